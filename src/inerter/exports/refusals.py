"""Refusals and notes: properties of a design that the format of an export has no means to state."""

from __future__ import annotations

from collections.abc import Sequence

from inerter.errors import ExportError
from inerter.formatting import format_quantity, format_some
from inerter.systems.graph import linear_graph
from inerter.systems.outputs import velocity_of
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Mechanism

_SHOWN = 3  # names in a message


def refuse_nonlinear(mechanism: Mechanism) -> None:
    """Raise `ExportError` for friction or gaps, which a linear format leaves out."""
    refuse_notes(linear_graph(mechanism).notes)


def refuse_notes(notes: Sequence[str]) -> None:
    """Raise `ExportError` if a linear model leaves something out."""
    if notes:
        raise ExportError(
            f"A linear model has neither friction nor gaps ({format_some(notes, _SHOWN)}). To export the design "
            "without them: linear=True, on the command line --linear."
        )


def refuse_moving_ground(mechanism: Mechanism, program: str) -> None:
    """Raise `ExportError` for a mechanism on moving ground."""
    if mechanism.ground_moves:
        raise ExportError(
            f"The ground of this mechanism moves, and {program} would need the {GROUND_ACCELERATION} at every mass. "
            "Export the mechanism on ground at rest, or a state space."
        )


def delay_notes(mechanism: Mechanism, inputs: Sequence[str]) -> list[str]:
    """Sentences on what the model does not say about the roads that are its inputs."""
    roads = [road for road in mechanism.roads if road.name in inputs]
    if len(roads) < 2:
        return []
    first = min(roads, key=lambda road: road.distance)
    late = [
        f"{velocity_of(road.name)} {format_quantity(road.distance - first.distance, 'm')} / speed later"
        for road in roads
        if road.distance > first.distance
    ]
    delays = f", and one road is at {velocity_of(first.name)} and reaches {', '.join(late)}" if late else ""
    return [f"The inputs of the roads are independent: delays and coherence are not in the model{delays}."]
