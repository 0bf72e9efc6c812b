"""Check of a rig file before the rig is run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.problem import at
from inerter.files.common.problems import refusal
from inerter.files.rig.loading import rig_of
from inerter.formatting import format_quantity
from inerter.networks.parser import format_expression


def check_lines(tables: Mapping[str, Any], path: Path) -> Iterator[str]:
    """Sentences about a sound rig file: the device, the signal and the samples.

    Raises `StudyError` as `load_rig` does, and for what the rig would refuse.
    """
    request = rig_of(tables, path)
    try:
        samples = request.check()
    except InerterError as error:
        raise refusal(path, [at(("rig",), str(error))]) from None
    device = format_expression(request.rig.device, [element.label for element in request.rig.device.elements()])
    yield (
        f"{path}: ok. Virtual rig with {device}; {request.signal.input}: {request.signal.kind}; {samples} samples over "
        f"{format_quantity(request.duration, 's', 6)}, at {format_quantity(request.rig.sampling, 'Hz', 6)}."
    )
