"""A mechanism: coordinates with masses, and networks mounted between ports and on roads.

Vertical up is positive. A port is a linear combination of coordinates, such as body height + lever x pitch; a strut's
may hold roads too, which are motions given from outside. A mounted network's elongation is the displacement of its
upper end less that of its lower end; its force is positive in tension.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from inerter.checks import check_positive, is_number
from inerter.errors import DesignError, MechanismError
from inerter.networks.elements import NAME, Element, Free, Inerter, Network, Tied, check_network, middle
from inerter.networks.transform import name_free_values, with_values

_SMALLEST, _LARGEST = 1e-12, 1e15  # of values in SI units, other than zero
Port = Mapping[str, float]
GROUND: Port = {}
GROUND_ACCELERATION = "ground_acceleration"  # the input of a mechanism on moving ground [m/s^2]
TRACKS = ("", "left", "right")


@dataclass(frozen=True)
class Coordinate:
    """A degree of freedom with its mass [kg], or its moment of inertia [kg m^2] if it is an angle [rad].

    Either may be free.
    """

    name: str
    inertia: float | Free
    angle: bool = False

    @property
    def element(self) -> Element:
        """Its inertia as an inerter to a place that has no acceleration."""
        return Inerter(self.inertia, self.name)

    @property
    def unit(self) -> str:
        """Of its inertia."""
        return "kg m^2" if self.angle else "kg"


@dataclass(frozen=True)
class Strut:
    """A network mounted between two ports of coordinates and roads; `GROUND` is the port that does not move."""

    name: str
    network: Network
    upper: Port
    lower: Port


@dataclass(frozen=True)
class Tyre:
    """A network between a port above and a road below."""

    name: str
    network: Network
    port: Port
    road: str


@dataclass(frozen=True)
class RoadInput:
    """Where the mechanism meets the road.

    It is `distance` [m] behind the first such place, so that the road arrives distance / speed later, and on the
    `track` "left" or "right", where there are two; on "" there is one.
    """

    name: str
    distance: float = 0.0
    track: str = ""


@dataclass(frozen=True)
class Force:
    """An external force [N] on a port, positive upwards (a moment [N m] if the port is an angle)."""

    name: str
    port: Port


@dataclass(frozen=True)
class Point:
    """A place that moves as a port does, with outputs of its own; an angle if that is what it measures."""

    name: str
    port: Port
    angle: bool = False


@dataclass(frozen=True)
class Weighted:
    """An output of the mechanism with the weight that brings it to the unit of an index."""

    output: str
    weight: float = 1.0


@dataclass(frozen=True)
class Measures:
    """Which outputs answer the questions that indices ask; empty where the mechanism has no answer."""

    comfort: tuple[Weighted, ...] = ()  # body accelerations [m/s^2 after weighting]
    tyre_load: tuple[Weighted, ...] = ()  # dynamic tyre forces [N]
    load_input: str | None = None  # the external force of the load-carrying index
    load_output: str | None = None  # the displacement that answers it


@dataclass(frozen=True)
class Mechanism:
    """Any number of coordinates, struts, tyres, roads and forces.

    Outputs that analysis may ask for, by name: `<coordinate>_displacement`, `_velocity`, `_acceleration`, so of points;
    `<tyre>_load`, `<tyre>_deflection`; `<strut>_force`, `<strut>_travel`; `<coordinate>_relative_displacement` and
    `_relative_velocity` are those over the ground, which are the same unless the ground moves.

    Raises `MechanismError` where a part names a coordinate or a road that is not there, where a mass is not positive,
    where names clash, and where a coordinate is attached to nothing; `DesignError` where one free name has two ranges.
    """

    coordinates: tuple[Coordinate, ...]
    struts: tuple[Strut, ...]
    tyres: tuple[Tyre, ...] = ()
    roads: tuple[RoadInput, ...] = ()
    forces: tuple[Force, ...] = ()
    measures: Measures = field(default_factory=Measures)
    points: tuple[Point, ...] = ()
    mirror: tuple[tuple[str, str], ...] = ()  # coordinates that are each other's image, or turn round: `half_of`
    still: tuple[Strut, ...] = ()  # struts that nothing moves and that are left out: their outputs are zero
    ground_moves: bool = False  # coordinates are then relative to it: see `on_moving_ground`

    def __post_init__(self) -> None:
        for name, kind in _KINDS.items():
            object.__setattr__(self, name, _parts(name, getattr(self, name), kind))
        if self.ground_moves:
            object.__setattr__(self, "forces", _with_ground(self.forces, self.coordinates))
        _check_measures(self.measures)
        _check_names(self)
        _check_numbers(self)
        _check_ports(self)
        _check_attached(self)
        masses = {c.name: c.element for c in self.coordinates if isinstance(c.inertia, Free)}
        named = name_free_values({**{mount.name: mount.network for mount in self.mounts()}, **masses})
        if masses:
            coordinates = (_with_inertia(c, named[c.name]) if c.name in masses else c for c in self.coordinates)
            object.__setattr__(self, "coordinates", tuple(coordinates))
        object.__setattr__(self, "struts", tuple(replace(s, network=named[s.name]) for s in self.struts))
        object.__setattr__(self, "tyres", tuple(replace(t, network=named[t.name]) for t in self.tyres))

    def mechanism(self) -> Mechanism:
        """Itself: a mechanism is a vehicle."""
        return self

    def on_moving_ground(self) -> Mechanism:
        """The same mechanism seen from ground that moves up with an acceleration, the input `GROUND_ACCELERATION`.

        Every mass feels it, m times as a force; roads lie still on the ground, and coordinates are relative to it.
        """
        if self.ground_moves:
            return self
        return replace(self, forces=(*self.forces, Force(GROUND_ACCELERATION, {})), ground_moves=True)

    def on_one_track(self) -> Mechanism:
        """The same mechanism with tyres that meet the road at once on one road, where it lies alike on both sides.

        What both sides share is then an input less, and how the road twists between axles no state.
        """
        held = {name for strut in self.struts for name in (*strut.upper, *strut.lower)}
        first: dict[float, str] = {}
        on = {r.name: r.name if r.name in held else first.setdefault(r.distance, r.name) for r in self.roads}
        if all(name == road for name, road in on.items()):
            return self
        tyres = tuple(replace(tyre, road=on[tyre.road]) for tyre in self.tyres)
        return replace(self, tyres=tyres, roads=tuple(road for road in self.roads if road.name in on.values()))

    def mounts(self) -> Iterator[Strut | Tyre]:
        """Struts, then tyres."""
        yield from self.struts
        yield from self.tyres

    def free_values(self) -> dict[str, Free]:
        """The free values by name: those of networks in the order in which they appear, then masses."""
        elements = (element for mount in self.mounts() for element in mount.network.elements())
        values = [*(element.value for element in elements), *(c.inertia for c in self.coordinates)]
        return {str(value.name): value for value in values if isinstance(value, Free)}

    def units(self) -> dict[str, str]:
        """The unit of each free value."""
        elements = (element for mount in self.mounts() for element in mount.network.elements())
        values = [*((e.value, e.unit) for e in elements), *((c.inertia, c.unit) for c in self.coordinates)]
        return {str(value.name): unit for value, unit in values if isinstance(value, Free)}

    def with_values(self, values: Mapping[str, float]) -> Mechanism:
        """The same mechanism with the named free values fixed.

        Raises `DesignError` for a name that is not a free value here.
        """
        check_known(values, self.free_values())
        return replace(
            self.with_masses(values),
            struts=tuple(replace(s, network=with_values(s.network, values)) for s in self.struts),
            tyres=tuple(replace(t, network=with_values(t.network, values)) for t in self.tyres),
        )

    def with_masses(self, values: Mapping[str, float]) -> Mechanism:
        """The same mechanism with those free masses fixed that are named; other names are passed over."""
        if not any(isinstance(c.inertia, Free) for c in self.coordinates):
            return self
        coordinates = tuple(_with_inertia(c, with_values(c.element, values)) for c in self.coordinates)
        return replace(self, coordinates=coordinates)


def _with_inertia(coordinate: Coordinate, element: Network) -> Coordinate:
    assert isinstance(element, Element)
    assert not isinstance(element.value, Tied)
    return replace(coordinate, inertia=element.value)


_KINDS: dict[str, type] = {
    "coordinates": Coordinate,
    "struts": Strut,
    "tyres": Tyre,
    "roads": RoadInput,
    "forces": Force,
    "points": Point,
}


def check_known(values: object, free_values: Mapping[str, Free]) -> None:
    """Raises `DesignError` unless `values` is a mapping whose every name is a free value."""
    if not isinstance(values, Mapping):
        raise DesignError(f"Expected values by name, such as {{'c': 3000.0}}, got {values!r}.")
    for name in values:
        if name not in free_values:
            known = ", ".join(free_values) or "none"
            raise DesignError(f"There is no free value named {name!r} in this design (free: {known}).")


def _parts(name: str, given: object, kind: type) -> tuple[object, ...]:
    parts = tuple(given) if isinstance(given, Iterable) and not isinstance(given, str) else (given,)
    for part in parts:
        if not isinstance(part, kind) or parts == (given,):
            raise MechanismError(f"The {name} of a mechanism are a tuple of {kind.__name__}(...), got {given!r}.")
    return parts


def _with_ground(forces: Iterable[Force], coordinates: Iterable[Coordinate]) -> tuple[Force, ...]:
    """The forces, that of the ground on the masses as they are now; one that is free is in the middle of its bounds."""
    masses = {c.name: -middle(c.inertia) for c in coordinates if not c.angle}
    return tuple(replace(f, port=masses) if f.name == GROUND_ACCELERATION else f for f in forces)


def check_quantity(what: str, value: object, unit: str) -> None:
    """Raises `MechanismError` unless `value` is positive, or free between positive bounds."""
    if not isinstance(value, Free):
        check_positive(MechanismError, what, value, unit)
    elif value.lower == 0.0:
        raise MechanismError(f"{what} must be positive, and its lower bound is 0 {unit}. Give a small positive bound.")


def _check_measures(measures: object) -> None:
    if not isinstance(measures, Measures):
        raise MechanismError(f"The measures of a mechanism are Measures(...), got {measures!r}.")
    if not isinstance(measures.comfort, tuple) or not isinstance(measures.tyre_load, tuple):
        raise MechanismError(f"The outputs of measures are tuples of Weighted(...), got {measures!r}.")
    for output in (*measures.comfort, *measures.tyre_load):
        if not isinstance(output, Weighted) or not isinstance(output.output, str) or not is_number(output.weight):
            raise MechanismError(f"A measure is Weighted(output name, number), got {output!r}.")


def _check_names(mechanism: Mechanism) -> None:
    seen: set[str] = set()
    parts: tuple[Coordinate | Strut | Tyre | RoadInput | Force | Point, ...] = (
        *mechanism.coordinates,
        *mechanism.struts,
        *mechanism.tyres,
        *mechanism.roads,
        *mechanism.forces,
        *mechanism.points,
    )
    for part in parts:
        kind = type(part).__name__
        if not isinstance(part.name, str) or not NAME.fullmatch(part.name):
            raise MechanismError(
                f"The name of a {kind} is a letter followed by letters, digits and underscores, got {part.name!r}."
            )
        if part.name in seen:
            raise MechanismError(f"Two parts of the mechanism are named {part.name!r}. Give each its own name.")
        seen.add(part.name)
    for mount in mechanism.mounts():
        check_network(mount.network)


def _check_numbers(mechanism: Mechanism) -> None:
    if not mechanism.coordinates and not (mechanism.roads and mechanism.struts):
        raise MechanismError("A mechanism needs at least one coordinate with a mass, or a strut that a road moves.")
    for coordinate in mechanism.coordinates:
        what = "Moment of inertia" if coordinate.angle else "Mass"
        check_quantity(f"{what} of {coordinate.name!r}", coordinate.inertia, coordinate.unit)
    for road in mechanism.roads:
        if not is_number(road.distance) or road.distance < 0.0:
            raise MechanismError(
                f"The distance of road {road.name!r} behind the first one must be zero or more metres, "
                f"got {road.distance!r}. Measure from the foremost axle."
            )
        if road.track not in TRACKS:
            raise MechanismError(
                f'The track of road {road.name!r} is "left" or "right", or "" where there is but one, '
                f"got {road.track!r}."
            )


def _check_ports(mechanism: Mechanism) -> None:
    coordinates = {c.name for c in mechanism.coordinates}
    roads = {r.name for r in mechanism.roads}
    ports = [(f"strut {s.name!r}", p, coordinates | roads) for s in mechanism.struts for p in (s.upper, s.lower)]
    ports += [(f"tyre {t.name!r}", t.port, coordinates) for t in mechanism.tyres]
    ports += [(f"force {f.name!r}", f.port, coordinates) for f in mechanism.forces]
    ports += [(f"point {p.name!r}", p.port, coordinates) for p in mechanism.points]
    for where, port, may_hold in ports:
        if not isinstance(port, Mapping):
            raise MechanismError(f"The port of {where} maps coordinates to levers, as {{'body': 1.0}}; got {port!r}.")
        for name, lever in port.items():
            if name not in may_hold:
                known = ", ".join(sorted(coordinates)) or "none"
                raise MechanismError(f"The {where} is at {name!r}, which is not a coordinate (coordinates: {known}).")
            if not is_number(lever):
                raise MechanismError(f"The lever of {name!r} in {where} must be a finite number, got {lever!r}.")
    for strut in mechanism.struts:
        if _travel(strut) == {}:
            raise MechanismError(f"Both ends of strut {strut.name!r} are at the same port: it can never move.")
    for tyre in mechanism.tyres:
        if tyre.road not in roads:
            known = ", ".join(sorted(roads)) or "none"
            raise MechanismError(f"Tyre {tyre.name!r} stands on {tyre.road!r}, which is not a road (roads: {known}).")


def check_values(mechanism: Mechanism) -> None:
    """Raises `MechanismError` for an element or inertia that is so small or large that others are lost beside it."""
    for mount in mechanism.mounts():
        for element in mount.network.elements():
            if not isinstance(element.value, Free | Tied):
                _check_size("value", element.label, element.value, element.unit)
    for coordinate in mechanism.coordinates:
        if not isinstance(coordinate.inertia, Free):
            _check_size("inertia", coordinate.name, coordinate.inertia, coordinate.unit)


def _check_size(what: str, of: str, value: float, unit: str) -> None:
    if value != 0.0 and not _SMALLEST <= value <= _LARGEST:
        raise MechanismError(
            f"The {what} of {of!r} is {value:g} {unit}, and numbers of 16 digits can only be computed with from "
            f"{_SMALLEST:g} to {_LARGEST:g} {unit}. Leave out what is so small, and join rigidly what is so stiff."
        )


def _travel(strut: Strut) -> dict[str, float]:
    names = {*strut.upper, *strut.lower}
    travel = {name: strut.upper.get(name, 0.0) - strut.lower.get(name, 0.0) for name in names}
    return {name: lever for name, lever in travel.items() if lever != 0.0}


def _check_attached(mechanism: Mechanism) -> None:
    held = {name for strut in mechanism.struts for name in _travel(strut)}
    held |= {name for tyre in mechanism.tyres for name, lever in tyre.port.items() if lever != 0.0}
    for coordinate in mechanism.coordinates:
        if coordinate.name not in held:
            raise MechanismError(
                f"Coordinate {coordinate.name!r} is held by nothing: no strut or tyre is mounted on it. "
                f"Mount one, or leave the coordinate out."
            )
