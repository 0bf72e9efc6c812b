"""Sentences about what no road or vehicle is, and the class of a road, as `inerter check` and answers have them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from inerter.field_metadata import Field, fields_of
from inerter.files.common.vehicle_tables import SEAT
from inerter.formatting import format_alike, format_number
from inerter.networks.elements import Element
from inerter.networks.elements.roles import LinearRole
from inerter.signals.road import ROAD_CLASSES, Road
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.seat import Seat

_ROUGHEST = "FGH"  # classes beyond public roads: ISO 8608:2016 has found up to E, on unpaved ones
_SMOOTHEST = 1e-6  # [m^3] Gd(n0) of a sixteenth of the mean of class A
_SPEEDS = (0.5, 150.0)  # [m/s] of vehicles with wheels
_ELEMENTS = {  # sizes of springs, dampers and inerters of vehicles with tyres [SI]
    LinearRole.STIFFNESS: (100.0, 1e9),
    LinearRole.DAMPING: (1.0, 1e7),
    LinearRole.MASS: (1e-3, 1e6),
}


def is_on_road(model: str) -> bool:
    """Whether a vehicle of this model has tyres on a road; of a mechanism, whose tyres may be rails, nobody knows."""
    return model in VEHICLES and VEHICLES[model].moved == "road"


def road_sentence(road: Road, speed: str) -> str:
    """Class of a road and, if given, the vehicle `speed`, as a sentence."""
    return f"Road: {class_words(road)}{f', at {speed}' if speed else ''}."


def class_words(road: Road) -> str:
    """The class of a road, with its displacement spectral density Gd(n0)."""
    return f"class {road.iso8608_class.letter} of ISO 8608 (Gd(n0) = {_millionths(road)} m^3, n0 = 0.1 cycle/m)"


def road_warnings(road: Road) -> Iterator[str]:
    """Warnings on an implausible road, or an implausible speed on it."""
    letter = road.iso8608_class.letter
    stated = 'Give Gd(n0) in m^3 (roughness = "256e-6 m^3"), kappa = Gd(n0) n0^2 / 2 in m^3/cycle, or class = "C".'
    if road.shape is not None:
        stated = "Check the units of the profile, and its columns."
    if letter in _ROUGHEST:
        yield (
            f"Warning: no public road is as rough as class {letter} of ISO 8608. The road has Gd(n0) = "
            f"{_millionths(road)} m^3, class C {round(ROAD_CLASSES['C'].mean / 1e-6)}e-6 m^3. {stated}"
        )
    elif _density(road) < _SMOOTHEST:
        yield (f"Warning: no road is as smooth as Gd(n0) = {_millionths(road)} m^3 (class A has 16e-6 m^3). {stated}")
    low, high = _SPEEDS
    if not low <= road.speed <= high:
        slow, driven, fast = format_alike([low, road.speed, high], "m/s")
        side = f"slower than {slow}" if road.speed < low else f"faster than {fast}"
        yield f"Warning: no vehicle drives at {driven}, {side}. Check the unit of the speed."


def vehicle_warnings(vehicle: Mapping[str, Any], elements: Iterable[tuple[str, Element]]) -> Iterator[str]:
    """Sentences on implausible numbers of a road vehicle, its seat, and the elements of its struts."""
    model = vehicle["model"]
    if not is_on_road(model):
        return
    yield from _beyond_usual(model.replace("-", " "), fields_of(VEHICLES[model]), vehicle)
    yield from _beyond_usual("seat", fields_of(Seat), vehicle.get(SEAT) or {})
    for name, element in elements:
        value, bounds = element.value, _ELEMENTS.get(element.linear)
        if isinstance(value, float | int) and bounds is not None:
            yield from _beyond(f"no vehicle has such a {element.key}: {name}", float(value), element.unit, bounds)


def _beyond_usual(what: str, fields: Iterable[Field], values: Mapping[str, Any]) -> Iterator[str]:
    for field in fields:
        value = values.get(field.name)
        if isinstance(value, float | int) and field.usual is not None:
            yield from _beyond(f"no {what} is like this one: {field.in_words}", value, field.unit, field.usual)


def _beyond(what: str, value: float, unit: str, bounds: tuple[float, float]) -> Iterator[str]:
    low, high = bounds
    if not low <= value <= high:
        given, limit = format_alike([value, low if value < low else high], unit)
        yield f"Warning: {what} {given}, {'less' if value < low else 'more'} than {limit}. Check its unit."


def _density(road: Road) -> float:
    """Gd(n0) [m^3]."""
    return 2.0 * road.roughness / 0.1**2


def _millionths(road: Road) -> str:
    return f"{format_number(1e6 * _density(road), 4)}e-6"
