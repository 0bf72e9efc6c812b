"""The half car of Wang and Su (2008)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from inerter.field_metadata import mount, quantity
from inerter.networks.elements import Free, Network, Spring
from inerter.vehicle.mechanism import (
    Coordinate,
    Force,
    Mechanism,
    OutputWeight,
    PerformanceOutputs,
    RoadInput,
    Strut,
    Tyre,
)
from inerter.vehicle.vehicle import VehicleModel


@dataclass(frozen=True)
class HalfCar(VehicleModel):
    """A rigid body in bounce and pitch on two struts, two wheels and one road, which is delayed at the rear wheel.

    Source: Wang and Su (2008), eqs. (7) to (10). Pitch is positive nose up, so that the front port is
    bounce + distance_front x pitch. Coordinates `sprung`, `pitch`, `unsprung_front`, `unsprung_rear`.

    Raises `MechanismError` unless masses, stiffnesses and distances are positive.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(4000.0)
    >>> car = it.HalfCar(363.5, 200.0, 25.0, 20.0, 120e3, 100e3, 0.775, 1.265, front=strut, rear=strut)
    >>> [round(road.distance, 3) for road in car.mechanism().roads]  # m behind the first
    [0.0, 2.04]
    """

    sprung_mass: float | Free = field(
        metadata=quantity("kg", "Half of the body mass.", "363.5 kg", may_be_free=True, usual=(2.0, 1e5))
    )
    pitch_inertia: float | Free = field(
        metadata=quantity("kg m^2", "Pitch inertia of half the body.", "200 kg m^2", may_be_free=True, usual=(0.1, 1e6))
    )
    unsprung_mass_front: float | Free = field(
        metadata=quantity("kg", "Front wheel and hub.", "25 kg", may_be_free=True, usual=(0.1, 1e4))
    )
    unsprung_mass_rear: float | Free = field(
        metadata=quantity("kg", "Rear wheel and hub.", "20 kg", may_be_free=True, usual=(0.1, 1e4))
    )
    tyre_stiffness_front: float | Free = field(
        metadata=quantity(
            "N/m", "Vertical stiffness of the front tyre.", "120 kN/m", may_be_free=True, usual=(2e3, 1e8)
        )
    )
    tyre_stiffness_rear: float | Free = field(
        metadata=quantity("N/m", "Vertical stiffness of the rear tyre.", "100 kN/m", may_be_free=True, usual=(2e3, 1e8))
    )
    distance_front: float = field(
        metadata=quantity("m", "Distance from the centre of mass to the front axle.", "0.775 m", usual=(0.05, 20.0))
    )
    distance_rear: float = field(
        metadata=quantity("m", "Distance from the centre of mass to the rear axle.", "1.265 m", usual=(0.05, 20.0))
    )
    front: Network = field(metadata=mount("Between body and front wheel."))
    rear: Network = field(metadata=mount("Between body and rear wheel."))
    key: ClassVar[str] = "half-car"
    question: ClassVar[str] = "Two axles, one road"
    outline: ClassVar[str] = "car"
    forces: ClassVar[Mapping[str, str]] = {"sprung_force": "N", "pitch_moment": "N m"}

    def mechanism(self) -> Mechanism:
        """The same car as a `Mechanism`.

        The weight of pitch in ride comfort is the mean lever arm (l_f + l_r)/2, which is defined in the text of the
        paper and omitted in its formula for J1.
        """
        front, rear = self.distance_front, self.distance_rear
        return Mechanism(
            coordinates=(
                Coordinate("sprung", self.sprung_mass),
                Coordinate("pitch", self.pitch_inertia, angle=True),
                Coordinate("unsprung_front", self.unsprung_mass_front),
                Coordinate("unsprung_rear", self.unsprung_mass_rear),
            ),
            struts=(
                Strut("front", self.front, upper={"sprung": 1.0, "pitch": front}, lower={"unsprung_front": 1.0}),
                Strut("rear", self.rear, upper={"sprung": 1.0, "pitch": -rear}, lower={"unsprung_rear": 1.0}),
            ),
            tyres=(
                Tyre("tyre_front", Spring(self.tyre_stiffness_front), {"unsprung_front": 1.0}, "road_front"),
                Tyre("tyre_rear", Spring(self.tyre_stiffness_rear), {"unsprung_rear": 1.0}, "road_rear"),
            ),
            roads=(RoadInput("road_front"), RoadInput("road_rear", distance=front + rear)),
            forces=(Force("sprung_force", {"sprung": 1.0}), Force("pitch_moment", {"pitch": 1.0})),
            measures=PerformanceOutputs(
                comfort=(OutputWeight("sprung_acceleration"), OutputWeight("pitch_acceleration", 0.5 * (front + rear))),
                tyre_load=(OutputWeight("tyre_front_load"), OutputWeight("tyre_rear_load")),
                load_input="sprung_force",
                load_output="sprung_displacement",
            ),
        )
