"""Lyapunov equations in compiled code: one linear system for the n (n + 1) / 2 entries of a symmetric matrix.

The adjoint equation A' Q + Q A + W = 0 has the transpose of the matrix of A P + P A' + W = 0, up to the double count of
off-diagonal entries, so both share one factorisation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import part
from inerter.kernels.dense import balance, factor_within, solve, solve_transposed

Array = Any


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
def lyapunov_factors(A: Array, drifting: Array, lyapunov: Array) -> bool:
    """Factors of P -> A P + P A' over symmetric P, in balanced units; False if singular.

    An entry of P between two of the states `drifting` is the negative of its right-hand side, and in no other equation.
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
    for i in range(drifting.size):
        for j in range(drifting.size):
            known = place[drifting[i], drifting[j]]
            for row in range(K.shape[0]):
                K[row, known] = 0.0
            K[known, known] = 1.0
    return factor_within(K, pivots)


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
