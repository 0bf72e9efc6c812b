"""Replacement of vehicle quantities, element values and masses by name."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, cast

from inerter.errors import DesignError
from inerter.field_metadata import fields_of
from inerter.networks.elements import Element, Free, Network
from inerter.networks.transform import map_elements
from inerter.validation import is_number
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Stage, Vehicle, VehicleModel


def replace_values(vehicle: Vehicle, values: Mapping[str, float], *, if_there: bool = False) -> Vehicle:
    """The same vehicle with replaced values (SI), by name.

    A name is that of a quantity of the vehicle or of a stage on it, such as `sprung_mass`, the label of elements, or
    the coordinate of a `Mechanism`, for its mass.

    Raises `DesignError` for an unknown name, unless unknown names are ignored (`if_there`), for elements of several
    kinds, or for a name of two of these.
    """
    vehicle = to_editable(vehicle)
    for name, value in values.items():
        if not is_number(value):
            raise DesignError(f"The value of {name!r} must be a finite number in SI units, got {value!r}.")
        if not if_there or name in _known_names(vehicle):
            vehicle = _replace_value(vehicle, name, float(value))
    return vehicle


def to_editable(vehicle: Vehicle) -> Vehicle:
    """The vehicle, or its mechanism if its class has no fields; elements are the same objects then."""
    if isinstance(vehicle, Stage):
        return _with_vehicle(vehicle, to_editable(vehicle.vehicle))
    return vehicle if isinstance(vehicle, VehicleModel | Mechanism) else vehicle.mechanism()


def quantities(vehicle: Vehicle) -> dict[str, float | Free]:
    """Quantities of a vehicle and of the stages on it, by name."""
    below = quantities(vehicle.vehicle) if isinstance(vehicle, Stage) else {}
    return below | _own_quantities(vehicle)


def masses(vehicle: Vehicle) -> dict[str, float | Free]:
    """Inertias of the coordinates of a `Mechanism`, also below stages, by name."""
    if isinstance(vehicle, Stage):
        return masses(vehicle.vehicle)
    return {c.name: c.inertia for c in vehicle.masses.values()} if isinstance(vehicle, Mechanism) else {}


def _own_quantities(vehicle: Vehicle) -> dict[str, float | Free]:
    if not isinstance(vehicle, VehicleModel | Stage):
        return {}
    return {field.name: getattr(vehicle, field.name) for field in fields_of(type(vehicle))}


def check_one_meaning(vehicle: Vehicle, name: str) -> None:
    """Raises `DesignError` for a name of two values of an editable vehicle, such as an element and a coordinate."""
    has = {
        "a quantity of the vehicle": name in quantities(vehicle),
        "an element": bool(elements_by_label(vehicle, name)),
        "the mass of a coordinate": name in masses(vehicle),
    }
    meanings = [meaning for meaning, is_there in has.items() if is_there]
    if len(meanings) > 1:
        raise DesignError(f"{name!r} is ambiguous: {' and '.join(meanings)}. Give them different names.")


def _replace_value(vehicle: Vehicle, name: str, value: float) -> Vehicle:
    check_one_meaning(vehicle, name)
    if name in quantities(vehicle):
        return _with_quantity(vehicle, name, value)
    chosen = {id(element) for element in elements_by_label(vehicle, name)}
    if chosen:
        return with_elements(vehicle, lambda e: e.with_value(value) if id(e) in chosen else e)
    if name in masses(vehicle):
        return _with_mass(vehicle, name, value)
    raise DesignError(f"unknown value {name!r}; available: {', '.join(_known_names(vehicle))}.")


def _with_quantity(vehicle: Vehicle, name: str, value: float) -> Vehicle:
    if isinstance(vehicle, Stage) and name not in _own_quantities(vehicle):
        return _with_vehicle(vehicle, _with_quantity(vehicle.vehicle, name, value))
    of: Any = vehicle
    return cast(Vehicle, dataclasses.replace(of, **{name: value}))


def _with_vehicle(stage: Stage, vehicle: Vehicle, **other: Network) -> Vehicle:
    """The stage on another vehicle."""
    of: Any = stage
    return cast(Vehicle, dataclasses.replace(of, vehicle=vehicle, **other))


def _with_mass(vehicle: Vehicle, name: str, value: float) -> Vehicle:
    if isinstance(vehicle, Stage):
        return _with_vehicle(vehicle, _with_mass(vehicle.vehicle, name, value))
    mechanism = vehicle.mechanism()
    coordinates = tuple(dataclasses.replace(c, inertia=value) if c.name == name else c for c in mechanism.coordinates)
    return dataclasses.replace(mechanism, coordinates=coordinates)


def _known_names(vehicle: Vehicle) -> list[str]:
    labels = [element.label for part in mounted_elements(vehicle) for element in part]
    return list(dict.fromkeys([*quantities(vehicle), *labels, *masses(vehicle)]))


def mounted_elements(vehicle: Vehicle) -> tuple[list[Element], list[Element]]:
    """Elements of the struts, and of tyres that are given as networks."""
    if isinstance(vehicle, Stage):
        struts, tyres = mounted_elements(vehicle.vehicle)
        return [*struts, *vehicle.network.elements()], tyres
    if isinstance(vehicle, VehicleModel):
        return [e for network in vehicle.networks().values() for e in network.elements()], []
    mechanism = vehicle.mechanism()
    parts = (mechanism.struts, mechanism.tyres)
    of_struts, of_tyres = ([e for mount in part for e in mount.network.elements()] for part in parts)
    return of_struts, of_tyres


def elements_by_label(vehicle: Vehicle, label: str) -> list[Element]:
    """Elements with a label, in struts if there are any, else in tyres.

    Raises `DesignError` if they are of several kinds, or unnamed with several values.
    """
    of_struts, of_tyres = (
        [element for element in part if element.label == label] for part in mounted_elements(vehicle)
    )
    chosen = of_struts or of_tyres
    if len({(e.unit, e.value) for e in chosen if e.name is None and not isinstance(e.value, Free)}) > 1:
        values = " and ".join(dict.fromkeys(str(e) for e in chosen))
        raise DesignError(f"{label!r} is ambiguous: {values}. Name the element, as in Spring(..., name=...).")
    if len({e.unit for e in chosen}) > 1:
        raise DesignError(f"{label!r} names elements of different kinds. Give them different names.")
    return chosen


def with_elements(vehicle: Vehicle, change: Callable[[Element], Network]) -> Vehicle:
    """The same vehicle with `change(element)` in place of each element of its mounted networks."""
    return with_networks(vehicle, lambda network: map_elements(network, change))


def with_networks(vehicle: Vehicle, change: Callable[[Network], Network]) -> Vehicle:
    """The same vehicle with changed mounted networks."""
    if isinstance(vehicle, Stage):
        return _with_vehicle(vehicle, with_networks(vehicle.vehicle, change), network=change(vehicle.network))
    if isinstance(vehicle, VehicleModel):
        mounted: dict[str, Any] = {name: change(network) for name, network in vehicle.networks().items()}
        return dataclasses.replace(vehicle, **mounted)
    return vehicle.mechanism().with_networks(lambda mount: change(mount.network))
