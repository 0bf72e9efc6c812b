"""Kinematics of a mechanism, determined by its topology and by which element values are zero.

Node velocities v = R a + N w + V z' split into those that inertia carries (a), those that nothing but other motions
resists (w, massless), and what roads impose through inerters (V). Positions g are as many independent elongations of
gaps and springs, and displacements of coordinates, as there are. It is found once for all designs of a layout.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import MechanismError
from inerter.kernels.arrays import FRICTION, GAP
from inerter.networks.elements import CombinedNetwork, Element, Network
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.networks.free_network import check_chosen
from inerter.systems.coordinates import clean, complete, null_space, pseudo_inverse
from inerter.systems.graph import Branch, Graph, full_graph
from inerter.systems.incidence import incidence_rows, inertia_values, inertias, ports
from inerter.systems.lever_arms import RANK_TOLERANCE, independent_rows, is_lost, lost_travel_message
from inerter.systems.outputs import Output, outputs
from inerter.vehicle.mechanism import Mechanism, Strut

Matrix = NDArray[np.float64]
Rows = tuple[Matrix, Matrix]  # of dampers and of springs
_UNCERTAIN = 1e-12  # of a travel that rounding takes, from which on other positions are chosen
_NUMBER = {GuardRole.FORCE: FRICTION, GuardRole.ELONGATION: GAP}  # that the kernels have for it


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The graph and the constant matrices of a layout.

    Rates are of all branches, over a, w, z'; `moving` are those of positions and of what the kernels look at.
    """

    graph: Graph
    outputs: dict[str, Output]
    motions: tuple[Matrix, Matrix, Matrix]  # R, N, V
    rates: tuple[Matrix, Matrix, Matrix]
    places: Positions
    moving: Matrix
    lengths: Matrix
    elements: NDArray[np.int64]
    ports: Matrix  # of the external forces, over nodes
    kinetic: Matrix  # (coordinates and inerters, na): velocities that carry kinetic energy, and ...
    kinetic_road: Matrix  # ... their part from z'
    acting: tuple[int, ...]  # branches of inerters, dampers and springs
    balance: tuple[Matrix, Matrix]  # see `_balance_terms`
    nonlinear: tuple[dict[int, int], ...]  # branches that act as one, and their direction in it
    needs_acceleration: tuple[bool, ...]
    moves_elements: tuple[bool, ...]
    weighs: bool  # whether R and V depend on values of inertia, as where a node is between two inerters alone

    @cached_property
    def own_elongations(self) -> NDArray[np.int64]:
        """For each branch the position that is its own elongation, or -1."""
        return np.array(self.places.own, dtype=np.int64)

    @cached_property
    def are_elongations(self) -> bool:
        """Whether every position is the elongation of an element."""
        return bool(np.count_nonzero(self.own_elongations >= 0) == self.places.nodes.shape[0])


@dataclass(frozen=True)
class _Layout:
    """A mechanism, equal to others of the same layout."""

    shape: tuple[Any, ...]
    mechanism: Mechanism = field(compare=False)


def kinematics(mechanism: Mechanism) -> Kinematics:
    """The kinematics of a mechanism without free values; its graph may have the elements of another of its layout.

    Raises `MechanismError` as `piecewise` does.
    """
    layout = _Layout(_shape_of(mechanism), mechanism)
    known = _cached_analysis(layout)
    return _analyse_layout(layout) if known.weighs else known


def with_elements(graph: Graph, elements: Sequence[Element]) -> Graph:
    """Graph with other elements on its branches."""
    pairs = zip(elements, graph.branches, strict=True)
    return replace(graph, branches=tuple(Branch(element, b.label, b.nodes, b.roads) for element, b in pairs))


def _shape_of(mechanism: Mechanism) -> tuple[Any, ...]:
    """Key of all properties of a mechanism on which its kinematics depend."""
    mounts = []
    for mount in mechanism.mounts():
        ends = (mount.upper, mount.lower) if isinstance(mount, Strut) else (mount.port, {mount.road: None})
        network = _network_shape(check_chosen(mount.network))
        mounts.append((type(mount), mount.name, network, *(tuple(end.items()) for end in ends)))
    return (
        tuple((c.name, c.angle, c.is_massless) for c in mechanism.coordinates),
        tuple(mounts),
        tuple(road.name for road in mechanism.roads),
        tuple((force.name, tuple(force.port.items())) for force in mechanism.forces),
        tuple((point.name, tuple(point.port.items()), point.angle) for point in mechanism.points),
        mechanism.ground_moves,
    )


