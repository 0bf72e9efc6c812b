"""A front: designs of which none is better than another in every criterion, with what they come to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import OK, DesignError, PerformanceIndexError, Status
from inerter.methods.asking import Asked
from inerter.optimisation.held import Held
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Front:
    """The trade-off between two or three indices, in rising order of the first.

    `values` (points, criteria) are the indices of the designs, `parameters` their free values, `statuses` how far each
    point can be trusted. `jumps` are pairs of neighbours between which the front has no points: there it leaps from one
    kind of design to another (told for two criteria). `limits` has what is limited at each point. `status` says why
    there are no points, if so.
    """

    indices: tuple[Asked, ...]
    values: Array
    parameters: tuple[dict[str, float], ...]
    designs: tuple[Vehicle, ...]
    statuses: tuple[Status, ...]
    jumps: tuple[tuple[int, int], ...]
    limits: tuple[tuple[Held, ...], ...]
    seed: int
    status: Status = OK

    @property
    def ideal(self) -> Array:
        """The least value of each criterion: the ends of the front have them."""
        return np.asarray(self.values.min(axis=0))

    @property
    def nadir(self) -> Array:
        """The largest value of each criterion on the front."""
        return np.asarray(self.values.max(axis=0))

    @property
    def normalised(self) -> Array:
        """The values with 0 for the least and 1 for the largest of each criterion on the front."""
        size = self.nadir - self.ideal
        return (self.values - self.ideal) / np.where(size > 0.0, size, 1.0)

    @property
    def knee(self) -> int:
        """The point that is farthest from the plane through the ends, in normalised criteria.

        Beyond it either criterion is bought dearly. Raises `DesignError` if there are no points.
        """
        if not len(self.values):
            raise DesignError(f"A front without points has no knee: {self.status.message}.")
        return int(np.argmin(self.normalised.sum(axis=1)))

    def hypervolume(self, reference: Sequence[float]) -> float:
        """The area (or volume) that the front dominates up to a reference point, in the units of the indices.

        Of two criteria exactly; of three by the package moocore (extra "fronts").

        Raises `PerformanceIndexError` unless the reference has a number for each criterion.
        """
        count = len(self.indices)
        if isinstance(reference, str) or len(reference) != count or not all(map(is_number, reference)):
            raise PerformanceIndexError(
                f"The reference of a hypervolume has {count} numbers, one for each criterion, got {reference!r}."
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
            'The hypervolume of three criteria needs the package moocore: pip install "inerter[fronts]".'
        ) from None
    return float(moocore.hypervolume(values, ref=list(reference)))
