"""Test of positive-realness without rounding.

A ratio n/d of polynomials without common roots is positive real if and only if n + d has all its roots to the left of
the imaginary axis and Re n(j w) d(-j w) >= 0 at all w: Chen and Smith (2009), "A note on tests for positive-real
functions", IEEE Trans. Autom. Control 54(2). The first is decided by Routh's scheme and the second between the isolated
roots of a polynomial in w^2, both in integers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from numbers import Rational
from typing import Any

import numpy as np

from inerter.errors import NotPositiveRealError, SynthesisError
from inerter.formatting import format_complex, format_number, format_quantity
from inerter.systems.polynomials import (
    Polynomial,
    add,
    derivative,
    greatest_common_divisor,
    mirror,
    multiply,
    positive_roots,
    primitive,
    quotient,
    refine_positive_roots,
    scale_by,
    trim,
    value,
)
from inerter.validation import is_listed, is_number

_INNER = 64  # parts of an interval between two roots in which the real part is negative
_OUTER = [Fraction(5, 4) ** i for i in range(1, 100)]  # ratios to the outermost roots


def is_positive_real(numerator: Iterable[float], denominator: Iterable[float]) -> bool:
    """Whether numerator / denominator is positive real, as the admittance of every passive network is.

    Coefficients are given highest power of s first. They are taken as exact (floats, integers or fractions), and the
    answer is exact: no tolerance and no rounding. An admittance whose real part touches zero may therefore lose the
    property when its coefficients are rounded.

    Raises `SynthesisError` if the coefficients are invalid.

    >>> is_positive_real([1, 2, 3], [1, 1, 1]), is_positive_real([1, 0.1, 3], [1, 1, 1])
    (True, False)
    """
    return find_violation(Ratio.of(numerator, denominator)) is None


@dataclass(frozen=True)
class Ratio:
    """top(s) / bottom(s), integer coefficients, lowest power first, without common roots."""

    top: Polynomial
    bottom: Polynomial

    @staticmethod
    def of(numerator: Iterable[float], denominator: Iterable[float]) -> Ratio:
        """The ratio from coefficients with the highest power first; raises `SynthesisError` if they are invalid."""
        n, n_factor = _to_integers(_coefficients(numerator, "numerator"))
        d, d_factor = _to_integers(_coefficients(denominator, "denominator"))
        if not d:
            raise SynthesisError(
                "The denominator of the admittance is zero. Give at least one coefficient that is not."
            )
        common, factor = greatest_common_divisor(d, n), n_factor / d_factor
        top = scale_by(quotient(n, common), factor.numerator) if n else []
        return Ratio(top, scale_by(quotient(d, common), factor.denominator))


@dataclass(frozen=True)
class Violation:
    """A point s [rad/s], on or right of the imaginary axis, with the value there, whose real part is negative.

    `needs_damping` if a damper in parallel makes the admittance positive real.
    """

    s: complex
    admittance: complex
    needs_damping: bool = False

    def to_error(self) -> NotPositiveRealError:
        """The error that refuses such an admittance."""
        omega = abs(self.s.imag)
        frequency = f"{format_number(omega, 4)} rad/s ({format_number(omega / math.tau, 4)} Hz)"
        damping = format_quantity(-self.admittance.real, "N s/m")
        if self.s.real == 0.0:
            problem = f"Re Y = -{damping} at {frequency}, so such a network would supply energy."
        else:
            problem = (
                f"Re Y = -{damping} at s = {format_complex(self.s)} rad/s, right of the imaginary axis at "
                f"{frequency}. Poles and zeros must lie left of the axis, or be simple ones on it."
            )
        remedy = (
            f"Add a damper of slightly more than {damping} in parallel, or correct" if self.needs_damping else "Correct"
        )
        text = f"The admittance is not positive real: {problem} {remedy} the coefficients."
        return NotPositiveRealError(text, self.s, self.admittance)


def find_violation(ratio: Ratio) -> Violation | None:
    """A point that shows that the admittance is not positive real; None if it is."""
    n, d = ratio.top, ratio.bottom
    if not n:
        return None
    real, square = real_part(n, d), real_part(d, d)
    points = _points_of_negative_sign(real)
    if points:
        is_bounded = len(n) <= len(d) and _is_hurwitz(d)
        if is_bounded:
            points += [x for x in _extremes(real, square) if value(real, x) < 0]
        lowest, x = min((_real_admittance(real, square, x), x) for x in points)
        return Violation(1j * math.sqrt(x), complex(_to_float(lowest)), is_bounded)
    weight = _typical_size(n, d)
    total = add(scale_by(n, weight.denominator), scale_by(d, weight.numerator))
    return None if _is_hurwitz(total) else Violation(_rightmost_root(total), complex(_to_float(-weight)))


def real_part(n: Polynomial, d: Polynomial) -> Polynomial:
    """Re n(j w) d(-j w) as a polynomial in w^2."""
    even = multiply(n, mirror(d))[0::2]
    return trim([-c if i % 2 else c for i, c in enumerate(even)])


def _coefficients(given: Iterable[float], what: str) -> list[Fraction]:
    expected = f"The {what} of an admittance must be a list of real numbers, highest power of s first"
    if isinstance(given, Mapping | Set) or not is_listed(given):
        raise SynthesisError(f"{expected}, got {given!r}. Write, for example, [1.0, 2.0, 3.0].")
    numbers: list[Any] = list(given)
    if not numbers:
        raise SynthesisError(f"{expected}, got an empty one. Write [0.0] for zero.")
    for number in numbers:
        exact = isinstance(number, Rational) and not isinstance(number, bool)
        if not exact and not is_number(number):
            raise SynthesisError(f"{expected}, got the coefficient {number!r}. Give finite real numbers.")
    return [
        Fraction(int(c.numerator), int(c.denominator)) if isinstance(c, Rational) else Fraction(float(c))
        for c in numbers[::-1]
    ]


def _to_integers(p: list[Fraction]) -> tuple[Polynomial, Fraction]:
    """A primitive polynomial with integer coefficients, and the factor by which p is larger."""
    common = math.lcm(*(c.denominator for c in p))
    integers = trim([int(c * common) for c in p])
    reduced = primitive(integers)
    return reduced, (Fraction(integers[-1], reduced[-1] * common) if integers else Fraction(1))


def _points_of_negative_sign(p: Polynomial) -> list[Fraction]:
    """Points x >= 0 in all intervals between roots in which p(x) < 0."""
    roots = positive_roots(p)
    lowest, highest = (roots[0][0], roots[-1][1]) if roots else (Fraction(1), Fraction(1))
    stretches = [[lowest / ratio for ratio in _OUTER], [highest * ratio for ratio in _OUTER]]
    for (_, low), (high, _) in pairwise(roots):
        stretches.append([low + (high - low) * Fraction(i, _INNER) for i in range(1, _INNER)])
    found = [x for stretch in stretches if value(p, stretch[0]) < 0 for x in stretch]
    return [Fraction(0), *found] if p and p[0] < 0 else found


def _extremes(p: Polynomial, square: Polynomial) -> list[Fraction]:
    """Points x > 0 at which p(x) / square(x) is stationary."""
    return refine_positive_roots(add(multiply(derivative(p), square), scale_by(multiply(p, derivative(square)), -1)))


def _real_admittance(p: Polynomial, square: Polynomial, x: Fraction) -> Fraction:
    """p(x) / square(x), where square(x) > 0."""
    return value(p, x) * Fraction(x.denominator) ** (len(square) - len(p)) / value(square, x)


def _is_hurwitz(p: Polynomial) -> bool:
    """Whether all roots of p have negative real parts: Routh's scheme in integers."""
    if p[-1] < 0:
        p = [-c for c in p]
    if any(c <= 0 for c in p):
        return False
    upper, lower = p[::-1][0::2], p[::-1][1::2]
    while lower:
        if lower[0] <= 0:
            return False
        padded = [*lower[1:], 0]
        row = [lower[0] * upper[i + 1] - upper[0] * padded[i] for i in range(len(upper) - 1)]
        upper, lower = lower, primitive(row)
    return True


def _to_float(number: Fraction) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.copysign(math.inf, number)


def _typical_size(n: Polynomial, d: Polynomial) -> Fraction:
    """A power of two of the size of n/d."""
    bits = max(abs(c) for c in n).bit_length() - max(abs(c) for c in d).bit_length()
    return Fraction(2) ** bits


def _rightmost_root(p: Polynomial) -> complex:
    """The root with the largest real part."""
    first = next(i for i, c in enumerate(p) if c)
    p = p[first:]
    if len(p) < 2:
        return 0j
    shift = (abs(p[0]).bit_length() - abs(p[-1]).bit_length()) / (len(p) - 1)  # s = 2^shift z: roots of size 1
    largest = max(math.log2(abs(c)) + i * shift for i, c in enumerate(p) if c)
    scaled = [math.copysign(2.0 ** (math.log2(abs(c)) + i * shift - largest), c) if c else 0.0 for i, c in enumerate(p)]
    roots = np.roots(scaled[::-1]) * 2.0**shift
    found = complex(roots[np.argmax(roots.real)])
    return complex(found.real, abs(found.imag))
