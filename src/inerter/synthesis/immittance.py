"""Admittances and impedances as ratios of polynomials in decimals of many digits, and what can be split off them.

Frequencies of minima and of poles are algebraic numbers, so synthesis cannot stay in fractions. Decimals of `DIGITS`
digits leave room for all cancellation; a difference smaller than `tiny` times its terms is zero by intention.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import zip_longest

import numpy as np

from inerter.systems.polynomials import Polynomial, derivative, positive_roots, trim

DIGITS = 100
_FINE = Decimal("1e-70")  # relative size below which a difference is rounding
_NEWTON_STEPS = 40
_STEPS = 400  # of bisection at most; Newton's method needs far fewer
Numbers = list[Decimal]  # coefficients, lowest power first, the last one not zero
ZERO, ONE = Decimal(0), Decimal(1)


@dataclass(frozen=True)
class Immittance:
    """top(s) / bottom(s): an admittance, or an impedance (velocity over force)."""

    top: Numbers
    bottom: Numbers
    is_impedance: bool
    tiny: Decimal

    def inverse(self) -> Immittance:
        """The same one-port as impedance instead of admittance, or the other way round."""
        return Immittance(self.bottom, self.top, not self.is_impedance, self.tiny)

    def over(self, top: Numbers, bottom: Numbers) -> Immittance:
        """An immittance of the same kind."""
        return Immittance(top, bottom, self.is_impedance, self.tiny)

    def without_pole_at_infinity(self) -> tuple[Decimal, Immittance]:
        """Factor a and the rest of a s + rest."""
        a = self.top[-1] / self.bottom[-1]
        rest = self._difference(self.top, [ZERO, *(a * c for c in self.bottom)])
        return a, self.over(trim(rest[:-1]), self.bottom)

    def without_pole_at_zero(self) -> tuple[Decimal, Immittance]:
        """Factor a and the rest of a / s + rest."""
        bottom = self.bottom[1:]
        a = self.top[0] / bottom[0]
        rest = self._difference(self.top, [a * c for c in bottom])
        return a, self.over(trim(rest[1:]), bottom)

    def without_pole_at(self, x: Decimal) -> tuple[Decimal, Immittance]:
        """Factor a and the rest of a s / (s^2 + x) + rest."""
        bottom = _divide_by_quadratic(self.bottom, x)
        (n_even, n_odd), (d_even, d_odd) = _parts(self.top, x), _parts(bottom, x)
        a = (n_odd * d_even - n_even * d_odd) / (d_even**2 + x * d_odd**2)
        rest = self._difference(self.top, [ZERO, *(a * c for c in bottom)])
        return a, self.over(_divide_by_quadratic(rest, x), bottom)

    def without_constant(self, a: Decimal, *, at_zero: bool = False, at_infinity: bool = False) -> Immittance:
        """The rest of a + rest, whose value at zero or infinity is zero if so given."""
        rest = self._difference(self.top, [a * c for c in self.bottom])
        if at_zero:
            rest[0] = ZERO
        return self.over(trim(rest[:-1] if at_infinity else rest), self.bottom)

    def real_part(self) -> Numbers:
        """Re top(j w) bottom(-j w) as a polynomial in x = w^2."""
        terms: list[list[Decimal]] = [[] for _ in range((len(self.top) + len(self.bottom)) // 2)]
        for i, a in enumerate(self.top):
            for j, b in enumerate(self.bottom):
                if (i + j) % 2 == 0:
                    terms[(i + j) // 2].append(-a * b if (i - j) % 4 else a * b)
        return trim([_sum(each, self.tiny) for each in terms])

    def square(self) -> Numbers:
        """|bottom(j w)|^2 as a polynomial in x = w^2."""
        return self.over(self.bottom, self.bottom).real_part()

    def smallest_real_part(self) -> tuple[Decimal, Decimal | None]:
        """The minimum of the real part on the imaginary axis and its x = w^2; None if that is infinite."""
        real, square = self.real_part(), self.square()
        up, down = _multiply(derivative(real), square), _multiply(real, derivative(square))
        slope = trim([_sum((a, -b), _FINE) for a, b in zip_longest(up, down, fillvalue=ZERO)])
        found: list[tuple[Decimal, Decimal | None]] = [(real[0] / square[0], ZERO)]
        found.append((real[-1] / square[-1] if len(real) == len(square) else ZERO, None))
        least = min(found, key=lambda each: each[0])
        for x in roots(slope):
            here = evaluate(real, x) / evaluate(square, x)
            if here < least[0] * (1 - self.tiny):
                least = here, x
        return least

    def touching(self) -> list[Decimal]:
        """All x = w^2 > 0 at which the real part, or the denominator, touches zero on the imaginary axis."""
        real = self.real_part()
        return [x for x in roots(derivative(real)) if _is_tiny(real, x, self.tiny)]

    def has_pole_at(self, x: Decimal) -> bool:
        """Whether there are poles at the roots of s^2 + x."""
        tiny = self.tiny.sqrt()
        return _is_tiny(self.bottom[0::2], -x, tiny) and _is_tiny(self.bottom[1::2], -x, tiny)

    def at(self, x: Decimal) -> tuple[Decimal, Decimal]:
        """Real part and, over w, imaginary part of the value at s = j w, where x = w^2."""
        (n_even, n_odd), (d_even, d_odd) = _parts(self.top, x), _parts(self.bottom, x)
        size = d_even**2 + x * d_odd**2
        return (n_even * d_even + x * n_odd * d_odd) / size, (n_odd * d_even - n_even * d_odd) / size

    def _difference(self, p: Numbers, q: Numbers) -> Numbers:
        return [_sum((a, -b), self.tiny) for a, b in zip_longest(p, q, fillvalue=ZERO)]

    def richards(self, slope: Decimal) -> tuple[Decimal, Immittance]:
        """Point k and Richards' function R(s) = (k F(s) - s F(k)) / (k F(k) - s F(s)), where F(k) = `slope` k.

        R is positive real and its degree is at most that of F (Richards 1947).
        """
        n, d = self.top, self.bottom
        k = _only_positive_root([a - slope * b for a, b in zip_longest(n, [ZERO, *d], fillvalue=ZERO)])
        value = slope * k
        top = [k * a - value * b for a, b in zip_longest(n, [ZERO, *d], fillvalue=ZERO)]
        bottom = [k * value * a - b for a, b in zip_longest(d, [ZERO, *n], fillvalue=ZERO)]
        top, bottom = _divide_by_root(top, k), _divide_by_root(bottom, k)
        if _is_tiny(top, -k, _FINE) and _is_tiny(bottom, -k, _FINE):
            top, bottom = _divide_by_root(top, -k), _divide_by_root(bottom, -k)
        return k, self.over(top, bottom)

    def partial_fractions(self) -> list[Immittance]:
        """Strictly proper parts, one for each real pole and each pair of complex ones; empty if poles coincide."""
        factors = _real_factors(self.bottom)
        parts = []
        for i, factor in enumerate(factors):
            others = [self.bottom[-1]]
            for other in factors[:i] + factors[i + 1 :]:
                others = _multiply(others, other)
            parts.append(self.over(trim(_quotient_modulo(self.top, others, factor)), factor))
        return parts


def evaluate(p: Sequence[Decimal], x: Decimal) -> Decimal:
    """p(x) by Horner's scheme."""
    result = ZERO
    for c in reversed(p):
        result = result * x + c
    return result


