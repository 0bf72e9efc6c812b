"""How a delayed white noise is correlated with the state: exactly, or as a Pade approximant would have it.

If x' = A x + B1 w(t) + B2 w(t - tau) with white w, the delayed noise meets a state that already knows it: their
covariance is exp(A tau) B1. A delay replaced by an all-pass filter D(s) of unit gain, as a diagonal Pade approximant
is, keeps the noise white and makes that covariance D(-A) B1, the Pade approximant of exp(A tau). So both conventions
need one Lyapunov equation of the order of A, and the approximant needs no states of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from inerter.errors import LinearSystemError

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Approximant:
    """D(s) = direct + sum residues / (s - poles), the diagonal Pade approximant of exp(-s)."""

    direct: float
    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]


def pade(order: int) -> Approximant:
    """The [n/n] Pade approximant of exp(-s) in partial fractions.

    Raises `LinearSystemError` unless 1 <= order <= 10, beyond which partial fractions lose digits.
    """
    if not isinstance(order, int) or not 1 <= order <= 10:
        raise LinearSystemError(f"A Pade approximant of order 1 to 10 is available, got {order!r}.")
    coefficients = np.array(
        [math.factorial(2 * order - k) // (math.factorial(k) * math.factorial(order - k)) for k in range(order + 1)],
        dtype=np.longdouble,
    )
    signs = (-1.0) ** np.arange(order + 1)
    slopes = coefficients[1:] * np.arange(1, order + 1)
    poles = np.polynomial.Polynomial(coefficients.astype(float)).roots().astype(np.clongdouble)
    for _ in range(4):  # the roots of a polynomial lose digits, and the residues magnify that
        poles = poles - _horner(coefficients, poles) / _horner(slopes, poles)
    residues = _horner(coefficients * signs, poles) / _horner(slopes, poles)
    return Approximant((-1.0) ** order, poles.astype(complex), residues.astype(complex))


def _horner(coefficients: NDArray[np.longdouble], x: NDArray[np.clongdouble]) -> NDArray[np.clongdouble]:
    result = np.zeros_like(x)
    for coefficient in coefficients[::-1]:
        result = result * x + coefficient
    return result


def propagate(A: Matrix, columns: Matrix, time: float, pade_order: int | None) -> Matrix:
    """exp(A time) @ columns, or its Pade approximant; `A` has no eigenvalue to the right of the imaginary axis."""
    if time == 0.0:
        return columns
    if pade_order is None:
        return np.asarray(scipy.linalg.expm(A * time) @ columns, dtype=float)
    approximant = pade(pade_order)
    result = approximant.direct * columns
    identity = np.eye(A.shape[0])
    for pole, residue in zip(approximant.poles, approximant.residues, strict=True):
        result = result - (residue * np.linalg.solve(A * time + pole * identity, columns.astype(complex))).real
    return result


def transfer(omega: Matrix, time: float, pade_order: int | None) -> NDArray[np.complex128]:
    """exp(-j omega time), or its Pade approximant."""
    s = 1j * np.asarray(omega, dtype=float) * time
    if pade_order is None or time == 0.0:
        return np.asarray(np.exp(-s))
    a = pade(pade_order)
    return np.asarray(a.direct + np.sum(a.residues / (s[..., None] - a.poles), axis=-1))
