"""Time stepping: an integrator without modes and events, to check the one that has them.

The step is Moreau and Jean's with theta = 1/2. Unknown are the mean velocities w of all nodes over a step h, massless
nodes included: displacements grow by h w and momenta p (of masses and inerters) become 2 (M w + B dz/h) - p, for
inerters that B couples to the roads z. Springs act with the mean of their forces at both ends of the step, dampers with
that of the mean velocity. Frictions and contacts are implicit, with one force for the step:

    a gap's elongation at the end of the step is within its bounds, and its force in the normal cone there;
    a friction's force is in size x Sgn(rate). The rate is that at the end of the step where inertia carries it, so
    that a body comes to rest and stays there; else, as between massless nodes, it is the mean rate over the step.

So reactions l and mean rates u = drift - G l are in a complementarity problem with a constant, symmetric, semidefinite
G: for the rate at the end only the value of u at which a friction sticks is another one, see `_aims`. It is solved
exactly. Not covered: impacts without compliance are refused; where inertia meets the end of a gap that only a friction
holds, what follows is right only for steps in which the friction cannot stop it; a node that nothing holds stays where
it is. The force of a damper on a road that jumps contains the jump, spread over a step.
Source: Acary and Brogliato (2008), Numerical Methods for Nonsmooth Dynamical Systems, chapter 10.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, SimulationError, Status, StatusKind
from inerter.kernels.stepping import DONE, FRICTION, GAP, HELD, INFINITE, KIND, ROWS, SIZE, STUCK, TIED, march
from inerter.networks.elements import Damper, Friction, Gap, Inerter, Spring
from inerter.systems.graph import Branch, Graph
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]

CHUNK = 1 << 15  # steps whose inputs are laid out at once
CALM = 0.03  # how fast a node that springs alone hold returns to balance: 1 is in one step, 0 is never
SAME = 1e-9  # size below which a direction or a row of order 1 is taken for zero


@dataclass(frozen=True, eq=False)
class StepTable:
    """Roads and external forces at the instants `time` [s], a constant step apart.

    `road` and `road_rate` [m, m/s] are of shape (roads, instants), `force` and `force_rate` [N, N/s] of (forces,
    instants). Between instants each channel is "cubic" (Hermite), "linear", or "zero" (held until the next instant, at
    which it jumps).
    """

    time: Matrix
    road: Matrix
    road_rate: Matrix
    force: Matrix
    force_rate: Matrix
    road_hold: tuple[str, ...]
    force_hold: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Start:
    """Displacements [m] and velocities [m/s] of all nodes at the first instant.

    Elongations [m] of the branches follow from them as if all were zero where every displacement and road is zero,
    unless they are given. What massless nodes are given only matters where something else than inertia holds them.
    """

    displacement: Matrix
    velocity: Matrix
    elongations: Matrix | None = None


@dataclass(frozen=True, eq=False)
class Histories:
    """Motions of the nodes, (samples, nodes), and forces of the branches [N], (samples, branches).

    The acceleration of a massless node is zero at the first and the last sample. What was not reached is nan.
    """

    time: Matrix
    displacement: Matrix
    velocity: Matrix
    acceleration: Matrix
    forces: Matrix
    status: Status


def step_through(mechanism: Mechanism, graph: Graph, table: StepTable, start: Start, every: int = 1) -> Histories:
    """Integrate with one step for each interval of `table`, and keep every `every`-th instant, the first one included.

    `graph` is `full_graph(mechanism)`. Second order in the step while nothing slides or touches, first order else.

    Raises `SimulationError` if the table is not usable, if a road that jumps moves an inerter, if a gap starts beyond
    its ends or can stop inertia with nothing in between that gives way.
    """
    h = _check_table(table, every)
    parts = _parts(mechanism, graph)
    _check_gaps(parts)
    offsets = _offsets(parts, table, start)
    scheme = _scheme(parts, table, offsets, h)
    known = _initial(parts, scheme, table, start, offsets)
    return _histories(parts, table, _march(scheme, parts, table, known, every), every)


# ---------------------------------------------------------------------------------------------- what there is


@dataclass(frozen=True, eq=False)
class _Parts:
    """The mechanism as rows over nodes (E) and roads (R), and matrices over nodes."""

    branches: tuple[Branch, ...]
    E: Matrix
    R: Matrix
    ports: Matrix  # nodes x forces
    k: Matrix  # of each branch [N/m], zero if it is no spring
    c: Matrix
    b: Matrix
    masses: Matrix  # of each node [kg]
    reactions: tuple[_Reaction, ...]

    @property
    def nodes(self) -> int:
        return int(self.E.shape[1])

    @property
    def roads(self) -> int:
        return int(self.R.shape[1])

    def nodal(self, values: Matrix, rows: Matrix) -> Matrix:
        """Forces on the nodes of branches with forces value x row: sum of E' value row."""
        return (self.E.T * values) @ rows


