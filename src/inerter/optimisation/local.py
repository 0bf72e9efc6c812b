"""Local searches from one starting point, in logarithms of the values and of the index.

Smooth indices are minimised with their gradient. A peak gain is the largest of many smooth functions, and at its
optimum two or more are equally large: there their upper level is minimised instead. `approach` does that with the peaks
of the current point, which gets close in a few steps; `polish` with fixed frequencies, to which it adds exceeding peaks
until there are none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.methods.objective import Differentiable, Objective
from inerter.optimisation.minimax_level import LogRows, bounded_rows, lowest_level
from inerter.work.progress import count_evaluation, report

Array = NDArray[np.float64]
_LEVEL_TOLERANCE = 1e-9  # relative height of a peak above the level that ends the minimax search
_MOST_PEAKS = 8  # slots for peaks during the approach
SAME_PLACE = 0.01  # logarithmic distance up to which two searches approach the same optimum
_HIDDEN = -700.0  # logarithm of an absent component


@dataclass(frozen=True, eq=False)
class LocalOptimum:
    """Result of a local search, with its number of evaluations."""

    point: Array
    value: float
    evaluations: int
    excess: float = 0.0  # constraint violation of the logarithm


def descend(
    objective: Differentiable, start: Array, lower: Array, upper: Array, known: Sequence[LocalOptimum] = ()
) -> LocalOptimum:
    """The local optimum of a smooth index that is reached from `start` within the bounds.

    It is one of those `known` if the search comes as close to that as `SAME_PLACE`.
    """
    reached: list[LocalOptimum] = []

    def logarithm(x: Array) -> tuple[float, Array]:
        point = np.clip(np.exp(x), lower, upper)  # exp(log(bound)) may miss the bound by rounding
        value, gradient = objective.value_and_gradient(point)
        count_evaluation()
        if not (np.isfinite(value) and value > 0.0 and np.all(np.isfinite(gradient))):
            return -_HIDDEN, np.zeros_like(x)
        return float(np.log(value)), gradient * point / value

    def stop_at_known(x: Array) -> None:
        near = (end for end in known if np.isfinite(end.value) and np.abs(x - np.log(end.point)).max() < SAME_PLACE)
        reached.extend(near)
        if reached:
            raise StopIteration

    minimize: Any = scipy.optimize.minimize
    result = minimize(
        logarithm,
        np.log(start),
        jac=True,
        callback=stop_at_known if known else None,
        method="L-BFGS-B",
        bounds=scipy.optimize.Bounds(np.log(lower), np.log(upper)),
        options={"maxiter": 300, "ftol": 1e-15, "gtol": 1e-9},
    )
    if reached:
        return replace(reached[0], evaluations=int(result.nfev))
    value = np.inf if result.fun >= -_HIDDEN else float(np.exp(result.fun))
    return LocalOptimum(np.clip(np.exp(result.x), lower, upper), value, int(result.nfev))


def trust_region(objective: Objective, start: Array, lower: Array, upper: Array) -> LocalOptimum:
    """The local optimum of a costly index near `start`, by a trust-region search without derivatives."""
    best, count, most = [LocalOptimum(start, np.inf, 0)], [0], 60 * start.size
    origin = np.log(start)

    def logarithm(x: Array) -> float:
        point = start if np.array_equal(x, origin) else np.clip(np.exp(x), lower, upper)
        value = float(objective.values(point[None])[0])
        count[0] += 1
        report_costly_search(count[0], most, best[0])
        if value < best[0].value:
            best[0] = LocalOptimum(point, value, 0)
        return float(np.log(value)) if 0.0 < value < np.inf else -_HIDDEN

    result = scipy.optimize.minimize(
        logarithm,
        origin,
        method="COBYQA",
        bounds=scipy.optimize.Bounds(np.log(lower), np.log(upper)),
        options={"initial_tr_radius": 0.1, "final_tr_radius": 1e-3, "maxfev": most},
    )
    return LocalOptimum(best[0].point, best[0].value, int(result.nfev))


def report_costly_search(count: int, most: int, best: LocalOptimum) -> None:
    """Report the number of evaluations, out of at most `most`, and the best value."""
    lowest = best.value if np.isfinite(best.value) else None
    report("evaluations", count, most, best=lowest, share=count / most)


def approach(objective: Differentiable, start: Array, lower: Array, upper: Array) -> LocalOptimum:
    """Close to a minimax optimum: the level above the peaks, each followed as it moves."""

    def peaks(point: Array) -> LogRows:
        which = _active_peaks(objective, point)[:_MOST_PEAKS]
        values, gradients = objective.components(point, which)
        logs, slopes = np.full(_MOST_PEAKS, _HIDDEN), np.zeros((_MOST_PEAKS, point.size))
        logs[: which.size], slopes[: which.size] = np.log(values), gradients * point / values[:, None]
        return bounded_rows(logs, slopes)

    point, count = lowest_level(peaks, start, lower, upper, tolerance=1e-7, most_steps=60)
    ends = np.vstack([start, point])
    values = objective.values(ends)
    best = int(np.argmin(values))
    return LocalOptimum(ends[best], float(values[best]), count + 2)


def polish(objective: Differentiable, start: LocalOptimum, lower: Array, upper: Array) -> LocalOptimum:
    """The minimax optimum near `start`: the level above fixed frequencies, to which exceeding peaks are added."""
    best, known, evaluations = start, _active_peaks(objective, start.point), start.evaluations
    point = start.point
    for _ in range(20):

        def at_known_peaks(point: Array, which: Array = known) -> LogRows:
            values, gradients = objective.components(point, which)
            return bounded_rows(np.log(values), gradients * point / values[:, None])

        point, count = lowest_level(at_known_peaks, point, lower, upper, tolerance=1e-13, most_steps=100)
        value, level = float(objective.values(point[None])[0]), float(np.exp(at_known_peaks(point).logs.max()))
        evaluations += count + 2
        if value < best.value:
            best = LocalOptimum(point, value, evaluations)
        if not np.isfinite(value) or value <= level * (1.0 + _LEVEL_TOLERANCE):
            break
        known = np.concatenate([known, _active_peaks(objective, point)])
    return LocalOptimum(best.point, best.value, evaluations)


def _active_peaks(objective: Differentiable, point: Array) -> Array:
    components = objective.active(point)
    assert components is not None
    return components
