"""A full car: heave, pitch and roll of its body on four wheels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
    Port,
    RoadInput,
    Strut,
    Tyre,
)
from inerter.vehicle.vehicle import VehicleModel

_SIDES = {"left": 0.5, "right": -0.5}  # lateral positions, in tracks


@dataclass(frozen=True)
class FullCar(VehicleModel):
    """A rigid body in heave, pitch and roll on four struts, optionally with anti-roll and anti-pitch networks.

    Pitch is positive nose up, roll positive left side up, so that the left front port is sprung + distance_front x
    pitch + track_front / 2 x roll. `front` and `rear` are mounted on the left and the right: a value is the same on
    both sides. `anti_roll_front` and `anti_roll_rear` act over the travel of the left strut minus that of the right
    one, and `anti_pitch` on each side over the travel of the front strut minus that of the rear one. Coordinates
    `sprung`, `pitch`, `roll`, `unsprung_front_left`, `unsprung_front_right`, `unsprung_rear_left`,
    `unsprung_rear_right`.

    Raises `MechanismError` unless masses, stiffnesses and lengths are positive.

    >>> import inerter as it
    >>> strut = it.Spring(20e3) | it.Damper(1500.0)
    >>> car = it.FullCar(1000.0, 1500.0, 400.0, 40.0, 45.0, 180e3, 180e3, 1.2, 1.4, 1.5, 1.5, front=strut, rear=strut)
    >>> mechanism = car.mechanism()
    >>> len(mechanism.coordinates), [road.name for road in mechanism.roads][:2]
    (7, ['road_front_left', 'road_front_right'])
    """

    sprung_mass: float | Free = field(
        metadata=quantity("kg", "Body mass.", "1400 kg", may_be_free=True, usual=(4.0, 2e5))
    )
    pitch_inertia: float | Free = field(
        metadata=quantity(
            "kg m^2", "Body pitch inertia about its centre of mass.", "2400 kg m^2", may_be_free=True, usual=(0.2, 2e6)
        )
    )
    roll_inertia: float | Free = field(
        metadata=quantity(
            "kg m^2", "Body roll inertia about its centre of mass.", "520 kg m^2", may_be_free=True, usual=(0.05, 5e5)
        )
    )
    unsprung_mass_front: float | Free = field(
        metadata=quantity("kg", "One front wheel and hub.", "45 kg", may_be_free=True, usual=(0.1, 5e3))
    )
    unsprung_mass_rear: float | Free = field(
        metadata=quantity("kg", "One rear wheel and hub.", "40 kg", may_be_free=True, usual=(0.1, 5e3))
    )
    tyre_stiffness_front: float | Free = field(
        metadata=quantity(
            "N/m", "Vertical stiffness of one front tyre.", "220 kN/m", may_be_free=True, usual=(2e3, 5e7)
        )
    )
    tyre_stiffness_rear: float | Free = field(
        metadata=quantity("N/m", "Vertical stiffness of one rear tyre.", "220 kN/m", may_be_free=True, usual=(2e3, 5e7))
    )
    distance_front: float = field(
        metadata=quantity("m", "Distance from the centre of mass to the front axle.", "1.2 m", usual=(0.05, 20.0))
    )
    distance_rear: float = field(
        metadata=quantity("m", "Distance from the centre of mass to the rear axle.", "1.5 m", usual=(0.05, 20.0))
    )
    track_front: float = field(
        metadata=quantity(
            "m", "Distance between the left and right front wheels and struts.", "1.52 m", usual=(0.05, 6.0)
        )
    )
    track_rear: float = field(
        metadata=quantity(
            "m", "Distance between the left and right rear wheels and struts.", "1.5 m", usual=(0.05, 6.0)
        )
    )
    front: Network = field(metadata=mount("Between body and each front wheel."))
    rear: Network = field(metadata=mount("Between body and each rear wheel."))
    anti_roll_front: Network | None = field(
        default=None, metadata=mount("Anti-roll network between left and right front travel.")
    )
    anti_roll_rear: Network | None = field(
        default=None, metadata=mount("Anti-roll network between left and right rear travel.")
    )
    anti_pitch: Network | None = field(
        default=None, metadata=mount("Anti-pitch network between front and rear travel, on each side.")
    )
    key: ClassVar[str] = "full-car"
    question: ClassVar[str] = "Four wheels and anti-roll bars"
    outline: ClassVar[str] = "car"
    forces: ClassVar[Mapping[str, str]] = {"sprung_force": "N", "pitch_moment": "N m", "roll_moment": "N m"}

    def mechanism(self) -> Mechanism:
        """The same car as a `Mechanism`.

        In ride comfort pitch is weighted by the mean distance of the axles, as in a half car, and roll by half the mean
        track.
        """
        half_track = 0.25 * (self.track_front + self.track_rear)
        return Mechanism(
            coordinates=self._coordinates(),
            struts=(*self._struts(), *self._across()),
            tyres=tuple(
                Tyre(f"tyre_{w}", Spring(self._of_axle("tyre_stiffness", w)), {f"unsprung_{w}": 1.0}, f"road_{w}")
                for w in _WHEELS
            ),
            roads=tuple(RoadInput(f"road_{w}", self._behind(w), side=w.partition("_")[2]) for w in _WHEELS),
            forces=(
                Force("sprung_force", {"sprung": 1.0}),
                Force("pitch_moment", {"pitch": 1.0}),
                Force("roll_moment", {"roll": 1.0}),
            ),
            measures=PerformanceOutputs(
                comfort=(
                    OutputWeight("sprung_acceleration"),
                    OutputWeight("pitch_acceleration", 0.5 * (self.distance_front + self.distance_rear)),
                    OutputWeight("roll_acceleration", half_track),
                ),
                tyre_load=tuple(OutputWeight(f"tyre_{w}_load") for w in _WHEELS),
                load_input="sprung_force",
                load_output="sprung_displacement",
            ),
            mirror=(*((f"unsprung_{a}_left", f"unsprung_{a}_right") for a in _AXLES), ("roll", "roll")),
        )

    def _coordinates(self) -> tuple[Coordinate, ...]:
        wheels = (Coordinate(f"unsprung_{w}", self._of_axle("unsprung_mass", w)) for w in _WHEELS)
        body = Coordinate("sprung", self.sprung_mass)
        pitch = Coordinate("pitch", self.pitch_inertia, angle=True)
        return (body, pitch, Coordinate("roll", self.roll_inertia, angle=True), *wheels)

    def _struts(self) -> tuple[Strut, ...]:
        mounted = {"front": self.front, "rear": self.rear}
        return tuple(
            Strut(w, mounted[w.partition("_")[0]], upper=self._body_at(w), lower={f"unsprung_{w}": 1.0})
            for w in _WHEELS
        )

    def _across(self) -> Iterator[Strut]:
        """Networks over the difference of two travels."""
        joined = (
            ("anti_roll_front", self.anti_roll_front, "front_left", "front_right"),
            ("anti_roll_rear", self.anti_roll_rear, "rear_left", "rear_right"),
            ("anti_pitch_left", self.anti_pitch, "front_left", "rear_left"),
            ("anti_pitch_right", self.anti_pitch, "front_right", "rear_right"),
        )
        for name, network, first, second in joined:
            if network is not None:
                yield Strut(name, network, upper=self._travel(first), lower=self._travel(second))

    def _travel(self, wheel: str) -> Port:
        return {**self._body_at(wheel), f"unsprung_{wheel}": -1.0}

    def _body_at(self, wheel: str) -> Port:
        axle, _, side = wheel.partition("_")
        ahead = dict(zip(_AXLES, _with_exact_difference(self.distance_front, -self.distance_rear), strict=True))
        track = dict(zip(_AXLES, _with_exact_difference(self.track_front, self.track_rear), strict=True))
        return {"sprung": 1.0, "pitch": ahead[axle], "roll": _SIDES[side] * track[axle]}

    def _behind(self, wheel: str) -> float:
        return 0.0 if wheel.startswith("front") else self.distance_front + self.distance_rear

    def _of_axle(self, quantity: str, wheel: str) -> float:
        value: float = getattr(self, f"{quantity}_{wheel.partition('_')[0]}")
        return value


_AXLES = ("front", "rear")
_WHEELS = tuple(f"{axle}_{side}" for axle in _AXLES for side in _SIDES)


def _with_exact_difference(first: float, second: float) -> tuple[float, float]:
    """Both values, the smaller one changed in its last digit if needed, so that their difference is exact.

    Networks over the difference of two travels then add no motion of the size of a rounding error to those of the
    struts, which the analysis would treat as a separate degree of freedom.
    """
    difference = first - second
    if abs(first) >= abs(second):
        return first, first - difference
    return difference + second, second
