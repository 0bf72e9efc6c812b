"""Check of a simulation file before the simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.plausibility import road_sentence, road_warnings, vehicle_warnings
from inerter.files.common.problem import at
from inerter.files.common.problems import refusal
from inerter.files.simulation.loading import simulation_of
from inerter.formatting import format_quantity
from inerter.networks.parser import names
from inerter.signals.road import Road


def check_lines(tables: Mapping[str, Any], path: Path) -> Iterator[str]:
    """Sentences about a sound simulation file: what moves, for how long, and what no road or vehicle is.

    Raises `StudyError` as `load_simulation` does, and for what `simulate` would refuse.
    """
    request = simulation_of(tables, path)
    try:
        steps = request.check()
        length = request.length or 0.0
    except InerterError as error:
        raise refusal(path, [at(("simulation",), str(error))]) from None
    layout = "; ".join(dict.fromkeys(request.layouts[request.layout].struts.values()))
    start = "steady state" if request.initial == "periodic" else f"from {request.initial}"
    yield (
        f"{path}: ok. Simulation of {request.model} with {request.layout} = {layout}; {request.signal.input}: "
        f"{request.signal.kind}; {format_quantity(length, 's', 6)}, {steps} steps of "
        f"{format_quantity(request.step, 's', 6)}, {request.integrator}, {start}."
    )
    if request.speed is not None and request.roughness is not None:
        road = Road(request.roughness, request.speed)
        yield road_sentence(road, format_quantity(road.speed, "m/s", 4))
        yield from road_warnings(road)
    used = {name for text in request.layouts[request.layout].struts.values() for name in names(text)}
    yield from vehicle_warnings(request.vehicle, [(n, element) for n, element in request.elements.items() if n in used])
    yield from (f"Note: {note}." for note in request.notes)
