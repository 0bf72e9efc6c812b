"""Validation of numbers, used by all layers where input enters."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TypeGuard

from inerter.errors import InerterError


def is_number(value: object) -> TypeGuard[float]:
    """Whether `value` is a finite real number (neither a bool nor an integer beyond floating point)."""
    if type(value) is float:  # as nearly always; an abstract class takes ten times as long
        return math.isfinite(value)
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def number_or_none(value: object) -> float | None:
    """The value, or None unless it is a finite number: what JSON holds of an error that is not known.

    >>> number_or_none(2.0), number_or_none(math.nan), number_or_none(None)
    (2.0, None, None)
    """
    return value if is_number(value) else None


def use_python_numbers(of: object) -> None:
    """Replace the numbers of NumPy and the fractions among the fields of a frozen dataclass by numbers of Python.

    Arithmetic with them would keep the seven digits of a float32 and the overflow of an int32. Mappings of names to
    numbers are replaced likewise; whatever is not a finite number stays, to be refused.
    """
    for name, value in vars(of).items():
        if type(value) in _OF_PYTHON:  # as nearly always
            continue
        if isinstance(value, dict):
            if not _OF_PYTHON.issuperset(map(type, value.values())):
                object.__setattr__(of, name, {key: _python_number(number) for key, number in value.items()})
        elif (number := _python_number(value)) is not value:
            object.__setattr__(of, name, number)


_OF_PYTHON = frozenset({float, int, bool, str, tuple, type(None)})


def _python_number(value: object) -> object:
    if type(value) in _OF_PYTHON or not is_number(value):
        return value
    return int(value) if isinstance(value, Integral) else float(value)


def check_positive(error: type[InerterError], what: str, value: object, unit: str) -> None:
    """Raise `error` unless `value` is a positive, finite number of `unit`."""
    if not is_number(value) or value <= 0.0:
        raise error(f"{what} must be a positive number of {unit}, got {value!r}.")


def is_whole(value: object, least: int = 0, most: float = math.inf) -> TypeGuard[int]:
    """Whether `value` is an integer (no bool) within these limits.

    >>> is_whole(3, 1), is_whole(0, 1), is_whole(3.0), is_whole(True)
    (True, False, False, False)
    """
    return isinstance(value, Integral) and not isinstance(value, bool) and least <= int(value) <= most


def check_whole(error: type[InerterError], what: str, value: object, least: int = 0) -> int:
    """The integer `value`; raises `error` unless it is one of at least `least`."""
    if not is_whole(value, least):
        expected = {0: "a non-negative integer", 1: "a positive integer"}.get(least, f"an integer of at least {least}")
        raise error(f"{what} must be {expected}, got {value!r}.")
    return int(value)
