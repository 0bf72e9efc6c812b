"""Constraints on indices of a design: at most, at least or equal, separately for each of several outputs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.formatting import format_quantity
from inerter.indices.definition import Combination, Index, IndexDefinition, OfIndex, quantity_words
from inerter.methods.composite_index import IndexLike, is_composite, is_index, objective_of
from inerter.methods.method import Method, check_request
from inerter.methods.objective import Differentiable, Objective
from inerter.validation import is_number, use_python_numbers
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_MOTIONS = ("displacement", "velocity", "acceleration", "relative_displacement", "relative_velocity")


class Sense(Enum):
    """Sense of a constraint."""

    AT_MOST = "at most"
    AT_LEAST = "at least"
    EQUAL = "equal to"

    def excess(self, off: Array) -> Array:
        """Constraint violation at the logarithm `off` of value over limit; negative if satisfied."""
        return -off if self is Sense.AT_LEAST else np.abs(off) if self is Sense.EQUAL else off


@dataclass(frozen=True)
class Limit:
    """A constraint of an optimisation: `of` is an index, `value` is in its SI unit.

    >>> import inerter as it
    >>> limit = it.at_most(it.TyreLoad(it.Road(5e-7, 25.0)), 500.0)
    >>> isinstance(limit, it.Limit), str(limit)
    (True, 'r.m.s. dynamic tyre load at most 500 N')
    """

    of: IndexLike
    sense: Sense
    value: float

    def __post_init__(self) -> None:
        use_python_numbers(self)
        if not is_index(self.of):
            raise PerformanceIndexError(
                f"A constraint requires an index, such as TyreLoad(road) or static_stiffness('strut'), got {self.of!r}."
            )
        if not is_number(self.value) or self.value <= 0.0:
            of_unit = f" of {unit}" if (unit := self.of.unit) else ""
            raise PerformanceIndexError(
                f"The limit of {self.of.title} must be a positive number{of_unit}, got {self.value!r}."
            )

    def __str__(self) -> str:
        return f"{quantity_words(self.of)} {self.sense.value} {format_quantity(self.value, self.of.unit)}"


def at_most(index: IndexLike, value: float) -> Limit:
    """Constraint that an index is at most `value` [its SI unit], separately for each of several struts or tyres.

    >>> import inerter as it
    >>> str(it.at_most(it.SuspensionTravel(it.Road(5e-7, 25.0)), 0.01))  # m
    'r.m.s. suspension travel at most 10 mm'
    """
    return Limit(index, Sense.AT_MOST, value)


def at_least(index: IndexLike, value: float) -> Limit:
    """Constraint that an index is at least `value` [its SI unit], separately for each of several struts or tyres.

    >>> import inerter as it
    >>> str(it.at_least(it.TyreLoad(it.Road(5e-7, 25.0)), 300.0))
    'r.m.s. dynamic tyre load at least 300 N'
    """
    return Limit(index, Sense.AT_LEAST, value)


def equal(index: IndexLike, value: float) -> Limit:
    """Constraint that an index equals `value` [its SI unit], separately for each of several struts or tyres.

    >>> import inerter as it
    >>> str(it.equal(it.TyreLoad(it.Road(5e-7, 25.0)), 300.0))
    'r.m.s. dynamic tyre load equal to 300 N'
    """
    return Limit(index, Sense.EQUAL, value)


def check_limits(subject_to: object) -> tuple[Limit, ...]:
    """`subject_to` as a tuple; raises `PerformanceIndexError` unless it consists of constraints."""
    several = tuple(subject_to) if isinstance(subject_to, Iterable) and not isinstance(subject_to, str) else None
    if several is None or not all(isinstance(one, Limit) for one in several):
        raise PerformanceIndexError(
            f"`subject_to` must be a list of constraints, such as [at_most(TyreLoad(road), 500.0)], got {subject_to!r}."
        )
    return several


@dataclass(frozen=True)
class OneOutput(OfIndex):
    """An index of one output of another index."""

    index: Index
    output: str

    @property
    def title(self) -> str:
        """Title of the index with the output."""
        return f"{self.index.title} ({self.output})"

    def definition(self, mechanism: Mechanism) -> IndexDefinition:
        """The definition of the index with that output only."""
        whole = self.index.definition(mechanism)
        i = [weighted.output for weighted in whole.outputs].index(self.output)
        return replace(whole, outputs=(whole.outputs[i],), filter=(whole.filters[i],))


def output_of(index: object) -> str:
    """The output of an index to which a constraint applies separately; empty if there is none."""
    while not isinstance(index, OneOutput):
        if (inner := getattr(index, "index", None)) is None:
            return ""
        index = inner
    return index.output


def for_each(index: IndexLike, vehicle: Vehicle) -> Sequence[IndexLike]:
    """Constrained quantities: each output of an index with several, unless it includes motions of coordinates.

    The parts of ride comfort are added, but travels of struts are constrained separately.
    """
    if is_composite(index):
        return index.per_output(for_each, vehicle)
    mechanism = vehicle.mechanism()
    definition = index.definition(mechanism)
    motions = {f"{c.name}_{what}" for c in mechanism.coordinates for what in _MOTIONS}
    names = [weighted.output for weighted in definition.outputs]
    if len(names) == 1 or definition.combination is not Combination.SUM_OF_RMS or motions & set(names):
        return [index]
    return [OneOutput(index, name) for name in names]


@dataclass(frozen=True, eq=False)
class Bound:
    """A constraint on one quantity of a vehicle, as a function of its free values."""

    limit: Limit
    function: Objective

    def excess(self, points: Array) -> Array:
        """Constraint violation of the logarithm at each row of `points`; infinite where unknown."""
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.log(self.function.values(points) / self.limit.value)
        return np.where(off < np.inf, self.limit.sense.excess(off), np.inf)


def bounds_of(vehicle: Vehicle, limits: Sequence[Limit], method: Method) -> tuple[Bound, ...]:
    """The constraints on each single quantity; raises the errors of `evaluate`."""
    found = []
    for limit in limits:
        check_request(vehicle, limit.of, method)
        found += [replace(limit, of=one) for one in for_each(limit.of, vehicle)]
    return tuple(Bound(one, objective_of(vehicle, one.of, method)) for one in found)


def is_smooth(bounds: Sequence[Bound]) -> bool:
    """Whether all of them have gradients."""
    return all(isinstance(bound.function, Differentiable) for bound in bounds)
