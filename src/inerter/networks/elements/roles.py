"""What an element may be to those who work with it, as a closed vocabulary: they ask these, never for a kind.

An element that is none of these by itself says of which network of others it is made instead (`Element.as_linear`,
`Element.as_piecewise`).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Linear(Enum):
    """What an element is to linear analysis. Stiffness, damping and mass are numbered by the power of s they have."""

    STIFFNESS = 0
    DAMPING = 1
    MASS = 2
    OPEN = "open"  # transmits no force, and is left out
    CLOSED = "closed"  # joins its ends rigidly

    @property
    def order(self) -> int:
        """Power of s in the dynamic stiffness of what has one."""
        assert isinstance(self.value, int)
        return self.value


class Guard(Enum):
    """What a switching element is watched by while it holds, or is loose."""

    FORCE = "force"  # holds its length in state 0 while its force is between its limits; moves against one of them else
    ELONGATION = "elongation"  # loose in state 0 between its limits; holds at one of them else


class Statistical(Enum):
    """What statistical linearisation makes of an element. What switches and is no damper to it, it refuses."""

    ITSELF = "itself"
    DAMPER = "damper"  # one that takes as much power from a Gaussian velocity, by its value as a force


@dataclass(frozen=True)
class Switch:
    """The modes of an element of the piecewise system: what guards them, and their names in states -1, 0 and 1.

    A report tells which part of the time it spent in each by the same names, or by those in `spent`.
    """

    guard: Guard
    lower: str
    middle: str
    upper: str
    at_middle: str = ""  # what one does in its middle state, to go after its name; "is ..." if left out
    spent: tuple[str, str, str] | None = None  # such as "stuck", in the order of the states

    def said(self, name: str) -> str:
        """That an element of this name is in its middle state."""
        return f"{name} {self.at_middle or f'is {self.middle}'}"

    def time_in(self, state: str) -> str:
        """How a report tells of the time in the state of that name."""
        names = (self.lower, self.middle, self.upper)
        return (self.spent or names)[names.index(state)]

    @property
    def states(self) -> dict[int, str]:
        """The names of the states by their numbers."""
        return {-1: self.lower, 0: self.middle, 1: self.upper}
