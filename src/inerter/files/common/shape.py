"""The shape of what several kinds of files have: vehicles, elements and layouts, with an example of each key."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, PlainValidator, Tag, model_validator

from inerter.files.common.entries import Amount, amount, check_order, element_name, expression, layout_name, positive
from inerter.files.common.told_kind import ToldKind, names_kind, told_kind

MODELS = ("quarter-car", "half-car")
RIG = "rig"
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
