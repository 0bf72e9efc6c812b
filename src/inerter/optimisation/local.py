"""The local search of a smooth index from one starting point, in logarithms of the values and of the index."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.methods.objective import Differentiable
from inerter.work.progress import count_evaluation

Array = NDArray[np.float64]
SAME_PLACE = 0.01  # logarithmic distance up to which two searches approach the same optimum
_NO_VALUE = 700.0  # logarithm that stands for a value that is not there


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
            return _NO_VALUE, np.zeros_like(x)
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
    value = np.inf if result.fun >= _NO_VALUE else float(np.exp(result.fun))
    return LocalOptimum(np.clip(np.exp(result.x), lower, upper), value, int(result.nfev))
