"""The shapes of what a table [vehicle] may hold beside quantities: the parts of a mechanism, and a seat."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from inerter.checks import is_number
from inerter.errors import UnitError
from inerter.files.common.entries import EXPRESSION, TEXT, not_negative, positive, word
from inerter.files.common.problem import EntryError
from inerter.files.common.schema import checked, quantity_schema
from inerter.files.common.tables import Shape, Shapes
from inerter.networks.elements import NAME
from inerter.units import parse_one_of, parse_quantity, shown
from inerter.vehicle.mechanism import TRACKS

MECHANISM = "mechanism"
SEAT = "seat"


class Length(float):
    """The lever of an angle [m]."""


class Inertia(float):
    """The moment of inertia of an angle [kg m^2]."""


def lever(entry: Any) -> float:
    """The lever of a coordinate: a number; of an angle a length."""
    if isinstance(entry, str):
        return Length(parse_quantity(entry, "m"))
    if not is_number(entry):
        raise EntryError(got=shown(entry), expected='a number such as 1, or for an angle a length such as "1.2 m"')
    return float(entry)


def inertia(entry: Any) -> float:
    """A mass, or the moment of inertia of an angle."""
    try:
        unit, value = parse_one_of(entry, {"kg": "", "kg m^2": ""}, "kg")
    except UnitError:
        wanted = 'a mass such as "250 kg", or of an angle a moment of inertia such as "200 kg m^2"'
        raise EntryError(got=shown(entry), expected=wanted) from None
    if value <= 0.0:
        raise EntryError(got=shown(entry), fault="not positive", expected=f"more than 0 {unit}")
    return value if unit == "kg" else Inertia(value)


def part_name(name: Any) -> str:
    """A name that can stand before the name of a motion or a force."""
    if not NAME.fullmatch(name):
        letters = "a letter followed by letters, digits and underscores, such as body"
        raise EntryError(got=shown(name), fault="not a name", expected=letters)
    return str(name)


LEVER_SCHEMA: dict[str, Any] = {"anyOf": [{"type": "number"}, quantity_schema("m")]}
PartName = Annotated[str, AfterValidator(part_name)]
Port = dict[PartName, Annotated[float, checked(lever, lambda: LEVER_SCHEMA)]]
NetworkText = Annotated[str | None, EXPRESSION]


class StrutTable(Shape):
    """Between two ports; without a lower one it is on the ground."""

    upper: Port = Field(
        min_length=1,
        description="The port at its upper end: coordinates with their levers.",
        examples=['upper = { body = 1, pitch = "1.2 m" }'],
    )
    lower: Port = Field(
        default_factory=dict,
        description="The port at its lower end; the ground if left out.",
        examples=["lower = { wheel = 1 }"],
    )
    network: NetworkText = Field(
        default=None, description="A network that all layouts have there.", examples=['network = "k | c"']
    )


class TyreTable(Shape):
    """Between a port and a road."""

    port: Port = Field(
        min_length=1, description="What it carries: coordinates with their levers.", examples=["port = { wheel = 1 }"]
    )
    road: Annotated[str, TEXT] = Field(description="The road below it.", examples=['road = "road"'])
    network: NetworkText = Field(
        default=None, description="A network that all layouts have there.", examples=['network = "kt"']
    )


class RoadPlace(Shape):
    """Where the mechanism meets the road."""

    distance: Annotated[float, not_negative("m")] = Field(
        default=0.0, description="Behind the first axle.", examples=['distance = "2.5 m"']
    )
    track: Annotated[str, word("a track", TRACKS)] = Field(
        default="", description="Left or right, where there are two.", examples=['track = "left"']
    )


class MeasureTable(Shape):
    """Which outputs answer the questions of indices."""

    comfort: dict[PartName, Annotated[float, checked(lever, lambda: LEVER_SCHEMA)]] = Field(
        default_factory=dict,
        description="Outputs that ride comfort is about, with their weights.",
        examples=["comfort = { body_acceleration = 1 }"],
    )
    tyre_load: dict[PartName, Annotated[float, checked(lever, lambda: LEVER_SCHEMA)]] | None = Field(
        default=None,
        description="Outputs that tyre load is about, with their weights.",
        examples=["tyre_load = { wheel_load = 1 }"],
    )
    load_input: Annotated[str | None, TEXT] = Field(
        default=None, description="The force of load carrying.", examples=['load_input = "load"']
    )
    load_output: Annotated[str | None, TEXT] = Field(
        default=None, description="What it moves.", examples=['load_output = "body_displacement"']
    )


class SeatTable(Shape):
    """A seat with its occupant, on any vehicle."""

    mass: Annotated[float, positive("kg")] = Field(
        description="The occupant, with what moves along of the seat.", examples=['mass = "60 kg"']
    )
    network: Annotated[str, EXPRESSION] = Field(
        description="Between floor and occupant.", examples=['network = "ks | cs"']
    )
    place: Port | None = Field(
        default=None,
        min_length=1,
        description="Where it stands: coordinates with their levers.",
        examples=['place = { sprung = 1, pitch = "0.3 m" }'],
    )


class MechanismTable(Shape):
    """A vehicle of masses, levers, networks and roads."""

    model: Literal["mechanism"] = Field(description="The kind of vehicle.", examples=['model = "mechanism"'])
    coordinates: dict[
        PartName, Annotated[float, checked(inertia, lambda: quantity_schema("kg", "kg m^2", least="positive"))]
    ] = Field(
        min_length=1,
        description="What moves: each with its mass, or its moment of inertia.",
        examples=['a section [vehicle.coordinates] with lines such as body = "250 kg"'],
    )
    struts: dict[PartName, StrutTable] = Field(
        default_factory=dict,
        description="What is between two ports.",
        examples=["a section [vehicle.struts] with lines such as s = { upper = { body = 1 }, lower = { wheel = 1 } }"],
    )
    tyres: dict[PartName, TyreTable] = Field(
        default_factory=dict,
        description="What is between a port and a road.",
        examples=['a section [vehicle.tyres] with lines such as tyre = { port = { wheel = 1 }, road = "road" }'],
    )
    roads: dict[PartName, RoadPlace] = Field(
        default_factory=dict,
        description="Where the roads are met.",
        examples=['a section [vehicle.roads] with lines such as rear = { distance = "2.5 m" }'],
    )
    forces: dict[PartName, Port] = Field(
        default_factory=dict,
        description="External forces and moments, by where they act.",
        examples=["a section [vehicle.forces] with lines such as load = { body = 1 }"],
    )
    measures: MeasureTable = Field(
        default_factory=MeasureTable,
        description="Which outputs answer which index.",
        examples=["a section [vehicle.measures] with comfort = { body_acceleration = 1 }"],
    )
    seat: SeatTable | None = Field(
        default=None, description="A seat with its occupant.", examples=['a section [vehicle.seat] with mass = "60 kg"']
    )


def mechanism_shapes() -> Shapes:
    """The shapes of a mechanism's tables by place."""
    parts: dict[str, type[Shape]] = {"struts": StrutTable, "tyres": TyreTable, "roads": RoadPlace}
    inside: Shapes = {("vehicle", "<mechanism>", name, "*"): shape for name, shape in parts.items()}
    return {**inside, ("vehicle", "<mechanism>", "measures"): MeasureTable}


class Driving(dict[str, Any]):
    """A table [signal] with the units of inputs that only its vehicle knows: of None, if none is named."""

    def __init__(self, table: Mapping[str, Any], units: Mapping[str | None, str]) -> None:
        super().__init__(table)
        self.units = units


def forces_of(vehicle: Mapping[str, Any]) -> dict[str, str]:
    """The forces of a mechanism, with their units, from its table or what became of it."""
    forces, coordinates = (vehicle.get(part) for part in ("forces", "coordinates"))
    if not isinstance(forces, dict) or not isinstance(coordinates, dict):
        return {}
    angles = {name for name, entry in coordinates.items() if _is_angle(entry)}
    ports = {name: port for name, port in forces.items() if isinstance(port, dict)}
    return {name: "N m" if port and port.keys() <= angles else "N" for name, port in ports.items()}


def _is_angle(entry: Any) -> bool:
    try:
        return isinstance(entry if isinstance(entry, float) else inertia(entry), Inertia)
    except ValueError:  # told with the coordinate
        return False
