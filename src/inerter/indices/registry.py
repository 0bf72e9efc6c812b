"""The indices that files know by their symbols, and the keys of files that are settings of theirs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from inerter.errors import PerformanceIndexError, RowError
from inerter.fields import Field, TextChoice, choices_of, fields_of
from inerter.indices.dynamic_load_coefficient import DynamicLoadCoefficient
from inerter.indices.element_force import ElementForce
from inerter.indices.element_stroke import ElementStroke
from inerter.indices.element_velocity import ElementVelocity
from inerter.indices.load_carrying import LoadCarrying
from inerter.indices.question import Index
from inerter.indices.ride_comfort import RideComfort
from inerter.indices.suspension_travel import SuspensionTravel
from inerter.indices.tyre_load import TyreLoad
from inerter.rows import Rows, made_of_rows
from inerter.signals.road import Road

INDICES: Rows[type[Index]] = Rows(
    "index",
    "symbol",
    ("title", "unit", "response", "question"),
    (
        RideComfort,
        TyreLoad,
        LoadCarrying,
        SuspensionTravel,
        DynamicLoadCoefficient,
        ElementForce,
        ElementStroke,
        ElementVelocity,
    ),
)
_AMPLITUDE = "amplitude"  # the setting that says how large a sinusoidal force is


@made_of_rows
def index_settings() -> dict[str, Field]:
    """The settings of all indices, by their keys; indices that have the same key share it.

    Raises `RowError` if two of them have it in unlike units.
    """
    found: dict[str, Field] = {}
    for index in INDICES.values():
        for field in fields_of(index):
            if found.setdefault(field.key, field).unit != field.unit:
                raise RowError(
                    f"{index.symbol} has a setting {field.key!r} in {field.unit}, and another index has it in "
                    f"{found[field.key].unit}. Choose another key."
                )
    return found


def index_choices(symbol: str) -> tuple[TextChoice, ...]:
    """The texts that an index has for settings; one that is `needed` must be given."""
    return choices_of(INDICES[symbol])


def amplitude_of(symbol: str) -> Field | None:
    """The setting of an index that is the amplitude of its sinusoidal force; None if it has none."""
    return next((field for field in fields_of(INDICES[symbol]) if field.name == _AMPLITUDE), None)


def is_on_road(symbol: str) -> bool:
    """Whether the index is asked on a road."""
    kind: Any = INDICES[symbol]
    return "road" in {field.name for field in dataclasses.fields(kind)}


def make_index(symbol: str, road: Road | None, settings: Mapping[str, Any]) -> Index:
    """The index of that symbol, on `road` if it is asked on one, with those of the settings that are its own.

    Raises `PerformanceIndexError` if one is missing that it cannot do without.
    """
    kind: Any = INDICES[symbol]
    for text in index_choices(symbol):
        if text.needed and text.key not in settings:
            raise PerformanceIndexError(
                f'{symbol} needs its {text.key}, such as {text.key} = "{text.example}": {text.sentence}'
            )
    own = {field.name: field.key for field in fields_of(kind)} | {text.name: text.key for text in choices_of(kind)}
    given = {name: settings[key] for name, key in own.items() if key in settings}
    index: Index = kind(**({"road": road} if is_on_road(symbol) else {}), **given)
    return index
