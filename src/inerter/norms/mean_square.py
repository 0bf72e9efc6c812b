"""The mean square of a response to white noise, from coefficients that are whole: what is infinite is decided exactly.

Roots that numerators and denominator share are divided out, and what is left on the imaginary axis makes the mean
square infinite; a passive mechanism has no poles to its right. The integral is a sum of residues, which needs no poles:
that of p/a is the leading coefficient of p modulo a. It is taken in decimals, twice as many until nothing changes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, DecimalException, getcontext, localcontext
from functools import cached_property, lru_cache
from itertools import zip_longest

from inerter.systems.polynomials import (
    Polynomial,
    add,
    greatest_common_divisor,
    mirror,
    multiply,
    on_axis,
    quotient,
    refine_positive_roots,
    scale_by,
    trim,
)

_AGREED = Decimal("1e-13")
_FEWEST, _MOST = 50, 6400  # digits
_SMALL = 16  # bits by which the exponent of a Taylor series lies below one
Numbers = list[Decimal]


class UnknownError(ArithmeticError):
    """A number cannot be had in the digits that are tried, or is beyond the range of floating point."""


@dataclass(frozen=True)
class Transfer:
    """Transfer from one source to one output: numerators over one denominator, with the delay of each [s]."""

    denominator: Polynomial
    numerators: tuple[Polynomial, ...]
    times: tuple[float, ...]

    def without_common_roots(self) -> Transfer:
        """Transfer with the roots common to numerators and denominator cancelled."""
        common = greatest_common_divisor(self.denominator, *self.numerators)
        if len(common) == 1:
            return self
        numerators = tuple(quotient(n, common) if n else n for n in self.numerators)
        return Transfer(quotient(self.denominator, common), numerators, self.times)

    @property
    def is_direct(self) -> bool:
        """Whether white noise passes straight through."""
        return max(map(len, self.numerators), default=0) >= len(self.denominator)


def axis_frequencies(denominator: Polynomial) -> list[float]:
    """Frequencies [rad/s] of the roots on the imaginary axis, none of which lies to its right."""
    zeros = next(i for i, c in enumerate(denominator) if c)
    squares = refine_positive_roots(mirror(on_axis(denominator[zeros:])))
    return [0.0] * bool(zeros) + [math.sqrt(square) for square in squares]


def mean_square(response: Transfer) -> tuple[float, list[float]]:
    """Variance of the response to unit white noise, and the frequencies of undamped motions that make it infinite.

    `response` is reduced and passes no noise straight through. Raises `UnknownError`.
    """
    a, numerators = response.denominator, response.numerators
    frequencies = axis_frequencies(a)
    drifts = frequencies == [0.0] and a[1] != 0 and sum(n[0] for n in numerators if n) == 0
    if frequencies and not drifts:
        return math.inf, frequencies
    before: Decimal | None = None
    digits = _FEWEST
    while digits <= _MOST:
        context = Context(prec=digits, Emax=MAX_EMAX, Emin=MIN_EMIN)
        with localcontext(context):
            try:
                found = _drifting(response) if drifts else _square(a, numerators, response.times)
            except (DecimalException, ZeroDivisionError):
                found = None
            if found is not None and before is not None and abs(found - before) <= _AGREED * found:
                return _float(found), []
        before, digits = found, 2 * digits
    raise UnknownError("the mean square could not be computed")


def _float(number: Decimal) -> float:
    result = float(number)
    if not (0.0 < result < math.inf) and number != 0:
        raise UnknownError("the mean square is beyond the range of numbers")
    return result


def _square(a: Polynomial, numerators: Sequence[Polynomial], times: Sequence[float]) -> Decimal:
    """Sum over all pairs of arrivals of the integral of p(s) q(-s) exp(s dt) / (a(s) a(-s))."""
    ring = _modulo(tuple(a), getcontext().prec)
    inverse = ring.inverse_of_mirrored
    total = Decimal(0)
    for i, p in enumerate(numerators):
        for j, q in enumerate(numerators):
            gap = times[j] - times[i]
            if p and q and (gap > 0.0 or (gap == 0.0 and i <= j)):
                f = ring.multiply(ring.reduce(multiply(p, mirror(q))), inverse)
                if gap > 0.0:
                    f = ring.multiply(f, ring.exponential(Decimal(times[j]) - Decimal(times[i])))
                total += (1 if i == j else 2) * ring.residues(f)
    return total


def _drifting(response: Transfer) -> Decimal:
    """Mean square with a pole at zero that cancels in the sum over all input paths, as in a tyre's share of the road.

    With p/(s a) = r/s + h/a, each arrival adds a step r to the decaying rest; the steps add up to zero in the end.
    """
    a, times = response.denominator[1:], response.times
    steps = [n[0] if n else 0 for n in response.numerators]
    rests = [
        trim(add(scale_by(n, a[0]), scale_by(a, -step))[1:]) for n, step in zip(response.numerators, steps, strict=True)
    ]
    ring = _modulo(tuple(a), getcontext().prec)
    total = _square(a, rests, times) if any(rests) else Decimal(0)
    for step, start in zip(steps, times, strict=True):
        for other, then in zip(steps, times, strict=True):
            total -= Decimal(step * other) * abs(Decimal(start) - Decimal(then)) / 2
        for rest, then in zip(rests, times, strict=True):  # the integral of the rest from the step on
            f = ring.multiply(ring.reduce(rest), ring.inverse_of_s())
            if start > then:
                f = ring.multiply(f, ring.exponential(Decimal(start) - Decimal(then)))
            total -= 2 * step * ring.residues(f)
    return total / Decimal(a[0]) ** 2


@lru_cache(maxsize=16)  # the outputs of one vehicle share their denominator
def _modulo(a: tuple[int, ...], digits: int) -> _Modulo:
    """The ring of polynomials modulo a(s), in numbers of as many digits as the context has."""
    assert digits == getcontext().prec
    return _Modulo(a)


class _Modulo:
    """Ring of polynomials modulo a(s), all of whose roots have negative real parts."""

    def __init__(self, a: Sequence[int]) -> None:
        self.whole, self.leading = a, Decimal(a[-1])
        self.a = [Decimal(c) / self.leading for c in a]
        self.n = len(a) - 1
        self.powers: dict[Decimal, Numbers] = {}

    def residues(self, f: Numbers) -> Decimal:
        """The sum of the residues of f/a."""
        return f[self.n - 1] / self.leading if self.n else Decimal(0)

    def reduce(self, p: Sequence[int] | Numbers) -> Numbers:
        rest = [+Decimal(c) for c in p] + [Decimal(0)] * (self.n - len(p))
        for i in range(len(rest) - 1, self.n - 1, -1):
            top = rest.pop()
            if top:
                for j in range(self.n):
                    rest[i - self.n + j] -= top * self.a[j]
        return rest

    def multiply(self, f: Numbers, g: Numbers) -> Numbers:
        product = [Decimal(0)] * max(2 * self.n - 1, 0)
        for i, x in enumerate(f):
            if x:
                for j, y in enumerate(g):
                    product[i + j] += x * y
        return self.reduce(product)

    def inverse_of_s(self) -> Numbers:
        return [-c / self.a[0] for c in self.a[1:]]

    @cached_property
    def inverse_of_mirrored(self) -> Numbers:
        """1/a(-s) at the roots of a = e(s^2) + s o(s^2), where a(-s) = 2 e(s^2) = -2 s o(s^2).

        With u e + v o = 1 that is (u - v/s)/2.
        """
        if self.n == 0:
            return []
        u, v = _bezout([+Decimal(c) for c in self.whole[0::2]], [+Decimal(c) for c in self.whole[1::2]])
        odd = self.multiply(self.reduce(_spread(v)), self.inverse_of_s())
        return [(x - y) / 2 for x, y in zip(self.reduce(_spread(u)), odd, strict=True)]

    def exponential(self, time: Decimal) -> Numbers:
        """exp(s time): a Taylor series of a small part of the time, squared."""
        if time not in self.powers:
            bits = [c.bit_length() - self.whole[-1].bit_length() + 1 for c in self.whole[-2::-1]]
            fastest = 1 + max((math.ceil(b / k) for k, b in enumerate(bits, 1)), default=0)  # Fujiwara's, of the roots
            squarings = max(0, fastest + math.frexp(float(time))[1] + _SMALL)
            step = time / 2**squarings
            total = term = self.reduce([Decimal(1)])
            for k in range(1, getcontext().prec * 4 // _SMALL + 2):
                term = [c * step / k for c in self.reduce([Decimal(0), *term])]
                total = [x + y for x, y in zip(total, term, strict=True)]
            for _ in range(squarings):
                total = self.multiply(total, total)
            self.powers[time] = total
        return self.powers[time]


def _spread(p: Numbers) -> Numbers:
    """p(s^2)."""
    return [c for x in p for c in (x, Decimal(0))][:-1]


def _bezout(e: Numbers, o: Numbers) -> tuple[Numbers, Numbers]:
    """U and v with u e + v o = 1, by Euclid's algorithm."""
    one, none = [Decimal(1)], [Decimal(0)]
    before, now = [e, one, none], [o, none, one]
    while len(now[0]) > 1:
        factors, rest = _divide(before[0], now[0])
        before, now = now, [rest, *(_less(x, factors, y) for x, y in zip(before[1:], now[1:], strict=True))]
    scale, u, v = now
    return [c / scale[0] for c in u], [c / scale[0] for c in v]


def _divide(p: Numbers, q: Numbers) -> tuple[Numbers, Numbers]:
    """Quotient, and remainder of a degree below that of q."""
    rest, factors = list(p), [Decimal(0)] * max(len(p) - len(q) + 1, 1)
    while len(rest) >= len(q):
        top = rest[-1] / q[-1]
        factors[len(rest) - len(q)] = top
        for j in range(len(q) - 1):
            rest[len(rest) - len(q) + j] -= top * q[j]
        rest.pop()
    return factors, rest


def _less(x: Numbers, factors: Numbers, y: Numbers) -> Numbers:
    """X - factors y."""
    product = [Decimal(0)] * (len(factors) + len(y) - 1)
    for i, a in enumerate(factors):
        for j, b in enumerate(y):
            product[i + j] += a * b
    return [a - b for a, b in zip_longest(x, product, fillvalue=Decimal(0))]
