"""Delayed inputs in compiled code: exp(A t) u or its Pade approximant, with error bounds, and the adjoint of that.

The same as in `inerter.norms.delay`, which needs no compiler and checks this one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import part
from inerter.kernels.dense import count_squarings, exponential, factor, multiply, solve, solve_transposed

Array = Any
_EPS = 2.2e-16


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
        scaled = A * (0.25 * time)
        squarings = count_squarings(scaled)
        quarter = exponential(scaled, squarings)
        powers = np.empty((5, n, n))
        for i in range(n):
            for j in range(n):
                powers[4, i, j] = 1.0 if i == j else 0.0
        for k in range(3, -1, -1):
            multiply(quarter, powers[k + 1], powers[k])
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
        blocks = np.zeros((2 * n, 2 * n))
        for i in range(n):
            for j in range(n):
                blocks[i, j] = time * A[j, i]
                blocks[n + i, n + j] = blocks[i, j]
        squarings = count_squarings(blocks)
        for i in range(n):
            for j in range(n):
                blocks[i, n + j] = time * bar[i] * u[j]
        propagated = exponential(blocks, squarings)
        for i in range(n):
            out[i] = 0.0
            for j in range(n):
                G_A[i, j] += propagated[i, n + j]
                out[i] += propagated[i, j] * bar[j]
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
