"""Constraints at an optimum: values of the quantities, activity, and sensitivities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status, StatusKind, worst_of
from inerter.formatting import format_quantity
from inerter.indices.definition import quantity_words
from inerter.methods.composite_index import estimate_of
from inerter.methods.error_bounds import STAND_INS
from inerter.methods.method import Estimate, Method
from inerter.optimisation.constrained_search import KEPT_COSTLY, ConstrainedProblem, sensitivities
from inerter.optimisation.limits import Limit, Sense, for_each
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_ACTIVE, _ACTIVE_COSTLY = 1e-5, 1e-3  # distance of a logarithm from its limit within which a constraint is active


@dataclass(frozen=True)
class ConstraintResult:
    """A constrained quantity at an optimum.

    `sensitivity` is the change of the index [%] if the limit is raised by 1 %: 0 for an inactive constraint, nan for an
    active one if the method has no gradients, or if the design is infeasible.
    """

    limit: Limit
    estimate: Estimate
    active: bool
    sensitivity: float

    @property
    def label(self) -> str:
        """The constraint in words."""
        return str(self.limit)

    @property
    def value(self) -> float:
        """Value of the quantity, in the unit of its index."""
        return self.estimate.value

    @property
    def excess(self) -> float:
        """Constraint violation of the logarithm; negative if satisfied."""
        with np.errstate(divide="ignore"):
            return float(self.limit.sense.excess(np.log(self.value / self.limit.value)))

    @property
    def is_safe(self) -> bool:
        """Whether an error bound explains the status, and no value within it and the interval breaks the constraint."""
        low, high = self.estimate.interval or (self.value, self.value)
        bound = self.estimate.error_bound
        if not bound > STAND_INS:
            return False  # the inaccuracy has another cause, whose size is not known
        return {
            Sense.AT_MOST: high * (1.0 + bound) <= self.limit.value,
            Sense.AT_LEAST: low * (1.0 - bound) >= self.limit.value,
            Sense.EQUAL: False,
        }[self.limit.sense]


def constraint_results(
    problem: ConstrainedProblem, design: Vehicle, method: Method, point: Array, *, known: bool
) -> tuple[ConstraintResult, ...]:
    """The constraints at a design; `known` means that it is an optimum with multipliers."""
    if not problem.bounds:
        return ()
    near = _ACTIVE if known else _ACTIVE_COSTLY
    slopes = sensitivities(problem, point) if known else [np.nan] * len(problem.bounds)
    found = []
    for bound, slope in zip(problem.bounds, slopes, strict=True):
        held = ConstraintResult(bound.limit, estimate_of(design, bound.limit.of, method), False, 0.0)
        active = bound.limit.sense is Sense.EQUAL or held.excess >= -near
        found.append(ConstraintResult(held.limit, held.estimate, active, slope if active else 0.0))
    return tuple(found)


def constraints_at(design: Vehicle, limits: Sequence[Limit], method: Method) -> tuple[ConstraintResult, ...]:
    """The constraints at a design that has nothing to be chosen, so that there are no sensitivities."""
    found = []
    for limit in limits:
        for one in for_each(limit.of, design):
            held = ConstraintResult(replace(limit, of=one), estimate_of(design, one, method), False, 0.0)
            active = abs(held.excess) <= _ACTIVE
            found.append(replace(held, active=active, sensitivity=np.nan) if active else held)
    return tuple(found)


def with_limits(estimate: Estimate, held: Sequence[ConstraintResult]) -> Estimate:
    """The estimate of an optimum, with a status no better than those of its constrained quantities.

    An inaccurate quantity counts only where its error may break the constraint.
    """
    unsure = [
        one
        for one in held
        if not one.estimate.status.ok and not (one.estimate.status.kind is StatusKind.INACCURATE and one.is_safe)
    ]
    status = worst_of((estimate.status, *(one.estimate.status for one in unsure)))
    if status == estimate.status:
        return estimate
    first = next(one for one in unsure if one.estimate.status == status)
    message = (
        f"the constraint {first.label} is satisfied by {format_quantity(first.value, first.limit.of.unit)}, which is "
        f"uncertain"
    )
    return replace(estimate, status=Status(status.kind, f"{message}: {status.message}"))


def infeasible(held: Sequence[ConstraintResult], parameters: Mapping[str, float], units: Mapping[str, str]) -> Status:
    """Status of an infeasible problem, with the closest design and its parameters."""
    limits, nearest = _constraint_words(held)
    at = ", ".join(f"{name} = {format_quantity(value, units[name])}" for name, value in parameters.items())
    return Status(
        StatusKind.INFEASIBLE,
        f"no feasible design within the bounds for {limits}; closest: {nearest}, at {at}",
    )


def broken(held: Sequence[ConstraintResult]) -> Status:
    """Status of a design that has nothing to be chosen: "infeasible" where it breaks a constraint, else `OK`."""
    if not any(one.excess > KEPT_COSTLY for one in held):
        return OK
    limits, nearest = _constraint_words(held)
    return Status(StatusKind.INFEASIBLE, f"no feasible design for {limits}: no design variable can change {nearest}")


def _constraint_words(held: Sequence[ConstraintResult]) -> tuple[str, str]:
    """All constraints in words, and the values of those that are broken."""
    labels = list(dict.fromkeys(one.label for one in held))  # a limit has the same one in all conditions
    worst = [max((one for one in held if one.label == label), key=lambda one: one.excess) for label in labels]
    missed = [one for one in worst if not one.excess <= KEPT_COSTLY] or worst
    values = [f"{quantity_words(one.limit.of)} {format_quantity(one.value, one.limit.of.unit)}" for one in missed]
    return " with ".join(labels), " and ".join(values)
