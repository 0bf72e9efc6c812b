"""A seat and its occupant, as a stage on any vehicle."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

from inerter.field_metadata import mount, quantity
from inerter.networks.elements import Network, check_network
from inerter.networks.transform import name_free_values
from inerter.vehicle.mechanism import Coordinate, Mechanism, OutputWeight, Port, Strut
from inerter.vehicle.vehicle import Stage, Vehicle, check_free_quantities, check_vehicle, name_free_quantities


@dataclass(frozen=True)
class Seat(Stage):
    """A vehicle with an occupant on a seat; ride comfort is that of the occupant.

    The seat is mounted at `place`, a port of the vehicle: {"sprung": 1.0, "pitch": 0.2, "roll": 0.4} is the body of a
    full car 0.2 m ahead of its centre of mass and 0.4 m left of it. Adds the coordinate `occupant` and the strut
    `seat` to the mechanism. All other indices, such as tyre load, are those of the vehicle with the occupant.

    Raises `DesignError` if `vehicle` is not a vehicle, `MechanismError` unless the mass is positive and the place is a
    port of the vehicle, `NetworkError` if `network` is not a network.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> seated = it.Seat(car, mass=60.0, network=it.Spring(10e3) | it.Damper(300.0))  # kg
    >>> [coordinate.name for coordinate in seated.mechanism().coordinates]
    ['sprung', 'unsprung', 'occupant']
    """

    vehicle: Vehicle
    mass: float = field(
        metadata=quantity(
            "kg",
            "Mass of the occupant and of the moving part of the seat.",
            "60 kg",
            may_be_free=True,
            usual=(2.0, 500.0),
        )
    )
    network: Network = field(metadata=mount("Between floor and occupant."))
    place: Port = field(default_factory=lambda: {"sprung": 1.0})
    coordinate: ClassVar[str] = "occupant"
    strut: ClassVar[str] = "seat"

    def __post_init__(self) -> None:
        check_vehicle(self.vehicle)
        name_free_quantities(self, "the occupant")
        below = {part.name: part.network for part in self.vehicle.mechanism().mounts()}
        named = name_free_values({**below, self.strut: check_network(self.network)})
        object.__setattr__(self, "network", named[self.strut])
        self.mechanism()
        check_free_quantities(self)

    def mechanism(self) -> Mechanism:
        """The same vehicle as a `Mechanism`."""
        below = self.vehicle.mechanism()
        upper = {self.coordinate: 1.0}
        return replace(
            below,
            coordinates=(*below.coordinates, Coordinate(self.coordinate, self.mass)),
            struts=(*below.struts, Strut(self.strut, self.network, upper=upper, lower=self.place)),
            measures=replace(below.measures, comfort=(OutputWeight(f"{self.coordinate}_acceleration"),)),
        )