def _network_shape(network: Network) -> tuple[Any, ...]:
    if isinstance(network, Element):
        return type(network), network.name, network.role if network.switch else None
    assert isinstance(network, CombinedNetwork)
    return (type(network), network.name, *map(_network_shape, network.parts))


def _analyse_layout(layout: _Layout) -> Kinematics:
    mechanism = layout.mechanism
    graph = full_graph(mechanism)
    branches = graph.branches
    inertia = _Inertia(*inertias(mechanism, graph), inertia_values(mechanism, graph))
    pushed = ports(mechanism, graph)
    *motions, weighs = _velocities(graph, inertia, pushed, len(mechanism.roads))
    R, N, V = motions
    nodes, roads = incidence_rows(branches, graph)
    rates = (nodes @ R, nodes @ N, roads + nodes @ V)
    places = _places(mechanism, graph)
    together = _together(branches)
    special = [next(iter(group)) for group in together]
    laws = (LinearRole.DAMPING, LinearRole.STIFFNESS)
    dampers, springs = ([i for i, b in enumerate(branches) if b.element.linear is law] for law in laws)
    positions = np.hstack([places.nodes @ R, places.nodes @ N, places.roads + places.nodes @ V])
    kinetic, kinetic_road = inertia.nodes @ R, inertia.roads + inertia.nodes @ V
    inerters = [i for i, b in enumerate(branches) if b.element.linear is LinearRole.MASS]
    moving, along, elongations = (
        (rows[dampers], rows[springs])
        for rows in (np.hstack(rates[:2]), np.hstack(rates), np.hstack(places.elongations))
    )
    switches = [(branches[i].element.switch, places.own[i]) for i in special]
    names = [[_NUMBER[switch.guard], own] for switch, own in switches if switch is not None]
    jolted = np.any(np.abs(kinetic_road) > 1e-12, axis=0)
    found = Kinematics(
        graph=graph,
        outputs=outputs(mechanism, graph),
        motions=(R, N, V),
        rates=rates,
        places=places,
        moving=_dense(np.vstack([positions, np.hstack(rates)[[*special, *dampers, *springs]]])),
        lengths=_dense(np.hstack(places.elongations)[special]),
        elements=np.array(names, dtype=np.int64).reshape(len(special), 2),
        ports=pushed,
        kinetic=kinetic,
        kinetic_road=kinetic_road,
        acting=(*inerters, *dampers, *springs),
        balance=_balance_terms((kinetic, kinetic_road), moving, along, elongations, (pushed @ np.hstack([R, N])).T),
        nonlinear=together,
        needs_acceleration=tuple(jolted | _locked_to(rates, special)),
        moves_elements=tuple(_moved_by(rates, [i for i in special if branches[i].element.acts])),
        weighs=weighs,
    )
    _check_locks(found)
    return found


def _balance_terms(
    kinetic: tuple[Matrix, Matrix], moving: Rows, rates: Rows, elongations: Rows, pushed: Matrix
) -> tuple[Matrix, Matrix]:
    """The balances of `kernels.modes`, without their forces of nonlinear elements, as a sum over values.

    What each inertia, damper and spring adds, (values, nv * columns), and what is there without any, (nv, columns).
    Columns are those of M and C_w, then of the right-hand sides: a, g and z, z', z'', forces, 1.
    """
    na, nv, nr = kinetic[0].shape[1], moving[0].shape[1], kinetic[1].shape[1]
    ends = np.cumsum([nv, na, elongations[0].shape[1], nr, nr, pushed.shape[1], 1])
    on_a, on_gz, on_speed, on_acceleration, on_force, _ = (slice(*pair) for pair in pairwise(ends))
    counts = np.cumsum([0, len(kinetic[0]), len(moving[0]), len(moving[1])])
    inertias, dampers, springs = (slice(*pair) for pair in pairwise(counts))
    terms, without = np.zeros((counts[-1], nv, ends[-1])), np.zeros((nv, ends[-1]))
    terms[inertias, :na, :na] = _products(kinetic[0], kinetic[0])
    terms[inertias, :na, on_acceleration] = -_products(*kinetic)
    resistance = _products(moving[0], rates[0])
    terms[dampers, :, na:nv] = resistance[:, :, na:nv]
    terms[dampers, :, on_a], terms[dampers, :, on_speed] = -resistance[:, :, :na], -resistance[:, :, nv:]
    terms[springs, :, on_gz] = -_products(moving[1], elongations[1])
    without[:, on_force] = pushed
    return terms.reshape(counts[-1], without.size), without


