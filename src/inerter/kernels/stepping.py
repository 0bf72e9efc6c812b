"""The loop over the steps of a time-stepping integrator: a linear prediction, then friction and contact solved exactly.

A step starts from what is known: (displacements, momenta, inputs, 1). One product gives what it would be without
reactions; the reactions of frictions and gaps then follow from a small complementarity problem with a constant matrix:

    rate = drift - G force, where
    a friction has lower <= force <= upper, one of these while it slides with rate below or above its aim;
    a gap has aim + lower <= rate <= aim + upper, force >= 0 at the upper bound, <= 0 at the lower one, else zero;
    a tied reaction has rate = aim + upper, whatever its force;
    a constant one has force = upper, whatever its rate.

All that is about reactions stands in one array with a column each, because a call costs time for each array.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import factor_by_quotients, multiply_vector, solve_by_quotients

Array = Any  # compiled code is typed when it is compiled

ROWS = 9  # of the array of reactions; side is -1, 0 or 1: sliding or touching there, or neither
KIND, LOWER, UPPER, DRIFT, AIM, SIDE, SPEED, BETTER, HELD = 0, 1, 2, 3, 4, 5, 6, 7, 8
FRICTION, GAP, TIED, CONSTANT = 0.0, 1.0, 2.0, 3.0  # tied: a gap of no width, or the motion of a loose node
DONE, STUCK, INFINITE = 0, 1, 2  # how a march ended: as it should, without reactions that fit, with nonsense
LIMIT = 400  # solutions tried before a complementarity problem is given up
PATIENCE = 8  # block changes without progress, before only one reaction is changed at a time
ROUNDING = 1e-12  # part of the largest rate below which that of another one tells nothing


class Step(NamedTuple):
    """The constant matrices of a step.

    What is known at its start: displacements (n), momenta (n), inputs, 1; then mean velocities (n), and reactions.
    """

    predict: Array  # rows over the first four of these for mean velocities, rates, aims and shared rates
    G: Array
    pull: Array  # (n, reactions): the mean velocity that a unit reaction takes away
    Z: Array  # combinations of reactions whose rates, the last of `predict`, inertia carries
    inertia: Array  # (n, n), and the next (n, inputs): twice the mean momenta of mean velocities and inputs
    moved: Array
    h: float
    starts: Array  # what is observed at a sample, from the step after it ...
    ends: Array  # ... and from the step before it; a sample is the mean of both


class Scratch(NamedTuple):
    """Room for one step."""

    guess: Array  # what `predict` makes
    force: Array  # reactions
    LU: Array  # their equations
    pivots: Array
    weight: Array  # of the reactions in `fill_share_equations`, and its equations
    taken: Array
    Q: Array
    order: Array


class Stretch(NamedTuple):
    """Range of steps: from `first` of `total`, with a sample at every `every`-th instant."""

    first: int
    total: int
    every: int


@part(borrowing=True)
def observe(rows: Array, known: Array, weight: float, out: Array, at: int) -> None:
    """Add `weight` times the observed quantities to one sample."""
    for i in range(rows.shape[0]):
        total = 0.0
        for j in range(rows.shape[1]):
            total += rows[i, j] * known[j]
        out[at, i] += weight * total


@part(borrowing=True)
def set_weights(law: Array, weight: Array) -> None:
    """Fill `weight` with the share of each reaction in a rate that inertia gives to several: its sliding speed.

    A friction that stuck or a gap that was closed takes next to nothing. One that was open takes nearly all: -1.
    """
    largest = 1e-300
    for i in range(weight.shape[0]):
        weight[i] = 0.0
        if law[KIND, i] == FRICTION and law[SIDE, i] != 0.0:
            weight[i] = law[SPEED, i]
            largest = max(largest, weight[i])
        if law[KIND, i] == GAP and law[SIDE, i] == 0.0:
            weight[i] = -1.0
    for i in range(weight.shape[0]):
        if weight[i] >= 0.0:
            weight[i] = weight[i] / largest + 1e-9


@part(borrowing=True)
def fill_share_equations(Z: Array, guess: Array, at: int, weight: Array, Q: Array, taken: Array) -> None:
    """Fill the equations for the shares a of the reactions and multipliers m: a = weight Z' m and Z a = rates."""
    count, size = Z.shape
    for i in range(size + count):
        taken[i] = 0.0
        for j in range(size + count):
            Q[i, j] = 0.0
        for a in range(count if i < size else 0):
            Q[i, i] = 1.0 if weight[i] >= 0.0 else 1e-9
            Q[i, size + a] = -abs(weight[i]) * Z[a, i]
        for j in range(size if i >= size else 0):
            taken[i] = guess[at + i - size]
            Q[i, j] = Z[i - size, j]


