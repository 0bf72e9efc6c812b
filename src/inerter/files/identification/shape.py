"""The shape of a configuration for `inerter identify`: how records are read, what is fitted, and how."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, PlainValidator

from inerter.files.common.entries import expression, not_negative, one_of, positive, text, whole, yes_or_no
from inerter.files.common.problem import EntryError
from inerter.files.common.shape import ElementEntry, ElementName, Range
from inerter.files.common.suggest import nearest
from inerter.files.common.tables import Shape
from inerter.identification.models import MODELS
from inerter.records.record import CHANNELS
from inerter.records.uncertain import Uncertain, parse_uncertain
from inerter.units import parse_quantity, shown

CHOOSE = "choose"  # between all models
GAPS = ("refuse", "fill", "longest")
_MOST_STARTS = 4096


def channel(value: Any) -> str | int:
    """A channel by its name or its number."""
    if isinstance(value, bool) or not isinstance(value, str | int) or value == "":
        raise EntryError(got=shown(value), expected='the name of a channel, such as "Load", or its number from 0')
    return value


def channel_units(value: Any) -> dict[str, str]:
    """Units by what a channel is, not by its name."""
    if not isinstance(value, dict):
        raise EntryError(got=shown(value), expected='a table such as { force = "kgf" }')
    for role, unit in value.items():
        if role not in CHANNELS:
            known = ", ".join(CHANNELS)
            hint = nearest(role, CHANNELS)
            raise EntryError(got=f"a unit of {shown(role)}", expected=f"one of {known}", hint=hint)
        if not isinstance(unit, str):
            raise EntryError(got=f"{shown(unit)} as the unit of the {role}", expected='text such as "kgf"')
    return value


def gap_treatment(value: Any) -> str | float:
    """What is done where samples are missing."""
    if isinstance(value, str) and value in GAPS:
        return value
    try:
        seconds = parse_quantity(value, "s")
    except ValueError:
        seconds = -1.0
    if seconds <= 0.0:
        known = ", ".join(map(shown, GAPS))
        raise EntryError(got=shown(value), expected=f'one of {known}, or the longest to fill, such as "50 ms"')
    return seconds


def longest_delay(value: Any) -> bool | float:
    """Whether the force may be late, or by how much at most."""
    return value if isinstance(value, bool) else parse_quantity(value, "s")


def check_part(value: Any) -> float:
    """The part of each record that is kept for the check."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 0.6:
        raise EntryError(got=shown(value), expected="a number from 0 to 0.6 without quotes, such as 0.2")
    return float(value)


Channel = Annotated[str | int | None, PlainValidator(channel)]


class RecordShape(Shape):
    """How the files are read, and what is done to the records."""

    displacement: Channel = None
    force: Channel = None
    time: Channel = None
    velocity: Channel = None
    acceleration: Channel = None
    units: Annotated[dict[str, str], PlainValidator(channel_units)] = Field(
        default_factory=dict, examples=['units = { force = "kgf" }']
    )
    interval: Annotated[float | None, positive("s")] = None
    gaps: Annotated[str | float, PlainValidator(gap_treatment)] = "refuse"
    force_range: Annotated[float | None, positive("N")] = None
    force_bandwidth: Annotated[float | None, positive("Hz")] = None
    force_noise: Annotated[float | None, positive("N")] = None
    displacement_noise: Annotated[float | None, positive("m")] = None
    fixture_mass: Annotated[Uncertain | None, PlainValidator(lambda value: parse_uncertain(value, "kg"))] = None
    period: Annotated[float | None, positive("s")] = None
    start: Annotated[float | None, PlainValidator(lambda value: parse_quantity(value, "s"))] = None
    stop: Annotated[float | None, PlainValidator(lambda value: parse_quantity(value, "s"))] = None
    resample: Annotated[float | None, positive("s")] = None
    repair: Annotated[bool, PlainValidator(yes_or_no)] = False
    detrend: Annotated[bool, PlainValidator(yes_or_no)] = False


class ModelShape(Shape):
    """The device: one of the catalogue, or a network of the section [elements]."""

    name: Annotated[str | None, PlainValidator(one_of("a model", (*MODELS, CHOOSE)))] = None
    layout: Annotated[str | None, PlainValidator(expression)] = None


class FitShape(Shape):
    """How it is fitted, as `identify` takes it."""

    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    starts: Annotated[int | None, whole(8, _MOST_STARTS)] = None
    offset: Annotated[bool, PlainValidator(yes_or_no)] = True
    gain: Annotated[bool, PlainValidator(yes_or_no)] = False
    delay: Annotated[bool | float | None, PlainValidator(longest_delay)] = None
    check: Annotated[float, PlainValidator(check_part)] = 0.2
    bandwidth: Annotated[float | None, positive("Hz")] = None
    lead: Annotated[float | None, not_negative("s")] = None
    force_scale: Annotated[Uncertain | None, PlainValidator(parse_uncertain)] = None
    displacement_scale: Annotated[Uncertain | None, PlainValidator(parse_uncertain)] = None


class IdentificationFile(Shape):
    """The whole file."""

    title: Annotated[str | None, PlainValidator(text)] = None
    record: RecordShape = Field(default_factory=RecordShape, examples=['a section [record] with force = "Load"'])
    model: ModelShape = Field(default_factory=ModelShape, examples=['a section [model] with name = "ball-screw"'])
    elements: dict[ElementName, ElementEntry] = Field(
        default_factory=dict, examples=['a section [elements] with lines such as b = "113 kg"']
    )
    fit: FitShape = Field(default_factory=FitShape, examples=["a section [fit] with seed = 0"])


SHAPES: dict[tuple[str, ...], type[Shape]] = {
    (): IdentificationFile,
    ("record",): RecordShape,
    ("model",): ModelShape,
    ("elements", "*", "<range>"): Range,
    ("fit",): FitShape,
}
