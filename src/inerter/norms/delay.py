"""Covariance of a delayed white noise with the state: exact, or for a Padé approximant of the delay.

If x' = A x + B1 w(t) + B2 w(t - tau) with white w, the delayed noise meets a state that already knows it: their
covariance is exp(A tau) B1. A delay replaced by an all-pass filter D(s) of unit gain, as a diagonal Pade approximant
is, keeps the noise white and makes that covariance D(-A) B1, the Pade approximant of exp(A tau). So both conventions
need one Lyapunov equation of the order of A, and the approximant needs no states of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.errors import LinearSystemError

Matrix = NDArray[np.float64]
_EPS = float(np.finfo(float).eps)


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
    coefficients = np.array(pade_coefficients(order), dtype=np.longdouble)
    signs = (-1.0) ** np.arange(order + 1)
    slopes = coefficients[1:] * np.arange(1, order + 1)
    poles = np.polynomial.Polynomial(coefficients.astype(float)).roots().astype(np.clongdouble)
    for _ in range(4):  # the roots of a polynomial lose digits, and the residues magnify that
        poles = poles - _horner(coefficients, poles) / _horner(slopes, poles)
    residues = _horner(coefficients * signs, poles) / _horner(slopes, poles)
    return Approximant((-1.0) ** order, poles.astype(complex), residues.astype(complex))


def pade_coefficients(order: int) -> list[int]:
    """The coefficients of the denominator in s; those of the numerator alternate in sign."""
    return [math.factorial(2 * order - k) // (math.factorial(k) * math.factorial(order - k)) for k in range(order + 1)]


def _horner(coefficients: NDArray[np.longdouble], x: NDArray[np.clongdouble]) -> NDArray[np.clongdouble]:
    result = np.zeros_like(x)
    for coefficient in coefficients[::-1]:
        result = result * x + coefficient
    return result


def propagate(
    A: Matrix, error: Matrix, columns: Matrix, unsure: Matrix, time: float, pade_order: int | None
) -> tuple[Matrix, Matrix]:
    """exp(A time) @ columns, or its Pade approximant, and a bound of its error, from those of A and of the columns.

    `A` is balanced and has no eigenvalue to the right of the imaginary axis. A change dA of A changes the exponential
    by the integral of exp(A (time - t)) dA exp(A t) over t, which is taken at five places; each squaring adds n
    roundings, of which the first ones are many.
    """
    if time == 0.0 or not columns.size:
        return columns, unsure
    n = A.shape[0]
    if pade_order is None:
        quarter, squarings = _exponential(A * (0.25 * time))
        half = quarter @ quarter
        change = time * error + _EPS * (n * 2.0 ** (squarings + 2) + 10.0) * np.eye(n)
        states = [columns]
        for _ in range(4):
            states.append(quarter @ states[-1])
        later = (half @ half, half @ quarter, half, quarter, np.eye(n))
        spread = sum(np.abs(power) @ (change @ np.abs(state)) for power, state in zip(later, states, strict=True))
        return states[-1], np.abs(later[0]) @ unsure + 0.5 * spread
    approximant = pade(pade_order)
    power, spread = approximant.direct * np.eye(n), np.abs(columns) * _EPS
    for pole, residue in zip(approximant.poles, approximant.residues, strict=True):
        matrix = A * time + pole * np.eye(n)
        inverse = np.linalg.inv(matrix)
        part = inverse @ columns
        change = time * error + 4.0 * n * _EPS * np.abs(matrix)
        power = power - (residue * inverse).real
        spread = spread + np.abs(residue) * np.abs(inverse) @ (change @ np.abs(part))
    return power @ columns, np.abs(power) @ unsure + spread


def _exponential(X: Matrix) -> tuple[Matrix, int]:
    """exp(X) by a Taylor series of X halved repeatedly, then squared as often; that number too.

    Apart from `kernels.dense.exponential`, which it checks: a norm of one design needs no compiled code, and loops in
    plain Python would take as long as the rest of the norm.
    """
    squarings = max(0, math.frexp(float(np.abs(X).sum(axis=1).max(initial=0.0)))[1] - 1)
    X = X * 0.5**squarings
    power = term = np.eye(X.shape[0])
    for k in range(1, 27):  # 2^27 / 27! is below rounding
        term = term @ X / k
        power = power + term
    with np.errstate(over="ignore", invalid="ignore"):  # of motions that no delay outlasts: a caller checks the norm
        for _ in range(squarings):
            power = power @ power
    return power, squarings


def turned_back(angle: Matrix) -> NDArray[np.complex128]:
    """exp(-j angle) of angles [rad], by cosine and sine: several times faster than the complex exponential."""
    turned = np.empty(angle.shape, dtype=complex)
    np.cos(angle, out=turned.real)
    np.sin(-angle, out=turned.imag)
    return turned


def transfer(omega: Matrix, time: float, pade_order: int | None) -> NDArray[np.complex128]:
    """exp(-j omega time), or its Pade approximant."""
    angle = np.asarray(omega, dtype=float) * time
    if pade_order is None or time == 0.0:
        return turned_back(angle)
    a, s = pade(pade_order), 1j * angle
    return np.asarray(a.direct + np.sum(a.residues / (s[..., None] - a.poles), axis=-1))
