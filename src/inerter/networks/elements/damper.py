"""The damper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from inerter.networks.elements.drawing import SymbolLine
from inerter.networks.elements.element import Element
from inerter.networks.elements.roles import LinearRole
from inerter.networks.elements.values import Value


@dataclass(frozen=True)
class Damper(Element):
    """Force proportional to the rate of elongation: F = c dx/dt.

    >>> import inerter as it
    >>> complex(it.Damper(1500.0).admittance(2j))  # force over velocity [N s/m]
    (1500+0j)
    """

    damping: Value  # [N s/m]
    name: str | None = None
    key: ClassVar[str] = "damper"
    symbol: ClassVar[str] = "c"
    quantity: ClassVar[str] = "damping"
    unit: ClassVar[str] = "N s/m"
    sentence: ClassVar[str] = "Force over the rate of elongation."
    example: ClassVar[str] = "3000 N s/m"
    linear: ClassVar[LinearRole] = LinearRole.DAMPING
    drawing: ClassVar[tuple[SymbolLine, ...]] = (  # a piston in a cup
        ((0.0, 20.0), (0.0, 1.0)),
        ((-5.5, 1.0), (5.5, 1.0)),
        ((-8.0, 8.0), (-8.0, -8.0), (8.0, -8.0), (8.0, 8.0)),
        ((0.0, -8.0), (0.0, -20.0)),
    )