@dataclass(frozen=True, eq=False)
class _Reaction:
    """A gap, or all frictions side by side as one, with the part of its force that each branch has."""

    gap: bool
    size: float  # half width [m] or force [N]
    nodes: Matrix
    roads: Matrix
    parts: dict[int, float]


def _parts(mechanism: Mechanism, graph: Graph) -> _Parts:
    """Rows and values of all elements; raises `SimulationError` if one is still free."""
    if mechanism.free_values():
        free = ", ".join(mechanism.free_values())
        raise SimulationError(f"A simulation needs numbers, but there are free values: {free}. Fix them first.")
    n, names = len(graph.nodes), [c.name for c in mechanism.coordinates]
    ports = np.zeros((n, len(mechanism.forces)))
    for j, force in enumerate(mechanism.forces):
        for name, lever in force.port.items():
            ports[names.index(name), j] += lever
    masses = np.zeros(n)
    masses[: len(names)] = [c.inertia for c in mechanism.coordinates]
    return _Parts(
        graph.branches,
        np.array([b.nodes for b in graph.branches]).reshape(len(graph.branches), n),
        np.array([b.roads for b in graph.branches]).reshape(len(graph.branches), len(mechanism.roads)),
        ports,
        _values(graph.branches, Spring),
        _values(graph.branches, Damper),
        _values(graph.branches, Inerter),
        masses,
        _reactions(graph.branches),
    )


def _values(branches: tuple[Branch, ...], kind: type) -> Matrix:
    return np.array([float(b.element.value) if isinstance(b.element, kind) else 0.0 for b in branches])  # type: ignore[arg-type]


def _reactions(branches: tuple[Branch, ...]) -> tuple[_Reaction, ...]:
    """One for each gap, and one for each set of frictions between the same two ends; none for a friction of zero."""
    found: list[_Reaction] = []
    for i, branch in enumerate(branches):
        if not isinstance(branch.element, Friction | Gap):
            continue
        gap, size, sign = isinstance(branch.element, Gap), float(branch.element.value), 1.0  # type: ignore[arg-type]
        row = np.concatenate([branch.nodes, branch.roads])
        for j, other in enumerate(found):
            beside = np.concatenate([other.nodes, other.roads])
            sign = 1.0 if np.array_equal(row, beside) else -1.0
            if not gap and not other.gap and np.array_equal(sign * row, beside):
                shares = {**other.parts, i: sign * size}
                found[j] = replace(other, size=other.size + size, parts=shares)
                break
        else:
            if gap or size > 0.0:
                found.append(_Reaction(gap, size, branch.nodes, branch.roads, {i: 1.0 if gap else size}))
    return tuple(r if r.gap else replace(r, parts={i: part / r.size for i, part in r.parts.items()}) for r in found)


# ---------------------------------------------------------------------------------------------- directions


@dataclass(frozen=True, eq=False)
class _Inertia:
    """The singular inertia matrix M, its coupling B to the roads, its inverse on its range, its null directions."""

    M: Matrix
    B: Matrix
    inverse: Matrix
    massless: Matrix  # orthonormal columns


def _inertia(parts: _Parts) -> _Inertia:
    M = np.diag(parts.masses) + parts.nodal(parts.b, parts.E)
    rows = np.vstack([np.eye(parts.nodes)[parts.masses > 0.0], _unit(parts.E[parts.b > 0.0])])
    carried, massless = _range_and_null(rows)
    inverse = carried @ np.linalg.inv(carried.T @ M @ carried) @ carried.T
    return _Inertia(M, parts.nodal(parts.b, parts.R), inverse, massless)


