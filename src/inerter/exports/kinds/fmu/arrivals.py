"""One road for all axles of a track: an FMU that delays it by itself, at a speed that is its parameter."""

from __future__ import annotations

from dataclasses import replace

from inerter.errors import ExportError
from inerter.exports.kinds.fmu.equations import FmuParameter
from inerter.exports.kinds.fmu.switching import SwitchingSystem
from inerter.exports.refusals import delay_notes
from inerter.formatting import format_quantity, format_range
from inerter.systems.outputs import velocity_of
from inerter.validation import check_positive
from inerter.vehicle.mechanism import LARGEST, SMALLEST, Mechanism, RoadInput


def on_one_road(system: SwitchingSystem, mechanism: Mechanism, speed: float) -> SwitchingSystem:
    """The system whose roads on one side are the foremost of them, and reach the others distance / speed later.

    Raises `ExportError` for a speed that is no positive number, or one that a host could not set.
    """
    check_positive(ExportError, "The speed", speed, "m/s")
    if not SMALLEST <= speed <= LARGEST:
        raise ExportError(f"The speed is {speed!r} m/s; an FMU supports {format_range(SMALLEST, LARGEST, 'm/s')}.")
    names = [one.name for one in system.inputs]
    roads = [road for road in mechanism.roads if velocity_of(road.name) in names]
    first: dict[str, RoadInput] = {}
    for road in sorted(roads, key=lambda road: road.distance):
        first.setdefault(road.side, road)
    sources, distances, notes = list(range(len(names))), [0.0] * len(names), []
    for road in roads:
        foremost = first[road.side]
        place = names.index(velocity_of(road.name))
        sources[place] = names.index(velocity_of(foremost.name))
        distances[place] = road.distance - foremost.distance
        if road is not foremost:
            later = format_quantity(distances[place], "m")
            notes.append(f"{velocity_of(foremost.name)} reaches {road.name} {later} / speed later.")
    kept = [note for note in system.system.notes if note not in delay_notes(mechanism, [road.name for road in roads])]
    return replace(
        system,
        system=replace(system.system, notes=(*kept, *notes)),
        sources=tuple(sources),
        distances=tuple(distances),
        speed=FmuParameter(
            "speed", "m/s", float(speed), description="Of the vehicle; it delays the road at later axles."
        ),
    )
