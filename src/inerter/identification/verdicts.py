"""Identifiability of each parameter, and the recommended experiments for those not identified."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from inerter.identification.fit import Parameter, RecordFit
from inerter.identification.intervals import CostProfile
from inerter.identification.parameter_space import Space
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.networks.elements.roles import LinearRole
from inerter.records.finding import Finding
from inerter.records.smoothing import resolution
from inerter.statements import Severity

_WIDE = 3.0  # ends of an interval this far apart, as a ratio, give an order of magnitude only
_ROOM = 1.5  # times the largest force: a load cell with a larger range has a margin


def identifiability(
    parameter: Parameter, profile: CostProfile, space: Space, index: int, comparisons: Sequence[RecordFit]
) -> Identifiability:
    """Verdict on a parameter, with the reason where it is not identified."""
    low, high = parameter.interval
    below, above = profile.lower.known, profile.upper.known
    if below and above:
        verdict = Verdict.MAGNITUDE if high > _WIDE * low else Verdict.IDENTIFIED
    elif not below and not above:
        verdict = Verdict.ANY
    else:
        verdict = Verdict.BELOW if above else Verdict.ABOVE
    kind = space.kinds[index]
    return Identifiability(
        name=parameter.name,
        verdict=verdict,
        unit=parameter.unit,
        interval=parameter.interval,
        least=float(space.lower[index]),
        role=None if kind is None else kind.linear,
        openings=sum(sum(c.openings.values()) for c in comparisons),
    )


def suggestions(
    space: Space,
    parameters: Mapping[str, Parameter],
    identifiable: Mapping[str, Identifiability],
    comparisons: Sequence[RecordFit],
) -> Iterator[Finding]:
    """The recommended experiment for each parameter that the records do not identify."""
    peak = max(float(np.abs(c.record.force).max()) for c in comparisons)
    travel = max(0.5 * float(np.ptp(c.record.displacement)) for c in comparisons)
    step = min(resolution(c.record.displacement) for c in comparisons)
    fastest = max(c.experiment.motion.highest for c in comparisons)
    limit = min((c.record.force_range for c in comparisons if c.record.force_range is not None), default=0.0)
    motion = {"fastest": fastest, "peak": peak, "limit": limit if limit > _ROOM * peak else None}
    for name, kind in zip(space.names, space.kinds, strict=True):
        if identifiable[name] or kind is None:
            continue
        held = identifiable[name].held
        if held is not None:
            yield Finding(FitFinding.BREAK_AWAY, Severity.INFO, name, {**motion, "held": held})
            continue
        if kind.linear is LinearRole.CLOSED:
            width = 2.0 * parameters[name].interval[1]
            if width < step:
                yield Finding(FitFinding.BELOW_RESOLUTION, Severity.INFO, name, {"width": width, "step": step})
            else:
                yield Finding(FitFinding.FASTER_REVERSALS, Severity.INFO, name, {**motion, "width": width})
        elif kind.linear is LinearRole.OPEN:
            yield Finding(FitFinding.SLOW_COSINE, Severity.INFO, name, {"travel": max(travel, 1e-3)})
        elif kind.linear is LinearRole.MASS:
            yield Finding(FitFinding.LARGER_ACCELERATIONS, Severity.INFO, name, {"travel": 2.0 * travel})
        else:
            yield Finding(FitFinding.HIGHER_FREQUENCIES, Severity.INFO, name, motion)
