"""The shape of a study file: which keys there are, what each may hold, and an example of each."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, PlainValidator, Tag, model_validator

from inerter.study.entries import (
    MOST_POINTS,
    Amount,
    amount,
    check_order,
    element_name,
    expression,
    layout_name,
    one_of,
    one_sweep,
    positive,
    share,
    some_names,
    some_of,
    sweep_list,
    text,
    whole,
)
from inerter.study.told_kind import ToldKind, names_kind, told_kind
from inerter.units import shown

MODELS = ("quarter-car", "half-car")
RIG = "rig"
INDICES = ("J1", "J3", "J5")
METHODS = ("norm", "statistical-linearisation", "expected-value", "approximate-linear")
AVERAGING = ("expected-value", "approximate-linear")  # over random roads
FORCED = ("expected-value", "statistical-linearisation")  # take J5 at a force of one amplitude
_MOST_ROADS = 100_000
CONVENTIONS = ("exact", "paper2008")
SPACINGS = ("linear", "log")
UNITS = {
    "sprung_mass": "kg",
    "unsprung_mass": "kg",
    "tyre_stiffness": "N/m",
    "pitch_inertia": "kg m^2",
    "unsprung_mass_front": "kg",
    "unsprung_mass_rear": "kg",
    "tyre_stiffness_front": "N/m",
    "tyre_stiffness_rear": "N/m",
    "distance_front": "m",
    "distance_rear": "m",
    "speed": "m/s",
    "roughness": "m^3/cycle",
    "high_pass": "rad/s",
    "force": "N",
}


class Shape(BaseModel):
    """A table of a study file; keys that it does not know are errors."""

    model_config = ConfigDict(extra="forbid")


AmountText = Annotated[Amount, PlainValidator(amount)]


class Range(Shape):
    """A free value: an optimiser chooses it between two bounds."""

    lower: AmountText = Field(alias="from", examples=['from = "100 N s/m"'])
    upper: AmountText = Field(alias="to", examples=['to = "100 kN s/m"'])

    @model_validator(mode="after")
    def _ordered(self) -> Range:
        check_order(self.lower, self.upper)
        return self


class SweepRange(Shape):
    """Values of one element from one end to the other."""

    lower: AmountText = Field(alias="from", examples=['from = "10 kN/m"'])
    upper: AmountText = Field(alias="to", examples=['to = "300 kN/m"'])
    points: Annotated[int, whole(2, MOST_POINTS)] = Field(examples=["points = 30"])
    spacing: Annotated[str, PlainValidator(one_of("a spacing", SPACINGS))] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> SweepRange:
        check_order(self.lower, self.upper)
        if self.spacing == "log" and self.lower.value == 0.0:
            raise ValueError('Got spacing = "log" from zero; expected from greater than zero, or spacing = "linear".')
        return self


SweepEntry = Annotated[
    Annotated[SweepRange, Tag("<range>")] | Annotated[tuple[Amount, ...], PlainValidator(sweep_list), Tag("<list>")],
    Discriminator(lambda value: "<range>" if isinstance(value, dict) else "<list>"),
]


def _car(value: Any) -> str:
    if value == RIG:
        raise ValueError(
            f"Got {shown(RIG)}, which has no road to be judged on; expected {' or '.join(map(shown, MODELS))}. "
            f"A rig is for: inerter simulate."
        )
    return one_of("a vehicle model", MODELS)(value)


class AnyCar(Shape):
    """A vehicle whose model is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    model: Annotated[str, PlainValidator(_car)] = Field(examples=['model = "quarter-car"'])


class QuarterCarShape(Shape):
    """The keys of `QuarterCar`."""

    model: Literal["quarter-car"]
    sprung_mass: Annotated[float, positive("kg")] = Field(examples=['sprung_mass = "181.75 kg"'])
    unsprung_mass: Annotated[float, positive("kg")] = Field(examples=['unsprung_mass = "25 kg"'])
    tyre_stiffness: Annotated[float, positive("N/m")] = Field(examples=['tyre_stiffness = "120 kN/m"'])


class HalfCarShape(Shape):
    """The keys of `HalfCar`."""

    model: Literal["half-car"]
    sprung_mass: Annotated[float, positive("kg")] = Field(examples=['sprung_mass = "363.5 kg"'])
    pitch_inertia: Annotated[float, positive("kg m^2")] = Field(examples=['pitch_inertia = "200 kg m^2"'])
    unsprung_mass_front: Annotated[float, positive("kg")] = Field(examples=['unsprung_mass_front = "25 kg"'])
    unsprung_mass_rear: Annotated[float, positive("kg")] = Field(examples=['unsprung_mass_rear = "20 kg"'])
    tyre_stiffness_front: Annotated[float, positive("N/m")] = Field(examples=['tyre_stiffness_front = "120 kN/m"'])
    tyre_stiffness_rear: Annotated[float, positive("N/m")] = Field(examples=['tyre_stiffness_rear = "100 kN/m"'])
    distance_front: Annotated[float, positive("m")] = Field(examples=['distance_front = "0.775 m"'])
    distance_rear: Annotated[float, positive("m")] = Field(examples=['distance_rear = "1.265 m"'])


