"""Eigenvalues and eigenvectors of a real matrix, in compiled code by LAPACK's dgeev (see `numba_lanes`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import instruction

Array = Any
_REAL = 1e-12  # relative size of an imaginary part that is rounding
_FAILED = 1


@instruction
def real_eigenvectors(transposed: Array, real: Array, imaginary: Array, rows: Array) -> int:
    """Solve the eigenproblem of a real matrix, given `transposed` and overwritten; 0 if it was solved.

    Eigenvalues are real[k] + j imaginary[k]. A real one has its eigenvector in rows[k]; a conjugate pair stands at k
    and k + 1, first that with a positive imaginary part, whose eigenvector is rows[k] + j rows[k + 1]. Here it is
    solved as a complex one.
    """
    n = real.size
    matrix = np.empty((n, n), np.complex128)
    for i in range(n):
        for j in range(n):
            matrix[i, j] = transposed[j, i]
    values, vectors = np.linalg.eig(matrix)
    k = 0
    for q in range(n):
        is_real = abs(values[q].imag) <= _REAL * abs(values[q])
        if not is_real and values[q].imag < 0.0:
            continue
        if k + (1 if is_real else 2) > n:
            return _FAILED
        turn, most = 1.0 + 0j, 0.0
        if is_real:
            for i in range(n):
                if abs(vectors[i, q]) > most:
                    most, turn = abs(vectors[i, q]), np.conj(vectors[i, q]) / abs(vectors[i, q])
        for i in range(n):
            entry = vectors[i, q] * turn
            rows[k, i] = entry.real
            if not is_real:
                rows[k + 1, i] = entry.imag
        real[k], imaginary[k] = values[q].real, 0.0
        if not is_real:
            imaginary[k] = values[q].imag
            real[k + 1], imaginary[k + 1] = values[q].real, -values[q].imag
            k += 1
        k += 1
    return 0 if k == n else _FAILED