def roots(p: Numbers) -> list[Decimal]:
    """The positive roots of p in rising order, to nearly all digits."""
    if len(p) < 2:
        return []
    integers = _to_integers(p)
    return [
        _refine(p, Decimal(low.numerator) / low.denominator, Decimal(high.numerator) / high.denominator)
        for low, high in positive_roots(integers)
    ]


def _refine(p: Numbers, low: Decimal, high: Decimal) -> Decimal:
    """The one root of p between `low` and `high`: Newton's method, with bisection where it leaves the interval."""
    if low == high:
        return low
    slope = derivative(p)
    rises = evaluate(p, high) > evaluate(p, low)
    x = (low + high) / 2
    for _ in range(_STEPS):
        here = evaluate(p, x)
        if (here > 0) == rises:
            high = x
        else:
            low = x
        steep = evaluate(slope, x)
        following = x - here / steep if steep else low
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - x) <= _FINE * x:
            return following
        x = following
    return x


def _real_factors(p: Numbers) -> list[Numbers]:
    """Factors s + a and s^2 + b s + c of p, to nearly all digits; empty where roots are too close to find them."""
    size = (abs(p[0] / p[-1])).ln() / (len(p) - 1)
    terms = [c * (i * size).exp() for i, c in enumerate(p)]
    largest = max(map(abs, terms))
    factors = []
    for root in np.roots([float(c / largest) for c in reversed(terms)]):
        if root.imag >= 0.0:
            guess = [-root.real] if root.imag == 0.0 else [abs(root) ** 2, -2.0 * root.real]
            stretched = [Decimal(c) * ((len(guess) - i) * size).exp() for i, c in enumerate(guess)]
            factor = _refine_factor(p, [*stretched, ONE])
            if factor is None:
                return []
            factors.append(factor)
    return factors


