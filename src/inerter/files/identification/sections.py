"""The keys of a configuration for `inerter identify`: how records are read, what is fitted, and how."""

from __future__ import annotations

from dataclasses import field
from typing import Any

from inerter.files.common.codec import (
    Scalar,
    TableCodec,
    key,
    keyed_dataclass,
    keys_in,
    section,
    table_of,
    without_none,
)
from inerter.files.common.elements import elements_codec
from inerter.files.common.entries import (
    EXPRESSION,
    TEXT_SCHEMA,
    YES_OR_NO,
    any_quantity,
    not_negative,
    positive,
    whole,
    word,
)
from inerter.files.common.problem import EntryError, invalid_entry
from inerter.files.common.schema import quantity_schema, words_schema
from inerter.files.common.suggest import nearest
from inerter.files.common.titles import title_section
from inerter.identification.models import MODELS
from inerter.records.record import CHANNELS
from inerter.records.uncertain import Uncertain, parse_uncertain
from inerter.registry import cache_until_registration
from inerter.units import parse_quantity, quote_value

NO_UNITS: dict[str, str] = {}
NO_ELEMENTS: dict[str, Any] = {}
ROLES = ("displacement", "force", "time", "velocity", "acceleration")
CHOOSE = "choose"  # between all models
CHOOSE_WORDS = "fits all models, and selects the simplest of those that predict best; takes a minute or two"
GAPS = ("refuse", "fill", "longest")
_MOST_STARTS = 4096


def channel(value: Any) -> str | int:
    """A channel by its name or its number."""
    if isinstance(value, bool) or not isinstance(value, str | int) or value == "":
        raise invalid_entry(value, expected='the name of a channel, such as "Load", or its number from 0')
    return value


def channel_units(value: Any) -> dict[str, str]:
    """Units by what a channel is, not by its name."""
    if not isinstance(value, dict):
        raise invalid_entry(value, expected='a table such as { force = "kgf" }')
    for role, unit in value.items():
        if role not in CHANNELS:
            known = ", ".join(CHANNELS)
            hint = nearest(role, CHANNELS)
            raise EntryError(got=f"a unit of {quote_value(role)}", expected=f"one of {known}", hint=hint)
        if not isinstance(unit, str):
            raise EntryError(got=f"{quote_value(unit)} as the unit of the {role}", expected='text such as "kgf"')
    return value


def gap_treatment(value: Any) -> str | float:
    """Treatment of missing samples."""
    if isinstance(value, str) and value in GAPS:
        return value
    try:
        seconds = parse_quantity(value, "s")
    except ValueError:
        seconds = -1.0
    if seconds <= 0.0:
        known = ", ".join(map(quote_value, GAPS))
        raise invalid_entry(value, expected=f'one of {known}, or the longest to fill, such as "50 ms"')
    return seconds


def longest_delay(value: Any) -> bool | float:
    """Whether a delay of the force is fitted, or its largest value."""
    return value if isinstance(value, bool) else parse_quantity(value, "s")


