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
    SHARE,
    SWEEP_LIST,
    SWEPT,
    TEXT,
    one_of,
    positive_number,
    some_names,
    some_of,
    some_of_file,
    whole,
    word,
)
from inerter.files.common.roads import CoherenceTable, RoadTable
from inerter.files.common.schema import OrDeeper, checked, words_schema
from inerter.files.common.shape import (
    ROAD,
    ElementEntry,
    ElementName,
    Range,
    WithVehicle,
    if_given,
    layouts,
    of_quantities,
    vehicle_shapes,
)
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.ties import TieEntry, is_tie, tie_entry, tie_schema
from inerter.files.common.vehicles import models
from inerter.files.study.conditions import OVER
from inerter.files.study.limits import LimitEntry, LimitShape
from inerter.files.study.own_indices import index_shapes, indices_of
from inerter.files.study.places import by_place
from inerter.indices.registry import index_settings
from inerter.methods.linear import CONVENTIONS
from inerter.methods.registry import DEFAULT, METHODS, methods_that, searches
from inerter.networks.elements.registry import units_told
from inerter.rows import made_of_rows
from inerter.units import shown
from inerter.vehicle.registry import VEHICLES

_MOST_ROADS = 100_000
_MOST_OF_FRONT = 1000
SPACINGS = ("linear", "log")


SweptText = Annotated[str, SWEPT]


class SweepRange(Shape):
    """Values of a number from one end to the other."""

    lower: SweptText = Field(alias="from", description="The first value.", examples=['from = "10 kN/m"'])
    upper: SweptText = Field(alias="to", description="The last value.", examples=['to = "300 kN/m"'])
    points: Annotated[int, whole(2, MOST_POINTS)] = Field(description="How many values.", examples=["points = 30"])
    spacing: Annotated[str, word("a spacing", SPACINGS)] = Field(
        default="linear", description="Equal steps, or equal ratios.", examples=['spacing = "log"']
    )


SweepEntry = Annotated[
    Annotated[SweepRange, Tag("<range>")] | Annotated[tuple[str, ...], SWEEP_LIST, Tag("<list>")],
    Discriminator(lambda value: "<range>" if isinstance(value, dict) else "<list>"),
    OrDeeper(),
]


def _by_place(table: Any) -> Any:
    return by_place(table, entries=False)


class ConditionTable(Shape):
    """Numbers by their places, and how much of the time they are so."""

    model_config = ConfigDict(extra="allow")
    share: Annotated[float, checked(positive_number, lambda: {"type": "number", "exclusiveMinimum": 0})] = Field(
        default=1.0, description="How much of the time it is so, beside the others.", examples=["share = 0.3"]
    )
    name: Annotated[str, TEXT] = Field(default="", description="What it is called.", examples=['name = "loaded"'])


ConditionShape = Annotated[ConditionTable, BeforeValidator(_by_place)]
Over = Annotated[str | None, word("a way to take an index over conditions", OVER)]


def _car(value: Any) -> str:
    cars = tuple(judged_models())
    if isinstance(value, str) and value in VEHICLES and value not in cars:
        raise ValueError(
            f"Got {shown(value)}, which has no road to be judged on; expected {' or '.join(map(shown, cars))}. "
            f"A {value.replace('-', ' ')} is for: inerter simulate."
        )
    return one_of("a vehicle model", cars)(value)


