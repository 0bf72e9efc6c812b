"""The shape of a study file: which keys there are, what each may hold, and an example of each."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    create_model,
    model_validator,
)

from inerter.errors import RowError
from inerter.fields import Field as Quantity
from inerter.fields import fields_of
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
    swept_amount,
    text,
    whole,
)
from inerter.files.common.shape import (
    ROAD,
    ElementEntry,
    ElementName,
    Range,
    RoadTable,
    WithVehicle,
    layouts,
    of_quantities,
    vehicle_shapes,
)
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.vehicles import models
from inerter.indices.registry import INDICES, index_settings
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import DEFAULT, METHODS, methods_that, searches
from inerter.rows import made_of_rows
from inerter.units import shown
from inerter.vehicle.registry import VEHICLES

_MOST_ROADS = 100_000
SPACINGS = ("linear", "log")


SweptText = Annotated[Amount, PlainValidator(swept_amount)]


class SweepRange(Shape):
    """Values of one element from one end to the other."""

    lower: SweptText = Field(alias="from", examples=['from = "10 kN/m"'])
    upper: SweptText = Field(alias="to", examples=['to = "300 kN/m"'])
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
    cars = tuple(_cars())
    if isinstance(value, str) and value in VEHICLES and value not in cars:
        raise ValueError(
            f"Got {shown(value)}, which has no road to be judged on; expected {' or '.join(map(shown, cars))}. "
            f"A {value.replace('-', ' ')} is for: inerter simulate."
        )
    return one_of("a vehicle model", cars)(value)


def _cars() -> list[str]:
    """The models that are judged, on a road or under a force."""
    return [model for model in models() if model not in VEHICLES or VEHICLES[model].moved != "displacement"]


class AnyCar(Shape):
    """A vehicle whose model is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    model: Annotated[str, PlainValidator(_car)] = Field(examples=['model = "quarter-car"'])


ROAD_EXAMPLE = 'a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"'
RoadShape = create_model("RoadShape", __base__=RoadTable, **of_quantities(ROAD))


def _search(value: Any) -> str:
    return one_of("an optimisation method", methods_that(searches))(value)


class Settings(Shape):
    """What is asked of the layouts, and how it is answered; beside these there are the settings of indices."""

    indices: Annotated[tuple[str, ...], some_of("an index", INDICES)] = Field(examples=['indices = ["J1", "J3", "J5"]'])
    conventions: Annotated[str, PlainValidator(one_of("a set of conventions", CONVENTIONS))] = "exact"
    optimise: Annotated[str | None, PlainValidator(_search)] = None
    evaluate: Annotated[tuple[str, ...], some_of("a method", METHODS)] = (DEFAULT,)
    baseline: Annotated[str | None, PlainValidator(text)] = None
    sweep: Annotated[dict[str, SweepEntry], AfterValidator(one_sweep)] | None = Field(
        default=None, examples=['sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 30 } }']
    )
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    realisations: Annotated[int | None, whole(2, _MOST_ROADS)] = None
    relative_error: Annotated[float | None, PlainValidator(share)] = None
    budgets: Annotated[tuple[str, ...], some_names("f")] = ()


class StudyFile(WithVehicle):
    """The whole file, but for what is made of quantities and rows."""

    title: Annotated[str | None, PlainValidator(text)] = None
    vehicle: Any
    road: Any
    elements: dict[ElementName, ElementEntry] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Any
    study: Any


@made_of_rows
def shapes() -> tuple[type[StudyFile], Shapes]:
    """The shape of a study file, and all shapes in it by their place.

    Raises `RowError` if an index has a setting whose key is one of the section's own.
    """
    taken = sorted(index_settings().keys() & Settings.model_fields.keys())
    if taken:
        raise RowError(f"An index has a setting {taken[0]!r}, a key that [study] has already. Choose another key.")
    settings = create_model("Settings", __base__=Settings, **_if_given(index_settings().values()))
    method, own = _method_shapes()
    vehicle, vehicles = vehicle_shapes(_cars(), AnyCar)
    *others, last = map(shown, _cars())
    cars = f"{', '.join(others)} or {last}"
    layout, tables = layouts()
    some_road: Any = RoadShape | None
    section: dict[str, Any] = {"methods": (method, Field(default_factory=method))} if own else {}
    file = create_model(
        "StudyFile",
        __base__=StudyFile,
        vehicle=(vehicle, Field(examples=[f"a section [vehicle] with model = {cars}"])),
        road=(some_road, Field(examples=[ROAD_EXAMPLE])),
        layouts=(layout, ...),
        study=(settings, Field(examples=['a section [study] with indices = ["J1", "J3", "J5"]'])),
        **section,
    )
    return file, {
        (): file,
        **vehicles,
        ("road",): RoadShape,
        ("elements", "*", "<range>"): Range,
        **tables,
        ("study",): settings,
        ("study", "sweep", "*", "<range>"): SweepRange,
        **own,
    }


def _method_shapes() -> tuple[type[Shape], Shapes]:
    """The section [methods], with a table for each method that has settings of its own, and its shapes by place."""
    own = {
        name: create_model(f"Method {name}", __base__=Shape, **_if_given(fields))
        for name, kind in METHODS.items()
        if (fields := fields_of(kind))
    }
    tables: dict[str, Any] = {
        f"table{number}": (shape, Field(default_factory=shape, alias=name))
        for number, (name, shape) in enumerate(own.items())
    }
    section = create_model("Methods", __base__=Shape, **tables)
    places: dict[tuple[str, ...], type[Shape]] = {("methods", name): shape for name, shape in own.items()}
    return section, {("methods",): section, **places} if own else {}


def _if_given(fields: Iterable[Quantity]) -> dict[str, Any]:
    """Keys for quantities that may be left out."""
    return {
        field.key: (
            Annotated[float | None, positive(field.unit)],
            Field(default=None, examples=[f'{field.key} = "{field.example}"']),
        )
        for field in fields
    }
