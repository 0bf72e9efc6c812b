"""How alike the two tracks of a road are: coherence over wavenumber, and the independent parts that have it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.checks import check_positive, is_number
from inerter.errors import PerformanceIndexError

Array = NDArray[np.float64]
Ratio = tuple[tuple[float, ...], tuple[float, ...]]  # of polynomials in s, the highest power first
# x K1(x) for x from 0 to 14 as a ratio of polynomials in x^2, by the iteration of Sanathanan and Koerner (1963).
_ISOTROPIC = (
    (1.0, 5.62721154, 1.76735408e-02, -5.76315885e-04),
    (1.0, 6.89288176, 3.02682174, 8.764452e-02, 9.63102e-03),
)


@dataclass(frozen=True)
class Coherence:
    """The cross-spectrum of left and right track over the spectrum that both have, a real function of wavenumber n.

    It is numerator / denominator, polynomials in x^2 with the lowest power first, where x = 2 pi n `length`. Make one
    by `Coherence.constant`, `Coherence.first_order` or `Coherence.isotropic`. The mean of the tracks and half of their
    difference, which are independent, then have (1 + coherence) / 2 and (1 - coherence) / 2 of the spectrum.

    Raises `PerformanceIndexError` unless it stays between -1 and 1 at every wavenumber.
    """

    numerator: Sequence[float]
    denominator: Sequence[float]
    length: float = 1.0  # [m]

    def __post_init__(self) -> None:
        check_positive(PerformanceIndexError, "The length of a coherence", self.length, "m")
        for name in ("numerator", "denominator"):
            given = getattr(self, name)
            if not isinstance(given, Sequence) or not given or not all(map(is_number, given)):
                raise PerformanceIndexError(f"The {name} of a coherence is a list of numbers, got {given!r}.")
            object.__setattr__(self, name, tuple(map(float, given)))
        square = np.concatenate([[0.0], np.geomspace(1e-12, 1e12, 2401)])
        top, bottom = (np.polyval(p[::-1], square) for p in (self.numerator, self.denominator))
        if np.any(bottom <= 0.0) or np.any(np.abs(top) > bottom * (1.0 + 1e-12)):
            raise PerformanceIndexError(
                "A coherence stays between -1 and 1 at every wavenumber, and its denominator positive; this one does "
                "not. Make one by Coherence.constant, Coherence.first_order or Coherence.isotropic."
            )

    @classmethod
    def constant(cls, level: float) -> Coherence:
        """The same at all wavenumbers: 1 if the tracks are alike, 0 if they are independent.

        Raises `PerformanceIndexError` unless `level` is a number from -1 to 1.
        """
        return cls((_level(level),), (1.0,))

    @classmethod
    def first_order(cls, wavenumber: float, level: float = 1.0) -> Coherence:
        """`level` / (1 + (n / `wavenumber`)^2): alike in long waves, independent in short ones, half at `wavenumber`.

        Raises `PerformanceIndexError` unless `wavenumber` [cycle/m] is positive and `level` a number from -1 to 1.
        """
        check_positive(PerformanceIndexError, "The wavenumber of a coherence", wavenumber, "cycle/m")
        return cls((_level(level),), (1.0, 1.0), 1.0 / (2.0 * math.pi * wavenumber))

    @classmethod
    def isotropic(cls, track: float) -> Coherence:
        """That of tracks `track` [m] apart on a surface that is as rough in every direction, x K1(x), x = 2 pi n track.

        K1 is a Bessel function. A ratio of polynomials stands for it, which deviates from it by 0.0027 at most. Source:
        Kamash and Robson (1978), for the waviness 2.

        Raises `PerformanceIndexError` unless `track` is positive.
        """
        check_positive(PerformanceIndexError, "The track of a coherence", track, "m")
        return cls(*_ISOTROPIC, track)

    def __call__(self, wavenumber: float | Array) -> Array:
        """The coherence at wavenumbers [cycle/m]."""
        square = (2.0 * math.pi * self.length * np.asarray(wavenumber, dtype=float)) ** 2
        return np.asarray(np.polyval(self.numerator[::-1], square) / np.polyval(self.denominator[::-1], square))

    def in_phase(self, speed: float) -> Ratio | None:
        """What makes the mean of both tracks of white noise at `speed` [m/s], as a stable filter; None for nothing."""
        return self._factor(1.0, speed)

    def in_anti_phase(self, speed: float) -> Ratio | None:
        """The same for half of their difference, left less right."""
        return self._factor(-1.0, speed)

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


def _level(value: object) -> float:
    if not is_number(value) or abs(value) > 1.0:
        raise PerformanceIndexError(f"The level of a coherence is a number from -1 to 1, got {value!r}.")
    return float(value)


def _spectral_factor(polynomial: Array, late: float) -> tuple[float, ...]:
    """The stable polynomial in s whose squared size on the imaginary axis is that polynomial in (late omega)^2."""
    trimmed = np.trim_zeros(polynomial, "b")
    roots = np.roots(trimmed[::-1]).astype(complex)
    product = np.atleast_1d(np.poly(-np.sqrt(-roots) / late)).real  # the root with a positive real part, negated
    scale = math.sqrt(abs(trimmed[-1])) * late ** (trimmed.size - 1)
    return tuple(float(c) for c in scale * product)