def _unit(rows: Matrix) -> Matrix:
    """Rows of length 1; empty ones stay so."""
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(rows / np.where(length > 0.0, length, 1.0))


def _range_and_null(rows: Matrix) -> tuple[Matrix, Matrix]:
    """Orthonormal columns that span the rows, which are of order 1, and those that are orthogonal to all of them."""
    if rows.shape[0] == 0 or rows.shape[1] == 0:
        return np.zeros((rows.shape[1], 0)), np.eye(rows.shape[1])
    _, size, V = np.linalg.svd(rows)
    rank = int(np.sum(size > SAME))
    return V[:rank].T, V[rank:].T


def _rank(rows: Matrix) -> int:
    return int(_range_and_null(rows)[0].shape[1])


def _reaction_rows(parts: _Parts) -> tuple[Matrix, Matrix]:
    count = len(parts.reactions)
    E = np.array([r.nodes for r in parts.reactions]).reshape(count, parts.nodes)
    return E, np.array([r.roads for r in parts.reactions]).reshape(count, parts.roads)


# ---------------------------------------------------------------------------------------------- checks


def _check_table(table: StepTable, every: int) -> float:
    """The step [s]; raises `SimulationError` unless the table has one, is finite and has a known hold everywhere."""
    time = table.time
    if time.ndim != 1 or time.size < 2 or every < 1:
        raise SimulationError(f"Time stepping needs two instants or more and every >= 1, got {time.shape}, {every}.")
    h = float(time[-1] - time[0]) / (time.size - 1)
    if not h > 0.0 or np.abs(np.diff(time) - h).max() > 1e-6 * h:
        raise SimulationError("Time stepping needs instants a constant positive step apart. Resample the input.")
    for what, values, rates, holds in (
        ("road", table.road, table.road_rate, table.road_hold),
        ("force", table.force, table.force_rate, table.force_hold),
    ):
        if not values.shape == rates.shape == (len(holds), time.size):
            raise SimulationError(f"Each {what} needs one value and one rate an instant, got shape {values.shape}.")
        if not (np.isfinite(values).all() and np.isfinite(rates).all()):
            raise SimulationError(f"A {what} of the input table is not finite.")
        if not set(holds) <= {"cubic", "linear", "zero"}:
            raise SimulationError(f'A {what} is held "cubic", "linear" or "zero", got {holds}.')
    return h


def _check_gaps(parts: _Parts) -> None:
    """Raises `SimulationError` if closing gaps stops inertia, or joins a road to the ground, with nothing between."""
    massless = _inertia(parts).massless
    E, R = _reaction_rows(parts)
    gaps = np.array([r.gap for r in parts.reactions], dtype=bool)
    closed = gaps & np.array([r.size == 0.0 for r in parts.reactions], dtype=bool)

    def rigid(chosen: NDArray[np.bool_], rows: Matrix) -> int:
        impulses = _range_and_null(massless.T @ E[chosen].T)[1]
        return _rank(impulses.T @ rows[chosen])

    both = np.hstack([E, R])
    if rigid(gaps, both) > rigid(closed, both):
        raise SimulationError(
            "A gap has inertia or a given motion on both sides and nothing that gives way: its impacts are undefined. "
            "Put a spring or damper in series with the gap."
        )
    if rigid(closed, both) > rigid(closed, E):
        raise SimulationError("Gaps of no width join a road to the ground rigidly. Put a spring in series with them.")


# ---------------------------------------------------------------------------------------------- start


def _offsets(parts: _Parts, table: StepTable, start: Start) -> Matrix:
    """Elongations where all displacements and roads are zero."""
    for what, values in (("displacement", start.displacement), ("velocity", start.velocity)):
        if values.shape != (parts.nodes,) or not np.isfinite(values).all():
            raise SimulationError(f"The start needs a finite {what} for each of the {parts.nodes} nodes.")
    if start.elongations is None:
        return np.zeros(len(parts.branches))
    if start.elongations.shape != (len(parts.branches),) or not np.isfinite(start.elongations).all():
        raise SimulationError(f"The start needs a finite elongation for each of the {len(parts.branches)} branches.")
    return np.asarray(start.elongations - parts.E @ start.displacement - parts.R @ table.road[:, 0])


