"""What limits come to at an optimum: what each quantity is, whether it holds the optimum back, and what that costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import Status, StatusKind, worst_of
from inerter.methods.asking import estimate_of
from inerter.methods.method import Estimate, Method
from inerter.optimisation.constrained import KEPT_COSTLY, Limited, sensitivities
from inerter.optimisation.limits import Limit, Sense
from inerter.units import format_quantity
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_ACTIVE, _ACTIVE_COSTLY = 1e-5, 1e-3  # distance of a logarithm from its limit at which this holds an optimum back


@dataclass(frozen=True)
class Held:
    """A limited quantity at an optimum.

    `sensitivity` is by how many per cent the index changes if the limit is made one per cent larger: 0 if it does not
    hold the optimum back, nan if it does and the method gives no gradients, or if the design does not keep it.
    """

    limit: Limit
    estimate: Estimate
    active: bool
    sensitivity: float

    @property
    def label(self) -> str:
        """The limit in words."""
        return str(self.limit)

    @property
    def value(self) -> float:
        """What the quantity is."""
        return self.estimate.value

    @property
    def excess(self) -> float:
        """By how much its logarithm is beyond its limit; negative if it is not."""
        with np.errstate(divide="ignore"):
            off = float(np.log(self.value / self.limit.value))
        return {Sense.AT_MOST: off, Sense.AT_LEAST: -off, Sense.EQUAL: abs(off)}[self.limit.sense]


def held_at(problem: Limited, design: Vehicle, method: Method, point: Array, *, known: bool) -> tuple[Held, ...]:
    """The limits at a design; `known` is whether it is an optimum whose multipliers can be told."""
    if not problem.bounds:
        return ()
    near = _ACTIVE if known else _ACTIVE_COSTLY
    slopes = sensitivities(problem, point) if known else [np.nan] * len(problem.bounds)
    found = []
    for bound, slope in zip(problem.bounds, slopes, strict=True):
        held = Held(bound.limit, estimate_of(design, bound.limit.of, method), False, 0.0)
        active = bound.limit.sense is Sense.EQUAL or held.excess >= -near
        found.append(Held(held.limit, held.estimate, active, slope if active else 0.0))
    return tuple(found)


def with_limits(estimate: Estimate, held: Sequence[Held]) -> Estimate:
    """The estimate of an optimum, whose status is no better than those of the quantities that keep its limits."""
    unsure = [one for one in held if not one.estimate.status.ok]
    status = worst_of((estimate.status, *(one.estimate.status for one in unsure)))
    if status == estimate.status:
        return estimate
    first = next(one for one in unsure if one.estimate.status == status)
    message = (
        f"the limit {first.label} is kept by {format_quantity(first.value, first.limit.of.unit)}, which is not sure"
    )
    return replace(estimate, status=Status(status.kind, f"{message}: {status.message}"))


def infeasible(held: Sequence[Held], parameters: Mapping[str, float], units: Mapping[str, str]) -> Status:
    """That no design keeps the limits, and which comes nearest, with its parameters in their units."""
    missed = [one for one in held if not one.excess <= KEPT_COSTLY] or list(held)
    limits = " with ".join(one.label for one in held)
    nearest = " and ".join(f"{one.limit.of.title} {format_quantity(one.value, one.limit.of.unit)}" for one in missed)
    at = ", ".join(f"{name} = {format_quantity(value, units[name])}" for name, value in parameters.items())
    return Status(
        StatusKind.INFEASIBLE,
        f"no design was found between the bounds that has {limits}; the nearest, at {at}, has {nearest}",
    )
