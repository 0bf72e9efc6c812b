"""Modes of a piecewise-linear mechanism: from what slips, sticks, touches and gapes to matrices.

With the velocities a that inertia carries, the positions g, the velocities w of massless motions, the forces F of the
nonlinear elements, and the roads' z, z', z'' and forces f of `Mechanics`:

    M a' + C_aw w + H_a^T F = -C_aa a - C_az z' - S_ag g - S_az z - M_z z'' + F_a f
           C_ww w + H_w^T F = -C_aw^T a - C_wz z' - S_wg g - S_wz z
    g' = P_a a + P_w w + P_z z'

An element i is either free, with F_i given (slip, open gap), or locked (stick, contact), with the rate of its
elongation H_a a + H_w w + H_z z' zero and F_i unknown. What a lock asks of massless velocities is met at once; what it
asks of inertial ones (the rows L) is differentiated, and must already be true when the mode begins. Massless motions
that only springs resist (Z) follow from the rate of the springs' balance, and those that nothing resists (Y) stay put;
their balance must be true too. These entry conditions, and the jump that would make them true, are kept with the mode.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.arrays import (
    DAMPERS,
    ENTRY,
    ETA,
    FRICTION,
    GAP,
    GUARD,
    KIND,
    NA,
    NR,
    NW,
    OUTPUT,
    OUTPUTS,
    OWN_POSITION,
    SEEN,
    SHARP,
    K,
    N,
)
from inerter.kernels.declare import kernel, part
from inerter.kernels.linalg import factor, solve

Array = Any
RANK_TOLERANCE = 1e-9  # incidence rows are scaled to one
ROUNDING = 1e-14  # of a sum, relative to its terms


@part("float64[:,::1](float64[:,::1], float64[:,::1])", apart=True)
def product(A: Array, B: Array) -> Array:
    """A B."""
    out = np.zeros((A.shape[0], B.shape[1]))
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@part("float64[:,::1](float64[:,::1], float64[:,::1])", apart=True)
def inner(A: Array, B: Array) -> Array:
    """A^T B."""
    out = np.zeros((A.shape[1], B.shape[1]))
    for k in range(A.shape[0]):
        for i in range(A.shape[1]):
            a = A[k, i]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@part("float64[:,::1](int64)", apart=True)
def unit(n: int) -> Array:
    """The unit matrix."""
    out = np.zeros((n, n))
    for i in range(n):
        out[i, i] = 1.0
    return out


@part("float64[:,::1](float64[:,::1])", apart=True)
def transposed(A: Array) -> Array:
    """A^T, in memory of its own."""
    out = np.zeros((A.shape[1], A.shape[0]))
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[j, i] = A[i, j]
    return out


@part("UniTuple(float64[:,::1], 2)(float64[:,::1])", apart=True)
def null_space(rows: Array) -> Any:
    """Bases of the vectors that all rows annihilate and of a complement, by elimination with complete pivoting."""
    m, n = rows.shape
    A = np.zeros((m, n))
    for i in range(m):
        for j in range(n):
            A[i, j] = rows[i, j]
    order = np.zeros(n, np.int64)
    for j in range(n):
        order[j] = j
    rank = 0
    while rank < min(m, n):
        best, p, q = RANK_TOLERANCE, -1, -1
        for i in range(rank, m):
            for j in range(rank, n):
                if abs(A[i, j]) > best:
                    best, p, q = abs(A[i, j]), i, j
        if p < 0:
            break
        for j in range(n):
            A[rank, j], A[p, j] = A[p, j], A[rank, j]
        for i in range(m):
            A[i, rank], A[i, q] = A[i, q], A[i, rank]
        order[rank], order[q] = order[q], order[rank]
        inverse = 1.0 / A[rank, rank]
        for j in range(rank, n):
            A[rank, j] *= inverse
        for i in range(m):
            if i != rank and A[i, rank] != 0.0:
                ratio = A[i, rank]
                for j in range(rank, n):
                    A[i, j] -= ratio * A[rank, j]
        rank += 1
    basis, complement = np.zeros((n, n - rank)), np.zeros((n, rank))
    for j in range(n - rank):
        basis[order[rank + j], j] = 1.0
        for i in range(rank):
            if abs(A[i, rank + j]) > RANK_TOLERANCE:
                basis[order[i], j] = -A[i, rank + j]
    for j in range(rank):
        complement[order[j], j] = 1.0
    return basis, complement


@part("boolean(int64, int64)", apart=True)
def is_locked(kind: int, state: int) -> bool:
    """Whether an element holds its elongation: friction that sticks, a gap that touches."""
    return (state == 0) == (kind == FRICTION)


@part("boolean(float64[::1], float64[:,::1], int64, float64[::1])", apart=True)
def adds_to(row: Array, basis: Array, count: int, rest: Array) -> bool:
    """Whether a row is independent of the first `count` orthonormal ones; `rest` is then the unit vector it adds."""
    size, left = 0.0, 0.0
    for j in range(rest.shape[0]):
        rest[j] = row[j]
        size += row[j] ** 2
    for _ in range(2):  # twice is enough for Gram-Schmidt
        for i in range(count):
            along = 0.0
            for j in range(rest.shape[0]):
                along += basis[i, j] * rest[j]
            for j in range(rest.shape[0]):
                rest[j] -= along * basis[i, j]
    for j in range(rest.shape[0]):
        left += rest[j] ** 2
    if left <= RANK_TOLERANCE**2 * size:
        return False
    for j in range(rest.shape[0]):
        rest[j] /= np.sqrt(left)
    return True


@part("Tuple((int64[::1], boolean[::1]))(float64[:,::1], int64[:,::1], int64[::1])", apart=True)
def independent_locks(locks: Array, elements: Array, state: Array) -> Any:
    """Numbers of locked elements whose rows are independent, and whether those hold each element.

    An element that depends on independent locks does not move; if it is locked itself, it is so without force.
    """
    k, columns = locks.shape
    basis, rest = np.zeros((k, columns)), np.zeros(columns)
    chosen, still = np.zeros(k, np.int64), np.zeros(k, np.bool_)
    count = 0
    for e in range(k):
        if is_locked(elements[e, KIND], state[e]) and adds_to(locks[e], basis, count, rest):
            for j in range(columns):
                basis[count, j] = rest[j]
            chosen[count] = e
            count += 1
    for e in range(k):
        still[e] = not adds_to(locks[e], basis, count, rest)
    return chosen[:count].copy(), still


@part("boolean(float64[:,::1], float64[:,::1])", apart=True)
def solve_rows(S: Array, right: Array) -> bool:
    """Solve S y = right for every column, rows and columns of S brought to one size; `right` becomes y.

    S becomes the sizes of what elimination added up in the place of each of its values.
    """
    size, width = S.shape[0], right.shape[1]
    rows, columns = np.zeros(size), np.zeros(size)
    for j in range(size):
        for i in range(size):
            columns[j] = max(columns[j], abs(S[i, j]))
        columns[j] = columns[j] if columns[j] > 0.0 else 1.0
    for i in range(size):
        for j in range(size):
            S[i, j] /= columns[j]
            rows[i] = max(rows[i], abs(S[i, j]))
        if not (rows[i] > 0.0):
            return False
        for j in range(size):
            S[i, j] /= rows[i]
        for j in range(width):
            right[i, j] /= rows[i]
    pivots = np.zeros(size, np.int64)
    if not factor(S, pivots):
        return False
    column = np.zeros(size)
    for j in range(width):
        for i in range(size):
            column[i] = right[i, j]
        solve(S, pivots, column)
        for i in range(size):
            right[i, j] = column[i] / columns[i]
    added_up(S, pivots)
    for i in range(size):
        for j in range(size):
            S[i, j] *= rows[i] * columns[j]
    return True


@part("void(float64[:,::1], int64[::1])", apart=True)
def added_up(LU: Array, pivots: Array) -> None:
    """Replace factors by |L| |U|, rows in the order of the matrix: rounding of elimination is as large, not less."""
    n = LU.shape[0]
    for i in range(n - 1, -1, -1):
        for j in range(n - 1, -1, -1):
            total = abs(LU[i, j]) if i < j else 0.0
            for k in range(min(i, j + 1)):
                total += abs(LU[i, k] * (LU[k, j] if k < j else 1.0 / LU[k, k]))
            LU[i, j] = total if i != j else total + abs(1.0 / LU[i, i])
    for k in range(n - 1, -1, -1):
        row = pivots[k]
        if row != k:
            for j in range(n):
                LU[k, j], LU[row, j] = LU[row, j], LU[k, j]


@part("void(float64[:,::1], int64, int64, float64[:,::1], float64)", apart=True)
def add(out: Array, top: int, left: int, A: Array, sign: float) -> None:
    """Add sign * A to a block of `out`."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[top + i, left + j] += sign * A[i, j]


