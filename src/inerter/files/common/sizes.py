"""Sizes of quantities that files may state."""

from __future__ import annotations

from typing import Any

from inerter.files.common.problem import invalid_entry
from inerter.formatting import format_range

_LARGEST = 1e50  # of a quantity in SI units, and the inverse of the smallest


def check_size(value: float, text: Any, unit: str) -> float:
    """`value`; raises `EntryError` for a size whose squares and products leave the range of numbers."""
    if value and not 1.0 / _LARGEST <= abs(value) <= _LARGEST:
        expected = f"a size from {format_range(1.0 / _LARGEST, _LARGEST, unit)}"
        raise invalid_entry(text, fault="a size that nothing has", expected=expected, hint="Check the unit.")
    return value
