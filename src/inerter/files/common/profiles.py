"""Keys of a file for the table of a measured profile: columns, units and spacing that its header does not state."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from inerter.errors import RecordError
from inerter.files.common.problem import EntryError, invalid_entry
from inerter.files.common.suggest import nearest
from inerter.formatting import format_quantity
from inerter.records.remedy import Action, Remedy
from inerter.roads.profile import Profile
from inerter.roads.reading import Columns, read_profile
from inerter.units import PURE, is_unit_for, quote_value

_UNITS = ("distance", "height")
COLUMNS_EXAMPLE = 'columns = { distance = "Station", height = 2 }'
UNITS_EXAMPLE = 'units = { distance = "m", height = "mm" }'
SPACING_EXAMPLE = 'interval = "0.1 m"'
COLUMNS_SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {
        role: {"anyOf": [{"type": "string", "minLength": 1}, {"type": "integer", "minimum": 0}]}
        for role in Columns.__annotations__
    },
    "additionalProperties": False,
}
UNITS_SCHEMA: dict[str, Any] = {
    "type": "object",
    "properties": {kind: {"type": "string", "minLength": 1} for kind in _UNITS},
    "additionalProperties": False,
}


def columns(value: Any) -> dict[str, str | int]:
    """Column of each quantity, by name or by number from 0."""
    known = tuple(Columns.__annotations__)
    for role, name in _table(value, known, COLUMNS_EXAMPLE).items():
        is_name = isinstance(name, str) and name != ""
        if not is_name and (isinstance(name, bool) or not isinstance(name, int) or name < 0):
            raise EntryError(got=f"{role} = {quote_value(name)}", expected="the name of a column, or its number from 0")
    return dict(value)


def units(value: Any) -> dict[str, str]:
    """Units of distances and of heights."""
    for kind, unit in _table(value, _UNITS, UNITS_EXAMPLE).items():
        if not isinstance(unit, str) or not unit.strip() or unit == PURE or not _is_length(unit):
            raise EntryError(got=f"{kind} = {quote_value(unit)}", expected=f"a unit of length, as in {UNITS_EXAMPLE}")
    return dict(value)


def read(
    path: Path | str,
    columns: dict[str, str | int] | None = None,
    units: dict[str, str] | None = None,
    interval: float | None = None,
) -> Profile:
    """The profile in a file, read as these keys say.

    Raises `RecordError`, whose remedies are keys of a file.
    """
    named: Any = columns or {}
    try:
        return read_profile(path, units=units, interval=interval, **named)
    except RecordError as error:
        raise RecordError(as_keys(error.args)) from None


def as_keys(text: Iterable[object]) -> str:
    """The parts of a sentence, such as the `args` of a `RecordError`, with keys of a file instead of Python's calls.

    >>> as_keys(("Name it: ", Remedy(Action.COLUMN, (("distance", "Station"),)), "."))
    'Name it: columns = { distance = "Station" }.'
    """
    return "".join(_key(part) if isinstance(part, Remedy) else str(part) for part in text)


def _key(remedy: Remedy) -> str:
    if remedy.action == Action.INTERVAL:
        return f'interval = "{format_quantity(remedy.value or 0.1, "m")}"'
    pairs = ", ".join(
        f"{role} = {quote_value(value) if isinstance(value, str) else value}" for role, value in remedy.value
    )
    return f"{'units' if remedy.action == Action.UNITS else 'columns'} = {{ {pairs} }}"


def _table(value: Any, known: tuple[str, ...], example: str) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise invalid_entry(value, expected=f"a table such as {example}")
    for role in value:
        if role not in known:
            raise invalid_entry(role, expected=f"one of {', '.join(known)}", hint=nearest(role, known))
    return value


def _is_length(unit: str) -> bool:
    try:
        return is_unit_for(unit, "m")
    except ValueError:
        return False
