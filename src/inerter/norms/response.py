"""Frequency responses."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError
from inerter.norms.delay import transfer
from inerter.norms.stability import balance
from inerter.systems.linear import LinearSystem

Complex = NDArray[np.complex128]


def frequency_response(system: LinearSystem, omega: ArrayLike, pade_order: int | None = None) -> Complex:
    """G(j omega), shape (len(omega), outputs, sources), omega in rad/s.

    Inputs of one source are one column, each arrival with its factor exp(-j omega delay) (or the Pade approximant).
    Infinite where omega is a pole.

    Raises `LinearSystemError` unless omega holds finite numbers.
    """
    frequencies = np.atleast_1d(np.asarray(omega, dtype=float))
    if frequencies.ndim != 1 or not np.all(np.isfinite(frequencies)):
        raise LinearSystemError("A frequency response needs a list of finite frequencies [rad/s].")
    response = resolvent(system)(frequencies) + system.D
    sources = list(dict.fromkeys(system.sources))
    result = np.zeros((frequencies.size, len(system.outputs), len(sources)), dtype=complex)
    for j, (source, delay) in enumerate(zip(system.sources, system.delays.tolist(), strict=True)):
        factor = transfer(frequencies, delay, pade_order)
        result[:, :, sources.index(source)] += response[:, :, j] * factor[:, None]
    return result


def resolvent(system: LinearSystem) -> Any:
    """The function omega -> C (j omega - A)^-1 B, vectorised, by one Schur form and a substitution a frequency."""
    A, scale = balance(system.A)
    T, Z = scipy.linalg.schur(A.astype(complex), output="complex") if A.size else (A.astype(complex), A.astype(complex))
    B, C = Z.conj().T @ (system.B / scale[:, None]), (system.C * scale) @ Z

    def evaluate(omega: NDArray[np.float64]) -> Complex:
        X = np.zeros((A.shape[0], omega.size, B.shape[1]), dtype=complex)
        with np.errstate(divide="ignore", invalid="ignore"):
            for i in reversed(range(A.shape[0])):
                rest = np.tensordot(T[i, i + 1 :], X[i + 1 :], axes=1)
                X[i] = (B[i] + rest) / (1j * omega - T[i, i])[:, None]
        return np.tensordot(X, C, axes=(0, 1)).swapaxes(1, 2)

    return evaluate
