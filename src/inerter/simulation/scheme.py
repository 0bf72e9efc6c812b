"""The scheme of time stepping: the constant matrices of one step, after Moreau and Jean with theta = 1/2.

Unknown are the mean velocities w of all nodes over a step h, massless nodes included: displacements grow by h w and
momenta p (of masses and inerters) become 2 (M w + B dz/h) - p, for inerters that B couples to the roads z. Springs act
with the mean of their forces at both ends of the step, dampers with that of the mean velocity. Frictions and contacts
are implicit, with one force for the step:

    a gap's elongation at the end of the step is within its bounds, and its force in the normal cone there;
    a friction's force is in size x Sgn(rate). The rate is that at the end of the step where inertia carries it, so
    that a body comes to rest and stays there; else, as between massless nodes, it is the mean rate over the step.

So reactions l and mean rates u = drift - G l are in a complementarity problem with a constant, symmetric, semidefinite
G: for the rate at the end only the value of u at which a friction sticks is another one, see `_aims`. It is solved
exactly, by `kernels.stepping`.
Source: Acary and Brogliato (2008), Numerical Methods for Nonsmooth Dynamical Systems, chapter 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.kernels.stepping import CONSTANT, FRICTION, GAP, HELD, KIND, LOWER, ROWS, TIED, UPPER
from inerter.simulation.parts import SAME, Parts, Reaction, range_and_null, rank, unit_rows

Matrix = NDArray[np.float64]

CALM = 0.03  # how fast a node that springs alone hold returns to balance: 1 is in one step, 0 is never


@dataclass(frozen=True)
class StepPlaces:
    """Positions of the quantities of a step in its vector: known at its start, then unknown."""

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

    @property
    def inputs(self) -> slice:
        """Slice of the inputs of a step: roads, increments, mean forces, rates at both ends."""
        return slice(self.z.start, self.rate1.stop)


@dataclass(frozen=True, eq=False)
class Scheme:
    """The constant matrices of a step, as `kernels.stepping.march` takes them."""

    at: StepPlaces
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


@dataclass(frozen=True, eq=False)
class _Rows:
    """Quantities of a step as rows over its numbers."""

    elongation: Matrix  # at the start
    linear: Matrix  # mean forces of springs and dampers
    momentum: Matrix  # at the end
    velocity0: Matrix  # of what has inertia, at the start and at the end
    velocity1: Matrix
    balance: Matrix  # of forces on the nodes, without reactions


def scheme_of(parts: Parts, road_hold: tuple[str, ...], offsets: Matrix, h: float) -> Scheme:
    """Mean velocities, rates and aims without reactions, and what reactions change in them.

    `offsets` [m] are the elongations where all displacements and roads are zero; `h` [s] is the step.

    Raises `SimulationError` if a road that jumps moves an inerter.
    """
    if np.any(parts.inertia.B[:, [hold == "zero" for hold in road_hold]]):
        raise SimulationError('A road that jumps (hold "zero") moves an inerter: hold it "linear" or "cubic".')
    E, R = parts.reaction_rows
    loose = parts.unconstrained_directions(
        parts.k + parts.c + parts.b > 0.0
    )  # only frictions and gaps hold these directions
    at = _places(parts, E.shape[0] + loose.shape[1])
    rows = _rows(parts, road_hold, offsets, at, h)
    inverse = _inverse(rows.balance[:, at.w], loose)
    w = -inverse @ rows.balance
    drift = E @ w + R @ np.eye(at.total)[at.dz] / h
    aims, Z, shared = _aims(parts, rows, at, h)
    still = np.zeros((loose.shape[1], at.total))
    predict = np.vstack([w, drift, still, aims, still, shared])[:, : at.w.start]
    starts, ends = _observed_rows(parts, rows, at, h)
    return Scheme(
        at=at,
        predict=np.ascontiguousarray(predict),
        G=_reaction_matrix(parts, inverse, loose),
        pull=np.ascontiguousarray(np.hstack([inverse @ E.T, -loose])),
        Z=np.ascontiguousarray(Z),
        inertia=np.ascontiguousarray(rows.momentum[:, at.w]),
        moved=np.ascontiguousarray(rows.momentum[:, at.z.start : at.dz.stop]),
        h=h,
        starts=starts,
        ends=ends,
        law=_law(parts, loose, h),
    )


def _places(parts: Parts, reactions: int) -> StepPlaces:
    n, roads, forces = parts.nodes, parts.roads, parts.ports.shape[1]
    ends = np.cumsum([0, n, n, roads, roads, forces, roads, roads, 1, n, reactions]).tolist()
    d, p, z, dz, force, rate0, rate1, one, w, x = (slice(a, b) for a, b in pairwise(ends))
    return StepPlaces(d, p, z, dz, force, rate0, rate1, one, w, x, ends[-1])


def _rows(parts: Parts, road_hold: tuple[str, ...], offsets: Matrix, at: StepPlaces, h: float) -> _Rows:
    """The scheme itself, in the words of the module's first lines."""
    E, R, inertia = parts.E, parts.R, parts.inertia
    unit = np.eye(at.total)
    d, p, z, dz, w = unit[at.d], unit[at.p], unit[at.z], unit[at.dz], unit[at.w]
    within = np.diag([0.0 if hold == "zero" else 0.5 for hold in road_hold]) @ dz
    elongation = E @ d + R @ z + np.outer(offsets, unit[at.one])
    mean_rate = E @ w + R @ dz / h
    springs = parts.k[:, None] * (elongation + R @ within + 0.5 * h * E @ w)
    linear = springs + _relaxation(parts) @ (h * mean_rate) + parts.c[:, None] * mean_rate
    momentum = 2.0 * (inertia.M @ w + inertia.B @ dz / h) - p
    balance = (momentum - p) / h + E.T @ linear - parts.ports @ unit[at.force]
    velocity0 = inertia.inverse @ (p - inertia.B @ unit[at.rate0])
    velocity1 = inertia.inverse @ (momentum - inertia.B @ unit[at.rate1])
    return _Rows(elongation, linear, momentum, velocity0, velocity1, balance)


