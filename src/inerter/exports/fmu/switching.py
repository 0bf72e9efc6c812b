"""The linear part of a vehicle with friction and gaps, with their forces as inputs and their motions as outputs.

Every branch of the graph becomes a strut of its own, every inner node a coordinate without mass, and every friction or
gap a force between its ends, in tension. What remains is an ordinary mechanism, and its state space the linear part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError, MechanismError
from inerter.exports.named_system import NamedQuantity, NamedSystem, Quantities
from inerter.exports.refusals import delay_notes, refuse_moving_ground
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.assemble import state_space
from inerter.systems.coordinates import null_space
from inerter.systems.graph import Branch, Graph, full_graph, switching
from inerter.systems.incidence import incidence_rows, inertias, of_law
from inerter.systems.outputs import input_unit, main_outputs, outputs, velocity_of
from inerter.vehicle.mechanism import GROUND, Coordinate, Force, Mechanism, Strut, TrackedPoint

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SwitchingSystem:
    """x' = A x + B (u, r), y = C x + D (u, r), q = Q (x, u, r), with reactions r of friction and gaps in tension.

    `system` has the reactions among its inputs, last. q is the velocity across a friction, whose reaction is `upper`
    where it slips up and `lower` where it slips down, or the elongation of a gap, which stays between both.
    """

    system: NamedSystem
    Q: Matrix
    lower: Matrix
    upper: Matrix
    is_gap: tuple[bool, ...]

    @property
    def inputs(self) -> Quantities:
        """The inputs that are no reactions."""
        return self.system.inputs[: len(self.system.inputs) - len(self.is_gap)]


def without_reactions(system: NamedSystem) -> SwitchingSystem:
    """A linear system."""
    none = np.zeros(0)
    return SwitchingSystem(system, np.zeros((0, len(system.states) + len(system.inputs))), none, none, ())


def switching_system(mechanism: Mechanism, wanted: Sequence[str] | None, title: str) -> SwitchingSystem:
    """The switching system of a mechanism whose values are numbers, with its main outputs or those `wanted`.

    Raises `ExportError` for friction or a gap on a road, or at a node that nothing but springs hold.
    """
    refuse_moving_ground(mechanism, "an FMU")
    mechanism = switching(mechanism)
    graph = full_graph(mechanism)
    reactive = [b for b in graph.branches if b.element.switch is not None]
    _check(mechanism, graph, reactive)
    opened, names = _open_mechanism(mechanism, graph, reactive)
    roads = [road.name for road in mechanism.roads]
    reactions = [f"reaction_{i}" for i in range(len(reactive))]
    inputs = [*roads, *(force.name for force in mechanism.forces), *reactions]
    moved = [f"{c.name}_{what}" for c in mechanism.coordinates for what in ("displacement", "velocity", "acceleration")]
    known = set(outputs(opened, full_graph(opened)))
    asked = [name for name in moved if name in known]
    asked += [f"across_{i}_{'displacement' if _is_gap(b) else 'velocity'}" for i, b in enumerate(reactive)]
    asked += [f"{names[id(b)]}_force" for b in graph.branches if b.element.switch is None]
    try:
        base = state_space(opened, inputs, asked)
    except MechanismError as error:
        raise ExportError(f"Friction and gaps of an FMU need a linear part that holds every node. {error}") from error
    n, m = len(base.states), len(inputs)
    A, B = np.zeros((n + len(roads),) * 2), np.zeros((n + len(roads), m))  # heights of the roads as states
    A[:n, :n], B[:n], B[n:, : len(roads)] = base.A, base.B, np.eye(len(roads))
    rows = {
        name: np.concatenate([c, np.zeros(len(roads)), d]) for name, c, d in zip(asked, base.C, base.D, strict=True)
    }
    for i, road in enumerate(roads):
        rows[road] = np.eye(n + len(roads) + m)[n + i]
    for i, reaction in enumerate(reactions):
        rows[reaction] = np.eye(n + len(roads) + m)[n + len(roads) + len(inputs) - len(reactions) + i]
    found = {name: rows[name] for name in moved if name in rows} | _mounts(mechanism, graph, reactive, names, rows)
    units = outputs(mechanism, graph)
    chosen = list(wanted) if wanted is not None else [name for name in main_outputs(mechanism) if name in found]
    for name in chosen:
        if name not in found:
            raise ExportError(f"An FMU with friction or gaps has no output {name!r}; available: {', '.join(found)}.")
    whole = np.array([found[name] for name in chosen]).reshape(len(chosen), n + len(roads) + m)
    width = n + len(roads)
    named = [NamedQuantity(velocity_of(r), "m/s") for r in roads]
    named += [NamedQuantity(f.name, input_unit(mechanism, f.name)) for f in mechanism.forces]
    system = NamedSystem(
        A,
        B,
        whole[:, :width],
        whole[:, width:],
        tuple(NamedQuantity(name) for name in (*base.states, *roads)),
        (*named, *(NamedQuantity(f"force of {b.label}", "N") for b in reactive)),
        tuple(NamedQuantity(name, units[name].unit) for name in chosen),
        notes=tuple(delay_notes(mechanism, roads)),
        title=title or "vehicle",
    )
    Q = np.array([rows[name] for name in asked if name.startswith("across_")]).reshape(len(reactive), width + m)
    limits = np.array([b.element.checked_limits() for b in reactive]).reshape(len(reactive), 2)
    return SwitchingSystem(system, Q, limits[:, 0], limits[:, 1], tuple(map(_is_gap, reactive)))


def _is_gap(branch: Branch) -> bool:
    return branch.element.switches_by(GuardRole.ELONGATION)


def _check(mechanism: Mechanism, graph: Graph, reactive: Sequence[Branch]) -> None:
    damped = np.vstack([inertias(mechanism, graph)[0], incidence_rows(of_law(graph, LinearRole.DAMPING), graph)[0]])
    loose = null_space(damped)
    for branch in reactive:
        what = f"{branch.element.key} {branch.label!r}"
        if np.any(branch.roads):
            raise ExportError(f"An FMU has no {what} on the road itself. Put it between moving parts.")
        if np.any(np.abs(branch.nodes @ loose) > 1e-9):
            raise ExportError(
                f"An FMU needs a mass, inerter or damper at both ends of the {what}, where only springs are. Put a "
                "damper beside the spring, or leave friction and gaps out with linear=True, on the command line "
                "--linear."
            )


def _open_mechanism(mechanism: Mechanism, graph: Graph, reactive: Sequence[Branch]) -> tuple[Mechanism, dict[int, str]]:
    """The mechanism of single branches without friction and gaps, and the name of the strut of each branch."""
    count = len(mechanism.coordinates)
    inner = [f"inner_node_{i}" for i in range(len(graph.nodes) - count)]
    nodes = [*(c.name for c in mechanism.coordinates), *inner]
    roads = [road.name for road in mechanism.roads]
    names = {id(branch): f"branch_{i}" for i, branch in enumerate(graph.branches)}

    def port(branch: Branch) -> dict[str, float]:
        both = [*zip(nodes, branch.nodes, strict=True), *zip(roads, branch.roads, strict=True)]
        return {name: float(lever) for name, lever in both if lever != 0.0}

    struts = tuple(Strut(names[id(b)], b.element, port(b), GROUND) for b in graph.branches if b.element.switch is None)
    reactions = tuple(
        Force(f"reaction_{i}", {node: -lever for node, lever in port(b).items()}) for i, b in enumerate(reactive)
    )
    points = tuple(TrackedPoint(f"across_{i}", port(b)) for i, b in enumerate(reactive))
    opened = replace(
        mechanism,
        coordinates=(*mechanism.coordinates, *(Coordinate(node, 0.0) for node in inner)),
        struts=struts,
        tyres=(),
        still=(),
        forces=(*mechanism.forces, *reactions),
        points=points,
        mirror=(),
    )
    return opened, names


def _mounts(
    mechanism: Mechanism,
    graph: Graph,
    reactive: Sequence[Branch],
    names: dict[int, str],
    rows: dict[str, Matrix],
) -> dict[str, Matrix]:
    """Rows of what mounts carry, and of how far they move."""
    found = {}
    numbers = {id(branch): i for i, branch in enumerate(reactive)}
    known = outputs(mechanism, graph)
    for mount in mechanism.mounts():
        force, travel = (name for name in main_outputs(mechanism) if name.rpartition("_")[0] == mount.name)
        of = graph.mounts[mount.name]
        carried = [(graph.branches[i], sign) for i, sign in of.carriers.items()]
        nothing = np.zeros_like(next(iter(rows.values())))
        found[force], found[travel] = nothing.copy(), nothing.copy()
        for branch, sign in carried:
            name = f"reaction_{numbers[id(branch)]}" if id(branch) in numbers else f"{names[id(branch)]}_force"
            found[force] += sign * rows[name]
        for coordinate, lever in zip(mechanism.coordinates, of.nodes, strict=False):
            if lever != 0.0:
                found[travel] += lever * rows[f"{coordinate.name}_displacement"]
        for road, lever in zip(mechanism.roads, of.roads, strict=True):
            if lever != 0.0:
                found[travel] += lever * rows[road.name]
        assert {force, travel} <= set(known)
    return found