def _products(left: Matrix, right: Matrix) -> Matrix:
    """Product of each left row, as a column, and each right row."""
    return np.asarray(left[:, :, None] * right[:, None, :])


_cached_analysis = lru_cache(maxsize=256)(_analyse_layout)


def _together(branches: Sequence[Branch]) -> tuple[dict[int, int], ...]:
    """Groups of frictions and gaps: frictions with the same ends together, with 1 or -1 for their orientation."""
    groups: list[dict[int, int]] = []
    for i, branch in enumerate(branches):
        if branch.element.switch is not None:
            turned = [_relative_orientation(branches[next(iter(group))], branch) for group in groups]
            if any(turned):
                at = int(np.flatnonzero(turned)[0])
                groups[at][i] = turned[at]
            else:
                groups.append({i: 1})
    return tuple(groups)


def _relative_orientation(first: Branch, other: Branch) -> int:
    """1 or -1 if two even frictions that hold are between the same ends, in the same order or the other one; else 0."""
    if not all(b.element.switches_by(GuardRole.FORCE) and b.element.acts and b.element.even for b in (first, other)):
        return 0
    row, beside = (np.concatenate([b.nodes, b.roads]) for b in (first, other))
    return next((turn for turn in (1, -1) if np.allclose(turn * row, beside, rtol=RANK_TOLERANCE, atol=0.0)), 0)


@dataclass(frozen=True, eq=False)
class _Inertia:
    """Masses and inerters: their rows over nodes and roads, and their values."""

    nodes: Matrix
    roads: Matrix
    values: Matrix


@dataclass(frozen=True, eq=False)
class Positions:
    """Positions as rows over nodes and roads, and what follows from them, over positions g and roads z."""

    nodes: Matrix
    roads: Matrix
    elongations: tuple[Matrix, Matrix]  # of springs and gaps, a row for each branch
    displacements: tuple[Matrix, Matrix]  # of the coordinates
    own: tuple[int, ...]  # for each branch the position that is its own elongation, or -1


def _places(mechanism: Mechanism, graph: Graph) -> Positions:
    """The first independent ones among the elongations of gaps and springs and the displacements of coordinates.

    Where springs nearly depend on each other, displacements come before them: in these they are no small differences.
    """
    branches = graph.branches
    nodes, roads = incidence_rows(branches, graph)
    gaps = [i for i, b in enumerate(branches) if b.element.switches_by(GuardRole.ELONGATION)]
    placed = gaps + [i for i, b in enumerate(branches) if b.element.linear is LinearRole.STIFFNESS]
    coordinates = np.eye(len(graph.nodes))[: len(mechanism.coordinates)]
    choices = np.vstack([nodes[placed], coordinates])
    choices_road = np.vstack([roads[placed], np.zeros((len(coordinates), roads.shape[1]))])
    chosen, over_g = _select_rows(choices, list(range(len(choices))))
    if is_lost(over_g, choices[chosen], _UNCERTAIN):
        springs, last = range(len(gaps), len(placed)), range(len(placed), len(choices))
        chosen, over_g = _select_rows(choices, [*range(len(gaps)), *last, *springs])
        if is_lost(over_g, choices[chosen]):
            raise MechanismError(lost_travel_message(over_g, [*(branches[i].label for i in placed), *graph.nodes]))
    P, P_road = choices[chosen], choices_road[chosen]
    over_g[chosen] = np.eye(len(chosen))
    over_z = clean(choices_road - over_g @ P_road)
    e_g, e_z = np.zeros((len(branches), len(chosen))), np.zeros(roads.shape)
    e_g[placed], e_z[placed] = over_g[: len(placed)], over_z[: len(placed)]
    number = {i: chosen.index(at) for at, i in enumerate(placed) if at in chosen}
    own = tuple(number.get(i, -1) for i in range(len(branches)))
    return Positions(P, P_road, (e_g, e_z), (over_g[len(placed) :], over_z[len(placed) :]), own)


def _select_rows(rows: Matrix, order: Sequence[int]) -> tuple[list[int], Matrix]:
    """Numbers of the first independent rows in an order, and the shares of these in all rows."""
    chosen = [order[i] for i in independent_rows(rows[order])]
    return chosen, clean(rows @ pseudo_inverse(rows[chosen])) if chosen else np.zeros((len(rows), 0))


