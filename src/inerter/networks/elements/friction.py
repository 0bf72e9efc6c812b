"""Dry friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from inerter.networks.elements.drawing import SymbolLine
from inerter.networks.elements.element import Element
from inerter.networks.elements.roles import GuardRole, LinearRole, StatisticalRole, SwitchRole
from inerter.networks.elements.values import Value


@dataclass(frozen=True)
class Friction(Element):
    """Dry (Coulomb) friction: a force of size f that opposes the motion, any force in [-f, f] at rest.

    >>> import inerter as it
    >>> run = it.simulate(it.Rig(it.Spring(1e6) - it.Friction(10.0)), displacement=it.sine(0.01, 1.0), duration=0.2)
    >>> float(run["device_force"][-1])  # N, while it slides upwards
    10.0
    """

    force: Value  # [N]
    name: str | None = None
    key: ClassVar[str] = "friction"
    symbol: ClassVar[str] = "f"
    quantity: ClassVar[str] = "force"
    unit: ClassVar[str] = "N"
    sentence: ClassVar[str] = "Sliding friction force, equal to the break-away force."
    example: ClassVar[str] = "10 N"
    linear: ClassVar[LinearRole] = LinearRole.OPEN
    switch: ClassVar[SwitchRole] = SwitchRole(
        GuardRole.FORCE, "slip down", "stick", "slip up", at_middle="sticks", spent=("slip down", "stuck", "slip up")
    )
    statistical: ClassVar[StatisticalRole] = StatisticalRole.DAMPER
    may_vanish: ClassVar[bool] = True
    tried: ClassVar[tuple[float, float]] = (0.1, 1e4)
    drawing: ClassVar[tuple[SymbolLine, ...]] = (  # a block that slides along a hatched wall
        ((0.0, 20.0), (0.0, 7.0)),
        ((-4.0, 7.0), (-4.0, -7.0), (4.0, -7.0), (4.0, 7.0), (-4.0, 7.0)),
        ((4.0, 13.0), (4.0, -13.0), (0.0, -13.0), (0.0, -20.0)),
        *(((4.0, y), (8.0, y + 4.0)) for y in (-13.0, -9.0, -5.0, -1.0, 3.0, 7.0)),
    )
