"""A Pareto front: non-dominated designs with their criteria."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, DesignError, PerformanceIndexError, Status
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import Estimate
from inerter.notebook import shown_by
from inerter.optimisation.active_constraints import ConstraintResult
from inerter.validation import is_number
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """The Pareto front of two or three indices, in ascending order of the first.

    `values` (points, criteria) are the indices of the designs, `estimates` the same with their errors, `parameters`
    their free values, `statuses` those of the points. `jumps` are pairs of neighbours between which the front is
    discontinuous (for two criteria). `limits` has the constraints at each point. `status` gives the reason for a front
    without points.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(it.free(100, 1e5, name="c")))
    >>> road = it.Road(5e-7, 25.0)
    >>> front = it.pareto_front(car, [it.RideComfort(road), it.TyreLoad(road)], it.Norm(), points=3)
    >>> bool((front.ideal <= front.values).all()), front.values.shape  # designs x indices
    (True, (3, 2))
    >>> print(front)
    Pareto front of J1 and J3, 3 points from 1.842 m/s², 551.1 N to 1.846 m/s², 549.9 N
    """

    _repr_html_ = shown_by("inerter.report.notebook:front_html")

    indices: tuple[IndexLike, ...]
    values: Array
    parameters: tuple[dict[str, float], ...]
    designs: tuple[Vehicle, ...]
    statuses: tuple[Status, ...]
    jumps: tuple[tuple[int, int], ...]
    limits: tuple[tuple[ConstraintResult, ...], ...]
    seed: int
    status: Status = OK
    estimates: tuple[tuple[Estimate, ...], ...] = ()

    def __str__(self) -> str:
        if not len(self.values):
            return f"Pareto front without points ({self.status})"
        first, last = (", ".join(map(str, self.estimates[i])) for i in (0, -1))
        names = " and ".join(index.symbol for index in self.indices)
        doubt = "" if self.status.ok else f" ({self.status})"
        return f"Pareto front of {names}, {len(self.values)} points from {first} to {last}{doubt}"

    @property
    def ideal(self) -> Array:
        """Ideal point: the smallest value of each criterion."""
        return np.asarray(self.values.min(axis=0))

    @property
    def nadir(self) -> Array:
        """Nadir point: the largest value of each criterion on the front."""
        return np.asarray(self.values.max(axis=0))

    @property
    def normalised(self) -> Array:
        """The values scaled to 0 for the smallest and 1 for the largest of each criterion on the front."""
        size = self.nadir - self.ideal
        return (self.values - self.ideal) / np.where(size > 0.0, size, 1.0)

    @property
    def knee(self) -> int:
        """Index of the knee: the point farthest from the plane through the ends, in normalised criteria.

        Beyond the knee, improving one criterion costs most in the other. Raises `DesignError` if there are no points.
        """
        if not len(self.values):
            raise DesignError(f"The Pareto front has no points, so no knee: {self.status.message}.")
        return int(np.argmin(self.normalised.sum(axis=1)))

    def hypervolume(self, reference: Sequence[float]) -> float:
        """Hypervolume: area (or volume) dominated by the front up to a reference point, in the units of the indices.

        For two criteria exactly; for three by the package moocore (extra "fronts").

        Raises `PerformanceIndexError` unless the reference has a number for each criterion.
        """
        count = len(self.indices)
        if isinstance(reference, str) or len(reference) != count or not all(map(is_number, reference)):
            raise PerformanceIndexError(
                f"The reference of a hypervolume must have {count} numbers, one for each criterion, got {reference!r}."
            )
        inside = self.values[np.all(self.values < np.array(reference), axis=1)]
        if not len(inside):
            return 0.0
        return _area(inside, *reference) if count == 2 else _volume(inside, reference)


def _area(values: Array, right: float, top: float) -> float:
    order = values[np.argsort(values[:, 0], kind="stable")]
    lowest = np.minimum.accumulate(order[:, 1])
    widths = np.append(order[1:, 0], right) - order[:, 0]
    return float(np.sum(widths * (top - lowest)))


def _volume(values: Array, reference: Sequence[float]) -> float:
    try:
        moocore = import_module("moocore")
    except ImportError:
        raise PerformanceIndexError(
            'The hypervolume of three criteria requires the package moocore: pip install "inerter[fronts]".'
        ) from None
    return float(moocore.hypervolume(values, ref=list(reference)))