def _settled(parts: _Parts, table: StepTable, start: Start, offsets: Matrix) -> Matrix:
    """Displacements at the start, in which nodes that only springs hold are in balance.

    Massless and undamped, they are there at once; the step's mean force would let them swing about that place.
    """
    displacement = start.displacement.copy()
    elongation = offsets + parts.E @ displacement + parts.R @ table.road[:, 0]
    held = [parts.masses[i] * np.eye(parts.nodes)[i] for i in np.flatnonzero(parts.masses)]
    held += [row for row, c, b in zip(parts.E, parts.c, parts.b, strict=True) if c + b > 0.0]
    for reaction in parts.reactions:
        at = next(iter(reaction.parts))
        if not reaction.gap or abs(elongation[at]) > (1.0 - SAME) * reaction.size:
            held.append(reaction.nodes)
        if reaction.gap and abs(elongation[at]) > reaction.size * (1.0 + SAME) + 1e-12:
            raise SimulationError(
                f"Gap {parts.branches[at].label!r} starts at {elongation[at]:g} m, beyond its half width of "
                f"{reaction.size:g} m. Start within it."
            )
    free = _range_and_null(_unit(np.array(held).reshape(len(held), parts.nodes)))[1]
    stiffness = free.T @ parts.nodal(parts.k, parts.E) @ free
    unbalanced = free.T @ (parts.E.T @ (parts.k * elongation))
    displacement -= free @ (np.linalg.pinv(stiffness, rcond=1e-12, hermitian=True) @ unbalanced)
    return displacement


def _initial(parts: _Parts, scheme: _Scheme, table: StepTable, start: Start, offsets: Matrix) -> Matrix:
    """What the first step knows: displacements and momenta, and a one."""
    at = scheme.at
    known = np.zeros(at.total)
    known[at.d] = _settled(parts, table, start, offsets)
    rate = _inputs(parts, table, 0, 1)[0, 2 * parts.roads + parts.ports.shape[1] :][: parts.roads]
    inertia = _inertia(parts)
    known[at.p] = inertia.M @ start.velocity + inertia.B @ rate
    known[at.one] = 1.0
    return known


# ---------------------------------------------------------------------------------------------- one step


@dataclass(frozen=True)
class _Places:
    """Where the numbers of a step stand: first what it knows at its start, then what it finds."""

    d: slice  # displacements [m]
    p: slice  # momenta [N s]
    z: slice  # roads at the start of the step [m]
    dz: slice  # their growth over the step
    force: slice  # mean external forces [N]
    rate0: slice  # rates of the roads at the start and at the end [m/s]
    rate1: slice
    one: slice
    w: slice  # mean velocities [m/s]
    x: slice  # reactions [N], then velocities along loose directions [m/s]
    total: int


def _places(parts: _Parts, reactions: int) -> _Places:
    n, roads, forces = parts.nodes, parts.roads, parts.ports.shape[1]
    ends = np.cumsum([0, n, n, roads, roads, forces, roads, roads, 1, n, reactions]).tolist()
    d, p, z, dz, force, rate0, rate1, one, w, x = (slice(a, b) for a, b in pairwise(ends))
    return _Places(d, p, z, dz, force, rate0, rate1, one, w, x, ends[-1])


@dataclass(frozen=True, eq=False)
class _Rows:
    """Quantities of a step as rows over its numbers."""

    mean_rate: Matrix  # of each branch
    elongation: Matrix  # at the start
    linear: Matrix  # mean forces of springs and dampers
    momentum: Matrix  # at the end
    velocity0: Matrix  # of what has inertia, at the start and at the end
    velocity1: Matrix
    balance: Matrix  # of forces on the nodes, without reactions


