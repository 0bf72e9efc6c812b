"""Names and units of the states and unknowns of a descriptor, for whoever writes its equations down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.systems.coordinate_split import Frame, split
from inerter.systems.descriptor import Descriptor
from inerter.systems.graph import linear_graph

Matrix = NDArray[np.float64]


def state_units(descriptor: Descriptor) -> tuple[str, ...]:
    """Unit of each state, in their order."""
    known = descriptor.model.outputs
    angles = _angles(descriptor)
    found = []
    for name in descriptor.states:
        if name in known:  # an output that is a state of its own
            found.append(known[name].unit)
        elif (node := _node_of(name, descriptor)) is not None:
            found.append("rad/s" if node in angles else "m/s")
        else:
            found.append("m")
    return tuple(found)


def unknowns(descriptor: Descriptor) -> tuple[tuple[str, str], ...]:
    """Name and unit of each unknown eta of the descriptor: accelerations, velocities and elongations."""
    mechanism = descriptor.mechanism
    roads = [road.name for road in mechanism.roads]
    ordered = sorted(descriptor.inputs, key=lambda name: name not in roads)
    frame = split(mechanism, linear_graph(mechanism), ordered, descriptor.outputs)
    found = frame.split
    springs = [branch.label for branch in frame.springs]
    names = [*_motions(found.R, frame, "acceleration"), *_motions(found.U, frame, "acceleration")]
    names += _motions(found.Y, frame, "velocity")
    names += [f"{springs[int(np.argmax(np.abs(column)))]}_elongation" for column in found.Z_e.T]
    names += _motions(found.U, frame, "velocity")
    if frame.slots.settles:
        names += _motions(found.Z, frame, "velocity")
    units = {"acceleration": "m/s^2", "velocity": "m/s", "elongation": "m"}
    angles = _angles(descriptor)
    told = []
    for name in _number_unknowns(names, descriptor.states):
        node, _, what = name.rpartition("_")
        what = what.rstrip("0123456789")
        told.append((name, units[what].replace("m", "rad", 1) if node in angles else units[what]))
    return tuple(told)


def _motions(columns: Matrix, frame: Frame, what: str) -> list[str]:
    return [f"{frame.graph.nodes[int(np.argmax(np.abs(column)))]}_{what}" for column in columns.T]


def _number_unknowns(names: Sequence[str], taken: Sequence[str]) -> list[str]:
    """The names with a number behind where they would occur twice, here or among those that are taken."""
    found: list[str] = []
    for name in names:
        number, told = 1, name
        while told in found or told in taken:
            number += 1
            told = f"{name}{number}"
        found.append(told)
    return found


def _angles(descriptor: Descriptor) -> frozenset[str]:
    return frozenset(c.name for c in descriptor.mechanism.coordinates if c.angle)


def _node_of(name: str, descriptor: Descriptor) -> str | None:
    """The node of which a state is the velocity; None for an elongation."""
    node, _, what = name.rpartition("_")
    is_velocity = what.rstrip("0123456789") == "velocity"
    return node if is_velocity and node in descriptor.model.graph.nodes else None
