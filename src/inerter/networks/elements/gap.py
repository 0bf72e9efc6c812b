"""Backlash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from inerter.networks.elements.drawing import SymbolLine
from inerter.networks.elements.element import Element
from inerter.networks.elements.roles import GuardRole, LinearRole, SwitchRole
from inerter.networks.elements.values import Value


@dataclass(frozen=True)
class Gap(Element):
    """Backlash: no force while |x| < half_width, rigid contact at -half_width and at +half_width.

    >>> import inerter as it
    >>> backlash = it.Spring(1e6) - it.Gap(5e-5)  # m: a tenth of a millimetre in all
    >>> run = it.simulate(it.Rig(backlash), displacement=it.sine(1e-3, 1.0), duration=0.25)
    >>> round(float(run["device_force"][-1]))  # 1e6 (1e-3 - 5e-5) N
    950
    """

    half_width: Value  # [m]
    name: str | None = None
    key: ClassVar[str] = "gap"
    symbol: ClassVar[str] = "gap"
    quantity: ClassVar[str] = "half_width"
    unit: ClassVar[str] = "m"
    sentence: ClassVar[str] = "Free travel to either side of the middle (half of the backlash)."
    unit_note: ClassVar[str] = "half of the backlash"
    example: ClassVar[str] = "0.1 mm"
    linear: ClassVar[LinearRole] = LinearRole.CLOSED
    switch: ClassVar[SwitchRole] = SwitchRole(
        GuardRole.ELONGATION, "lower contact", "open", "upper contact", spent=("lower end", "in the gap", "upper end")
    )
    effect: ClassVar[str] = "backlash"
    may_vanish: ClassVar[bool] = True
    tried: ClassVar[tuple[float, float]] = (1e-6, 1e-2)
    drawing: ClassVar[tuple[SymbolLine, ...]] = (  # a pin between two jaws
        ((0.0, 20.0), (0.0, 9.0)),
        ((4.0, 9.0), (-8.0, 9.0), (-8.0, -7.0), (4.0, -7.0)),
        ((-4.0, 1.0), (8.0, 1.0), (8.0, -12.0), (0.0, -12.0), (0.0, -20.0)),
    )