def model_tag(vehicle: Any) -> str:
    """Which shape the table [vehicle] has."""
    model = vehicle.get("model") if isinstance(vehicle, dict) else None
    return f"<{model}>" if isinstance(model, str) and model in MODELS else "<any>"


VehicleEntry = Annotated[
    Annotated[QuarterCarShape, Tag("<quarter-car>")]
    | Annotated[HalfCarShape, Tag("<half-car>")]
    | Annotated[AnyCar, Tag("<any>")],
    Discriminator(model_tag),
]


class RoadShape(Shape):
    """The keys of `Road`."""

    speed: Annotated[float, positive("m/s")] = Field(examples=['speed = "25 m/s"'])
    roughness: Annotated[float, positive("m^3/cycle")] = Field(examples=['roughness = "5e-7 m^3/cycle"'])


ElementEntry = Annotated[
    Annotated[Range, Tag("<range>")]
    | Annotated[Amount, PlainValidator(amount), Tag("<fixed>")]
    | Annotated[ToldKind, PlainValidator(told_kind), Tag("<kind>")],
    Discriminator(lambda value: "<kind>" if names_kind(value) else "<range>" if isinstance(value, dict) else "<fixed>"),
]


class Axles(Shape):
    """A layout of a half car with a strut of its own at each axle."""

    front: Annotated[str, PlainValidator(expression)] = Field(examples=['front = "k | c"'])
    rear: Annotated[str, PlainValidator(expression)] = Field(examples=['rear = "k | c"'])


LayoutEntry = Annotated[
    Annotated[Axles, Tag("<axles>")] | Annotated[str, PlainValidator(expression), Tag("<strut>")],
    Discriminator(lambda value: "<axles>" if isinstance(value, dict) else "<strut>"),
]
ElementName = Annotated[str, AfterValidator(element_name)]
Layouts = Annotated[
    dict[Annotated[str, AfterValidator(layout_name)], LayoutEntry],
    Field(min_length=1, examples=['a section [layouts] with lines such as S1 = "k | c"']),
]


class Settings(Shape):
    """What is asked of the layouts, and how it is answered."""

    indices: Annotated[tuple[str, ...], some_of("an index", INDICES)] = Field(examples=['indices = ["J1", "J3", "J5"]'])
    conventions: Annotated[str, PlainValidator(one_of("a set of conventions", CONVENTIONS))] = "exact"
    optimise: Annotated[str | None, PlainValidator(one_of("an optimisation method", METHODS))] = None
    evaluate: Annotated[tuple[str, ...], some_of("a method", METHODS)] = ("norm",)
    baseline: Annotated[str | None, PlainValidator(text)] = None
    sweep: Annotated[dict[str, SweepEntry], AfterValidator(one_sweep)] | None = Field(
        default=None, examples=['sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 30 } }']
    )
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    high_pass: Annotated[float | None, positive("rad/s")] = None
    realisations: Annotated[int | None, whole(2, _MOST_ROADS)] = None
    relative_error: Annotated[float | None, PlainValidator(share)] = None
    force: Annotated[float | None, positive("N")] = None
    budgets: Annotated[tuple[str, ...], some_names("f")] = ()


class StudyFile(Shape):
    """The whole file."""

    title: Annotated[str | None, PlainValidator(text)] = None
    vehicle: VehicleEntry = Field(examples=['a section [vehicle] with model = "quarter-car" or "half-car"'])
    road: RoadShape = Field(
        examples=['a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"'],
    )
    elements: dict[ElementName, ElementEntry] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Layouts
    study: Settings = Field(examples=['a section [study] with indices = ["J1", "J3", "J5"]'])


SHAPES: dict[tuple[str, ...], type[Shape]] = {
    (): StudyFile,
    ("vehicle", "<any>"): AnyCar,
    ("vehicle", "<quarter-car>"): QuarterCarShape,
    ("vehicle", "<half-car>"): HalfCarShape,
    ("road",): RoadShape,
    ("elements", "*", "<range>"): Range,
    ("layouts", "*", "<axles>"): Axles,
    ("study",): Settings,
    ("study", "sweep", "*", "<range>"): SweepRange,
}
