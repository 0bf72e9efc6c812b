"""Filters as values: stable linear systems with one input and one output, by their transfer functions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError
from inerter.formatting import format_complex
from inerter.systems.linear import LinearSystem
from inerter.systems.polynomials import Polynomial

Coefficient = float | Fraction
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Filter:
    """F(s) = numerator / denominator, each a list of coefficients with the highest power of s first; s in rad/s.

    `Filter((1.0, 0.0), (1.0, a))` is the high pass s/(s + a). `Filter.of(system)` takes a `LinearSystem`.

    Raises `LinearSystemError` if a coefficient is no finite real number, if the numerator is zero or of a higher order
    than the denominator, or if a pole does not lie in the open left half plane.

    >>> import inerter as it
    >>> abs(it.Filter([1.0, 0.0], [1.0, 2.0]).response([2.0])).round(4)
    array([0.7071])
    """

    numerator: Sequence[Coefficient]  # kept as tuples, without leading zeros
    denominator: Sequence[Coefficient]

    def __post_init__(self) -> None:
        for name in ("numerator", "denominator"):
            object.__setattr__(self, name, _coefficients(name, getattr(self, name)))
        if not self.numerator:
            raise LinearSystemError("The numerator of a filter must not be zero.")
        if not self.denominator:
            raise LinearSystemError("The denominator of a filter has a coefficient that is not zero.")
        if len(self.numerator) > len(self.denominator):
            raise LinearSystemError(
                f"The numerator of a filter is of no higher order than its denominator, got {len(self.numerator) - 1} "
                f"over {self.order}: the signal would be differentiated."
            )
        if not _is_stable([Fraction(c) for c in self.denominator]):
            poles = np.roots(np.array(self.denominator, dtype=float))
            worst = complex(poles[np.argmax(poles.real)])
            raise LinearSystemError(
                f"The poles of a filter lie in the open left half plane; of these one lies near "
                f"{format_complex(worst)} rad/s."
            )
        try:
            _ = self.scaled_coefficients
        except OverflowError:
            raise LinearSystemError("The coefficients of the filter are beyond the range of numbers.") from None

    @staticmethod
    def of(system: LinearSystem) -> Filter:
        """The filter that a linear system is, without rounding.

        Raises `LinearSystemError` unless it has one input, at once, and one output, and for what no filter is.
        """
        if not isinstance(system, LinearSystem):
            raise LinearSystemError(f"A filter is made of a LinearSystem, got {system!r}.")
        if len(system.inputs) != 1 or len(system.outputs) != 1 or np.any(system.delays):
            raise LinearSystemError(
                f"A filter has one input, which arrives at once, and one output; this system has "
                f"{len(system.inputs)} and {len(system.outputs)}{', and a delay' if np.any(system.delays) else ''}."
            )
        return Filter(*_transfer_function(system))

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.denominator) - 1

    @cached_property
    def whole(self) -> tuple[Polynomial, Polynomial]:
        """Numerator and denominator with whole coefficients, the lowest power first."""
        exact = [Fraction(c) for c in (*self.numerator, *self.denominator)]
        common = math.lcm(*(c.denominator for c in exact))
        integers = [int(c * common) for c in exact]
        count = len(self.numerator)
        return integers[:count][::-1], integers[count:][::-1]

    @cached_property
    def scaled_coefficients(self) -> tuple[float, Any, Any]:
        """A frequency w, and the coefficients of numerator and denominator over (s / w)^0, ..., (s / w)^order.

        Powers of two scale them, so that those of the denominator are near one and none is rounded but to extended
        precision.
        """
        top, bottom = self.whole
        exponent = round((_log2(bottom[0]) - _log2(bottom[-1])) / self.order) if self.order else 0
        rate = Fraction(2) ** exponent
        size = Fraction(2) ** round(_log2(bottom[-1]) + exponent * self.order)
        padded = [*top, *[0] * (len(bottom) - len(top))]
        numbers = [[_long(c * rate**i / size) for i, c in enumerate(p)] for p in (padded, bottom)]
        return float(rate), np.array(numbers[0]), np.array(numbers[1])

    def then(self, other: Filter) -> Filter:
        """Filter in series with another one after it, without rounding."""
        pairs = ((self.numerator, other.numerator), (self.denominator, other.denominator))
        return Filter(*(_convolve(*pair) for pair in pairs))

    def response(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """F(j omega) at angular frequencies [rad/s]."""
        rate, top, bottom = self.scaled_coefficients
        x = 1j * np.asarray(omega, dtype=float) / rate
        low = np.abs(x) <= 1.0
        powers = np.where(low, x, 1.0 / np.where(low, 1.0, x))  # beyond, both are taken over the highest power
        near, far = (
            np.polynomial.polynomial.polyval(powers, p) / np.polynomial.polynomial.polyval(powers, q)
            for p, q in (
                (top.astype(float), bottom.astype(float)),
                (top[::-1].astype(float), bottom[::-1].astype(float)),
            )
        )
        return np.asarray(np.where(low, near, far))


@lru_cache(maxsize=64)
def high_pass(corner: float) -> Filter:
    """s/(s + corner), corner in rad/s."""
    return Filter((1.0, 0.0), (1.0, corner))


def as_filter(given: object) -> Filter | None:
    """`given`, a filter, a linear system or nothing, as a filter.

    Raises `LinearSystemError` for anything else.
    """
    if given is None or isinstance(given, Filter):
        return given
    if isinstance(given, LinearSystem):
        return Filter.of(given)
    raise LinearSystemError(f"A filter is Filter(numerator, denominator) or a LinearSystem, got {given!r}.")


def with_filter_states(X_eta: Matrix, X_x: Matrix, filters: Sequence[Filter]) -> tuple[Matrix, Matrix, list[slice]]:
    """Rates X_eta eta + X_x x of states, with those of the states of `filters`, and the places of these.

    The states of a filter are a signal and its derivatives but the highest, which is a further unknown in eta.

    >>> with_filter_states(np.zeros((2, 1)), np.eye(2), [Filter([1.0], [1.0, 3.0, 2.0])])[2]
    [slice(2, 4, None)]
    """
    old, first = X_eta.shape
    edges = (old + np.cumsum([0, *(one.order for one in filters)])).tolist()
    states = [slice(start, stop) for start, stop in pairwise(edges)]
    rates, own = np.zeros((edges[-1], first + len(filters))), np.zeros((edges[-1], edges[-1]))
    rates[:old, :first], own[:old, :old] = X_eta, X_x
    for unknown, (one, place) in enumerate(zip(filters, states, strict=True), start=first):
        rows = np.arange(place.start, place.stop)
        own[rows[:-1], rows[1:]] = one.scaled_coefficients[0]
        rates[rows[-1:], unknown] = one.scaled_coefficients[0]
    return rates, own, states


def _convolve(left: Sequence[Coefficient], right: Sequence[Coefficient]) -> list[Fraction]:
    result = [Fraction(0)] * (len(left) + len(right) - 1)
    for i, x in enumerate(left):
        for j, y in enumerate(right):
            result[i + j] += Fraction(x) * Fraction(y)
    return result


def _coefficients(name: str, given: object) -> tuple[Coefficient, ...]:
    """Coefficients as numbers, without leading zeros."""
    try:
        listed = list(given) if not isinstance(given, str) else []  # type: ignore[call-overload]
        numbers = tuple(c if isinstance(c, Fraction) else _real(c) for c in listed)
    except (TypeError, ValueError, OverflowError):
        numbers = ()
    if not numbers or not all(isinstance(c, Fraction) or math.isfinite(c) for c in numbers):
        raise LinearSystemError(
            f"The {name} of a filter is a list of finite real numbers, the highest power of s first, got {given!r}."
        )
    first = next((i for i, c in enumerate(numbers) if c), len(numbers))
    return numbers[first:]


def _real(value: Any) -> float:
    if isinstance(value, str | bool) or np.iscomplexobj(value):
        raise TypeError
    return float(value)


def _is_stable(descending: list[Fraction]) -> bool:
    """Whether all roots have negative real parts: the first column of Routh's array keeps its sign."""
    if any(c * descending[0] <= 0 for c in descending):
        return False
    upper, lower = descending[0::2], descending[1::2]
    while lower:
        if lower[0] * descending[0] <= 0:
            return False
        factor = upper[0] / lower[0]
        after = [u - factor * b for u, b in zip(upper[1:], [*lower[1:], Fraction(0)], strict=False)]
        upper, lower = lower, after
    return True


