"""Piecewise-linear systems: what compiled code needs to know of a mechanism to simulate it in every mode.

Node velocities v = R a + N w + V z' split into those that inertia carries (a), those that nothing but other motions
resists (w, massless), and what roads impose through inerters (V). Positions g are as many independent elongations of
gaps and springs, and displacements of coordinates, as there are. Both splits hold in every mode; what a mode makes of
them is `kernels.modes`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, MechanismError
from inerter.kernels.arrays import FRICTION, GAP, KIND
from inerter.networks.elements import Damper, Element, Free, Friction, Gap, Inerter, Spring
from inerter.systems.coordinates import clean, complete, independent_rows, null_space
from inerter.systems.graph import Branch, Graph, full_graph
from inerter.systems.outputs import Output, outputs
from inerter.vehicle.cars import Vehicle, check_vehicle
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


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
    """A mechanism in the coordinates of the module's docstring.

    A row over the state, the inputs and eta = (a', w, forces of the nonlinear elements) is what an output is made of.
    Inputs are the roads' z, z', z'' and the external forces, in this order.
    """

    mechanism: Mechanism
    graph: Graph
    mechanics: Mechanics
    nonlinear: tuple[int, ...]  # branches that are friction or gaps
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
    def elements(self) -> tuple[str, ...]:
        """Labels of the nonlinear elements."""
        return tuple(self.graph.branches[i].label for i in self.nonlinear)


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
    graph = full_graph(mechanism)
    count, roads = len(graph.nodes), len(mechanism.roads)
    masses = [
        Branch(Inerter(c.inertia), c.name, row, np.zeros(roads))
        for c, row in zip(mechanism.coordinates, np.eye(count), strict=False)
    ]
    branches = graph.branches
    nonlinear = tuple(i for i, b in enumerate(branches) if isinstance(b.element, Friction | Gap))
    R, N, V = _velocities(mechanism, graph, masses)
    rows = _stack(branches, count, roads)
    E_a, E_w, E_z = rows[0] @ R, rows[0] @ N, rows[1] + rows[0] @ V
    placed = [i for i, b in enumerate(branches) if isinstance(b.element, Gap)]
    placed += [i for i, b in enumerate(branches) if isinstance(b.element, Spring)]
    coordinates = np.eye(count)[: len(mechanism.coordinates)]
    choices = np.vstack([rows[0][placed], coordinates])
    choices_road = np.vstack([rows[1][placed], np.zeros((len(coordinates), roads))])
    chosen = independent_rows(choices)
    P, P_road = choices[chosen], choices_road[chosen]
    over_g = clean(choices @ np.linalg.pinv(P)) if chosen else np.zeros((len(choices), 0))
    over_g[chosen] = np.eye(len(chosen))
    over_z = clean(choices_road - over_g @ P_road)
    e_g, e_z = np.zeros((len(branches), len(chosen))), np.zeros((len(branches), roads))
    e_g[placed], e_z[placed] = over_g[: len(placed)], over_z[: len(placed)]

    def weighted(kind: type[Element], left: Matrix, right: Matrix) -> Matrix:
        value = np.array([_value(b.element) if isinstance(b.element, kind) else 0.0 for b in branches])
        return np.ascontiguousarray(left.T @ (value[:, None] * right))

    inertial = [*masses, *(b for b in branches if isinstance(b.element, Inerter))]
    inertia = np.array([_value(b.element) for b in inertial])
    nodes, of_roads = _stack(inertial, count, roads)
    kinetic, kinetic_road = nodes @ R, of_roads + nodes @ V
    force_rows = np.zeros((len(mechanism.forces), count))
    for i, force in enumerate(mechanism.forces):
        force_rows[i, : len(coordinates)] = [force.port.get(c.name, 0.0) for c in mechanism.coordinates]
    special = list(nonlinear)
    kinds = [FRICTION if isinstance(branches[i].element, Friction) else GAP for i in special]
    dampers = [i for i, b in enumerate(branches) if isinstance(b.element, Damper)]
    springs = [i for i, b in enumerate(branches) if isinstance(b.element, Spring)]
    own = [chosen.index(placed.index(i)) if i in placed and placed.index(i) in chosen else -1 for i in special]
    M, M_z = kinetic.T @ (inertia[:, None] * kinetic), kinetic.T @ (inertia[:, None] * kinetic_road)
    motions = np.hstack([E_a, E_w])
    resistance = weighted(Damper, motions, motions)
    na, nw = R.shape[1], N.shape[1]
    left = resistance.copy()
    left[:, :na] = 0.0
    left[:na, :na] = M
    right = np.hstack([
        -resistance[:, :na],
        -weighted(Spring, motions, e_g),
        -weighted(Spring, motions, e_z),
        -weighted(Damper, motions, E_z),
        -np.vstack([M_z, np.zeros((nw, roads))]),
        (force_rows @ np.hstack([R, N])).T,
        np.zeros((na + nw, 1)),
    ])  # fmt: skip
    mechanics = Mechanics(
        balance=np.hstack([left, right]),
        rates=_dense(
            np.vstack(
                [
                    np.hstack([P @ R, P @ N, P_road + P @ V]),
                    np.hstack([E_a, E_w, E_z])[[*special, *dampers, *springs]],
                ]
            )
        ),
        lengths=_dense(np.hstack([e_g, e_z])[special]),
        elements=np.array([kinds, own], dtype=np.int64).T.copy(),
        limit=np.array([_value(branches[i].element) for i in special]),
    )
    system = PiecewiseSystem(
        mechanism=mechanism,
        graph=graph,
        mechanics=mechanics,
        nonlinear=nonlinear,
        outputs=outputs(mechanism, graph),
        rates=(E_a, E_w, E_z),
        elongations=(e_g, e_z),
        displacements=(over_g[len(placed) :], over_z[len(placed) :]),
        motions=(R, N, V),
        kinetic=kinetic,
        kinetic_road=kinetic_road,
        inertia=inertia,
        positions=P,
        heights=P_road,
        needs_velocity=tuple(np.any(np.abs(_felt(resistance, weighted(Damper, motions, E_z), na)) > 1e-9, axis=0)),
        needs_acceleration=tuple(np.any(np.abs(kinetic_road) > 1e-12, axis=0) | _locked_to(E_a, E_w, E_z, special)),
    )
    _check_locks(system)
    return system


def _felt(resistance: Matrix, by_road: Matrix, na: int) -> Matrix:
    """Damping between inertias and roads once the massless motions between them have given way."""
    return by_road[:na] - resistance[:na, na:] @ np.linalg.pinv(resistance[na:, na:]) @ by_road[na:]


def _locked_to(E_a: Matrix, E_w: Matrix, E_z: Matrix, special: list[int]) -> NDArray[np.bool_]:
    """Roads that a friction that sticks, or a gap that touches, may tie an inertia to."""
    together = null_space(E_w[special].T).T
    return np.asarray(np.any(np.abs(together @ E_z[special]) > 1e-9, axis=0))


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
        value = share * _value(element)
        E_a, E_w, E_z = (rows[i] for rows in system.rates)
        match element:
            case Spring():
                on_x[na:] += value * system.elongations[0][i]
                on_u[z] += value * system.elongations[1][i]
            case Damper():
                add_velocity((value * E_a, value * E_w, value * E_z))
            case Inerter():
                on_eta[:na] += value * E_a
                on_u[acceleration] += value * E_z
            case _:
                on_eta[na + nw + system.nonlinear.index(int(i))] += share
    if output.road.size:
        on_u[z] += output.road
    if output.road_velocity.size:
        on_u[rate] += output.road_velocity
    if output.external.size:
        on_u[3 * roads :] += output.external
    return on_x, on_u, on_eta


def _velocities(mechanism: Mechanism, graph: Graph, masses: list[Branch]) -> tuple[Matrix, Matrix, Matrix]:
    """R, N and V: motions with inertia, massless motions, and what roads impose on a node between inerters alone.

    A motion that only inertia resists and nothing excites keeps its momentum of zero, so it follows the others at once.
    """
    count, roads = len(graph.nodes), len(mechanism.roads)
    inertial = [*masses, *(b for b in graph.branches if isinstance(b.element, Inerter))]
    nodes, of_roads = _stack(inertial, count, roads)
    others = [b for b in graph.branches if not isinstance(b.element, Inerter)]
    holding = [b for b in others if not isinstance(b.element, Friction | Gap) or _holds(b.element)]
    loose = null_space(np.vstack([nodes, _stack(holding, count, roads)[0]]))
    if loose.shape[1]:
        node = graph.nodes[int(np.argmax(np.abs(loose[:, 0])))]
        raise MechanismError(
            f"Node {node!r} is held by nothing while the gaps beside it are open: no mass, spring, damper, inerter or "
            f"friction resists its motion. Join the gaps into one, or add what holds the part between them."
        )
    N = null_space(nodes)
    U = null_space(_stack(others, count, roads)[0])
    for force in mechanism.forces:
        row = np.zeros(count)
        row[: len(mechanism.coordinates)] = [force.port.get(c.name, 0.0) for c in mechanism.coordinates]
        U = U @ null_space((row @ U)[None])
    R = complete(np.hstack([U, N]), np.eye(count))
    value = np.array([_value(b.element) for b in inertial])
    M, M_z = nodes.T @ (value[:, None] * nodes), nodes.T @ (value[:, None] * of_roads)
    if not U.shape[1]:
        return R, N, np.zeros((count, roads))
    own = U.T @ M @ U
    return R - U @ np.linalg.solve(own, U.T @ M @ R), N, -U @ np.linalg.solve(own, U.T @ M_z)


def _holds(element: Element) -> bool:
    """Whether a friction always holds, or a gap is always closed."""
    value = _value(element)
    return value > 0.0 if isinstance(element, Friction) else value == 0.0


def _check_locks(system: PiecewiseSystem) -> None:
    """Raises `MechanismError` if closing gaps would stop an inertia at once, or if a lock's force is not determined."""
    mechanics, labels = system.mechanics, system.elements
    na, nw = system.motions[0].shape[1], system.motions[1].shape[1]
    ng, k = system.positions.shape[0], len(system.nonlinear)
    H_a, H_w, H_z = np.split(mechanics.rates[ng : ng + k], [na, na + nw], axis=1)
    gaps = [i for i, kind in enumerate(mechanics.elements[:, KIND]) if kind == GAP]
    for together in null_space(H_w[gaps].T).T:
        named = [i for i, share in zip(gaps, together, strict=True) if abs(share) > 1e-9]
        across = together @ np.hstack([H_a, H_z])[gaps]
        if np.any(np.abs(across) > 1e-9) and any(mechanics.limit[i] > 0.0 for i in named):
            which = " and ".join(repr(labels[i]) for i in named)
            raise MechanismError(
                f"Gap {which} has inertia (or a given motion) on both sides and no compliance: closing it would be an "
                f"impact. Put the spring or damper of the real part in series with it."
            )
    for together in null_space(np.hstack([H_w, H_a]).T).T:
        if np.any(np.abs(together @ H_z) > 1e-9):
            which = " and ".join(repr(labels[i]) for i, share in enumerate(together) if abs(share) > 1e-9)
            raise MechanismError(
                f"The force of {which} is not determined when it does not slip: nothing between given motions gives "
                f"way. Put the spring of the real part (such as a shaft) in series with it."
            )


def _stack(branches: list[Branch] | tuple[Branch, ...], nodes: int, roads: int) -> tuple[Matrix, Matrix]:
    on_nodes = np.array([b.nodes for b in branches]).reshape(len(branches), nodes)
    return on_nodes, np.array([b.roads for b in branches]).reshape(len(branches), roads)


def _value(element: Element) -> float:
    value = element.value
    assert not isinstance(value, Free)
    return value


def _dense(matrix: Matrix) -> Matrix:
    return np.ascontiguousarray(clean(matrix))