def _locked_to(rates: tuple[Matrix, Matrix, Matrix], nonlinear: list[int]) -> NDArray[np.bool_]:
    """Roads that a friction that sticks, or a gap that touches, may tie an inertia to."""
    _, E_w, E_z = (rows[nonlinear] for rows in rates)
    return np.asarray(np.any(np.abs(null_space(E_w.T).T @ E_z) > 1e-9, axis=0))


def _moved_by(rates: tuple[Matrix, Matrix, Matrix], elements: list[int]) -> NDArray[np.bool_]:
    """Roads that move one of these elements with nothing but massless motions between."""
    links, moved = (np.abs(rows) > 1e-9 for rows in rates[1:])
    for _ in range(links.shape[1]):
        moved = moved | (links @ (links.T @ moved))
    return np.asarray(np.any(moved[elements], axis=0))


def _velocities(graph: Graph, inertia: _Inertia, pushed: Matrix, roads: int) -> tuple[Matrix, Matrix, Matrix, bool]:
    """R, N and V: motions with inertia, massless motions, and what roads impose on a node between inerters alone.

    A motion that only inertia resists and nothing excites keeps its momentum of zero, so it follows the others at once.
    Whether there is one, so that R and V depend on values, is told last.
    """
    count = len(graph.nodes)
    others = [b for b in graph.branches if b.element.linear is not LinearRole.MASS]
    holding = [b for b in others if b.element.switch is None or b.element.always_holds]
    loose = null_space(np.vstack([inertia.nodes, incidence_rows(holding, graph)[0]]))
    if loose.shape[1]:
        node = graph.nodes[int(np.argmax(np.abs(loose[:, 0])))]
        raise MechanismError(
            f"Node {node!r} is unconstrained while the adjacent gaps are open: no mass, spring, damper, inerter or "
            "friction resists its motion. Join the gaps into one, or add an element that acts on the part between "
            "them."
        )
    N = null_space(inertia.nodes)
    U = null_space(incidence_rows(others, graph)[0])
    for row in pushed:
        U = U @ null_space((row @ U)[None])
    R = complete(np.hstack([U, N]), np.eye(count))
    if not U.shape[1]:
        return R, N, np.zeros((count, roads)), False
    momentum = U.T @ inertia.nodes.T * inertia.values
    own = momentum @ inertia.nodes @ U
    return (
        R - U @ np.linalg.solve(own, momentum @ inertia.nodes @ R),
        N,
        -U @ np.linalg.solve(own, momentum @ inertia.roads),
        True,
    )


def _check_locks(found: Kinematics) -> None:
    """Raises `MechanismError` if closing gaps would stop an inertia at once, or if a lock's force is not determined."""
    na, nw = found.motions[0].shape[1], found.motions[1].shape[1]
    ng, k = found.places.nodes.shape[0], len(found.nonlinear)
    special = [found.graph.branches[next(iter(group))] for group in found.nonlinear]
    labels = [branch.label for branch in special]
    H_a, H_w, H_z = np.split(found.moving[ng : ng + k], [na, na + nw], axis=1)
    gaps = [i for i, branch in enumerate(special) if branch.element.switches_by(GuardRole.ELONGATION)]
    for together in null_space(H_w[gaps].T).T:
        named = [i for i, share in zip(gaps, together, strict=True) if abs(share) > 1e-9]
        across = together @ np.hstack([H_a, H_z])[gaps]
        if np.any(np.abs(across) > 1e-9) and any(special[i].element.acts for i in named):
            which = " and ".join(repr(labels[i]) for i in named)
            raise MechanismError(
                f"Gap {which} has inertia (or a given motion) on both sides and no compliance: closing it would be an "
                f"impact. Put the spring or damper of the real part in series with it."
            )
    for together in null_space(np.hstack([H_w, H_a]).T).T:
        if np.any(np.abs(together @ H_z) > 1e-9):
            which = " and ".join(repr(labels[i]) for i, share in enumerate(together) if abs(share) > 1e-9)
            raise MechanismError(
                f"The force of {which} is not determined when it does not slip: nothing between given motions is "
                f"compliant. Put the spring of the real part (such as a shaft) in series with it."
            )


def _dense(matrix: Matrix) -> Matrix:
    return np.ascontiguousarray(clean(matrix))
