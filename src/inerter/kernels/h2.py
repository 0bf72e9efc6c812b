"""H2 norms and their gradients, compiled, for many values of one descriptor.

The covariance solves A P + P A' + W = 0 as one linear system for its n (n + 1) / 2 entries. The adjoint equation
A' Q + Q A + C' C = 0 has the transpose of the same matrix, up to the double count of off-diagonal entries, so both
share one factorisation.

A state that only the road moves has a row of zeros in A and a covariance that is known beforehand (see `Coordinates`).
That takes the place of its equation, which says nothing, and the others follow it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close_extended, extended_space, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.double_double import add_multiple
from inerter.kernels.linalg import exponential, factor, factor_within, matmul, solve, solve_transposed

Array = Any
_ACCURATE = 1e-9  # relative error of a squared norm up to which it is believed
_SMALL = 1e-7  # relative size of the terms of a correction at first order up to which the rest is far below that
_DAMPED = 1e-6  # relative correction of a variance from which on its motion may be damped by rounding
_REFINED = 3e-5  # correction from which on the twofold A and B, right at first order, may be off by `_ACCURATE`
_FOUND, _REFINEMENTS = 1e-2, 5  # correction up to which others may make it small; how many in all
_SOLVED = 1e-3  # share of the noise that enters a state that the solution may leave over
_EPS = 2.2e-16
_ENTERED = 8.0 * _EPS  # relative error of what the road puts into a state that only it moves, and of its covariance


@part()
def units(A: Array) -> Array:
    """Units of the states that even out rows and columns of A: a few sweeps of balancing."""
    scale = np.empty(A.shape[0])
    balance(A, scale, np.empty(A.shape[0]))
    return scale


@part(borrowing=True)
def balance(A: Array, scale: Array, inverse: Array) -> None:
    """Fill `scale` with `units`. They depend on A alone, so that a result does not depend on what came before it."""
    n = A.shape[0]
    for i in range(n):
        scale[i], inverse[i] = 1.0, 1.0
    for _ in range(3):
        for i in range(n):
            row, column = 0.0, 0.0
            for j in range(n):
                if j != i:
                    row += abs(A[i, j]) * scale[j]
                    column += abs(A[j, i]) * inverse[j]
            if column > 0.0:
                scale[i] = np.sqrt(row / column) if row > 0.0 else 1.0 / column
                inverse[i] = 1.0 / scale[i]


@part(borrowing=True)
def list_places(A: Array, place: Array, depends: Array, order: Array) -> None:
    """Fill `place` with the position of each entry of a symmetric matrix in the vector of its distinct entries.

    An entry stands before those that its equation in A P + P A' has from states which A moves without being moved by
    them, as a filter is moved by what it filters: blocks of zeros under the diagonal then stay zero in the factors.
    """
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            depends[i, j] = A[i, j] != 0.0 or i == j
    for k in range(n):
        for i in range(n):
            if depends[i, k]:
                for j in range(n):
                    depends[i, j] = depends[i, j] or depends[k, j]
    count = 0
    for size in range(n, 0, -1):  # what depends on more states comes first
        for i in range(n):
            total = 0
            for j in range(n):
                total += depends[i, j]
            if total == size:
                order[count] = i
                count += 1
    count, start = 0, 0
    while start < n:
        end = block_end(depends, order, start)
        first = start
        while first < n:
            last = block_end(depends, order, first)
            for i in range(start, end):
                for j in range(max(i, first), last):
                    place[order[i], order[j]] = count
                    place[order[j], order[i]] = count
                    count += 1
            first = last
        start = end


@part(borrowing=True)
def block_end(depends: Array, order: Array, start: int) -> int:
    """End of the block of mutually dependent states that begins at `start`."""
    end = start + 1
    while end < order.size and depends[order[start], order[end]] and depends[order[end], order[start]]:
        end += 1
    return end


@part()
def lyapunov_space(n: int) -> Any:
    """Room for the Lyapunov equations of order n: factors, pivots, places, units, a right-hand side, A in its units,
    and what places are found by.
    """
    N = n * (n + 1) // 2
    places, finding = np.empty((n, n), np.int64), (np.empty((n, n), np.bool_), np.empty(n, np.int64))
    units = np.ones(n), np.ones(n)
    return np.zeros((N, N)), np.empty(N, np.int64), places, units, np.empty(N), np.empty((n, n)), finding


@part(borrowing=True)
def lyapunov_factors(A: Array, drifts: Array, lyapunov: Array) -> bool:
    """Factors of P -> A P + P A' over symmetric P, in balanced units; False if singular.

    An entry of P between two of the states `drifts` is the negative of its right-hand side, and in no other equation.
    """
    K, pivots, place, (scale, inverse), _, scaled, (depends, order) = lyapunov
    n = A.shape[0]
    list_places(A, place, depends, order)
    balance(A, scale, inverse)
    for i in range(n):
        for j in range(n):
            scaled[i, j] = A[i, j] * scale[j] * inverse[i]
    K[:, :] = 0.0
    pivots[:] = 0  # until it is factored: the last row of each column that is not zero
    for i in range(n):
        for j in range(i, n):
            row = place[i, j]
            for k in range(n):
                if scaled[i, k] != 0.0:
                    K[row, place[k, j]] += scaled[i, k]
                    pivots[place[k, j]] = max(pivots[place[k, j]], row)
                if scaled[j, k] != 0.0:
                    K[row, place[i, k]] += scaled[j, k]
                    pivots[place[i, k]] = max(pivots[place[i, k]], row)
    for column in range(pivots.size):
        pivots[column] = max(pivots[column], column, pivots[max(column - 1, 0)])
    for i in range(drifts.size):
        for j in range(drifts.size):
            known = place[drifts[i], drifts[j]]
            for row in range(K.shape[0]):
                K[row, known] = 0.0
            K[known, known] = 1.0
    return factor_within(K, pivots)


@part()
def propagate_columns(
    A: Array, E_A: Array, time: float, u: Array, unsure: Array, pade: Array, out: Array, error: Array
) -> None:
    """Fill `out` with exp(A time) u, or its Pade approximant where `pade` has poles, and `error` with a bound of its
    error, from those of A, which is balanced, and of u.

    A change dA changes exp(A time) by the integral of exp(A (time - t)) dA exp(A t), taken at five places; the
    squarings of the exponential add n roundings each, of which the first ones are many.
    """
    poles, residues, direct = pade
    n = A.shape[0]
    if poles.size == 0:
        quarter, _, squarings = exponential(A * (0.25 * time), A, False)
        powers = np.empty((5, n, n))
        for i in range(n):
            for j in range(n):
                powers[4, i, j] = 1.0 if i == j else 0.0
        for k in range(3, -1, -1):
            matmul(quarter, powers[k + 1], powers[k])
        rounding, change = _EPS * (n * 2.0 ** (squarings + 2) + 15.0), np.empty(n)
        for i in range(n):
            error[i] = 0.0
            for j in range(n):
                error[i] += abs(powers[0, i, j]) * unsure[j]
        for step in range(5):
            for i in range(n):
                out[i] = 0.0
                for j in range(n):
                    out[i] += powers[4 - step, i, j] * u[j]
            for i in range(n):
                change[i] = rounding * abs(out[i])
                for j in range(n):
                    change[i] += time * E_A[i, j] * abs(out[j])
            for i in range(n):
                for j in range(n):
                    error[i] += 0.5 * abs(powers[step, i, j]) * change[j]
        return
    power = np.zeros((n, n))
    for i in range(n):
        out[i], error[i], power[i, i] = direct * u[i], 0.0, direct
    M, pivots, z = np.empty((n, n), np.complex128), np.empty(n, np.int64), np.empty(n, np.complex128)
    size, change = np.empty((n, n)), np.empty(n)
    for k in range(poles.size):
        for i in range(n):
            for j in range(n):
                M[i, j] = A[i, j] * time
            M[i, i] += poles[k]
            for j in range(n):
                size[i, j] = time * E_A[i, j] + 4.0 * n * _EPS * abs(M[i, j])
            z[i] = u[i]
        factor(M, pivots)
        solve(M, pivots, z)
        for i in range(n):
            out[i] -= (residues[k] * z[i]).real
            change[i] = 0.0
            for j in range(n):
                change[i] += size[i, j] * abs(z[j])
        for j in range(n):
            for i in range(n):
                z[i] = 0.0
            z[j] = 1.0
            solve(M, pivots, z)
            for i in range(n):
                error[i] += abs(residues[k]) * abs(z[i]) * change[j]
                power[i, j] -= (residues[k] * z[i]).real
    for i in range(n):
        for j in range(n):
            error[i] += abs(power[i, j]) * unsure[j]


@part()
def propagate_adjoint(
    A: Array, time: float, u: Array, bar: Array, poles: Array, residues: Array, direct: float, G_A: Array, out: Array
) -> None:
    """The adjoint of `propagate_columns`: adds d(bar' E u)/dA to G_A and fills `out` with E' bar."""
    n = A.shape[0]
    if poles.size == 0:
        N = np.empty((n, n))
        for i in range(n):
            for j in range(n):
                N[i, j] = time * bar[i] * u[j]
        E, L, _ = exponential(A.T.copy() * time, N, True)
        for i in range(n):
            for j in range(n):
                G_A[i, j] += L[i, j]
            out[i] = 0.0
            for j in range(n):
                out[i] += E[i, j] * bar[j]
        return
    for i in range(n):
        out[i] = direct * bar[i]
    M, pivots = np.empty((n, n), np.complex128), np.empty(n, np.int64)
    z, y = np.empty(n, np.complex128), np.empty(n, np.complex128)
    for k in range(poles.size):
        for i in range(n):
            for j in range(n):
                M[i, j] = A[i, j] * time
            M[i, i] += poles[k]
            z[i], y[i] = u[i], bar[i]
        factor(M, pivots)
        solve(M, pivots, z)
        solve_transposed(M, pivots, y)
        for i in range(n):
            out[i] -= (residues[k] * y[i]).real
            for j in range(n):
                G_A[i, j] += time * (residues[k] * y[i] * z[j]).real


@part(borrowing=True)
def solve_symmetric(lyapunov: Array, W: Array, adjoint: bool, P: Array) -> None:
    """P of A P + P A' + W = 0, or of A' P + P A + W = 0, from the factors of the former."""
    K, pivots, place, (scale, inverse), b, _, _ = lyapunov
    n = W.shape[0]
    into, out = (scale, inverse) if adjoint else (inverse, scale)
    for i in range(n):
        for j in range(i, n):
            weight = 2.0 if adjoint and i != j else 1.0
            b[place[i, j]] = -W[i, j] * weight * (into[i] * into[j])
    if adjoint:
        solve_transposed(K, pivots, b)
    else:
        solve(K, pivots, b)
    for i in range(n):
        for j in range(i, n):
            weight = 0.5 if adjoint and i != j else 1.0
            P[i, j] = b[place[i, j]] * weight * (out[i] * out[j])
            P[j, i] = P[i, j]


@part()
def norms_space(descriptor: Array) -> Any:
    """Room for `norms_in`."""
    n, m, o = descriptor[1].shape[2], descriptor[2].shape[2], descriptor[7].shape[1]
    return extended_space(descriptor), lyapunov_space(n), np.zeros((2, m, n)), np.empty((5, n, n)), np.empty((o, n))


@part()
def delayed_covariance(E_A: Array, B: Array, E_B: Array, lyapunov: Array, delayed: Array, arrivals: Array) -> None:
    """Fill `delayed` with the covariance of the state with each delayed input, and with bounds of its error."""
    gaps, (poles, residues, direct), (drifts, _) = arrivals
    _, _, _, (scale, _), _, scaled, _ = lyapunov
    n, m = B.shape
    E_scaled, u, unsure = np.empty((n, n)), np.empty(n), np.empty(n)
    for i in range(n):
        for j in range(n):
            E_scaled[i, j] = abs(E_A[i, j]) * scale[j] / scale[i]
    for c in range(1, m):
        for i in range(n):
            u[i] = (delayed[0, c - 1, i] + B[i, c - 1]) / scale[i]
            unsure[i] = (delayed[1, c - 1, i] + abs(E_B[i, c - 1])) / scale[i] + _EPS * abs(u[i])
        propagate_columns(
            scaled, E_scaled, gaps[c - 1], u, unsure, (poles, residues, direct), delayed[0, c], delayed[1, c]
        )
        for i in range(n):
            delayed[0, c, i] *= scale[i]
            delayed[1, c, i] *= scale[i]
        for i in range(drifts.size):  # they keep what they have
            w = drifts[i]
            delayed[0, c, w], delayed[1, c, w] = delayed[0, c - 1, w] + B[w, c - 1], 0.0


@part(borrowing=True)
def lyapunov_residual(lost: Array, A: Array, B: Array, delayed: Array, W: Array, P: Array, rest: Array) -> bool:
    """Fill `rest` with the residual A P + P A' + W, with A and B before rounding; W is overwritten.

    False if that is much of the noise that enters a state.
    """
    lost_A, lost_B = lost
    n, m = B.shape
    for i in range(n):
        noise = W[i, i]
        high, low = rest[i], W[i]
        for j in range(n):
            high[j], low[j] = 0.0, 0.0
        for k in range(n):
            if A[i, k] != 0.0:
                add_multiple(high, low, A[i, k], P[k], n)
            if lost_A[i, k] != 0.0:
                for j in range(n):
                    low[j] += lost_A[i, k] * P[k, j]
        for c in range(m):  # half of the noise: the other half comes with the transpose
            add_multiple(high, low, 0.5 * B[i, c], B[:, c], n)
            if c > 0:
                add_multiple(high, low, delayed[0, c, i], B[:, c], n)
            for j in range(n):
                low[j] += lost_B[i, c] * (B[j, c] + delayed[0, c, j])
        for j in range(n):
            high[j] += low[j]
        low[i] = noise
    for i in range(n):
        for j in range(i, n):
            rest[i, j] += rest[j, i]
            rest[j, i] = rest[i, j]
        if W[i, i] > 0.0 and not abs(rest[i, i]) <= _SOLVED * W[i, i]:
            return False
    return True


@part()
def norms_in(space: Array, p: Array, descriptor: Array, extended: Array, arrivals: Array, result: Array) -> float:
    """Fill `result` with the norm of each output; returns its doubt, see `assess_accuracy`.

    The residual A P + P A' + W, with A and B before rounding, corrects all rounding at first order:
    solved for once more it is what P lacks, whose share of a square has small terms where that can be believed.
    """
    closing, lyapunov, delayed, (W, P, Q, rest, lacks), CP = space
    if not close_extended(closing, p, descriptor, extended):
        return np.inf
    A, B, C = closing[0][0], closing[0][1], closing[0][2]
    lost_A, lost_B, lost_C, _ = closing[1]
    drifts, walks = arrivals[2]
    if not lyapunov_factors(A, drifts, lyapunov):
        return np.inf
    if B.shape[1] > 1:
        delayed_covariance(lost_A, B, lost_B, lyapunov, delayed, arrivals)
    matrices, lost = (A, B, C, delayed), (lost_A, lost_B, lost_C)
    return assess_accuracy(matrices, lost, lyapunov, (drifts, walks), (W, P, Q, rest, lacks, CP), result)


@part(borrowing=True)
def input_error(matrices: Array, lyapunov: Array, known: Array, result: Array, Q: Array) -> float:
    """Relative error of the squares from the delayed covariances and from the inputs of drifting states.

    A change of what enters changes the squares by its product with Q of A' Q + Q A + C' C = 0, C over the norms.
    """
    A, B, C, delayed = matrices
    drifts, walks = known
    n, m = B.shape
    for i in range(n):
        for j in range(n):
            Q[i, j] = 0.0
            for k in range(C.shape[0]):
                Q[i, j] += (C[k, i] / result[k]) * (C[k, j] / result[k])
    solve_symmetric(lyapunov, Q, True, Q)
    total = 0.0
    for i in range(drifts.size):
        for j in range(drifts.size):
            size = _ENTERED * abs(walks[i, j])
            total += size * abs(Q[drifts[i], drifts[j]])
            for k in range(n):
                total += 2.0 * size * abs(Q[k, drifts[j]] * A[k, drifts[i]])
            Q[drifts[i], drifts[j]] = 0.0  # nothing else enters there
        for k in range(n):
            for c in range(m):
                size = _ENTERED * abs(B[drifts[i], c]) * (abs(B[k, c]) + abs(delayed[0, c, k]))
                total += 2.0 * size * abs(Q[k, drifts[i]])
    for i in range(n):
        for j in range(n):
            for c in range(1, m):
                total += 2.0 * abs(Q[i, j]) * (delayed[1, c, i] * abs(B[j, c]))
    return total


@part(borrowing=True)
def refine(matrices: Array, lost: Array, lyapunov: Array, drifts: Array, room: Array) -> tuple[bool, float]:
    """Correct P until the correction is small; fill `rest` with its residual and `lacks` with the last correction.

    Whether that came to an end, and the largest share that a variance may lack: `_DAMPED` as P was, `_ACCURATE` where
    it had to be corrected, zero where one lacked more than `_REFINED` before.
    """
    A, B, _, delayed = matrices
    W, P, rest, lacks = room
    n, limit = A.shape[0], _DAMPED
    for _ in range(_REFINEMENTS):
        if not lyapunov_residual(lost, A, B, delayed, W, P, rest):
            return False, 0.0
        for i in range(drifts.size):
            for j in range(drifts.size):
                rest[drifts[i], drifts[j]] = 0.0
        solve_symmetric(lyapunov, rest, False, lacks)
        worst = 0.0
        for i in range(n):
            if not abs(lacks[i, i]) <= _FOUND * P[i, i]:
                return False, 0.0
            if P[i, i] > 0.0:
                worst = max(worst, abs(lacks[i, i]) / P[i, i])
        if worst <= max(limit, _ACCURATE):
            return True, limit
        limit = _ACCURATE if worst <= _REFINED and limit > 0.0 else 0.0
        for i in range(n):
            for j in range(n):
                P[i, j] += lacks[i, j]
    return False, 0.0


@part(borrowing=True)
def assess_accuracy(matrices: Array, lost: Array, lyapunov: Array, known: Array, room: Array, result: Array) -> float:
    """Fill `result` once A, B and C, the factors and `delayed` are there. See `norms_in`.

    Returns the sizes of the terms of the correction and of what rounding may add, relative to a square: the norm may be
    off by a small part of it. Infinite where it may be off by more than `_ACCURATE`.
    """
    A, B, C, delayed = matrices
    drifts, walks = known
    lost_A, lost_B, lost_C = lost
    W, P, Q, rest, lacks, CP = room
    n, m, o = A.shape[0], B.shape[1], C.shape[0]
    for i in range(n):
        for j in range(n):
            W[i, j] = 0.0
            for c in range(m):
                W[i, j] += B[i, c] * B[j, c] + delayed[0, c, i] * B[j, c] + B[i, c] * delayed[0, c, j]
    for i in range(drifts.size):
        for j in range(drifts.size):
            for k in range(n):
                W[k, drifts[j]] += A[k, drifts[i]] * walks[i, j]
                W[drifts[j], k] += A[k, drifts[i]] * walks[i, j]
    for i in range(drifts.size):
        for j in range(drifts.size):
            W[drifts[i], drifts[j]] = -walks[i, j]
    solve_symmetric(lyapunov, W, False, P)
    found, limit = refine(matrices, (lost_A, lost_B), lyapunov, drifts, (W, P, rest, lacks))
    if not found:
        return np.inf
    terms, unsure = 0.0, 0.0
    for k in range(o):
        total, change, size, rounding = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            CP[k, i], row, more, most = 0.0, 0.0, 0.0, 0.0
            for j in range(n):
                CP[k, i] += P[i, j] * C[k, j]
                more += lacks[i, j] * C[k, j]
                most += abs(lacks[i, j] * C[k, j])
                row += abs(P[i, j] * C[k, j])
            total += CP[k, i] * C[k, i]
            change += more * C[k, i] + 2.0 * CP[k, i] * lost_C[k, i]
            size += most * abs(C[k, i]) + 2.0 * abs(CP[k, i] * lost_C[k, i])
            rounding += n * _EPS * row * abs(C[k, i])
        if not total > 0.0:
            return np.inf
        result[k] = np.sqrt(total + change)
        terms += size / total
        unsure += rounding / total
    if m > 1 or drifts.size > 0:
        unsure += input_error(matrices, lyapunov, known, result, Q)
    believed = limit > 0.0 and terms <= min(_SMALL, limit) and unsure <= _ACCURATE
    return terms + unsure if believed else np.inf


@part()
def gradient_in(space: Array, p: Array, descriptor: Array, arrivals: Array, weights: Array, result: Array) -> Array:
    """Gradient over p of the weighted sum of the norms that `norms_in` has filled `result` with."""
    (closing, _, _, _, _, _), lyapunov, delayed, (CC, P, Q, _, _), CP = space
    A, B, C, _, T, factors, _, _ = closing
    gaps, (poles, residues, direct), _ = arrivals
    o, m, n = C.shape[0], B.shape[1], A.shape[0]
    CC[:, :] = 0.0
    G_C = np.zeros((o, n))
    for k in range(o):
        share = weights[k] / (2.0 * result[k]) if result[k] > 0.0 else 0.0
        for i in range(n):
            G_C[k, i] = 2.0 * share * CP[k, i]
            for j in range(n):
                CC[i, j] += share * C[k, i] * C[k, j]
    solve_symmetric(lyapunov, CC, True, Q)
    G_A, G_B, G_D = np.empty((n, n)), np.zeros((n, m)), np.zeros((o, m))
    matmul(Q, P, G_A)
    for i in range(n):
        for j in range(n):
            G_A[i, j] *= 2.0
    carry = np.zeros(n)  # what later arrivals make of the state that this one leaves
    u, bar = np.empty(n), np.empty(n)
    for c in range(m - 1, -1, -1):
        for i in range(n):
            here, before = 0.0, 0.0
            for j in range(n):
                here += Q[i, j] * B[j, c]
                before += Q[i, j] * delayed[0, c, j]
            G_B[i, c] += 2.0 * (here + before) + carry[i]
            bar[i] = 2.0 * here + carry[i]
        if c > 0:
            for i in range(n):
                u[i] = delayed[0, c - 1, i] + B[i, c - 1]
            propagate_adjoint(A, gaps[c - 1], u, bar, poles, residues, direct, G_A, carry)
    return pull_back(p, descriptor, T, factors, G_A, G_B, G_C, G_D)


@kernel(
    "r.m.s. norms",
    f"(float64[:,::1], {DESCRIPTOR}, UniTuple(float64[:,::1], 2), Tuple((float64[::1], Tuple((complex128[::1], "
    "complex128[::1], float64)), Tuple((int64[::1], float64[:,::1])))), float64[::1])",
)
def norms(points: Array, descriptor: Array, extended: Array, arrivals: Array, weights: Array) -> Any:
    """Norms (designs, outputs) at each row of `points`, gradients over it, and the doubts of the norms.

    The gradients (designs, values) are those of the sum of the norms with `weights`; none without weights. Norms that
    may be off are nan, or what was found, with its gradient; their doubt (see `assess_accuracy`) is infinite.
    `extended` as in `close_extended`. `arrivals` = (gaps, (poles, residues, direct), (drifts, walks)): times between an
    arrival of the road and the next, the Pade approximant (no poles: exact), and the states that only the road moves,
    if there are any, with their covariance.
    """
    space = norms_space(descriptor)
    count = points.shape[0]
    result, doubts = np.full((count, descriptor[7].shape[1]), np.nan), np.empty(count)
    gradients = np.full((count if weights.size > 0 else 0, points.shape[1]), np.nan)
    for i in range(count):
        doubts[i] = norms_in(space, points[i], descriptor, extended, arrivals, result[i])
        if weights.size > 0 and not np.isnan(result[i, -1]):
            gradient = gradient_in(space, points[i], descriptor, arrivals, weights, result[i])
            for j in range(gradient.size):
                gradients[i, j] = gradient[j]
    return result, gradients, doubts
