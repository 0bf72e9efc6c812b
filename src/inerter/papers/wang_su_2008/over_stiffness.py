"""Indices over the static stiffness: which curve is certainly higher, and where two of them cross."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.papers.wang_su_2008.between import WORSE

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Intersection:
    """Where one curve becomes better or worse than another [N/m], and its standard error."""

    k: float
    error: float


@dataclass(frozen=True, eq=False)
class Curves:
    """Indices over the static stiffness."""

    data: xr.Dataset

    @property
    def k(self) -> Array:
        """Static stiffness [N/m]."""
        return np.asarray(self.data["k"].values)

    @property
    def step(self) -> float:
        """Between swept stiffnesses [N/m]: what can be read off a figure."""
        return float(np.diff(self.k).max())

    def of(self, layout: str, index: str) -> Array:
        """The values of one curve."""
        return np.asarray(self.data["value"].sel(layout=layout, index=index).values)

    def error(self, layout: str, index: str) -> Array:
        """Their standard errors."""
        if "standard_error" not in self.data:
            return np.zeros(self.k.size)
        return np.asarray(self.data["standard_error"].sel(layout=layout, index=index).fillna(0.0).values)

    def excess(self, one: str, other: str, index: str) -> Array:
        """How much higher `one` is than `other`, relative."""
        return np.asarray(self.of(one, index) / self.of(other, index) - 1.0)

    def excess_error(self, one: str, other: str, index: str) -> Array:
        """The standard error of that."""
        return np.asarray(np.hypot(self.error(one, index), self.error(other, index)) / self.of(other, index))

    def worse(self, one: str, other: str, index: str) -> Flags:
        """Where `one` is higher than `other` by more than can be seen, and than two standard errors."""
        return np.asarray(self.excess(one, other, index) > WORSE + 2.0 * self.excess_error(one, other, index))

    def not_worst(self, one: str, others: Iterable[str], index: str) -> Array:
        """Stiffnesses at which `one` is certainly not the worst."""
        return self.k[np.any([self.worse(other, one, index) for other in others], axis=0)]

    def crossings(self, one: str, other: str, index: str) -> list[Intersection]:
        """Where `one` becomes better or worse than `other`, by linear interpolation between swept values.

        A stretch between turns, or before or behind them all, counts if the difference is certain anywhere on it.
        """
        gap, k, error = self.excess(one, other, index), self.k, self.excess_error(one, other, index)
        certain = self.worse(one, other, index) | self.worse(other, one, index)
        stretches = np.split(np.arange(k.size), 1 + np.flatnonzero(np.diff(np.sign(gap)) != 0))
        counted = [stretch for stretch in stretches if certain[stretch].any()]
        turns = [(s[-1], after[0]) for s, after in pairwise(counted) if gap[s[-1]] * gap[after[0]] < 0.0]
        return [
            Intersection(
                k=float(k[i] + (k[j] - k[i]) * gap[i] / (gap[i] - gap[j])),
                error=float(max(error[i], error[j]) * (k[j] - k[i]) / abs(gap[i] - gap[j])),
            )
            for i, j in turns
        ]

    def order(self, layouts: Iterable[str], index: str, at: Flags) -> list[str]:
        """The layouts, best first, where `at` holds, by their mean relative to the first one."""
        chosen = list(layouts)
        mean = {name: float(np.mean(self.excess(name, chosen[0], index)[at])) for name in chosen}
        return sorted(chosen, key=mean.__getitem__)

    def certainly_better(self, one: str, other: str, index: str, at: Flags) -> bool:
        """Whether `one` is lower than `other` in the mean where `at` holds, by more than two standard errors.

        Errors at different stiffnesses come from the same random inputs and may be correlated.
        """
        gap, error = self.excess(other, one, index)[at], self.excess_error(other, one, index)[at]
        return bool(np.mean(gap) > WORSE + 2.0 * np.mean(error))
