"""Piecewise-linear systems: the matrices of a mechanism from which compiled code builds every mode.

Velocities, positions and all that follows from which elements are where is `systems.kinematics`, found once for a
layout; what a mode makes of it is `kernels.modes`.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, MechanismError
from inerter.formatting import format_range
from inerter.networks.elements import Element
from inerter.networks.elements.roles import LinearRole
from inerter.systems.coordinate_split import RowBlocks
from inerter.systems.coordinates import clean, pseudo_inverse
from inerter.systems.graph import Graph, switching
from inerter.systems.kinematics import Kinematics, kinematics, with_elements
from inerter.systems.observe import add, motion
from inerter.systems.outputs import Output
from inerter.systems.structure import structure_of
from inerter.validation import is_number
from inerter.vehicle.mechanism import Mechanism, check_values
from inerter.vehicle.vehicle import Vehicle, check_fixed, check_vehicle

Matrix = NDArray[np.float64]
_KEPT, _KEPT_SYSTEMS = 128, 16  # rows of outputs, and systems
_LOST = 1e14  # ratio of inertias at which the smaller one is rounding of the larger


@dataclass(frozen=True, eq=False)
class PiecewiseSystem:
    """A mechanism in the coordinates of `systems.kinematics`.

    A row over the state, the inputs and eta = (a', w, forces of the nonlinear elements) is what an output is made of.
    Inputs are the roads' z, z', z'' and the external forces, in this order.
    """

    mechanism: Mechanism
    kinematics: Kinematics
    graph: Graph
    balance: Matrix  # and limits, see `kernels.arrays.Mechanics`
    limits: Matrix
    nonlinear: tuple[dict[int, float], ...]  # branches of friction or gaps that act as one; shares of its force
    outputs: dict[str, Output]
    rates: tuple[Matrix, Matrix, Matrix]  # of all branches, over a, w, z'
    elongations: tuple[Matrix, Matrix]  # of springs and gaps (zero for others), over g, z
    displacements: tuple[Matrix, Matrix]  # of the coordinates, over g, z
    motions: tuple[Matrix, Matrix, Matrix]  # R, N, V
    kinetic: Matrix  # (coordinates and inerters, na): velocities that carry kinetic energy, and ...
    kinetic_road: Matrix  # ... their part from z'
    inertia: Matrix  # ... with these inertias
    positions: Matrix  # (ng, nodes): positions from node displacements, and ...
    heights: Matrix  # (ng, roads): ... from those of the roads
    needs_acceleration: tuple[bool, ...]  # of each road
    moves_elements: tuple[bool, ...]  # of each road, whether friction or a gap moves with it at once

    @property
    def order(self) -> int:
        """Number of states."""
        return int(self.motions[0].shape[1] + self.positions.shape[0])

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        nodes = (*self.graph.nodes, *(b.label for b in self.graph.branches))
        named = [f"{nodes[int(np.argmax(np.abs(column) > 0.5))]}_velocity" for column in self.motions[0].T]
        return (*named, *(f"position_{i + 1}" for i in range(self.positions.shape[0])))

    @property
    def inputs(self) -> int:
        """Number of inputs of a mode."""
        return 3 * len(self.mechanism.roads) + len(self.mechanism.forces)

    @cached_property
    def needs_velocity(self) -> tuple[bool, ...]:
        """Of each road, whether its velocity reaches an inertia at once."""
        na, nv, speed = self.motions[0].shape[1], self.balance.shape[0], self.positions.shape[0]
        on_w, sides = np.split(self.balance, [nv], axis=1)
        first = na + speed + len(self.mechanism.roads)
        damping = np.hstack([-sides[:, :na], on_w[:, na:], -sides[:, first : first + len(self.mechanism.roads)]])
        return tuple(np.any(np.abs(_condensed_damping(damping, na)) > 1e-9, axis=0))

    @property
    def nonlinear_elements(self) -> tuple[Element, ...]:
        """First element of each nonlinear group."""
        return tuple(self.graph.branches[next(iter(group))].element for group in self.nonlinear)


def piecewise(vehicle: Vehicle) -> PiecewiseSystem:
    """The piecewise-linear system of a vehicle or rig.

    Raises `DesignError` if a value is free, `MechanismError` if a node is unconstrained, if closing a gap would be
    an impact between inertias, or if the force of an element is not determined.
    """
    check_vehicle(vehicle)
    mechanism = vehicle.mechanism()
    check_fixed(mechanism)
    structure = structure_of(mechanism)
    if structure is None:
        return _assemble(mechanism)
    known, system = _assemble_once(_Design((structure.key, *structure.values), mechanism))
    return system if known == mechanism else _assemble(mechanism)  # such as with other measures


@dataclass(frozen=True)
class _Design:
    """A mechanism, equal to others of the same structure and values."""

    key: tuple[Hashable, ...]
    mechanism: Mechanism = field(compare=False)


@lru_cache(maxsize=_KEPT_SYSTEMS)
def _assemble_once(design: _Design) -> tuple[Mechanism, PiecewiseSystem]:
    """A mechanism and its system, which further runs share, and with it what is kept for a system."""
    return design.mechanism, _assemble(design.mechanism)


def _assemble(mechanism: Mechanism) -> PiecewiseSystem:
    switched = switching(mechanism)
    check_values(switched)
    return _system(switched, kinematics(switched), list(switched.elements()))


def with_element_values(system: PiecewiseSystem, values: Mapping[str, float]) -> PiecewiseSystem:
    """System with other values of some elements and inertias, by label.

    Far quicker than `piecewise`: for those who simulate one layout thousands of times. What was zero must stay zero.
    `mechanism` has the new inertias, but its networks are the old ones; `graph` has the new elements.

    Raises `DesignError` for a label that is not there, for a value that is not a number of the old one's sign, and for
    a layout with a node between inerters alone, whose motions depend on their values.
    """
    if system.kinematics.weighs:
        raise DesignError(
            "A node lies between inerters alone, so that its motion depends on their values. Use piecewise(...)."
        )
    elements = {b.label: b.element for b in system.graph.branches}
    inertias = {c.name: c for c in system.mechanism.coordinates}
    for label, value in values.items():
        if label in elements:
            old, positive = elements[label].value, elements[label].value != 0.0
        elif label in inertias:
            old, positive = inertias[label].inertia, not inertias[label].is_massless
        else:
            listed = ", ".join([*elements, *inertias])
            raise DesignError(f"Unknown element or coordinate {label!r}; available: {listed}.")
        if not is_number(value) or not (value > 0.0 if positive else value == 0.0):
            allowed = "any positive number" if positive else "nothing else"
            raise DesignError(f"The value of {label!r} is {old!r} and can become {allowed} here, got {value!r}.")
        if label in elements:
            changed = elements[label].with_value(value)
            if changed.role != elements[label].role:
                raise DesignError(
                    f"With {value!r}, {label!r} changes whether it holds against small forces. Use piecewise(...)."
                )
            elements[label] = changed
        else:
            inertias[label] = replace(inertias[label], inertia=value)
    if system.mechanism.ground_moves and any(label in inertias for label in values):
        raise DesignError("Moving ground acts on every mass. Change the masses first, then use piecewise(...).")
    mechanism = copy(system.mechanism)  # which was checked when it was made
    object.__setattr__(mechanism, "coordinates", tuple(inertias.values()))
    return _system(mechanism, system.kinematics, list(elements.values()))


def _system(mechanism: Mechanism, known: Kinematics, elements: Sequence[Element]) -> PiecewiseSystem:
    graph, places = with_elements(known.graph, elements), known.places
    masses = [coordinate.coefficient for coordinate in mechanism.masses.values()]
    values = np.array([*masses, *(elements[i].coefficient for i in known.acting)])
    inertia = values[: len(known.kinetic)]
    _check_inertia(known.kinetic, inertia)
    terms, without = known.balance
    return PiecewiseSystem(
        mechanism=mechanism,
        kinematics=known,
        graph=graph,
        balance=values.dot(terms).reshape(without.shape) + without,
        limits=np.array([_limits(graph, group) for group in known.nonlinear]).reshape(-1, 2),
        nonlinear=tuple(_shares(graph, group) for group in known.nonlinear),
        outputs=known.outputs,
        rates=known.rates,
        elongations=places.elongations,
        displacements=places.displacements,
        motions=known.motions,
        kinetic=known.kinetic,
        kinetic_road=known.kinetic_road,
        inertia=inertia,
        positions=places.nodes,
        heights=places.roads,
        needs_acceleration=known.needs_acceleration,
        moves_elements=known.moves_elements,
    )


def _check_inertia(kinetic: Matrix, inertia: Matrix) -> None:
    """Raises `MechanismError` if an inertia is lost to rounding against another one that moves with it."""
    sizes = inertia.tolist()
    if sizes and max(sizes) > _LOST * min(sizes):
        M = kinetic.T @ (inertia[:, None] * kinetic)
        size = 1.0 / np.sqrt(np.diag(M))
        if np.linalg.eigvalsh(M * size * size[:, None])[0] < 1.0 / _LOST:
            raise MechanismError(
                f"Inertias from {format_range(inertia.min(), inertia.max(), 'kg', 6)} move together, and numbers of 16 "
                f"digits cannot resolve both. Leave out the smallest, or join the heaviest rigidly."
            )


def _shares(graph: Graph, group: dict[int, int]) -> dict[int, float]:
    """Share of the force of a group for each of its branches; frictions in parallel share it by their sizes."""
    sizes = {i: graph.branches[i].element.coefficient for i in group}
    whole = sum(sizes.values())
    return {i: turned * (sizes[i] / whole if len(group) > 1 else 1.0) for i, turned in group.items()}


def _limits(graph: Graph, group: dict[int, int]) -> list[float]:
    """Limits of the force or elongation in the middle state of a group; sums over its elements."""
    return [sum(ends) for ends in zip(*(graph.branches[i].element.checked_limits() for i in group), strict=True)]


def _condensed_damping(damping: Matrix, na: int) -> Matrix:
    """Damping between inertias and roads, with the massless motions between them eliminated."""
    nv = damping.shape[0]
    if na == nv or not damping[na:, nv:].any():  # no massless motion is damped against a road
        return damping[:na, nv:]
    return damping[:na, nv:] - damping[:na, na:nv] @ np.linalg.pinv(damping[na:, na:nv]) @ damping[na:, nv:]


@dataclass(frozen=True, eq=False)
class _Frame:
    """The coordinates of a piecewise system, as rows over eta, the state and the inputs."""

    system: PiecewiseSystem

    def blank(self) -> RowBlocks:
        """Rows of zeros."""
        R, N, _ = self.system.motions
        eta = R.shape[1] + N.shape[1] + len(self.system.nonlinear)
        return np.zeros(eta), np.zeros(self.system.order), np.zeros(self.system.inputs)

    def velocity(self, nodes: Matrix, roads: Matrix | None = None) -> RowBlocks:
        """The velocity of a combination of nodes and roads."""
        R, N, V = self.system.motions
        return self._moving((nodes @ R, nodes @ N, nodes @ V if roads is None or not roads.size else nodes @ V + roads))

    def acceleration(self, nodes: Matrix) -> RowBlocks:
        """The acceleration of a combination of nodes that inertia carries."""
        R, _, V = self.system.motions
        return self._accelerating(nodes @ R, nodes @ V)

    def external(self, weights: Matrix) -> RowBlocks:
        """A combination of the external forces."""
        eta, x, u = self.blank()
        u[3 * len(self.system.mechanism.roads) :] = weights
        return eta, x, u

    def displacement(self, over_g: Matrix, over_z: Matrix) -> RowBlocks:
        """Rows of a displacement from those over positions and over heights of roads."""
        eta, x, u = self.blank()
        x[self.system.motions[0].shape[1] :], u[self._roads(0)] = over_g, over_z
        return eta, x, u

    def force(self, i: int) -> RowBlocks:
        """The force of a branch."""
        element, rates = self.system.graph.branches[i].element, [rows[i] for rows in self.system.rates]
        value = element.coefficient
        match element.linear:
            case LinearRole.STIFFNESS:
                return self.displacement(*(value * rows[i] for rows in self.system.elongations))
            case LinearRole.DAMPING:
                return self._moving((value * rates[0], value * rates[1], value * rates[2]))
            case LinearRole.MASS:
                return self._accelerating(value * rates[0], value * rates[2])
        eta, x, u = self.blank()
        eta[eta.size - len(self.system.nonlinear) :] = [group.get(i, 0.0) for group in self.system.nonlinear]
        return eta, x, u

    def _moving(self, rates: tuple[Matrix, Matrix, Matrix]) -> RowBlocks:
        eta, x, u = self.blank()
        na = rates[0].size
        x[:na], eta[na : na + rates[1].size], u[self._roads(1)] = rates
        return eta, x, u

    def _accelerating(self, over_a: Matrix, over_z: Matrix) -> RowBlocks:
        eta, x, u = self.blank()
        eta[: over_a.size], u[self._roads(2)] = over_a, over_z
        return eta, x, u

    def _roads(self, derivative: int) -> slice:
        roads = len(self.system.mechanism.roads)
        return slice(derivative * roads, (derivative + 1) * roads)


@lru_cache(maxsize=_KEPT)
def output_rows(system: PiecewiseSystem, output: Output) -> tuple[Matrix, Matrix, Matrix]:
    """An output as rows over the state, the inputs and eta, not to be written to; kept for further runs."""
    frame, count = _Frame(system), len(system.mechanism.coordinates)
    rows = motion(frame, output, len(system.graph.nodes))
    if output.displacement.size or output.road.size:
        over_g, over_z = _displacement_rows(
            system, output.displacement if output.displacement.size else np.zeros(count)
        )
        add(rows, frame.displacement(over_g, over_z + output.road if output.road.size else over_z))
    for i in np.flatnonzero(output.forces):
        add(rows, [output.forces[i] * row for row in frame.force(int(i))])
    on_eta, on_x, on_u = rows
    for row in rows:
        row.setflags(write=False)
    return on_x, on_u, on_eta


def _displacement_rows(system: PiecewiseSystem, nodes: Matrix) -> tuple[Matrix, Matrix]:
    """Rows of a displacement over positions and over heights of roads, for massless nodes too."""
    count = len(system.mechanism.coordinates)
    if not np.any(nodes[count:]):
        over_g, over_z = (nodes[:count] @ part for part in system.displacements)
        return over_g, over_z
    over_g = clean(nodes @ pseudo_inverse(system.positions))
    return over_g, clean(-over_g @ system.heights)
