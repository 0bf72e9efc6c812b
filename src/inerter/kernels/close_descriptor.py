"""From a descriptor and values to A, B, C, D, and from gradients over those back to gradients over the values.

The descriptor is the tuple (S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u) of `inerter.systems.descriptor`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import part
from inerter.kernels.dense import copy, equilibrate_rows, factor, solve_rows, solve_transposed
from inerter.kernels.double_double import add_multiple

Array = Any
DESCRIPTOR = f"Tuple(({3 * 'float64[:,:,::1], '}{3 * 'float64[:,::1], '}{3 * 'float64[:,:,::1], '}))"  # its type


@part(borrowing=True)
def contract(p: Array, stack: Array, out: Array) -> None:
    """Sum up a stack: out = stack[0] + sum p[i] stack[1 + i]."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            total = stack[0, i, j]
            for k in range(p.size):
                total += p[k] * stack[k + 1, i, j]
            out[i, j] = total


@part()
def closing_space(descriptor: Array) -> Any:
    """Room for `close_in`: allocation would cost as much as the arithmetic."""
    S, R, F, _, _, _, _, Y_x, _ = descriptor
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    A, B, C, D = np.empty((n, n)), np.empty((n, m)), np.empty((o, n)), np.empty((o, m))
    T, LU, pivots, size = np.empty((e, n + m)), np.empty((e, e)), np.empty(e, np.int64), np.empty(e)
    return A, B, C, D, T, (LU, pivots, size), np.empty((o, e))


@part()
def split_up(values: Array, e: int, n: int, m: int, o: int) -> Any:
    """S, [R F], Y_eta and [Y_x Y_u], which stand in a row, as matrices."""
    first, second = e * e, e * e + e * (n + m)
    third = second + o * e
    return (
        values[:first].reshape((e, e)),
        values[first:second].reshape((e, n + m)),
        values[second:third].reshape((o, e)),
        values[third : third + o * (n + m)].reshape((o, n + m)),
    )


@part()
def extended_space(descriptor: Array) -> Any:
    """Room for `close_extended`: that of `close_in`, remainders of A, B, C, D, and sums in double-double."""
    S, R, F, _, _, _, _, Y_x, _ = descriptor
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    count = e * e + e * (n + m) + o * e + o * (n + m)
    high, low = np.empty(count), np.empty(count)
    remainders = np.empty((n, n)), np.empty((n, m)), np.empty((o, n)), np.empty((o, m))
    split = split_up(high, e, n, m, o), split_up(low, e, n, m, o)
    return closing_space(descriptor), remainders, high, low, split, np.empty((2, n + m))


@part(borrowing=True)
def close_extended(room: Array, p: Array, descriptor: Array, extended: Array) -> bool:
    """Fill A, B, C and D as `close_in` does, and their remainders: A + remainder_A is A before rounding, and so on.

    `extended` holds S, [R F], Y_eta and [Y_x Y_u] in a row, as a stack (1 + values, entries), and the remainders of
    that, an array without entries where they are zero. False if S is singular.
    """
    space, (remainder_A, remainder_B, remainder_C, remainder_D), high, low, split, (sum_high, sum_low) = room
    _, _, _, X_eta, X_x, X_u, _, _, _ = descriptor
    A, B, C, D, T, (LU, pivots, size), _ = space
    (S, right, Y, over), (S_low, right_low, Y_low, over_low) = split
    stack, fine = extended
    e, n, m, o = S.shape[0], A.shape[0], B.shape[1], C.shape[0]
    for q in range(high.size):
        high[q], low[q] = stack[0, q], 0.0
    for k in range(p.size):
        add_multiple(high, low, p[k], stack[k + 1], high.size)
    if fine.shape[0] > 0:
        for q in range(high.size):
            low[q] += fine[0, q]
            for k in range(p.size):
                low[q] += p[k] * fine[k + 1, q]
    copy(S, LU)
    copy(right, T)
    equilibrate_rows(LU, T, size)
    if not factor(LU, pivots):
        return False
    solve_rows(LU, pivots, T)
    for i in range(e):  # the residual of T takes the place of its right-hand side, then the correction of T
        for k in range(e):
            if S[i, k] != 0.0:
                add_multiple(right[i], right_low[i], -S[i, k], T[k], n + m)
                for j in range(n + m):
                    right_low[i, j] -= S_low[i, k] * T[k, j]
        for j in range(n + m):
            right[i, j] = (right[i, j] + right_low[i, j]) / size[i]
    solve_rows(LU, pivots, right)
    for i in range(n):
        for j in range(n):
            sum_high[j], sum_low[j] = X_x[i, j], 0.0
        for j in range(m):
            sum_high[n + j], sum_low[n + j] = X_u[i, j], 0.0
        for k in range(e):
            if X_eta[i, k] != 0.0:
                add_multiple(sum_high, sum_low, X_eta[i, k], T[k], n + m)
                for j in range(n + m):
                    sum_low[j] += X_eta[i, k] * right[k, j]
        for j in range(n):
            A[i, j], remainder_A[i, j] = sum_high[j], sum_low[j]
        for j in range(m):
            B[i, j], remainder_B[i, j] = sum_high[n + j], sum_low[n + j]
    for i in range(o):
        for k in range(e):
            if Y[i, k] != 0.0:
                add_multiple(over[i], over_low[i], Y[i, k], T[k], n + m)
                for j in range(n + m):
                    over_low[i, j] += Y_low[i, k] * T[k, j] + Y[i, k] * right[k, j]
        for j in range(n):
            C[i, j], remainder_C[i, j] = over[i, j], over_low[i, j]
        for j in range(m):
            D[i, j], remainder_D[i, j] = over[i, n + j], over_low[i, n + j]
    return True


