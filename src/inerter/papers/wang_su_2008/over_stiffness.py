"""Indices over the static stiffness: how curves differ, with what confidence, and where two of them cross."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from inerter.papers.wang_su_2008.between import WORSE
from inerter.papers.wang_su_2008.judging import ClaimVerdict, EstimatedQuantity, within

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


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
        """Distance of the swept stiffnesses [N/m], the resolution of a figure."""
        return float(np.diff(self.k).max())

    def of(self, layout: str, index: str) -> Array:
        """The values of one curve."""
        return np.asarray(self.data["value"].sel(layout=layout, index=index).values)

    def excess(self, one: str, other: str, index: str) -> Array:
        """Relative excess of `one` over `other` (k,)."""
        return np.asarray(self.of(one, index) / self.of(other, index) - 1.0)

    def uncertain_excess(self, one: str, other: str, index: str) -> list[EstimatedQuantity]:
        """Relative excess of `one` over `other` with its uncertainty, at each stiffness.

        Realisation by realisation, since both had the same ones: common deviations cancel.
        """
        gap, scatter = self.excess(one, other, index), self._scatter(one, other, index)
        doubts = self._doubts(one, other, index)
        return [
            _mean(g, s, r, doubt)
            for g, s, r, doubt in zip(gap, scatter, self._rest(one, other, index), doubts, strict=True)
        ]

    def mean_excess(self, one: str, other: str, index: str, at: Flags) -> EstimatedQuantity:
        """Mean relative excess of `one` over `other` with its uncertainty, over the stiffnesses where `at` is True.

        The realisations are the same at every stiffness, so their deviations are averaged before they are squared.
        """
        doubt = next((d for d in self._doubts(one, other, index)[at] if d), "")
        rest = float(np.mean(self._rest(one, other, index)[at]))
        scatter = self._scatter(one, other, index)[at].mean(axis=0)
        return _mean(float(np.mean(self.excess(one, other, index)[at])), scatter, rest, doubt)

    def crossings(self, one: str, other: str, index: str) -> list[EstimatedQuantity]:
        """Stiffnesses [N/m] where `one` becomes better or worse than `other`, interpolated between swept values.

        A stretch between turns, or before or behind them all, counts if the difference is certain anywhere on it.
        """
        gap, k, found = self.excess(one, other, index), self.k, self.uncertain_excess(one, other, index)
        same = [within(each, -WORSE, WORSE, k.size) for each in found]
        certain = np.array([verdict is ClaimVerdict.CONTRADICTED for verdict in same])
        stretches = np.split(np.arange(k.size), 1 + np.flatnonzero(np.diff(np.sign(gap)) != 0))
        counted = [stretch for stretch in stretches if certain[stretch].any()]
        turns = [(s[-1], after[0]) for s, after in pairwise(counted) if gap[s[-1]] * gap[after[0]] < 0.0]
        return [
            EstimatedQuantity(
                float(k[i] + (k[j] - k[i]) * gap[i] / (gap[i] - gap[j])),
                float(max(found[i].error, found[j].error) * (k[j] - k[i]) / abs(gap[i] - gap[j])),
                min(found[i].freedom, found[j].freedom),
                found[i].doubt or found[j].doubt,
            )
            for i, j in turns
        ]

    def order(self, layouts: Iterable[str], index: str, at: Flags) -> list[str]:
        """The layouts, best first, where `at` holds, by their mean relative to the first one."""
        chosen = list(layouts)
        mean = {name: float(np.mean(self.excess(name, chosen[0], index)[at])) for name in chosen}
        return sorted(chosen, key=mean.__getitem__)

    def _at(self, name: str, layout: str, index: str) -> Array | None:
        return np.asarray(self.data[name].sel(layout=layout, index=index).values) if name in self.data else None

    def _deviations(self, layout: str, index: str) -> Array:
        """Deviation of each realisation from the mean (k, realisations); zero for a linear design."""
        found = self._at("deviation", layout, index)
        return np.zeros((self.k.size, 1)) if found is None else np.nan_to_num(found)

    def _scatter(self, one: str, other: str, index: str) -> Array:
        """Deviation of `excess` in each realisation (k, realisations), to first order."""
        first, second = self.of(one, index)[:, None], self.of(other, index)[:, None]
        a, b = self._deviations(one, index), self._deviations(other, index)
        return np.asarray(a / second - first / second**2 * b)

    def _rest(self, one: str, other: str, index: str) -> Array:
        """Uncertainty of `excess` (k,) not due to the realisations: unresolved harmonics, smoothing."""
        base, zero = self.of(other, index), np.zeros(self.k.size)
        parts = [self._at("unsampled_error", layout, index) for layout in (one, other)]
        return np.asarray(np.hypot(*(zero if part is None else np.nan_to_num(part) for part in parts)) / base)

    def _doubts(self, one: str, other: str, index: str) -> Array:
        statuses = [self._at("status", layout, index) for layout in (one, other)]
        found = np.full(self.k.size, "", dtype=object)
        for status in statuses:
            if status is not None:
                found = np.where((found == "") & (status != "ok"), status, found)
        return found


def _mean(value: float, scatter: Array, rest: float, doubt: str) -> EstimatedQuantity:
    """A mean over realisations that deviate from it by `scatter`, with what else is unsure of it."""
    count = scatter.size
    if count < 2 or not np.any(scatter):
        return EstimatedQuantity(float(value), float(rest), inf, doubt)
    error = np.sqrt(np.sum(scatter**2) / (count * (count - 1)))
    return EstimatedQuantity(float(value), float(np.hypot(error, rest)), count - 1, doubt)
