"""Limits on what a design may be: at most, at least or just so much of an index, each of several outputs by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import PerformanceIndexError
from inerter.indices.question import Combination, Index, OfIndex, Question
from inerter.methods.asking import Asked, is_composed, is_index, objective_of
from inerter.methods.method import Method, check_request
from inerter.methods.objective import Differentiable, Objective
from inerter.units import format_quantity
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
_MOTIONS = ("displacement", "velocity", "acceleration", "relative_displacement", "relative_velocity")


class Sense(Enum):
    """On which side of its value a limited quantity may lie."""

    AT_MOST = "at most"
    AT_LEAST = "at least"
    EQUAL = "equal to"


@dataclass(frozen=True)
class Limit:
    """What an optimum must keep: `of` is an index, `value` is in its SI unit."""

    of: Asked
    sense: Sense
    value: float

    def __post_init__(self) -> None:
        if not is_index(self.of):
            raise PerformanceIndexError(
                f"A limit is put on an index, such as TyreLoad(road) or static_stiffness('strut'), got {self.of!r}."
            )
        if not is_number(self.value) or self.value <= 0.0:
            raise PerformanceIndexError(
                f"The limit of {self.of.title} must be a positive number of {self.of.unit}, got {self.value!r}."
            )

    def __str__(self) -> str:
        return f"{self.of.title} {self.sense.value} {format_quantity(self.value, self.of.unit)}"


def at_most(index: Asked, value: float) -> Limit:
    """The limit that an index is at most `value`, in its SI unit; of several struts or tyres that each is."""
    return Limit(index, Sense.AT_MOST, value)


def at_least(index: Asked, value: float) -> Limit:
    """The limit that an index is at least `value`, in its SI unit; of several struts or tyres that each is."""
    return Limit(index, Sense.AT_LEAST, value)


def equal(index: Asked, value: float) -> Limit:
    """The limit that an index is `value`, in its SI unit; of several struts or tyres that each is."""
    return Limit(index, Sense.EQUAL, value)


def check_limits(subject_to: object) -> tuple[Limit, ...]:
    """`subject_to` as a tuple; raises `PerformanceIndexError` unless it is limits."""
    several = tuple(subject_to) if isinstance(subject_to, Iterable) and not isinstance(subject_to, str) else None
    if several is None or not all(isinstance(one, Limit) for one in several):
        raise PerformanceIndexError(
            f"`subject_to` is a list of limits, such as [at_most(TyreLoad(road), 500.0)], got {subject_to!r}."
        )
    return several


@dataclass(frozen=True)
class OneOutput(OfIndex):
    """An index of one output of another index."""

    index: Index
    output: str

    @property
    def title(self) -> str:
        """That of the index, with the output."""
        return f"{self.index.title} ({self.output})"

    def question(self, mechanism: Mechanism) -> Question:
        """The question of the index with that output alone."""
        whole = self.index.question(mechanism)
        i = [weighted.output for weighted in whole.outputs].index(self.output)
        return replace(whole, outputs=(whole.outputs[i],), filter=(whole.filters[i],))


def output_of(index: object) -> str:
    """The one output of an index, in whatever way it is taken, that a limit holds for by itself; else empty."""
    while not isinstance(index, OneOutput):
        if (inner := getattr(index, "index", None)) is None:
            return ""
        index = inner
    return index.output


def for_each(index: Asked, vehicle: Vehicle) -> Sequence[Asked]:
    """What a limit is put on: each output of an index that has several, unless motions of coordinates are among them.

    The parts of ride comfort add up to what is felt; a strut's travel says nothing of another's.
    """
    if is_composed(index):
        return index.per_output(for_each, vehicle)
    mechanism = vehicle.mechanism()
    question = index.question(mechanism)
    motions = {f"{c.name}_{what}" for c in mechanism.coordinates for what in _MOTIONS}
    names = [weighted.output for weighted in question.outputs]
    if len(names) == 1 or question.combination is not Combination.SUM_OF_RMS or motions & set(names):
        return [index]
    return [OneOutput(index, name) for name in names]


@dataclass(frozen=True, eq=False)
class Bound:
    """A limit on one quantity of a vehicle, as a function of its free values."""

    limit: Limit
    function: Objective

    def excess(self, points: Array) -> Array:
        """By how much the logarithm is beyond its limit at each row of `points`; infinite where nothing is known."""
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.log(self.function.values(points) / self.limit.value)
        off = np.where(np.isnan(off), np.inf, off)
        match self.limit.sense:
            case Sense.AT_MOST:
                return np.asarray(off)
            case Sense.AT_LEAST:
                return np.asarray(np.where(off == np.inf, np.inf, -off))
            case Sense.EQUAL:
                return np.asarray(np.abs(off))


def bounds_of(vehicle: Vehicle, limits: Sequence[Limit], method: Method) -> tuple[Bound, ...]:
    """The limits on each single quantity; raises what `evaluate` raises."""
    found = []
    for limit in limits:
        check_request(vehicle, limit.of, method)
        found += [replace(limit, of=one) for one in for_each(limit.of, vehicle)]
    return tuple(Bound(one, objective_of(vehicle, one.of, method)) for one in found)


def is_smooth(bounds: Sequence[Bound]) -> bool:
    """Whether all of them have gradients."""
    return all(isinstance(bound.function, Differentiable) for bound in bounds)
