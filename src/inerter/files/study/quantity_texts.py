"""Quantities as written in the study file, for output in the same units and digits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from typing import Any

from inerter.errors import UnitError
from inerter.files.common.entries import QuantityText
from inerter.files.common.roads import remark
from inerter.files.common.toml import as_toml
from inerter.files.study.study import Study
from inerter.units import is_unit_for, parse_quantity, unit_in


def texts_of(tables: Mapping[str, Any]) -> tuple[str, ...]:
    """Texts of a file that may be quantities: single entries, not those in a list."""
    return tuple(dict.fromkeys(_texts(tables)))


def _texts(tables: Mapping[str, Any]) -> Iterator[str]:
    for entry in tables.values():
        if isinstance(entry, Mapping):
            yield from _texts(entry)
        elif isinstance(entry, list):
            for one in entry:
                yield from _texts(one) if isinstance(one, Mapping) else ()
        elif isinstance(entry, str) and any(map(str.isdigit, entry)):
            yield " ".join(entry.split())


def as_written(study: Study, value: float, unit: str) -> str | None:
    """Text of a quantity in the study file whose value is identical; None if the file has none."""
    return _values(study.texts, unit).get(value)


@lru_cache(maxsize=64)
def _values(texts: tuple[str, ...], unit: str) -> dict[float, str]:
    found: dict[float, str] = {}
    for text in texts:
        with suppress(UnitError):
            if is_unit_for(unit_in(text), unit):
                found.setdefault(parse_quantity(text, unit), text)
    return found


def write_resolved(study: Study) -> str:
    """`study.to_tables()` as TOML, with its quantities as the file wrote them.

    `load_study` reads an equal study from it, to the last bit of every value.
    """
    return remark(study.line) + as_toml(_rewritten(study, study.to_tables()))


def _rewritten(study: Study, entry: Any) -> Any:
    match entry:
        case dict():
            return {key: _rewritten(study, one) for key, one in entry.items()}
        case list():
            return [_rewritten(study, one) if isinstance(one, dict) else one for one in entry]
        case QuantityText():
            return as_written(study, entry.number, entry.unit) or entry
        case _:
            return entry