@part()
def close(p: Array, descriptor: Array) -> Any:
    """A, B, C, D, the solution T = S^-1 [R F], the factors of S, and whether all went well."""
    space = closing_space(descriptor)
    good = close_in(space, p, descriptor)
    A, B, C, D, T, factors, _ = space
    return A, B, C, D, T, factors, good


@part(borrowing=True)
def close_in(space: Array, p: Array, descriptor: Array) -> bool:
    """Fill `space` with what `close` returns; False if S is singular."""
    S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u = descriptor
    A, B, C, D, T, factors, Y = space
    LU, pivots, size = factors
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    contract(p, S, LU)
    contract(p, R, T[:, :n])
    contract(p, F, T[:, n:])
    contract(p, Y_eta, Y)
    contract(p, Y_x, C)
    contract(p, Y_u, D)
    copy(X_x, A)
    copy(X_u, B)
    equilibrate_rows(LU, T, size)
    if not factor(LU, pivots):
        return False
    solve_rows(LU, pivots, T)
    for k in range(e):
        for i in range(n):
            x = X_eta[i, k]
            if x != 0.0:
                for j in range(n):
                    A[i, j] += x * T[k, j]
                for j in range(m):
                    B[i, j] += x * T[k, n + j]
        for i in range(o):
            y = Y[i, k]
            if y != 0.0:
                for j in range(n):
                    C[i, j] += y * T[k, j]
                for j in range(m):
                    D[i, j] += y * T[k, n + j]
    return True


@part()
def pull_back(
    p: Array, descriptor: Array, T: Array, factors: Array, G_A: Array, G_B: Array, G_C: Array, G_D: Array
) -> Array:
    """Gradient over the values p from the gradients over A, B, C and D.

    With T = S^-1 [R F]: dT = S^-1 (d[R F] - dS T), so one transposed solve serves every value.
    """
    S, R, F, X_eta, _, _, Y_eta, Y_x, Y_u = descriptor
    LU, pivots, size = factors
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    Y = np.empty((o, e))
    contract(p, Y_eta, Y)
    G_T = np.zeros((n + m, e))  # gradient over T, transposed; then S^-T times it
    for k in range(e):
        for i in range(n):
            x = X_eta[i, k]
            if x != 0.0:
                for j in range(n):
                    G_T[j, k] += x * G_A[i, j]
                for j in range(m):
                    G_T[n + j, k] += x * G_B[i, j]
        for i in range(o):
            y = Y[i, k]
            if y != 0.0:
                for j in range(n):
                    G_T[j, k] += y * G_C[i, j]
                for j in range(m):
                    G_T[n + j, k] += y * G_D[i, j]
    for j in range(n + m):
        solve_transposed(LU, pivots, G_T[j])
        for i in range(e):
            G_T[j, i] /= size[i]
    gradient = np.zeros(p.size)
    for v in range(p.size):
        total = 0.0
        for i in range(e):
            for j in range(n):
                total += G_T[j, i] * R[v + 1, i, j]
            for j in range(m):
                total += G_T[n + j, i] * F[v + 1, i, j]
            for k in range(e):
                s = S[v + 1, i, k]
                if s != 0.0:
                    for j in range(n + m):
                        total -= G_T[j, i] * s * T[k, j]
        for i in range(o):
            for j in range(n):
                total += G_C[i, j] * Y_x[v + 1, i, j]
            for j in range(m):
                total += G_D[i, j] * Y_u[v + 1, i, j]
            for k in range(e):
                y = Y_eta[v + 1, i, k]
                if y != 0.0:
                    for j in range(n):
                        total += G_C[i, j] * y * T[k, j]
                    for j in range(m):
                        total += G_D[i, j] * y * T[k, n + j]
        gradient[v] = total
    return gradient