def _relaxation(parts: Parts) -> Matrix:
    """Spring forces, for the growth of all elongations, that calm nodes which springs alone hold.

    Such a node has no memory, but a balance of the mean forces of each step would let its position alternate for ever
    about the balance, once a friction or gap has disturbed it. This is zero where the balance is not disturbed.
    """
    free = parts.unconstrained_directions(parts.b + parts.c > 0.0)
    toward = parts.k[:, None] * (parts.E @ free)
    stiffness = free.T @ parts.nodal(parts.k, parts.E) @ free
    return 0.5 * CALM * toward @ np.linalg.pinv(stiffness, rcond=1e-12, hermitian=True) @ toward.T


def _inverse(A: Matrix, loose: Matrix) -> Matrix:
    """Inverse of the step's matrix outside its null directions `loose`; scaling keeps the digits of small pivots."""
    size = 1.0 / np.sqrt(np.where(np.diag(A) > 0.0, np.diag(A), 1.0))
    directions, _ = np.linalg.qr(loose / size[:, None])  # of the scaled matrix
    scaled = A * size * size[:, None] + directions @ directions.T
    inverse = (np.linalg.inv(scaled) - directions @ directions.T) * size * size[:, None]
    return np.asarray(0.5 * (inverse + inverse.T))


def _reaction_matrix(parts: Parts, inverse: Matrix, loose: Matrix) -> Matrix:
    """G: the rates that unit reactions take away, and the balance of reactions along loose directions.

    A loose direction has an artificial damping of 1e-10 of all friction forces at 1 m/s, so that it stays where it is
    when nothing holds it. Dependent reactions (around a loop) are told apart by a give of 1e-10 of the step's own.
    """
    E, _ = parts.reaction_rows
    count, free = E.shape[0], loose.shape[1]
    G = np.zeros((count + free, count + free))
    G[:count, :count] = E @ inverse @ E.T
    G[:count, count:] = -E @ loose
    G[count:, :count] = (E @ loose).T
    G[count:, count:] = np.eye(free) * 1e-10 * (sum(_friction(r) for r in parts.reactions) or 1.0)
    if rank(unit_rows(E)) < count:
        give = np.diag(G)[:count]
        G[range(count), range(count)] += 1e-10 * np.maximum(give, 1e-6 * max(give.max(), 1e-6))
    return G


