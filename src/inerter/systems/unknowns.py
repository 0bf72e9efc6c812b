"""Names and units of the states and unknowns of a descriptor, for whoever writes its equations down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.systems.coordinate_split import split
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
    names = [*frame.motion_names("R", "acceleration"), *frame.motion_names("U", "acceleration")]
    names += frame.motion_names("Y", "velocity")
    names += [f"{springs[int(np.argmax(np.abs(column)))]}_elongation" for column in found.Z_e.T]
    names += frame.motion_names("U", "velocity")
    if frame.slots.settles:
        names += frame.motion_names("Z", "velocity")
    units = {"acceleration": "m/s^2", "velocity": "m/s", "elongation": "m"}
    angles = _angles(descriptor)
    told = []
    for name in _number_unknowns(names, descriptor.states):
        before, _, what = name.rpartition("_")
        node, what = _named_node(before), what.rstrip("0123456789")
        told.append((name, units[what].replace("m", "rad", 1) if node in angles else units[what]))
    return tuple(told)


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
    before, _, what = name.rpartition("_")
    node = _named_node(before)
    is_velocity = what.rstrip("0123456789") == "velocity"
    return node if is_velocity and node in descriptor.model.graph.nodes else None


def _named_node(before: str) -> str:
    """The node in a name, before `_velocity` or `_acceleration`."""
    return before.removesuffix("_partial")