@part(borrowing=True)
def shift_aims(weight: Array, taken: Array, law: Array) -> None:
    """Add the shares of frictions to their aims."""
    for i in range(weight.shape[0]):
        if law[KIND, i] == FRICTION:
            law[AIM, i] += taken[i]


@part(borrowing=True)
def set_forces(law: Array, force: Array) -> bool:
    """Set up the forces for the present sides: right sides where a reaction holds, and the force itself where not.

    True if other reactions hold than before.
    """
    changed = False
    for i in range(force.shape[0]):
        kind, side = law[KIND, i], law[SIDE, i]
        reach, holds = law[UPPER, i], 0.0
        if side < 0.0:
            reach = law[LOWER, i]
        if kind == TIED or (kind == GAP and side != 0.0):
            holds = 1.0
            force[i] = law[DRIFT, i] - law[AIM, i] - reach
        elif kind == FRICTION and side == 0.0:
            holds = 1.0
            force[i] = law[DRIFT, i] - law[AIM, i]
        else:
            force[i] = 0.0
            if kind != GAP:
                force[i] = reach
        if law[HELD, i] != holds:
            changed = True
        law[HELD, i] = holds
    return changed


@part(borrowing=True)
def fill_force_equations(G: Array, law: Array, LU: Array) -> None:
    """Fill the equations of the forces."""
    for i in range(G.shape[0]):
        for j in range(G.shape[0]):
            LU[i, j] = G[i, j] * law[HELD, i]
        LU[i, i] += 1.0 - law[HELD, i]


@part(borrowing=True)
def count_misfits(G: Array, law: Array, force: Array, slack: float) -> Any:
    """Number of reactions that do not fit their side, and the last of them; records the side of each that fits."""
    count, last = 0, -1
    for i in range(G.shape[0]):
        kind, side, lower, upper = law[KIND, i], law[SIDE, i], law[LOWER, i], law[UPPER, i]
        rate = law[DRIFT, i]
        for j in range(G.shape[0]):
            rate -= G[i, j] * force[j]
        law[SPEED, i] = abs(rate)
        above, better = rate - law[AIM, i], side
        if kind == FRICTION and side == 0.0:
            if force[i] > upper:
                better = 1.0
            elif force[i] < lower:
                better = -1.0
        elif kind == FRICTION:
            if side * above < -slack:
                better = 0.0
        elif kind == GAP and side == 0.0:
            if above > upper + slack:
                better = 1.0
            elif above < lower - slack:
                better = -1.0
        elif kind == GAP and side * force[i] < 0.0:
            better = 0.0
        law[BETTER, i] = better
        if better != side:
            count += 1
            last = i
    return count, last


@part(borrowing=True)
def fill_inputs(inputs: Array, step: int, known: Array, at: int) -> None:
    """Copy the inputs of a step into `known`."""
    for j in range(inputs.shape[1]):
        known[at + j] = inputs[step, j]


@part(borrowing=True)
def set_free_rates(guess: Array, at: int, law: Array) -> float:
    """Copy the rates and aims without reactions; returns the rate below which a sign is rounding."""
    count, largest = law.shape[1], 0.0
    for i in range(count):
        law[DRIFT, i] = guess[at + i]
        law[AIM, i] = guess[at + count + i]
        largest = max(largest, abs(guess[at + i]), abs(guess[at + count + i]))
    return ROUNDING * largest


@part(borrowing=True)
def change_sides(law: Array, least: int) -> None:
    """Move reactions from number `least` upwards to the side that fits."""
    for i in range(least, law.shape[1]):
        law[SIDE, i] = law[BETTER, i]


