"""A mechanism whose frictions and gaps are cut: their forces are inputs, and the motions across them outputs.

Every branch of the graph becomes a strut of its own, every inner node a coordinate without mass, and every friction or
gap a force between its ends, in tension. What remains is an ordinary mechanism without friction and gaps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ExportError, MechanismError
from inerter.exports.kinds.fmu.equations import Equations, FmuParameter, equations_of
from inerter.networks.elements import Element, Network
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.networks.transform import map_elements
from inerter.systems.assemble import state_space
from inerter.systems.coordinates import null_space
from inerter.systems.graph import Branch, Graph, full_graph, switching
from inerter.systems.incidence import incidence_rows, inertias, of_law
from inerter.systems.kinematics import kinematics
from inerter.systems.linear import LinearSystem
from inerter.systems.outputs import force_of, of_mount, outputs
from inerter.systems.structure import structure_of
from inerter.vehicle.mechanism import GROUND, Coordinate, Force, Mechanism, Strut, TrackedPoint

Matrix = NDArray[np.float64]
Rows = dict[str, Matrix]  # over the columns of a model, or stacks of them


@dataclass(frozen=True, eq=False)
class Cut:
    """A friction or gap that is cut."""

    branch: Branch
    reaction: Force  # in its place, in tension
    point: TrackedPoint | None  # that moves as its elongation does; none at a node that only springs hold
    levers: Mapping[str, float]  # of coordinates in its elongation there
    springs: Mapping[int, float]  # and of the elongations of branches

    @property
    def is_gap(self) -> bool:
        """Whether its law is about its elongation, and not about its velocity."""
        return self.branch.element.switches_by(GuardRole.ELONGATION)

    @property
    def motion(self) -> str:
        """The output on which its law is."""
        assert self.point is not None
        return f"{self.point.name}_{'displacement' if self.is_gap else 'velocity'}"

    @property
    def creeps(self) -> bool:
        """Whether it is a friction at a node that only springs hold, which its force moves at once."""
        return self.point is None and not self.is_gap


@dataclass(frozen=True, eq=False)
class CutMechanism:
    """A mechanism as simulation has it, and the same without its frictions and gaps."""

    whole: Mechanism
    graph: Graph
    opened: Mechanism
    cuts: tuple[Cut, ...]
    carried: tuple[str, ...]  # the output or input of `opened` that is the force of each branch of the graph
    labels: Mapping[str, str]  # of the elements of `opened`, by those of the whole

    @property
    def inputs(self) -> tuple[str, ...]:
        """Roads, forces and, last, the reactions."""
        return (*(road.name for road in self.whole.roads), *(force.name for force in self.opened.forces))

    def outputs(self) -> tuple[str, ...]:
        """Motions of coordinates and across the cuts, and the forces of what is not cut."""
        motions = ("displacement", "velocity", "acceleration")
        moved = [f"{c.name}_{what}" for c in self.whole.coordinates for what in motions]
        known = outputs(self.opened, full_graph(self.opened))
        across = [cut.motion for cut in self.cuts if cut.point is not None]
        reactions = {cut.reaction.name for cut in self.cuts}
        return (*(n for n in moved if n in known), *across, *(n for n in self.carried if n not in reactions))

    def linear_part(self) -> LinearSystem:
        """The state space of what is not cut; raises `ExportError` where it does not hold every node."""
        try:
            return state_space(self.opened, self.inputs, self.outputs())
        except MechanismError as error:
            raise ExportError(
                f"Friction and gaps of an FMU need a linear part that holds every node. {error}"
            ) from error

    def equations(self) -> Equations | None:
        """The equations of what is not cut over its values, which have the names that the whole gives them."""
        if structure_of(self.whole) is None:
            return None
        found = equations_of(self.opened, self.inputs, self.outputs())
        if found is None:
            return None
        named = tuple(replace(one, name=self.labels.get(one.name, one.name)) for one in found.parameters)
        return replace(found, parameters=named)

    def limits(self) -> tuple[FmuParameter | None, ...]:
        """The limit of each cut as a parameter, where it is one."""
        if structure_of(self.whole) is None:
            return tuple(None for _ in self.cuts)
        return tuple(_limit(cut) if cut.branch.element.even else None for cut in self.cuts)

    def complete(self, rows: Rows) -> Rows:
        """Rows of all outputs of the whole from those of the opened mechanism, its roads and reactions."""
        nothing = np.zeros_like(next(iter(rows.values())))
        found = {name: row for name, row in rows.items() if name in outputs(self.whole, self.graph)}
        for mount in self.whole.mounts():
            force, travel = of_mount(mount)
            place = self.graph.mounts[mount.name]
            found[force] = sum((sign * rows[self.carried[i]] for i, sign in place.carriers.items()), nothing)
            levers = dict(zip((c.name for c in self.whole.coordinates), place.nodes, strict=False))
            found[travel] = nothing
            for name, lever in levers.items():
                if lever != 0.0:
                    found[travel] = found[travel] + lever * rows[f"{name}_displacement"]
            for road, lever in zip(self.whole.roads, place.roads, strict=True):
                found[travel] = found[travel] + lever * rows[road.name]
        return found

    def motions(self, rows: Rows, equations: Equations | None = None) -> list[Matrix]:
        """Rows of the motions on which the laws are; stacks of them with the equations that have these rows."""
        found = []
        for cut in self.cuts:
            if cut.point is not None:
                found.append(rows[cut.motion])
                continue
            terms = [lever * rows[f"{name}_displacement"] for name, lever in cut.levers.items()]
            terms += [lever * self._elongation(i, rows, equations) for i, lever in cut.springs.items()]
            found.append(np.sum(terms, axis=0))
        return found

    def _elongation(self, number: int, rows: Rows, equations: Equations | None) -> Matrix:
        """Elongation of a spring: its force over its stiffness, which `equations` has as a parameter."""
        force, element = rows[self.carried[number]], self.graph.branches[number].element
        if equations is None:
            return force / element.coefficient
        names = [one.name for one in equations.parameters]
        found = np.zeros_like(force)
        found[0] = force[1 + names.index(self.graph.branches[number].label)] / element.gain
        return found


def cut_mechanism(mechanism: Mechanism, prescribed: int = 0) -> CutMechanism:
    """The cut mechanism of one with numbers as values, whose first `prescribed` coordinates move as they are told.

    Raises `ExportError` for friction or a gap on a road, `MechanismError` as `piecewise` does.
    """
    whole = switching(mechanism)
    graph = full_graph(whole)
    numbers = [i for i, branch in enumerate(graph.branches) if branch.element.switch is not None]
    _check([graph.branches[i] for i in numbers], prescribed)
    inner = [f"inner_node_{i}" for i in range(len(graph.nodes) - len(whole.coordinates))]
    nodes = [*(c.name for c in whole.coordinates), *inner]
    roads = [road.name for road in whole.roads]

    def port(branch: Branch) -> dict[str, float]:
        both = [*zip(nodes, branch.nodes, strict=True), *zip(roads, branch.roads, strict=True)]
        return {name: float(lever) for name, lever in both if lever != 0.0}

    struts = {
        i: Strut(f"branch_{i}", b.element, port(b), GROUND) for i, b in enumerate(graph.branches) if i not in numbers
    }
    cuts = []
    for i in numbers:
        branch = graph.branches[i]
        pulled = {node: -lever for node, lever in port(branch).items()}
        reaction = Force(f"reaction_{i}", pulled)
        if _is_loose(whole, graph, branch, prescribed):
            cuts.append(Cut(branch, reaction, None, *_place(whole, graph, branch)))
        else:
            cuts.append(Cut(branch, reaction, TrackedPoint(f"across_{i}", port(branch)), {}, {}))
    opened = replace(
        whole,
        coordinates=(*whole.coordinates, *(Coordinate(node, 0.0) for node in inner)),
        struts=tuple(struts.values()),
        tyres=(),
        still=(),
        forces=(*whole.forces, *(cut.reaction for cut in cuts)),
        points=tuple(cut.point for cut in cuts if cut.point is not None),
        mirror=(),
    )
    kinematics(_with_widths(whole))  # refuses what simulation refuses, such as impacts
    reactions = {i: cut.reaction.name for i, cut in zip(numbers, cuts, strict=True)}
    carried = [reactions[i] if i in reactions else force_of(struts[i].name) for i in range(len(graph.branches))]
    found = full_graph(opened).branches if struts else ()
    labels = {one.label: graph.branches[i].label for one, i in zip(found, struts, strict=True)}
    return CutMechanism(whole, graph, opened, tuple(cuts), tuple(carried), labels)


def _with_widths(mechanism: Mechanism) -> Mechanism:
    """The mechanism whose gaps all have a width, as a host may give them; an FMU has no rigid joint in their place."""

    def widen(element: Element) -> Network:
        is_closed = element.switches_by(GuardRole.ELONGATION) and not element.acts
        return element.with_value(1.0) if is_closed else element

    return mechanism.with_networks(lambda mount: map_elements(mount.network, widen))


def _limit(cut: Cut) -> FmuParameter:
    element = cut.branch.element
    value = element.value
    assert isinstance(value, float)
    return FmuParameter(cut.branch.label, element.unit, value, is_tunable=not cut.is_gap, may_vanish=True)


def _check(reactive: Sequence[Branch], prescribed: int) -> None:
    for branch in reactive:
        what = f"{branch.element.key} {branch.label!r}"
        if np.any(branch.roads):
            raise ExportError(f"An FMU does not support the {what} on the road itself. Put it between moving parts.")
        if not np.any(branch.nodes[prescribed:]):
            raise ExportError(
                f"The {what} is between the ends of the strut itself, so that only a host could determine when it "
                "sticks or touches. Export the whole vehicle, or give it an elastic shaft."
            )


def _is_loose(mechanism: Mechanism, graph: Graph, branch: Branch, prescribed: int) -> bool:
    """Whether an end of a branch is at a node that neither mass, inerter nor damper holds."""
    damped = np.vstack([inertias(mechanism, graph)[0], incidence_rows(of_law(graph, LinearRole.DAMPING), graph)[0]])
    loose = null_space(damped[:, prescribed:])
    return bool(np.any(np.abs(branch.nodes[prescribed:] @ loose) > 1e-9))


def _place(mechanism: Mechanism, graph: Graph, branch: Branch) -> tuple[dict[str, float], dict[int, float]]:
    """The elongation of a branch by coordinates and by elongations of springs; raises `ExportError` if it is none."""
    springs = {
        i: one.nodes
        for i, one in enumerate(graph.branches)
        if one.element.linear is LinearRole.STIFFNESS and not np.any(one.roads)
    }
    count = len(mechanism.coordinates)
    rows = np.vstack([np.eye(len(graph.nodes))[:count], *springs.values()])
    weights = np.linalg.lstsq(rows.T, branch.nodes, rcond=None)[0]
    if np.abs(weights @ rows - branch.nodes).max() > 1e-9:
        raise ExportError(
            f"The elongation of the {branch.element.key} {branch.label!r} is unknown in an FMU: it has only springs "
            "at one end. Put a damper in parallel with the spring, or leave friction and gaps out with linear=True, on "
            "the command line --linear."
        )
    levers = {c.name: float(w) for c, w in zip(mechanism.coordinates, weights, strict=False) if abs(w) > 1e-9}
    return levers, {i: float(w) for i, w in zip(springs, weights[count:], strict=True) if abs(w) > 1e-9}
