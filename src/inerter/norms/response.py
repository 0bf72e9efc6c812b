"""Frequency responses."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError
from inerter.norms.delay import pade, transfer
from inerter.norms.stability import balance
from inerter.systems.linear import LinearSystem, check_system

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
_MOST_ENTRIES = 4_000_000  # of all matrices that are solved at once


def frequency_response(system: LinearSystem, omega: ArrayLike, pade_order: int | None = None) -> Complex:
    """G(j omega), shape (len(omega), outputs, sources), omega in rad/s.

    Inputs of one source are one column, each arrival with its factor exp(-j omega delay), or with a Pade approximant
    for each delay between one arrival and the next, as in `h2`.
    Infinite where omega is a pole.

    Raises `LinearSystemError` unless omega holds finite numbers.
    """
    check_system(system)
    if pade_order is not None:
        pade(pade_order)  # refuses an order that there is not, even where nothing is late
    try:
        frequencies = np.atleast_1d(np.asarray(omega, dtype=float))
    except (TypeError, ValueError):
        raise LinearSystemError(f"A frequency response needs a list of frequencies [rad/s], got {omega!r}.") from None
    if frequencies.ndim != 1 or not np.all(np.isfinite(frequencies)):
        raise LinearSystemError("A frequency response needs a list of finite frequencies [rad/s].")
    response = resolvent(system)(frequencies) + system.D
    sources = list(dict.fromkeys(system.sources))
    result = np.zeros((frequencies.size, len(system.outputs), len(sources)), dtype=complex)
    for column, source in enumerate(sources):
        factor, before = np.ones(frequencies.size, dtype=complex), 0.0
        for j in np.argsort(system.delays, kind="stable"):
            if system.sources[j] != source:
                continue
            delay = float(system.delays[j])
            factor, before = factor * transfer(frequencies, delay - before, pade_order), delay
            with np.errstate(invalid="ignore"):  # at a pole
                result[:, :, column] += response[:, :, j] * factor[:, None]
    return result


def resolvent(system: LinearSystem) -> Any:
    """The function omega -> C (j omega - A)^-1 B, by elimination at each frequency.

    Elimination keeps the digits of small responses, such as that of one axle to the other's road; a Schur form, which
    mixes all states, would lose them.
    """
    A, scale = balance(system.A)
    B, C = system.B / scale[:, None], system.C * scale

    def evaluate(omega: NDArray[np.float64]) -> Complex:
        if A.shape[0] == 0:
            return np.zeros((omega.size, C.shape[0], B.shape[1]), dtype=complex)
        parts = np.array_split(omega, max(1, omega.size * A.size // _MOST_ENTRIES))
        return np.concatenate([_solve(A, B, C, part) for part in parts])

    return evaluate


def _solve(A: Matrix, B: Matrix, C: Matrix, omega: Matrix) -> Complex:
    M = 1j * omega[:, None, None] * np.eye(A.shape[0]) - A
    try:
        return np.asarray(C @ np.linalg.solve(M, np.broadcast_to(B.astype(complex), (omega.size, *B.shape))))
    except np.linalg.LinAlgError:
        if omega.size == 1:  # a pole
            return np.full((1, C.shape[0], B.shape[1]), np.inf + 0j)
        return np.concatenate([_solve(A, B, C, omega[i : i + 1]) for i in range(omega.size)])
