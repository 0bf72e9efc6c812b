"""From one starting point to a local optimum, in logarithms of the values and of the index.

Smooth indices go downhill with their gradient. A peak gain is the largest of many smooth functions, and at its optimum
two or more are equally large: there the level that all of them stay below is minimised instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from inerter.methods.method import Objective

Array = NDArray[np.float64]
_LEVEL_TOLERANCE = 1e-9  # relative height of a peak above the level that ends the minimax search
_MOST_COMPONENTS = 48


@dataclass(frozen=True, eq=False)
class LocalOptimum:
    """Where a search ended, and how many evaluations it took."""

    point: Array
    value: float
    evaluations: int


def descend(objective: Objective, start: Array, lower: Array, upper: Array) -> LocalOptimum:
    """The local optimum that is reached from `start` within the bounds."""
    if objective.active(start) is None:
        return _smooth(objective, start, lower, upper)
    return _minimax(objective, start, lower, upper)


def _smooth(objective: Objective, start: Array, lower: Array, upper: Array) -> LocalOptimum:
    def logarithm(x: Array) -> tuple[float, Array]:
        point = _inside(np.exp(x), lower, upper)
        value, gradient = objective.value_and_gradient(point)
        if not (np.isfinite(value) and value > 0.0 and np.all(np.isfinite(gradient))):
            return 700.0, np.zeros_like(x)
        return float(np.log(value)), gradient * point / value

    bounds = scipy.optimize.Bounds(np.log(lower), np.log(upper))
    result = scipy.optimize.minimize(
        logarithm,
        np.log(start),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": 300, "ftol": 1e-15, "gtol": 1e-9},
    )
    point = _inside(np.exp(result.x), lower, upper)
    return LocalOptimum(point, float(np.exp(result.fun)), int(result.nfev))


def _minimax(objective: Objective, start: Array, lower: Array, upper: Array) -> LocalOptimum:
    """Exchange: minimise the level above the known components, add the peaks that then stand out, repeat."""
    x, evaluations = np.log(start), 1
    best, best_value = start, float(objective.values(start[None])[0])
    known = _active(objective, start)
    for _ in range(30):
        x, level, count = _lowest_level(objective, x, known, np.log(lower), np.log(upper))
        point = _inside(np.exp(x), lower, upper)
        value = float(objective.values(point[None])[0])
        evaluations += count + 1
        if value < best_value:
            best, best_value = point, value
        if not np.isfinite(value) or value <= level * (1.0 + _LEVEL_TOLERANCE):
            break
        known = np.concatenate([known, _active(objective, point)])[-_MOST_COMPONENTS:]
    return LocalOptimum(best, best_value, evaluations)


def _active(objective: Objective, point: Array) -> Array:
    components = objective.active(point)
    assert components is not None
    return components


def _lowest_level(objective: Objective, x: Array, known: Array, low: Array, high: Array) -> tuple[Array, float, int]:
    """Minimise t over (x, t) subject to log component_i(x) <= t for every known component."""
    memory: dict[bytes, tuple[Array, Array]] = {}

    def components(z: Array) -> tuple[Array, Array]:
        key = z[:-1].tobytes()
        if key not in memory:
            point = np.exp(np.clip(z[:-1], low, high))
            values, gradients = objective.components(point, known)
            memory[key] = np.log(values), gradients * point / values[:, None]
        return memory[key]

    def slack(z: Array) -> Array:
        return np.asarray(z[-1] - components(z)[0])

    def slack_jacobian(z: Array) -> Array:
        return np.column_stack([-components(z)[1], np.ones(known.size)])

    direction = np.zeros(x.size + 1)
    direction[-1] = 1.0
    first = np.append(x, 0.0)
    first[-1] = float(components(first)[0].max())
    minimize: Any = scipy.optimize.minimize  # the stubs do not know this form of constraints
    result = minimize(
        lambda z: z[-1],
        first,
        jac=lambda z: direction,
        method="SLSQP",
        bounds=scipy.optimize.Bounds(np.append(low, -np.inf), np.append(high, np.inf)),
        constraints={"type": "ineq", "fun": slack, "jac": slack_jacobian},
        options={"maxiter": 100, "ftol": 1e-13},
    )
    found = np.clip(result.x[:-1], low, high)
    level = float(components(np.append(found, 0.0))[0].max())
    return found, float(np.exp(level)), len(memory)


def _inside(point: Array, lower: Array, upper: Array) -> Array:
    """exp(log(bound)) may miss the bound by rounding."""
    return np.clip(point, lower, upper)
