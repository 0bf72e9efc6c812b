"""The shape of what several kinds of files have: vehicles, elements and layouts, with an example of each key."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from inspect import getdoc
from operator import or_
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    create_model,
    model_validator,
)

from inerter.errors import RowError
from inerter.fields import Field as Quantity
from inerter.fields import TextChoice, fields_of, mounts_of, needed_mounts_of
from inerter.files.common.entries import (
    AMOUNT,
    EXPRESSION,
    TEXT,
    Amount,
    check_order,
    element_name,
    layout_name,
    not_negative,
    or_free,
    positive,
    word,
)
from inerter.files.common.kind_entry import KindEntry, kind_entry, kind_schema, names_kind
from inerter.files.common.schema import NEVER, Says, checked
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.vehicle_shapes import (
    MECHANISM,
    SEAT,
    Driving,
    MechanismTable,
    SeatTable,
    forces_of,
    mechanism_shapes,
)
from inerter.rows import made_of_rows
from inerter.vehicle.registry import VEHICLES

ROAD = (
    Quantity("speed", "m/s", "V of the vehicle.", "25 m/s", "speed"),
    Quantity("roughness", "m^3/cycle", "kappa = Gd(n0) n0^2 / 2 of ISO 8608.", "5e-7 m^3/cycle", "roughness"),
)
ANY = "<any>"  # the shape of what does not say its kind


AmountText = Annotated[Amount, AMOUNT]


class Range(Shape):
    """A free value: an optimiser chooses it between two bounds."""

    lower: AmountText = Field(alias="from", description="The least it may be.", examples=['from = "100 N s/m"'])
    upper: AmountText = Field(alias="to", description="The most it may be.", examples=['to = "100 kN s/m"'])

    @model_validator(mode="after")
    def _ordered(self) -> Range:
        check_order(self.lower, self.upper)
        return self


def of_quantities(fields: Iterable[Quantity], *, free: bool = False) -> dict[str, Any]:
    """Keys for quantities: those without a default must be given, and those whose default is zero may be zero.

    Those that may be free may be ranges, if that makes sense here (`free`).
    """
    keys: dict[str, Any] = {}
    for field in fields:
        check = not_negative(field.unit) if field.default == 0.0 else positive(field.unit)
        if free and field.may_be_free:
            check = or_free(field.unit, field.key, may_vanish=field.default == 0.0)
        default = ... if field.default is None else field.default
        keys[field.key] = (Annotated[Any, check], Field(default, **of_field(field)))
    return keys


def of_field(field: Quantity | TextChoice) -> dict[str, Any]:
    """What its key says of a quantity or a text: a sentence, and an example."""
    return {"description": field.sentence, "examples": [f'{field.key} = "{field.example}"']}


def if_given(fields: Iterable[Quantity]) -> dict[str, Any]:
    """Keys for quantities that may be left out."""
    return {
        field.key: (
            Annotated[float | None, positive(field.unit)],
            Field(default=None, **of_field(field)),
        )
        for field in fields
    }


def of_choices(choices: Iterable[TextChoice]) -> dict[str, Any]:
    """Keys for texts, some of which may be left out."""
    keys = {}
    for one in choices:
        check = word(f"a {one.key.replace('_', ' ')}", one.options) if one.options else TEXT
        needed, optional = Field(**of_field(one)), Field(default=None, **of_field(one))
        keys[one.key] = (Annotated[str, check], needed) if one.needed else (Annotated[str | None, check], optional)
    return keys


def vehicle_shapes(models: Iterable[str], unknown: type[Shape], *, free: bool) -> tuple[Any, Shapes]:
    """The table [vehicle] of any of these models, and its shapes by place; `unknown` is that of any other model.

    Its quantities may be `free` where something is optimised.
    """
    made = {f"<{model}>": _vehicle_shape(model, free) for model in models}

    def tag(vehicle: Any) -> str:
        model = vehicle.get("model") if isinstance(vehicle, dict) else None
        return f"<{model}>" if isinstance(model, str) and f"<{model}>" in made else ANY

    shapes = {**made, ANY: unknown}
    places: dict[tuple[str, ...], type[Shape]] = {("vehicle", name): shape for name, shape in shapes.items()}
    seats: dict[tuple[str, ...], type[Shape]] = {
        ("vehicle", name, SEAT): SeatTable for name, shape in made.items() if SEAT in shape.model_fields
    }
    return one_of_shapes(shapes, tag), {**places, **seats, **mechanism_shapes()}


def _vehicle_shape(model: str, free: bool) -> type[Shape]:
    if model == MECHANISM:
        return MechanismTable
    keys = of_quantities(fields_of(VEHICLES[model]), free=free)
    own: dict[str, Any] = {"model": (Literal[model], _what(model))}
    if VEHICLES[model].moved == "road":
        own[SEAT] = (SeatTable | None, MechanismTable.model_fields[SEAT])
    taken = sorted(own.keys() & keys.keys())
    if taken:
        raise RowError(f"{model} has a quantity {taken[0]!r}, a key that [vehicle] has already. Choose another name.")
    return create_model(f"Vehicle {model}", __base__=Shape, __doc__=_about(model), **{**own, **keys})


def _what(model: str) -> Any:
    return Field(description="The kind of vehicle.", examples=[f'model = "{model}"'])


def _about(model: str) -> str:
    return (getdoc(VEHICLES[model]) or model).partition("\n\n")[0]


class WithVehicle(Shape):
    """A file with a vehicle: what it names itself, mounts and forces, is known to what refers to it."""

    @model_validator(mode="before")
    @classmethod
    def _named_by_the_vehicle(cls, tables: Any) -> Any:
        vehicle = tables.get("vehicle") if isinstance(tables, dict) else None
        if not isinstance(vehicle, dict):
            return tables
        found, given = dict(tables), tables.get("layouts")
        if isinstance(given, dict) and (SEAT in vehicle or vehicle.get("model") == MECHANISM):
            found["layouts"] = {n: _Mounted(entry) if isinstance(entry, dict) else entry for n, entry in given.items()}
        signal = tables.get("signal")
        if isinstance(signal, dict):
            found["signal"] = Driving(signal, _units(vehicle))
        return found


def _units(vehicle: Mapping[str, Any]) -> dict[str | None, str]:
    """The units of inputs that only this vehicle knows."""
    forces: dict[str | None, str] = dict(forces_of(vehicle).items())
    row = VEHICLES.get(str(vehicle.get("model")))
    if row is not None:
        first = row.forces.get(row.moved)
    else:
        first = None if vehicle.get("roads") else next(iter(forces.values()), None)
    return forces if first is None else {**forces, None: first}


class _Mounted(dict[str, Any]):
    """A layout of a vehicle that names its mounts itself."""


def one_of_shapes(shapes: Mapping[str, Any], tag: Callable[[Any], str]) -> Any:
    """What has the shape whose tag it has."""
    known = {**shapes, **({ANY: Annotated[shapes[ANY], Says(lambda: NEVER)]} if ANY in shapes else {})}
    return Annotated[reduce(or_, (Annotated[shape, Tag(name)] for name, shape in known.items())), Discriminator(tag)]


ElementEntry = Annotated[
    Annotated[Range, Tag("<range>")]
    | Annotated[Amount, AMOUNT, Tag("<fixed>")]
    | Annotated[KindEntry, checked(kind_entry, kind_schema), Tag("<kind>")],
    Discriminator(lambda value: "<kind>" if names_kind(value) else "<range>" if isinstance(value, dict) else "<fixed>"),
]


ElementName = Annotated[str, AfterValidator(element_name)]


LayoutName = Annotated[str, AfterValidator(layout_name)]


@made_of_rows
def layouts() -> tuple[Any, Shapes]:
    """The section [layouts], and its shapes by place: a text for all mounts, or a table with a text for each."""
    several = {mounts: needed_mounts_of(kind) for kind in VEHICLES.values() if len(mounts := mounts_of(kind)) > 1}
    tables = {f"<{' '.join(mounts)}>": _mounts_shape(mounts, needed) for mounts, needed in several.items()}

    def tag(entry: Any) -> str:
        if not isinstance(entry, dict):
            return "<strut>"
        if isinstance(entry, _Mounted):
            return "<mounted>"
        return max(tables, key=lambda name: len(set(entry) & set(tables[name].model_fields)))

    strut = Annotated[str, EXPRESSION]
    each: Any = one_of_shapes({**tables, "<strut>": strut, "<mounted>": dict[str, strut]}, tag)
    every: Any = dict.__class_getitem__((LayoutName, each))
    example = 'a section [layouts] with lines such as S1 = "k | c"'
    entry = Annotated[every, Field(min_length=1, examples=[example], description="How elements are joined.")]
    return entry, {("layouts", "*", name): shape for name, shape in tables.items()}


def _mounts_shape(mounts: tuple[str, ...], needed: tuple[str, ...]) -> type[Shape]:
    text = Annotated[str, EXPRESSION]
    keys: dict[str, Any] = {
        mount: (text, Field(... if mount in needed else None, **_of_mount(mount))) for mount in mounts
    }
    return create_model(f"Mounts {' '.join(mounts)}", __base__=Shape, **keys)


def _of_mount(mount: str) -> dict[str, Any]:
    return {"description": f"The network at {mount}.", "examples": [f'{mount} = "k | c"']}
