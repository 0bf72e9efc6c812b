"""Frequency responses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError
from inerter.kernels.modal_sums import add_modes
from inerter.norms.delay import pade, transfer
from inerter.norms.exact import responses_exactly
from inerter.norms.stability import balance
from inerter.systems.linear import LinearSystem, check_system
from inerter.validation import real_numbers

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
_MODAL = 1e-12  # of the largest value: what a sum over modes may be off by where it is compared
_HALF_DIGIT = float(np.finfo(float).eps) / 2.0
_CERTAIN = 1e-9  # of the largest response of an output to an input: what rounding may change
_SAMPLED = 64  # frequencies, about, at which that is looked at, beside those of the largest responses
_SILENT = 1e-12  # of the largest response of an output: what responds less is measured by that
_MOST_ENTRIES = 4_000_000  # of all matrices that are solved at once


def frequency_response(system: LinearSystem, omega: ArrayLike, pade_order: int | None = None) -> Complex:
    """G(j omega), shape (len(omega), outputs, sources), omega in rad/s.

    Inputs of one source are one column, each arrival with its factor exp(-j omega delay), or with a Pade approximant
    for each delay between one arrival and the next, as in `h2`.
    Infinite where omega is a pole. Where rounding of the matrices of a mechanism, such as one of values many decades
    apart, may change a response by more than 1e-9 of its largest, transfer functions are evaluated without rounding.

    Raises `LinearSystemError` unless omega holds finite numbers.
    """
    return _response(system, omega, pade_order, _certain)


def rounded_response(system: LinearSystem, omega: ArrayLike) -> Complex:
    """Frequency response by the matrices as they are, whatever rounding has done to them."""
    return _response(system, omega, None, resolvent)


def modal_response(
    system: LinearSystem, omega: ArrayLike, pade_order: int | None = None, within: float = _MODAL
) -> Complex:
    """Frequency response by modes, within ten times `within` of the largest value; fast for many frequencies.

    A sum over modes; by elimination where eigenvectors are so nearly parallel that it would lose more digits, which is
    looked at where it would show: at both ends, and at the frequencies next to the poles.
    """
    return _response(system, omega, pade_order, partial(_modal, within=within))


def _response(system: LinearSystem, omega: ArrayLike, pade_order: int | None, resolved: Any) -> Complex:
    check_system(system)
    if pade_order is not None:
        pade(pade_order)  # refuses an order that there is not, even where nothing is late
    given = real_numbers(omega)
    if given is None:
        raise LinearSystemError(f"A frequency response needs a list of frequencies [rad/s], got {omega!r}.")
    frequencies = np.atleast_1d(given)
    if frequencies.ndim != 1 or not np.all(np.isfinite(frequencies)):
        raise LinearSystemError("A frequency response needs a list of finite frequencies [rad/s].")
    response = resolved(system)(frequencies)
    response += system.D
    sources = list(dict.fromkeys(system.sources))
    if sources == list(system.sources) and not np.any(system.delays):
        return np.asarray(response)
    result = np.zeros((frequencies.size, len(system.outputs), len(sources)), dtype=complex)
    for column, source in enumerate(sources):
        factor, before = np.ones(frequencies.size, dtype=complex), 0.0
        for j in np.argsort(system.delays, kind="stable"):
            if system.sources[j] != source:
                continue
            delay = float(system.delays[j])
            if delay != before:
                factor, before = factor * transfer(frequencies, delay - before, pade_order), delay
            with np.errstate(invalid="ignore"):  # at a pole
                result[:, :, column] += response[:, :, j] * factor[:, None]
    return result


def resonant_range(matrices: Sequence[Matrix]) -> Matrix:
    """Angular frequencies from a decade below the slowest resonance to a decade above the fastest."""
    poles = np.concatenate([np.linalg.eigvals(A) for A in matrices]) if matrices else np.array([1.0])
    resonances = np.abs(poles[np.abs(poles.imag) > 0.3 * np.abs(poles)])
    sizes = resonances if resonances.size else np.abs(poles)[np.abs(poles) > 0.0]
    low, high = (sizes.min(), sizes.max()) if sizes.size else (1.0, 1.0)
    return np.geomspace(low / 10.0, high * 10.0, 601)


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


def _certain(system: LinearSystem) -> Any:
    """The function of `resolvent`, without rounding where that may change it."""
    rounded, fine = resolvent(system), system.fine

    def evaluate(omega: NDArray[np.float64]) -> Complex:
        found = rounded(omega)
        if fine is None or not omega.size:
            return np.asarray(found)
        even = np.arange(0, omega.size, max(1, omega.size // _SAMPLED))
        sample = np.union1d(even, np.abs(found).argmax(axis=0))  # and where each response is the largest
        matrices = system.A, system.B, system.C, system.D
        with np.errstate(all="ignore"):
            try:
                again, error = rounding_of_response(matrices, 1j * omega[sample], fine.errors)
            except np.linalg.LinAlgError:  # a pole
                return np.asarray(found)
            eliminated = np.abs(again - found[sample] - system.D)  # in other units, and so with other roundings
            if relative_rounding(found + system.D, np.maximum(error, eliminated)) <= _CERTAIN:
                return np.asarray(found)
        return responses_exactly(system, omega) - system.D

    return evaluate


def rounding_of_response(
    matrices: tuple[Matrix, Matrix, Matrix, Matrix], s: ArrayLike, doubt: Matrix | float, E: Matrix | None = None
) -> tuple[Complex, Matrix]:
    """Responses C (s E - A)^-1 B + D, and what rounding of A, B, C and D changes in them, to first order.

    Both (len(s), outputs, inputs). `doubt` are errors of the entries of [A B; C D] beside half of their last digits.

    Raises `numpy.linalg.LinAlgError` at a pole.
    """
    A, B, C, D = matrices
    off = _HALF_DIGIT * np.abs(np.block([[A, B], [C, D]])) + doubt
    laplace = np.asarray(s, dtype=complex)[:, None, None]
    inverse = np.linalg.inv(laplace * (np.eye(len(A)) if E is None else E) - A)
    left, right = C @ inverse, inverse @ B
    response = left @ B + D
    before, after = (np.broadcast_to(np.eye(n), (len(inverse), n, n)) for n in D.shape)
    left, right = np.concatenate([np.abs(left), before], axis=2), np.concatenate([np.abs(right), after], axis=1)
    return np.asarray(response), np.asarray(left @ off @ right)


def relative_rounding(response: Complex, error: Matrix) -> float:
    """Largest error over the largest response of its output and input; of silent ones, over that of the output."""
    size = np.abs(response).max(axis=0, initial=0.0)
    whole = size.max(axis=1, keepdims=True, initial=0.0)
    size = np.where(size < _SILENT * whole, whole, size)
    return float(np.max(error.max(axis=0, initial=0.0) / size, initial=0.0, where=size != 0.0))


def _modal(system: LinearSystem, within: float) -> Any:
    """The function of `resolvent`, as a sum over modes where that has enough digits."""
    exact = resolvent(system)
    A, scale = balance(system.A)
    try:
        poles, vectors = np.linalg.eig(A)
        excited = np.linalg.solve(vectors, (system.B / scale[:, None]).astype(complex))
    except np.linalg.LinAlgError:
        return exact
    residues = np.ascontiguousarray((system.C * scale @ vectors).T[:, :, None] * excited[:, None, :])
    poles = poles.astype(complex)

    def evaluate(omega: NDArray[np.float64]) -> Complex:
        if omega.size <= 10 * poles.size or not poles.size:
            return np.asarray(exact(omega))
        found = np.zeros((omega.size, *residues.shape[1:]), dtype=complex)
        add_modes(np.ascontiguousarray(omega), poles, residues, found)
        worst = np.unique([0, omega.size - 1, *(int(np.argmin(np.abs(omega - pole.imag))) for pole in poles)])
        known = exact(omega[worst])
        with np.errstate(invalid="ignore"):
            close = np.abs(found[worst] - known).max(axis=0) <= within * np.abs(known).max(axis=0)
        return np.asarray(found if np.all(close) else exact(omega))

    return evaluate


def _solve(A: Matrix, B: Matrix, C: Matrix, omega: Matrix) -> Complex:
    M = 1j * omega[:, None, None] * np.eye(A.shape[0]) - A
    try:
        return np.asarray(C @ np.linalg.solve(M, np.broadcast_to(B.astype(complex), (omega.size, *B.shape))))
    except np.linalg.LinAlgError:
        if omega.size == 1:  # a pole
            return np.full((1, C.shape[0], B.shape[1]), np.inf + 0j)
        return np.concatenate([_solve(A, B, C, omega[i : i + 1]) for i in range(omega.size)])
