"""The outputs of a mechanism by name, as rows over the motions of its nodes, the forces of its branches and its inputs.

Linear analysis and both integrators know nodes, branches and inputs only; this is the one place that knows what people
ask for, and how what they may ask for is called.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError, PerformanceIndexError
from inerter.formatting import format_some, in_words
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.graph import Branch, Carriers, Graph, Mount, full_graph
from inerter.vehicle.mechanism import GROUND_ACCELERATION, Coordinate, Mechanism, Strut, TrackedPoint, Tyre

Matrix = NDArray[np.float64]
_LISTED = 24  # names in a message
_MOTIONS = {"displacement": "", "velocity": "/s", "acceleration": "/s^2"}  # of a coordinate, and behind its unit
_OVER_GROUND = ("displacement", "velocity")  # that are known of a mass though nothing is known of where the ground is
_MOUNTED = {Strut: ("force", "travel"), Tyre: ("load", "deflection")}  # what a mount carries, and how far it moves


_EMPTY: Matrix = np.zeros(0)


def _none() -> Matrix:
    return _EMPTY


@dataclass(frozen=True, eq=False)
class Output:
    """Output: the sum of its rows times the quantities they refer to. An empty row is a row of zeros."""

    name: str
    unit: str
    title: str
    displacement: Matrix = field(default_factory=_none)  # over the nodes
    velocity: Matrix = field(default_factory=_none)
    acceleration: Matrix = field(default_factory=_none)
    forces: Matrix = field(default_factory=_none)  # over the branches
    road: Matrix = field(default_factory=_none)  # over the roads' displacements
    road_velocity: Matrix = field(default_factory=_none)
    external: Matrix = field(default_factory=_none)  # over the external forces


def outputs(mechanism: Mechanism, graph: Graph) -> dict[str, Output]:
    """Every output of `mechanism` by name.

    Inputs; motions of coordinates; force, travel or load and deflection of mounts; velocity, force and, where
    springs tell it, stroke of elements; motions over the ground. If only one strut is there, `force` and `travel` are
    its own.
    """
    mounts = _of_mounts(mechanism, graph)
    found = [*_of_inputs(mechanism), *_of_coordinates(mechanism, graph), *mounts]
    if len(mechanism.struts) == 1:
        own = f"{mechanism.struts[0].name}_"
        found += [replace(o, name=o.name.removeprefix(own)) for o in found if o.name.startswith(own)]
    found += [*_of_elements(mechanism, graph), *_over_ground(mechanism, graph), *_of_still(mechanism)]
    known = {output.name: output for output in reversed(found)}  # a mount's own name goes before an element's
    return {output.name: known[output.name] for output in found}


def main_outputs(mechanism: Mechanism) -> list[str]:
    """Names of the outputs that every analysis has: motions of coordinates, what mounts carry and how far they move."""
    coordinates = [f"{c.name}_{what}" for c in mechanism.coordinates for what in _motions(mechanism, c)]
    return coordinates + [name for mount in mechanism.mounts() for name in of_mount(mount)]


def of_mount(mount: Strut | Tyre) -> tuple[str, str]:
    """The names of what a mount carries, and of how far it moves."""
    carried, moved = _MOUNTED[type(mount)]
    return f"{mount.name}_{carried}", f"{mount.name}_{moved}"


def input_names(mechanism: Mechanism) -> list[str]:
    """Names of the inputs: roads, then external forces."""
    return [*(road.name for road in mechanism.roads), *(force.name for force in mechanism.forces)]


def force_of(label: str) -> str:
    """Name of an element's force, and of a force in parallel with the element."""
    return f"{label}_force"


def velocity_of(label: str) -> str:
    """The name of the velocity across an element."""
    return f"{label}_velocity"


def stroke_of(label: str) -> str:
    """The name of an element's elongation."""
    return f"{label}_stroke"


def rename_output(output: str, elements: Mapping[str, str]) -> str:
    """Name of an output once elements have other names, by the old ones.

    >>> rename_output("k_force", {"k": "spring"}), rename_output("sprung_velocity", {"k": "spring"})
    ('spring_force', 'sprung_velocity')
    """
    for old, new in elements.items():
        for output_of in (force_of, velocity_of, stroke_of):
            if output == output_of(old):
                return output_of(new)
    return output


