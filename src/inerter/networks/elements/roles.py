"""Roles of an element in analysis and simulation, as a closed vocabulary, used instead of its class.

An element without such a role is replaced by a network of others (`Element.as_linear`, `Element.as_piecewise`).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class LinearRole(Enum):
    """Role of an element in linear analysis; the values of stiffness, damping and mass are their powers of s.

    >>> import inerter as it
    >>> it.Inerter(300.0).linear.order, it.Gap(1e-4).linear is it.LinearRole.CLOSED  # power of s; a rigid connection
    (2, True)
    """

    STIFFNESS = 0
    DAMPING = 1
    MASS = 2
    OPEN = "open"  # transmits no force, and is neglected
    CLOSED = "closed"  # rigid connection

    @property
    def order(self) -> int:
        """Power of s in the dynamic stiffness."""
        assert isinstance(self.value, int)
        return self.value


class GuardRole(Enum):
    """Quantity that guards the states of a switching element.

    >>> import inerter as it
    >>> it.Friction(10.0).switch.guard is it.GuardRole.FORCE, it.Gap(1e-4).switch.guard is it.GuardRole.ELONGATION
    (True, True)
    """

    FORCE = "force"  # constant length in state 0 while the force is between its limits; else sliding at one of them
    ELONGATION = "elongation"  # no force in state 0 between its limits; else contact at one of them


class StatisticalRole(Enum):
    """Replacement in statistical linearisation, which rejects switching elements without an equivalent damper.

    >>> import inerter as it
    >>> it.Friction(10.0).statistical is it.StatisticalRole.DAMPER
    True
    """

    ITSELF = "itself"
    DAMPER = "damper"  # dissipates the same power under a Gaussian velocity


@dataclass(frozen=True)
class SwitchRole:
    """Contact states of an element of the piecewise system: their guard, and their names for -1, 0 and 1.

    Reports of the share of time in each state use the same names, or those in `spent`.

    >>> import inerter as it
    >>> states = it.Gap(1e-4).switch
    >>> states.middle
    'open'
    """

    guard: GuardRole
    lower: str
    middle: str
    upper: str
    at_middle: str = ""  # verb phrase of the middle state, for use after the name; default: "is ..."
    spent: tuple[str, str, str] | None = None  # such as "stuck", in the order of the states

    @property
    def middle_phrase(self) -> str:
        """Verb phrase of the middle state."""
        return self.at_middle or f"is {self.middle}"

    def middle_state_text(self, name: str) -> str:
        """Clause that an element of this name is in its middle state."""
        return f"{name} {self.middle_phrase}"

    def time_in(self, state: str) -> str:
        """Name of a state in reports of the share of time."""
        names = (self.lower, self.middle, self.upper)
        return (self.spent or names)[names.index(state)]

    @property
    def states(self) -> dict[int, str]:
        """Names of the states by number."""
        return {-1: self.lower, 0: self.middle, 1: self.upper}
