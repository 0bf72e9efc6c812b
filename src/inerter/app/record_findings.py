"""Inspection of a measured record."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from inerter.figures.curves import thin_curve
from inerter.files.identification.running import read
from inerter.files.identification.sections import RecordRequest
from inerter.formatting import printed_text
from inerter.records.record import CHANNELS

_SHOWN = 2000  # samples of a channel


def found_in(path: str) -> dict[str, Any]:
    """Channels of a record, thinned for display, with its notes and findings.

    Raises `RecordError` for a file that cannot be used.
    """
    reading = read(Path(path), RecordRequest())
    record = reading.received
    return {
        "name": record.source,
        "samples": int(record.time.size),
        "duration": float(record.time[-1] - record.time[0]),
        "channels": [
            {
                **dict(zip(("name", "time", "values"), (name, *thin_curve(record.time, values, _SHOWN)), strict=True)),
                "unit": CHANNELS[name],
            }
            for name, values in record.channels().items()
            if name != "time"
        ],
        "notes": [printed_text(note) for note in record.notes],
        "findings": [
            {"severity": f.severity, "about": f.about, "sentence": printed_text(f.sentence)} for f in reading.findings
        ],
    }
