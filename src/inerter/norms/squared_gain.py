"""The square of a gain over the square of the frequency, from coefficients that are whole, and all of its maxima."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from inerter.norms.mean_square import Transfer, UnknownError
from inerter.systems.polynomials import Polynomial, add, derivative, mirror, multiply, positive_roots, scale_by, value

_FLAT = 1e-13  # relative difference of gains over a peak that ends its refinement
_WIDTH = Fraction(1, 1 << 26)  # relative distance of the ends of an interval around a suggested peak
_HALVINGS = 52  # of an interval in double precision
_BITS = 900  # of the largest coefficient of a polynomial in double precision


@dataclass(frozen=True)
class SquaredGain:
    """|G(j w)|^2 = top(w^2) / bottom(w^2), summed up over all numerators; the denominator has no root on the axis."""

    top: Polynomial
    bottom: Polynomial

    @staticmethod
    def of(response: Transfer) -> SquaredGain:
        top: Polynomial = []
        for numerator in response.numerators:
            top = add(top, _on_axis_squared(numerator))
        return SquaredGain(top, _on_axis_squared(response.denominator))

    def gain(self, x: Fraction) -> float:
        """The gain where the squared frequency is x."""
        spare = len(self.bottom) - len(self.top)
        return _root(value(self.top, x) * x.denominator**spare, value(self.bottom, x)) if self.top else 0.0

    def peaks(self) -> list[tuple[float, float]]:
        """Frequencies [rad/s] and gains of all local maxima; one at infinity where the gain rises for good."""
        falling = scale_by(multiply(self.top, derivative(self.bottom)), -1)
        slope = add(multiply(derivative(self.top), self.bottom), falling)
        if not slope:
            return [(0.0, self.gain(Fraction(0)))] if self.top else []
        found = [] if next(c for c in slope if c) > 0 else [(0.0, self.gain(Fraction(0)))]
        roots = positive_roots(slope)
        edges = [(before[1] + after[0]) / 2 for before, after in pairwise(roots)]
        edges = [roots[0][0] / 2, *edges, roots[-1][1] + 1] if roots else []
        for root, before, after in zip(roots, edges[:-1], edges[1:], strict=True):
            if value(slope, before) > 0 > value(slope, after):
                found.append(self._top(slope, *root))
        if slope[-1] > 0:
            found.append((math.inf, _root(self.top[-1], self.bottom[-1])))
        return found

    def _top(self, slope: Polynomial, low: Fraction, high: Fraction) -> tuple[float, float]:
        """The maximum between `low` and `high`, where `slope` changes its sign once."""
        low, high = _narrow(slope, low, high)
        at_low, at_high = self.gain(low), self.gain(high)
        while True:
            middle = (low + high) / 2
            at_middle = self.gain(middle)
            largest = max(at_low, at_middle, at_high)
            if largest - min(at_low, at_middle, at_high) <= _FLAT * largest:
                return _root(middle.numerator, middle.denominator), largest
            if value(slope, middle) > 0:
                low, at_low = middle, at_middle
            else:
                high, at_high = middle, at_middle


def _narrow(slope: Polynomial, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    """A narrower interval in which `slope` falls through zero, as double precision suggests and whole numbers confirm.

    The interval that is given, where they do not.
    """
    scale = max(high.numerator.bit_length() - high.denominator.bit_length(), 0)  # the root lies below 2^(scale + 1)
    terms = [c << scale * i for i, c in enumerate(slope)]
    spare = max(max(c.bit_length() for c in terms) - _BITS, 0)
    falling = [float(c >> spare) for c in reversed(terms)]
    left, right = float(low / (1 << scale)), float(high / (1 << scale))
    for _ in range(_HALVINGS):
        middle = 0.5 * (left + right)
        total = 0.0
        for c in falling:
            total = total * middle + c
        left, right = (middle, right) if total > 0.0 else (left, middle)
    centre = Fraction(0.5 * (left + right)) * (1 << scale)
    around = centre * (1 - _WIDTH), centre * (1 + _WIDTH)
    inside = low <= around[0] and around[1] <= high
    return around if inside and value(slope, around[0]) > 0 > value(slope, around[1]) else (low, high)


def _on_axis_squared(p: Polynomial) -> Polynomial:
    """|p(j w)|^2 as a polynomial in w^2."""
    square = multiply(p, mirror(p))
    return [-c if i % 2 else c for i, c in enumerate(square[0::2])]


def _root(top: int, bottom: int) -> float:
    """The square root of a fraction whose terms may be beyond floating point."""
    shift = (bottom.bit_length() - top.bit_length() + 128) // 2 * 2
    whole = (top << shift) // bottom if shift > 0 else top // (bottom << -shift)
    try:
        return math.ldexp(math.isqrt(whole), -shift // 2)
    except OverflowError:
        raise UnknownError("the gain is beyond the range of numbers") from None
