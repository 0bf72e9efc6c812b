"""The lowest level above some functions under constraints on others, all in logarithms (SLSQP)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.work.progress import count_evaluation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LogRows:
    """Logarithms of functions at a point, and their slopes over the logarithms of its values.

    `under` is 1 for functions bounded by the level and 0 for those bounded by zero; `equal` are those constrained to
    zero.
    """

    logs: Array
    slopes: Array
    under: Array
    equal: Array
    equal_slopes: Array


def lowest_level(
    rows: Callable[[Array], LogRows], start: Array, lower: Array, upper: Array, tolerance: float, most_steps: int
) -> tuple[Array, int]:
    """Minimise t over (log point, t) subject to `rows`; returns the point and the number of evaluations."""
    memory: dict[bytes, LogRows] = {}

    def at(z: Array) -> LogRows:
        key = z[:-1].tobytes()
        if key not in memory:
            memory[key] = rows(np.clip(np.exp(z[:-1]), lower, upper))
            count_evaluation()
        return memory[key]

    first = np.append(np.log(start), 0.0)
    here = at(first)
    first[-1] = float(here.logs[here.under > 0.0].max())
    upwards = np.zeros(first.size)
    upwards[-1] = 1.0
    constraints: list[dict[str, Any]] = [
        {
            "type": "ineq",
            "fun": lambda z: at(z).under * z[-1] - at(z).logs,
            "jac": lambda z: np.hstack([-at(z).slopes, at(z).under[:, None]]),
        }
    ]
    if here.equal.size:
        constraints.append(
            {
                "type": "eq",
                "fun": lambda z: at(z).equal,
                "jac": lambda z: np.hstack([at(z).equal_slopes, np.zeros((at(z).equal.size, 1))]),
            }
        )
    minimize: Any = scipy.optimize.minimize  # the stubs do not know this form of constraints
    result = minimize(
        lambda z: z[-1],
        first,
        jac=lambda z: upwards,
        method="SLSQP",
        bounds=scipy.optimize.Bounds(np.append(np.log(lower), -np.inf), np.append(np.log(upper), np.inf)),
        constraints=constraints,
        options={"maxiter": most_steps, "ftol": tolerance},
    )
    return np.clip(np.exp(result.x[:-1]), lower, upper), len(memory)
