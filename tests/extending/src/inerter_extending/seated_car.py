"""A vehicle: a quarter car with a passenger on a seat."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import inerter as it


@it.VEHICLES.add
@dataclass(frozen=True)
class SeatedCar(it.VehicleModel):
    """Passenger over body over wheel over road; comfort is that of the passenger."""

    seated_mass: float = field(metadata=it.quantity("kg", "Passenger and cushion.", "60 kg"))
    sprung_mass: float = field(metadata=it.quantity("kg", "A quarter of the body.", "180 kg"))
    unsprung_mass: float = field(metadata=it.quantity("kg", "Wheel and hub.", "25 kg"))
    seat_stiffness: float = field(metadata=it.quantity("N/m", "Of the cushion.", "15 kN/m"))
    seat_damping: float = field(metadata=it.quantity("N s/m", "Of the cushion.", "500 N s/m"))
    tyre_stiffness: float = field(metadata=it.quantity("N/m", "Of the tyre.", "120 kN/m"))
    strut: it.Network = field(metadata=it.mount("Between body and wheel."))
    key: ClassVar[str] = "seated-car"
    forces: ClassVar[dict[str, str]] = {"sprung_force": "N"}

    def mechanism(self) -> it.Mechanism:
        cushion = it.Spring(self.seat_stiffness, "cushion_spring") | it.Damper(self.seat_damping, "cushion_damper")
        return it.Mechanism(
            coordinates=(
                it.Coordinate("seated", self.seated_mass),
                it.Coordinate("sprung", self.sprung_mass),
                it.Coordinate("unsprung", self.unsprung_mass),
            ),
            struts=(
                it.Strut("strut", self.strut, upper={"sprung": 1.0}, lower={"unsprung": 1.0}),
                it.Strut("seat", cushion, upper={"seated": 1.0}, lower={"sprung": 1.0}),
            ),
            tyres=(it.Tyre("tyre", it.Spring(self.tyre_stiffness), port={"unsprung": 1.0}, road="road"),),
            roads=(it.RoadInput("road"),),
            forces=(it.Force("sprung_force", {"sprung": 1.0}),),
            measures=it.PerformanceOutputs(
                comfort=(it.OutputWeight("seated_acceleration"),),
                tyre_load=(it.OutputWeight("tyre_load"),),
                load_input="sprung_force",
                load_output="sprung_displacement",
            ),
        )
