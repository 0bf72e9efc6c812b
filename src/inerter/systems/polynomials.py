"""Polynomials with whole coefficients, from the constant upwards, without rounding.

Whether two polynomials share a root, whether one has roots on the imaginary axis, and where its positive roots lie, is
decided by arithmetic alone. Shared roots are rare, and a prime modulus shows nearly always that there are none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from math import gcd as common
from math import inf
from typing import TypeVar

Polynomial = list[int]
Coefficient = TypeVar("Coefficient", int, Decimal)
_PRIME = (1 << 61) - 1
_FINE = Fraction(1, 1 << 56)  # of a root, to which an interval is halved
_ITERATIONS, _CLOSE, _TURN = 200, 4e-16, 1.0 + 1e-3j  # of a search for all roots: at most, last step, first turn


def trim(p: Sequence[Coefficient]) -> list[Coefficient]:
    """`p` without leading zeros; the zero polynomial is empty."""
    size = len(p)
    while size and p[size - 1] == 0:
        size -= 1
    return list(p[:size])


def primitive(p: Polynomial) -> Polynomial:
    """`p` over the largest number that divides all its coefficients."""
    content = common(*p) if p else 1
    return [c // content for c in p] if content > 1 else p


def multiply(p: Polynomial, q: Polynomial) -> Polynomial:
    """Product of two polynomials."""
    result = [0] * max(len(p) + len(q) - 1, 0)
    for i, a in enumerate(p):
        if a:
            for j, b in enumerate(q):
                result[i + j] += a * b
    return trim(result)


def add(p: Polynomial, q: Polynomial) -> Polynomial:
    """Sum of two polynomials."""
    short, long = sorted((p, q), key=len)
    return trim([a + b for a, b in zip(short, long, strict=False)] + long[len(short) :])


def scale_by(p: Polynomial, factor: int) -> Polynomial:
    """`p` times a number."""
    return trim([factor * c for c in p])


def derivative(p: Sequence[Coefficient]) -> list[Coefficient]:
    """Derivative of a polynomial."""
    return [i * c for i, c in enumerate(p)][1:]


def mirror(p: Polynomial) -> Polynomial:
    """p(-s)."""
    return [-c if i % 2 else c for i, c in enumerate(p)]


def interpolate_integers(values: Sequence[int]) -> Polynomial:
    """The polynomial with these values at 1, 2, 3, ..., which has whole coefficients.

    Divided differences of such a polynomial are whole too.
    """
    differences = list(values)
    for order in range(1, len(values)):
        for i in range(len(values) - 1, order - 1, -1):
            differences[i] = (differences[i] - differences[i - 1]) // order
    result: Polynomial = []
    for i in range(len(values) - 1, -1, -1):  # Horner's scheme in Newton's form: result (s - i - 1) + difference
        result = [(result[j - 1] if j else differences[i]) - (i + 1) * c for j, c in enumerate([*result, 0])]
    return trim(result)


def quotient(p: Polynomial, q: Polynomial) -> Polynomial:
    """Quotient p / q up to a constant factor, where q divides p and both are primitive."""
    rest, result = list(p), [0] * (len(p) - len(q) + 1)
    for i in range(len(result) - 1, -1, -1):
        result[i] = rest[i + len(q) - 1] // q[-1]
        if result[i]:
            for j, c in enumerate(q):
                rest[i + j] -= result[i] * c
    assert not any(rest)
    return result


def greatest_common_divisor(p: Polynomial, *others: Polynomial) -> Polynomial:
    """The greatest common divisor of all, primitive, with a positive leading coefficient; zeros are passed over."""
    result = primitive(trim(p))
    for other in others:
        if len(result) == 1:
            break
        if other:
            result = _gcd_of_two(result, primitive(other))
    return [-c for c in result] if result and result[-1] < 0 else result


def _gcd_of_two(p: Polynomial, q: Polynomial) -> Polynomial:
    if not p or not q:
        return p or q
    if p[-1] % _PRIME and q[-1] % _PRIME and _degree_of_gcd(p, q) == 0:
        return [1]
    if len(p) < len(q):
        p, q = q, p
    while q:
        p, q = q, primitive(_remainder(p, q))
    return primitive(p)


def _remainder(p: Polynomial, q: Polynomial) -> Polynomial:
    rest = list(p)
    while len(rest) >= len(q):
        factor = common(rest[-1], q[-1])
        up, down = q[-1] // factor, rest[-1] // factor
        shift = len(rest) - len(q)
        rest = [up * c for c in rest]
        for j, c in enumerate(q):
            rest[shift + j] -= down * c
        rest = trim(rest)
    return rest


def _degree_of_gcd(p: Polynomial, q: Polynomial) -> int:
    """The degree of the greatest common divisor modulo a prime, which is never less than the true one."""
    a, b = trim([c % _PRIME for c in p]), trim([c % _PRIME for c in q])
    while b:
        inverse = pow(b[-1], -1, _PRIME)
        while len(a) >= len(b):
            factor, shift = a[-1] * inverse % _PRIME, len(a) - len(b)
            a = trim(a[:shift] + [(x - factor * c) % _PRIME for x, c in zip(a[shift:], b, strict=True)])
        a, b = b, a
    return len(a) - 1


def _on_axis(p: Polynomial, powers: Sequence[int]) -> tuple[int, int]:
    """Real and imaginary part of `p` at j x, by the powers of x, which may all have one factor."""
    terms = [c * power for c, power in zip(p, powers, strict=False)]
    return sum(terms[0::4]) - sum(terms[2::4]), sum(terms[1::4]) - sum(terms[3::4])


def on_axis(p: Polynomial) -> Polynomial:
    """The polynomial whose roots are the squares of those roots of `p` whose negative is a root too.

    If no root lies to the right of the imaginary axis, these are the roots on it.
    """
    return greatest_common_divisor(trim(p[0::2]), trim(p[1::2])) if any(p[1::2]) else primitive(trim(p[0::2]))


def value(p: Polynomial, x: Fraction) -> int:
    """p(x) times the denominator of x to the degree of p, which has the sign of p(x)."""
    top, bottom = x.as_integer_ratio()
    result, power = 0, 1
    for c in reversed(p):
        result = result * top + c * power
        power *= bottom
    return result


def positive_roots(p: Polynomial) -> list[tuple[Fraction, Fraction]]:
    """Intervals above zero, apart from each other and in rising order, that hold one positive root of `p` each.

    By Descartes' rule of signs and bisection (Collins and Akritas, 1976). A root that is met has its interval (x, x).
    """
    p = _without_repeated_roots(p)
    if len(p) < 2:
        return []
    one, bits = Fraction(1), (p[0].bit_length() - p[-1].bit_length()) // (len(p) - 1)
    first = min(bits, 0) * (len(p) - 1)
    near = [c << bits * i - first for i, c in enumerate(p)]  # p(2^bits x), whose roots lie around one
    found = [_above_zero(near, *ends) for ends in _between_zero_and_one(near)]
    found += [(one, one)] if sum(near) == 0 else []
    beyond = [_above_zero(near[::-1], *ends) for ends in _between_zero_and_one(near[::-1])]
    found += [(1 / high, 1 / low) for low, high in reversed(beyond)]
    unit = Fraction(2) ** bits
    found = [(low * unit, high * unit) for low, high in found]
    for i in range(len(found) - 1):
        while found[i][1] >= found[i + 1][0]:
            found[i], found[i + 1] = _bisect_root(p, *found[i]), _bisect_root(p, *found[i + 1])
    return found


def refine_positive_roots(p: Polynomial) -> list[Fraction]:
    """The positive roots of `p` in rising order, to the digits of double precision."""
    simple = _without_repeated_roots(p)
    return [_refine_root(simple, *ends) for ends in positive_roots(simple)]


def _refine_root(p: Polynomial, low: Fraction, high: Fraction) -> Fraction:
    while high - low > _FINE * low:
        low, high = _bisect_root(p, low, high)
    return high


def improve_roots(p: Polynomial, guesses: Sequence[complex]) -> list[complex]:
    """All roots of `p`, of which none is zero, from as many `guesses`, by the iteration of Aberth (1973).

    The ratio of `p` and its derivative is rounded once at each guess, so that a root is as near as a number can be.
    Guesses are turned out of the real axis, which they would not leave by themselves.
    """
    slope, roots = derivative(p), [guess * _TURN for guess in guesses]
    waiting = set(range(len(roots)))
    for _ in range(_ITERATIONS):
        for i in sorted(waiting):
            step = _newton_step(p, slope, roots[i])
            others = sum(1.0 / (roots[i] - root) for root in roots if root != roots[i])
            step /= (1.0 - step * others) or 1.0
            roots[i] -= step
            if abs(step) <= _CLOSE * abs(roots[i]):
                waiting.discard(i)
    return [complex(root.real) if abs(root.imag) <= _CLOSE * abs(root.real) else root for root in roots]


def _newton_step(p: Polynomial, slope: Polynomial, z: complex) -> complex:
    """p(z) / p'(z), rounded once; zero where the latter is."""
    (a, one), (b, other) = z.real.as_integer_ratio(), z.imag.as_integer_ratio()
    unit = max(one, other)  # both are powers of two
    at = a * (unit // one), b * (unit // other), unit
    (x, y), (u, v) = _value_times(p, *at), _value_times(slope, *at)
    size = (u * u + v * v) * unit
    return complex((x * u + y * v) / size, (y * u - x * v) / size) if size else 0j


def _value_times(p: Polynomial, a: int, b: int, unit: int) -> tuple[int, int]:
    """Real and imaginary part of `p` at (a + b j) / unit, times the unit to the degree of `p`."""
    x, y, power = 0, 0, 1
    for c in reversed(p):
        x, y, power = x * a - y * b + c * power, x * b + y * a, power * unit
    return x, y


def _without_repeated_roots(p: Polynomial) -> Polynomial:
    """The polynomial with the roots of `p` other than zero, each of them once."""
    p = trim(p)
    while p and p[0] == 0:
        p = p[1:]
    repeated = greatest_common_divisor(p, derivative(p)) if len(p) > 1 else []
    return quotient(p, repeated) if len(repeated) > 1 else p


def _above_zero(p: Polynomial, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    while low == 0:
        low, high = _bisect_root(p, low, high)
    return low, high


def _bisect_root(p: Polynomial, low: Fraction, high: Fraction) -> tuple[Fraction, Fraction]:
    """The half that holds the one root of `p` above `low` and up to `high`; `p` has no double root."""
    middle = (low + high) / 2
    here = value(p, middle)
    if here == 0:
        return middle, middle
    before = value(p, low) or value(derivative(p), low)
    return (middle, high) if (before > 0) == (here > 0) else (low, middle)


def _between_zero_and_one(p: Polynomial) -> list[tuple[Fraction, Fraction]]:
    found: list[tuple[Fraction, Fraction]] = []
    waiting = [(p, 0, 0)]  # p((x + place) / 2^depth)
    while waiting:
        q, place, depth = waiting.pop()
        if q[0] == 0:
            if place:
                found.append((Fraction(place, 1 << depth),) * 2)
            q = q[1:]
        changes = _changes(_shift_by_one(q[::-1]))
        if changes == 1:
            found.append((Fraction(place, 1 << depth), Fraction(place + 1, 1 << depth)))
        elif changes > 1:
            left = [c << (len(q) - 1 - i) for i, c in enumerate(q)]
            waiting.append((_shift_by_one(left), 2 * place + 1, depth + 1))
            waiting.append((left, 2 * place, depth + 1))
    return found


def _shift_by_one(p: Polynomial) -> Polynomial:
    """p(x + 1)."""
    result = list(p)
    for i in range(len(p) - 1):
        for j in range(len(p) - 2, i - 1, -1):
            result[j] += result[j + 1]
    return result


def _changes(p: Polynomial) -> int:
    signs = [c > 0 for c in p if c]
    return sum(a != b for a, b in pairwise(signs))


Fractions = tuple[Polynomial, Polynomial] | None  # numerator and denominator; None is one


@dataclass(frozen=True)
class TransferFunctions:
    """G(s) = numerators[output][input] / denominator, with whole coefficients."""

    denominator: Polynomial
    numerators: tuple[tuple[Polynomial, ...], ...]

    def at(self, omega: float) -> list[list[complex]]:
        """G(j omega) of each output and input, rounded once; infinite at a pole."""
        top, bottom = omega.as_integer_ratio()
        degree = max(len(p) for row in (*self.numerators, (self.denominator,)) for p in row) - 1
        powers = [top**i * bottom ** (degree - i) for i in range(degree + 1)]
        real, imaginary = _on_axis(self.denominator, powers)
        size = real * real + imaginary * imaginary
        if not size:
            return [[complex(inf) for _ in row] for row in self.numerators]
        parts = ((_on_axis(p, powers) for p in row) for row in self.numerators)
        return [
            [complex((x * real + y * imaginary) / size, (y * real - x * imaginary) / size) for x, y in row]
            for row in parts
        ]

    def with_filters(self, filters: Sequence[Fractions]) -> TransferFunctions:
        """Transfer functions with each output times a fraction (None for 1), over one common denominator."""
        bottoms = list(dict.fromkeys(tuple(one[1]) for one in filters if one is not None))
        rows = []
        for row, one in zip(self.numerators, filters, strict=True):
            factor = [1] if one is None else one[0]
            for bottom in bottoms:
                if one is None or bottom != tuple(one[1]):
                    factor = multiply(factor, list(bottom))
            rows.append(tuple(multiply(factor, numerator) for numerator in row))
        denominator = self.denominator
        for bottom in bottoms:
            denominator = multiply(denominator, list(bottom))
        return TransferFunctions(denominator, tuple(rows))

    def with_inputs(self, sums: Sequence[Sequence[tuple[int, Fractions]]]) -> TransferFunctions:
        """Transfer functions from new inputs, each a sum of old inputs, by number, times fractions (None for 1)."""
        terms = [term for one in sums for term in one]
        by_input = TransferFunctions(
            self.denominator, tuple(tuple(row[i] for row in self.numerators) for i, _ in terms)
        ).with_filters([factor for _, factor in terms])
        columns = iter(by_input.numerators)
        added = [[next(columns) for _ in one] for one in sums]
        rows = []
        for k in range(len(self.numerators)):
            totals: list[Polynomial] = []
            for several in added:
                total: Polynomial = []
                for column in several:
                    total = add(total, column[k])
                totals.append(total)
            rows.append(tuple(totals))
        return TransferFunctions(by_input.denominator, tuple(rows))
