"""Piecewise-linear systems: what compiled code needs to know of a mechanism to simulate it in every mode.

Node velocities v = R a + N w + V z' split into those that inertia carries (a), those that nothing but other motions
resists (w, massless), and what roads impose through inerters (V). Positions g are as many independent elongations of
gaps and springs, and displacements of coordinates, as there are. Both splits hold in every mode; what a mode makes of
them is `kernels.modes`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import UnionType

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, MechanismError
from inerter.kernels.arrays import FRICTION, GAP, KIND
from inerter.networks.elements import Damper, Element, Free, Friction, Gap, Inerter, Spring
from inerter.systems.coordinates import clean, complete, independent_rows, null_space, pseudo_inverse
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
    inertia = _inertia(mechanism, graph)
    R, N, V = motions = _velocities(mechanism, graph, inertia)
    nodes, roads = _stack(graph.branches, graph)
    rates = (nodes @ R, nodes @ N, roads + nodes @ V)
    places = _places(mechanism, graph)
    kinetic, kinetic_road = inertia.nodes @ R, inertia.roads + inertia.nodes @ V
    nonlinear = tuple(i for i, b in enumerate(graph.branches) if isinstance(b.element, Friction | Gap))
    damping = _weighted(graph, Damper, np.hstack(rates[:2]), np.hstack(rates))
    system = PiecewiseSystem(
        mechanism=mechanism,
        graph=graph,
        mechanics=_mechanics(mechanism, graph, motions, rates, places, inertia),
        nonlinear=nonlinear,
        outputs=outputs(mechanism, graph),
        rates=rates,
        elongations=places.elongations,
        displacements=places.displacements,
        motions=motions,
        kinetic=kinetic,
        kinetic_road=kinetic_road,
        inertia=inertia.values,
        positions=places.nodes,
        heights=places.roads,
        needs_velocity=tuple(np.any(np.abs(_felt(damping, R.shape[1])) > 1e-9, axis=0)),
        needs_acceleration=tuple(np.any(np.abs(kinetic_road) > 1e-12, axis=0) | _locked_to(rates, nonlinear)),
        moves_elements=tuple(_moved_by(rates, [i for i in nonlinear if _value(graph.branches[i].element) > 0.0])),
    )
    _check_locks(system)
    return system


@dataclass(frozen=True, eq=False)
class _Inertia:
    """Masses and inerters: their rows over nodes and roads, and their values."""

    nodes: Matrix
    roads: Matrix
    values: Matrix


def _inertia(mechanism: Mechanism, graph: Graph) -> _Inertia:
    inerters = [b for b in graph.branches if isinstance(b.element, Inerter)]
    nodes, roads = _stack(inerters, graph)
    masses = np.eye(len(graph.nodes))[: len(mechanism.coordinates)]
    still = np.zeros((len(masses), roads.shape[1]))
    values = np.array([*(c.inertia for c in mechanism.coordinates), *(_value(b.element) for b in inerters)])
    return _Inertia(np.vstack([masses, nodes]), np.vstack([still, roads]), values)


@dataclass(frozen=True, eq=False)
class _Places:
    """Positions as rows over nodes and roads, and what follows from them, over positions g and roads z."""

    nodes: Matrix
    roads: Matrix
    elongations: tuple[Matrix, Matrix]  # of springs and gaps, a row for each branch
    displacements: tuple[Matrix, Matrix]  # of the coordinates
    own: tuple[int, ...]  # for each branch the position that is its own elongation, or -1


def _places(mechanism: Mechanism, graph: Graph) -> _Places:
    """The first independent ones among the elongations of gaps and springs and the displacements of coordinates."""
    branches = graph.branches
    nodes, roads = _stack(branches, graph)
    placed = [i for kind in (Gap, Spring) for i, b in enumerate(branches) if isinstance(b.element, kind)]
    coordinates = np.eye(len(graph.nodes))[: len(mechanism.coordinates)]
    choices = np.vstack([nodes[placed], coordinates])
    choices_road = np.vstack([roads[placed], np.zeros((len(coordinates), roads.shape[1]))])
    chosen = independent_rows(choices)
    P, P_road = choices[chosen], choices_road[chosen]
    over_g = clean(choices @ pseudo_inverse(P)) if chosen else np.zeros((len(choices), 0))
    over_g[chosen] = np.eye(len(chosen))
    over_z = clean(choices_road - over_g @ P_road)
    e_g, e_z = np.zeros((len(branches), len(chosen))), np.zeros(roads.shape)
    e_g[placed], e_z[placed] = over_g[: len(placed)], over_z[: len(placed)]
    number = {i: chosen.index(at) for at, i in enumerate(placed) if at in chosen}
    own = tuple(number.get(i, -1) for i in range(len(branches)))
    return _Places(P, P_road, (e_g, e_z), (over_g[len(placed) :], over_z[len(placed) :]), own)


def _mechanics(
    mechanism: Mechanism,
    graph: Graph,
    motions: tuple[Matrix, Matrix, Matrix],
    rates: tuple[Matrix, Matrix, Matrix],
    places: _Places,
    inertia: _Inertia,
) -> Mechanics:
    """Left and right-hand sides of the balances of `kernels.modes`, and the rows of what can be locked."""
    branches, (R, N, V) = graph.branches, motions
    moving, na, nw = np.hstack(rates[:2]), R.shape[1], N.shape[1]
    resistance = _weighted(graph, Damper, moving, np.hstack(rates))
    kinetic, kinetic_road = inertia.nodes @ R, inertia.roads + inertia.nodes @ V
    momentum = inertia.values[:, None] * np.hstack([kinetic, kinetic_road])
    left = resistance[:, : na + nw].copy()
    left[:, :na] = 0.0
    left[:na, :na] = kinetic.T @ momentum[:, :na]
    ports = np.zeros((len(mechanism.forces), len(graph.nodes)))
    for i, force in enumerate(mechanism.forces):
        ports[i, : len(mechanism.coordinates)] = [force.port.get(c.name, 0.0) for c in mechanism.coordinates]
    right = np.hstack([
        -resistance[:, :na],
        -_weighted(graph, Spring, moving, np.hstack(places.elongations)),
        -resistance[:, na + nw :],
        -np.vstack([kinetic.T @ momentum[:, na:], np.zeros((nw, kinetic_road.shape[1]))]),
        (ports @ np.hstack([R, N])).T,
        np.zeros((na + nw, 1)),
    ])  # fmt: skip
    kinds: tuple[type[Element] | UnionType, ...] = (Friction | Gap, Damper, Spring)
    special, dampers, springs = ([i for i, b in enumerate(branches) if isinstance(b.element, k)] for k in kinds)
    positions = np.hstack([places.nodes @ R, places.nodes @ N, places.roads + places.nodes @ V])
    names = [[FRICTION if isinstance(branches[i].element, Friction) else GAP, places.own[i]] for i in special]
    return Mechanics(
        balance=np.hstack([left, right]),
        rates=_dense(np.vstack([positions, np.hstack(rates)[[*special, *dampers, *springs]]])),
        lengths=_dense(np.hstack(places.elongations)[special]),
        elements=np.array(names, dtype=np.int64).reshape(len(special), 2),
        limit=np.array([_value(branches[i].element) for i in special]),
    )


def _weighted(graph: Graph, kind: type[Element], left: Matrix, right: Matrix) -> Matrix:
    """Sum over the elements of one kind of left row x value x right row."""
    values = np.array([_value(b.element) if isinstance(b.element, kind) else 0.0 for b in graph.branches])
    return np.ascontiguousarray(left.T @ (values[:, None] * right))


def _felt(damping: Matrix, na: int) -> Matrix:
    """Damping between inertias and roads once the massless motions between them have given way."""
    nv = damping.shape[0]
    return damping[:na, nv:] - damping[:na, na:nv] @ np.linalg.pinv(damping[na:, na:nv]) @ damping[na:, nv:]


def _locked_to(rates: tuple[Matrix, Matrix, Matrix], nonlinear: tuple[int, ...]) -> NDArray[np.bool_]:
    """Roads that a friction that sticks, or a gap that touches, may tie an inertia to."""
    _, E_w, E_z = (rows[list(nonlinear)] for rows in rates)
    return np.asarray(np.any(np.abs(null_space(E_w.T).T @ E_z) > 1e-9, axis=0))


def _moved_by(rates: tuple[Matrix, Matrix, Matrix], elements: list[int]) -> NDArray[np.bool_]:
    """Roads that move one of these elements with nothing but massless motions between."""
    links, moved = (np.abs(rows) > 1e-9 for rows in rates[1:])
    for _ in range(links.shape[1]):
        moved = moved | (links @ (links.T @ moved))
    return np.asarray(np.any(moved[elements], axis=0))


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


def _velocities(mechanism: Mechanism, graph: Graph, inertia: _Inertia) -> tuple[Matrix, Matrix, Matrix]:
    """R, N and V: motions with inertia, massless motions, and what roads impose on a node between inerters alone.

    A motion that only inertia resists and nothing excites keeps its momentum of zero, so it follows the others at once.
    """
    count = len(graph.nodes)
    others = [b for b in graph.branches if not isinstance(b.element, Inerter)]
    holding = [b for b in others if not isinstance(b.element, Friction | Gap) or _holds(b.element)]
    loose = null_space(np.vstack([inertia.nodes, _stack(holding, graph)[0]]))
    if loose.shape[1]:
        node = graph.nodes[int(np.argmax(np.abs(loose[:, 0])))]
        raise MechanismError(
            f"Node {node!r} is held by nothing while the gaps beside it are open: no mass, spring, damper, inerter or "
            f"friction resists its motion. Join the gaps into one, or add what holds the part between them."
        )
    N = null_space(inertia.nodes)
    U = null_space(_stack(others, graph)[0])
    for force in mechanism.forces:
        row = np.zeros(count)
        row[: len(mechanism.coordinates)] = [force.port.get(c.name, 0.0) for c in mechanism.coordinates]
        U = U @ null_space((row @ U)[None])
    R = complete(np.hstack([U, N]), np.eye(count))
    if not U.shape[1]:
        return R, N, np.zeros((count, len(mechanism.roads)))
    momentum = U.T @ inertia.nodes.T * inertia.values
    own = momentum @ inertia.nodes @ U
    return (
        R - U @ np.linalg.solve(own, momentum @ inertia.nodes @ R),
        N,
        -U @ np.linalg.solve(own, momentum @ inertia.roads),
    )


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


def _stack(branches: Sequence[Branch], graph: Graph) -> tuple[Matrix, Matrix]:
    """Rows of some branches over nodes and over roads."""
    nodes, roads = len(graph.nodes), next((b.roads.size for b in graph.branches), 0)
    on_nodes = np.array([b.nodes for b in branches]).reshape(len(branches), nodes)
    return on_nodes, np.array([b.roads for b in branches]).reshape(len(branches), roads)


def _value(element: Element) -> float:
    value = element.value
    assert not isinstance(value, Free)
    return value


def _dense(matrix: Matrix) -> Matrix:
    return np.ascontiguousarray(clean(matrix))
