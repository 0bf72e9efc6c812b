"""Dense linear algebra on small matrices: products, elimination, null spaces, eigenvectors, the exponential.

Every operation is here once, for compiled code and as plain Python. Below order 20 loops are faster than a library.
What thousands of designs or steps need works in place; what is built once for each mode returns its result, and is
called (`apart`), not copied into what calls it, so that modes compile in a second.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import Array, Floats, Ints, Matrix
from inerter.kernels.decorators import part
from inerter.kernels.eigenproblem import real_eigenvectors

RANK_TOLERANCE = 1e-9  # rows are scaled to one
ROUNDING = 1e-14  # of a sum, relative to its terms


class Spaces(NamedTuple):
    """Bases, as columns, of the vectors that all rows annihilate, and of a complement."""

    null: Matrix
    complement: Matrix


@part(borrowing=True)
def copy(source: Array, target: Array) -> None:
    """Copy a matrix: an assignment to a slice would compile for a second, for the sake of its error message."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@part(typed=True, apart=True)
def set_to_zero(A: Matrix) -> None:
    """Set all entries to zero."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            A[i, j] = 0.0


@part(typed=True, apart=True)
def identity(n: int) -> Matrix:
    """Identity matrix of order n."""
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
def block(A: Matrix, top: int, bottom: int, left: int, right: int) -> Matrix:
    """A block of A as a copy."""
    out = np.zeros((bottom - top, right - left))
    for i in range(bottom - top):
        for j in range(right - left):
            out[i, j] = A[top + i, left + j]
    return out


@part(typed=True, apart=True)
def add_block(out: Matrix, top: int, left: int, A: Matrix, sign: float) -> None:
    """Add sign * A to a block of `out`."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[top + i, left + j] += sign * A[i, j]


@part(typed=True, apart=True)
def set_rows(A: Matrix, top: int, rows: Matrix) -> None:
    """Replace the rows of A from `top` on."""
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            A[top + i, j] = rows[i, j]


@part(typed=True, apart=True)
def absolute(A: Matrix) -> Matrix:
    """Absolute values."""
    out = np.zeros(A.shape)
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = abs(A[i, j])
    return out


@part(typed=True, apart=True)
def is_zero_row(rows: Matrix, i: int) -> bool:
    """Whether a row is zero."""
    zero = True
    for j in range(rows.shape[1]):
        zero = zero and rows[i, j] == 0.0
    return zero


