"""JSON Schemas of files, for editors: made of the shape of a file, and of what each entry says that it may be."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, PlainValidator

DIALECT = "https://json-schema.org/draft/2020-12/schema"
UNIT = "x-unit"  # a keyword of our own, which validators pass over: the SI unit of a quantity
NEVER: dict[str, Any] = {"not": {}}  # an alternative that no entry has
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


@dataclass(frozen=True)
class Says:
    """What a JSON Schema says of an entry. It is made when it is asked for, since rows may be added until then."""

    schema: Callable[[], dict[str, Any]]

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return handler(source)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return self.schema()


@dataclass(frozen=True)
class OrDeeper:
    """A JSON Schema that takes the same entry in a table of tables too."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return handler(source)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        deeper = {"type": ["array", "object"]}
        return {"anyOf": [handler(core), {"type": "object", "additionalProperties": deeper, "minProperties": 1}]}


def checked(check: Callable[..., Any], schema: Callable[[], dict[str, Any]]) -> PlainValidator:
    """An entry that `check` turns into its value, or refuses, and the `schema` that tells editors what it may be."""
    return PlainValidator(check, json_schema_input_type=Annotated[Any, Says(schema)])


def or_range_schema(one: dict[str, Any]) -> dict[str, Any]:
    """A quantity of this schema, or a table with the two ends of a free value."""
    ends = {"type": "object", "properties": {"from": one, "to": one}, "required": ["from", "to"]}
    return {"anyOf": [one, {**ends, "additionalProperties": False}]}


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
    """One of some words."""
    return {"type": "string", "enum": list(words)}


def list_schema(items: dict[str, Any]) -> dict[str, Any]:
    """A list of at least one, none of them twice."""
    return {"type": "array", "items": items, "minItems": 1, "uniqueItems": True}


def json_schema(file: type[BaseModel], title: str, description: str) -> dict[str, Any]:
    """The JSON Schema (2020-12) of a kind of file, whose whole shape is `file`."""
    made = file.model_json_schema(by_alias=True)
    return {"$schema": DIALECT, "title": title, **_tidied(made), "description": description}


def example_value(example: str) -> Any:
    """The value in an example such as `points = 30`; None if the example is words."""
    try:
        (value,) = tomllib.loads(example).values()
    except (tomllib.TOMLDecodeError, ValueError):
        return None
    return value


def _tidied(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema without what pydantic says of Python: titles made of names, and None, which TOML does not have."""
    found = {key: _part(key, value) for key, value in schema.items() if key != "title"}
    if found.get("default", ...) is None:
        del found["default"]
    examples = [value for text in schema.get("examples", ()) if (value := example_value(text)) is not None]
    found.pop("examples", None)
    several = [one for key in ("anyOf", "oneOf") for one in found.pop(key, ())]
    alternatives = [one for one in several if one not in ({"type": "null"}, NEVER)]
    if len(alternatives) == 1:
        found = {**alternatives[0], **found}
    elif alternatives:
        found["anyOf"] = alternatives
    return {**found, "examples": examples} if examples else found


def _part(key: str, value: Any) -> Any:
    if key in ("properties", "$defs"):
        return {name: _tidied(one) for name, one in value.items()}
    if isinstance(value, dict) and key not in ("default", "const"):
        return _tidied(value)
    if isinstance(value, list) and key in ("anyOf", "oneOf", "allOf"):
        return [_tidied(one) for one in value]
    return value
