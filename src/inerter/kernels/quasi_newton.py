"""Quasi-Newton matrices of searches within bounds, compiled (Nocedal and Wright, 2006, sections 16.7 and 18.3)."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import part

Array = Any


@part(borrowing=True)
def reset(hessian: Array, scale: float) -> None:
    """Make the matrix `scale` times the identity."""
    for i in range(hessian.shape[0]):
        for j in range(hessian.shape[0]):
            hessian[i, j] = scale if i == j else 0.0


@part(borrowing=True)
def factorise_free(hessian: Array, held: Array, L: Array) -> bool:
    """Fill the Cholesky factor over the variables that are not held; False if there is none."""
    for i in range(hessian.shape[0]):
        for j in range(i + 1):
            is_held = held[i] == 1 or held[j] == 1
            total = hessian[i, j] if not is_held else 1.0 if i == j else 0.0
            for m in range(j):
                total -= L[i, m] * L[j, m]
            if i == j:
                if not total > 0.0:
                    return False
                L[i, i] = np.sqrt(total)
            else:
                L[i, j] = total / L[j, j]
    return True


@part(borrowing=True)
def solve_lower(L: Array, x: Array) -> None:
    """Overwrite x by the solution of L y = x."""
    for i in range(x.size):
        for m in range(i):
            x[i] -= L[i, m] * x[m]
        x[i] /= L[i, i]


@part(borrowing=True)
def solve_upper(L: Array, x: Array) -> None:
    """Overwrite x by the solution of L' y = x."""
    for i in range(x.size - 1, -1, -1):
        for m in range(i + 1, x.size):
            x[i] -= L[m, i] * x[m]
        x[i] /= L[i, i]


@part(borrowing=True)
def update(B: Array, s: Array, y: Array, Bs: Array) -> None:
    """BFGS update with Powell's damping for a step s that changes the gradient by y; `Bs` is room."""
    sBs, sy = 0.0, 0.0
    for i in range(s.size):
        Bs[i] = 0.0
        for j in range(s.size):
            Bs[i] += B[i, j] * s[j]
        sBs += s[i] * Bs[i]
        sy += s[i] * y[i]
    if not sBs > 1e-30:
        return
    theta = 1.0 if sy >= 0.2 * sBs else 0.8 * sBs / (sBs - sy)
    rs = theta * sy + (1.0 - theta) * sBs
    for i in range(s.size):
        ri = theta * y[i] + (1.0 - theta) * Bs[i]
        for j in range(s.size):
            rj = theta * y[j] + (1.0 - theta) * Bs[j]
            B[i, j] += ri * rj / rs - Bs[i] * Bs[j] / sBs
