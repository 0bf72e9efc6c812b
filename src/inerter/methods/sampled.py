"""An index that is simulated, as a function of the free values: always the same roads, as many for every design."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import StatusKind
from inerter.indices.question import Index
from inerter.methods.method import Estimate
from inerter.vehicle.cars import Vehicle

Array = NDArray[np.float64]
Evaluate = Callable[[Vehicle, Index], Estimate]
_STEP = 1e-3  # of a relative change, for differences
_USABLE = (StatusKind.OK, StatusKind.INACCURATE)


class SampledObjective:
    """The `Objective` of a method that simulates: costly, and without derivatives of its own."""

    costly = True

    def __init__(self, evaluate: Evaluate, vehicle: Vehicle, index: Index) -> None:
        self.evaluate, self.vehicle, self.index = evaluate, vehicle, index
        self.names = list(vehicle.free_values())

    def values(self, points: Array) -> Array:
        """The index at each row of `points`; infinite where the simulation has no result."""
        return np.array([self._value(point) for point in points])

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The index and its gradient by differences on the same roads."""
        steps = _STEP * point * np.eye(point.size)
        ends = self.values(np.vstack([point + steps, point - steps]))
        gradient = (ends[: point.size] - ends[point.size :]) / (2.0 * _STEP * point)
        return self._value(point), np.asarray(gradient)

    def active(self, point: Array) -> None:
        """Nothing is known of the parts of a peak gain."""

    def components(self, point: Array, which: Array) -> Any:
        """There are none."""
        raise NotImplementedError

    def _value(self, point: Array) -> float:
        design = self.vehicle.with_values(dict(zip(self.names, point.tolist(), strict=True)))
        found = self.evaluate(design, self.index)
        return found.value if found.status.kind in _USABLE and np.isfinite(found.value) else np.inf
