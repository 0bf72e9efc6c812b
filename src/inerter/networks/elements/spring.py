"""The spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from inerter.networks.elements.drawing import COIL, SymbolLine
from inerter.networks.elements.element import Element
from inerter.networks.elements.roles import LinearRole
from inerter.networks.elements.values import Value


@dataclass(frozen=True)
class Spring(Element):
    """Force proportional to elongation: F = k x.

    >>> import inerter as it
    >>> complex(it.Spring(120e3).admittance(2j))  # k / s [N s/m] at s = 2 j rad/s
    -60000j
    """

    stiffness: Value  # [N/m]
    name: str | None = None
    key: ClassVar[str] = "spring"
    symbol: ClassVar[str] = "k"
    quantity: ClassVar[str] = "stiffness"
    unit: ClassVar[str] = "N/m"
    sentence: ClassVar[str] = "Force over elongation."
    example: ClassVar[str] = "120 kN/m"
    linear: ClassVar[LinearRole] = LinearRole.STIFFNESS
    drawing: ClassVar[tuple[SymbolLine, ...]] = (COIL,)