def _of_inputs(mechanism: Mechanism) -> list[Output]:
    roads, forces = np.eye(len(mechanism.roads)), np.eye(len(mechanism.forces))
    found = [Output(r.name, "m", in_words(r.name), road=row) for r, row in zip(mechanism.roads, roads, strict=True)]
    angles = {c.name for c in mechanism.coordinates if c.angle}
    for given, row in zip(mechanism.forces, forces, strict=True):
        unit = "N m" if set(given.port) <= angles else "N"
        if mechanism.ground_moves and given.name == GROUND_ACCELERATION:
            unit = "m/s^2"
        found.append(Output(given.name, unit, in_words(given.name), external=row))
    return found


def _motions(mechanism: Mechanism, coordinate: Coordinate | TrackedPoint) -> tuple[str, ...]:
    """Motions of a coordinate or point available as outputs: on moving ground only accelerations, and none of a node
    without mass.
    """
    if isinstance(coordinate, Coordinate):
        has_mass = not coordinate.is_massless
    else:
        has_mass = not any(c.is_massless and coordinate.port.get(c.name) for c in mechanism.coordinates)
    over_ground = () if mechanism.ground_moves and not coordinate.angle else _OVER_GROUND
    return (*over_ground, "acceleration") if has_mass else over_ground


def _of_coordinates(mechanism: Mechanism, graph: Graph) -> list[Output]:
    found = []
    ground = np.array([float(force.name == GROUND_ACCELERATION) for force in mechanism.forces])
    for coordinate, row in _moving(mechanism, graph):
        unit, said = "rad" if coordinate.angle else "m", in_words(coordinate.name)
        carried = {"external": ground} if mechanism.ground_moves and not coordinate.angle else {}
        for what in _motions(mechanism, coordinate):
            moved: dict[str, Any] = {what: row, **carried}
            found.append(Output(f"{coordinate.name}_{what}", f"{unit}{_MOTIONS[what]}", f"{said} {what}", **moved))
    return found


def _moving(mechanism: Mechanism, graph: Graph) -> list[tuple[Coordinate | TrackedPoint, Matrix]]:
    """Coordinates and points, as rows over the nodes."""
    found: list[tuple[Coordinate | TrackedPoint, Matrix]] = []
    found += zip(mechanism.coordinates, np.eye(len(graph.nodes)), strict=False)
    of = {coordinate.name: row for coordinate, row in found}
    for point in mechanism.points:
        found.append((point, sum((v * of[n] for n, v in point.port.items()), np.zeros(len(graph.nodes)))))
    return found


def _over_ground(mechanism: Mechanism, graph: Graph) -> list[Output]:
    """Motions of masses relative to the ground, whether that moves or not."""
    found = []
    for coordinate, row in (one for one in _moving(mechanism, graph) if not one[0].angle):
        for what in _OVER_GROUND:
            moved: dict[str, Any] = {what: row}
            title = f"{in_words(coordinate.name)} {what} over the ground"
            found.append(Output(f"{coordinate.name}_relative_{what}", f"m{_MOTIONS[what]}", title, **moved))
    return found


def _of_mounts(mechanism: Mechanism, graph: Graph) -> list[Output]:
    found = []
    for part in mechanism.mounts():
        mount, (force, travel) = graph.mounts[part.name], of_mount(part)
        total = np.zeros(len(graph.branches))
        total[list(mount.carriers)] = list(mount.carriers.values())
        found += [
            Output(force, "N", in_words(force), forces=total),
            Output(travel, "m", in_words(travel), displacement=mount.nodes, road=mount.roads),
        ]
    return found


def _of_elements(mechanism: Mechanism, graph: Graph) -> list[Output]:
    places: dict[str, tuple[Branch | Mount, Carriers]] = {
        label: (group, group.carriers) for label, group in graph.groups.items()
    }
    for i, branch in enumerate(graph.branches):
        if branch.label not in graph.silent:
            places.setdefault(branch.label, (branch, {i: 1.0}))
    found, lost = [], ~_positioned_nodes(mechanism, graph)
    elongations = [b.nodes for b in graph.branches if _determines_elongation(b)]
    for label, (place, carriers) in places.items():
        total = np.zeros(len(graph.branches))
        total[list(carriers)] = list(carriers.values())
        moved = {"velocity": place.nodes, "road_velocity": place.roads}
        found += [
            Output(velocity_of(label), "m/s", f"velocity across {label}", **moved),
            Output(force_of(label), "N", f"force of {label}", forces=total),
        ]
        if not np.any(place.nodes[lost]) or any(np.array_equal(place.nodes, row) for row in elongations):
            moved = {"displacement": place.nodes, "road": place.roads}
            found.append(Output(stroke_of(label), "m", f"stroke of {label}", **moved))
    return found


def positioned_rows(mechanism: Mechanism, graph: Graph) -> Matrix:
    """Displacements that are known, over the nodes: elongations of springs and gaps, and coordinates."""
    placed = [b.nodes for b in graph.branches if _determines_elongation(b)]
    return np.vstack([*placed, np.eye(len(mechanism.coordinates), len(graph.nodes))])


