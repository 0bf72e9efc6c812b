"""The shape of a study file: which keys there are, what each may hold, and an example of each."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Discriminator, Field, PlainValidator, Tag, model_validator

from inerter.files.common.entries import (
    MOST_POINTS,
    Amount,
    check_order,
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
from inerter.files.common.shape import (
    MODELS,
    RIG,
    AmountText,
    Axles,
    ElementEntry,
    ElementName,
    HalfCarShape,
    Layouts,
    QuarterCarShape,
    Range,
    Shape,
    model_tag,
)
from inerter.units import shown

INDICES = ("J1", "J3", "J5")
METHODS = ("norm", "statistical-linearisation", "expected-value", "approximate-linear")
AVERAGING = ("expected-value", "approximate-linear")  # over random roads
FORCED = ("expected-value", "statistical-linearisation")  # take J5 at a force of one amplitude
_MOST_ROADS = 100_000
CONVENTIONS = ("exact", "paper2008")
SPACINGS = ("linear", "log")


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
