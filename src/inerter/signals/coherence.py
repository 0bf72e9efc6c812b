"""Coherence between the left and right tracks of a road, and the independent parts that have it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.validation import check_positive, is_number, use_python_numbers

Array = NDArray[np.float64]
Ratio = tuple[tuple[float, ...], tuple[float, ...]]  # of polynomials in s, the highest power first
# 1 - x K1(x) within 6 % of itself for x above 1e-3, as a ratio of polynomials in x^2 (minimax fit of the ratio).
_OSCILLATING = (5.0, 7.1 + 1.1j, 9.9 + 3.3j, 12.4 + 6.8j, 15.0 + 11.9j)  # rates, and their conjugates
_ISOTROPIC = (
    (2.321311584441453e-06, 0.034459574806466296, 1.4486734273829336),
    (2.321311584441453e-06, 0.03446783522489262, 1.5149025250469859, 1.0),
)
ISOTROPIC_DENSITY = 2e-8  # relative error of the density of `isotropic_exponentials`
_TERMS = 14  # of the series of K1 below 1, whose last is 1e-24 there
_STEP, _LOWEST, _HIGHEST = 0.02, -32.0, 16.0  # of ln x in a table, whose cubics deviate by less than 1e-9


@dataclass(frozen=True)
class Coherence:
    """Normalised cross-spectrum (coherency) of the left and right tracks, a real function of wavenumber n.

    It is numerator / denominator, polynomials in x^2 with the lowest power first, where x = 2 pi n `length`; that of an
    `is_isotropic` surface is x K1(x), which this ratio approximates where filters are required. Create one with
    `Coherence.constant`, `Coherence.first_order` or `Coherence.isotropic`. The mean of the tracks and half of their
    difference, which are independent, then have (1 + coherence) / 2 and (1 - coherence) / 2 of the spectrum.

    Raises `PerformanceIndexError` unless it is between -1 and 1 at every wavenumber.

    >>> import inerter as it
    >>> float(it.Coherence.first_order(wavenumber=0.2)(0.2))  # cycle/m
    0.5
    """

    numerator: Sequence[float]
    denominator: Sequence[float]
    length: float = 1.0  # [m]
    is_isotropic: bool = False

    def __post_init__(self) -> None:
        use_python_numbers(self)
        check_positive(PerformanceIndexError, "The length of a coherence", self.length, "m")
        for name in ("numerator", "denominator"):
            given = getattr(self, name)
            if not isinstance(given, Sequence) or not given or not all(map(is_number, given)):
                raise PerformanceIndexError(f"The {name} of a coherence must be a list of numbers, got {given!r}.")
            object.__setattr__(self, name, tuple(map(float, given)))
        if self.is_isotropic and (self.numerator, self.denominator) != _ISOTROPIC:
            raise PerformanceIndexError(
                "The polynomials of the coherence of an isotropic surface are fixed. Use "
                "Coherence.isotropic(track=...)."
            )
        square = np.concatenate([[0.0], np.geomspace(1e-12, 1e12, 2401)])
        top, bottom = (np.polyval(p[::-1], square) for p in (self.numerator, self.denominator))
        if np.any(bottom <= 0.0) or np.any(np.abs(top) > bottom * (1.0 + 1e-12)):
            raise PerformanceIndexError(
                "A coherence must be between -1 and 1 at every wavenumber, and its denominator positive. Use "
                "Coherence.constant, Coherence.first_order or Coherence.isotropic."
            )

    @classmethod
    def constant(cls, level: float) -> Coherence:
        """The same coherence at all wavenumbers: 1 for identical tracks, 0 for independent ones.

        Raises `PerformanceIndexError` unless `level` is a number from -1 to 1.
        """
        return cls((_level(level),), (1.0,))

    @classmethod
    def first_order(cls, wavenumber: float, level: float = 1.0) -> Coherence:
        """Coherence `level` / (1 + (n / `wavenumber`)^2), which falls to half its level at `wavenumber`.

        Raises `PerformanceIndexError` unless `wavenumber` [cycle/m] is positive and `level` a number from -1 to 1.
        """
        check_positive(PerformanceIndexError, "The wavenumber of a coherence", wavenumber, "cycle/m")
        return cls((_level(level),), (1.0, 1.0), 1.0 / (2.0 * math.pi * float(wavenumber)))

    @classmethod
    def isotropic(cls, track: float) -> Coherence:
        """Coherence x K1(x), x = 2 pi n track, of tracks `track` [m] apart on an isotropic surface.

        K1 is a Bessel function. Source: Kamash and Robson (1978), for the waviness 2.

        Raises `PerformanceIndexError` unless `track` is positive.
        """
        check_positive(PerformanceIndexError, "The track of a coherence", track, "m")
        return cls(*_ISOTROPIC, track, is_isotropic=True)

    def __call__(self, wavenumber: float | Array) -> Array:
        """The coherence at wavenumbers [cycle/m]."""
        x = 2.0 * math.pi * self.length * np.abs(np.asarray(wavenumber, dtype=float))
        return np.asarray(1.0 - _difference(x)) if self.is_isotropic else self._ratio(x)

    def in_phase(self, speed: float) -> Ratio | None:
        """Stable filter of white noise for the mean of both tracks at `speed` [m/s]; None if the mean is zero."""
        return self._factor(1.0, speed)

    def in_anti_phase(self, speed: float) -> Ratio | None:
        """Stable filter of white noise for half of the difference of the tracks, left minus right; None if zero."""
        return self._factor(-1.0, speed)

    def excess(self, sign: float, speed: float) -> Excess | None:
        """Relative excess of the density over that of the filter; None where the filter is exact.

        `sign` is 1 for the mean of the tracks, and -1 for half of their difference.
        """
        return Excess(self.length / speed, sign) if self.is_isotropic else None

    def _ratio(self, x: Array) -> Array:
        return np.asarray(np.polyval(self.numerator[::-1], x**2) / np.polyval(self.denominator[::-1], x**2))

    def _factor(self, sign: float, speed: float) -> Ratio | None:
        """The spectral factor of (1 + sign x coherence) / 2."""
        top, bottom = np.zeros((2, max(len(self.numerator), len(self.denominator))))
        bottom[: len(self.denominator)] = self.denominator
        top[: len(self.numerator)] = self.numerator
        part = 0.5 * (bottom + sign * top)
        if not np.any(part):
            return None
        late = self.length / speed
        return _spectral_factor(part, late), _spectral_factor(bottom, late)


@dataclass(frozen=True)
class Excess:
    """Relative excess of the density of a source over that of its approximating filter: a function of omega.

    For one of the two independent parts of tracks on an isotropic surface, `sign` 1 for their mean and -1 for half of
    their difference; `time` is the track divided by the speed of the vehicle. The excess is at most 0.06 where omega
    `time` exceeds 1e-3, grows with the logarithm of longer waves, and is 1.45 / (omega time)^2 in short ones.
    """

    time: float  # [s]
    sign: float

    def __call__(self, omega: Array) -> Array:
        """The excess at non-zero frequencies omega [rad/s]."""
        return _excess(self.sign, np.abs(np.asarray(omega, dtype=float)) * self.time)

    def factor(self, omega: Array) -> Array:
        """Factor on the frequency response of the filter that corrects the density."""
        return np.sqrt(1.0 + self(omega))

    @property
    def table(self) -> tuple[float, float, float, Array]:
        """Time [s], first value and step of ln(omega time), and the excess and its slope over it there (2, n).

        Below the first value the excess is linear.
        """
        return self.time, _LOWEST, _STEP, _table(self.sign)


@lru_cache(maxsize=2)
def isotropic_exponentials(sign: float) -> tuple[Any, Any, float]:
    """Rates m < 0, residues r and direct term of the autocorrelation of a part of isotropic tracks, over V t / track.

    It is direct delta(t) + sum r exp(m |t|): for `sign` 1 of the velocity of the mean of the tracks, with the density
    (1 + gamma) / 2; for -1 of the displacement of half of their difference, (1 - gamma) / (2 x^2) at x = 2 pi n track.
    Least squares of the relative error at fixed rates: those of decaying oscillations bring the decay of gamma beyond
    x = 5, real ones the logarithm of long waves. The density is off by less than `ISOTROPIC_DENSITY` of itself at x
    from 1e-6 on.
    """
    low = np.exp(np.arange(math.log(1e-4 if sign > 0.0 else 1e-8), math.log(0.02), 0.5))
    middle = np.exp(np.arange(math.log(low[-1]) + 0.25, math.log(5.0), 0.25))
    rates = np.array([*low, *middle, *_OSCILLATING], dtype=complex)
    x = np.exp(np.linspace(math.log(1e-9), math.log(1e4), 3000))
    difference, direct = _difference(x), max(sign, 0.0)
    density = 2.0 - difference if sign > 0.0 else difference / x**2
    weight = np.minimum(1.0, (1e6 * x) ** 2) / density
    terms = 1.0 / (x[:, None] ** 2 + rates**2)
    several = rates.imag > 0.0
    columns = weight[:, None] * np.concatenate(
        [np.where(several, 2.0, 1.0) * terms.real, -2.0 * terms.imag[:, several]], 1
    )
    sizes = np.linalg.norm(columns, axis=0)
    found = np.linalg.lstsq(columns / sizes, (density - direct) * weight, rcond=1e-15)[0] / sizes
    factors = found[: rates.size].astype(complex)
    factors[several] += 1j * found[rates.size :]
    rates = np.concatenate([rates, rates[several].conj()])
    factors = np.concatenate([factors, factors[several].conj()])
    return -rates, factors / (4.0 * rates), 0.5 * direct


@lru_cache(maxsize=2)
def _table(sign: float) -> Array:
    at, by = np.arange(_LOWEST, _HIGHEST + 0.5 * _STEP, _STEP), 1e-4
    ahead, behind = (_excess(sign, np.exp(at + step)) for step in (by, -by))
    found = np.array([_excess(sign, np.exp(at)), (ahead - behind) / (2.0 * by)])
    found.setflags(write=False)
    return found


def _excess(sign: float, x: Array) -> Array:
    top, bottom = _ISOTROPIC
    less = np.array([*bottom[1:]]) - np.array([*top[1:], 0.0])  # the constants are equal: divided by x^2
    size = np.polyval(bottom[::-1], x**2)
    of_ratio, of_surface = x**2 * np.polyval(less[::-1], x**2) / size, _difference(x)
    if sign > 0.0:
        return np.asarray((of_ratio - of_surface) / (2.0 - of_ratio))
    return np.asarray((of_surface - of_ratio) / np.maximum(of_ratio, 1e-300))


def _difference(x: Array) -> Array:
    """1 - x K1(x), below 1 by the series of K1, without cancellation (Abramowitz and Stegun, 9.6.11)."""
    near = np.clip(x, 1e-150, 1.0)
    square, term, total = 0.25 * near**2, np.ones_like(near), np.zeros_like(near)
    for k in range(_TERMS):
        total += (scipy.special.digamma(k + 1) + scipy.special.digamma(k + 2) - 2.0 * np.log(0.5 * near)) * term
        term = term * square / ((k + 1) * (k + 2))
    far = np.maximum(x, 1.0)
    return np.asarray(np.where(x < 1.0, np.where(x > 0.0, square * total, 0.0), 1.0 - far * scipy.special.k1(far)))


def _level(value: object) -> float:
    if not is_number(value) or abs(value) > 1.0:
        raise PerformanceIndexError(f"The level of a coherence must be a number from -1 to 1, got {value!r}.")
    return float(value)


def _spectral_factor(polynomial: Array, late: float) -> tuple[float, ...]:
    """The stable polynomial in s whose squared size on the imaginary axis is that polynomial in (late omega)^2."""
    trimmed = np.trim_zeros(polynomial, "b")
    roots = np.roots(trimmed[::-1]).astype(complex)
    product = np.atleast_1d(np.poly(-np.sqrt(-roots) / late)).real  # the root with a positive real part, negated
    scale = math.sqrt(abs(trimmed[-1])) * late ** (trimmed.size - 1)
    return tuple(float(c) for c in scale * product)
