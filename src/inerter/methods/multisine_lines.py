"""An index that is simulated, as a function of the free values: always the same roads, as many for every design."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inerter.errors import StatusKind
from inerter.indices.definition import Index
from inerter.methods.method import Estimate
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
Evaluate = Callable[[Vehicle, Index], Estimate]
_USABLE = (StatusKind.OK, StatusKind.INACCURATE)


class SampledObjective:
    """The `Objective` of a method that simulates: its values, without derivatives."""

    def __init__(self, evaluate: Evaluate, vehicle: Vehicle, index: Index) -> None:
        self.evaluate, self.vehicle, self.index = evaluate, vehicle, index
        self.names = list(vehicle.free_values())

    def values(self, points: Array) -> Array:
        """The index at each row of `points`; infinite where the simulation has no result."""
        return np.array([self._value(point) for point in points])

    def _value(self, point: Array) -> float:
        design = self.vehicle.with_values(dict(zip(self.names, point.tolist(), strict=True)))
        found = self.evaluate(design, self.index)
        return found.value if found.status.kind in _USABLE and np.isfinite(found.value) else np.inf
