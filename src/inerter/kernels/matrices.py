"""Matrix algebra that makes its results: products, blocks, null spaces, equations and the exponential.

For what is built once, in which it reads as it is written; `linalg` works in place, for what is done by thousands. All
are called, not copied into what calls them, so that what is built from many of them compiles in a second.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inerter.kernels.arrays import Ints, Matrix
from inerter.kernels.decorators import part
from inerter.kernels.linalg import factor, matmul, solve

RANK_TOLERANCE = 1e-9  # rows are scaled to one
ROUNDING = 1e-14  # of a sum, relative to its terms


class Spaces(NamedTuple):
    """Bases, as columns, of the vectors that all rows annihilate, and of a complement."""

    null: Matrix
    complement: Matrix


@part(typed=True, apart=True)
def product(A: Matrix, B: Matrix) -> Matrix:
    """A B."""
    out = np.empty((A.shape[0], B.shape[1]))
    matmul(A, B, out)
    return out


@part(typed=True, apart=True)
def inner(A: Matrix, B: Matrix) -> Matrix:
    """A^T B."""
    out = np.zeros((A.shape[1], B.shape[1]))
    for k in range(A.shape[0]):
        for i in range(A.shape[1]):
            a = A[k, i]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@part(typed=True, apart=True)
def unit(n: int) -> Matrix:
    """The unit matrix."""
    out = np.zeros((n, n))
    for i in range(n):
        out[i, i] = 1.0
    return out


@part(typed=True, apart=True)
def transpose(A: Matrix) -> Matrix:
    """A^T as a copy."""
    out = np.zeros((A.shape[1], A.shape[0]))
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[j, i] = A[i, j]
    return out


@part(typed=True, apart=True)
def add(out: Matrix, top: int, left: int, A: Matrix, sign: float) -> None:
    """Add sign * A to a block of `out`."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[top + i, left + j] += sign * A[i, j]


@part(typed=True, apart=True)
def block(A: Matrix, top: int, bottom: int, left: int, right: int) -> Matrix:
    """A block of A as a copy."""
    out = np.zeros((bottom - top, right - left))
    for i in range(bottom - top):
        for j in range(right - left):
            out[i, j] = A[top + i, left + j]
    return out


@part(typed=True, apart=True)
def sizes_of(A: Matrix) -> Matrix:
    """Absolute values."""
    out = np.zeros(A.shape)
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = abs(A[i, j])
    return out


@part(typed=True, apart=True)
def drop_rounding(A: Matrix, bound: Matrix) -> None:
    """Set to zero what is rounding of sums of terms as large as `bound`: what cannot move must not drift."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            if abs(A[i, j]) < ROUNDING * bound[i, j]:
                A[i, j] = 0.0


@part(typed=True, apart=True)
def is_zero(rows: Matrix, i: int) -> bool:
    """Whether a row is zero."""
    zero = True
    for j in range(rows.shape[1]):
        zero = zero and rows[i, j] == 0.0
    return zero


@part(typed=True, apart=True)
def null_space(rows: Matrix) -> Spaces:
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
    return Spaces(basis, complement)


@part(typed=True, apart=True)
def solve_scaled(S: Matrix, right: Matrix) -> bool:
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


@part(typed=True, apart=True)
def added_up(LU: Matrix, pivots: Ints) -> None:
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


@part(typed=True, apart=True)
def exponential(X: Matrix) -> Matrix:
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
