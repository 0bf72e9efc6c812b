"""The inerter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from inerter.networks.elements.drawing import SymbolLine, circle
from inerter.networks.elements.element import Element
from inerter.networks.elements.roles import LinearRole
from inerter.networks.elements.values import Value


@dataclass(frozen=True)
class Inerter(Element):
    """Force proportional to the relative acceleration of its ends: F = b d2x/dt2.

    >>> import inerter as it
    >>> complex(it.Inerter(300.0).admittance(2j))  # b s [N s/m] at s = 2 j rad/s
    600j
    """

    inertance: Value  # [kg]
    name: str | None = None
    key: ClassVar[str] = "inerter"
    symbol: ClassVar[str] = "b"
    quantity: ClassVar[str] = "inertance"
    unit: ClassVar[str] = "kg"
    sentence: ClassVar[str] = (
        "Force over the relative acceleration of its ends; the mass of the device belongs to the bodies there."
    )
    example: ClassVar[str] = "300 kg"
    linear: ClassVar[LinearRole] = LinearRole.MASS
    drawing: ClassVar[tuple[SymbolLine, ...]] = (  # a rod that turns a flywheel in a box
        ((-8.0, 9.0), (-8.0, -9.0), (8.0, -9.0), (8.0, 9.0), (-8.0, 9.0)),
        circle(0.0, 0.0, 5.0),
        circle(0.0, 0.0, 0.4),
        ((0.0, 20.0), (0.0, 5.0)),
        ((0.0, -9.0), (0.0, -20.0)),
    )
