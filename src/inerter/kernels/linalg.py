"""Small dense linear algebra in place, for real and complex matrices; faster than a library below order 20."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import part

Array = Any  # compiled code is typed when it is compiled


@part(borrowing=True)
def factor(A: Array, pivots: Array) -> bool:
    """LU factors of A in its place, with partial pivoting; False if A is singular. Rows should be of like size.

    The inverse of each pivot stands in its place: a product costs a tenth of a quotient.
    """
    for k in range(A.shape[0]):
        pivots[k] = A.shape[0] - 1
    return factor_within(A, pivots)


@part(borrowing=True)
def factor_within(A: Array, pivots: Array) -> bool:
    """LU factors of A in its place; each column is zero below the row in `pivots`, which are in ascending order."""
    n = A.shape[0]
    for k in range(n):
        best, row, end = abs(A[k, k]), k, pivots[k] + 1
        for i in range(k + 1, end):
            here = abs(A[i, k])
            if here > best:
                best, row = here, i
        if not (best > 0.0 and best < np.inf):
            return False
        pivots[k] = row
        if row != k:
            for j in range(n):
                A[k, j], A[row, j] = A[row, j], A[k, j]
        inverse = 1.0 / A[k, k]
        A[k, k] = inverse
        for i in range(k + 1, end):
            if A[i, k] != 0.0:
                ratio = A[i, k] * inverse
                A[i, k] = ratio
                for j in range(k + 1, n):
                    A[i, j] -= ratio * A[k, j]
    return True


@part(borrowing=True)
def solve(LU: Array, pivots: Array, b: Array) -> None:
    """Solve A x = b; b becomes x."""
    n = LU.shape[0]
    for k in range(n):
        row = pivots[k]
        if row != k:
            b[k], b[row] = b[row], b[k]
    for i in range(n):
        total = b[i]
        for j in range(i):
            total -= LU[i, j] * b[j]
        b[i] = total
    for i in range(n - 1, -1, -1):
        total = b[i]
        for j in range(i + 1, n):
            total -= LU[i, j] * b[j]
        b[i] = total * LU[i, i]


@part(borrowing=True)
def solve_rows(LU: Array, pivots: Array, X: Array) -> None:
    """Solve A Y = X for all columns at once; X becomes Y."""
    n, m = X.shape
    for k in range(n):
        row = pivots[k]
        if row != k:
            for j in range(m):
                X[k, j], X[row, j] = X[row, j], X[k, j]
    for i in range(n):
        for k in range(i):
            if LU[i, k] != 0.0:
                for j in range(m):
                    X[i, j] -= LU[i, k] * X[k, j]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            if LU[i, k] != 0.0:
                for j in range(m):
                    X[i, j] -= LU[i, k] * X[k, j]
        for j in range(m):
            X[i, j] *= LU[i, i]


@part(borrowing=True)
def solve_transposed(LU: Array, pivots: Array, b: Array) -> None:
    """Solve A^T x = b (no conjugation); b becomes x."""
    n = LU.shape[0]
    for i in range(n):
        total = b[i] * LU[i, i]
        b[i] = total
        for j in range(i + 1, n):
            b[j] -= LU[i, j] * total
    for i in range(n - 1, -1, -1):
        total = b[i]
        for j in range(i):
            b[j] -= LU[i, j] * total
    for k in range(n - 1, -1, -1):
        row = pivots[k]
        if row != k:
            b[k], b[row] = b[row], b[k]


@part(borrowing=True)
def matmul(A: Array, B: Array, out: Array) -> None:
    """Multiply: out = A B."""
    for i in range(A.shape[0]):
        for j in range(B.shape[1]):
            out[i, j] = 0.0
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]


@part(borrowing=True)
def copy(source: Array, target: Array) -> None:
    """Copy a matrix: an assignment to a slice would compile for a second, for the sake of its error message."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@part()
def sort(values: Array) -> None:
    """Sort a short list in its place, by insertion: the library's sort would compile for a second."""
    for i in range(1, values.size):
        value, at = values[i], i
        while at > 0 and values[at - 1] > value:
            values[at] = values[at - 1]
            at -= 1
        values[at] = value


@part()
def merge(first: Array, second: Array) -> Array:
    """Two sorted lists as one."""
    together, i = np.empty(first.size + second.size), 0
    for k in range(first.size + 1):
        while i < second.size and (k == first.size or second[i] < first[k]):
            together[k + i] = second[i]
            i += 1
        if k < first.size:
            together[k + i] = first[k]
    return together


@part()
def exponential(X: Array, N: Array, with_derivative: bool) -> Any:
    """exp(X) by a Taylor series of a scaled X and repeated squaring, its derivative in the direction N, how often."""
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
    scale = 0.5**squarings
    E, L = np.eye(n), np.zeros((n, n))
    T, dT = np.eye(n), np.zeros((n, n))
    work, dwork = np.empty((n, n)), np.empty((n, n))
    for k in range(1, 15):  # 0.5^15 / 15! is below rounding
        factor_k = scale / k
        if with_derivative:
            matmul(X, dT, dwork)
            matmul(N, T, work)
            for i in range(n):
                for j in range(n):
                    dT[i, j] = factor_k * (dwork[i, j] + work[i, j])
                    L[i, j] += dT[i, j]
        matmul(X, T, work)
        for i in range(n):
            for j in range(n):
                T[i, j] = factor_k * work[i, j]
                E[i, j] += T[i, j]
    for _ in range(squarings):
        if with_derivative:
            matmul(E, L, work)
            matmul(L, E, dwork)
            for i in range(n):
                for j in range(n):
                    L[i, j] = work[i, j] + dwork[i, j]
        matmul(E, E, work)
        copy(work, E)
    return E, L, squarings
