"""Local searches one after another, with progress reports, saved for resumption of a long run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from inerter.optimisation.local import SAME_PLACE, LocalOptimum
from inerter.work.checkpoints import resume_or_compute
from inerter.work.progress import report

Array = NDArray[np.float64]
_SHORTER = 1.25  # later starts are further from an optimum, and many end early
_KEPT = 1e-4  # of a logarithm beyond its limit up to which a value is reported as the lowest
_PROMISING = 0.02  # relative distance from the best up to which a search that has come near is converged fully
TIGHT = 1e-5  # distance of a logarithm from its limit up to which a constraint may be active
SAMPLED, APPROACHED = 0.02, 0.95  # shares of a search that are done with its sample, and with all first searches


def searches_from(
    starts: Sequence[Array], search: Callable[[Array, Sequence[LocalOptimum]], LocalOptimum], end: float
) -> list[LocalOptimum]:
    """The end of a search from each start, which gets those before; `end` is the share of all work done then."""
    found: list[LocalOptimum] = []
    for number, start in enumerate(starts):
        share = end - (end - SAMPLED) * (1.0 - number / len(starts)) ** _SHORTER
        report("starts", number, len(starts), best=lowest_feasible(found), share=share)
        found.append(resumable_search(start, lambda start=start: search(start, found)))  # type: ignore[misc]
    report("starts", len(starts), len(starts), best=lowest_feasible(found), share=end)
    return found


def converge_promising(
    near: Sequence[LocalOptimum], refine: Callable[[LocalOptimum], LocalOptimum]
) -> list[LocalOptimum]:
    """Ends of searches that have come near their optima, the best first.

    `refine` converges those close to the best feasible one, each place once; the others stay as they are.
    """
    near = sorted(near, key=lambda local: (max(local.excess, TIGHT), local.value))
    ended: list[LocalOptimum] = []
    for number, local in enumerate(near):
        if local.excess > near[0].excess + TIGHT or local.value > near[0].value * (1.0 + _PROMISING):
            ended.append(local)
            continue
        here = (end for end in ended if np.abs(np.log(end.point / local.point)).max() < SAME_PLACE)
        same = next(here, None)
        if same is None:
            share = APPROACHED + (1.0 - APPROACHED) * number / len(near)
            report("ends", number, len(near), best=lowest_feasible([*ended, *near]), share=share)
            ended.append(resumable_search(local.point, partial(refine, local)))
        else:
            ended.append(replace(same, evaluations=local.evaluations))
    return ended


def resumable_search(start: Array, search: Callable[[], LocalOptimum]) -> LocalOptimum:
    """The end of a search, as it was kept or as it is found now."""

    def numbers() -> list[float]:
        found = search()
        return [found.value, found.evaluations, found.excess, *found.point]

    value, evaluations, excess, *point = resume_or_compute(start.tobytes(), numbers)
    return LocalOptimum(np.array(point), value, int(evaluations), excess)


def lowest_feasible(found: Sequence[LocalOptimum]) -> float | None:
    """The lowest feasible value; None if there is none yet."""
    values = [local.value for local in found if local.excess <= _KEPT and np.isfinite(local.value)]
    return min(values, default=None)
