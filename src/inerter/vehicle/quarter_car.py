"""The quarter car of Wang and Su (2008)."""

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

_ROADS = (RoadInput("road"),)
_FORCES = (Force("sprung_force", {"sprung": 1.0}),)
_OUTPUTS = PerformanceOutputs(
    comfort=(OutputWeight("sprung_acceleration"),),
    tyre_load=(OutputWeight("tyre_load"),),
    load_input="sprung_force",
    load_output="sprung_displacement",
)


@dataclass(frozen=True)
class QuarterCar(VehicleModel):
    """A body and a wheel on one road, with one strut between body and wheel.

    Source: Wang and Su (2008), eqs. (2) and (3). Coordinates `sprung` and `unsprung`, input road `road`, force
    `sprung_force` on the body.

    Raises `MechanismError` unless masses and tyre stiffness are positive, `NetworkError` if `strut` is not a network.

    >>> import inerter as it
    >>> car = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=180e3, strut=it.Spring(20e3))
    >>> it.state_space(car).inputs
    ('road', 'sprung_force')
    """

    sprung_mass: float | Free = field(
        metadata=quantity("kg", "A quarter of the body mass.", "181.75 kg", may_be_free=True, usual=(1.0, 5e4))
    )
    unsprung_mass: float | Free = field(
        metadata=quantity("kg", "Wheel, hub and share of the suspension.", "25 kg", may_be_free=True, usual=(0.1, 5e3))
    )
    tyre_stiffness: float | Free = field(
        metadata=quantity("N/m", "Vertical tyre stiffness.", "120 kN/m", may_be_free=True, usual=(2e3, 5e7))
    )
    strut: Network = field(metadata=mount("Between body and wheel."))
    key: ClassVar[str] = "quarter-car"
    question: ClassVar[str] = "Which strut for a quarter car?"
    outline: ClassVar[str] = "corner"
    forces: ClassVar[Mapping[str, str]] = {"sprung_force": "N"}

    def mechanism(self) -> Mechanism:
        """The same car as a `Mechanism`."""
        return Mechanism(
            coordinates=(Coordinate("sprung", self.sprung_mass), Coordinate("unsprung", self.unsprung_mass)),
            struts=(Strut("strut", self.strut, upper={"sprung": 1.0}, lower={"unsprung": 1.0}),),
            tyres=(Tyre("tyre", Spring(self.tyre_stiffness), port={"unsprung": 1.0}, road="road"),),
            roads=_ROADS,
            forces=_FORCES,
            measures=_OUTPUTS,
        )
