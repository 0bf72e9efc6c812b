"""Measurement of a virtual rig, in a few lines of at most 80 columns."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap

import numpy as np

from inerter.files.rig.running import RigRequest
from inerter.formatting import format_quantity, format_share
from inerter.records.record import Record
from inerter.report.text import WIDTH


def rig_text(request: RigRequest, record: Record) -> str:
    """The title, the signal, the samples, notes, the largest displacement and force, and whether the cell saturated."""
    return "\n".join(line for part in _lines(request, record) for line in wrap(part, WIDTH, subsequent_indent="  "))


def _lines(request: RigRequest, record: Record) -> Iterator[str]:
    peak, limit = float(np.abs(record.force).max()), request.rig.force_range
    yield request.title
    yield f"{record.source}"
    rate = format_quantity(1.0 / record.interval, "Hz", 6)
    yield f"{record.time.size} samples over {format_quantity(record.duration, 's', 6)}, at {rate}"
    yield from record.notes
    yield f"displacement up to {format_quantity(float(np.abs(record.displacement).max()), 'm')}"
    full = float(np.mean(np.abs(record.force) >= 0.999 * limit))
    state = f"saturated in {format_share(full, 2)} of the samples" if full else "not saturated"
    known = format_quantity(limit, "N")
    yield f"force up to {format_quantity(peak, 'N')} of the {known} that the load cell can read: {state}"