def _aims(parts: Parts, rows: _Rows, at: StepPlaces, h: float) -> tuple[Matrix, Matrix, Matrix]:
    """Mean rates for sticking frictions and for gaps in mid-position, combinations Z of reactions, and their rates.

    A friction whose rate inertia carries sticks when the rate at the end of the step is zero: the mean is then half
    the rate at the start. Others stick when the mean is zero, unless inertia carries a combination of several, as in
    frictions end to end: those that slide then share what the combination has.
    """
    unit, inertia, (E, R) = np.eye(at.total), parts.inertia, parts.reaction_rows
    carried = E @ inertia.inverse
    half = 0.5 * carried @ unit[at.p] + (R - carried @ inertia.B) @ (unit[at.dz] / h - 0.5 * unit[at.rate1])
    aims = np.zeros((len(parts.reactions), at.total))
    mixed: list[int] = []
    for i, reaction in enumerate(parts.reactions):
        if reaction.gap:
            aims[i] = -rows.elongation[reaction.branch] / h
            mixed.append(i)
        elif np.linalg.norm(E[i] @ inertia.massless) <= SAME * np.linalg.norm(E[i]):
            aims[i] = half[i]
        elif reaction.acts:
            mixed.append(i)
    Z = np.zeros((0, len(parts.reactions)))
    if not all(parts.reactions[i].gap for i in mixed):
        impulses = range_and_null((E[mixed] @ inertia.massless).T)[1].T
        Z = np.zeros((impulses.shape[0], len(parts.reactions)))
        Z[:, mixed] = impulses
    return aims, Z, Z @ half


def _observed_rows(parts: Parts, rows: _Rows, at: StepPlaces, h: float) -> tuple[Matrix, Matrix]:
    """Displacements, velocities, accelerations and forces, from the step after an instant and from that before it.

    The mean of both is of second order in h: velocities of massless nodes and all forces are mean values of a step.
    """
    unit = np.eye(at.total)
    d, w = unit[at.d], unit[at.w]
    massless = parts.massless[:, None]
    growth = rows.velocity1 - rows.velocity0
    forces = rows.linear + parts.b[:, None] / h * (parts.E @ growth + parts.R @ (unit[at.rate1] - unit[at.rate0]))
    for row, reaction in zip(unit[at.x], parts.reactions, strict=False):
        for i, share in reaction.shares.items():
            forces[i] += share * row
    starts = (d, np.where(massless, w, rows.velocity0), np.where(massless, 2.0 * w, growth) / h, forces)
    ends = (d + h * w, np.where(massless, w, rows.velocity1), np.where(massless, -2.0 * w, growth) / h, forces)
    return np.vstack(starts), np.vstack(ends)


def _law(parts: Parts, loose: Matrix, h: float) -> Matrix:
    """Kind and limits of each reaction; those of a gap are rates that close it from zero in one step."""
    law = np.zeros((ROWS, len(parts.reactions) + loose.shape[1]))
    law[KIND], law[HELD] = TIED, -1.0
    for i, reaction in enumerate(parts.reactions):
        law[[LOWER, UPPER], i] = np.array([reaction.lower, reaction.upper]) / (h if reaction.gap else 1.0)
        if reaction.acts:
            law[KIND, i] = GAP if reaction.gap else FRICTION
        elif not reaction.gap:
            law[KIND, i] = CONSTANT
    return law


def _friction(reaction: Reaction) -> float:
    """Largest finite limit of a friction in size [N]; zero for a gap."""
    forces = [abs(force) for force in (reaction.lower, reaction.upper) if isfinite(force)]
    return 0.0 if reaction.gap else max(forces, default=0.0)
