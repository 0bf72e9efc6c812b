"""The quarter car, the half car and the test rig of Wang and Su (2008) as mechanisms."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol, Self

from inerter.checks import check_positive
from inerter.errors import DesignError, MechanismError
from inerter.networks.elements import Damper, Free, Network, Spring, check_network
from inerter.networks.transform import name_free_values, with_values
from inerter.vehicle.mechanism import (
    GROUND,
    Coordinate,
    Force,
    Measures,
    Mechanism,
    RoadInput,
    Strut,
    Tyre,
    Weighted,
    check_known,
)


class Vehicle(Protocol):
    """What every analysis takes: something that is a mechanism and may have free values."""

    def mechanism(self) -> Mechanism:
        """The mechanism that it is."""
        ...

    def free_values(self) -> dict[str, Free]:
        """Its design variables by name."""
        ...

    def with_values(self, values: Mapping[str, float]) -> Self:
        """The same vehicle with the named free values fixed."""
        ...


def check_vehicle(vehicle: object) -> None:
    """Raises `DesignError` unless `vehicle` is one (its class is not)."""
    if isinstance(vehicle, type) or not hasattr(vehicle, "mechanism"):
        raise DesignError(f"Expected a vehicle, such as QuarterCar(...), got {vehicle!r}.")


@dataclass(frozen=True)
class QuarterCar:
    """Body over wheel over road, with one strut between body and wheel.

    Source: Wang and Su (2008), eqs. (2) and (3). Coordinates `sprung` and `unsprung`, input road `road`, force
    `sprung_force` on the body.

    Raises `MechanismError` unless masses and tyre stiffness are positive, `NetworkError` if `strut` is no network.
    """

    sprung_mass: float  # [kg]
    unsprung_mass: float  # [kg]
    tyre_stiffness: float  # [N/m]
    strut: Network

    def __post_init__(self) -> None:
        for name, unit in (("sprung_mass", "kg"), ("unsprung_mass", "kg"), ("tyre_stiffness", "N/m")):
            check_positive(
                MechanismError, f"The {name.replace('_', ' ')} of the quarter car", getattr(self, name), unit
            )
        object.__setattr__(self, "strut", name_free_values({"strut": check_network(self.strut)})["strut"])

    def mechanism(self) -> Mechanism:
        """The same car as a `Mechanism`."""
        return Mechanism(
            coordinates=(Coordinate("sprung", self.sprung_mass), Coordinate("unsprung", self.unsprung_mass)),
            struts=(Strut("strut", self.strut, upper={"sprung": 1.0}, lower={"unsprung": 1.0}),),
            tyres=(Tyre("tyre", Spring(self.tyre_stiffness), port={"unsprung": 1.0}, road="road"),),
            roads=(RoadInput("road"),),
            forces=(Force("sprung_force", {"sprung": 1.0}),),
            measures=Measures(
                comfort=(Weighted("sprung_acceleration"),),
                tyre_load=(Weighted("tyre_load"),),
                load_input="sprung_force",
                load_output="sprung_displacement",
            ),
        )

    def free_values(self) -> dict[str, Free]:
        """The design variables by name, in the order in which they appear."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> QuarterCar:
        """The same car with the named free values fixed; raises `DesignError` for a name that is not free here."""
        check_known(values, self.free_values())
        return replace(self, strut=with_values(self.strut, values))