def _rows(parts: _Parts, inertia: _Inertia, table: StepTable, offsets: Matrix, at: _Places, h: float) -> _Rows:
    """The scheme itself, in the words of the module's first lines."""
    E, R, M, B = parts.E, parts.R, inertia.M, inertia.B
    unit = np.eye(at.total)
    d, p, z, dz, w = unit[at.d], unit[at.p], unit[at.z], unit[at.dz], unit[at.w]
    within = np.diag([0.0 if hold == "zero" else 0.5 for hold in table.road_hold]) @ dz
    elongation = E @ d + R @ z + np.outer(offsets, unit[at.one])
    mean_rate = E @ w + R @ dz / h
    springs = parts.k[:, None] * (elongation + R @ within + 0.5 * h * E @ w)
    linear = springs + _relaxation(parts, inertia) @ (h * mean_rate) + parts.c[:, None] * mean_rate
    momentum = 2.0 * (M @ w + B @ dz / h) - p
    balance = (momentum - p) / h + E.T @ linear - parts.ports @ unit[at.force]
    velocity0 = inertia.inverse @ (p - B @ unit[at.rate0])
    velocity1 = inertia.inverse @ (momentum - B @ unit[at.rate1])
    return _Rows(mean_rate, elongation, linear, momentum, velocity0, velocity1, balance)


def _relaxation(parts: _Parts, inertia: _Inertia) -> Matrix:
    """Spring forces, for the growth of all elongations, that calm nodes which springs alone hold.

    Such a node has no memory, but a balance of the mean forces of each step would let its position alternate for ever
    about the balance, once a friction or gap has disturbed it. This is zero where the balance is not disturbed.
    """
    held = np.vstack([np.diag(parts.masses > 0.0).astype(float), _unit(parts.E[parts.b + parts.c > 0.0])])
    free = _range_and_null(held)[1]
    toward = parts.k[:, None] * (parts.E @ free)
    stiffness = free.T @ parts.nodal(parts.k, parts.E) @ free
    return 0.5 * CALM * toward @ np.linalg.pinv(stiffness, rcond=1e-12, hermitian=True) @ toward.T


@dataclass(frozen=True, eq=False)
class _Scheme:
    """The constant matrices of a step, as the compiled loop takes them."""

    at: _Places
    predict: Matrix
    G: Matrix
    pull: Matrix
    Z: Matrix
    inertia: Matrix
    moved: Matrix
    h: float
    starts: Matrix
    ends: Matrix
    law: Matrix


def _scheme(parts: _Parts, table: StepTable, offsets: Matrix, h: float) -> _Scheme:
    """Mean velocities, rates and aims without reactions, and what reactions change in them."""
    inertia, (E, R) = _inertia(parts), _reaction_rows(parts)
    if np.any(inertia.B[:, [hold == "zero" for hold in table.road_hold]]):
        raise SimulationError('A road that jumps (hold "zero") moves an inerter: hold it "linear" or "cubic".')
    loose = _loose(parts)
    at = _places(parts, E.shape[0] + loose.shape[1])
    rows = _rows(parts, inertia, table, offsets, at, h)
    inverse = _inverse(rows.balance[:, at.w], loose)
    w = -inverse @ rows.balance
    drift = E @ w + R @ np.eye(at.total)[at.dz] / h
    aims, Z, shared = _aims(parts, inertia, rows, at, h)
    still = np.zeros((loose.shape[1], at.total))
    predict = np.vstack([w, drift, still, aims, still, shared])[:, : at.w.start]
    G = _reaction_matrix(parts, E, inverse, loose)
    pull = np.hstack([inverse @ E.T, -loose])
    starts, ends = _observed(parts, inertia, rows, at, h)
    law = _law(parts, loose, h)
    moved = rows.momentum[:, at.z.start : at.dz.stop]
    predict, G, pull, Z, inertial, moved = (
        np.ascontiguousarray(a) for a in (predict, G, pull, Z, rows.momentum[:, at.w], moved)
    )
    return _Scheme(at, predict, G, pull, Z, inertial, moved, h, starts, ends, law)


def _loose(parts: _Parts) -> Matrix:
    """Orthonormal directions in which only frictions and gaps hold the nodes."""
    linear = _unit(parts.E[parts.k + parts.c + parts.b > 0.0])
    return _range_and_null(np.vstack([np.diag(parts.masses > 0.0).astype(float), linear]))[1]


