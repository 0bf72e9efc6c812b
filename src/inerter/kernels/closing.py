"""From a descriptor and values to A, B, C, D, and from gradients over those back to gradients over the values.

The descriptor is the tuple (S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u) of `inerter.systems.descriptor`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels import part
from inerter.kernels.linalg import copy, factor, solve, solve_transposed

Array = Any
_EPS = 2.2e-16
_TERMS = 4  # roundings, in eps, of an entry of S and R: of its terms and their sum


@part()
def contract(p: Array, stack: Array, out: Array) -> None:
    """Sum up a stack: out = stack[0] + sum p[i] stack[1 + i]."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            total = stack[0, i, j]
            for k in range(p.size):
                total += p[k] * stack[k + 1, i, j]
            out[i, j] = total


@part()
def even_out(S: Array, T: Array, size: Array) -> None:
    """Divide each equation by its largest coefficient: inertia, damping and stiffness differ by their units."""
    for i in range(S.shape[0]):
        largest = 0.0
        for j in range(S.shape[1]):
            largest = max(largest, abs(S[i, j]))
        size[i] = largest
        if largest > 0.0:
            for j in range(S.shape[1]):
                S[i, j] /= largest
            for j in range(T.shape[1]):
                T[i, j] /= largest


@part()
def errors_space(descriptor: Array) -> Any:
    """Room for `errors_in`."""
    S, R, F, _, _, _, _, Y_x, _ = descriptor
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    sizes = np.empty((e, e)), np.empty((e, n + m)), np.empty((o, e)), np.empty((o, n))
    return np.empty((n, n)), np.empty((n, m)), np.empty((o, n)), sizes, np.empty((e, e)), np.empty((e, n + m))


@part()
def errors_in(room: Array, p: Array, descriptor: Array, sizes: Array, space: Array) -> None:
    """Fill `room` with bounds of the rounding errors of the A, B and C that `close_in` has filled `space` with.

    `sizes` are stacks like S, R, F, Y_eta and Y_x of the descriptor, with the sizes of all terms in place of the terms.
    """
    _, _, _, X_eta, X_x, X_u, _, _, _ = descriptor
    E_A, E_B, E_C, (S, RF, Y_size, Y_x), inverse, unsure = room
    _, _, _, _, T, (LU, pivots, size), Y, column = space
    e, n, m, o = S.shape[0], E_A.shape[0], E_B.shape[1], E_C.shape[0]
    contract(p, sizes[0], S)
    contract(p, sizes[1], RF[:, :n])
    contract(p, sizes[2], RF[:, n:])
    contract(p, sizes[3], Y_size)
    contract(p, sizes[4], Y_x)
    rounding = (_TERMS + e) * _EPS
    for k in range(e):
        for i in range(e):
            column[i] = 0.0
        column[k] = 1.0
        solve(LU, pivots, column)
        for i in range(e):
            inverse[i, k] = rounding * abs(column[i]) / size[k]
    for k in range(e):
        for j in range(n + m):
            for i in range(e):
                RF[k, j] += S[k, i] * abs(T[i, j])
    for k in range(e):
        for j in range(n + m):
            unsure[k, j] = _EPS * abs(T[k, j])
        for i in range(e):
            x = inverse[k, i]
            if x != 0.0:
                for j in range(n + m):
                    unsure[k, j] += x * RF[i, j]
    for i in range(n):
        for j in range(n):
            E_A[i, j] = _EPS * abs(X_x[i, j])
        for j in range(m):
            E_B[i, j] = _EPS * abs(X_u[i, j])
        for k in range(e):
            x = abs(X_eta[i, k])
            if x != 0.0:
                for j in range(n):
                    E_A[i, j] += x * unsure[k, j]
                for j in range(m):
                    E_B[i, j] += x * unsure[k, n + j]
    for i in range(o):
        for j in range(n):
            E_C[i, j] = _TERMS * _EPS * Y_x[i, j]
        for k in range(e):
            y, more = abs(Y[i, k]), rounding * Y_size[i, k]
            if more != 0.0:
                for j in range(n):
                    E_C[i, j] += y * unsure[k, j] + more * abs(T[k, j])


@part()
def closing_space(descriptor: Array) -> Any:
    """Room for `close_in`: allocation would cost as much as the arithmetic."""
    S, R, F, _, _, _, _, Y_x, _ = descriptor
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    A, B, C, D = np.empty((n, n)), np.empty((n, m)), np.empty((o, n)), np.empty((o, m))
    T, LU, pivots, size = np.empty((e, n + m)), np.empty((e, e)), np.empty(e, np.int64), np.empty(e)
    return A, B, C, D, T, (LU, pivots, size), np.empty((o, e)), np.empty(e)


@part()
def close(p: Array, descriptor: Array) -> Any:
    """A, B, C, D, the solution T = S^-1 [R F], the factors of S, and whether all went well."""
    space = closing_space(descriptor)
    good = close_in(space, p, descriptor)
    A, B, C, D, T, factors, _, _ = space
    return A, B, C, D, T, factors, good


@part()
def close_in(space: Array, p: Array, descriptor: Array) -> bool:
    """Fill `space` with what `close` returns; False if S is singular."""
    S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u = descriptor
    A, B, C, D, T, factors, Y, column = space
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
    even_out(LU, T, size)
    if not factor(LU, pivots):
        return False
    for j in range(n + m):
        for i in range(e):
            column[i] = T[i, j]
        solve(LU, pivots, column)
        for i in range(e):
            T[i, j] = column[i]
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
