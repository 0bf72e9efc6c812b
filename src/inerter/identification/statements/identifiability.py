"""Identifiability of parameters: verdicts and their sentences."""

from __future__ import annotations

import math
from dataclasses import dataclass

from inerter.deprecation import RenamedAttribute
from inerter.formatting import format_quantity, format_range
from inerter.networks.elements.roles import LinearRole
from inerter.statements import Severity, Statement, WordedEnum

_CAUSES = {
    LinearRole.OPEN: "Friction is small compared with the other forces; move slowly, so that friction dominates.",
    LinearRole.MASS: "The inertial force is too small; accelerate more.",
    LinearRole.STIFFNESS: "Its deflection is too small, or it never carries the force; excite near its resonance.",
    LinearRole.DAMPING: "Its force is small compared with that of the spring; excite at a higher frequency.",
}


def _cause(i: Identifiability) -> str:
    if i.role is None:
        return "The records contain too little information on it."
    if i.held is not None:
        what = "It never slipped" if i.role is LinearRole.OPEN else "The friction in parallel with it never slipped"
        return f"{what}, under forces of up to {format_quantity(i.held, 'N')}; excite with larger or faster motion."
    if i.role is not LinearRole.CLOSED:
        return _CAUSES[i.role]
    if i.openings == 0:
        return "Contact never opens in the best fit; excite with force reversals."
    return f"All {i.openings} lift-offs are too short to be resolved in the noise."


def _below(i: Identifiability) -> str:
    least = format_quantity(i.least, i.unit)
    upper = format_quantity(i.interval[1], i.unit)
    return f"not identifiable: only an upper bound, {upper}, is known (search from {least}). {_cause(i)}"


class Verdict(WordedEnum):
    """Identifiability of a parameter by the records, with its sentence after the name of the parameter."""

    IDENTIFIED = "identified", "identified."
    MAGNITUDE = (
        "order of magnitude",
        lambda i: f"identified; only its order of magnitude, {format_range(i.interval[0], i.interval[1], i.unit)}.",
    )
    ANY = "any value", lambda i: f"not identifiable: the confidence interval covers all of its bounds. {_cause(i)}"
    BELOW = "below", _below
    ABOVE = (
        "above",
        lambda i: (
            f"not identifiable: only a lower bound, {format_quantity(i.interval[0], i.unit)}, is known. {_cause(i)}"
        ),
    )
    NOISY = (
        "noise",
        "not identifiable: the noise of the displacement, which passes through the device, decides its value more than "
        "the motion does. Excite with several frequencies, up to those at which its springs take a tenth of the "
        "motion.",
    )
    WITHHELD = "withheld", "withheld: the fit is unreliable."
    CONDITIONAL = (
        "conditional",
        lambda i: (
            f"withheld: the fit is unreliable; {format_range(i.interval[0], i.interval[1], i.unit)} under the most "
            f"likely causes of the misfit."
        ),
    )
    UNPREDICTABLE = "unpredictable", "not identifiable: the force of this device cannot be predicted."


_UNRELIABLE = (Verdict.WITHHELD, Verdict.CONDITIONAL, Verdict.UNPREDICTABLE)


@dataclass(frozen=True)
class Identifiability(Statement):
    """The verdict on a parameter, with its reasons. True where the parameter is identified."""

    name: str
    verdict: Verdict
    unit: str = ""
    interval: tuple[float, float] = (math.nan, math.nan)  # of the profile likelihood
    least: float = 0.0  # lower bound of the search
    role: LinearRole | None = None  # of its element; None for one of the sensors
    openings: int = 0  # of its gap in the best fit
    held: float | None = None  # [N] the largest force at which a friction did not slip

    def __bool__(self) -> bool:
        return self.identified

    @property
    def identified(self) -> bool:
        """Whether both ends of its interval are known and valid."""
        return self.verdict in (Verdict.IDENTIFIED, Verdict.MAGNITUDE)

    @property
    def plain(self) -> bool:
        """Whether it is identified without reservation."""
        return self.verdict is Verdict.IDENTIFIED

    @property
    def severity(self) -> Severity:
        """Warning for an unreliable fit; a bound, or no information, is a reliable result."""
        return Severity.WARNING if self.verdict in _UNRELIABLE else Severity.INFO

    @property
    def about(self) -> str:
        """The name of the parameter."""
        return self.name

    @property
    def sentence(self) -> str:
        """Name and verdict in words."""
        return f"{self.name}: {self.verdict.format_words(self)}"

    told = RenamedAttribute("identified")
