"""The shape of a simulation file: what it shares with study files, [signal] and [simulation]."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, PlainValidator, Tag

from inerter.files.common.entries import Amount, fixed_amount, one_of, positive, text, whole, yes_or_no
from inerter.files.common.shape import (
    MODELS,
    RIG,
    Axles,
    ElementName,
    HalfCarShape,
    Layouts,
    QuarterCarShape,
    Shape,
    model_tag,
)
from inerter.files.common.signals import SIGNAL_SHAPES, SignalEntry
from inerter.files.common.told_kind import ToldKind

INTEGRATORS = ("event-driven", "time-stepping")
INITIAL = ("rest", "preload", "periodic")


class RigShape(Shape):
    """A rig is all device."""

    model: Literal["rig"]


class AnyVehicle(Shape):
    """A vehicle whose model is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    model: Annotated[str, PlainValidator(one_of("a vehicle model", (*MODELS, RIG)))] = Field(
        examples=['model = "quarter-car"']
    )


def _moved_tag(vehicle: Any) -> str:
    return f"<{RIG}>" if isinstance(vehicle, dict) and vehicle.get("model") == RIG else model_tag(vehicle)


MovedEntry = Annotated[
    Annotated[QuarterCarShape, Tag("<quarter-car>")]
    | Annotated[HalfCarShape, Tag("<half-car>")]
    | Annotated[RigShape, Tag("<rig>")]
    | Annotated[AnyVehicle, Tag("<any>")],
    Discriminator(_moved_tag),
]


class PassedRoad(Shape):
    """The keys of `Road`; only a multisine cannot do without a roughness."""

    speed: Annotated[float, positive("m/s")] = Field(examples=['speed = "25 m/s"'])
    roughness: Annotated[float | None, positive("m^3/cycle")] = None


class SimulationSettings(Shape):
    """How the motion is computed, and what is kept of it."""

    layout: Annotated[str | None, PlainValidator(text)] = None
    duration: Annotated[float | None, positive("s")] = None
    step: Annotated[float, positive("s")] = 2e-4
    integrator: Annotated[str, PlainValidator(one_of("an integrator", INTEGRATORS))] = "event-driven"
    initial: Annotated[str, PlainValidator(one_of("an initial state", INITIAL))] = "rest"
    energy: Annotated[bool, PlainValidator(yes_or_no)] = False
    every: Annotated[int, whole(1, 10**9)] = 1


class SimulationFile(Shape):
    """The whole file."""

    title: Annotated[str | None, PlainValidator(text)] = None
    vehicle: MovedEntry = Field(examples=['a section [vehicle] with model = "quarter-car", "half-car" or "rig"'])
    road: PassedRoad | None = Field(
        default=None, examples=['a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"']
    )
    elements: dict[ElementName, Annotated[Amount | ToldKind, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Layouts
    signal: SignalEntry = Field(examples=['a section [signal] with kind = "multisine"'])
    simulation: SimulationSettings = Field(examples=['a section [simulation] with duration = "10 s"'])


SHAPES: dict[tuple[str, ...], type[Shape]] = {
    ("vehicle", "<quarter-car>"): QuarterCarShape,
    ("vehicle", "<half-car>"): HalfCarShape,
    (): SimulationFile,
    ("vehicle", "<any>"): AnyVehicle,
    ("vehicle", "<rig>"): RigShape,
    ("road",): PassedRoad,
    ("layouts", "*", "<axles>"): Axles,
    **SIGNAL_SHAPES,
    ("simulation",): SimulationSettings,
}
