"""Error sources of estimates, and their propagation through sums and maxima."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from types import MappingProxyType
from typing import TYPE_CHECKING

from inerter.errors import ErrorSource, Status, StatusKind
from inerter.formatting import format_alike

if TYPE_CHECKING:
    from inerter.methods.method import Estimate

ROUNDING = "rounding"
_SAME = 1e-6  # relative difference up to which a search and the method itself have the same value
Effects = Mapping[str, Sequence[float]]  # effects of errors of a road on a value, by source
STAND_INS = 0.1  # relative error of a value that is ok by what stands in for its excitation, such as a line for a road


def with_error_sources(estimate: Estimate, own: Sequence[ErrorSource], promise: float) -> Estimate:
    """Estimate with a method's `own` error sources before those of approximated excitations, which it already has.

    Status and sources are those of `judge_errors`.
    """
    status, sources = judge_errors(estimate.value, estimate.status, own, estimate.error_sources, promise)
    return replace(estimate, status=status, error_sources=sources)


def with_verified_value(estimate: Estimate, searched: float) -> Estimate:
    """The estimate of a design, inaccurate where it differs from the value by which a search found the design."""
    if not estimate.status.ok or abs(estimate.value - searched) <= _SAME * abs(searched):
        return estimate
    one, other = format_alike([searched, estimate.value], estimate.unit)
    message = f"the value of the search, {one}, differs from that of the design, {other}"
    return replace(estimate, status=Status(StatusKind.INACCURATE, message))


def judge_errors(
    value: float, status: Status, own: Sequence[ErrorSource], stand_ins: Sequence[ErrorSource], promise: float
) -> tuple[Status, tuple[ErrorSource, ...]]:
    """Status of a value, and its error sources: a method's `own`, then those of approximated excitations.

    Inaccurate where its own exceed `promise`, or the others `STAND_INS`. A value that is infinite is so exactly, and
    one that is not known has no error.
    """
    if not math.isfinite(value):
        return status, (ErrorSource(ROUNDING, 0.0),) if math.isinf(value) else ()
    for several, most in ((own, promise), (stand_ins, STAND_INS)):
        bound = sum([source.bound for source in several])
        if status.ok and not bound <= most:
            largest = max(several, key=lambda source: source.bound)
            up_to, promised = format_alike([bound, most], "", 2)
            message = f"relative error up to {up_to}, more than {promised}, mostly from {largest.name}"
            if math.isnan(bound):
                unknown = ", ".join(source.name for source in several if math.isnan(source.bound))
                message = f"unknown error from {unknown}"
            status = Status(StatusKind.INACCURATE, message)
    return status, (*own, *stand_ins)


def of_weighted_sum(
    parts: Sequence[Estimate], weights: Sequence[float], *, on_one_road: bool = True
) -> tuple[ErrorSource, ...]:
    """Error sources of a sum of estimates with positive weights; none where one of them names none.

    Effects of errors of one road add up with their signs and by their bands, all other errors by their sizes.
    """
    total = sum(weight * part.value for weight, part in zip(weights, parts, strict=True))
    if not math.isfinite(total) or total == 0.0 or not all(part.error_sources for part in parts):
        return ()
    found: dict[str, ErrorSource] = {}
    for weight, part in zip(weights, parts, strict=True):
        share = weight * abs(part.value / total)
        for source in part.error_sources:
            known = found.get(source.name, ErrorSource(source.name, 0.0))
            effects = source.shared if on_one_road else ()
            shared = tuple(a + share * b for a, b in zip_longest(known.shared, effects, fillvalue=0.0))
            alone = known.bound - math.hypot(*known.shared) + share * (source.bound - math.hypot(*effects))
            found[source.name] = ErrorSource(source.name, alone + math.hypot(*shared), shared)
    return tuple(found.values())


def of_worst(parts: Sequence[Estimate], value: float) -> tuple[ErrorSource, ...]:
    """Error sources of the largest of some estimates, `value`; none where one of them names none.

    It is off by no more than that one of them whose error is the largest. As another one may be the largest in truth,
    no other value shares that error.
    """
    if not math.isfinite(value) or value == 0.0 or not all(part.error_sources for part in parts):
        return ()
    widest = max(parts, key=lambda part: abs(part.value) * part.error_bound)
    share = abs(widest.value / value)
    return tuple(ErrorSource(source.name, share * source.bound) for source in widest.error_sources)


def improvement_bound(
    value: float,
    base: float,
    bound: float,
    base_bound: float,
    shared: Effects = MappingProxyType({}),
    base_shared: Effects = MappingProxyType({}),
) -> float:
    """Largest error of an improvement [%], of values with these relative errors; nan where none is known.

    Infinite where the base value may be zero by its own error. Of errors that both share, the `shared_errors` of each
    estimate, the difference counts.
    """
    if not math.isfinite(value) or not base or math.isnan(bound + base_bound):
        return math.nan
    if base_bound >= 1.0:
        return math.inf
    alone = sum(whole - size_of_effects(of) for whole, of in ((bound, shared), (base_bound, base_shared)))
    apart = {
        name: [a - b for a, b in zip_longest(shared.get(name, ()), base_shared.get(name, ()), fillvalue=0.0)]
        for name in {**shared, **base_shared}
    }
    return 100.0 * abs(value / base) * (alone + size_of_effects(apart)) / (1.0 - base_bound)


def size_of_effects(effects: Effects) -> float:
    """Bound of errors of a road with these effects by source: those of one source are independent."""
    return sum(math.hypot(*several) for several in effects.values())