def _inverse(A: Matrix, loose: Matrix) -> Matrix:
    """Inverse of the step's matrix outside its null directions `loose`; scaling keeps the digits of small pivots."""
    size = 1.0 / np.sqrt(np.where(np.diag(A) > 0.0, np.diag(A), 1.0))
    directions, _ = np.linalg.qr(loose / size[:, None])  # of the scaled matrix
    scaled = A * size * size[:, None] + directions @ directions.T
    inverse = (np.linalg.inv(scaled) - directions @ directions.T) * size * size[:, None]
    return np.asarray(0.5 * (inverse + inverse.T))


def _reaction_matrix(parts: _Parts, E: Matrix, inverse: Matrix, loose: Matrix) -> Matrix:
    """G: the rates that unit reactions take away, and the balance of reactions along loose directions.

    A loose direction has an artificial damping of 1e-10 of all friction forces at 1 m/s, so that it stays where it is
    when nothing holds it. Dependent reactions (around a loop) are told apart by a give of 1e-10 of the step's own.
    """
    count, free = E.shape[0], loose.shape[1]
    G = np.zeros((count + free, count + free))
    G[:count, :count] = E @ inverse @ E.T
    G[:count, count:] = -E @ loose
    G[count:, :count] = (E @ loose).T
    G[count:, count:] = np.eye(free) * 1e-10 * (sum(r.size for r in parts.reactions if not r.gap) or 1.0)
    if _rank(_unit(E)) < count:
        give = np.diag(G)[:count]
        G[range(count), range(count)] += 1e-10 * np.maximum(give, 1e-6 * max(give.max(), 1e-6))
    return G


def _law(parts: _Parts, loose: Matrix, h: float) -> Matrix:
    """Kind and size of each reaction; a gap's as the rate that crosses half of it in one step."""
    law = np.zeros((ROWS, len(parts.reactions) + loose.shape[1]))
    law[KIND], law[HELD] = TIED, -1.0
    for i, reaction in enumerate(parts.reactions):
        law[SIZE, i] = reaction.size / h if reaction.gap else reaction.size
        if not reaction.gap or reaction.size > 0.0:
            law[KIND, i] = GAP if reaction.gap else FRICTION
    return law


def _aims(parts: _Parts, inertia: _Inertia, rows: _Rows, at: _Places, h: float) -> tuple[Matrix, Matrix, Matrix]:
    """At which mean rate a friction sticks and a gap is in its middle; combinations Z of reactions, and theirs.

    A friction whose rate inertia carries sticks when the rate at the end of the step is zero: the mean is then half
    the rate at the start. Others stick when the mean is zero, unless inertia carries a combination of several, as in
    frictions end to end: those that slide then share what the combination has.
    """
    unit, (E, R) = np.eye(at.total), _reaction_rows(parts)
    carried = E @ inertia.inverse
    half = 0.5 * carried @ unit[at.p] + (R - carried @ inertia.B) @ (unit[at.dz] / h - 0.5 * unit[at.rate1])
    aims = np.zeros((len(parts.reactions), at.total))
    mixed: list[int] = []
    for i, reaction in enumerate(parts.reactions):
        if reaction.gap:
            aims[i] = -rows.elongation[next(iter(reaction.parts))] / h
            mixed.append(i)
        elif np.linalg.norm(E[i] @ inertia.massless) <= SAME * np.linalg.norm(E[i]):
            aims[i] = half[i]
        else:
            mixed.append(i)
    Z = np.zeros((0, len(parts.reactions)))
    if not all(parts.reactions[i].gap for i in mixed):
        impulses = _range_and_null((E[mixed] @ inertia.massless).T)[1].T
        Z = np.zeros((impulses.shape[0], len(parts.reactions)))
        Z[:, mixed] = impulses
    return aims, Z, Z @ half


def _observed(parts: _Parts, inertia: _Inertia, rows: _Rows, at: _Places, h: float) -> tuple[Matrix, Matrix]:
    """Displacements, velocities, accelerations and forces, from the step after an instant and from that before it.

    The mean of both is of second order in h: velocities of massless nodes and all forces are mean values of a step.
    """
    unit = np.eye(at.total)
    d, w = unit[at.d], unit[at.w]
    carried = (np.linalg.norm(inertia.massless, axis=1) <= SAME)[:, None]
    growth = rows.velocity1 - rows.velocity0
    forces = rows.linear + parts.b[:, None] / h * (parts.E @ growth + parts.R @ (unit[at.rate1] - unit[at.rate0]))
    for row, reaction in zip(unit[at.x], parts.reactions, strict=False):
        for i, part in reaction.parts.items():
            forces[i] += part * row
    starts = (d, np.where(carried, rows.velocity0, w), np.where(carried, growth, 2.0 * w) / h, forces)
    ends = (d + h * w, np.where(carried, rows.velocity1, w), np.where(carried, growth, -2.0 * w) / h, forces)
    return np.vstack(starts), np.vstack(ends)


