"""An element: a ball screw with its flywheel, given as its drawing gives it; it unfolds into a network."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import ClassVar

import inerter as it


@dataclass(frozen=True)
class Flywheel(it.Element):
    """What turns with the screw: an inertance of (2 pi / pitch)^2 times its moment of inertia."""

    moment: float | it.Free
    pitch: float  # [m] a turn
    name: str | None = None
    key: ClassVar[str] = "flywheel"
    symbol: ClassVar[str] = "J"
    quantity: ClassVar[str] = "moment"
    unit: ClassVar[str] = "kg m^2"
    sentence: ClassVar[str] = "Moment of inertia of the flywheel, with the screw."
    example: ClassVar[str] = "0.001 kg m^2"
    more: ClassVar[tuple[it.Field, ...]] = (it.Field("pitch", "m", "Travel of the nut in one turn."),)
    linear: ClassVar[it.LinearRole] = it.LinearRole.MASS

    @property
    def gain(self) -> float:
        return (2.0 * pi / self.pitch) ** 2


@it.ELEMENTS.add
@dataclass(frozen=True)
class BallScrew(it.Element):
    """A flywheel on a screw with friction in the nut, on an elastic shaft."""

    moment: float | it.Free
    pitch: float  # [m] a turn
    friction: float  # [N] of the nut
    shaft_stiffness: float  # [N/m]
    shaft_damping: float  # [N s/m]
    name: str | None = None
    key: ClassVar[str] = "ball screw"
    symbol: ClassVar[str] = "J"
    quantity: ClassVar[str] = "moment"
    unit: ClassVar[str] = "kg m^2"
    sentence: ClassVar[str] = Flywheel.sentence
    example: ClassVar[str] = "0.001 kg m^2"
    more: ClassVar[tuple[it.Field, ...]] = (
        *Flywheel.more,
        it.Field("friction", "N", "Dry friction of the nut."),
        it.Field("shaft_stiffness", "N/m", "Of the shaft, along its axis."),
        it.Field("shaft_damping", "N s/m", "Of the shaft, along its axis."),
    )
    linear: ClassVar[it.LinearRole] = it.LinearRole.MASS
    drawing: ClassVar[tuple[it.SymbolLine, ...]] = (  # a screw that goes through a wheel
        ((0.0, 20.0), (0.0, 12.0)),
        *(((-3.0, y), (3.0, y + 2.0)) for y in (4.0, 7.0, 10.0)),
        ((-3.0, 4.0), (-3.0, 12.0), (3.0, 12.0), (3.0, 4.0)),
        ((-8.0, 4.0), (-8.0, -2.0), (8.0, -2.0), (8.0, 4.0), (-8.0, 4.0)),
        ((0.0, -2.0), (0.0, -20.0)),
    )

    def as_linear(self) -> it.Network:
        return self.as_piecewise()  # which says that friction is left out

    def as_piecewise(self) -> it.Network:
        spring = it.Spring(self.shaft_stiffness, f"{self.label}_stiffness")
        shaft = spring | it.Damper(self.shaft_damping, f"{self.label}_damping")
        wheel = Flywheel(self.moment, self.pitch, self.name)
        return shaft - (wheel | it.Friction(self.friction, f"{self.label}_friction"))
