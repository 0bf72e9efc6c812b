"""The table [vehicle]: the quantities of a model, or the parts of a mechanism, and a seat."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from inspect import getdoc
from typing import Any, ClassVar

from inerter.errors import RegistryError, UnitError
from inerter.field_metadata import fields_of
from inerter.files.common.codec import (
    INVALID,
    Codec,
    Declaration,
    KeyPath,
    LoadContext,
    Scalar,
    TableCodec,
    key,
    keyed_dataclass,
    keys_in,
    section,
    table_of,
)
from inerter.files.common.codecs import NamesCodec, TaggedCodec, WeightsCodec
from inerter.files.common.entries import (
    EXPRESSION,
    LOWER,
    OUTPUT_NAME,
    TEXT,
    Amount,
    declaration_of,
    not_negative,
    other_bound,
    range_codec,
    text_of,
    with_bounds,
    word,
)
from inerter.files.common.number import Number
from inerter.files.common.problem import invalid_entry
from inerter.files.common.schema import quantity_schema
from inerter.networks.elements import NAME, Free
from inerter.units import PURE, parse_one_of, parse_quantity
from inerter.validation import is_number
from inerter.vehicle.mechanism import TRACKS
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.seat import Seat

MECHANISM = "mechanism"
SEAT, SEAT_MASS = "seat", "mass on the seat"
NOTHING: Mapping[str, Any] = {}
NO_MEASURES: Mapping[str, Any] = {"comfort": NOTHING, "tyre_load": None, "load_input": None, "load_output": None}


class Length(float):
    """The lever of an angle [m]."""


def inertia(entry: Any) -> Amount:
    """A mass, or the moment of inertia of an angle, with its unit."""
    try:
        unit, value = parse_one_of(entry, {"kg": "", "kg m^2": ""}, "kg")
    except UnitError:
        wanted = 'a mass such as "250 kg", or of an angle a moment of inertia such as "200 kg m^2"'
        raise invalid_entry(entry, expected=wanted) from None
    if value < 0.0:
        raise invalid_entry(entry, fault="negative", expected=f"more than 0 {unit}, or 0 for a node")
    return Amount(unit, value)


def _bound(entry: Any) -> Amount:
    found = inertia(entry)
    if found.value == 0.0:
        raise invalid_entry(entry, fault="not positive", expected=f"more than 0 {found.unit}")
    return found


def part_name(name: Any) -> str:
    """A name that can stand before the name of a motion or a force."""
    if not NAME.fullmatch(name):
        letters = "a letter followed by letters, digits and underscores, such as body"
        raise invalid_entry(name, fault="not a name", expected=letters)
    return str(name)


def force_name(name: Any) -> str:
    """The name of a force, which is not that of the input that moves all roads."""
    if name == "road":
        raise invalid_entry(
            name, fault="as an input of a signal it is all roads", expected="another name, such as load"
        )
    return part_name(name)


_RANGE = range_codec(Scalar(_bound, lambda: quantity_schema("kg", "kg m^2", least="positive")), "1 kg", "2 kg")


@dataclass(frozen=True)
class InertiaCodec(Codec):
    """A mass, or the moment of inertia of an angle, which may be `free`."""

    is_number: ClassVar[bool] = True

    free: bool = False

    def load(self, raw: Any, context: LoadContext) -> Amount:
        """The inertia; a free one has the name of its key."""
        if self.free and isinstance(raw, dict):
            found = _RANGE.load(raw, context)
            return found if found is INVALID else Amount(found.lower.unit, found.free(context.place[-1]))
        return inertia(raw)

    def dump(self, value: Amount) -> Any:
        """The text in its unit, or a table of two."""
        return text_of(value.value, value.unit)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the text."""
        one = quantity_schema("kg", "kg m^2", least="not negative")
        return {"anyOf": [one, _RANGE.schema()]} if self.free else one

    def numbers(self, value: Amount, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The mass or the moment of inertia with its bounds; none of a node without mass."""
        if value.value != 0.0:
            yield from with_bounds(
                Number(value.unit, "inertia" if is_angle(value) else "mass", value.value, may_be_free=self.free)
            )

    def put(self, value: Amount, keys: Sequence[str], number: float) -> Amount:
        """The inertia with another number, or the free one with another bound."""
        if isinstance(value.value, Free) and keys:
            return value._replace(value=other_bound(value.value, keys[0], number))
        return value._replace(value=number)


@dataclass(frozen=True)
class LeverCodec(Codec):
    """A lever: a mere number, or a length for an angle."""

    is_number: ClassVar[bool] = True

    def load(self, raw: Any, context: LoadContext) -> float:
        """The number, or a `Length` [m]."""
        if isinstance(raw, str):
            return Length(parse_quantity(raw, "m"))
        if not is_number(raw):
            raise invalid_entry(raw, expected='a number such as 1, or for an angle a length such as "1.2 m"')
        return float(raw)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of both."""
        return {"anyOf": [{"type": "number"}, quantity_schema("m")]}

    def numbers(self, value: float, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The lever."""
        unit = "m" if isinstance(value, Length) else PURE
        yield (), Number(unit, words or "lever", value, may_vanish=True, signed=True)

    def put(self, value: float, keys: Sequence[str], number: float) -> float:
        """Lever with another number, of the same type as `value`."""
        return type(value)(number)


@dataclass(frozen=True)
class PortCodec(NamesCodec):
    """Coordinates that a port is joined to, with their levers."""

    item: Codec = LeverCodec()
    name: Callable[[Any], str] = part_name

    def dump(self, value: Mapping[str, float]) -> dict[str, Any]:
        """The levers by their names."""
        return {n: f"{float(v)!r} m" if isinstance(v, Length) else float(v) for n, v in value.items()}


@dataclass(frozen=True)
class OutputsCodec(PortCodec, WeightsCodec):
    """Outputs with their weights."""


PORT = PortCodec(least=1)
SOME_PORT = PortCodec()
_OUTPUTS = OutputsCodec()


@keyed_dataclass
class StrutTable:
    """Network between two ports; default of the lower one: the ground."""

    upper: Mapping[str, float] = key(
        PORT, "Upper port: coordinates with their lever arms.", 'upper = { body = 1, pitch = "1.2 m" }'
    )
    lower: Mapping[str, float] = key(
        SOME_PORT, "Lower port; default: the ground.", "lower = { wheel = 1 }", default=NOTHING
    )
    network: str | None = key(EXPRESSION, "Network that is common to all layouts.", 'network = "k | c"', default=None)


@keyed_dataclass
class TyreTable:
    """Network between a port and a road."""

    port: Mapping[str, float] = key(
        PORT, "Port that the tyre carries: coordinates with their lever arms.", "port = { wheel = 1 }"
    )
    road: str = key(TEXT, "Road input of the tyre.", 'road = "road"')
    network: str | None = key(EXPRESSION, "Network that is common to all layouts.", 'network = "kt"', default=None)


@keyed_dataclass
class RoadPlace:
    """Position of a road input."""

    distance: float = key(
        not_negative("m"), "Distance behind the first axle; it determines the delay.", 'distance = "2.5 m"', default=0.0
    )
    track: str = key(
        word("a side", TRACKS),
        "Side of the vehicle: left or right, for roads with two tracks.",
        'track = "left"',
        default="",
    )


@keyed_dataclass
class MeasureTable:
    """Performance outputs of indices, with their weights."""

    comfort: Mapping[str, float] = key(
        _OUTPUTS,
        "Outputs of ride comfort J1, with their weights.",
        "comfort = { body_acceleration = 1 }",
        default=NOTHING,
    )
    tyre_load: Mapping[str, float] | None = key(
        _OUTPUTS,
        "Outputs of the dynamic tyre load J3, with their weights.",
        "tyre_load = { wheel_load = 1 }",
        default=None,
    )
    load_input: str | None = key(TEXT, "Force of load carrying J5.", 'load_input = "load"', default=None)
    load_output: str | None = key(
        OUTPUT_NAME, "Displacement output of load carrying J5.", 'load_output = "body_displacement"', default=None
    )


@keyed_dataclass
class SeatTable:
    """A seat with its occupant, on any vehicle."""

    network: str = key(EXPRESSION, "Network between floor and occupant.", 'network = "ks | cs"')
    place: Mapping[str, float] | None = key(
        PORT,
        "Position of the seat: coordinates with their lever arms.",
        'place = { sprung = 1, pitch = "0.3 m" }',
        default=None,
    )


def _parts_of(kind: Any) -> TableCodec:
    return table_of(kind, make=dict, about=(kind.__doc__ or "").partition("\n\n")[0])


@keyed_dataclass
class MechanismTable:
    """A vehicle of masses, levers, networks and roads."""

    struts: Mapping[str, Any] = key(
        NamesCodec(_parts_of(StrutTable), part_name),
        "Networks between two ports.",
        "a section [vehicle.struts] with lines such as s = { upper = { body = 1 }, lower = { wheel = 1 } }",
        default=NOTHING,
    )
    tyres: Mapping[str, Any] = key(
        NamesCodec(_parts_of(TyreTable), part_name),
        "Networks between a port and a road.",
        'a section [vehicle.tyres] with lines such as tyre = { port = { wheel = 1 }, road = "road" }',
        default=NOTHING,
    )
    roads: Mapping[str, Any] = key(
        NamesCodec(_parts_of(RoadPlace), part_name),
        "Road inputs with their positions.",
        'a section [vehicle.roads] with lines such as rear = { distance = "2.5 m" }',
        default=NOTHING,
    )
    forces: Mapping[str, Mapping[str, float]] = key(
        NamesCodec(SOME_PORT, force_name),
        "External forces and moments, by the port on which they act.",
        "a section [vehicle.forces] with lines such as load = { body = 1 }",
        default=NOTHING,
    )
    measures: Mapping[str, Any] = key(
        _parts_of(MeasureTable),
        "Performance outputs of each index.",
        "a section [vehicle.measures] with comfort = { body_acceleration = 1 }",
        default=NO_MEASURES,
    )


def _coordinates(free: bool) -> Declaration:
    """The table of coordinates, whose inertias may be `free`."""
    sentence = "Degrees of freedom: the mass or moment of inertia of each; 0 for a node that joins networks."
    example = 'a section [vehicle.coordinates] with lines such as body = "250 kg"'
    table = NamesCodec(InertiaCodec(free), part_name, least=1)
    return section("coordinates", table, sentence, example)


def _seat(free: bool) -> Declaration:
    """The table of a seat, whose mass may be `free`."""
    mass = replace(next(declaration_of(one, free=free) for one in fields_of(Seat)), words=SEAT_MASS)
    table = table_of(SeatTable, keys=(mass, *keys_in(SeatTable)), make=dict, about=str(SeatTable.__doc__))
    example = 'a section [vehicle.seat] with mass = "60 kg"'
    return Declaration(table, "A seat with its occupant.", example, None, SEAT, SEAT, SEAT)


def vehicle_codec(models: Sequence[str], check_model: Callable[[Any], str], *, free: bool) -> TaggedCodec:
    """The table [vehicle] of any of these models, as a dictionary of its values with "model" among them.

    Its quantities may be `free` where something is optimised.
    """
    made = {model: _vehicle_table(model, free) for model in models}
    return TaggedCodec("model", lambda: made, check_model, lambda vehicle: str(vehicle["model"]), next(iter(models)))


def _vehicle_table(model: str, free: bool) -> TableCodec:
    def make(**values: Any) -> dict[str, Any]:
        values = {"model": model, **values}
        return {name: value for name, value in values.items() if value is not None or name != SEAT}

    tag = ("model", model, "The kind of vehicle.")
    if model == MECHANISM:
        keys = (_coordinates(free), *keys_in(MechanismTable), _seat(free))
        return table_of(MechanismTable, keys=keys, make=make, tag=tag, about=str(MechanismTable.__doc__))
    keys = tuple(declaration_of(field, free=free) for field in fields_of(VEHICLES[model]))
    seat = (_seat(free),) if VEHICLES[model].moved == "road" else ()
    taken = sorted({"model", *(one.name for one in seat)} & {one.name for one in keys})
    if taken:
        raise RegistryError(
            f"{model} has a quantity {taken[0]!r}, a key that [vehicle] has already. Choose another name."
        )
    about = (getdoc(VEHICLES[model]) or model).partition("\n\n")[0]
    return TableCodec((*keys, *seat), make, tag=tag, about=about)


def units_of_inputs(vehicle: Any) -> dict[str | None, str]:
    """Units of the inputs that only this vehicle has, by name, from its table; under None that of the default input."""
    if not isinstance(vehicle, dict):
        return {}
    forces: dict[str | None, str] = dict(forces_of(vehicle).items())
    row = VEHICLES.get(str(vehicle.get("model")))
    if row is not None:
        first = row.forces.get(row.moved)
    else:
        first = None if vehicle.get("roads") else next(iter(forces.values()), None)
    return forces if first is None else {**forces, None: first}


def forces_of(vehicle: Mapping[str, Any]) -> dict[str, str]:
    """The forces of a mechanism, with their units, from its table or what became of it."""
    forces, coordinates = (vehicle.get(part) for part in ("forces", "coordinates"))
    if not isinstance(forces, dict) or not isinstance(coordinates, dict):
        return {}
    angles = {name for name, entry in coordinates.items() if is_angle(entry)}
    ports = {name: port for name, port in forces.items() if isinstance(port, dict)}
    return {name: "N m" if port and port.keys() <= angles else "N" for name, port in ports.items()}


def is_angle(entry: Any) -> bool:
    """Whether an entry of a coordinate, or the amount that it became, is a moment of inertia."""
    try:
        found = entry if isinstance(entry, Amount) else inertia(entry[LOWER] if isinstance(entry, dict) else entry)
        return found.unit != "kg"
    except (ValueError, KeyError):  # told with the coordinate
        return False
