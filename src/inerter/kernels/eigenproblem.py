"""Eigenvalues and eigenvectors of a real matrix, in compiled code by LAPACK's dgeev.

Numba's own `eig` takes matrices as complex for this, in twice the time; the call here is by the symbol that it uses.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.decorators import instruction, part

Array = Any
_REAL = 1e-12  # relative size of an imaginary part that is rounding
_FAILED = 1


@part()
def real_eigenvectors_by_complex(transposed: Array, real: Array, imaginary: Array, rows: Array) -> int:
    """Do the same as `real_eigenvectors` by the complex eigenproblem."""
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


@instruction(real_eigenvectors_by_complex)
def real_eigenvectors(typing: Any, transposed: Any, real: Any, imaginary: Any, rows: Any) -> Any:
    """Compile the eigenproblem of a real matrix, given `transposed` and overwritten; 0 if it was solved.

    Eigenvalues are real[k] + j imaginary[k]. A real one has its eigenvector in rows[k]; a conjugate pair stands at k
    and k + 1, first that with a positive imaginary part, whose eigenvector is rows[k] + j rows[k + 1].
    """
    from llvmlite import ir  # noqa: PLC0415 - heavy
    from numba import types  # noqa: PLC0415
    from numba.core import cgutils as utilities  # noqa: PLC0415

    cgutils: Any = utilities

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        arrays = [context.make_array(t)(context, builder, a) for t, a in zip(signature.args, arguments, strict=True)]
        a, wr, wi, vr = (builder.bitcast(array.data, cgutils.voidptr_t) for array in arrays)
        n, one = cgutils.unpack_tuple(builder, arrays[1].shape, 1)[0], context.get_constant(types.intp, 1)
        letters = [ir.Constant(ir.IntType(8), ord(letter)) for letter in "dNV"]
        given = [
            *letters,
            n,
            a,
            n,
            wr,
            wi,
            vr,
            one,
            vr,
            n,
        ]  # the left eigenvectors, which are not asked for, have no place
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in given])
        found = builder.call(cgutils.get_or_insert_function(builder.module, kind, "numba_ez_rgeev"), given)
        return builder.sext(found, ir.IntType(64))

    return types.int64(transposed, real, imaginary, rows), code
