"""The shape of a rig file: what it shares with simulation files, and [rig]."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, PlainValidator, create_model

from inerter.files.common.entries import (
    Amount,
    any_quantity,
    fixed_amount,
    not_negative,
    positive,
    positive_number,
    text,
    whole,
    yes_or_no,
)
from inerter.files.common.kind_entry import KindEntry
from inerter.files.common.shape import ElementName, layouts
from inerter.files.common.signals import signal_shapes
from inerter.files.common.tables import Shape, Shapes
from inerter.rows import made_of_rows


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
    force_offset: Annotated[float | None, any_quantity("N")] = None
    force_gain: Annotated[float | None, PlainValidator(positive_number)] = None
    force_delay: Annotated[float | None, not_negative("s")] = None
    reversed: Annotated[bool, PlainValidator(yes_or_no)] = False


class RigFile(Shape):
    """The whole file, but for what rows make of its layouts and signal."""

    title: Annotated[str | None, PlainValidator(text)] = None
    elements: dict[ElementName, Annotated[Amount | KindEntry, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as b = "113 kg"']
    )
    layouts: Any
    signal: Any
    rig: RigSettings = Field(examples=['a section [rig] with duration = "5 s"'])


@made_of_rows
def shapes() -> tuple[type[RigFile], Shapes]:
    """The shape of a rig file, and all shapes in it by their place."""
    layout, tables = layouts()
    signal, signals = signal_shapes()
    file = create_model(
        "RigFile",
        __base__=RigFile,
        layouts=(layout, Field(examples=['a section [layouts] with a line such as screw = "(ks | cs) - (b | f)"'])),
        signal=(signal, Field(examples=['a section [signal] with kind = "cosine"'])),
    )
    return file, {**tables, **signals, (): file, ("rig",): RigSettings}