@lru_cache(maxsize=64)  # the definition of an index is made again and again
def _transfer_function(system: LinearSystem) -> tuple[list[Fraction], list[Fraction]]:
    """Numerator and denominator, the highest power first: from c A^k b, and from the traces of the powers of A."""
    n = system.order
    A, size = _whole(system.A)
    column, more = _whole(system.B)
    (row,), most = _whole(system.C)
    scale, powers, bottom = more * most, A, [Fraction(1)]
    traces, markov = list[Fraction](), list[Fraction]()
    for k in range(n):
        markov.append(Fraction(sum(c * b for c, (b,) in zip(row, column, strict=True)), scale * size**k))
        traces.append(Fraction(sum(powers[i][i] for i in range(n)), size ** (k + 1)))
        column, powers = _product(A, column), _product(powers, A)
    for k in range(1, n + 1):
        bottom.append(-sum((bottom[k - i] * traces[i - 1] for i in range(1, k + 1)), Fraction(0)) / k)
    top = [Fraction(float(system.D[0, 0])) * x for x in bottom]
    for k in range(1, n + 1):
        top[k] += sum((bottom[k - 1 - i] * markov[i] for i in range(k)), Fraction(0))
    return top, bottom


def _whole(matrix: NDArray[np.float64]) -> tuple[list[list[int]], int]:
    """A matrix as whole numbers over one."""
    exact = [[Fraction(x) for x in row] for row in matrix.tolist()]
    size = math.lcm(1, *(x.denominator for row in exact for x in row))
    return [[int(x * size) for x in row] for row in exact], size


def _product(left: list[list[int]], right: list[list[int]]) -> list[list[int]]:
    columns = list(zip(*right, strict=True))
    return [[sum(x * y for x, y in zip(row, column, strict=True)) for column in columns] for row in left]


def _log2(number: int) -> float:
    return math.log2(abs(number))


def _long(number: Fraction) -> Any:
    """Number in extended precision."""
    high = float(number)
    return np.longdouble(high) + np.longdouble(float(number - Fraction(high)))
