"""Objective functions of optimisers: values of an index and, if available, gradients."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_MISSED = 1e-12  # relative distance from a bound that the rounding of a logarithm explains


class Objective(Protocol):
    """An index of a design as a function of its free values, for an optimiser. Points are (values,) or (n, values).

    One that knows no more than its values is costly: searches make do with few of them.
    """

    def values(self, points: Array) -> Array:
        """The index at each row of `points`."""
        ...


@runtime_checkable
class Differentiable(Objective, Protocol):
    """An index with gradients: smooth, or the largest of smooth functions."""

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """Index and its gradient at one point where it is smooth."""
        ...

    def active(self, point: Array) -> Array | None:
        """Active components of a maximum of smooth functions, as `components` takes them; None for a smooth index."""
        ...

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """Values (components,) and gradients (components, values) of the components `which`."""
        ...


class Smooth:
    """The components of a `Differentiable` that is one smooth function: it has none."""

    def active(self, point: Array) -> None:
        """None, as for every smooth index."""

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """Never asked for, as none is active."""
        raise NotImplementedError


def count_of(points: Mapping[str, Array]) -> int:
    """Number of designs of which `points` are the free values: one if there are none."""
    return next(iter(points.values())).size if points else 1


def rows_of(points: Mapping[str, Array], names: Iterable[str]) -> Array:
    """Free values (designs, values) in the order of `names`."""
    columns = [points[name] for name in names]
    return np.ascontiguousarray(np.column_stack(columns)) if columns else np.empty((count_of(points), 0))


def snap_to_bounds(points: Array, lower: Array, upper: Array) -> Array:
    """Values of a search in logarithms, which miss their bounds by a rounding, with the bounds in their place."""
    for end in (lower, upper):
        points = np.where(np.abs(points - end) <= _MISSED * end, end, points)
    return points
