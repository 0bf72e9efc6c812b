"""Kinds of element whose laws differ by their direction: a push, a stop on one side, and what gives way in one."""

from __future__ import annotations

import math
from dataclasses import dataclass

from inerter.field_metadata import Field
from inerter.networks.elements import Damper, Element, Network, Value
from inerter.networks.elements.roles import GuardRole, LinearRole, SwitchRole


@dataclass(frozen=True)
class Push(Element):
    """A force that stays the same, as of a spring so long that travel does not change it; positive in tension."""

    force: Value  # [N]
    name: str | None = None
    key = "push"
    symbol = "p"
    quantity = "force"
    unit = "N"
    sentence = "The force."
    example = "100 N"
    linear = LinearRole.OPEN
    switch = SwitchRole(GuardRole.FORCE, "down", "none", "up")

    @property
    def limits(self) -> tuple[float, float]:
        return self.coefficient, self.coefficient


@dataclass(frozen=True)
class OneSidedStop(Element):
    """Rigid contact at a shortening of `clearance`, no force before."""

    clearance: Value  # [m]
    name: str | None = None
    key = "stop"
    symbol = "s"
    quantity = "clearance"
    unit = "m"
    sentence = "Travel to the contact."
    example = "50 mm"
    linear = LinearRole.OPEN
    switch = SwitchRole(GuardRole.ELONGATION, "contact", "open", "never")

    @property
    def limits(self) -> tuple[float, float]:
        return -self.coefficient, math.inf


@dataclass(frozen=True)
class OneWay(Element):
    """A clutch that holds any tension, and gives way in compression against its drag."""

    drag: Value  # [N]
    name: str | None = None
    key = "one-way clutch"
    symbol = "w"
    quantity = "drag"
    unit = "N"
    sentence = "Force against which it gives way."
    example = "1 N"
    linear = LinearRole.OPEN
    switch = SwitchRole(GuardRole.FORCE, "slip down", "stick", "never")
    may_vanish = True

    @property
    def limits(self) -> tuple[float, float]:
        return -self.coefficient, math.inf


@dataclass(frozen=True)
class UnevenFriction(Element):
    """Dry friction with another force in each direction."""

    force: Value  # [N] in extension
    compression: float  # [N]
    name: str | None = None
    key = "uneven friction"
    symbol = "u"
    quantity = "force"
    unit = "N"
    sentence = "Force while it gets longer."
    example = "10 N"
    more = (Field("compression", "N", "Force while it gets shorter."),)
    linear = LinearRole.OPEN
    switch = SwitchRole(GuardRole.FORCE, "slip down", "stick", "slip up")

    @property
    def limits(self) -> tuple[float, float]:
        return -self.compression, self.coefficient


def valved_damper(compression: float, extension: float) -> Network:
    """A damper with another damping in extension, the larger one."""
    return Damper(compression) | Damper(extension - compression) - OneWay(0.0)
