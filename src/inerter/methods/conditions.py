"""Operating conditions: speeds, roads, loads and tyres with their shares, and indices combined over them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError, Status, worst_of
from inerter.formatting import format_number
from inerter.indices.definition import Index, OfIndex
from inerter.indices.measured_road import MeasuredRoad
from inerter.methods.combined_objective import ObjectivePart, combine_objectives
from inerter.methods.composite_index import IndexLike, Ties, estimate_of, estimates_of, is_index, objective_of
from inerter.methods.error_bounds import of_weighted_sum, of_worst
from inerter.methods.method import Estimate, Method, constituents_of
from inerter.methods.objective import Objective, count_of
from inerter.networks.elements import Tied
from inerter.signals.road import Road
from inerter.validation import check_positive, is_listed, is_number
from inerter.vehicle.replace_values import replace_values
from inerter.vehicle.vehicle import Vehicle
from inerter.work.running import map_items

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Condition:
    """Operating condition: replaced numbers of the vehicle and the road, with a share of the time.

    `vehicle` has other numbers of it by their names, such as `sprung_mass`, `tyre_stiffness` or the label of an
    element; `road` is another road, or other numbers of the one of the index, such as `speed`. What is not named stays
    as it is. `share` is how much of the time, or distance, that is; shares need not add up to 1. With `if_there` a
    vehicle need not have all that is named, as one of several designs that are compared.

    Raises `PerformanceIndexError` for a share that is not positive, or what is neither a road nor numbers of one.

    >>> import inerter as it
    >>> loaded = it.Condition(share=0.7, vehicle={"sprung_mass": 320.0}, road={"speed": 30.0}, name="loaded")  # kg, m/s
    >>> loaded.share
    0.7
    """

    share: float = 1.0
    vehicle: Mapping[str, float] = field(default_factory=dict)
    road: Road | Mapping[str, float] = field(default_factory=dict)
    name: str = ""
    if_there: bool = False

    def __post_init__(self) -> None:
        check_positive(PerformanceIndexError, "The share of a condition", self.share)
        if not isinstance(self.vehicle, Mapping):
            raise PerformanceIndexError(
                f"A condition gives numbers of the vehicle by name, such as {{'sprung_mass': 240.0}}, "
                f"got {self.vehicle!r}."
            )
        known = {f.name for f in dataclasses.fields(Road)}
        if not isinstance(self.road, Road) and not (isinstance(self.road, Mapping) and set(self.road) <= known):
            raise PerformanceIndexError(
                f"The road of a condition is a Road, or numbers of one by name ({', '.join(sorted(known))}), "
                f"got {self.road!r}."
            )

    def of(self, index: IndexLike) -> IndexLike:
        """Index on the road of the condition; unchanged if the condition has none."""
        return _on_other_road(index, self.road) if isinstance(self.road, Road) or self.road else index

    def __str__(self) -> str:
        road = {"road": self.road} if isinstance(self.road, Road) else dict(self.road)
        return (
            self.name
            or ", ".join(
                f"{name} = {format_number(value)}" if is_number(value) else f"{name} = {value}"
                for name, value in {**road, **self.vehicle}.items()
            )
            or "unchanged"
        )


@dataclass(frozen=True)
class Conditions:
    """Several conditions, over which an index has a mean and a worst.

    Raises `PerformanceIndexError` if there are none.

    >>> import inerter as it
    >>> use = it.Conditions([
    ...     it.Condition(0.3, road={"speed": 15.0}),
    ...     it.Condition(0.7, road={"speed": 30.0}, vehicle={"sprung_mass": 240.0}),
    ... ])
    >>> strut = it.Spring(120e3) | it.Damper(4981)
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> comfort = it.RideComfort(it.Road(roughness=5e-7, speed=25))
    >>> mean, worst = (it.evaluate(car, over, it.Norm()).value for over in (use.mean(comfort), use.worst(comfort)))
    >>> round(mean, 3), round(worst, 3)
    (2.548, 2.648)
    """

    conditions: tuple[Condition, ...]

    def __init__(self, conditions: Iterable[Condition]) -> None:
        several = tuple(conditions) if is_listed(conditions) else (conditions,)
        if not several or not all(isinstance(one, Condition) for one in several):
            raise PerformanceIndexError(f"Conditions are a list of Condition(...), at least one, got {conditions!r}.")
        object.__setattr__(self, "conditions", several)

    def mean(self, index: IndexLike) -> OverConditions:
        """The mean of the index over the conditions, by their shares."""
        return OverConditions(index, self, worst=False)

    def worst(self, index: IndexLike) -> OverConditions:
        """The largest value of the index in any of the conditions, whatever its share."""
        return OverConditions(index, self, worst=True)

    @property
    def shares(self) -> tuple[float, ...]:
        """The shares, which add up to 1."""
        total = sum(one.share for one in self.conditions)
        return tuple(one.share / total for one in self.conditions)

    @property
    def are_on_one_road(self) -> bool:
        """Whether all conditions have the same measured road, perhaps at different speeds."""
        return len({one.road.shape if isinstance(one.road, Road) else None for one in self.conditions}) == 1


@dataclass(frozen=True)
class OverConditions(OfIndex):
    """An index taken over conditions: its mean by their shares, or the worst of them."""

    index: IndexLike
    conditions: Conditions
    worst: bool

    def __post_init__(self) -> None:
        if not is_index(self.index):
            raise PerformanceIndexError(f"Conditions require an index such as RideComfort(road), got {self.index!r}.")

    @property
    def title(self) -> str:
        """Title of the index, with "mean" or "worst" over conditions where there are several."""
        if len(self.conditions.conditions) == 1:
            return self.index.title
        return f"{self.index.title}, {'worst' if self.worst else 'mean'} over conditions"

    def cases(self, vehicle: Vehicle) -> list[tuple[Vehicle, IndexLike]]:
        """Vehicle and index in each condition; raises `DesignError` for an unknown name."""
        return [
            (replace_values(vehicle, one.vehicle, if_there=one.if_there), one.of(self.index))
            for one in self.conditions.conditions
        ]

    def constituents(self, vehicle: Vehicle) -> Sequence[tuple[Vehicle, Index]]:
        """Constituent indices in all conditions, each with its vehicle."""
        return [asked for case, index in self.cases(vehicle) for asked in constituents_of(case, index)]

    def combine(self, values: Array) -> Array:
        """The mean by shares or the worst (designs,) of values in each condition (conditions, designs)."""
        return np.asarray(values.max(axis=0) if self.worst else np.array(self.conditions.shares) @ values)

    def per_output(self, split: Callable[[Any, Vehicle], Sequence[Any]], vehicle: Vehicle) -> list[OverConditions]:
        """The index of each single output, taken in the same way; `split` takes an index apart."""
        return [dataclasses.replace(self, index=one) for one in split(self.index, vehicle)]

    def estimate(self, vehicle: Vehicle, method: Method) -> Estimate:
        """The value for a vehicle without free values, with those in each condition; notes are those of any of them."""
        found = map_items(partial(_estimate_case, method), self.cases(vehicle))
        status = worst_of(one.status for one in found)
        notes = tuple(dict.fromkeys(note for one in found for note in one.notes))
        if self.worst:
            unknown = (one for one in found if not np.isfinite(one.value))
            worst = next(unknown, None) or max(found, key=lambda one: one.value)
            sources = of_worst(found, worst.value)
            over = dataclasses.replace(worst, status=status, notes=notes, error_sources=sources)
        else:
            over = _mean(found, self.conditions, status, notes)
        return dataclasses.replace(over, in_conditions=tuple(found))

    def estimate_many(self, vehicle: Vehicle, method: Method, points: Mapping[str, Array]) -> Array:
        """The values (designs,) at many values of the free values, nan where one is not ok."""
        columns = []
        for case, index in self.cases(vehicle):
            own = {name: points[name] for name in case.free_values()}
            found = estimates_of(case, [index], method, own)[:, 0]
            columns.append(np.broadcast_to(found, (count_of(points),)))
        return self.combine(np.array(columns))

    def as_objective(self, vehicle: Vehicle, method: Method) -> Objective:
        """The index as a function of the free values of the vehicle, which a condition may fix."""
        names = tuple(vehicle.free_values())
        parts = []
        for (case, index), share in zip(self.cases(vehicle), self.conditions.shares, strict=True):
            own = tuple(case.free_values())
            follow = None if own == names else Ties(names, tuple(Tied((name,)) for name in own))
            parts.append(ObjectivePart(objective_of(case, index, method), follow, 1.0 if self.worst else share))
        return combine_objectives(parts, worst=self.worst)


def values_changed(index: IndexLike) -> frozenset[str]:
    """Names of the numbers of the vehicle that conditions of an index change."""
    inside = values_changed(index.index) if isinstance(index, OfIndex) else frozenset[str]()
    if not isinstance(index, OverConditions):
        return inside
    return inside.union(*(one.vehicle for one in index.conditions.conditions))


def _estimate_case(method: Method, case: tuple[Vehicle, IndexLike]) -> Estimate:
    return estimate_of(*case, method)


def _mean(found: Sequence[Estimate], conditions: Conditions, status: Status, notes: tuple[str, ...]) -> Estimate:
    """The mean by shares; its standard error is the sum of all, which is the most, as conditions may share roads."""
    shares = conditions.shares
    value = sum(share * one.value for share, one in zip(shares, found, strict=True))
    unit = found[0].unit
    sources = of_weighted_sum(found, shares, on_one_road=conditions.are_on_one_road)
    if all(one.standard_error is None for one in found):
        return Estimate(value, unit, status, notes=notes, error_sources=sources)
    error = sum(share * (one.standard_error or 0.0) for share, one in zip(shares, found, strict=True))
    reach = sum(
        share * 0.5 * (one.interval[1] - one.interval[0])
        for share, one in zip(shares, found, strict=True)
        if one.interval is not None
    )
    counts = {len(one.samples) for one in found}
    samples: tuple[float, ...] = ()
    if len(counts) == 1:
        samples = tuple((np.array(shares) @ np.array([one.samples for one in found])).tolist())
    realisations = max(one.realisations for one in found)
    return Estimate(value, unit, status, error, (value - reach, value + reach), realisations, notes=notes,
                    samples=samples, error_sources=sources)  # fmt: skip


def _on_other_road(value: Any, road: Road | Mapping[str, Any]) -> Any:
    """Copy of `value` with another road, or another number of its road, wherever a road is a part of it."""
    if isinstance(road, Road):
        if isinstance(value, Road | MeasuredRoad):
            return road
    elif isinstance(value, Road):
        return dataclasses.replace(value, **road)
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    held = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
    other = {name: _on_other_road(one, road) for name, one in held.items()}
    new = {name: one for name, one in other.items() if one is not held[name]}
    return dataclasses.replace(value, **new) if new else value
