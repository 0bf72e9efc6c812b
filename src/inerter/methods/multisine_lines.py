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
    """The `Objective` of a method that simulates: its values, without derivatives. Each point is simulated once."""

    def __init__(self, evaluate: Evaluate, vehicle: Vehicle, index: Index) -> None:
        self.evaluate, self.vehicle, self.index = evaluate, vehicle, index
        self.names = list(vehicle.free_values())
        self._estimates: dict[bytes, Estimate] = {}

    def values(self, points: Array) -> Array:
        """The index at each row of `points`; infinite where the simulation has no result."""
        return np.array([self._value(point) for point in points])

    def estimate_at(self, point: Array, evaluate: Evaluate) -> Estimate | None:
        """The estimate at a point, if this very function was asked there."""
        return self._estimates.get(point.tobytes()) if evaluate == self.evaluate else None

    def _value(self, point: Array) -> float:
        found = self._estimates.get(point.tobytes())
        if found is None:
            design = self.vehicle.with_values(dict(zip(self.names, point.tolist(), strict=True)))
            found = self._estimates[point.tobytes()] = self.evaluate(design, self.index)
        return found.value if found.status.kind in _USABLE and np.isfinite(found.value) else np.inf