@part(borrowing=True)
def set_means(guess: Array, pull: Array, force: Array, known: Array, at: int) -> float:
    """Copy mean velocities and forces of the step into `known`; returns their sum, finite if all are numbers."""
    n, count = pull.shape
    total = 0.0
    for i in range(n):
        w = guess[i]
        for j in range(count):
            w -= pull[i, j] * force[j]
            known[at + n + j] = force[j]
        known[at + i] = w
        total += w
    return total


@part(borrowing=True)
def advance_motion(inertia: Array, moved: Array, h: float, known: Array, at: int) -> None:
    """Advance displacements and momenta from the start of the step to its end."""
    n = inertia.shape[0]
    for i in range(n):
        momentum = -known[n + i]
        for j in range(n):
            momentum += inertia[i, j] * known[at + j]
        for j in range(moved.shape[1]):
            momentum += moved[i, j] * known[2 * n + j]
        known[n + i] = momentum
        known[i] += h * known[at + i]


def _types(types: Any) -> Any:
    vector, matrix, numbers = types.float64[::1], types.float64[:, ::1], types.int64[::1]
    step = types.NamedTuple([*[matrix] * 6, types.float64, matrix, matrix], Step)
    scratch = types.NamedTuple([vector, vector, matrix, numbers] * 2, Scratch)
    return step, matrix, types.NamedUniTuple(types.int64, 3, Stretch), vector, matrix, scratch, matrix


@kernel("time stepping", _types, borrowing=True)
def march(step: Step, inputs: Array, stretch: Stretch, known: Array, law: Array, scratch: Scratch, out: Array) -> Any:
    """Step through `inputs`, a row each; `known` and `law` are kept for the next ones. Samples are added to `out`.

    Where inertia carries a combination of rates, the aims of its frictions get the vector a with Z a = rates of least
    sum a_i^2 / weight_i.

    Reactions: start from the sides of the step before; all misfits change at once while their number falls, then only
    the last one, which comes to an end for every P-matrix. Source: Judice and Pires (1994), block principal pivoting
    for linear complementarity problems with bounds.

    Returns how it ended and the step that it reached.
    """
    predict, G, pull, Z, inertia, moved, h, starts, ends = step
    first, total, every = stretch
    guess, force, LU, pivots, weight, taken, Q, order = scratch
    n, count = pull.shape
    w = known.shape[0] - n - count
    sample, left = (first + every - 1) // every, -first % every  # the next one, and the steps until then
    for now in range(first, first + inputs.shape[0]):
        fill_inputs(inputs, now - first, known, 2 * n)
        multiply_vector(predict, known, guess)
        slack = set_free_rates(guess, n, law)
        for _ in range(min(Z.shape[0], 1)):
            set_weights(law, weight)
            fill_share_equations(Z, guess, n + 2 * count, weight, Q, taken)
            factor_by_quotients(Q, order)
            solve_by_quotients(Q, order, taken)
            shift_aims(weight, taken, law)
        wrong, fewest, patience, tried = 1, count + 1, PATIENCE, 0
        while wrong > 0 and tried < LIMIT:
            changed = set_forces(law, force)
            if changed:
                fill_force_equations(G, law, LU)
                factor_by_quotients(LU, pivots)
            solve_by_quotients(LU, pivots, force)
            wrong, last = count_misfits(G, law, force, slack)
            tried, patience = tried + 1, patience - 1
            if wrong < fewest:
                fewest, patience = wrong, PATIENCE
            change_sides(law, 0 if patience >= 0 else last)
        check = set_means(guess, pull, force, known, w)
        if wrong > 0 or not abs(check) < 1e300:
            return STUCK if wrong > 0 else INFINITE, now
        if left == 0:
            observe(starts, known, 1.0 if now == 0 else 0.5, out, sample)
            sample, left = sample + 1, every
        left -= 1
        if left == 0:
            observe(ends, known, 1.0 if now + 1 == total else 0.5, out, sample)
        advance_motion(inertia, moved, h, known, w)
    return DONE, first + inputs.shape[0]
