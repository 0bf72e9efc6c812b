"""The split of a graph's motions into unknowns, states and inputs, in which linear analysis writes its equations.

Unknowns are eta = (accelerations of R and U, velocities of Y, elongations zeta, velocities of U), and the velocities of
Z where an output asks for them; states x = (velocities a, elongations g); inputs u = (road velocities, forces). See
`systems.coordinates`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import MechanismError
from inerter.networks.elements import Element, Free
from inerter.networks.elements.roles import LinearRole
from inerter.systems.coordinates import Coordinates, combination, find_coordinates
from inerter.systems.graph import Branch, Graph
from inerter.systems.incidence import incidence_rows, inertias, of_law, ports
from inerter.systems.lever_arms import BranchRows, is_lost, lost_travel_message
from inerter.systems.outputs import Output, force_of, outputs
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]
Long = NDArray[np.longdouble]
RowBlocks = tuple[Matrix, Matrix, Matrix]  # on eta, x and u


@dataclass(frozen=True)
class Slots:
    """Slices of the coordinates in the unknowns eta and the states x."""

    a1: slice
    u1: slice
    y: slice
    z: slice
    u0: slice
    z1: slice  # empty unless an output asks for velocities of Z
    a: slice
    g: slice

    @staticmethod
    def of(split: Coordinates, *, settling: bool) -> Slots:
        """The slots, with velocities of Z where an output asks for one (`settling`)."""
        a, u, y, z = (columns.shape[1] for columns in (split.R, split.U, split.Y, split.Z))
        edges = np.cumsum([0, a, u, y, z, u, z * settling])
        a1, u1, y1, z0, u0, z1 = (slice(int(i), int(j)) for i, j in pairwise(edges))
        return Slots(a1, u1, y1, z0, u0, z1, slice(0, a), slice(a, a + split.G.shape[1]))

    @property
    def settles(self) -> bool:
        """Whether velocities of Z are unknowns."""
        return bool(self.z1.stop > self.z1.start)


@dataclass(frozen=True, eq=False)
class Frame:
    """A graph with its motions split, for chosen inputs (roads first)."""

    mechanism: Mechanism
    graph: Graph
    inputs: tuple[str, ...]
    split: Coordinates
    slots: Slots
    known: dict[str, Output]
    springs: tuple[Branch, ...]
    spring_rows: Matrix  # over nodes, and ...
    spring_roads: Matrix  # ... over the roads that are inputs
    road_columns: list[int]  # of the roads that are inputs, among all
    force_rows: Matrix  # of the other inputs over nodes

    @property
    def roads(self) -> int:
        """Inputs that are roads."""
        return len(self.road_columns)

    @property
    def unknowns(self) -> int:
        """Length of eta."""
        return int(self.slots.z1.stop)

    @property
    def states(self) -> int:
        """Length of x."""
        return int(self.slots.g.stop)

    @property
    def precision_warning(self) -> str:
        """Message on elongations lost to rounding; empty if none is."""
        shares = self.split.G
        lost = is_lost(shares, np.hstack(self.split.rates))
        return lost_travel_message(shares, [branch.label for branch in self.springs]) if lost else ""

    @cached_property
    def free(self) -> dict[str, Free]:
        """The free values by name."""
        elements = [*(b.element for b in self.graph.branches), *(c.element for c in self.mechanism.masses.values())]
        return {str(e.value.name): e.value for e in elements if isinstance(e.value, Free)}

    @cached_property
    def spring_number(self) -> dict[int, int]:
        """Number of each spring by the identity of its branch."""
        return {id(branch): i for i, branch in enumerate(self.springs)}

    def slice_of(self, element: Element) -> tuple[int, float]:
        """Number of the slice, in a stack over the free values, of an element's value, and its factor there."""
        if isinstance(element.value, Free):
            return 1 + list(self.free).index(str(element.value.name)), element.gain
        return 0, element.coefficient

    def blank(self) -> RowBlocks:
        """Rows of zeros."""
        return np.zeros(self.unknowns), np.zeros(self.states), np.zeros(len(self.inputs))

    def motion_names(self, part: str, what: str) -> list[str]:
        """Names of the motions of a part of the split (R, U, Y or Z), such as `wheel_velocity`.

        A motion is called after a node if that node has no other; else it is `<node>_partial_<what>`, one of the
        motions that a node such as one between springs and inerters has.
        """
        split = self.split
        alone = np.count_nonzero(np.hstack([split.R, split.U, split.Y, split.Z]), axis=1) == 1
        names = []
        for column in getattr(split, part).T:
            own = alone & (column == 1.0)
            node = self.graph.nodes[int(np.argmax(own if own.any() else np.abs(column)))]
            names.append(f"{node}_{what}" if own.any() else f"{node}_partial_{what}")
        return names

    def velocity(self, nodes: Matrix, roads: Matrix | None = None) -> RowBlocks:
        """The velocity of a combination of nodes and roads."""
        (eta, x, u), at = self.blank(), self.slots
        x[at.a], eta[at.u0], eta[at.y], settling = self.split.rate(nodes)
        assert at.settles or not np.any(settling)  # `split` is told which outputs are wanted
        if at.settles:
            eta[at.z1] = settling
        if roads is not None and roads.size:
            u[: self.roads] = roads[self.road_columns]
        return eta, x, u

    def acceleration(self, nodes: Matrix) -> RowBlocks:
        """The acceleration of a combination of nodes that inertia carries."""
        eta, x, u = self.blank()
        eta[self.slots.a1], eta[self.slots.u1] = self.split.rate(nodes)[:2]
        return eta, x, u

    def elongation(self, springs: Matrix) -> RowBlocks:
        """A combination of spring elongations."""
        eta, x, u = self.blank()
        x[self.slots.g], eta[self.slots.z] = springs @ self.split.G, springs @ self.split.Z_e
        return eta, x, u

    def external(self, weights: Matrix) -> RowBlocks:
        """A combination of the external forces; those that are no inputs are zero."""
        eta, x, u = self.blank()
        for force, weight in zip(self.mechanism.forces, weights, strict=False):
            if force.name in self.inputs:
                u[self.inputs.index(force.name)] += weight
        return eta, x, u

    def across(self, branch: Branch) -> RowBlocks:
        """Rows of the quantity that an element's value multiplies: its acceleration, velocity or elongation."""
        match branch.element.linear:
            case LinearRole.MASS:
                return self.acceleration(branch.nodes)
            case LinearRole.DAMPING:
                return self.velocity(branch.nodes, branch.roads)
            case LinearRole.STIFFNESS:
                alone = np.zeros(len(self.springs))
                alone[self.spring_number[id(branch)]] = 1.0
                return self.elongation(alone)
        return self.blank()

    def displacement(self, nodes: Matrix, roads: Matrix) -> Matrix | None:
        """Combination of spring elongations equal to a displacement for every motion; None if there is none."""
        springs = np.hstack([self.spring_rows, self.spring_roads])
        return combination(self.split.span, springs, np.hstack([nodes, roads[self.road_columns]]))


