"""Location of guard crossings along a piece of the motion: guards as polynomials, and their first roots."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.arrays import FRICTION, NONE, Floats, Run
from inerter.kernels.decorators import part
from inerter.kernels.flow import first_root, orders_in, slope_at, value_at
from inerter.kernels.lanes import in_groups, multiply_add
from inerter.kernels.locking import can_be_in

ORDERS = 6  # derivatives that are looked at to see on which side of its limit a guard goes
ROUNDING = 1e-13  # relative to the largest state so far
MET = 1e-9  # the same where a guard has just been met
_NEGLIGIBLE = 1e-19  # last coefficients of a guard relative to its change: far below its rounding


@part(borrowing=True, inside=True)
def first_crossing(run: Run, count: int, d: float, ends: bool) -> Any:
    """Time of the first guard crossing in units of the piece (at most 1), and its element, or -1.

    The piece has the length d and `ends` with the segment or before.
    """
    mechanics, place, modes, room = run.mechanics, run.motion.place[0], run.modes, run.room
    sizes, m = mechanics.sizes, place.mode
    best = 2.0
    who = NONE
    ended = place.ended != 0
    place.ended = 0
    for e in range(sizes.elements):
        watch = run.motion.watch[e]
        if watch.touch < ORDERS:
            slips = mechanics.kind[e] == FRICTION and modes.state[m, e] != 0 and can_be_in(mechanics.limits, e, 0)
            if slips and ended and _lies_still(run, e, min(count - 1, ORDERS), modes.reach[m] / d):
                watch.crossed = modes.state[m, e]
                best, who = 0.0, e
                break
            s = _crossing(run, e, count - 1, ends)
            if slips and ends and _comes_to_zero(room.guard, count - 1):
                place.ended = 1
            if s < best:
                best, who = s, e
    return min(best, 1.0), who


@part(borrowing=True, inside=True)
def advance_to(run: Run, count: int, s: float) -> bool:
    """Advance the state to the part s of the piece; False if the motion has grown beyond all bounds."""
    motion, sizes, X = run.motion, run.mechanics.sizes, run.room.series
    groups, ending = in_groups(X, 0, X.shape), orders_in(X)
    for g in range(groups.shape[1]):
        total = groups[count - 1, g]
        for k in range(count - 2, -1, -1):
            total = multiply_add(total, s, groups[k, g])
        groups[ending, g] = total
    for i in range(sizes.states):
        value = X[ending, i]
        if not (abs(value) < 1e150):
            return False
        motion.state[i] = value
        motion.scale[i] = max(motion.scale[i], abs(value))
    if s > 0.0:
        for e in range(sizes.elements):
            motion.watch[e].touch = 0
    return True


@part(borrowing=True, inside=True)
def _crossing(run: Run, e: int, count: int, ends: bool) -> float:
    """First time, in units of the piece, at which the guard of element e is crossed; 2 if it is not.

    Its `crossed` is then the limit, if it is crossed with a slope beyond all rounding, else 0. A limit that is just
    reached where the segment `ends` is left to the next one: inputs may turn there.
    """
    limits, watch = run.modes.limits[run.motion.place[0].mode, e], run.motion.watch[e]
    if limits[0] == -np.inf and limits[1] == np.inf:
        return 2.0
    c, g, swing = run.room.guard, run.room.distance, _guard_polynomial(run, e, count)
    while count > ORDERS and abs(c[count - 1]) <= _NEGLIGIBLE * swing:
        count -= 1
    best = 2.0
    for at in range(2):
        side, limit = 2 * at - 1, limits[at]
        zeros = watch.touch if watch.side == side else 0
        if abs(limit) == np.inf or (zeros == 0 and side * (limit - c[0]) > swing):
            continue
        for k in range(zeros, count):
            g[k - zeros] = -side * c[k]
        if zeros == 0:
            g[0] += side * limit
        root = first_root(g, count - zeros, run.room.ends)
        if ends and root > 1.0 - MET:
            size = swing + abs(c[0]) + abs(limit)
            root = 2.0 if value_at(g, count - zeros, 1.0) > -ROUNDING * size else root
        if root < best:
            best = root
            watch.crossed = side if slope_at(g, count - zeros, root) < -1e-6 * swing else 0
    return best


@part(borrowing=True, inside=True)
def _guard_polynomial(run: Run, e: int, count: int) -> float:
    """Fill `room.guard` with the polynomial of a guard along the piece; returns a bound of its change."""
    X, c, column, swing = run.room.series, run.room.guard, run.mechanics.sizes.states + e, 0.0
    first = orders_in(X) + 1
    for k in range(count):
        c[k] = X[first + k, column]
        swing += abs(c[k])
    return float(swing - abs(c[0]))


@part("boolean(float64[::1], int64)", borrowing=True)
def _comes_to_zero(c: Floats, count: int) -> bool:
    """Whether a polynomial is zero at 1, and not before."""
    total, size = 0.0, 0.0
    for k in range(count):
        total += c[k]
        size += abs(c[k])
    return abs(total) <= ROUNDING * size and abs(c[0]) > MET * size


@part(borrowing=True, inside=True)
def _lies_still(run: Run, e: int, count: int, longer: float) -> bool:
    """Whether a slip that has come to zero has ended for good: its velocity and the rates of it are rounding.

    What the piece would add up to if it were so many times `longer` counts: in a short one a slip that begins is slow.
    """
    n, nu, X, U = run.mechanics.sizes.states, run.mechanics.sizes.inputs, run.room.series, run.room.inputs
    row = run.modes.maps[run.motion.place[0].mode, run.mechanics.rows.guard + e]
    first, size, change, scale = orders_in(X) + 1, abs(row[n + nu]), 0.0, 1.0
    for j in range(n):
        size += abs(row[j] * X[0, j])
    for j in range(nu):
        size += abs(row[n + j] * U[0, j])
    for k in range(1, count):
        scale *= longer
        change += abs(X[first + k, n + e]) * scale
    return bool(abs(X[first, n + e]) + change <= ROUNDING * size)
