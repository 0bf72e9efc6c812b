"""What records tell and what they do not, in sentences, and the experiment that would tell more."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from inerter.identification.fit import Comparison, Parameter, Told
from inerter.identification.intervals import Profile
from inerter.identification.space import Space
from inerter.networks.elements import Element
from inerter.networks.elements.roles import Linear
from inerter.units import format_quantity

_WIDE = 3.0  # ends of an interval this far apart, as a ratio, tell an order of magnitude only


_CAUSES = {
    Linear.OPEN: "Friction is lost beside the other forces; move slowly, so that little but friction is left.",
    Linear.MASS: "The force of inertia is too small; accelerate more.",
    Linear.STIFFNESS: "It hardly gives way under these forces, or never carries them; excite near its resonance.",
    Linear.DAMPING: "Its force is small beside that of the spring; excite at a higher frequency.",
}


def told(
    kind: type[Element] | None,
    parameter: Parameter,
    profile: Profile,
    space: Space,
    index: int,
    comparisons: Sequence[Comparison],
    values: Mapping[str, float],
) -> Told:
    """Whether a parameter is told by the records, and why not."""
    name, unit = parameter.name, parameter.unit
    low, high = (format_quantity(v, unit) if unit else f"{v:.4g}" for v in parameter.interval)
    least = format_quantity(float(space.lower[index]), unit) if unit else f"{space.lower[index]:g}"
    below, above = profile.lower.told, profile.upper.told
    if below and above:
        wide = parameter.interval[1] > _WIDE * parameter.interval[0]
        how = f"; only its order of magnitude, {low} to {high}" if wide else ""
        return Told(True, f"{name}: told{how}.")
    cause = _cause(kind, comparisons)
    if not below and not above:
        return Told(False, f"{name}: cannot be told: any value within its bounds explains the records as well. {cause}")
    if above:
        return Told(False, f"{name}: cannot be told from {least} below {high}. {cause}")
    return Told(False, f"{name}: at least {low}; larger values cannot be told from each other. {cause}")


def _cause(kind: type[Element] | None, comparisons: Sequence[Comparison]) -> str:
    if kind is None:
        return "The records tell too little of the sensor."
    if kind.linear is Linear.CLOSED:
        openings = sum(sum(c.openings.values()) for c in comparisons)
        if openings == 0:
            return "The contact never opens in the best fit; excite it so that the force reverses."
        return f"The contact opens {openings} times, each time for less than the noise shows."
    return _CAUSES[kind.linear]


def suggestions(
    space: Space,
    parameters: Mapping[str, Parameter],
    identifiable: Mapping[str, Told],
    comparisons: Sequence[Comparison],
) -> Iterator[str]:
    """The next experiment, for each parameter that the records do not tell."""
    peak = max(float(np.abs(c.record.force).max()) for c in comparisons)
    travel = max(0.5 * float(np.ptp(c.record.displacement)) for c in comparisons)
    fastest = max(c.experiment.motion.highest for c in comparisons)
    limits = [c.record.force_range for c in comparisons if c.record.force_range is not None]
    room = f", up to the {min(limits):.0f} N of the load cell" if limits and min(limits) > 1.5 * peak else ""
    for name, kind in zip(space.names, space.kinds, strict=True):
        if identifiable[name] or kind is None:
            continue
        upper = parameters[name].interval[1]
        if kind.linear is Linear.CLOSED:
            yield (
                f"{name}: a faster motion in which the force reverses often (now up to {fastest:.3g} Hz and "
                f"{peak:.3g} N{room}), sampled so that crossing {format_quantity(2.0 * upper, 'm')} takes several "
                f"samples."
            )
        elif kind.linear is Linear.OPEN:
            slow = format_quantity(max(travel, 1e-3), "m")
            yield f"{name}: a slow cosine, 0.1 Hz and {slow}, without the flywheel."
        elif kind.linear is Linear.MASS:
            wider = format_quantity(2.0 * travel, "m")
            yield f"{name}: larger accelerations: {wider} at the same frequency, or twice the frequency."
        else:
            yield (
                f"{name}: a multisine or sweep of small amplitude up to twice the present {fastest:.3g} Hz or "
                f"more{room}."
            )
