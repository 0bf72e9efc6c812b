"""Whether records identify a parameter, as data, and how that is said."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from inerter.networks.elements.roles import Linear
from inerter.units import format_quantity


class Verdict(StrEnum):
    """What records say of a parameter."""

    IDENTIFIED = "identified"
    MAGNITUDE = "order of magnitude"  # both ends are known, and far apart
    ANY = "any value"  # between the bounds of the search
    BELOW = "below"  # the upper end alone is known
    ABOVE = "above"  # the lower end alone is known
    WITHHELD = "withheld"  # the fit is not to be relied on
    CONDITIONAL = "conditional"  # the same, but a hypothesis explains why, and gives a range
    UNPREDICTABLE = "unpredictable"  # nobody can predict the force of the device


@dataclass(frozen=True)
class Identifiability:
    """The verdict on a parameter, with what it rests on. True where the parameter is identified."""

    name: str
    verdict: Verdict
    unit: str = ""
    interval: tuple[float, float] = (math.nan, math.nan)  # of the profile likelihood
    least: float = 0.0  # where it was sought from
    role: Linear | None = None  # of its element; None for one of the sensors
    openings: int = 0  # of its gap in the best fit
    held: float | None = None  # [N] the largest force that a friction held without slipping, by which it is stuck

    def __bool__(self) -> bool:
        return self.identified

    @property
    def identified(self) -> bool:
        """Whether both ends of its interval are known, and mean anything."""
        return self.verdict in (Verdict.IDENTIFIED, Verdict.MAGNITUDE)

    @property
    def plain(self) -> bool:
        """Whether it is identified, and nothing needs saying about it."""
        return self.verdict is Verdict.IDENTIFIED

    @property
    def sentence(self) -> str:
        """For a reader."""
        return f"{self.name}: {_SENTENCES[self.verdict](self)}"

    @property
    def told(self) -> bool:
        """The old name of `identified`."""
        warnings.warn("`told` is now `identified`; the old name goes with the next version.", DeprecationWarning, 2)
        return self.identified


_CAUSES = {
    Linear.OPEN: "Friction is lost beside the other forces; move slowly, so that little but friction is left.",
    Linear.MASS: "The force of inertia is too small; accelerate more.",
    Linear.STIFFNESS: "It hardly gives way under these forces, or never carries them; excite near its resonance.",
    Linear.DAMPING: "Its force is small beside that of the spring; excite at a higher frequency.",
}


def _cause(i: Identifiability) -> str:
    if i.role is None:
        return "The records say too little of the sensor."
    if i.held is not None:
        what = "It never slipped" if i.role is Linear.OPEN else "The friction beside it never slipped"
        return f"{what}, under forces of up to {_shown(i.held, 'N')}; move it further or faster, so that it does."
    if i.role is not Linear.CLOSED:
        return _CAUSES[i.role]
    if i.openings == 0:
        return "There is no lift-off in the best fit; excite it so that the force reverses."
    return f"There are {i.openings} lift-offs, each shorter than the noise shows."


def _shown(value: float, unit: str) -> str:
    return format_quantity(value, unit) if unit else f"{value:.4g}"


def _magnitude(i: Identifiability) -> str:
    low, high = (_shown(end, i.unit) for end in i.interval)
    return f"identified; only its order of magnitude, {low} to {high}."


def _below(i: Identifiability) -> str:
    least = format_quantity(i.least, i.unit) if i.unit else f"{i.least:g}"
    upper = _shown(i.interval[1], i.unit)
    return f"not identifiable; all values from {least} to {upper} explain the records as well. {_cause(i)}"


_SENTENCES: Mapping[Verdict, Callable[[Identifiability], str]] = {
    Verdict.IDENTIFIED: lambda i: "identified.",
    Verdict.MAGNITUDE: _magnitude,
    Verdict.ANY: lambda i: f"not identifiable; any value within its bounds explains the records as well. {_cause(i)}",
    Verdict.BELOW: _below,
    Verdict.ABOVE: lambda i: (
        f"not identifiable; at least {_shown(i.interval[0], i.unit)}, and larger values explain the records as well. "
        f"{_cause(i)}"
    ),
    Verdict.WITHHELD: lambda i: "withheld, for the fit is not to be relied on.",
    Verdict.CONDITIONAL: lambda i: (
        f"withheld, for the fit is not to be relied on; {_shown(i.interval[0], i.unit)} to "
        f"{_shown(i.interval[1], i.unit)} if what explains the misfit is so."
    ),
    Verdict.UNPREDICTABLE: lambda i: "not identifiable: nobody can predict the force of this device.",
}