@dataclass(frozen=True)
class HalfCar:
    """A rigid body in bounce and pitch on two struts, two wheels and one road that reaches the rear wheel later.

    Source: Wang and Su (2008), eqs. (7) to (10). Pitch is positive nose up, so that the front port is
    bounce + distance_front x pitch. Coordinates `sprung`, `pitch`, `unsprung_front`, `unsprung_rear`.

    Raises `MechanismError` unless masses, stiffnesses and distances are positive.
    """

    sprung_mass: float  # [kg]
    pitch_inertia: float  # [kg m^2]
    unsprung_mass_front: float  # [kg]
    unsprung_mass_rear: float  # [kg]
    tyre_stiffness_front: float  # [N/m]
    tyre_stiffness_rear: float  # [N/m]
    distance_front: float  # centre of mass to front axle [m]
    distance_rear: float  # centre of mass to rear axle [m]
    front: Network
    rear: Network

    def __post_init__(self) -> None:
        for name, unit in _HALF_CAR_UNITS.items():
            check_positive(MechanismError, f"The {name.replace('_', ' ')} of the half car", getattr(self, name), unit)
        named = name_free_values({"front": check_network(self.front), "rear": check_network(self.rear)})
        object.__setattr__(self, "front", named["front"])
        object.__setattr__(self, "rear", named["rear"])

    def mechanism(self) -> Mechanism:
        """The same car as a `Mechanism`.

        The weight of pitch in ride comfort is the mean lever (l_f + l_r)/2, which the paper's text defines and its
        formula for J1 leaves out.
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
            measures=Measures(
                comfort=(Weighted("sprung_acceleration"), Weighted("pitch_acceleration", 0.5 * (front + rear))),
                tyre_load=(Weighted("tyre_front_load"), Weighted("tyre_rear_load")),
                load_input="sprung_force",
                load_output="sprung_displacement",
            ),
        )

    def free_values(self) -> dict[str, Free]:
        """The design variables by name, in the order in which they appear."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> HalfCar:
        """The same car with the named free values fixed; raises `DesignError` for a name that is not free here."""
        check_known(values, self.free_values())
        return replace(self, front=with_values(self.front, values), rear=with_values(self.rear, values))


_CELL = 1e13  # [N/m] stiffness of a load cell: a millionth of the softness of any device
_ON_CELL = {"load_cell": 1.0}


@dataclass(frozen=True)
class Rig:
    """A device between a motion table, whose displacement is given, and a load cell on the ground.

    Source: Wang and Su (2008), the test platform. Input `displacement` [m] of the device's upper end; the load cell
    reads the output `device_force`, positive in tension. A load cell that follows only up to `cell_bandwidth` [Hz]
    (second order, Butterworth) is a mass on a spring, so stiff that it hardly moves; it then reads `reading_force`.

    Raises `NetworkError` if `device` is no network, `MechanismError` if the bandwidth is not positive.
    """

    device: Network
    cell_bandwidth: float | None = None  # [Hz]

    def __post_init__(self) -> None:
        if self.cell_bandwidth is not None:
            check_positive(MechanismError, "The bandwidth of a load cell", self.cell_bandwidth, "Hz")
        object.__setattr__(self, "device", name_free_values({"device": check_network(self.device)})["device"])

    def mechanism(self) -> Mechanism:
        """The same rig as a `Mechanism`."""
        coordinates: tuple[Coordinate, ...] = ()
        cell: tuple[Strut, ...] = ()
        lower = GROUND
        if self.cell_bandwidth is not None:
            omega = 2.0 * math.pi * self.cell_bandwidth
            coordinates, lower = (Coordinate("load_cell", _CELL / omega**2),), _ON_CELL
            damping = math.sqrt(2.0) * _CELL / omega
            mount = Spring(_CELL, name="reading") | Damper(damping, name="load_cell_damping")
            cell = (Strut("load_cell_mount", mount, upper=_ON_CELL, lower=GROUND),)
        return Mechanism(
            coordinates=coordinates,
            struts=(Strut("device", self.device, upper={"displacement": 1.0}, lower=lower), *cell),
            roads=(RoadInput("displacement"),),
        )

    @property
    def reading(self) -> str:
        """The output that the load cell reads."""
        return "device_force" if self.cell_bandwidth is None else "reading_force"

    def free_values(self) -> dict[str, Free]:
        """The design variables by name, in the order in which they appear."""
        return self.mechanism().free_values()

    def with_values(self, values: Mapping[str, float]) -> Rig:
        """The same rig with the named free values fixed; raises `DesignError` for a name that is not free here."""
        check_known(values, self.free_values())
        return replace(self, device=with_values(self.device, values))


_HALF_CAR_UNITS = {
    "sprung_mass": "kg",
    "pitch_inertia": "kg m^2",
    "unsprung_mass_front": "kg",
    "unsprung_mass_rear": "kg",
    "tyre_stiffness_front": "N/m",
    "tyre_stiffness_rear": "N/m",
    "distance_front": "m",
    "distance_rear": "m",
}