def _determines_elongation(branch: Branch) -> bool:
    return branch.element.linear is LinearRole.STIFFNESS or branch.element.switches_by(GuardRole.ELONGATION)


def _positioned_nodes(mechanism: Mechanism, graph: Graph) -> NDArray[np.bool_]:
    """Nodes whose place is known: coordinates, and what springs and gaps join to them. Others, such as that between a
    damper and an inerter, have velocities only.
    """
    known = np.arange(len(graph.nodes)) < len(mechanism.coordinates)
    joining = [b.nodes != 0.0 for b in graph.branches if _determines_elongation(b)]
    while not known.all():
        alone = [row & ~known for row in joining if np.count_nonzero(row & ~known) == 1]
        if not alone:
            break
        known = known | np.any(alone, axis=0)
    return known


def _of_still(mechanism: Mechanism) -> list[Output]:
    """Zero outputs of struts that do not move, under each of their names."""
    found: list[Output] = []
    for strut in mechanism.still:
        force, travel = of_mount(strut)
        found += [Output(force, "N", in_words(force)), Output(travel, "m", in_words(travel))]
        labels = [element.label for element in strut.network.elements()]
        for label in (*(f"{strut.name}.{label}" for label in labels), *labels):
            found += [
                Output(velocity_of(label), "m/s", f"velocity across {label}"),
                Output(force_of(label), "N", f"force of {label}"),
                Output(stroke_of(label), "m", f"stroke of {label}"),
            ]
    return found


def check_inputs(
    mechanism: Mechanism, names: Sequence[str], error: type[InerterError], also: Sequence[str] = ()
) -> None:
    """Raises `error` for a name that is neither an input of the mechanism nor in `also`."""
    known = input_names(mechanism)
    for name in names:
        if name not in known and name not in also:
            raise error(f"Unknown input {name!r}; available: {', '.join(known) or 'none'}.")


def unit_of(mechanism: Mechanism, names: Sequence[str]) -> str:
    """Common unit of these outputs; empty for different or unknown units.

    Beside motions in m, those of angles are weighted by levers in m.
    """
    known = outputs(mechanism, full_graph(mechanism))
    units = {known[name].unit if name in known else "" for name in names}
    if len(units) > 1:
        units = {re.sub(r"^rad(?![^/])", "m", unit) for unit in units}
    return units.pop() if len(units) == 1 else ""


def input_unit(mechanism: Mechanism, name: str) -> str:
    """The unit of an input: of a force, of a road's displacement, or of `<road>_velocity`; empty for an unknown one."""
    if any(name == velocity_of(road.name) for road in mechanism.roads):
        return "m/s"
    return unit_of(mechanism, [name]) if name in input_names(mechanism) else ""


def check_bounded(mechanism: Mechanism, driven: Mechanism, name: str) -> None:
    """Raises `PerformanceIndexError` for a motion of the mechanism that has no bounds once the ground moves."""
    if driven.ground_moves and name in main_outputs(mechanism) and name not in main_outputs(driven):
        coordinate, _, what = name.rpartition("_")
        raise PerformanceIndexError(
            f"Under ground acceleration {name!r} is unbounded, because the ground drifts. "
            f"Use {coordinate}_relative_{what}, the motion relative to the ground."
        )


def check_element(mechanism: Mechanism, label: object, called: Callable[[str], str]) -> None:
    """Raises `PerformanceIndexError` unless the element and its output, named by `called`, are known."""
    graph = full_graph(mechanism)
    known = outputs(mechanism, graph)
    every = dict.fromkeys((*graph.groups, *(branch.label for branch in graph.branches)))
    labels = [name for name in every if force_of(name) in known]
    if not isinstance(label, str) or label not in labels:
        raise PerformanceIndexError(f"Unknown element {label!r}; available: {', '.join(labels) or 'none'}.")
    if called(label) not in known:
        raise PerformanceIndexError(
            f"The stroke of {label!r} is undefined, only its velocity is known: no spring determines the position of "
            "one end."
        )


def find(known: Mapping[str, Output], name: object, error: type[InerterError]) -> Output:
    """Output of that name; raises `error`, with the names that come close, if there is none."""
    if isinstance(name, str) and name in known:
        return known[name]
    close = get_close_matches(str(name), known, n=3)
    hint = f"Did you mean {' or '.join(close)}?" if close else f"Available: {format_some(known, _LISTED)}."
    raise error(f"Unknown output {name!r}. {hint}")
