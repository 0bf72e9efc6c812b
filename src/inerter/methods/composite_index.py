"""Evaluation of an index by a method, for simple and composed indices, and for dependent values of a design.

A method evaluates one index definition of a mechanism of numbers and free values. An index that combines several
values, or needs no method, is a `CompositeIndex`, which calls the method itself. Values that are tied to others are
free values to a method, and are resolved here. So no method depends on either.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import adopt_renamed
from inerter.indices.definition import DescribedIndex, Index
from inerter.methods.combined_objective import ObjectivePart, combine_objectives
from inerter.networks.elements import Element, Free, Tied, middle
from inerter.vehicle.replace_values import with_elements
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from typing_extensions import TypeIs

    from inerter.methods.method import Estimate, Method
    from inerter.methods.objective import Objective

Array = NDArray[np.float64]


@runtime_checkable
class CompositeIndex(DescribedIndex, Protocol):
    """Composed index: combines several indices, or computes its value without a method."""

    def constituents(self, vehicle: Vehicle) -> Sequence[tuple[Vehicle, Index]]:
        """Constituent indices, each with its vehicle; raises `InerterError` if there are none for it."""
        ...

    def per_output(self, split: Callable[[Any, Vehicle], Sequence[Any]], vehicle: Vehicle) -> Sequence[CompositeIndex]:
        """Composed indices of the single outputs that `split` separates, for constraints on each."""
        ...

    def estimate(self, vehicle: Vehicle, method: Method) -> Estimate:
        """The value for a vehicle without free values."""
        ...

    def estimate_many(self, vehicle: Vehicle, method: Method, points: Mapping[str, Array]) -> Array:
        """The values (designs,) at many values of the free values, nan where one is not ok."""
        ...

    def as_objective(self, vehicle: Vehicle, method: Method) -> Objective:
        """The index as a function of the free values."""
        ...


IndexLike = Index | CompositeIndex


def is_index(given: object) -> bool:
    """Whether an object is an index or a composed index, not its class."""
    if isinstance(given, type):
        return False
    adopt_renamed(given, question="definition")
    return hasattr(given, "definition") or is_composite(given)


def is_composite(index: object) -> TypeIs[CompositeIndex]:
    """Whether an index is composed."""
    return hasattr(index, "constituents") and not isinstance(index, type) and isinstance(index, CompositeIndex)


def estimate_of(vehicle: Vehicle, index: IndexLike, method: Method) -> Estimate:
    """The index of a vehicle without free values."""
    return index.estimate(vehicle, method) if is_composite(index) else method.estimate(vehicle, index)


def estimates_of(vehicle: Vehicle, indices: Sequence[IndexLike], method: Method, points: Mapping[str, Array]) -> Array:
    """The indices (designs, indices) of a vehicle at many values of its free values."""
    untied = without_tied_values(vehicle)
    if untied is not None:
        return _estimates_untied(untied, indices, method, points)
    plain = [index for index in indices if not is_composite(index)]
    together = method.estimate_many(vehicle, plain, points) if plain else np.empty((0, 0))
    columns = iter(together.T)
    return np.column_stack(
        [index.estimate_many(vehicle, method, points) if is_composite(index) else next(columns) for index in indices]
    )


def objective_of(vehicle: Vehicle, index: IndexLike, method: Method) -> Objective:
    """The index as a function of the free values."""
    untied = without_tied_values(vehicle)
    if untied is not None:
        return combine_objectives(
            [ObjectivePart(objective_of(untied.vehicle, index, method), untied.ties)], worst=False
        )
    return index.as_objective(vehicle, method) if is_composite(index) else method.objective(vehicle, index)


@dataclass(frozen=True)
class Ties:
    """Map from the design variables to the values of another design: each a free, tied or fixed value."""

    names: tuple[str, ...]
    inner: tuple[Tied, ...]  # of each value of the other design

    def values(self, points: Array) -> Array:
        """Values of the other design (n, inner), one row for each of `points`."""
        columns = dict(zip(self.names, points.T, strict=True))
        found = [np.broadcast_to(tie.slopes(columns)[0], (points.shape[0],)) for tie in self.inner]
        return np.ascontiguousarray(np.column_stack(found)) if found else np.zeros((points.shape[0], 0))

    def slopes(self, point: Array) -> Array:
        """Derivatives (inner, outer) of those values at one point."""
        known = dict(zip(self.names, point.tolist(), strict=True))
        rows = [tie.slopes(known)[1] for tie in self.inner]
        return np.array([[float(row.get(name, 0.0)) for name in self.names] for row in rows])


@dataclass(frozen=True)
class UntiedDesign:
    """Design whose tied values are design variables, and the map that gives them."""

    vehicle: Vehicle
    ties: Ties


def without_tied_values(vehicle: Vehicle) -> UntiedDesign | None:
    """Design with design variables in place of tied values, and their map; None if there are no tied values.

    Their bounds are half and twice the value that they have in the middle of the bounds of the design variables.
    """
    if not any(isinstance(value, Tied) for value in vehicle.mechanism().open_values):
        return None
    free = vehicle.free_values()
    found: dict[str, Tied] = {}
    names = (name for i in count(1) if (name := f"tied{i}") not in free)
    halfway = {name: middle(value) for name, value in free.items()}

    def free_element(element: Element) -> Element:
        if not isinstance(element.value, Tied):
            return element
        size = float(element.value.slopes(halfway)[0])
        name = next(names)
        found[name] = element.value
        like = Free(0.5 * size, 2.0 * size, name) if 0.0 < size < math.inf else Free(0.5, 2.0, name)
        return type(element).of(
            like, element.label, **{field.name: getattr(element, field.name) for field in element.more}
        )

    untied = with_elements(vehicle, free_element)
    inner = tuple(found.get(name, Tied((name,))) for name in untied.free_values())
    return UntiedDesign(untied, Ties(tuple(free), inner))


def _estimates_untied(
    untied: UntiedDesign, indices: Sequence[IndexLike], method: Method, points: Mapping[str, Array]
) -> Array:
    rows = np.column_stack([points[name] for name in untied.ties.names])
    inner = untied.ties.values(rows)
    good = np.all((inner > 0.0) & np.isfinite(inner), axis=1)
    result = np.full((rows.shape[0], len(indices)), np.nan)
    if good.any():
        values = dict(zip(untied.vehicle.free_values(), inner[good].T, strict=True))
        result[good] = estimates_of(untied.vehicle, indices, method, values)
    return result
