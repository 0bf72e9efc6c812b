"""A mechanism: coordinates with masses, and networks mounted between ports and on roads.

Vertical up is positive. A port is a linear combination of coordinates, such as body height + lever arm x pitch; that of
a strut may include roads too, which are prescribed motions. The elongation of a mounted network is the displacement of
its upper end minus that of its lower end; its force is positive in tension.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import chain

from inerter.deprecation import RenamedAttribute, renamed_keywords
from inerter.errors import DesignError, MechanismError
from inerter.formatting import format_number, format_quantity, format_range
from inerter.networks.elements import NAME, Element, Free, Inerter, Network, Tied, check_network, middle
from inerter.networks.transform import check_named_apart, name_free_values, with_values
from inerter.notebook import shown_by
from inerter.validation import check_positive, is_listed, is_number, use_python_numbers

SMALLEST, LARGEST = 1e-12, 1e15  # of values in SI units, other than zero
_ROUNDING, _SHORTEST = 1e-13, 1e-8  # of lever arms of a coordinate, over its longest: a zero, and what is told from one
Port = Mapping[str, float]
GROUND: Port = {}
GROUND_ACCELERATION = "ground_acceleration"  # the input of a mechanism on moving ground [m/s^2]
TRACKS = ("", "left", "right")


@dataclass(frozen=True)
class Coordinate:
    """A degree of freedom with its mass [kg], or its moment of inertia [kg m^2] if it is an angle [rad].

    Either may be free. 0 is a node without mass, at which networks meet: its displacement and velocity follow from the
    balance of their forces, and its acceleration is no output.

    >>> import inerter as it
    >>> body, pitch = it.Coordinate("body", 900.0), it.Coordinate("pitch", 1400.0, angle=True)
    >>> body.unit, pitch.unit
    ('kg', 'kg m^2')
    """

    name: str
    inertia: float | Free
    angle: bool = False

    def __post_init__(self) -> None:
        use_python_numbers(self)

    @property
    def element(self) -> Element:
        """The inertia as an inerter to a point without acceleration; there is none for a node without mass."""
        return Inerter(self.inertia, self.name)

    @property
    def is_massless(self) -> bool:
        """Whether it is a node without mass."""
        return self.inertia == 0.0

    @property
    def coefficient(self) -> float:
        """Mass or moment of inertia; raises `DesignError` if it is free."""
        return 0.0 if self.is_massless else self.element.coefficient

    @property
    def unit(self) -> str:
        """Unit of the inertia."""
        return "kg m^2" if self.angle else "kg"


@dataclass(frozen=True)
class Strut:
    """A network mounted between two ports of coordinates and roads; `GROUND` is the fixed port.

    >>> import inerter as it
    >>> front = it.Strut("front", it.Spring(20e3), upper={"body": 1.0, "pitch": 1.2}, lower={"wheel": 1.0})
    >>> front.upper["pitch"]  # lever arm [m]
    1.2
    """

    name: str
    network: Network
    upper: Port
    lower: Port

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True)
class Tyre:
    """A network between a port above and a road below.

    >>> import inerter as it
    >>> tyre = it.Tyre("tyre", it.Spring(180e3), port={"wheel": 1.0}, road="road")
    >>> tyre.network.stiffness  # N/m
    180000.0
    """

    name: str
    network: Network
    port: Port
    road: str

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True)
class RoadInput:
    """A road input of the mechanism.

    It acts `distance` [m] behind the first one, with a delay of distance / speed, on the `side` "left" or "right", or
    "" for a single track.

    >>> import inerter as it
    >>> rear = it.RoadInput("road_rear", distance=2.7, side="left")  # m behind the first
    >>> rear.distance / 27.0  # s later at 27 m/s
    0.1
    """

    name: str
    distance: float = 0.0
    side: str = ""
    track = RenamedAttribute("side")

    def __post_init__(self) -> None:
        use_python_numbers(self)


RoadInput.__init__ = renamed_keywords(track="side")(RoadInput.__init__)  # type: ignore[method-assign]


@dataclass(frozen=True)
class Force:
    """An external force [N] on a port, positive upwards (a moment [N m] if the port is an angle).

    >>> import inerter as it
    >>> it.Force("gust", {"body": 1.0, "pitch": 0.4}).port["pitch"]  # 0.4 m ahead of the centre of mass
    0.4
    """

    name: str
    port: Port

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True)
class TrackedPoint:
    """A tracked point that moves with a port, with its own outputs; an angle if `angle` is true.

    >>> import inerter as it
    >>> nose = it.TrackedPoint("nose", {"body": 1.0, "pitch": 2.1})  # output nose_acceleration
    >>> nose.port["pitch"]
    2.1
    """

    name: str
    port: Port
    angle: bool = False

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True)
class OutputWeight:
    """An output of the mechanism with a weight that converts it to the unit of an index.

    >>> import inerter as it
    >>> it.OutputWeight("pitch_acceleration", weight=1.02)  # m: the acceleration 1.02 m from the centre
    OutputWeight(output='pitch_acceleration', weight=1.02)
    """

    output: str
    weight: float = 1.0

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True)
class PerformanceOutputs:
    """Performance outputs of each index; empty where the mechanism has none; tyre loads are by default those of all.

    >>> import inerter as it
    >>> outputs = it.PerformanceOutputs(tyre_load=())
    >>> outputs.comfort  # none: RideComfort is refused, and so is TyreLoad
    ()
    """

    comfort: tuple[OutputWeight, ...] = ()  # body accelerations [m/s^2 after weighting]
    tyre_load: tuple[OutputWeight, ...] | None = None  # dynamic tyre forces [N]; None: of all tyres
    load_input: str | None = None  # the external force of the load-carrying index
    load_output: str | None = None  # the displacement under that force


@dataclass(frozen=True)
class Mechanism:
    """Any number of coordinates, struts, tyres, roads and forces; `measures` are the outputs of each index.

    `points` have outputs of their own. `mirror`, `still`, `twins` and `ground_moves` are set by `symmetric_half` and
    `on_moving_ground`.

    Outputs by name: `<coordinate>_displacement`, `_velocity`, `_acceleration`, also of points; `<tyre>_load`,
    `<tyre>_deflection`; `<strut>_force`, `<strut>_travel`; `<coordinate>_relative_displacement` and
    `_relative_velocity` are relative to the ground, and equal to the absolute ones unless the ground moves.

    Raises `MechanismError` for unknown coordinates or roads, negative masses, duplicate names, and unconstrained
    coordinates; `DesignError` where one free name has two ranges.

    >>> import inerter as it
    >>> strut = it.Strut("strut", it.Spring(400.0) | it.Damper(4.0), upper={"mass": 1.0}, lower=it.GROUND)
    >>> oscillator = it.Mechanism(
    ...     coordinates=(it.Coordinate("mass", 1.0),), struts=(strut,), forces=(it.Force("push", {"mass": 1.0}),)
    ... )
    >>> it.state_space(oscillator).outputs
    ('mass_displacement', 'mass_velocity', 'mass_acceleration', 'strut_force', 'strut_travel')
    """

    coordinates: tuple[Coordinate, ...]
    struts: tuple[Strut, ...]
    tyres: tuple[Tyre, ...] = ()
    roads: tuple[RoadInput, ...] = ()
    forces: tuple[Force, ...] = ()
    measures: PerformanceOutputs = field(default_factory=PerformanceOutputs)
    points: tuple[TrackedPoint, ...] = ()
    mirror: tuple[tuple[str, str], ...] = ()  # mirrored pairs of coordinates, or antisymmetric ones: see `half_of`
    still: tuple[Strut, ...] = ()  # struts at rest, which are left out: their outputs are zero
    twins: tuple[tuple[str, str], ...] = ()  # a mount and the one before it that has its network and moves alike
    ground_moves: bool = False  # coordinates are relative to the ground then: see `on_moving_ground`

    _repr_svg_ = shown_by("inerter.figures.plots.network:design_svg")

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
        if not self.open_values:
            return
        del self.__dict__["open_values"]  # since what has no name gets one
        masses = {c.name: c.element for c in self.coordinates if isinstance(c.inertia, Free)}
        named = name_free_values({**{mount.name: mount.network for mount in self.mounts()}, **masses})
        if masses:
            coordinates = (_with_inertia(c, named[c.name]) if c.name in masses else c for c in self.coordinates)
            object.__setattr__(self, "coordinates", tuple(coordinates))
        if any(named[mount.name] is not mount.network for mount in self.mounts()):
            object.__setattr__(self, "struts", tuple(replace(s, network=named[s.name]) for s in self.struts))
            object.__setattr__(self, "tyres", tuple(replace(t, network=named[t.name]) for t in self.tyres))
        if masses:
            names = {c.name for c in self.masses.values() if isinstance(c.inertia, Free) and c.inertia.name == c.name}
            check_named_apart(names, (mount.network for mount in self.mounts()), "the mass of a coordinate")

    def mechanism(self) -> Mechanism:
        """The mechanism itself, since a mechanism is a vehicle."""
        return self

    def on_moving_ground(self) -> Mechanism:
        """The mechanism in relative coordinates under base excitation, the input `GROUND_ACCELERATION` (up positive).

        Each mass m is loaded by m times the acceleration; roads are fixed to the ground.
        """
        if self.ground_moves:
            return self
        return replace(self, forces=(*self.forces, Force(GROUND_ACCELERATION, {})), ground_moves=True)

    def on_one_track(self) -> Mechanism:
        """The mechanism on a single track: tyres at the same distance share one road input.

        This removes inputs, and states for the twist of the road between axles.
        """
        if len(self.roads) < 2:
            return self
        held = {name for strut in self.struts for name in (*strut.upper, *strut.lower)}
        first: dict[float, str] = {}
        on = {r.name: r.name if r.name in held else first.setdefault(r.distance, r.name) for r in self.roads}
        if all(name == road for name, road in on.items()):
            return self
        tyres = tuple(replace(tyre, road=on[tyre.road]) for tyre in self.tyres)
        return replace(self, tyres=tyres, roads=tuple(road for road in self.roads if road.name in on.values()))

    @property
    def tyre_loads(self) -> tuple[OutputWeight, ...]:
        """Outputs of the dynamic tyre load, those of all tyres unless `measures` names some."""
        given = self.measures.tyre_load
        return tuple(OutputWeight(f"{tyre.name}_load") for tyre in self.tyres) if given is None else given

    @property
    def masses(self) -> dict[int, Coordinate]:
        """Coordinates with inertia, by their numbers."""
        return {i: c for i, c in enumerate(self.coordinates) if not c.is_massless}

    def mounts(self) -> Iterator[Strut | Tyre]:
        """The struts, then the tyres."""
        return chain(self.struts, self.tyres)

    def elements(self) -> Iterator[Element]:
        """The elements of the struts, then of the tyres."""
        return (element for mount in self.mounts() for element in mount.network.elements())

    def strut_elements(self) -> list[Element]:
        """The elements of the struts."""
        return [element for strut in self.struts for element in strut.network.elements()]

    @cached_property
    def open_values(self) -> list[Free | Tied]:
        """Values that are no numbers: those of networks in order of appearance, then masses."""
        values = [element.value for mount in self.mounts() for element in mount.network.elements()]
        values += [coordinate.inertia for coordinate in self.coordinates]
        return [value for value in values if isinstance(value, (Free, Tied))]

    def free_values(self) -> dict[str, Free]:
        """Free values by name: those of networks in order of appearance, then masses."""
        return {str(value.name): value for value in self.open_values if isinstance(value, Free)}

    def units(self) -> dict[str, str]:
        """The unit of each free value."""
        values = [*((e.value, e.unit) for e in self.elements()), *((c.inertia, c.unit) for c in self.coordinates)]
        return {str(value.name): unit for value, unit in values if isinstance(value, Free)}

    def with_values(self, values: Mapping[str, float]) -> Mechanism:
        """The same mechanism with the named free values fixed.

        Raises `DesignError` for a name that is not a free value here.
        """
        check_known(values, self.free_values())
        return self.with_masses(values).with_networks(lambda mount: with_values(mount.network, values))

    def with_networks(self, change: Callable[[Strut | Tyre], Network]) -> Mechanism:
        """The same mechanism with the network `change(mount)` in each strut and tyre."""
        return replace(
            self,
            struts=tuple(replace(strut, network=change(strut)) for strut in self.struts),
            tyres=tuple(replace(tyre, network=change(tyre)) for tyre in self.tyres),
        )

    def with_masses(self, values: Mapping[str, float]) -> Mechanism:
        """The same mechanism with the named free masses fixed; other names are ignored."""
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
    "points": TrackedPoint,
}


def check_known(values: object, free_values: Mapping[str, Free]) -> None:
    """Raise `DesignError` unless `values` is a mapping of names of free values."""
    if not isinstance(values, Mapping):
        raise DesignError(f"Expected values by name, such as {{'c': 3000.0}}, got {values!r}.")
    for name in values:
        if name not in free_values:
            known = ", ".join(free_values) or "none"
            raise DesignError(f"unknown free value {name!r}; free values of this design: {known}.")


def _parts(name: str, given: object, kind: type) -> tuple[object, ...]:
    if is_listed(given):
        parts = tuple(given)
        if all(isinstance(part, kind) for part in parts):
            return parts
    raise MechanismError(f"The {name} of a mechanism must be a tuple of {kind.__name__}(...), got {given!r}.")


def _with_ground(forces: Iterable[Force], coordinates: Iterable[Coordinate]) -> tuple[Force, ...]:
    """The forces, with that of the ground on the present masses; a free mass is at the middle of its bounds."""
    masses = {c.name: -middle(c.inertia) for c in coordinates if not c.angle}
    return tuple(replace(f, port=masses) if f.name == GROUND_ACCELERATION else f for f in forces)


def check_quantity(what: str, value: object, unit: str) -> None:
    """Raise `MechanismError` unless `value` is positive, or free between positive bounds."""
    if not isinstance(value, Free):
        check_positive(MechanismError, what, value, unit)
    elif value.lower == 0.0:
        raise MechanismError(f"{what} must be positive, and its lower bound is 0 {unit}. Give a small positive bound.")


def _check_measures(measures: object) -> None:
    if not isinstance(measures, PerformanceOutputs):
        raise MechanismError(f"The measures of a mechanism must be PerformanceOutputs(...), got {measures!r}.")
    loads = () if measures.tyre_load is None else measures.tyre_load
    if not isinstance(measures.comfort, tuple) or not isinstance(loads, tuple):
        raise MechanismError(f"The outputs of measures must be tuples of OutputWeight(...), got {measures!r}.")
    for output in (*measures.comfort, *loads):
        if not isinstance(output, OutputWeight) or not isinstance(output.output, str) or not is_number(output.weight):
            raise MechanismError(f"A measure must be OutputWeight(output name, number), got {output!r}.")


_is_name = lru_cache(maxsize=1024)(NAME.fullmatch)


def _check_names(mechanism: Mechanism) -> None:
    seen: set[str] = set()
    parts: tuple[Coordinate | Strut | Tyre | RoadInput | Force | TrackedPoint, ...] = (
        *mechanism.coordinates,
        *mechanism.struts,
        *mechanism.tyres,
        *mechanism.roads,
        *mechanism.forces,
        *mechanism.points,
    )
    for part in parts:
        name = part.name
        if not isinstance(name, str) or not _is_name(name):
            raise MechanismError(
                f"The name of a {type(part).__name__} must be a letter followed by letters, digits and underscores, "
                f"got {name!r}."
            )
        if name in seen:
            raise MechanismError(f"Duplicate name {name!r} in the mechanism. Give each part a unique name.")
        seen.add(name)
    for mount in mechanism.mounts():
        check_network(mount.network)


def _check_numbers(mechanism: Mechanism) -> None:
    if not mechanism.coordinates and not (mechanism.roads and mechanism.struts):
        raise MechanismError("A mechanism requires at least one coordinate with a mass, or a strut on a road.")
    for coordinate in mechanism.coordinates:
        what = "Moment of inertia" if coordinate.angle else "Mass"
        if not coordinate.is_massless:
            check_quantity(f"{what} of {coordinate.name!r}", coordinate.inertia, coordinate.unit)
    for road in mechanism.roads:
        if not is_number(road.distance) or road.distance < 0.0:
            raise MechanismError(
                f"The distance of road {road.name!r} behind the first one must be zero or more metres, "
                f"got {road.distance!r}. Measure from the foremost axle."
            )
        if road.side not in TRACKS:
            raise MechanismError(
                f'The side of road {road.name!r} must be "left" or "right", or "" for a single track, '
                f"got {road.side!r}."
            )


def _check_ports(mechanism: Mechanism) -> None:
    coordinates = {c.name for c in mechanism.coordinates}
    roads = {r.name for r in mechanism.roads}
    of_struts = coordinates | roads
    ports = [("strut", s.name, p, of_struts) for s in mechanism.struts for p in (s.upper, s.lower)]
    ports += [("tyre", t.name, t.port, coordinates) for t in mechanism.tyres]
    ports += [("force", f.name, f.port, coordinates) for f in mechanism.forces]
    ports += [("point", p.name, p.port, coordinates) for p in mechanism.points]
    for kind, of, port, may_hold in ports:
        if type(port) is not dict and not isinstance(port, Mapping):
            raise MechanismError(
                f"The port of {kind} {of!r} must map coordinates to lever arms, as {{'body': 1.0}}; got {port!r}."
            )
        for name, lever in port.items():
            if name not in may_hold:
                known = ", ".join(sorted(coordinates)) or "none"
                raise MechanismError(f"{kind} {of!r}: unknown coordinate {name!r}; available: {known}.")
            if not is_number(lever):
                raise MechanismError(
                    f"The lever arm of {name!r} in {kind} {of!r} must be a finite number, got {lever!r}."
                )
    _check_levers([(kind, of, port) for kind, of, port, _ in ports if of != GROUND_ACCELERATION])
    for tyre in mechanism.tyres:
        if tyre.road not in roads:
            known = ", ".join(sorted(roads)) or "none"
            raise MechanismError(f"tyre {tyre.name!r}: unknown road {tyre.road!r}; available: {known}.")


def _check_levers(ports: Sequence[tuple[str, str, Port]]) -> None:
    """Raise `MechanismError` for a lever arm so short that analyses would take it for zero, other than by rounding.

    It is compared with those of struts and tyres, as forces and points have no part in the dependence of travels.
    """
    sizes = [abs(lever) for _, _, port in ports for lever in port.values() if lever]
    if not sizes or min(sizes) >= _SHORTEST * max(sizes):  # as nearly always
        return
    longest: dict[str, float] = {}
    for kind, _, port in ports:
        if kind in ("strut", "tyre"):
            for name, lever in port.items():
                longest[name] = max(abs(lever), longest.get(name, 0.0))
    for kind, of, port in ports:
        for name, lever in port.items():
            most = longest.get(name, 0.0)
            if _ROUNDING * most < abs(lever) < _SHORTEST * most:
                raise MechanismError(
                    f"The lever arm of {name!r} in {kind} {of!r} is {format_number(lever)}, less than "
                    f"{format_number(_SHORTEST)} of its longest one, {format_number(most)}, and would be lost. "
                    f"Give lever arms within eight decades, or 0."
                )


def check_values(mechanism: Mechanism) -> None:
    """Raise `MechanismError` for an element or inertia too small or large for double precision."""
    for mount in mechanism.mounts():
        for element in mount.network.elements():
            if not (isinstance(element.value, Free | Tied) or _has_size(element.value)):
                large = "Replace such a large element by a rigid joint."
                raise _size_error(f"value of {element.label!r}", element.value, element.unit, "element", large)
    for coordinate in mechanism.coordinates:
        if not (isinstance(coordinate.inertia, Free) or _has_size(coordinate.inertia)):
            large = "Fix such a heavy body to the ground."
            raise _size_error(f"inertia of {coordinate.name!r}", coordinate.inertia, coordinate.unit, "inertia", large)


def _has_size(value: float) -> bool:
    """Whether a value is zero, or of a size that double precision supports."""
    return value == 0.0 or SMALLEST <= value <= LARGEST


def _size_error(what: str, value: float, unit: str, kind: str, if_large: str) -> MechanismError:
    remedy = f"Omit such a small {kind}." if value < SMALLEST else if_large
    return MechanismError(
        f"The {what} is {format_quantity(value, unit, 6)}; double precision supports "
        f"{format_range(SMALLEST, LARGEST, unit)}. {remedy}"
    )


def _travel(strut: Strut) -> dict[str, float]:
    names = {*strut.upper, *strut.lower}
    travel = {name: strut.upper.get(name, 0.0) - strut.lower.get(name, 0.0) for name in names}
    return {name: lever for name, lever in travel.items() if lever != 0.0}


def _check_attached(mechanism: Mechanism) -> None:
    held = {name for tyre in mechanism.tyres for name, lever in tyre.port.items() if lever != 0.0}
    for strut in mechanism.struts:
        travel = _travel(strut)
        if not travel:
            raise MechanismError(f"Both ends of strut {strut.name!r} are at the same port, so its travel is zero.")
        held.update(travel)
    for coordinate in mechanism.coordinates:
        if coordinate.name not in held:
            raise MechanismError(
                f"Coordinate {coordinate.name!r} is unconstrained: no strut or tyre is mounted on it. "
                f"Mount one, or leave the coordinate out."
            )
