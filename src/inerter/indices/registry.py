"""Registry of the indices by their symbols in files, and their settings by key."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from inerter.errors import PerformanceIndexError, RegistryError
from inerter.field_metadata import Field, TextChoice, TypedField, choices_of, fields_of, typed_fields_of
from inerter.indices.definition import Index
from inerter.indices.dynamic_load_coefficient import DynamicLoadCoefficient
from inerter.indices.load_carrying import LoadCarrying
from inerter.indices.of_element import ElementForce, ElementStroke, ElementVelocity
from inerter.indices.peak_response import PeakResponse
from inerter.indices.random_response import RandomResponse
from inerter.indices.ride_comfort import RideComfort
from inerter.indices.suspension_travel import SuspensionTravel
from inerter.indices.tyre_load import TyreLoad
from inerter.registry import Registry, cache_until_registration
from inerter.signals.road import Road

INDICES: Registry[type[Index]] = Registry(
    "index",
    "symbol",
    ("title", "unit", "response", "definition"),
    (
        RideComfort,
        TyreLoad,
        LoadCarrying,
        SuspensionTravel,
        DynamicLoadCoefficient,
        ElementForce,
        ElementStroke,
        ElementVelocity,
        RandomResponse,
        PeakResponse,
    ),
    {"question": "definition"},
)
_AMPLITUDE = "amplitude"  # the setting that says how large a sinusoidal input is
_ROAD, _EXCITATION = "road", "excitation"
_EXCITED = TypedField(
    _ROAD,
    _EXCITATION,
    "Excitation of the vehicle; the road of the study if left out.",
    '{ force = "sprung_force", intensity = "1 N^2/Hz" }',
    _EXCITATION,
)


@cache_until_registration
def index_settings() -> dict[str, Field]:
    """Settings of all indices by key; indices with the same key share the setting.

    Raises `RegistryError` if two of them have it in unlike units.
    """
    found: dict[str, Field] = {}
    for index in INDICES.values():
        for field in fields_of(index):
            if found.setdefault(field.key, field).unit != field.unit:
                raise RegistryError(
                    f"{index.symbol} has a setting {field.key!r} in {field.unit}, and another index has it in "
                    f"{found[field.key].unit}. Choose another key."
                )
    return found


def index_choices(symbol: str) -> tuple[TextChoice, ...]:
    """The texts that an index has for settings; one that is `needed` must be given."""
    return choices_of(INDICES[symbol])


def index_forms(symbol: str) -> tuple[TypedField, ...]:
    """Settings of an index that have value types other than quantities and texts; a `needed` one is required.

    An index on a road has its excitation among them, which is the road if nothing else is given.
    """
    kind: Any = INDICES[symbol]
    stated = typed_fields_of(kind)
    if _ROAD in {field.name for field in dataclasses.fields(kind)}:
        stated += (_EXCITED,)
    return tuple(dataclasses.replace(one, needed=one.needed and one.form != _EXCITATION) for one in stated)


def needed_settings(symbol: str) -> tuple[TextChoice | TypedField, ...]:
    """The settings of an index that must be given."""
    stated: list[TextChoice | TypedField] = [*index_choices(symbol), *index_forms(symbol)]
    return tuple(one for one in stated if one.needed)


def amplitude_of(symbol: str) -> Field | TypedField | None:
    """Setting of an index that is the amplitude of its sinusoidal input; None if the index has none."""
    stated: list[Field | TypedField] = [*fields_of(INDICES[symbol]), *index_forms(symbol)]
    return next((one for one in stated if one.name == _AMPLITUDE), None)


def excitation_of(symbol: str) -> TypedField | None:
    """Setting of an index that is its excitation, by default the road; None if the index has none."""
    return next((one for one in index_forms(symbol) if one.form == _EXCITATION), None)


def make_index(symbol: str, road: Road | None, settings: Mapping[str, Any]) -> Index:
    """The index of that symbol with those of the settings that are its own, on `road` if nothing else excites it.

    Raises `PerformanceIndexError` if one is missing that it cannot do without.
    """
    kind: Any = INDICES[symbol]
    for one in needed_settings(symbol):
        if one.key not in settings:
            raise PerformanceIndexError(f"{symbol} needs its {one.key}, such as {as_line(one)}: {one.sentence}")
    stated: list[Any] = [*fields_of(kind), *index_choices(symbol), *index_forms(symbol)]
    given = {one.name: settings[one.key] for one in stated if one.key in settings}
    if (excitation := excitation_of(symbol)) is not None:
        given = {excitation.name: road, **given}
    index: Index = kind(**given)
    return index


def as_line(setting: Field | TextChoice | TypedField) -> str:
    """A setting with its example, as a line of a file."""
    value = setting.example if isinstance(setting, TypedField) else f'"{setting.example}"'
    return f"{setting.key} = {value}"