@part("float64[:,::1](float64[:,::1], int64, int64, int64, int64)", apart=True)
def block(A: Array, top: int, bottom: int, left: int, right: int) -> Array:
    """A block of A, in memory of its own."""
    out = np.zeros((bottom - top, right - left))
    for i in range(bottom - top):
        for j in range(right - left):
            out[i, j] = A[top + i, left + j]
    return out


@part("float64[:,::1](float64[:,::1])", apart=True)
def sizes_of(A: Array) -> Array:
    """Absolute values."""
    out = np.zeros(A.shape)
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = abs(A[i, j])
    return out


@part("void(float64[:,::1], float64[:,::1])", apart=True)
def drop_rounding(A: Array, bound: Array) -> None:
    """Set to zero what is rounding of sums of terms as large as `bound`: what cannot move must not creep."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            if abs(A[i, j]) < ROUNDING * bound[i, j]:
                A[i, j] = 0.0


@part("void(float64[:,::1], float64[:,::1], int64)", apart=True)
def after_entry(maps: Array, mended: Array, entry: int) -> None:
    """Have all rows see the state as the conditions on entry leave it: drift off them then changes nothing."""
    rows, n, conditions, width = maps.shape[0], mended.shape[0], mended.shape[1], maps.shape[1]
    asked, bound = block(maps, entry, entry + conditions, 0, width), sizes_of(maps)
    add(bound, 0, 0, product(product(block(bound, 0, rows, 0, n), sizes_of(mended)), sizes_of(asked)), 1.0)
    for _ in range(2):  # what rounding of the first time leaves, the second removes
        add(maps, 0, 0, product(product(block(maps, 0, rows, 0, n), mended), asked), 1.0)
    drop_rounding(maps, bound)
    for i in range(conditions):
        for j in range(width):
            maps[entry + i, j] = asked[i, j]


@part("boolean(float64[:,::1], int64)", apart=True)
def is_zero(rows: Array, i: int) -> bool:
    """Whether a row is zero."""
    zero = True
    for j in range(rows.shape[1]):
        zero = zero and rows[i, j] == 0.0
    return zero


@part("void(float64[:,::1], int64, int64, float64[:,::1])", apart=True)
def unwatched(maps: Array, guard: int, n: int, limits: Array) -> None:
    """Limits of the guards while the mode lasts, behind them those on entry: what is constant need not be watched."""
    k, width = limits.shape[0] // 2, maps.shape[1]
    guards, rates = block(maps, guard, guard + k, 0, n), block(maps, 0, n, 0, width)
    change = product(guards, rates)
    bound = product(sizes_of(guards), sizes_of(rates))
    drop_rounding(change, bound)
    for e in range(k):
        limits[k + e, 0], limits[k + e, 1] = limits[e, 0], limits[e, 1]
        moves = not is_zero(change, e)
        for j in range(n, width - 1):
            moves = moves or maps[guard + e, j] != 0.0
        if not moves:
            limits[e, 0], limits[e, 1] = -np.inf, np.inf


@kernel(
    "modes of motion",
    "boolean(int64[::1], float64[:,::1], float64[:,::1], float64[:,::1], int64[:,::1], float64[::1], float64[:,::1], "
    "int64[::1], float64[:,::1], float64[:,::1], float64[:,::1])",
)
def build(
    sizes: Array,
    balance: Array,
    rates: Array,
    lengths: Array,
    elements: Array,
    limit: Array,
    over: Array,
    state: Array,
    maps: Array,
    reaction: Array,
    limits: Array,
) -> bool:
    """Fill one mode's maps, reaction and limits for its elements' states; False if the mode is singular.

    Arguments are those of `Mechanics`, then one row of those of `Modes`.
    """
    na, nw, nr, n, k = sizes[NA], sizes[NW], sizes[NR], sizes[N], sizes[K]
    ng, nv, width, columns = n - na, na + nw, maps.shape[1], na + nw + nr
    motion = block(rates, 0, ng, 0, columns)
    locks = block(rates, ng, ng + k, 0, columns)
    dampers = block(rates, ng + k, ng + k + sizes[DAMPERS], na, nv)
    springs = block(rates, ng + k + sizes[DAMPERS], rates.shape[0], na, nv)
    held, still = independent_locks(block(locks, 0, k, 0, nv), elements, state)
    nl = held.shape[0]
    H = np.zeros((nl, columns))
    for i in range(nl):
        for j in range(columns):
            H[i, j] = locks[held[i], j]
    H_a, H_w, H_z = block(H, 0, nl, 0, na), block(H, 0, nl, na, nv), block(H, 0, nl, nv, columns)

    X, _ = null_space(H_w)
    L, at_once = null_space(transposed(H_w))
    undamped = product(X, null_space(product(dampers, X))[0])
    loose, sprung = null_space(product(springs, undamped))
    Z, Y = product(undamped, sprung), product(undamped, loose)
    others, _ = null_space(transposed(undamped))

    sides = block(balance, 0, nv, nv, nv + width)
    on_wg, on_wz = block(sides, na, nv, na, n), block(sides, na, nv, n, n + nr)
    for e in range(k):
        if elements[e, KIND] == FRICTION:
            for j in range(nv):
                sides[j, width - 1] -= state[e] * limit[e] * locks[e, j]
    on_w = block(sides, na, nv, 0, width)
    S, right = np.zeros((nv + nl, nv + nl)), np.zeros((nv + nl, width))
    add(S, 0, 0, block(balance, 0, na, 0, nv), 1.0)
    add(S, 0, nv, transposed(H_a), 1.0)
    add(right, 0, 0, block(sides, 0, na, 0, width), 1.0)
    row = na
    # balances of the massless motions that something damps or locks
    add(S, row, na, inner(others, block(balance, na, nv, na, nv)), 1.0)
    add(S, row, nv, inner(others, transposed(H_w)), 1.0)
    add(right, row, 0, inner(others, on_w), 1.0)
    row += others.shape[1]
    # rate of the springs' balance
    nz = Z.shape[1]
    spring_rate = product(inner(Z, on_wg), motion)
    add(spring_rate, 0, nv, inner(Z, on_wz), 1.0)
    add(S, row, na, block(spring_rate, 0, nz, na, nv), -1.0)
    add(right, row, 0, block(spring_rate, 0, nz, 0, na), 1.0)
    add(right, row, n + nr, block(spring_rate, 0, nz, nv, columns), 1.0)
    row += nz
    add(S, row, na, transposed(Y), 1.0)
    row += Y.shape[1]
    # locks that massless motions meet at once, and locks between inertial motions
    add(S, row, na, inner(at_once, H_w), 1.0)
    add(right, row, 0, inner(at_once, H_a), -1.0)
    add(right, row, n + nr, inner(at_once, H_z), -1.0)
    row += at_once.shape[1]
    velocity = inner(L, H_a)
    add(S, row, 0, velocity, 1.0)
    add(right, row, n + 2 * nr, inner(L, H_z), -1.0)
    solved = np.zeros((nv + nl, width + nv + nl))
    add(solved, 0, 0, right, 1.0)
    add(solved, 0, width, unit(nv + nl), 1.0)
    if not solve_rows(S, solved):
        return False
    bound = sizes_of(right)  # of the residual of the solution that elimination finds
    add(bound, 0, 0, product(S, sizes_of(block(solved, 0, nv + nl, 0, width))), 1.0)
    bound = product(sizes_of(block(solved, 0, nv + nl, width, width + nv + nl)), bound)
    right = block(solved, 0, nv + nl, 0, width)
    drop_rounding(right, bound)

    for i in range(maps.shape[0]):
        for j in range(width):
            maps[i, j] = 0.0
    massless, massless_bound = block(right, na, nv, 0, width), block(bound, na, nv, 0, width)
    add(maps, 0, 0, block(right, 0, na, 0, width), 1.0)
    add(maps, na, 0, product(block(motion, 0, ng, na, nv), massless), 1.0)
    add(maps, na, 0, block(motion, 0, ng, 0, na), 1.0)
    add(maps, na, n + nr, block(motion, 0, ng, nv, columns), 1.0)
    grown = block(maps, na, n, 0, width)
    bound = sizes_of(grown)
    add(bound, 0, 0, product(sizes_of(block(motion, 0, ng, na, nv)), massless_bound), 1.0)
    drop_rounding(grown, bound)
    for i in range(ng):
        for j in range(width):
            maps[na + i, j] = grown[i, j]
    eta, guard = sizes[ETA], sizes[GUARD]
    add(maps, eta, 0, block(right, 0, nv, 0, width), 1.0)
    for i in range(nl):
        add(maps, eta + nv + held[i], 0, block(right, nv + i, nv + i + 1, 0, width), 1.0)
    for e in range(k):
        for j in range(width):
            if still[e] and elements[e, OWN_POSITION] >= 0:
                maps[na + elements[e, OWN_POSITION], j] = 0.0
        # what the state of each element asks: a row and the interval in which its value must stay
        limits[e, 0], limits[e, 1] = -np.inf, np.inf
        if limit[e] > 0.0:
            limits[e, 0] = -limit[e] if state[e] == 0 else (0.0 if state[e] > 0 else -np.inf)
            limits[e, 1] = limit[e] if state[e] == 0 else (0.0 if state[e] < 0 else np.inf)
        if elements[e, KIND] == FRICTION:
            maps[eta + nv + e, width - 1] += state[e] * limit[e]
        if is_locked(elements[e, KIND], state[e]):  # its force
            add(maps, guard + e, 0, block(maps, eta + nv + e, eta + nv + e + 1, 0, width), 1.0)
        elif elements[e, KIND] == GAP:  # open: its elongation
            add(maps, guard + e, na, block(lengths, e, e + 1, 0, ng + nr), 1.0)
        elif not still[e]:  # slip: its velocity
            add(maps, guard + e, 0, block(locks, e, e + 1, 0, na), 1.0)
            add(maps, guard + e, n + nr, block(locks, e, e + 1, nv, columns), 1.0)
            add(maps, guard + e, 0, product(block(locks, e, e + 1, na, nv), massless), 1.0)
            slip = block(maps, guard + e, guard + e + 1, 0, width)
            bound = sizes_of(slip)
            add(bound, 0, 0, product(sizes_of(block(locks, e, e + 1, na, nv)), massless_bound), 1.0)
            drop_rounding(slip, bound)
            for j in range(width):
                maps[guard + e, j] = slip[0, j]
    inputs = width - 1
    add(maps, sizes[OUTPUT], 0, block(over, 0, over.shape[0], 0, inputs), 1.0)
    on_eta = block(over, 0, over.shape[0], inputs, over.shape[1])
    add(maps, sizes[OUTPUT], 0, product(on_eta, block(maps, eta, sizes[ENTRY], 0, width)), 1.0)

    # conditions on entry: velocities across locks, balance of springs, balance of what is loose
    nc, entry = L.shape[1], sizes[ENTRY]
    state[k], state[k + 1], state[k + 2] = nc, nz, Y.shape[1]
    add(maps, entry, 0, velocity, 1.0)
    add(maps, entry, n + nr, inner(L, H_z), 1.0)
    add(maps, entry + nc, 0, inner(Z, on_w), 1.0)
    add(maps, entry + nc + nz, 0, inner(Y, on_w), 1.0)
    for i in range(n + k):
        for j in range(reaction.shape[1]):
            reaction[i, j] = 0.0
    locks_w = block(locks, 0, k, na, nv)
    impulse, inverse = transposed(velocity), unit(nc)
    if not solve_rows(block(balance, 0, na, 0, na), impulse):
        return False
    if not solve_rows(product(velocity, impulse), inverse):
        return False
    add(reaction, 0, 0, product(impulse, inverse), -1.0)
    forces = product(L, inverse)
    for i in range(nl):
        add(reaction, n + held[i], 0, block(forces, i, i + 1, 0, nc), 1.0)
    inverse = unit(nz)
    if not solve_rows(product(block(spring_rate, 0, nz, na, nv), Z), inverse):
        return False
    moved = product(Z, inverse)
    add(reaction, na, nc, product(block(motion, 0, ng, na, nv), moved), -1.0)
    add(reaction, n, nc, product(locks_w, moved), -1.0)
    add(reaction, n, nc + nz, product(locks_w, Y), 1.0)
    add(maps, sizes[SEEN], 0, unit(n), 1.0)
    after_entry(maps, block(reaction, 0, n, 0, nc + nz), entry)
    for e in range(k):
        slips = elements[e, KIND] == FRICTION and state[e] != 0 and not still[e] and limit[e] > 0.0
        if slips and is_zero(maps, guard + e):  # what cannot move sticks
            limits[e, 0 if state[e] > 0 else 1] = state[e]
    unwatched(maps, guard, n, limits)
    return True


@part("float64[:,::1](float64[:,::1])", apart=True)
def exponential(X: Array) -> Array:
    """exp(X), by a Taylor series of a scaled X and repeated squaring."""
    n = X.shape[0]
    norm = 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += abs(X[i, j])
        norm = max(norm, total)
    squarings = 0
    while norm > 0.5:
        norm *= 0.5
        squarings += 1
    scaled = block(X, 0, n, 0, n)
    for i in range(n):
        for j in range(n):
            scaled[i, j] = np.ldexp(X[i, j], -squarings)
    second = product(scaled, scaled)
    third, fourth = product(second, scaled), product(second, second)
    factorial = 20922789888000.0  # 16!, and 0.5^17 / 17! is below rounding
    power = np.zeros((n, n))
    add(power, 0, 0, fourth, 1.0 / factorial)
    for k in range(12, -1, -4):  # Horner's rule in powers of four: six products, not sixteen
        if k < 12:
            power = product(fourth, power)
        low = factorial / ((k + 4.0) * (k + 3.0) * (k + 2.0) * (k + 1.0))
        factorial = low
        for i in range(n):
            power[i, i] += 1.0 / low
            for j in range(n):
                at_two = scaled[i, j] + second[i, j] / (k + 2.0) + third[i, j] / ((k + 2.0) * (k + 3.0))
                power[i, j] += at_two / (low * (k + 1.0))
    for _ in range(squarings):
        power = product(power, power)
    return power


@part("void(float64[:,::1], int64, int64, int64, int64[::1], float64, float64[:,::1])", apart=True)
def over_chains(maps: Array, first: int, n: int, nr: int, channels: Array, h: float, out: Array) -> None:
    """Rows of maps, from `first` on, over the state, the chains of integrators of some channels, and 1."""
    for i in range(out.shape[0]):
        row = maps[first + i]
        for j in range(n):
            out[i, j] = row[j]
        for at in range(channels.shape[0]):
            c = channels[at]
            if c < nr:
                out[i, n + 4 * at] = row[n + c]
                out[i, n + 4 * at + 1] = row[n + nr + c] / h
                out[i, n + 4 * at + 2] = row[n + 2 * nr + c] / (h * h)
            else:
                out[i, n + 4 * at] = row[n + 2 * nr + c]
        out[i, out.shape[1] - 1] = row[maps.shape[1] - 1]


@part("Tuple((int64[::1], int64[::1]))(int64[::1])", apart=True)
def moving_channels(used: Array) -> Any:
    """Numbers of the channels of which a knot number is used, in order, and the used numbers among theirs alone."""
    channels, among = np.zeros(used.shape[0], np.int64), np.zeros(used.shape[0], np.int64)
    count = 0
    for i in range(used.shape[0]):
        if count == 0 or channels[count - 1] != used[i] // 4:
            channels[count] = used[i] // 4
            count += 1
        among[i] = 4 * (count - 1) + used[i] % 4
    return channels[:count].copy(), among


@part("void(float64[:,::1], int64, int64[::1], float64[:,::1], int64)", apart=True)
def into_knots(rows: Array, n: int, used: Array, out: Array, top: int) -> None:
    """Rows over the chains at the start of a step, as columns over the numbers z0, z1 - z0, h z0', h z1' of cubics."""
    size = rows.shape[1]
    numbers = np.zeros(size - 1 - n)
    for i in range(rows.shape[0]):
        for c in range(0, size - 1 - n, 4):
            y0, y1, y2, y3 = rows[i, n + c], rows[i, n + c + 1], rows[i, n + c + 2], rows[i, n + c + 3]
            numbers[c] = y0
            numbers[c + 1] = 6.0 * y2 - 12.0 * y3
            numbers[c + 2] = y1 - 4.0 * y2 + 6.0 * y3
            numbers[c + 3] = 6.0 * y3 - 2.0 * y2
        for j in range(n):
            out[j, top + i] = rows[i, j]
        for j in range(used.shape[0]):
            out[n + j, top + i] = numbers[used[j]]
        out[n + used.shape[0], top + i] = rows[i, size - 1]


@part("void(float64[:,::1], float64[:,::1], int64, int64[::1], float64[:,::1], int64, int64)", apart=True)
def _bound_sway(guards: Array, chain: Array, n: int, used: Array, steps: Array, bends: int, top: int) -> None:
    """One eighth of the largest second derivative of each guard over a step, as weights on absolute values.

    Its first terms go to the rows from `bends` on as they are, if that is not negative.
    """
    k, columns = guards.shape[0], n + used.shape[0] + 1
    term, power = np.zeros((columns, k)), guards
    for j in range(columns):
        for i in range(k):
            steps[j, top + i] = 0.0
    for order in range(1, 60):
        power = product(power, chain)
        largest = 0.0
        for i in range(k):
            for j in range(chain.shape[0]):
                power[i, j] /= order
                largest = max(largest, abs(power[i, j]))
        if largest == 0.0:
            break
        into_knots(power, n, used, term, 0)
        weight, first = order * (order - 1) / 8.0, bends + (order - 2) * k
        for j in range(columns):
            for i in range(k):
                if bends >= 0 and 2 <= order < 2 + SHARP:
                    steps[j, first + i] = weight * term[j, i]
                else:
                    steps[j, top + i] += weight * abs(term[j, i])


@part("float64(float64[:,::1], int64)", apart=True)
def growth(maps: Array, n: int) -> float:
    """About the spectral radius of the state matrix, from above: the 32nd root of a norm of its 32nd power [1/s]."""
    A = block(maps, 0, n, 0, n)
    logarithm, power = 0.0, 1.0
    for _ in range(6):
        norm = 0.0
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += abs(A[i, j])
            norm = max(norm, total)
        if norm == 0.0:
            return 0.0
        logarithm += power * np.log(norm)
        for i in range(n):
            for j in range(n):
                A[i, j] /= norm
        A = product(A, A)
        power *= 0.5
    return float(np.exp(logarithm))


@kernel("steps of a mode", "float64(int64[::1], int64[::1], float64[:,::1], float64[:,::1], float64)")
def discretise(sizes: Array, used: Array, maps: Array, steps: Array, h: float) -> float:
    """Exact flow of one mode over a step of length h, its guards and outputs there, and the guards' sway within it.

    The input over the step is a cubic: a chain of four integrators for every road and force that moves stands for it.
    Returns how far a Taylor series of the flow serves [s].
    """
    n, nr, k = sizes[N], sizes[NR], sizes[K]
    channels, used = moving_channels(used)
    size = n + 4 * channels.shape[0] + 1
    rate, guards = np.zeros((n, size)), np.zeros((k, size))
    outputs = np.zeros((sizes[OUTPUTS], size))
    over_chains(maps, 0, n, nr, channels, h, rate)
    over_chains(maps, sizes[GUARD], n, nr, channels, h, guards)
    over_chains(maps, sizes[OUTPUT], n, nr, channels, h, outputs)
    chain = np.zeros((size, size))
    add(chain, 0, 0, rate, h)
    for c in range(channels.shape[0]):
        for j in range(3):
            chain[n + 4 * c + j, n + 4 * c + j + 1] = 1.0
    exact = exponential(chain)
    into_knots(block(exact, 0, n, 0, size), n, used, steps, 0)
    into_knots(product(guards, exact), n, used, steps, n)
    into_knots(guards, n, used, steps, n + k)
    into_knots(product(outputs, exact), n, used, steps, n + 2 * k)
    columns, rows = n + used.shape[0] + 1, n + 2 * k + sizes[OUTPUTS]
    for c in range(min(nr, steps.shape[0] - columns)):  # roads that jump: positions follow; with a force nothing does
        for i in range(n):
            steps[columns + c, i] = maps[i, n + nr + c]
    if steps.shape[0] > columns:
        into_knots(outputs, n, used, steps, rows)
        rows += sizes[OUTPUTS]
    sways = steps.shape[1] - -(-k // 4) * 4
    _bound_sway(guards, chain, n, used, steps, rows if sways >= rows + SHARP * k else -1, sways)
    return 1.0 / max(growth(maps, n), 1e-9)