# ---------------------------------------------------------------------------------------------- all steps


def _inputs(parts: _Parts, table: StepTable, first: int, last: int) -> Matrix:
    """What steps `first` to `last` - 1 are given, one row each: roads, growths, mean forces, rates at both ends."""
    h = float(table.time[-1] - table.time[0]) / (table.time.size - 1)
    z0, z1 = table.road[:, first:last], table.road[:, first + 1 : last + 1]
    rates = {
        "cubic": (table.road_rate[:, first:last], table.road_rate[:, first + 1 : last + 1]),
        "linear": ((z1 - z0) / h, (z1 - z0) / h),
        "zero": (0.0 * z0, 0.0 * z0),
    }
    F0, F1 = table.force[:, first:last], table.force[:, first + 1 : last + 1]
    bend = h / 12.0 * (table.force_rate[:, first:last] - table.force_rate[:, first + 1 : last + 1])
    means = {"cubic": 0.5 * (F0 + F1) + bend, "linear": 0.5 * (F0 + F1), "zero": F0}
    columns = [
        z0,
        z1 - z0,
        *(means[hold][j : j + 1] for j, hold in enumerate(table.force_hold)),
        *(rates[hold][end][j : j + 1] for end in (0, 1) for j, hold in enumerate(table.road_hold)),
    ]
    return np.ascontiguousarray(np.vstack(columns).T)


def _march(scheme: _Scheme, parts: _Parts, table: StepTable, known: Matrix, every: int) -> tuple[Matrix, int, int]:
    """All samples, how the march ended, and the step that it reached."""
    steps, count, shared = table.time.size - 1, scheme.G.shape[0], sum(scheme.Z.shape)
    samples = np.zeros((steps // every + 1, scheme.starts.shape[0]))
    law = scheme.law.copy()
    scratch = (
        *(np.zeros(scheme.predict.shape[0]), np.zeros(count), np.zeros((count, count)), np.zeros(count, np.int64)),
        *(np.zeros(scheme.Z.shape[1]), np.zeros(shared), np.zeros((shared, shared)), np.zeros(shared, np.int64)),
    )
    matrices = (scheme.predict, scheme.G, scheme.pull, scheme.Z, scheme.inertia, scheme.moved, scheme.h)
    ended, reached = DONE, 0
    for first in range(0, steps, CHUNK):
        inputs = _inputs(parts, table, first, min(first + CHUNK, steps))
        ended, reached = march(
            *matrices, scheme.starts, scheme.ends, inputs, first, steps, every, known, law, scratch, samples
        )
        if ended != DONE:
            break
    return samples, ended, reached


_ENDED = {
    STUCK: "no friction and contact forces that fit were found",
    INFINITE: "the velocities grew beyond all numbers",
}


def _histories(parts: _Parts, table: StepTable, marched: tuple[Matrix, int, int], every: int) -> Histories:
    samples, ended, reached = marched
    n, status = parts.nodes, OK
    if ended != DONE:
        samples[-(-reached // every) :] = np.nan
        status = Status(StatusKind.FAILED, f"At t = {table.time[reached]:g} s {_ENDED[ended]}; what follows is nan.")
    massless = np.linalg.norm(_inertia(parts).massless, axis=1) > SAME
    acceleration = samples[:, 2 * n : 3 * n]
    acceleration[0, massless] = 0.0
    if (table.time.size - 1) % every == 0:
        acceleration[-1, massless] = 0.0
    return Histories(
        np.ascontiguousarray(table.time[::every]),
        np.ascontiguousarray(samples[:, :n]),
        np.ascontiguousarray(samples[:, n : 2 * n]),
        np.ascontiguousarray(acceleration),
        np.ascontiguousarray(samples[:, 3 * n :]),
        status,
    )