def split(mechanism: Mechanism, graph: Graph, inputs: Sequence[str], wanted: Sequence[str] = ()) -> Frame:
    """Frame for these inputs, roads first, and for outputs that may need the rate at which springs settle.

    Raises `MechanismError` for an inerter on the road itself, and for a node that is held by nothing.
    """
    for branch in of_law(graph, LinearRole.MASS):
        if np.any(branch.roads):
            raise MechanismError(
                f"{branch.element.key.capitalize()} {branch.label!r} is mounted on the road itself: its force "
                f"follows the road's acceleration, which does not exist for a white road velocity. Mount it "
                f"between moving parts."
            )
    columns = [i for i, road in enumerate(mechanism.roads) if road.name in inputs]
    forces = _forces(mechanism, graph, inputs[len(columns) :])
    springs = of_law(graph, LinearRole.STIFFNESS)
    spring_rows, spring_roads = incidence_rows(springs, graph)
    spring_roads = np.array([b.roads[columns] for b in springs]).reshape(len(springs), len(columns))
    found = find_coordinates(
        graph.nodes,
        inertia=inertias(mechanism, graph)[0],
        damping=incidence_rows(of_law(graph, LinearRole.DAMPING), graph)[0],
        springs=spring_rows,
        spring_roads=spring_roads,
        forces=forces,
        span=BranchRows.of(graph, columns),
    )
    known = outputs(mechanism, graph)
    asked = [known[name] for name in wanted if name in known]
    moved = [row for one in asked for row in (one.velocity, one.displacement) if row.size]
    slots = Slots.of(found, settling=any(np.any(found.rate(row)[3]) for row in moved))
    return Frame(
        mechanism, graph, tuple(inputs), found, slots, known, tuple(springs), spring_rows, spring_roads, columns, forces
    )


def _forces(mechanism: Mechanism, graph: Graph, names: Sequence[str]) -> Matrix:
    """Rows over nodes of external forces, and of forces in parallel with elements."""
    beside = {force_of(branch.label): -branch.nodes for branch in graph.branches}
    given = {force.name: row for force, row in zip(mechanism.forces, ports(mechanism, graph), strict=True)}
    rows = beside | given
    return np.array([rows[name] for name in names]).reshape(len(names), len(graph.nodes))
