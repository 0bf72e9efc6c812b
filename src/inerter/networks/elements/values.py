"""Values of elements: a number, a design variable, or a dependent value; and names."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.deprecation import RenamedAttribute
from inerter.errors import NetworkError
from inerter.formatting import format_alike, format_number
from inerter.validation import is_number, use_python_numbers

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True)
class Free:
    """A design variable between two bounds. Two of the same name are one.

    >>> import inerter as it
    >>> variable = it.free(100, 1e4, name="c")
    >>> isinstance(variable, it.Free), variable.lower, variable.upper
    (True, 100, 10000.0)
    """

    lower: float
    upper: float
    name: str | None = None

    def __post_init__(self) -> None:
        use_python_numbers(self)
        for bound in (self.lower, self.upper):
            if not is_number(bound):
                raise NetworkError(f"A bound of a free value must be a finite number, got {bound!r}.")
        if not 0.0 <= self.lower < self.upper:
            lower, upper = format_alike([self.lower, self.upper], "")
            raise NetworkError(
                f"The bounds of a free value must satisfy 0 <= lower < upper, got lower = {lower} and upper = {upper}. "
                f"Swap them if they are reversed; to fix the value, give the "
                f"number itself."
            )
        check_name(self.name)


def middle(value: float | Free) -> float:
    """The value; for a free one the geometric mean of its bounds, or the upper bound if the lower is zero."""
    if not isinstance(value, Free):
        return value
    return (value.lower * value.upper) ** 0.5 or value.upper


def free(lower: float, upper: float, name: str | None = None) -> Free:
    """A design variable between `lower` and `upper`, in the unit of its element.

    Raises `NetworkError` unless 0 <= lower < upper, both finite.

    >>> import inerter as it
    >>> it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(it.free(100, 1e4))).free_values()
    {'c': Free(lower=100, upper=10000.0, name='c')}
    """
    return Free(lower, upper, name)


@dataclass(frozen=True)
class Tied:
    """A dependent value: sums, differences, products and quotients of other values, by name, and numbers.

    `program` lists names and numbers in postfix notation, each operation after its two operands.

    >>> import inerter as it
    >>> rear = it.tied("k_front", factor=0.8)
    >>> isinstance(rear, it.Tied), rear.substitute({"k_front": 100e3})
    (True, 80000.0)
    """

    program: tuple[str | float, ...]

    def __add__(self, other: Tied | float) -> Tied:
        return _combine(self, other, "+")

    def __radd__(self, other: float) -> Tied:
        return _combine(other, self, "+")

    def __sub__(self, other: Tied | float) -> Tied:
        return _combine(self, other, "-")

    def __rsub__(self, other: float) -> Tied:
        return _combine(other, self, "-")

    def __mul__(self, other: Tied | float) -> Tied:
        return _combine(self, other, "*")

    def __rmul__(self, other: float) -> Tied:
        return _combine(other, self, "*")

    def __truediv__(self, other: Tied | float) -> Tied:
        return _combine(self, other, "/")

    def __rtruediv__(self, other: float) -> Tied:
        return _combine(other, self, "/")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the values on which it depends."""
        return tuple(dict.fromkeys(x for x in self.program if isinstance(x, str) and x not in _ARITHMETIC))

    def substitute(self, values: Mapping[str, float]) -> Tied | float:
        """The value with some names replaced by numbers; a number once all are."""
        known = tuple(float(values[x]) if isinstance(x, str) and x in values else x for x in self.program)
        found = Tied(known)
        return found if found.names else float(found.slopes({})[0])

    fixed = RenamedAttribute("substitute")

    def slopes(self, values: Mapping[str, ArrayLike]) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
        """The value, and its derivatives by name; infinite or nan where it divides by zero."""
        stack: list[tuple[Any, dict[str, Any]]] = []
        with np.errstate(all="ignore"):
            for x in self.program:
                if isinstance(x, float):
                    stack.append((np.float64(x), {}))
                elif x in _ARITHMETIC:
                    (b, db), (a, da) = stack.pop(), stack.pop()
                    value, by_a, by_b = _ARITHMETIC[x](a, b)
                    both = {**da, **db}
                    stack.append((value, {n: by_a * da.get(n, 0.0) + by_b * db.get(n, 0.0) for n in both}))
                else:
                    number = np.asarray(values[x], dtype=float)
                    stack.append((number, {x: np.ones_like(number)}))
        ((value, slopes),) = stack
        return np.asarray(value), slopes

    def __str__(self) -> str:
        stack: list[str] = []
        for x in self.program:
            if isinstance(x, str) and x in _ARITHMETIC:
                b, a = stack.pop(), stack.pop()
                stack.append(f"({a} {x} {b})")
            else:
                stack.append(x if isinstance(x, str) else format_number(x))
        return stack[0]


_ARITHMETIC: dict[str, Callable[[Any, Any], tuple[Any, Any, Any]]] = {  # the result and its two derivatives
    "+": lambda a, b: (a + b, 1.0, 1.0),
    "-": lambda a, b: (a - b, 1.0, -1.0),
    "*": lambda a, b: (a * b, b, a),
    "/": lambda a, b: (a / b, 1.0 / b, -a / (b * b)),
}


def tied(name: str, factor: float = 1.0, plus: float = 0.0) -> Tied:
    """A dependent value: `factor` times the free value of that name, `plus` a number in its unit.

    Ties can be added, subtracted, multiplied and divided, by one another and by numbers.

    Raises `NetworkError` for an invalid name or number.

    >>> import inerter as it
    >>> rear = it.Spring(it.tied("k_front", factor=0.8))
    >>> made_up = it.Spring(1.0 / (1.0 / 120e3 - 1.0 / it.tied("k1")))  # 120 kN/m in series with k1
    >>> made_up.with_value(made_up.value.substitute({"k1": 360e3})).value
    180000.0
    """
    if name is None:
        raise NetworkError("A tied value depends on a free one. Give its name.")
    check_name(name)
    found = Tied((name,))
    if _number(factor) != 1.0:
        found = factor * found
    return found + plus if _number(plus) != 0.0 else found


def _combine(one: Tied | float, other: Tied | float, operation: str) -> Tied:
    parts = [x.program if isinstance(x, Tied) else (_number(x),) for x in (one, other)]
    return Tied((*parts[0], *parts[1], operation))


def _number(value: object) -> float:
    if not is_number(value):
        raise NetworkError(f"A tied value must consist of other values and finite numbers, got {value!r}.")
    return float(value)


Value = float | Free | Tied


def check_name(name: object) -> None:
    """Raise `NetworkError` unless `name` is None or valid in an expression."""
    if name is not None and (not isinstance(name, str) or not NAME.fullmatch(name)):
        raise NetworkError(f"A name must be a letter followed by letters, digits and underscores, got {name!r}.")
