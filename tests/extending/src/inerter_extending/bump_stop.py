"""An element: a rubber buffer, which a suspension meets after some travel in compression and on no other side."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import ClassVar

import inerter as it


@dataclass(frozen=True)
class Stop(it.Element):
    """No force before it is shorter by `clearance`, rigid contact there: its upper end is never met."""

    clearance: float | it.Free
    name: str | None = None
    key: ClassVar[str] = "one-sided stop"
    symbol: ClassVar[str] = "s"
    quantity: ClassVar[str] = "clearance"
    unit: ClassVar[str] = "m"
    sentence: ClassVar[str] = "Travel in compression before it is met."
    example: ClassVar[str] = "40 mm"
    linear: ClassVar[it.LinearRole] = it.LinearRole.OPEN
    switch: ClassVar[it.SwitchRole] = it.SwitchRole(it.GuardRole.ELONGATION, "contact", "open", "never")

    @property
    def limits(self) -> tuple[float, float]:
        return -self.coefficient, inf


@it.ELEMENTS.add
@dataclass(frozen=True)
class BumpStop(it.Element):
    """A one-sided stop in series with a spring; linear analysis, which stays near rest, leaves it out."""

    stiffness: float | it.Free
    clearance: float  # [m]
    name: str | None = None
    key: ClassVar[str] = "bump stop"
    symbol: ClassVar[str] = "kb"
    quantity: ClassVar[str] = "stiffness"
    unit: ClassVar[str] = "N/m"
    sentence: ClassVar[str] = "Stiffness of the buffer."
    example: ClassVar[str] = "200 kN/m"
    more: ClassVar[tuple[it.Field, ...]] = (it.Field("clearance", "m", Stop.sentence),)
    linear: ClassVar[it.LinearRole] = it.LinearRole.OPEN

    def as_piecewise(self) -> it.Network:
        return Stop(self.clearance, f"{self.label}_stop") - it.Spring(self.stiffness, f"{self.label}_spring")
