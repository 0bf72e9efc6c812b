"""The shape of a rig file: what it shares with simulation files, and [rig]."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, PlainValidator

from inerter.files.common.entries import (
    Amount,
    fixed_amount,
    not_negative,
    positive,
    positive_number,
    quantity,
    text,
    whole,
    yes_or_no,
)
from inerter.files.common.shape import Axles, ElementName, Layouts, Shape
from inerter.files.common.signals import SIGNAL_SHAPES, SignalEntry
from inerter.files.common.told_kind import ToldKind


class RigSettings(Shape):
    """How long is measured, and the sensors; what is left out is that of `VirtualRig`."""

    layout: Annotated[str | None, PlainValidator(text)] = None
    duration: Annotated[float, positive("s")] = Field(examples=['duration = "5 s"'])
    start: Annotated[float, not_negative("s")] = 0.0
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    sampling: Annotated[float | None, positive("Hz")] = None
    table_bandwidth: Annotated[float | None, positive("Hz")] = None
    encoder_resolution: Annotated[float | None, not_negative("m")] = None
    encoder_noise: Annotated[float | None, not_negative("m")] = None
    force_range: Annotated[float | None, positive("N")] = None
    force_resolution: Annotated[float | None, not_negative("N")] = None
    force_noise: Annotated[float | None, not_negative("N")] = None
    force_bandwidth: Annotated[float | None, positive("Hz")] = None
    force_offset: Annotated[float | None, quantity("N")] = None
    force_gain: Annotated[float | None, PlainValidator(positive_number)] = None
    force_delay: Annotated[float | None, not_negative("s")] = None
    reversed: Annotated[bool, PlainValidator(yes_or_no)] = False


class RigFile(Shape):
    """The whole file."""

    title: Annotated[str | None, PlainValidator(text)] = None
    elements: dict[ElementName, Annotated[Amount | ToldKind, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as b = "113 kg"']
    )
    layouts: Layouts = Field(examples=['a section [layouts] with a line such as screw = "(ks | cs) - (b | f)"'])
    signal: SignalEntry = Field(examples=['a section [signal] with kind = "cosine"'])
    rig: RigSettings = Field(examples=['a section [rig] with duration = "5 s"'])


SHAPES: dict[tuple[str, ...], type[Shape]] = {
    ("layouts", "*", "<axles>"): Axles,
    **SIGNAL_SHAPES,
    (): RigFile,
    ("rig",): RigSettings,
}
