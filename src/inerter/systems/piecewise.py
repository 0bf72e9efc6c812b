"""Piecewise-linear systems: what compiled code needs to know of a mechanism to simulate it in every mode.

Velocities, positions and all that follows from which elements are where is `systems.kinematics`, found once for a
layout; what a mode makes of it is `kernels.modes`.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import DesignError, MechanismError
from inerter.networks.elements import Element
from inerter.networks.elements.roles import Linear
from inerter.systems.graph import Graph, switching
from inerter.systems.kinematics import Kinematics, kinematics, with_elements
from inerter.systems.outputs import Output
from inerter.vehicle.mechanism import Mechanism, check_values
from inerter.vehicle.vehicle import Vehicle, check_vehicle

Matrix = NDArray[np.float64]
_LOST = 1e14  # ratio of inertias at which the smaller one is rounding of the larger


@dataclass(frozen=True, eq=False)
class Mechanics:
    """The constant matrices that `kernels.arrays.Mechanics` describes."""

    balance: Matrix
    rates: Matrix
    lengths: Matrix
    elements: NDArray[np.int64]
    limit: Matrix


@dataclass(frozen=True, eq=False)
class PiecewiseSystem:
    """A mechanism in the coordinates of `systems.kinematics`.

    A row over the state, the inputs and eta = (a', w, forces of the nonlinear elements) is what an output is made of.
    Inputs are the roads' z, z', z'' and the external forces, in this order.
    """

    mechanism: Mechanism
    kinematics: Kinematics
    graph: Graph
    mechanics: Mechanics
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
    needs_velocity: tuple[bool, ...]  # of each road, whether its velocity reaches an inertia at once
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

    @property
    def nonlinear_elements(self) -> tuple[Element, ...]:
        """One of each nonlinear group."""
        return tuple(self.graph.branches[next(iter(group))].element for group in self.nonlinear)


def piecewise(vehicle: Vehicle) -> PiecewiseSystem:
    """The piecewise-linear system of a vehicle or rig.

    Raises `DesignError` if a value is free, `MechanismError` if a node is held by nothing, if closing a gap would be
    an impact between inertias, or if the force of an element is not determined.
    """
    check_vehicle(vehicle)
    mechanism = vehicle.mechanism()
    free = ", ".join(mechanism.free_values())
    if free:
        raise DesignError(f"The value of {free} is still free. Fix it with with_values(...), or optimise first.")
    mechanism = switching(mechanism)
    check_values(mechanism)
    return _system(mechanism, kinematics(mechanism))


def revalued(system: PiecewiseSystem, values: Mapping[str, float]) -> PiecewiseSystem:
    """The same system with other values of some elements and coordinates' inertias, by label.

    Far quicker than `piecewise`: for those who simulate one layout thousands of times. What was zero must stay zero.
    `mechanism` has the new inertias, but its networks are the old ones; `graph` has the new elements.

    Raises `DesignError` for a label that is not there, for a value that is not a number of the old one's sign, and for
    a layout with a node between inerters alone, whose motions depend on their values.
    """
    if system.kinematics.weighs:
        raise DesignError(
            "A node is between inerters alone, so that its motion depends on values. Take piecewise(...)."
        )
    elements = {b.label: b.element for b in system.graph.branches}
    inertias = {c.name: c for c in system.mechanism.coordinates}
    for label, value in values.items():
        if label in elements:
            old, positive = elements[label].value, elements[label].value != 0.0
        elif label in inertias:
            old, positive = inertias[label].inertia, True
        else:
            listed = ", ".join([*elements, *inertias])
            raise DesignError(f"There is no element or coordinate labelled {label!r} (there are: {listed}).")
        if not is_number(value) or not (value > 0.0 if positive else value == 0.0):
            allowed = "any positive number" if positive else "nothing else"
            raise DesignError(f"The value of {label!r} is {old:g} and can become {allowed} here, got {value!r}.")
        if label in elements:
            elements[label] = elements[label].with_value(value)
        else:
            inertias[label] = replace(inertias[label], inertia=value)
    mechanism = copy(system.mechanism)  # which was checked when it was made
    object.__setattr__(mechanism, "coordinates", tuple(inertias.values()))
    known = system.kinematics
    return _system(mechanism, replace(known, graph=with_elements(known.graph, list(elements.values()))))


def _system(mechanism: Mechanism, known: Kinematics) -> PiecewiseSystem:
    graph, rates, places = known.graph, known.rates, known.places
    R, _, V = known.motions
    inerters = (b.element.coefficient for b in graph.branches if b.element.linear is Linear.MASS)
    inertia = np.array([*(c.inertia for c in mechanism.coordinates), *inerters])
    kinetic, kinetic_road = known.inertia_nodes @ R, known.inertia_roads + known.inertia_nodes @ V
    _check_inertia(kinetic, inertia)
    resistance = _weighted(graph, Linear.DAMPING, np.hstack(rates[:2]), np.hstack(rates))
    return PiecewiseSystem(
        mechanism=mechanism,
        kinematics=known,
        graph=graph,
        mechanics=_mechanics(known, resistance, kinetic, kinetic_road, inertia),
        nonlinear=tuple(_shares(graph, group) for group in known.nonlinear),
        outputs=known.outputs,
        rates=rates,
        elongations=places.elongations,
        displacements=places.displacements,
        motions=known.motions,
        kinetic=kinetic,
        kinetic_road=kinetic_road,
        inertia=inertia,
        positions=places.nodes,
        heights=places.roads,
        needs_velocity=tuple(np.any(np.abs(_felt(resistance, R.shape[1])) > 1e-9, axis=0)),
        needs_acceleration=known.needs_acceleration,
        moves_elements=known.moves_elements,
    )


def _check_inertia(kinetic: Matrix, inertia: Matrix) -> None:
    """Raises `MechanismError` if an inertia is lost beside another one that moves with it."""
    if inertia.size and inertia.max() > _LOST * inertia.min():
        M = kinetic.T @ (inertia[:, None] * kinetic)
        size = 1.0 / np.sqrt(np.diag(M))
        if np.linalg.eigvalsh(M * size * size[:, None])[0] < 1.0 / _LOST:
            raise MechanismError(
                f"Inertias from {inertia.min():g} to {inertia.max():g} kg move together, and numbers of 16 digits "
                "cannot hold both. Leave out what is so small, and join rigidly what is so heavy."
            )


def _mechanics(
    known: Kinematics, resistance: Matrix, kinetic: Matrix, kinetic_road: Matrix, inertia: Matrix
) -> Mechanics:
    """Left and right-hand sides of the balances of `kernels.modes`, and the rows of what can be locked."""
    R, N, _ = known.motions
    moving, na, nw = np.hstack(known.rates[:2]), R.shape[1], N.shape[1]
    momentum = inertia[:, None] * np.hstack([kinetic, kinetic_road])
    left = resistance[:, : na + nw].copy()
    left[:, :na] = 0.0
    left[:na, :na] = kinetic.T @ momentum[:, :na]
    right = [
        -resistance[:, :na],
        -_weighted(known.graph, Linear.STIFFNESS, moving, np.hstack(known.places.elongations)),
        -resistance[:, na + nw :],
        -np.vstack([kinetic.T @ momentum[:, na:], np.zeros((nw, kinetic_road.shape[1]))]),
        (known.ports @ np.hstack([R, N])).T,
        np.zeros((na + nw, 1)),
    ]
    return Mechanics(
        balance=np.hstack([left, *right]),
        rates=known.moving,
        lengths=known.lengths,
        elements=known.elements,
        limit=np.array([sum(known.graph.branches[i].element.coefficient for i in group) for group in known.nonlinear]),
    )


def _shares(graph: Graph, group: dict[int, int]) -> dict[int, float]:
    """What each branch of a group has of its force: frictions side by side share it by their sizes."""
    sizes = {i: graph.branches[i].element.coefficient for i in group}
    whole = sum(sizes.values())
    return {i: turned * (sizes[i] / whole if len(group) > 1 else 1.0) for i, turned in group.items()}


def _weighted(graph: Graph, law: Linear, left: Matrix, right: Matrix) -> Matrix:
    """Sum over the elements of one law of left row x coefficient x right row."""
    values = np.array([b.element.coefficient if b.element.linear is law else 0.0 for b in graph.branches])
    return np.ascontiguousarray(left.T @ (values[:, None] * right))


def _felt(damping: Matrix, na: int) -> Matrix:
    """Damping between inertias and roads once the massless motions between them have given way."""
    nv = damping.shape[0]
    if na == nv:
        return damping[:, nv:]
    return damping[:na, nv:] - damping[:na, na:nv] @ np.linalg.pinv(damping[na:, na:nv]) @ damping[na:, nv:]


def output_rows(system: PiecewiseSystem, output: Output) -> tuple[Matrix, Matrix, Matrix]:
    """An output as rows over the state, the inputs and eta."""
    roads = len(system.mechanism.roads)
    na, nw = system.motions[0].shape[1], system.motions[1].shape[1]
    on_x, on_u = np.zeros(system.order), np.zeros(system.inputs)
    on_eta = np.zeros(na + nw + len(system.nonlinear))
    z, rate, acceleration = (slice(i * roads, (i + 1) * roads) for i in range(3))
    count = len(system.mechanism.coordinates)

    def add_velocity(weights: tuple[Matrix, Matrix, Matrix]) -> None:
        on_x[:na] += weights[0]
        on_eta[na : na + nw] += weights[1]
        on_u[rate] += weights[2]

    if output.displacement.size:
        moved = output.displacement[:count]
        on_x[na:] += moved @ system.displacements[0]
        on_u[z] += moved @ system.displacements[1]
    if output.velocity.size:
        velocity = output.velocity
        add_velocity((velocity @ system.motions[0], velocity @ system.motions[1], velocity @ system.motions[2]))
    if output.acceleration.size:
        on_eta[:na] += output.acceleration @ system.motions[0]  # massless motions have no part in a coordinate's
        on_u[acceleration] += output.acceleration @ system.motions[2]
    for i in np.flatnonzero(output.forces):
        element, share = system.graph.branches[i].element, output.forces[i]
        value = share * element.coefficient
        E_a, E_w, E_z = (rows[i] for rows in system.rates)
        match element.linear:
            case Linear.STIFFNESS:
                on_x[na:] += value * system.elongations[0][i]
                on_u[z] += value * system.elongations[1][i]
            case Linear.DAMPING:
                add_velocity((value * E_a, value * E_w, value * E_z))
            case Linear.MASS:
                on_eta[:na] += value * E_a
                on_u[acceleration] += value * E_z
            case _:
                for number, group in enumerate(system.nonlinear):
                    on_eta[na + nw + number] += share * group.get(int(i), 0.0)
    if output.road.size:
        on_u[z] += output.road
    if output.road_velocity.size:
        on_u[rate] += output.road_velocity
    if output.external.size:
        on_u[3 * roads :] += output.external
    return on_x, on_u, on_eta