@part(typed=True, apart=True)
def drop_rounding(A: Matrix, bound: Matrix) -> None:
    """Set entries to zero that are rounding errors of sums of terms as large as `bound`, so that nothing drifts."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            if abs(A[i, j]) < ROUNDING * bound[i, j]:
                A[i, j] = 0.0


@part(borrowing=True)
def multiply_vector(A: Array, x: Array, out: Array) -> None:
    """Multiply: out = A x."""
    for i in range(A.shape[0]):
        total = 0.0
        for j in range(A.shape[1]):
            total += A[i, j] * x[j]
        out[i] = total


@part(borrowing=True)
def multiply(A: Array, B: Array, out: Array) -> None:
    """Multiply: out = A B."""
    for i in range(A.shape[0]):
        for j in range(B.shape[1]):
            out[i, j] = 0.0
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]


@part(typed=True, apart=True)
def product(A: Matrix, B: Matrix) -> Matrix:
    """A B as a new matrix."""
    out = np.empty((A.shape[0], B.shape[1]))
    multiply(A, B, out)
    return out


@part(typed=True, apart=True)
def inner(A: Matrix, B: Matrix) -> Matrix:
    """A^T B as a new matrix."""
    out = np.zeros((A.shape[1], B.shape[1]))
    for k in range(A.shape[0]):
        for i in range(A.shape[1]):
            a = A[k, i]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@part(borrowing=True)
def equilibrate_rows(S: Array, right: Array, size: Array) -> None:
    """Divide each equation by its largest coefficient, kept in `size`; equations without one stay as they are.

    Inertia, damping and stiffness differ by their units, which must not choose the pivots.
    """
    for i in range(S.shape[0]):
        largest = 0.0
        for j in range(S.shape[1]):
            largest = max(largest, abs(S[i, j]))
        size[i] = largest
        if largest > 0.0:
            for j in range(S.shape[1]):
                S[i, j] /= largest
            for j in range(right.shape[1]):
                right[i, j] /= largest


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
def substitute_forward(LU: Array, pivots: Array, b: Array) -> None:
    """Forward substitution: b becomes L^-1 P b."""
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


@part(borrowing=True)
def solve(LU: Array, pivots: Array, b: Array) -> None:
    """Solve A x = b; b becomes x."""
    n = LU.shape[0]
    substitute_forward(LU, pivots, b)
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
def factor_by_quotients(A: Array, pivots: Array) -> None:
    """LU factors of A in its place, with partial pivoting, for `solve_by_quotients`; they hold the pivots.

    Apart from `factor`, whose inverse of a pivot rounds once more, 6 % of the median error of a solution: a step of
    time stepping has few equations and solves them once, so that its quotients cost nothing.
    """
    n = A.shape[0]
    for k in range(n):
        best, row = abs(A[k, k]), k
        for i in range(k + 1, n):
            if abs(A[i, k]) > best:
                best, row = abs(A[i, k]), i
        pivots[k] = row
        for j in range(n):
            A[k, j], A[row, j] = A[row, j], A[k, j]
        for i in range(k + 1, n):
            ratio = A[i, k] / A[k, k]
            A[i, k] = ratio
            for j in range(k + 1, n):
                A[i, j] -= ratio * A[k, j]


@part(borrowing=True)
def solve_by_quotients(LU: Array, pivots: Array, b: Array) -> None:
    """Solve A x = b from the factors of `factor_by_quotients`; b becomes x."""
    n = LU.shape[0]
    substitute_forward(LU, pivots, b)
    for i in range(n - 1, -1, -1):
        total = b[i]
        for j in range(i + 1, n):
            total -= LU[i, j] * b[j]
        b[i] = total / LU[i, i]


@part(typed=True, apart=True)
def solve_scaled(S: Matrix, right: Matrix) -> bool:
    """Solve S Y = right, rows and columns of S scaled to one size; `right` becomes Y. False if S is singular.

    S becomes |L| |U| of its factors, the sizes of the terms that elimination added up in each of its entries.
    """
    size, width = S.shape[0], right.shape[1]
    rows, columns = np.zeros(size), np.zeros(size)
    for j in range(size):
        for i in range(size):
            columns[j] = max(columns[j], abs(S[i, j]))
        columns[j] = columns[j] if columns[j] > 0.0 else 1.0
        for i in range(size):
            S[i, j] /= columns[j]
    equilibrate_rows(S, right, rows)
    pivots = np.zeros(size, np.int64)
    if not factor(S, pivots):
        return False
    solve_rows(S, pivots, right)
    multiply_absolute_factors(S, pivots)
    for i in range(size):
        for j in range(width):
            right[i, j] /= columns[i]
        for j in range(size):
            S[i, j] *= rows[i] * columns[j]
    return True


@part(typed=True, apart=True)
def multiply_absolute_factors(LU: Matrix, pivots: Ints) -> None:
    """Replace factors by |L| |U|, rows in the order of the matrix: it bounds the rounding errors of elimination."""
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
def null_space(rows: Matrix) -> Spaces:
    """Bases of the vectors that all rows annihilate and of a complement, by elimination with complete pivoting.

    Apart from `factor`: that takes the matrix for regular, this one finds its rank.
    """
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
def is_independent(row: Floats, basis: Matrix, count: int, residual: Floats) -> bool:
    """Whether a row is independent of the first `count` orthonormal ones; `residual` is then its unit vector.

    Gram-Schmidt, and no elimination: rows come one after the other, and each is judged by those before it.
    """
    size, left = 0.0, 0.0
    for j in range(residual.shape[0]):
        residual[j] = row[j]
        size += row[j] ** 2
    for _ in range(2):  # twice is enough for Gram-Schmidt
        for i in range(count):
            along = 0.0
            for j in range(residual.shape[0]):
                along += basis[i, j] * residual[j]
            for j in range(residual.shape[0]):
                residual[j] -= along * basis[i, j]
    for j in range(residual.shape[0]):
        left += residual[j] ** 2
    if left <= RANK_TOLERANCE**2 * size:
        return False
    for j in range(residual.shape[0]):
        residual[j] /= np.sqrt(left)
    return True


@part()
def balancing_units(A: Array) -> Array:
    """Units of the states that balance A, see `balance`."""
    scale = np.empty(A.shape[0])
    balance(A, scale, np.empty(A.shape[0]))
    return scale


@part(borrowing=True)
def balance(A: Array, scale: Array, inverse: Array) -> None:
    """Fill `scale` with units of the states that balance rows and columns of A, in a few sweeps, and their inverses.

    They depend on A alone, so that a result does not depend on what was computed before it.
    """
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


@part()
def factor_resolvent(A: Array, scale: Array, omega: float, M: Array, pivots: Array) -> bool:
    """M becomes the factors of j omega - A, with the states in units of `scale`; False at a pole."""
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            M[i, j] = -A[i, j] * scale[j] / scale[i]
        M[i, i] += 1j * omega
    return factor(M, pivots)


@part()
def apply_resolvent(M: Array, pivots: Array, scale: Array, x: Array) -> None:
    """Multiply: x becomes (j omega - A)^-1 x, by the factors of `factor_resolvent`."""
    for i in range(x.size):
        x[i] /= scale[i]
    solve(M, pivots, x)
    for i in range(x.size):
        x[i] *= scale[i]


@part()
def apply_resolvent_transposed(M: Array, pivots: Array, scale: Array, x: Array) -> None:
    """Multiply: x becomes (j omega - A)^-T x, without conjugation, by the factors of `factor_resolvent`."""
    for i in range(x.size):
        x[i] *= scale[i]
    solve_transposed(M, pivots, x)
    for i in range(x.size):
        x[i] /= scale[i]


@part()
def in_units(A: Array, scale: Array) -> Array:
    """A with the states in units of `scale`."""
    scaled = np.empty(A.shape)
    for i in range(A.shape[0]):
        for j in range(A.shape[0]):
            scaled[i, j] = A[i, j] * scale[j] / scale[i]
    return scaled


@part()
def eigenvectors(matrix: Array) -> Any:
    """Eigenvalues of a real matrix, eigenvectors as columns, the inverse of their matrix, and whether there is one.

    The real and the imaginary part of the eigenvector of a conjugate pair are columns of a real matrix, whose inverse
    has those of the pair. Eigenvalues that LAPACK does not find are nan.
    """
    n = matrix.shape[0]
    values, real, imaginary = np.full(n, np.nan + 0j), np.empty(n), np.empty(n)
    vectors, inverse = np.zeros((n, n), np.complex128), np.zeros((n, n), np.complex128)
    columns, rows, solved = np.empty((n, n)), np.empty((n, n)), np.zeros((n, n))
    pivots, largest = np.empty(n, np.int64), 0.0
    for i in range(n):
        for j in range(n):
            columns[j, i] = matrix[i, j]
            largest += abs(matrix[i, j])
    if n == 0 or not largest < np.inf or real_eigenvectors(columns, real, imaginary, rows) != 0:
        return values, vectors, inverse, n == 0
    for k in range(n):
        values[k] = complex(real[k], imaginary[k])
        solved[k, k] = 1.0
        for i in range(n):
            columns[i, k] = rows[k, i]
    if not factor(columns, pivots):
        return values, vectors, inverse, False
    solve_rows(columns, pivots, solved)
    for k in range(n):
        sign = 1.0 if imaginary[k] > 0.0 else -1.0 if imaginary[k] < 0.0 else 0.0
        first, second = k - 1 if sign < 0.0 else k, k + 1 if sign > 0.0 else k
        share = 0.5 if sign != 0.0 else 1.0
        for i in range(n):
            vectors[i, k] = complex(rows[first, i], sign * rows[second, i])
            inverse[k, i] = share * complex(solved[first, i], -sign * solved[second, i])
    return values, vectors, inverse, True


@part(typed=True, apart=True)
def count_squarings(X: Matrix) -> int:
    """Number of times to halve X until its largest row sum is one half or less."""
    norm = 0.0
    for i in range(X.shape[0]):
        total = 0.0
        for j in range(X.shape[0]):
            total += abs(X[i, j])
        norm = max(norm, total)
    squarings = 0
    while 0.5 < norm < np.inf:
        norm *= 0.5
        squarings += 1
    return squarings


@part(typed=True, apart=True)
def exponential(X: Matrix, squarings: int) -> Matrix:
    """exp(X) by a Taylor series of X halved `squarings` times (see `count_squarings`), then squared as often.

    The blocks [[X, N], [0, X]] with the squarings of X give [[exp(X), L], [0, exp(X)]], where L is the derivative of
    exp(X) in the direction N: it is linear in N, so the size of N does not matter.
    """
    n = X.shape[0]
    scaled = block(X, 0, n, 0, n)
    for i in range(n):
        for j in range(n):
            scaled[i, j] = np.ldexp(X[i, j], -squarings)
    second = product(scaled, scaled)
    third, fourth = product(second, scaled), product(second, second)
    factorial = 20922789888000.0  # 16!, and 0.5^17 / 17! is below rounding
    power = np.zeros((n, n))
    add_block(power, 0, 0, fourth, 1.0 / factorial)
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
