"""H2 norms and their gradients, compiled, for many values of one descriptor.

The covariance P of the state solves A P + P A' + W = 0, and Q of the adjoint equation A' Q + Q A + C' C = 0 gives the
gradient; both share the factors of `inerter.kernels.lyapunov`.

A state that only the road moves has a row of zeros in A and a covariance that is known beforehand (see `Coordinates`).
That takes the place of its equation, which says nothing, and the others follow it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.close_descriptor import DESCRIPTOR, close_extended, extended_space, pull_back
from inerter.kernels.decorators import kernel, part
from inerter.kernels.delay import propagate_adjoint, propagate_columns
from inerter.kernels.dense import multiply
from inerter.kernels.double_double import add_multiple
from inerter.kernels.lyapunov import lyapunov_factors, lyapunov_space, solve_symmetric

Array = Any
_ACCURATE = 1e-9  # relative error of a squared norm up to which it counts as known
_SMALL = 1e-7  # relative size of the terms of a correction at first order up to which higher orders are far below that
_DAMPED = 1e-6  # relative correction of a variance from which on its motion may be damped by rounding
_REFINED = 3e-5  # correction from which on A and B in double-double, right at first order, may be off by `_ACCURATE`
_CORRECTABLE, _REFINEMENTS = 1e-2, 5  # largest correction that further ones may reduce; number of all
_RESIDUAL = 1e-3  # largest residual of a variance over the noise that enters its state
_EPS = 2.2e-16
_INPUT_ERROR = 8.0 * _EPS  # relative error of what the road puts into a state that only it moves, and of its covariance


@part()
def norms_space(descriptor: Array) -> Any:
    """Room for `norms_in`."""
    n, m, o = descriptor[1].shape[2], descriptor[2].shape[2], descriptor[7].shape[1]
    return extended_space(descriptor), lyapunov_space(n), np.zeros((2, m, n)), np.empty((5, n, n)), np.empty((o, n))


@part()
def delayed_covariance(E_A: Array, B: Array, E_B: Array, lyapunov: Array, delayed: Array, arrivals: Array) -> None:
    """Fill `delayed` with the covariance of the state with each delayed input, and with bounds of its error."""
    gaps, (poles, residues, direct), (drifting, _) = arrivals
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
        for i in range(drifting.size):  # they keep what they have
            w = drifting[i]
            delayed[0, c, w], delayed[1, c, w] = delayed[0, c - 1, w] + B[w, c - 1], 0.0


@part(borrowing=True)
def lyapunov_residual(
    remainders: Array, A: Array, B: Array, delayed: Array, W: Array, P: Array, residual: Array
) -> bool:
    """Fill `residual` with A P + P A' + W, where A + remainder_A and B + remainder_B are those before rounding.

    W is overwritten. False if the residual is much of the noise that enters a state.
    """
    remainder_A, remainder_B = remainders
    n, m = B.shape
    for i in range(n):
        noise = W[i, i]
        high, low = residual[i], W[i]
        for j in range(n):
            high[j], low[j] = 0.0, 0.0
        for k in range(n):
            if A[i, k] != 0.0:
                add_multiple(high, low, A[i, k], P[k], n)
            if remainder_A[i, k] != 0.0:
                for j in range(n):
                    low[j] += remainder_A[i, k] * P[k, j]
        for c in range(m):  # half of the noise: the other half comes with the transpose
            add_multiple(high, low, 0.5 * B[i, c], B[:, c], n)
            if c > 0:
                add_multiple(high, low, delayed[0, c, i], B[:, c], n)
            for j in range(n):
                low[j] += remainder_B[i, c] * (B[j, c] + delayed[0, c, j])
        for j in range(n):
            high[j] += low[j]
        low[i] = noise
    for i in range(n):
        for j in range(i, n):
            residual[i, j] += residual[j, i]
            residual[j, i] = residual[i, j]
        if W[i, i] > 0.0 and not abs(residual[i, i]) <= _RESIDUAL * W[i, i]:
            return False
    return True


@part()
def norms_in(space: Array, p: Array, descriptor: Array, extended: Array, arrivals: Array, result: Array) -> float:
    """Fill `result` with the norm of each output; returns their error estimate, see `assess_accuracy`.

    The residual A P + P A' + W, with A and B before rounding, gives the correction of P, which removes all rounding
    errors at first order; the norm counts as known where the terms of the correction of a square are small.
    """
    closing, lyapunov, delayed, (W, P, Q, residual, correction), CP = space
    if not close_extended(closing, p, descriptor, extended):
        return np.inf
    A, B, C = closing[0][0], closing[0][1], closing[0][2]
    remainder_A, remainder_B, remainder_C, _ = closing[1]
    if not lyapunov_factors(A, arrivals[2][0], lyapunov):
        return np.inf
    if B.shape[1] > 1:
        delayed_covariance(remainder_A, B, remainder_B, lyapunov, delayed, arrivals)
    matrices, remainders = (A, B, C, delayed), (remainder_A, remainder_B, remainder_C)
    room = W, P, Q, residual, correction, CP
    return assess_accuracy(matrices, remainders, lyapunov, arrivals[2], room, result)


@part(borrowing=True)
def input_error(matrices: Array, lyapunov: Array, known: Array, result: Array, Q: Array) -> float:
    """Relative error of the squares from the delayed covariances and from the inputs of drifting states.

    A change of what enters changes the squares by its product with Q of A' Q + Q A + C' C = 0, C over the norms.
    """
    A, B, C, delayed = matrices
    drifting, drift_covariance = known
    n, m = B.shape
    for i in range(n):
        for j in range(n):
            Q[i, j] = 0.0
            for k in range(C.shape[0]):
                Q[i, j] += (C[k, i] / result[k]) * (C[k, j] / result[k])
    solve_symmetric(lyapunov, Q, True, Q)
    total = 0.0
    for i in range(drifting.size):
        for j in range(drifting.size):
            size = _INPUT_ERROR * abs(drift_covariance[i, j])
            total += size * abs(Q[drifting[i], drifting[j]])
            for k in range(n):
                total += 2.0 * size * abs(Q[k, drifting[j]] * A[k, drifting[i]])
            Q[drifting[i], drifting[j]] = 0.0  # nothing else enters there
        for k in range(n):
            for c in range(m):
                size = _INPUT_ERROR * abs(B[drifting[i], c]) * (abs(B[k, c]) + abs(delayed[0, c, k]))
                total += 2.0 * size * abs(Q[k, drifting[i]])
    for i in range(n):
        for j in range(n):
            for c in range(1, m):
                total += 2.0 * abs(Q[i, j]) * (delayed[1, c, i] * abs(B[j, c]))
    return total


@part(borrowing=True)
def refine(matrices: Array, remainders: Array, lyapunov: Array, drifting: Array, room: Array) -> tuple[bool, float]:
    """Correct P until the `correction` is small; `residual` and `correction` are those that remain.

    Whether that converged, and the largest relative correction to accept: `_DAMPED` of P as solved for, `_ACCURATE`
    once it was corrected, zero where a correction was more than `_REFINED`.
    """
    A, B, _, delayed = matrices
    W, P, residual, correction = room
    n, limit = A.shape[0], _DAMPED
    for _ in range(_REFINEMENTS):
        if not lyapunov_residual(remainders, A, B, delayed, W, P, residual):
            return False, 0.0
        for i in range(drifting.size):
            for j in range(drifting.size):
                residual[drifting[i], drifting[j]] = 0.0
        solve_symmetric(lyapunov, residual, False, correction)
        worst = 0.0
        for i in range(n):
            if not abs(correction[i, i]) <= _CORRECTABLE * P[i, i]:
                return False, 0.0
            if P[i, i] > 0.0:
                worst = max(worst, abs(correction[i, i]) / P[i, i])
        if worst <= max(limit, _ACCURATE):
            return True, limit
        limit = _ACCURATE if worst <= _REFINED and limit > 0.0 else 0.0
        for i in range(n):
            for j in range(n):
                P[i, j] += correction[i, j]
    return False, 0.0


@part(borrowing=True)
def assess_accuracy(
    matrices: Array, remainders: Array, lyapunov: Array, known: Array, room: Array, result: Array
) -> float:
    """Fill `result` with the norms from A, B, C, the factors and `delayed`; see `norms_in`.

    Returns the sizes of the terms of the correction and of what rounding may add, relative to a square: the norm may be
    off by a small part of it. Infinite where it may be off by more than `_ACCURATE`.
    """
    A, B, C, delayed = matrices
    drifting, drift_covariance = known
    remainder_A, remainder_B, remainder_C = remainders
    W, P, Q, residual, correction, CP = room
    n, m, o = A.shape[0], B.shape[1], C.shape[0]
    for i in range(n):
        for j in range(n):
            W[i, j] = 0.0
            for c in range(m):
                W[i, j] += B[i, c] * B[j, c] + delayed[0, c, i] * B[j, c] + B[i, c] * delayed[0, c, j]
    for i in range(drifting.size):
        for j in range(drifting.size):
            for k in range(n):
                W[k, drifting[j]] += A[k, drifting[i]] * drift_covariance[i, j]
                W[drifting[j], k] += A[k, drifting[i]] * drift_covariance[i, j]
    for i in range(drifting.size):
        for j in range(drifting.size):
            W[drifting[i], drifting[j]] = -drift_covariance[i, j]
    solve_symmetric(lyapunov, W, False, P)
    found, limit = refine(matrices, (remainder_A, remainder_B), lyapunov, drifting, (W, P, residual, correction))
    if not found:
        return np.inf
    terms, unsure = 0.0, 0.0
    for k in range(o):
        total, change, size, rounding = 0.0, 0.0, 0.0, 0.0
        for i in range(n):
            CP[k, i], row, more, most = 0.0, 0.0, 0.0, 0.0
            for j in range(n):
                CP[k, i] += P[i, j] * C[k, j]
                more += correction[i, j] * C[k, j]
                most += abs(correction[i, j] * C[k, j])
                row += abs(P[i, j] * C[k, j])
            total += CP[k, i] * C[k, i]
            change += more * C[k, i] + 2.0 * CP[k, i] * remainder_C[k, i]
            size += most * abs(C[k, i]) + 2.0 * abs(CP[k, i] * remainder_C[k, i])
            rounding += n * _EPS * row * abs(C[k, i])
        if not total > 0.0:
            return np.inf
        result[k] = np.sqrt(total + change)
        terms += size / total
        unsure += rounding / total
    if m > 1 or drifting.size > 0:
        unsure += input_error(matrices, lyapunov, known, result, Q)
    is_known = limit > 0.0 and terms <= min(_SMALL, limit) and unsure <= _ACCURATE
    return terms + unsure if is_known else np.inf


@part()
def gradient_in(space: Array, p: Array, descriptor: Array, arrivals: Array, weights: Array, result: Array) -> Array:
    """Gradient over p of the weighted sum of the norms that `norms_in` has filled `result` with."""
    (closing, _, _, _, _, _), lyapunov, delayed, (CC, P, Q, _, _), CP = space
    A, B, C, _, T, factors, _ = closing
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
    multiply(Q, P, G_A)
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
    """Norms (designs, outputs) at each row of `points`, gradients over it, and error estimates (designs,).

    The gradients (designs, values) are those of the sum of the norms with `weights`; none without weights. Where
    norms may be off by more than `_ACCURATE`, the error estimate (see `assess_accuracy`) is infinite, and norms and
    gradient are nan or inaccurate. `extended` as in `close_extended`. `arrivals` = (gaps, (poles, residues, direct),
    (drifting, drift_covariance)): times between an arrival of the road and the next, the Pade approximant (no poles:
    exact), and the states that only the road moves, if there are any, with their covariance.
    """
    space = norms_space(descriptor)
    count = points.shape[0]
    result, errors = np.full((count, descriptor[7].shape[1]), np.nan), np.empty(count)
    gradients = np.full((count if weights.size > 0 else 0, points.shape[1]), np.nan)
    for i in range(count):
        errors[i] = norms_in(space, points[i], descriptor, extended, arrivals, result[i])
        if weights.size > 0 and not np.isnan(result[i, -1]):
            gradient = gradient_in(space, points[i], descriptor, arrivals, weights, result[i])
            for j in range(gradient.size):
                gradients[i, j] = gradient[j]
    return result, gradients, errors
