"""Autocorrelation of white noise behind filters, as a sum of exponentials."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.systems.filters import Filter
from inerter.systems.polynomials import Polynomial, derivative, multiply

Number = tuple[Fraction, Fraction]  # real and imaginary part
_EPS = float(np.finfo(float).eps)
_SAME, _AT_MOST = (
    1e-10,
    20,
)  # what the sum may be off by at a frequency, relative to its terms; steps of Newton's method


@dataclass(frozen=True, eq=False)
class Autocorrelation:
    """R(t) = direct delta(t) + sum_f residues[f] exp(poles[f] |t|), of white noise of unit intensity behind filters."""

    poles: NDArray[np.complex128]  # [1/s]
    residues: NDArray[np.complex128]
    errors: NDArray[np.float64]  # relative error of residues[f] / (poles[f] + s) for any s in the left half plane
    direct: float

    def spectrum(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Bilateral Laplace transform: the density at s = j omega."""
        return np.asarray(self.direct + self._terms(s).sum(axis=-1))

    def _terms(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return np.asarray(-2.0 * self.residues * self.poles / (self.poles**2 - np.asarray(s)[..., None] ** 2))

    def behind(self, other: Autocorrelation) -> Autocorrelation:
        """Autocorrelation with the product of both densities, which have no pole in common."""
        poles = np.concatenate([self.poles, other.poles])
        residues = np.concatenate(
            [self.residues * other.spectrum(self.poles), other.residues * self.spectrum(other.poles)]
        )
        sizes = np.concatenate(
            [
                np.abs(self.residues) * (other.direct + np.abs(other._terms(self.poles)).sum(axis=-1)),
                np.abs(other.residues) * (self.direct + np.abs(self._terms(other.poles)).sum(axis=-1)),
            ]
        )
        lost = poles.size * _EPS * sizes / np.maximum(np.abs(residues), 1e-300)
        return Autocorrelation(poles, residues, pole_errors(poles) + lost, self.direct * other.direct)

    def __call__(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """R(t) without its delta function."""
        return np.asarray((self.residues * np.exp(np.abs(times)[..., None] * self.poles)).sum(axis=-1).real)


def pole_errors(poles: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Relative rounding errors of r / (m + s) for these poles m and any s in the left half plane."""
    return np.asarray(_EPS * (8.0 + 2.0 * np.abs(poles) / np.abs(poles.real)))


@lru_cache(maxsize=64)
def autocorrelation(*filters: Filter | None) -> Autocorrelation | None:
    """Autocorrelation behind filters in series; None where poles are too close to each other to be told apart.

    Poles and residues are of the exact coefficients, by Newton's method in fractions from roots in double precision.
    """
    top, bottom = Polynomial([1]), Polynomial([1])
    for one in filters:
        if one is not None:
            top, bottom = multiply(top, one.whole[0]), multiply(bottom, one.whole[1])
    order = len(bottom) - 1
    direct = float(Fraction(top[-1], bottom[-1]) ** 2) if len(top) == len(bottom) else 0.0
    starts = _roots(bottom)
    slope, found, residues = derivative(bottom), list[complex](), list[complex]()
    for start in starts[starts.imag >= 0.0]:
        pole = _root(bottom, slope, complex(start))
        if pole is None:
            return None
        minus = (-pole[0], -pole[1])
        residue = _divide(
            _times(_value(top, pole), _value(top, minus)), _times(_value(slope, pole), _value(bottom, minus))
        )
        for conjugate in (False, True)[: 2 if pole[1] else 1]:
            found.append(_complex(pole, conjugate))
            residues.append(_complex(residue, conjugate))
    poles = np.array(found, dtype=complex)
    if poles.size != order or np.unique(poles).size != order or not np.all(poles.real < 0.0):
        return None
    result = Autocorrelation(poles, np.array(residues, dtype=complex), pole_errors(poles), direct)
    return result if _agrees(result, top, bottom) else None


def _roots(polynomial: Polynomial) -> NDArray[np.complex128]:
    """Roots in double precision, of the polynomial in units in which its first and last coefficient are alike."""
    order = len(polynomial) - 1
    if order < 1:
        return np.zeros(0, dtype=complex)
    unit = float(abs(Fraction(polynomial[0], polynomial[-1]))) ** (1.0 / order)
    scaled = [float(Fraction(c, polynomial[-1]) * Fraction(unit) ** (i - order)) for i, c in enumerate(polynomial)]
    return np.asarray(np.roots(scaled[::-1]) * unit, dtype=complex)


def _root(polynomial: Polynomial, slope: Polynomial, start: complex) -> Number | None:
    """Root near a start, to twice the digits of double precision; None if Newton's method does not find it."""
    at = Fraction(start.real), Fraction(start.imag)
    for _ in range(_AT_MOST):
        over = _value(slope, at)
        if not any(over):
            return None
        step = _complex(_divide(_value(polynomial, at), over))
        before = complex(at[0], at[1])
        at = at[0] - Fraction(step.real), (at[1] - Fraction(step.imag) if start.imag else Fraction(0))
        if abs(step) <= _EPS**1.5 * abs(before):
            return at
        at = at if abs(step) <= _EPS * abs(before) else (Fraction(float(at[0])), Fraction(float(at[1])))
    return None


def _value(polynomial: Polynomial, at: Number) -> Number:
    total = (Fraction(0), Fraction(0))
    for c in reversed(polynomial):
        product = _times(total, at)
        total = product[0] + c, product[1]
    return total


def _times(one: Number, other: Number) -> Number:
    return one[0] * other[0] - one[1] * other[1], one[0] * other[1] + one[1] * other[0]


def _divide(one: Number, other: Number) -> Number:
    size = other[0] ** 2 + other[1] ** 2
    product = _times(one, (other[0], -other[1]))
    return product[0] / size, product[1] / size


def _complex(number: Number, conjugate: bool = False) -> complex:
    return complex(float(number[0]), float(-number[1] if conjugate else number[1]))


def _agrees(found: Autocorrelation, top: Polynomial, bottom: Polynomial) -> bool:
    """Whether the spectrum of the sum is that of the filters, at the frequency of each pole."""
    for omega in np.abs(found.poles):
        at = Fraction(0), Fraction(float(omega))
        ratio = abs(_complex(_divide(_value(top, at), _value(bottom, at)))) ** 2
        here = np.array(1j * omega)
        size = found.direct + np.abs(found._terms(here)).sum()
        if not abs(found.spectrum(here).real - ratio) <= _SAME * size:
            return False
    return True