def judged_models() -> list[str]:
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

    model_config = ConfigDict(json_schema_extra=lambda schema: schema["required"].remove("indices"))  # of a trade-off

    @model_validator(mode="before")
    @classmethod
    def _of_a_trade_off(cls, table: Any) -> Any:
        """The indices of a trade-off are asked for by themselves too."""
        alone = isinstance(table, dict) and "trade_off" in table and "indices" not in table
        return {**table, "indices": table["trade_off"]} if alone else table

    indices: Annotated[tuple[str, ...], some_of_file("an index", indices_of)] = Field(
        description="What is asked of each layout.", examples=['indices = ["J1", "J3", "J5"]']
    )
    conventions: Annotated[str, word("a set of conventions", CONVENTIONS)] = Field(
        default="exact",
        description="How numbers are made: exactly, or as in the paper of 2008.",
        examples=['conventions = "paper2008"'],
    )
    optimise: Annotated[str | None, checked(_search, lambda: words_schema(methods_that(searches)))] = Field(
        default=None,
        description="The method whose value is made smallest; needed if anything is free.",
        examples=['optimise = "norm"'],
    )
    evaluate: Annotated[tuple[str, ...], some_of("a method", METHODS)] = Field(
        default=(DEFAULT,),
        description="The methods that judge the designs; tables and figures are about the first.",
        examples=['evaluate = ["norm", "expected-value"]'],
    )
    baseline: Annotated[str | None, TEXT] = Field(
        default=None,
        description="The layout that the others are compared with; the first if left out.",
        examples=['baseline = "S1"'],
    )
    sweep: Annotated[dict[str, SweepEntry], BeforeValidator(by_place)] | None = Field(
        default=None,
        description="Numbers of this file, by their places, that take these values in turn; two make a map.",
        examples=['sweep = { k = { from = "10 kN/m", to = "300 kN/m", points = 30 } }'],
    )
    seed: Annotated[int, whole(0, 2**63 - 1)] = Field(
        default=0, description="Of the search and of the random roads.", examples=["seed = 1"]
    )
    realisations: Annotated[int | None, whole(2, _MOST_ROADS)] = Field(
        default=None,
        description="Random roads of the methods that average; their own choice if left out.",
        examples=["realisations = 20"],
    )
    relative_error: Annotated[float | None, SHARE] = Field(
        default=None,
        description="As many roads as make the standard error that part of the value.",
        examples=["relative_error = 0.002"],
    )
    budgets: Annotated[tuple[str, ...], some_names("f")] = Field(
        default=(),
        description="Elements: for which values of each is a layout better than the baseline?",
        examples=['budgets = ["f"]'],
    )
    subject_to: Annotated[dict[str, LimitEntry], BeforeValidator(by_place)] | None = Field(
        default=None,
        description="Limits on other indices: what is best is the best that keeps them.",
        examples=['subject_to = { tyre-load = { at_most = "600 N" } }'],
    )
    conditions: Over = Field(
        default=None,
        description="What an index is over the [[conditions]].",
        examples=['conditions = "worst"'],
    )
    trade_off: Annotated[tuple[str, ...], some_of_file("an index", indices_of)] = Field(
        default=(), description="Two indices whose front is sought.", examples=['trade_off = ["J1", "J3"]']
    )
    points: Annotated[int | None, whole(3, _MOST_OF_FRONT)] = Field(
        default=None, description="How many designs of a front.", examples=["points = 25"]
    )
    tolerance: Annotated[dict[str, Any], BeforeValidator(_by_place)] | None = Field(
        default=None,
        description="By what part values scatter: what the index then is, and what matters.",
        examples=['tolerance = { c = "10 %", b = "5 %" }'],
    )
    quantile: Annotated[float | None, SHARE] = Field(
        default=None,
        description="The part of all scattered designs that is to be at least as good.",
        examples=["quantile = 0.95"],
    )


_AnyElement = Annotated[
    Annotated[ElementEntry, Tag("<own>")] | Annotated[TieEntry, checked(tie_entry, tie_schema), Tag("<tied>")],
    Discriminator(lambda value: "<tied>" if is_tie(value) else "<own>"),
]


class StudyFile(WithVehicle):
    """The whole file, but for what is made of quantities and rows."""

    title: Annotated[str | None, TEXT] = Field(
        default=None, description="A line for reports; the name of the file if left out.", examples=['title = "My car"']
    )
    vehicle: Any
    road: Any
    elements: Any
    layouts: Any
    indices: Any
    conditions: list[ConditionShape] = Field(
        default=[],
        description="Numbers of this file, by their places, as they are in one operating condition.",
        examples=['[[conditions]] with "road.speed" = "15 m/s"'],
    )
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
    vehicle, vehicles = vehicle_shapes(judged_models(), AnyCar, free=True)
    *others, last = map(shown, judged_models())
    cars = f"{', '.join(others)} or {last}"
    some_road: Any = RoadShape | None
    elements: Any = dict[ElementName, _AnyElement]
    layout, tables = layouts()
    section: dict[str, Any] = (
        {"methods": (method, Field(default_factory=method, description="Settings of methods, a table for each."))}
        if own
        else {}
    )
    file = create_model(
        "StudyFile",
        __base__=StudyFile,
        vehicle=(
            vehicle,
            Field(
                description="What the struts are mounted in: its model decides which other keys there are.",
                examples=[f"a section [vehicle] with model = {cars}"],
            ),
        ),
        road=(
            some_road,
            Field(default=None, description="What the vehicle drives on, and how fast.", examples=[ROAD_EXAMPLE]),
        ),
        elements=(
            elements,
            Field(
                min_length=1,
                description="What struts are made of, by names of your own. The unit tells the element: "
                f"{units_told()}. A value is fixed, or free between two bounds.",
                examples=['a section [elements] with lines such as k = "120 kN/m"'],
            ),
        ),
        layouts=(layout, Field(description="How elements are joined: | side by side, - end to end.")),
        indices=(
            index,
            Field(
                default_factory=dict,
                description="Indices of your own: a kind, with its settings.",
                examples=['a section [indices.comfort] with kind = "ride-comfort"'],
            ),
        ),
        study=(
            settings,
            Field(
                description="What is asked of the layouts, and how it is answered.",
                examples=['a section [study] with indices = ["J1", "J3", "J5"]'],
            ),
        ),
        **section,
    )
    return file, {
        (): file,
        **vehicles,
        ("road",): RoadShape,
        ("road", "coherence"): CoherenceTable,
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
