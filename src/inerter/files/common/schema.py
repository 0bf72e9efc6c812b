"""Parts of JSON Schemas of files, for editors."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any

DIALECT = "https://json-schema.org/draft/2020-12/schema"
UNIT = "x-unit"  # a keyword of our own, which validators pass over: the SI unit of a quantity
INSTEAD = "x-instead"  # another: lines of other keys, one of which a file must have if it lacks the key
USUAL = {  # units of each kind as they are often written; others are not refused
    "N/m": ("N/m", "kN/m", "MN/m", "N/mm", "kN/mm", "lbf/in"),
    "N s/m": ("N s/m", "kN s/m", "MN s/m", "N s/mm", "kN s/mm"),
    "kg": ("kg", "g", "t", "lb"),
    "N": ("N", "kN", "MN", "kgf", "lbf"),
    "m": ("m", "km", "cm", "mm", "um", "in", "ft"),
    "m/s": ("m/s", "km/h", "mm/s", "mph"),
    "m/s^2": ("m/s^2", "mm/s^2"),
    "m^3/cycle": ("m^3/cycle",),
    "cycle/m": ("cycle/m", "cycle/km"),
    "kg m^2": ("kg m^2",),
    "rad/s": ("rad/s", "Hz", "kHz"),
    "s": ("s", "ms", "min"),
    "rad": ("rad", "deg"),
}
_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![eE][+-]?\d)"
_NOT_ZERO = r"(?=[\d.]*[1-9])"


def quantity_schema(*units: str, least: str = "") -> dict[str, Any]:
    """A number with a unit of one of these kinds, of any if none is named.

    A pattern cannot know all units that can be written; it refuses a number without one, and the usual units of other
    kinds. `least` is "positive" or "not negative" where a sign, or zero, is refused.

    >>> import re
    >>> pattern = quantity_schema("N/m", least="positive")["pattern"]
    >>> [bool(re.search(pattern, text)) for text in ("120 kN/m", "3 klbf/ft", "120", "120 kN", "-1 N/m", "0 N/m")]
    [True, True, False, False, False, False]
    """
    sign = r"\+?" if least else "[+-]?"
    other = [unit for kind, usual in USUAL.items() if kind not in units for unit in usual]
    known = units and all(unit in USUAL for unit in units)
    refused = "|".join(unit.replace("^", r"\^") for unit in other) if known else ""
    kind = rf"(?!(?:{refused})\s*$)" if refused else ""
    zero = _NOT_ZERO if least == "positive" else ""
    one = {UNIT: units[0]} if len(units) == 1 else {}
    return {"type": "string", "pattern": rf"^\s*{sign}{zero}{_NUMBER}\s*{kind}[^\s\d,.][^,]*$", **one}


def words_schema(words: Iterable[str]) -> dict[str, Any]:
    """JSON Schema of a text that must be one of `words`."""
    return {"type": "string", "enum": list(words)}


def list_schema(items: dict[str, Any]) -> dict[str, Any]:
    """A list of at least one, none of them twice."""
    return {"type": "array", "items": items, "minItems": 1, "uniqueItems": True}


def example_value(example: str) -> Any:
    """The value in an example such as `points = 30`; None if the example is words."""
    try:
        (value,) = tomllib.loads(example).values()
    except (tomllib.TOMLDecodeError, ValueError):
        return None
    return value
