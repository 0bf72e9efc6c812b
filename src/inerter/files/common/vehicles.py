"""Vehicle of a table [vehicle]: the mounts that layouts fill, the vehicle with its networks, and its problems.

The table has the model and its values: quantities by their keys or, of a mechanism, the tables of its parts; and
perhaps the table of a seat.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from inerter.errors import InerterError, MechanismError
from inerter.field_metadata import fields_of, mounts_of, needed_mounts_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.common.vehicle_tables import MECHANISM, SEAT, SEAT_MASS, Length, forces_of, is_angle
from inerter.formatting import format_number, format_quantity, format_range, in_words
from inerter.networks.elements import Damper, Free, Network, Spring
from inerter.units import quote_value
from inerter.vehicle.mechanism import (
    GROUND_ACCELERATION,
    Coordinate,
    Force,
    Mechanism,
    OutputWeight,
    PerformanceOutputs,
    Port,
    RoadInput,
    Strut,
    Tyre,
)
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.rig import Rig
from inerter.vehicle.seat import Seat
from inerter.vehicle.vehicle import Vehicle

VehicleTable = Mapping[str, Any]
Networks = Mapping[str, Network]
_GROUND = {GROUND_ACCELERATION: "m/s^2"}
_ANY: Network = Spring(1.0) | Damper(1.0)  # where it does not matter what is mounted


@dataclass(frozen=True)
class MountEntry:
    """A place for a network: whether every layout has to fill it, and the network if the vehicle says it itself."""

    needed: bool = True
    network: str | None = None


def models() -> tuple[str, ...]:
    """All models that files know."""
    return (*VEHICLES, MECHANISM)


def mounts(table: VehicleTable) -> dict[str, MountEntry]:
    """Mounts that layouts fill, by name; a seat last."""
    if table["model"] == MECHANISM:
        parts = {**table["struts"], **table["tyres"]}
        own = {name: MountEntry(part["network"] is None, part["network"]) for name, part in parts.items()}
    else:
        kind = VEHICLES[table["model"]]
        needed = needed_mounts_of(kind)
        own = {name: MountEntry(needed=name in needed) for name in mounts_of(kind)}
    seat = {SEAT: MountEntry(needed=False, network=table[SEAT]["network"])} if SEAT in table else {}
    return {**own, **seat}


def build_vehicle(table: VehicleTable, networks: Networks) -> Vehicle:
    """The vehicle with these networks in its mounts."""
    if SEAT in table:
        seat = table[SEAT]
        vehicle = build_vehicle(_without_seat(table), {name: n for name, n in networks.items() if name != SEAT})
        place = {} if seat["place"] is None else {"place": _floats(seat["place"])}
        return Seat(vehicle, seat["mass"], networks[SEAT], **place)
    if table["model"] == MECHANISM:
        return _mechanism(table, networks)
    values = {name: value for name, value in table.items() if name != "model"}
    return VEHICLES[table["model"]](**values, **networks)


def vehicle_words(table: VehicleTable) -> Iterator[tuple[str, float | None, str]]:
    """Name, value and unit of each quantity of a vehicle, or name, None and a text, for reports."""
    yield from _mechanism_words(table) if table["model"] == MECHANISM else _words_of(VEHICLES[table["model"]], table)
    if SEAT in table:
        yield from ((SEAT_MASS, value, unit) for _, value, unit in _words_of(Seat, table[SEAT]))
        yield "seat mounted at", None, _place(table[SEAT]["place"] or {"sprung": 1.0})


def _words_of(kind: Any, values: Mapping[str, Any]) -> Iterator[tuple[str, float | None, str]]:
    """Name, value and unit of each quantity that a dataclass declares and that is not zero."""
    for field in fields_of(kind):
        value = values[field.key]
        if value != 0.0:
            yield _in_words(field.in_words, value, field.unit)


def _in_words(name: str, value: float | Free, unit: str) -> tuple[str, float | None, str]:
    """Name, value and unit; or name, None and the text of a range."""
    if isinstance(value, Free):
        return name, None, f"free, {format_range(value.lower, value.upper, unit, 12)}"
    return name, value, unit


def vehicle_problems(table: VehicleTable) -> Iterator[Problem]:
    """Problems of a vehicle that do not depend on its networks."""
    own = mounts(_without_seat(table))
    if SEAT in table and SEAT in own:
        yield at(("vehicle", "struts", SEAT), fault="there is a seat in [vehicle.seat] too", expected="another name")
        return
    problems = list(_mechanism_problems(table)) if table["model"] == MECHANISM else []
    yield from problems
    if SEAT in table and not problems:
        place = table[SEAT]["place"] or {"sprung": 1.0}
        car = build_vehicle(_without_seat(table), dict.fromkeys(own, _ANY))
        known = {c.name: c.angle for c in car.mechanism().coordinates}
        yield from _port_problems(("vehicle", SEAT, "place"), place, known, ())


def inputs(table: VehicleTable) -> dict[str, str]:
    """Inputs that a signal may excite, with the unit of each; the default input first."""
    if table["model"] == MECHANISM:
        forces, has_mass = forces_of(table), not all(map(is_angle, table["coordinates"].values()))
        ground = _GROUND if has_mass and GROUND_ACCELERATION not in forces else {}
        return {**({"road": "m"} if table["roads"] else {}), **forces, **ground}
    kind = VEHICLES[table["model"]]
    return {kind.moved: "m", **kind.forces, **({} if kind is Rig else _GROUND)}


def tracks(table: VehicleTable) -> dict[str, str] | None:
    """Track of each road of the vehicle, empty for a single one; None if the vehicle cannot be built."""
    if any(vehicle_problems(table)):
        return None
    own = _without_seat(table)
    try:
        roads = build_vehicle(own, dict.fromkeys(mounts(own), _ANY)).mechanism().roads
    except InerterError:
        return None
    return {road.name: road.side for road in roads}


def _without_seat(table: VehicleTable) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key != SEAT}


def _mechanism(table: VehicleTable, networks: Networks) -> Mechanism:
    """Mechanism of the tables of its parts."""
    given = table["measures"]
    loads = given["tyre_load"]
    ends = {n: (_floats(s["upper"]), _floats(s["lower"])) for n, s in table["struts"].items()}
    return Mechanism(
        tuple(Coordinate(name, one.value, is_angle(one)) for name, one in table["coordinates"].items()),
        tuple(Strut(name, networks[name], upper, lower) for name, (upper, lower) in ends.items()),
        tuple(Tyre(n, networks[n], _floats(t["port"]), t["road"]) for n, t in table["tyres"].items()),
        tuple(RoadInput(name, road["distance"], road["track"]) for name, road in table["roads"].items()),
        tuple(Force(name, _floats(port)) for name, port in table["forces"].items()),
        PerformanceOutputs(
            tuple(OutputWeight(output, float(weight)) for output, weight in given["comfort"].items()),
            None if loads is None else tuple(OutputWeight(output, float(weight)) for output, weight in loads.items()),
            given["load_input"],
            given["load_output"],
        ),
    )


def _mechanism_words(table: VehicleTable) -> Iterator[tuple[str, float | None, str]]:
    for name, (unit, value) in table["coordinates"].items():
        yield _in_words(in_words(name), value, unit)
    for name, strut in table["struts"].items():
        yield f"strut {name}", None, f"{_place(strut['upper'])} over {_place(strut['lower'])}"
    for name, tyre in table["tyres"].items():
        yield f"tyre {name}", None, f"{_place(tyre['port'])} over {tyre['road']}"
    for name, road in table["roads"].items():
        side = f", on the {road['track']}" if road["track"] else ""
        yield f"road {name}", None, f"{format_quantity(road['distance'], 'm')} behind the first{side}"
    for name, port in table["forces"].items():
        yield f"force {name}", None, f"on {_place(port)}"


def _mechanism_problems(table: VehicleTable) -> Iterator[Problem]:
    known = {name: is_angle(inertia) for name, inertia in table["coordinates"].items()}
    roads = tuple(table["roads"])
    found: list[Problem] = []
    for name, strut in table["struts"].items():
        for end in ("upper", "lower"):
            found += _port_problems(("vehicle", "struts", name, end), strut[end], known, roads)
    for name, tyre in table["tyres"].items():
        found += _port_problems(("vehicle", "tyres", name, "port"), tyre["port"], known, ())
        if tyre["road"] not in roads:
            hint = nearest(tyre["road"], roads)
            wanted = f"a road, one of {some(roads) or 'none'}"
            found.append(
                at(("vehicle", "tyres", name, "road"), got=quote_value(tyre["road"]), expected=wanted, hint=hint)
            )
    for name, port in table["forces"].items():
        found += _port_problems(("vehicle", "forces", name), port, known, ())
    if not found:
        try:
            _mechanism(table, dict.fromkeys(mounts(_without_seat(table)), _ANY))
        except MechanismError as error:
            found.append(at(("vehicle",), str(error)))
    yield from found


def _port_problems(
    place: tuple[str, ...], port: Mapping[str, float], known: Mapping[str, bool], roads: tuple[str, ...]
) -> Iterator[Problem]:
    """Names in a port that are not there, and levers of the wrong kind; `known` says what is an angle."""
    for name, lever in port.items():
        if name not in known and name not in roads:
            hint = nearest(name, (*known, *roads))
            yield at((*place, name), fault="not a coordinate", expected=f"one of {some((*known, *roads))}", hint=hint)
        elif known.get(name, False) and not isinstance(lever, Length):
            expected = f'the lever as a length, such as "{format_quantity(lever, "m")}"'
            yield at((*place, name), got=format_number(lever), fault=f"{name} is an angle", expected=expected)
        elif not known.get(name, False) and isinstance(lever, Length):
            got = f'"{format_quantity(lever, "m")}"'
            yield at((*place, name), got=got, fault=f"{name} is no angle", expected="a number, such as 1")


def _floats(port: Mapping[str, float]) -> Port:
    return {name: float(lever) for name, lever in port.items()}


def _place(port: Mapping[str, float]) -> str:
    """A port in words."""
    terms = [
        f"{format_quantity(lever, 'm')} × {name}" if isinstance(lever, Length) else _times(lever, name)
        for name, lever in port.items()
    ]
    return " + ".join(terms).replace("+ -", "− ").replace("+ −", "− ") or "ground"


def _times(lever: float, name: str) -> str:
    return name if lever == 1.0 else f"{format_number(lever)} × {name}"
