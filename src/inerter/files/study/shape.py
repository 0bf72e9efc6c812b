"""The shape of a study file: which keys there are, what each may hold, and an example of each."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    create_model,
    model_validator,
)

from inerter.errors import RowError
from inerter.fields import fields_of
from inerter.files.common.entries import (
    MOST_POINTS,
    one_of,
    positive_number,
    quantity_list,
    quantity_text,
    share,
    some_names,
    some_of,
    some_of_file,
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
    if_given,
    layouts,
    of_quantities,
    vehicle_shapes,
)
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.ties import TieEntry, is_tie, tie_entry
from inerter.files.common.vehicles import models
from inerter.files.study.conditions import OVER
from inerter.files.study.limits import LimitEntry, LimitShape
from inerter.files.study.own_indices import index_shapes, indices_of
from inerter.files.study.places import by_place
from inerter.indices.registry import index_settings
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import DEFAULT, METHODS, methods_that, searches
from inerter.rows import made_of_rows
from inerter.units import shown
from inerter.vehicle.registry import VEHICLES

_MOST_ROADS = 100_000
_MOST_OF_FRONT = 1000
SPACINGS = ("linear", "log")


SweptText = Annotated[str, PlainValidator(quantity_text)]


class SweepRange(Shape):
    """Values of a number from one end to the other."""

    lower: SweptText = Field(alias="from", examples=['from = "10 kN/m"'])
    upper: SweptText = Field(alias="to", examples=['to = "300 kN/m"'])
    points: Annotated[int, whole(2, MOST_POINTS)] = Field(examples=["points = 30"])
    spacing: Annotated[str, PlainValidator(one_of("a spacing", SPACINGS))] = "linear"


SweepEntry = Annotated[
    Annotated[SweepRange, Tag("<range>")] | Annotated[tuple[str, ...], PlainValidator(quantity_list), Tag("<list>")],
    Discriminator(lambda value: "<range>" if isinstance(value, dict) else "<list>"),
]


def _by_place(table: Any) -> Any:
    return by_place(table, entries=False)


class ConditionTable(Shape):
    """Numbers by their places, and how much of the time they are so."""

    model_config = ConfigDict(extra="allow")
    share: Annotated[float, PlainValidator(positive_number)] = Field(default=1.0, examples=["share = 0.3"])
    name: Annotated[str, PlainValidator(text)] = Field(default="", examples=['name = "loaded"'])


ConditionShape = Annotated[ConditionTable, BeforeValidator(_by_place)]
Over = Annotated[str | None, PlainValidator(one_of("a way to take an index over conditions", OVER))]


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

    @model_validator(mode="before")
    @classmethod
    def _of_a_trade_off(cls, table: Any) -> Any:
        """The indices of a trade-off are asked for by themselves too."""
        alone = isinstance(table, dict) and "trade_off" in table and "indices" not in table
        return {**table, "indices": table["trade_off"]} if alone else table

    indices: Annotated[tuple[str, ...], some_of_file("an index", indices_of)] = Field(
        examples=['indices = ["J1", "J3", "J5"]']
    )
    conventions: Annotated[str, PlainValidator(one_of("a set of conventions", CONVENTIONS))] = "exact"
    optimise: Annotated[str | None, PlainValidator(_search)] = None
    evaluate: Annotated[tuple[str, ...], some_of("a method", METHODS)] = (DEFAULT,)
    baseline: Annotated[str | None, PlainValidator(text)] = None
    sweep: Annotated[dict[str, SweepEntry], BeforeValidator(by_place)] | None = Field(
        default=None, examples=['sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 30 } }']
    )
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    realisations: Annotated[int | None, whole(2, _MOST_ROADS)] = None
    relative_error: Annotated[float | None, PlainValidator(share)] = None
    subject_to: Annotated[dict[str, LimitEntry], BeforeValidator(by_place)] | None = Field(
        default=None, examples=['subject_to = { tyre-load = { at_most = "600 N" } }']
    )
    conditions: Over = None
    trade_off: Annotated[tuple[str, ...], some_of_file("an index", indices_of)] = ()
    points: Annotated[int | None, whole(3, _MOST_OF_FRONT)] = None
    tolerance: Annotated[dict[str, Any], BeforeValidator(_by_place)] | None = Field(
        default=None, examples=['tolerance = { c = "10 %", b = "5 %" }']
    )
    quantile: Annotated[float | None, PlainValidator(share)] = None
    budgets: Annotated[tuple[str, ...], some_names("f")] = ()


_AnyElement = Annotated[
    Annotated[ElementEntry, Tag("<own>")] | Annotated[TieEntry, PlainValidator(tie_entry), Tag("<tied>")],
    Discriminator(lambda value: "<tied>" if is_tie(value) else "<own>"),
]


class StudyFile(WithVehicle):
    """The whole file, but for what is made of quantities and rows."""

    title: Annotated[str | None, PlainValidator(text)] = None
    vehicle: Any
    road: Any
    elements: dict[ElementName, _AnyElement] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Any
    indices: Any
    conditions: list[ConditionShape] = Field(default=[], examples=['[[conditions]] with "road.speed" = "15 m/s"'])
    study: Any


@made_of_rows
def shapes() -> tuple[type[StudyFile], Shapes]:
    """The shape of a study file, and all shapes in it by their place.

    Raises `RowError` if an index has a setting whose key is one of the section's own.
    """
    taken = sorted(index_settings().keys() & Settings.model_fields.keys())
    if taken:
        raise RowError(f"An index has a setting {taken[0]!r}, a key that [study] has already. Choose another key.")
    settings = create_model("Settings", __base__=Settings, **if_given(index_settings().values()))
    method, own = _method_shapes()
    index, kinds = index_shapes()
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
        indices=(index, Field(default_factory=dict)),
        study=(settings, Field(examples=['a section [study] with indices = ["J1", "J3", "J5"]'])),
        **section,
    )
    return file, {
        (): file,
        **vehicles,
        ("road",): RoadShape,
        **kinds,
        ("elements", "*", "<own>", "<range>"): Range,
        **tables,
        ("study",): settings,
        ("study", "sweep", "*", "<range>"): SweepRange,
        ("study", "subject_to", "*", "<limit>"): LimitShape,
        **own,
    }


def _method_shapes() -> tuple[type[Shape], Shapes]:
    """The section [methods], with a table for each method that has settings of its own, and its shapes by place."""
    own = {
        name: create_model(f"Method {name}", __base__=Shape, **if_given(fields))
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
