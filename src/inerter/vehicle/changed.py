"""A vehicle with other numbers by their names: quantities of the vehicle, values of elements, masses of coordinates."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, cast

from inerter.checks import is_number
from inerter.errors import DesignError
from inerter.fields import fields_of
from inerter.networks.elements import Element, Free, Network
from inerter.networks.transform import map_elements
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.seat import Seat
from inerter.vehicle.vehicle import Vehicle, VehicleModel


def changed(vehicle: Vehicle, values: Mapping[str, float]) -> Vehicle:
    """The same vehicle with other numbers (SI), each by its name.

    That is a quantity of the vehicle such as `sprung_mass`, else the label of elements, else a coordinate of a
    `Mechanism`, whose mass it is. Of a vehicle with a seat, `mass` is that of the occupant; all others are as below.

    Raises `DesignError` for a name that stands for nothing here, or for elements of several kinds.
    """
    for name, value in values.items():
        if not is_number(value):
            raise DesignError(f"The value of {name!r} must be a finite number in SI units, got {value!r}.")
        vehicle = _one_changed(vehicle, name, float(value))
    return vehicle


def _one_changed(vehicle: Vehicle, name: str, value: float) -> Vehicle:
    if name in _quantities(vehicle):
        stated: Any = vehicle
        return cast(Vehicle, dataclasses.replace(stated, **{name: value}))
    if isinstance(vehicle, Seat):
        return _below_changed(vehicle, name, value)
    chosen = {id(element) for element in labelled(vehicle, name)}
    if chosen:
        return with_elements(vehicle, lambda e: e.with_value(value) if id(e) in chosen else e)
    mechanism = vehicle.mechanism()
    if isinstance(vehicle, Mechanism) and name in {c.name for c in mechanism.coordinates}:
        return dataclasses.replace(
            mechanism,
            coordinates=tuple(
                dataclasses.replace(c, inertia=value) if c.name == name else c for c in mechanism.coordinates
            ),
        )
    raise _nothing(vehicle, name)


def _below_changed(seat: Seat, name: str, value: float) -> Seat:
    """The vehicle below changed, and elements of the seat's network with that label."""
    if name not in _known(seat):
        raise _nothing(seat, name)
    labelled(seat, name)
    network = map_elements(seat.network, lambda e: e.with_value(value) if e.label == name else e)
    below = _one_changed(seat.vehicle, name, value) if name in _known(seat.vehicle) else seat.vehicle
    return dataclasses.replace(seat, vehicle=below, network=network)


def _nothing(vehicle: Vehicle, name: str) -> DesignError:
    return DesignError(f"There is nothing named {name!r} to change (there are: {', '.join(_known(vehicle))}).")


def _quantities(vehicle: Vehicle) -> list[str]:
    return [field.name for field in fields_of(type(vehicle))] if dataclasses.is_dataclass(vehicle) else []


def _known(vehicle: Vehicle) -> list[str]:
    masses = [c.name for c in vehicle.coordinates] if isinstance(vehicle, Mechanism) else []
    below = _known(vehicle.vehicle) if isinstance(vehicle, Seat) else []
    labels = [e.label for part in mounted(vehicle) for e in part]
    return list(dict.fromkeys([*_quantities(vehicle), *below, *labels, *masses]))


def mounted(vehicle: Vehicle) -> tuple[list[Element], list[Element]]:
    """The elements of the struts, and of tyres that are given as networks."""
    if isinstance(vehicle, VehicleModel):
        struts: list[Network] = list(vehicle.networks().values())
        tyres: list[Network] = []
    else:
        mechanism = vehicle.mechanism()
        struts, tyres = [s.network for s in mechanism.struts], [t.network for t in mechanism.tyres]
    return [e for network in struts for e in network.elements()], [e for network in tyres for e in network.elements()]


def labelled(vehicle: Vehicle, label: str) -> list[Element]:
    """The elements of that label, in struts if there are some, else in tyres.

    Raises `DesignError` if they are of several kinds, or unnamed with several values.
    """
    of_struts, of_tyres = ([element for element in part if element.label == label] for part in mounted(vehicle))
    chosen = of_struts or of_tyres
    if len({(e.unit, e.value) for e in chosen if e.name is None and not isinstance(e.value, Free)}) > 1:
        values = " and ".join(dict.fromkeys(str(e) for e in chosen))
        raise DesignError(f"{label!r} stands for {values}. Name the one that is meant, as in Spring(..., name=...).")
    if len({e.unit for e in chosen}) > 1:
        raise DesignError(f"{label!r} names elements of different kinds. Give them different names.")
    return chosen


def with_elements(vehicle: Vehicle, change: Callable[[Element], Element]) -> Vehicle:
    """The same vehicle with other elements in what is mounted."""
    if isinstance(vehicle, VehicleModel):
        mounted: dict[str, Any] = {name: map_elements(network, change) for name, network in vehicle.networks().items()}
        return dataclasses.replace(vehicle, **mounted)
    mechanism = vehicle.mechanism()
    return dataclasses.replace(
        mechanism,
        struts=tuple(dataclasses.replace(s, network=map_elements(s.network, change)) for s in mechanism.struts),
        tyres=tuple(dataclasses.replace(t, network=map_elements(t.network, change)) for t in mechanism.tyres),
    )
