"""Friction laws and their sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from inerter.formatting import format_alike, format_number, format_quantity, format_range
from inerter.statements import Statement

SLOW = 0.3  # of the largest speed: where the two slopes meet
Law = Literal["coulomb", "viscous", "stribeck", "other", "not identifiable"]
Reason = Literal["", "samples", "friction", "speeds"]  # insufficient for an identification


@dataclass(frozen=True)
class FrictionLaw(Statement):
    """The friction of a record: its `level`, and its slopes over the speed.

    `law` is "coulomb" where no dependence is significant, "viscous" where the friction grows with speed, "stribeck"
    where it falls at low speed, "other" where it does neither, and "not identifiable" otherwise, for a `reason`.
    """

    law: Law
    level: float  # [N] mean size of the sliding friction; for a fit, of the friction in its residual
    interval: tuple[float, float]  # [N] of the level, 95 %
    p_value: float  # of a friction that does not depend on the speed; nan if not identifiable
    slow: float  # [N s/m] slope below `SLOW` of the largest speed
    slow_interval: tuple[float, float]  # 95 %
    fast: float  # [N s/m] slope above
    fast_interval: tuple[float, float]
    speeds: tuple[float, float]  # [m/s] least and largest at which it slides
    samples: int  # in which it slides
    reason: Reason = ""

    @property
    def sentence(self) -> str:
        """For a reader."""
        return _SENTENCES[self.law](self)


def _coulomb_text(law: FrictionLaw) -> str:
    unseen, top = max(abs(end) for end in law.fast_interval), law.speeds[1]
    return (
        f"No dependence on speed up to {format_quantity(top, 'm/s', 3)} (p = {format_number(law.p_value, 2)}); a "
        f"viscous part above {format_quantity(unseen, 'N s/m', 3)}, {format_quantity(unseen * top, 'N', 2)} at that "
        f"speed, can be excluded."
    )


def _stribeck_text(law: FrictionLaw) -> str:
    return (
        f"Friction falls with speed at low speed, by {format_quantity(-law.slow, 'N s/m', 3)} below "
        f"{format_quantity(SLOW * law.speeds[1], 'm/s', 3)} (p = {format_number(law.p_value, 2)}): a Stribeck effect, "
        f"which Coulomb's law neglects."
    )


def _viscous_text(law: FrictionLaw) -> str:
    slope = law.fast if law.fast_interval[0] > 0.0 else law.slow
    return (
        f"Friction grows with speed, by {format_quantity(slope, 'N s/m', 3)} (p = {format_number(law.p_value, 2)}): "
        f"add a damper in parallel with the inerter."
    )


def _other_text(law: FrictionLaw) -> str:
    slow, fast = format_alike([law.slow, law.fast], "N s/m", 3)
    return (
        f"Friction depends on speed (p = {format_number(law.p_value, 2)}), yet neither as a damper nor as Stribeck's "
        f"law: slopes {slow} and {fast}."
    )


def _not_identifiable_text(law: FrictionLaw) -> str:
    low, high = law.speeds
    why = {
        "samples": f"the device slides in {law.samples} samples only; record more, with larger strokes",
        "friction": f"the friction, {format_quantity(law.level, 'N', 3)}, does not exceed the noise",
        "speeds": f"the sliding speeds range from {format_range(low, high, 'm/s', 3)} only; use larger strokes",
    }
    return f"The friction law is not identifiable: {why[law.reason]}."


_SENTENCES: Mapping[Law, Callable[[FrictionLaw], str]] = {
    "coulomb": _coulomb_text,
    "stribeck": _stribeck_text,
    "viscous": _viscous_text,
    "other": _other_text,
    "not identifiable": _not_identifiable_text,
}
