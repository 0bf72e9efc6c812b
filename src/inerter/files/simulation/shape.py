"""The shape of a simulation file: what it shares with study files, [signal] and [simulation]."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, PlainValidator, Tag, create_model

from inerter.files.common.entries import Amount, fixed_amount, one_of, positive, text, whole, yes_or_no
from inerter.files.common.signal_kinds import KINDS, NEEDED, UNITS, unit_of
from inerter.files.study.shape import (
    MODELS,
    RIG,
    SHAPES,
    Axles,
    ElementName,
    HalfCarShape,
    Layouts,
    QuarterCarShape,
    Shape,
    model_tag,
)

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


class AnySignal(Shape):
    """A signal whose kind is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    kind: Annotated[str, PlainValidator(one_of("a kind of signal", tuple(KINDS)))] = Field(
        examples=['kind = "multisine"']
    )


def _signal_shape(kind: str, unit: str) -> type[Shape]:
    keys = {name: key.of(unit) for name, key in KINDS[kind].keys.items()}
    fields: dict[str, Any] = {
        name: (Annotated[Any, key.check(key.unit)], Field(default=key.default, examples=[key.example]))
        for name, key in keys.items()
    }
    fields["kind"] = (Literal[kind], NEEDED)
    fields["input"] = (Annotated[str | None, PlainValidator(text)], None)
    return create_model(f"{kind} in {unit}", __base__=Shape, **fields)


def _signal_tag(signal: Any) -> str:
    kind = signal.get("kind") if isinstance(signal, dict) else None
    return f"<{kind} in {unit_of(signal.get('input'))}>" if isinstance(kind, str) and kind in KINDS else "<any>"


_SIGNALS = {f"<{kind} in {unit}>": _signal_shape(kind, unit) for kind in KINDS for unit in UNITS}
if TYPE_CHECKING:
    SignalEntry = Shape
else:
    SignalEntry = Annotated[
        reduce(or_, (Annotated[shape, Tag(tag)] for tag, shape in {"<any>": AnySignal, **_SIGNALS}.items())),
        Discriminator(_signal_tag),
    ]


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
    elements: dict[ElementName, Annotated[Amount, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Layouts
    signal: SignalEntry = Field(examples=['a section [signal] with kind = "multisine"'])
    simulation: SimulationSettings = Field(examples=['a section [simulation] with duration = "10 s"'])


SIMULATION_SHAPES: dict[tuple[str, ...], type[Shape]] = {
    **{place: SHAPES[place] for place in (("vehicle", "<quarter-car>"), ("vehicle", "<half-car>"))},
    (): SimulationFile,
    ("vehicle", "<any>"): AnyVehicle,
    ("vehicle", "<rig>"): RigShape,
    ("road",): PassedRoad,
    ("layouts", "*", "<axles>"): Axles,
    ("signal", "<any>"): AnySignal,
    **{("signal", tag): shape for tag, shape in _SIGNALS.items()},
    ("simulation",): SimulationSettings,
}
