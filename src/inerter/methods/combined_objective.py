"""Objectives that are made of others: a sum of them or the largest of them, each over values that may follow from ours.

Sums and maxima of functions that are smooth, or the largest of smooth ones, are such functions again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from inerter.methods.objective import Differentiable, Objective

Array = NDArray[np.float64]
_MOST_OF_EACH, _MOST_SUMS = 4, 24  # peaks of each part that a sum combines, and combinations that it tells


class ValueMap(Protocol):
    """Map from our values to those of a part of the objective."""

    def values(self, points: Array) -> Array:
        """Values (n, inner), one row for each of `points`."""
        ...

    def slopes(self, point: Array) -> Array:
        """Derivatives (inner, outer) of the part's values at one point."""
        ...


@dataclass(frozen=True, eq=False)
class ObjectivePart:
    """An objective over values that follow from ours (over ours, without), times `scale`, plus `offset`."""

    objective: Any
    follow: ValueMap | None = None
    scale: float = 1.0
    offset: float = 0.0

    def values(self, points: Array) -> Array:
        """Scaled and offset objective at each row of `points`; infinite where a dependent value is not positive."""
        if self.follow is None:
            return np.asarray(self.scale * self.objective.values(points) + self.offset)
        inner = self.follow.values(points)
        good = _possible(inner)
        result = np.full(points.shape[0], np.inf)
        if good.any():
            result[good] = self.scale * self.objective.values(np.ascontiguousarray(inner[good])) + self.offset
        return result

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The value with its gradient over our values."""
        inner, slopes = self._inner(point)
        if inner is None:
            return np.inf, np.zeros(point.size)
        value, gradient = self.objective.value_and_gradient(inner)
        return self.scale * value + self.offset, self.scale * (gradient if slopes is None else gradient @ slopes)

    def active(self, point: Array) -> Any:
        """Active components of the objective at `point`; empty where a dependent value is not positive."""
        inner, _ = self._inner(point)
        return np.zeros(0) if inner is None else self.objective.active(inner)

    def components(self, point: Array, which: Any) -> tuple[Array, Array]:
        """Components `which` of the scaled objective, and their gradients over our values."""
        inner, slopes = self._inner(point)
        if inner is None:
            return np.full(len(which), np.inf), np.zeros((len(which), point.size))
        if all(one is None for one in which):
            value, gradient = self.value_and_gradient(point)
            return np.full(len(which), value), np.tile(gradient, (len(which), 1))
        values, gradients = self.objective.components(inner, _to_array(list(which)))
        return self.scale * values + self.offset, self.scale * (gradients if slopes is None else gradients @ slopes)

    def _inner(self, point: Array) -> tuple[Array | None, Array | None]:
        if self.follow is None:
            return point, None
        inner = self.follow.values(point[None])
        return (inner[0], self.follow.slopes(point)) if _possible(inner)[0] else (None, None)


def _possible(values: Array) -> NDArray[np.bool_]:
    return np.asarray(np.all((values > 0.0) & np.isfinite(values), axis=1))


def combine_objectives(parts: Sequence[ObjectivePart], *, worst: bool) -> Objective:
    """The sum of the parts or the largest of them; with gradients if all of them have some."""
    values = CombinedObjective(tuple(parts), worst)
    known = all(isinstance(part.objective, Differentiable) for part in parts)
    found: Differentiable | CombinedObjective = DifferentiableCombination(values) if known else values
    return found


@dataclass(frozen=True, eq=False)
class CombinedObjective:
    """Parts of which no gradient is known: an `Objective`."""

    parts: tuple[ObjectivePart, ...]
    worst: bool

    def values(self, points: Array) -> Array:
        """The sum or the largest at each row of `points`."""
        found = np.array([part.values(points) for part in self.parts])
        return np.asarray(found.max(axis=0) if self.worst else found.sum(axis=0))


@dataclass(frozen=True, eq=False)
class DifferentiableCombination:
    """Parts with gradients: a `Differentiable`.

    One of the smooth functions of a maximum is (the number of a part, which of its own), of a sum one of each part;
    None stands for that of a part that is smooth.
    """

    plain: CombinedObjective

    @property
    def _parts(self) -> tuple[ObjectivePart, ...]:
        return self.plain.parts

    def values(self, points: Array) -> Array:
        """The sum or the largest at each row of `points`."""
        return self.plain.values(points)

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The value; the gradient of the sum where all parts are smooth, of the largest else."""
        if not self.plain.worst and all(part.active(point) is None for part in self._parts):
            found = [part.value_and_gradient(point) for part in self._parts]
            return sum(value for value, _ in found), np.sum([gradient for _, gradient in found], axis=0)
        which = self.active(point)
        if not len(which):
            return np.inf, np.zeros(point.size)
        values, gradients = self.components(point, which)
        best = int(np.argmax(values))
        return float(values[best]), gradients[best]

    def active(self, point: Array) -> Any:
        """The smooth functions that matter here, the largest first; None for a sum of smooth parts."""
        found = [part.active(point) for part in self._parts]
        if not self.plain.worst and all(which is None for which in found):
            return None
        each = [[None] if which is None else list(which) for which in found]
        if self.plain.worst:
            several = [(i, one) for i, which in enumerate(each) for one in which]
        else:
            several = list(product(*(which[:_MOST_OF_EACH] for which in each)))
        chosen = _to_array(several)
        if not several:
            return chosen
        order = np.argsort(-self.components(point, chosen)[0], kind="stable")
        return chosen[order if self.plain.worst else order[:_MOST_SUMS]]

    def components(self, point: Array, which: Any) -> tuple[Array, Array]:
        """Components `which` of the combined objective, and their gradients."""
        values, gradients = np.zeros(len(which)), np.zeros((len(which), point.size))
        for i, part in enumerate(self._parts):
            if self.plain.worst:
                mine = np.array([place for place, one in enumerate(which) if one[0] == i], dtype=int)
                wanted = [which[place][1] for place in mine]
            else:
                mine, wanted = np.arange(len(which)), [one[i] for one in which]
            if wanted:
                own = list(dict.fromkeys(wanted))
                found, slopes = part.components(point, own)
                back = [own.index(one) for one in wanted]
                values[mine] += found[back]
                gradients[mine] += slopes[back]
        return values, gradients


def _to_array(several: list[Any]) -> Any:
    """Array of the entries: of floats if all are, else of objects."""
    if all(isinstance(one, float) for one in several):
        return np.array(several, dtype=float)
    found = np.empty(len(several), dtype=object)
    for i, one in enumerate(several):
        found[i] = one
    return found