def check_part(value: Any) -> float:
    """Share of each record that is held out for validation."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 0.6:
        raise invalid_entry(value, expected="a number from 0 to 0.6 without quotes, such as 0.2")
    return float(value)


_CHANNEL = Scalar(channel, lambda: {"anyOf": [{"type": "string", "minLength": 1}, {"type": "integer", "minimum": 0}]})
_UNITS = Scalar(channel_units, lambda: {"type": "object", "additionalProperties": {"type": "string"}})
_GAPS = Scalar(gap_treatment, lambda: {"anyOf": [words_schema(GAPS), quantity_schema("s")]})
_DELAY = Scalar(longest_delay, lambda: {"anyOf": [{"type": "boolean"}, quantity_schema("s")]})
_CHECK = Scalar(check_part, lambda: {"type": "number", "minimum": 0, "maximum": 0.6})
_MASS = Scalar(lambda value: parse_uncertain(value, "kg"), lambda: TEXT_SCHEMA)
_SCALE = Scalar(parse_uncertain, lambda: {"anyOf": [{"type": "number"}, TEXT_SCHEMA]})
_ANY_TIME = any_quantity("s")


@keyed_dataclass
class RecordRequest:
    """Arguments of `read_record` for the files, and the preparation of their records."""

    channels: dict[str, str | int] = field(default_factory=dict)  # by role
    units: dict[str, str] = key(
        _UNITS, "Units of the channels, by their quantity.", 'units = { force = "kgf" }', default=NO_UNITS
    )
    interval: float | None = key(positive("s"), "Sampling interval, where the file has no times.", default=None)
    gaps: str | float = key(_GAPS, "Treatment of missing samples.", 'gaps = "fill"', default="refuse")
    force_range: float | None = key(positive("N"), "The largest force of the load cell.", default=None)
    force_bandwidth: float | None = key(positive("Hz"), "Bandwidth of the load cell.", default=None)
    force_noise: float | None = key(positive("N"), "Noise of the load cell, r.m.s.", default=None)
    displacement_noise: float | None = key(positive("m"), "Noise of the displacement, r.m.s.", default=None)
    fixture_mass: Uncertain | None = key(_MASS, "Mass between load cell and device.", default=None)
    period: float | None = key(positive("s"), "Period of a periodic motion.", default=None)
    start: float | None = key(_ANY_TIME, "Start of the part that is used.", default=None)
    stop: float | None = key(_ANY_TIME, "End of the part that is used.", default=None)
    resample: float | None = key(positive("s"), "New sampling interval: the record is resampled.", default=None)
    repair: bool = key(
        YES_OR_NO, "Whether spikes and held values are interpolated, and slower channels thinned.", default=False
    )
    detrend: bool = key(YES_OR_NO, "Whether a linear trend is removed.", default=False)


AS_RECORDED = RecordRequest()


@keyed_dataclass
class ModelRequest:
    """The device: one of the catalogue, or a network of the section [elements]."""

    name: str | None = key(word("a model", (*MODELS, CHOOSE)), "A model of the catalogue.", default=None)
    layout: str | None = key(EXPRESSION, "Network of the elements.", default=None)


@keyed_dataclass
class FitSettings:
    """Settings of the fit, as `identify` takes them."""

    seed: int = key(whole(0, 2**63 - 1), "Seed of the starting points.", "seed = 0", default=0)
    starts: int | None = key(whole(8, _MOST_STARTS), "Number of starting points.", default=None)
    offset: bool = key(YES_OR_NO, "Whether the force may have an offset.", default=True)
    gain: bool = key(YES_OR_NO, "Whether the force may have a gain.", default=False)
    delay: bool | float | None = key(
        _DELAY, "Whether a delay of the force is fitted, or its largest value.", default=None
    )
    check: float = key(_CHECK, "Share of each record that is held out for validation.", default=0.2)
    bandwidth: float | None = key(positive("Hz"), "Highest frequency that is fitted.", default=None)
    lead: float | None = key(not_negative("s"), "Initial part of each record that is not fitted.", default=None)
    force_scale: Uncertain | None = key(_SCALE, "Factor of the force readings.", default=None)
    displacement_scale: Uncertain | None = key(_SCALE, "Factor of the displacement readings.", default=None)
    quadratic_damping: bool = key(
        YES_OR_NO, "Whether a damping that grows with the square of the speed is fitted too.", default=False
    )


def _record(**values: Any) -> RecordRequest:
    roles = without_none(**{role: values.pop(role) for role in ROLES})
    return RecordRequest(channels=roles, **values)


_CHANNELS = tuple(section(role, _CHANNEL, f"The channel of the {role}.", default=None) for role in ROLES)


@cache_until_registration
def identification_codec() -> TableCodec:
    """The whole file, as a dictionary by its sections."""
    return TableCodec(
        (
            title_section("the report", "record"),
            section(
                "record",
                TableCodec((*_CHANNELS, *keys_in(RecordRequest)), _record),
                "Channels, units and preparation of the records.",
                'a section [record] with force = "Load"',
                default=AS_RECORDED,
            ),
            section(
                "model",
                table_of(ModelRequest),
                "The device: one of the catalogue, or a network of the elements.",
                'a section [model] with name = "ball-screw"',
                default=ModelRequest(),
            ),
            section(
                "elements",
                elements_codec(free=True, least=0),
                "Elements of the device, by names that you choose. The unit determines the kind.",
                'a section [elements] with lines such as b = "113 kg"',
                default=NO_ELEMENTS,
            ),
            section(
                "fit",
                table_of(FitSettings, make=without_none),
                "Settings of the fit.",
                "a section [fit] with seed = 0",
                default=without_none(**vars(FitSettings())),
            ),
        )
    )
