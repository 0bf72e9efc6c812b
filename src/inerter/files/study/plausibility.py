"""What a study file says that no road or vehicle is, in warnings."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from inerter.fields import fields_of
from inerter.files.study.study import Study
from inerter.signals.road import ROAD_CLASSES, Road
from inerter.units import format_number, format_quantity
from inerter.vehicle.registry import VEHICLES

_ROUGHEST = "FGH"  # classes that no public road has (ISO 8608:2016, Annex C: up to E, unpaved)
_SMOOTHEST = 1e-6  # [m^3] Gd(n0) of a sixteenth of the mean of class A
_SPEEDS = (0.5, 150.0)  # [m/s] of what rolls on wheels
_USUAL = {  # of vehicles on roads and rails, by unit [SI]
    "kg": (0.5, 2e5),
    "kg m^2": (0.5, 1e7),
    "N/m": (1e3, 1e9),
    "m": (0.05, 30.0),
}


def road_sentence(study: Study) -> str:
    """The class of the road and the speed; empty where either is varied, or where no index is about a road."""
    varied = any(sweep.label.startswith("road.") for sweep in study.sweeps) or study.conditions
    return "" if study.road is None or varied else f"Road: {class_words(study.road)}, at {study.road.speed:.4g} m/s"


def class_words(road: Road) -> str:
    """The class of a road, with its displacement spectral density Gd(n0)."""
    return f"class {road.iso8608_class.letter} of ISO 8608 (Gd(n0) = {_millionths(road)} m^3, n0 = 0.1 cycle/m)"


def _density(road: Road) -> float:
    """Gd(n0) [m^3]."""
    return 2.0 * road.roughness / 0.1**2


def _millionths(road: Road) -> str:
    return f"{format_number(1e6 * _density(road), 4)}e-6"


def input_warnings(study: Study) -> Iterator[str]:
    """Why the road, the speed or the vehicle may not be what is meant."""
    if study.road is None or study.model not in VEHICLES:
        return
    yield from _road_warnings(study.road)
    for field in fields_of(VEHICLES[study.model]):
        value = study.vehicle.get(field.name)
        low, high = _USUAL.get(field.unit, (0.0, inf))
        if isinstance(value, float | int) and not low <= value <= high:
            side = "less than" if value < low else "more than"
            yield (
                f"Warning: no vehicle is like this one: {field.in_words} {format_quantity(value, field.unit)}, "
                f"{side} {format_quantity(low if value < low else high, field.unit)}. Check its unit."
            )


def _road_warnings(road: Road) -> Iterator[str]:
    letter = road.iso8608_class.letter
    if letter in _ROUGHEST:
        yield (
            f"Warning: no public road is as rough as class {letter} of ISO 8608. The road has Gd(n0) = "
            f"{_millionths(road)} m^3, class C {ROAD_CLASSES['C'].mean / 1e-6:.0f}e-6 m^3. Give Gd(n0) in m^3 "
            '(roughness = "256e-6 m^3"), kappa = Gd(n0) n0^2 / 2 in m^3/cycle, or class = "C".'
        )
    elif _density(road) < _SMOOTHEST:
        yield (
            f"Warning: no road is as smooth as Gd(n0) = {_millionths(road)} m^3 (class A has 16e-6 m^3). Give "
            "Gd(n0) in m^3, or kappa = Gd(n0) n0^2 / 2 in m^3/cycle."
        )
    low, high = _SPEEDS
    if not low <= road.speed <= high:
        side = f"slower than {low:g}" if road.speed < low else f"faster than {high:g}"
        yield f"Warning: no vehicle drives at {road.speed:.4g} m/s, {side} m/s. Check the unit of the speed."
