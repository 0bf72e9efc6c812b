"""Optima between the swept stiffnesses of Figure 11: where two of its curves cross, and how they compare at one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.optimize

from inerter.methods.norm import Norm
from inerter.optimisation.optimise import optimise
from inerter.papers.wang_su_2008.source import study

if TYPE_CHECKING:
    import xarray as xr

WORSE = 1e-4  # two optima that differ by less, relatively, are equally good: no figure shows it
_PLACE = 55e3  # [N/m] near which the paper finds an elastic S3 worse than S1
_THERE = "there"
_PAIRS = (("J3", "S3-soft", "S3"), ("J3", "S3-hard", "S3"), ("J5", "S3-soft", "S1"), ("J5", "S3-hard", "S1"))
_STARTS = 4
Found = Mapping[str, Mapping[str, Any]]


def names(figure11: xr.Dataset) -> list[str]:
    """Names of the points to compute: index, two layouts, and number of the stiffness before a crossing, or "there"."""
    asked = []
    for index, one, other in _PAIRS:
        first, second = (figure11["value"].sel(layout=layout, index=index).values for layout in (one, other))
        asked += [f"{index} {one} {other} {i}" for i in np.flatnonzero(np.diff(first / second - 1.0 > WORSE))]
    return asked + [f"{index} {one} {other} {_THERE}" for index, one, other in _PAIRS if other == "S1"]


def compute(name: str) -> dict[str, float]:
    """The stiffness [N/m] of a crossing, or how much worse the first layout is at the place, relative.

    Worse means by more than a hundredth of a per cent: where the static compliance decides J5, layouts are equally
    good. A crossing is found by optimising both again.
    """
    index, one, other, point = name.split()
    source = study("figure11")

    def optimal(layout: str, k: float) -> float:
        vehicle = source.design(layout, k)
        method = Norm(source.conventions)
        return optimise(vehicle, source.index(index), method, seed=source.seed, starts=_STARTS).value

    def excess(k: float) -> float:
        return optimal(one, k) / optimal(other, k) - 1.0

    if point == _THERE:
        return {"excess": excess(_PLACE)}
    (swept,) = source.sweeps
    low, high = swept.values[int(point) : int(point) + 2]
    return {"k": float(scipy.optimize.brentq(lambda k: excess(k) - WORSE, low, high, rtol=3e-4))}


def crossings(found: Found, index: str, one: str, other: str) -> list[float]:
    """Stiffnesses k [N/m] at which the optimum of `one` becomes worse than that of `other`, or no longer is."""
    mine = (numbers for name, numbers in found.items() if name.rpartition(" ")[0] == f"{index} {one} {other}")
    return sorted(numbers["k"] for numbers in mine if "k" in numbers)


def excess_there(found: Found, index: str, one: str, other: str) -> float:
    """Relative excess of `one` over `other` at the fixed stiffness."""
    return float(found[f"{index} {one} {other} {_THERE}"]["excess"])
