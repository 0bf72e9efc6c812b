"""A filter in a study file: the coefficients of its transfer function."""

from __future__ import annotations

from typing import Any

from inerter.files.common.codec import Scalar, TableCodec, section
from inerter.files.common.problem import EntryError
from inerter.formatting import format_number
from inerter.systems.filters import Filter
from inerter.units import quote_value
from inerter.validation import is_number


def _coefficients(value: Any) -> tuple[float, ...]:
    if not isinstance(value, list) or not value or not all(map(is_number, value)):
        raise EntryError(
            got=quote_value(value) if not isinstance(value, list) or value else "an empty list",
            expected="a list of numbers without quotes, the highest power of s first, such as [1.0, 0.5]",
        )
    return tuple(map(float, value))


_COEFFICIENTS = Scalar(
    _coefficients,
    lambda: {"type": "array", "items": {"type": "number"}, "minItems": 1},
    lambda values: list(map(float, values)),
)
FILTER = TableCodec(
    (
        section("numerator", _COEFFICIENTS, "Coefficients of s, the highest power first.", "numerator = [1.0, 0.0]"),
        section(
            "denominator",
            _COEFFICIENTS,
            "Coefficients of s, the highest power first; all poles are stable.",
            "denominator = [1.0, 0.5]",
        ),
    ),
    make=Filter,  # which says what is wrong with it
    about="A transfer function in s, s in rad/s.",
)


def in_s(value: Filter) -> str:
    """Transfer function of a filter as text.

    >>> in_s(Filter([-1.0, 2.0], [1.0, 0.5, 2.5])), in_s(Filter([3.0], [1.0, 3.0]))
    ('(-s + 2) / (s^2 + 0.5 s + 2.5)', '3 / (s + 3)')
    """
    top, bottom = (_polynomial([float(c) for c in part]) for part in (value.numerator, value.denominator))
    return f"{_parenthesise(top)} / {_parenthesise(bottom)}"


def _polynomial(coefficients: list[float]) -> str:
    """A sum of powers of s, the highest first."""
    text = ""
    for power, c in zip(reversed(range(len(coefficients))), coefficients, strict=True):
        s = ("", "s")[power] if power < 2 else f"s^{power}"
        size = "" if s and abs(c) == 1.0 else format_number(abs(c))
        sign = "-" if c < 0.0 else "+"
        text += f" {sign} {' '.join(filter(None, (size, s)))}" if c else ""
    return text.removeprefix(" + ") if text.startswith(" + ") else f"-{text.removeprefix(' - ')}"


def _parenthesise(text: str) -> str:
    return f"({text})" if " " in text else text