def _refine_factor(p: Numbers, factor: Numbers) -> Numbers | None:
    """A factor of p from a close one, by Newton's method in its coefficients (Bairstow 1920); None if that fails."""
    for _ in range(_NEWTON_STEPS):
        quotient, rest = _divide(p, factor)
        change = _quotient_modulo(rest, _divide(quotient, factor)[1], factor)
        factor = [*(a + b for a, b in zip_longest(factor[:-1], change, fillvalue=ZERO)), ONE]
        if all(abs(b) <= _FINE * abs(a) for a, b in zip(factor, change, strict=False)):
            return factor
    return None


def _divide(p: Numbers, q: Numbers) -> tuple[Numbers, Numbers]:
    """Quotient and remainder of p over q, whose leading coefficient is one."""
    rest, quotient = list(p), [ZERO] * max(len(p) - len(q) + 1, 0)
    for i in range(len(quotient) - 1, -1, -1):
        quotient[i] = rest[i + len(q) - 1]
        for j, c in enumerate(q):
            rest[i + j] -= quotient[i] * c
    return quotient, rest[: len(q) - 1]


def _quotient_modulo(p: Numbers, q: Numbers, factor: Numbers) -> Numbers:
    """The polynomial x with x q = p modulo s + a or s^2 + b s + c."""
    p, q = _divide(p, factor)[1], _divide(q, factor)[1]
    if len(factor) == 2:
        return [p[0] / q[0]]
    (a, b), (e, f) = ((*each, ZERO, ZERO)[:2] for each in (p, q))
    mean, size = factor[1], factor[0]
    norm = e * e - mean * e * f + size * f * f  # q times its conjugate e - b f - f s
    return [(a * (e - mean * f) + size * b * f) / norm, (b * e - a * f) / norm]


def _only_positive_root(p: Numbers) -> Decimal:
    """The positive root of n(s) - slope s d(s): n(s) / (s d(s)) falls where n/d is positive real."""
    found = roots(trim(p))
    if len(found) != 1:
        raise ArithmeticError(f"{len(found)} positive roots instead of one")
    return found[0]


def _to_integers(p: Numbers) -> Polynomial:
    """Polynomial p times a power of ten, with integer coefficients."""
    shift = min(int(c.as_tuple().exponent) for c in p if c)
    return trim([int(c.scaleb(-shift)) if c else 0 for c in p])


def _parts(p: Numbers, x: Decimal) -> tuple[Decimal, Decimal]:
    """p(j w) = even + j w odd, where x = w^2."""
    return evaluate(p[0::2], -x), evaluate(p[1::2], -x)


def _is_tiny(p: Sequence[Decimal], x: Decimal, tiny: Decimal) -> bool:
    """Whether p(x) is zero but for rounding of its terms."""
    return abs(evaluate(p, x)) <= tiny * evaluate([abs(c) for c in p], abs(x))


def _sum(terms: Iterable[Decimal], tiny: Decimal) -> Decimal:
    """The sum of the terms; zero if it is `tiny` against them."""
    terms = list(terms)
    total = sum(terms, ZERO)
    return ZERO if abs(total) <= tiny * sum((abs(term) for term in terms), ZERO) else total


def _multiply(p: Numbers, q: Numbers) -> Numbers:
    result = [ZERO] * max(len(p) + len(q) - 1, 0)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            result[i + j] += a * b
    return result


def _divide_by_quadratic(p: Numbers, x: Decimal) -> Numbers:
    """The quotient of p and s^2 + x, a factor of p."""
    result = [ZERO] * (len(p) - 2)
    for i in range(len(result) - 1, -1, -1):
        above = x * result[i + 2] if i + 2 < len(result) else ZERO
        result[i] = _sum((p[i + 2], -above), _FINE)
    return trim(result)


def _divide_by_root(p: Numbers, root: Decimal) -> Numbers:
    """The quotient of p and s - root, a factor of p."""
    result = [ZERO] * (len(p) - 1)
    for i in range(len(result) - 1, -1, -1):
        above = root * result[i + 1] if i + 1 < len(result) else ZERO
        result[i] = _sum((p[i + 1], above), _FINE)
    return trim(result)
