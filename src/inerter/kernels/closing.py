"""From a descriptor and values to A, B, C, D, and from gradients over those back to gradients over the values.

The descriptor is the tuple (S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u) of `inerter.systems.descriptor`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels import compiled
from inerter.kernels.linalg import factor, solve, solve_transposed

Array = Any


@compiled
def contract(p: Array, stack: Array, out: Array) -> None:
    """Sum up a stack: out = stack[0] + sum p[i] stack[1 + i]."""
    out[:, :] = stack[0]
    for k in range(p.size):
        value = p[k]
        for i in range(out.shape[0]):
            for j in range(out.shape[1]):
                out[i, j] += value * stack[k + 1, i, j]


@compiled
def close(p: Array, descriptor: Array) -> Any:
    """A, B, C, D, the solution T = S^-1 [R F], the factors of S, and whether all went well."""
    S, R, F, X_eta, X_x, X_u, Y_eta, Y_x, Y_u = descriptor
    e, n, m, o = S.shape[1], R.shape[2], F.shape[2], Y_x.shape[1]
    LU, pivots = np.empty((e, e)), np.empty(e, np.int64)
    RF = np.empty((e, n + m))
    contract(p, S, LU)
    contract(p, R, RF[:, :n])
    contract(p, F, RF[:, n:])
    good = factor(LU, pivots)
    A, B, C, D = X_x.copy(), X_u.copy(), np.empty((o, n)), np.empty((o, m))
    contract(p, Y_x, C)
    contract(p, Y_u, D)
    if good:
        column = np.empty(e)
        for j in range(n + m):
            for i in range(e):
                column[i] = RF[i, j]
            solve(LU, pivots, column)
            for i in range(e):
                RF[i, j] = column[i]
        Y = np.empty((o, e))
        contract(p, Y_eta, Y)
        for k in range(e):
            for i in range(n):
                x = X_eta[i, k]
                if x != 0.0:
                    for j in range(n):
                        A[i, j] += x * RF[k, j]
                    for j in range(m):
                        B[i, j] += x * RF[k, n + j]
            for i in range(o):
                y = Y[i, k]
                if y != 0.0:
                    for j in range(n):
                        C[i, j] += y * RF[k, j]
                    for j in range(m):
                        D[i, j] += y * RF[k, n + j]
    return A, B, C, D, RF, LU, pivots, good


@compiled
def pull_back(
    p: Array, descriptor: Array, T: Array, LU: Array, pivots: Array, G_A: Array, G_B: Array, G_C: Array, G_D: Array
) -> Array:
    """Gradient over the values p from the gradients over A, B, C and D.

    With T = S^-1 [R F]: dT = S^-1 (d[R F] - dS T), so one transposed solve serves every value.
    """
    S, R, F, X_eta, _, _, Y_eta, Y_x, Y_u = descriptor
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
