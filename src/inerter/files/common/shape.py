"""The shape of what several kinds of files have: vehicles, elements and layouts, with an example of each key."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from operator import or_
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    create_model,
    model_validator,
)

from inerter.errors import RowError
from inerter.fields import Choice, fields_of, mounts_of
from inerter.fields import Field as Quantity
from inerter.files.common.entries import (
    Amount,
    amount,
    check_order,
    element_name,
    expression,
    layout_name,
    one_of,
    positive,
    text,
)
from inerter.files.common.kind_entry import KindEntry, kind_entry, names_kind
from inerter.files.common.problem import EntryError
from inerter.rows import made_of_rows
from inerter.signals.road import ROAD_CLASSES
from inerter.vehicle.registry import VEHICLES

ROAD = (
    Quantity("speed", "m/s", "V of the vehicle.", "25 m/s", "speed"),
    Quantity("roughness", "m^3/cycle", "kappa = Gd(n0) n0^2 / 2 of ISO 8608.", "5e-7 m^3/cycle", "roughness"),
)
ANY = "<any>"  # the shape of what does not say its kind


class Shape(BaseModel):
    """A table of a study file; keys that it does not know are errors."""

    model_config = ConfigDict(extra="forbid")


class RoadTable(Shape):
    """A table [road] may say the class of a road in place of its roughness."""

    letter: Annotated[str | None, PlainValidator(one_of("a class of ISO 8608", ROAD_CLASSES))] = Field(
        default=None, alias="class", examples=['class = "C"']
    )

    @model_validator(mode="before")
    @classmethod
    def _of_a_class(cls, table: Any) -> Any:
        if not isinstance(table, dict) or "class" not in table:
            return table
        if "roughness" in table:
            raise EntryError(got="both roughness and class", expected="one of the two")
        known = ROAD_CLASSES.get(str(table["class"]), ROAD_CLASSES["A"])  # of another one, that is what is told
        return {**table, "roughness": f"{known.roughness!r} m^3/cycle"}


Shapes = Mapping[tuple[str, ...], type[Shape]]
AmountText = Annotated[Amount, PlainValidator(amount)]


class Range(Shape):
    """A free value: an optimiser chooses it between two bounds."""

    lower: AmountText = Field(alias="from", examples=['from = "100 N s/m"'])
    upper: AmountText = Field(alias="to", examples=['to = "100 kN s/m"'])

    @model_validator(mode="after")
    def _ordered(self) -> Range:
        check_order(self.lower, self.upper)
        return self


def of_quantities(fields: Iterable[Quantity]) -> dict[str, Any]:
    """Keys for quantities that must be given."""
    return {
        field.key: (Annotated[float, positive(field.unit)], Field(examples=[f'{field.key} = "{field.example}"']))
        for field in fields
    }


def if_given(fields: Iterable[Quantity]) -> dict[str, Any]:
    """Keys for quantities that may be left out."""
    return {
        field.key: (
            Annotated[float | None, positive(field.unit)],
            Field(default=None, examples=[f'{field.key} = "{field.example}"']),
        )
        for field in fields
    }


def of_choices(choices: Iterable[Choice]) -> dict[str, Any]:
    """Keys for texts, some of which may be left out."""
    keys = {}
    for one in choices:
        check = PlainValidator(one_of(f"a {one.key.replace('_', ' ')}", one.options) if one.options else text)
        examples = [f'{one.key} = "{one.example}"']
        needed, optional = Field(examples=examples), Field(default=None, examples=examples)
        keys[one.key] = (Annotated[str, check], needed) if one.needed else (Annotated[str | None, check], optional)
    return keys


def vehicle_shapes(models: Iterable[str], unknown: type[Shape]) -> tuple[Any, Shapes]:
    """The table [vehicle] of any of these models, and its shapes by place; `unknown` is that of any other model."""
    made = {f"<{model}>": _vehicle_shape(model) for model in models}

    def tag(vehicle: Any) -> str:
        model = vehicle.get("model") if isinstance(vehicle, dict) else None
        return f"<{model}>" if isinstance(model, str) and f"<{model}>" in made else ANY

    shapes = {**made, ANY: unknown}
    return one_of_shapes(shapes, tag), {("vehicle", name): shape for name, shape in shapes.items()}


def _vehicle_shape(model: str) -> type[Shape]:
    keys = of_quantities(fields_of(VEHICLES[model]))
    if "model" in keys:
        raise RowError(f"{model} has a quantity 'model', a key that [vehicle] has already. Choose another name.")
    return create_model(f"Vehicle {model}", __base__=Shape, **{**keys, "model": (Literal[model], ...)})


def one_of_shapes(shapes: Mapping[str, Any], tag: Callable[[Any], str]) -> Any:
    """What has the shape whose tag it has."""
    return Annotated[reduce(or_, (Annotated[shape, Tag(name)] for name, shape in shapes.items())), Discriminator(tag)]


ElementEntry = Annotated[
    Annotated[Range, Tag("<range>")]
    | Annotated[Amount, PlainValidator(amount), Tag("<fixed>")]
    | Annotated[KindEntry, PlainValidator(kind_entry), Tag("<kind>")],
    Discriminator(lambda value: "<kind>" if names_kind(value) else "<range>" if isinstance(value, dict) else "<fixed>"),
]


ElementName = Annotated[str, AfterValidator(element_name)]


LayoutName = Annotated[str, AfterValidator(layout_name)]


@made_of_rows
def layouts() -> tuple[Any, Shapes]:
    """The section [layouts], and its shapes by place: a text for all mounts, or a table with a text for each."""
    several = dict.fromkeys(mounts for kind in VEHICLES.values() if len(mounts := mounts_of(kind)) > 1)
    tables = {f"<{' '.join(mounts)}>": _mounts_shape(mounts) for mounts in several}

    def tag(entry: Any) -> str:
        if not isinstance(entry, dict):
            return "<strut>"
        return max(tables, key=lambda name: len(set(entry) & set(tables[name].model_fields)))

    strut = Annotated[str, PlainValidator(expression)]
    each: Any = one_of_shapes({**tables, "<strut>": strut}, tag)
    every: Any = dict.__class_getitem__((LayoutName, each))
    example = 'a section [layouts] with lines such as S1 = "k | c"'
    entry = Annotated[every, Field(min_length=1, examples=[example])]
    return entry, {("layouts", "*", name): shape for name, shape in tables.items()}


def _mounts_shape(mounts: tuple[str, ...]) -> type[Shape]:
    text = Annotated[str, PlainValidator(expression)]
    keys: dict[str, Any] = {mount: (text, Field(examples=[f'{mount} = "k | c"'])) for mount in mounts}
    return create_model(f"Mounts {' '.join(mounts)}", __base__=Shape, **keys)
