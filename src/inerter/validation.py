"""Validation of numbers, used by all layers where input enters."""

from __future__ import annotations

import math
from numbers import Real
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


def check_positive(error: type[InerterError], what: str, value: object, unit: str) -> None:
    """Raise `error` unless `value` is a positive, finite number of `unit`."""
    if not is_number(value) or value <= 0.0:
        raise error(f"{what} must be a positive number of {unit}, got {value!r}.")
