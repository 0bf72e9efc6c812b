"""Effect of sensor noise on the estimates, by a parametric bootstrap (Efron and Tibshirani 1993).

Records are drawn from the best fit: the identified device is moved as the motion was measured, and the errors of the
encoder and of the load cell are added. Each of them is fitted too. The scatter of these fits, and their bias against
the device that generated them, enter the intervals in addition to the residuals:

- An encoder has a finite resolution. Near the turning points of a periodic motion, its rounding is the same in every
  period and does not average out.
- The noise that the smoothed displacement still has passes through the model into its force, so values that let less
  of it through seem to fit better (errors in variables).
- With impacts and stick-slip the residuals are not smooth, and the best fit is one of many close local minima.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from inerter.identification.experiment import Experiment
from inerter.identification.intervals import ROBUST, BestFit, steps_of
from inerter.identification.problem import FitProblem, map_problems
from inerter.identification.search import improve
from inerter.identification.sensors import source_of
from inerter.work.progress import counter

Matrix = NDArray[np.float64]
DRAWS = 12
_EVALUATIONS = 5


@dataclass(frozen=True, eq=False)
class Bootstrap:
    """Result of a parametric bootstrap: the fit with wider intervals, its bias, and its predictability."""

    optimum: BestFit  # the same, with intervals at least as wide as they scatter
    bias: Matrix  # of the drawn fits against the generating device, in coordinates; at most two standard errors
    predicted: float  # share of the variance of the force that encoder noise does not change


def bootstrap(problem: FitProblem, optimum: BestFit, seed: int, draws: int = DRAWS) -> Bootstrap:
    """Draw records from the best fit, and fit them.

    Their scatter replaces the curvature, which assumes independent errors; autocorrelation of the residuals is added to
    it. Where residuals exceed the sensor noise, the scatter is scaled by the same factor.
    """
    random = np.random.default_rng([seed, 2])
    lower, upper = problem.space.bounds
    steps = steps_of(optimum)
    source = source_of(problem, optimum.point)
    if source is None:
        return Bootstrap(optimum, np.zeros(optimum.point.size), 0.0)
    drawn = []
    for _ in range(draws):
        experiments = source.draw(random)
        start = optimum.point + optimum.errors * random.standard_normal(optimum.point.size)
        drawn.append((replace(problem, experiments=experiments), np.clip(start, lower, upper)))
    found = map_problems(partial(_refit, optimum.point, steps), drawn, progress=counter("bootstrap", draws))
    points, costs, forces = zip(*found, strict=True)
    shares = [_unchanged_share(source.forces, force, problem.experiments) for force in forces]
    moved = np.array(points) - optimum.point
    unexplained = max(optimum.cost / max(float(np.median(costs)), 1e-300), 1.0)
    few = student.ppf(0.975, draws - 1) / norm.ppf(0.975)
    square = np.var(moved, axis=0, ddof=1) * (1.0 + 1.0 / draws) * unexplained * few**2
    ratio = np.clip(square / np.maximum(np.diag(optimum.covariance), 1e-300), 1.0, 1e4)
    wider = replace(optimum, widening=optimum.widening + ratio - 1.0)
    bias = np.clip(np.mean(moved, axis=0), -2.0 * wider.errors, 2.0 * wider.errors)
    return Bootstrap(wider, np.asarray(bias), float(np.median(shares)))


def _refit(
    truth: Matrix, steps: Matrix, problem: FitProblem, start: Matrix
) -> tuple[Matrix, float, list[Matrix | None]]:
    """The fit to a drawn record from a start, its cost, and the forces there of the device that the record is of."""
    point, cost, _, _ = improve(problem, start, _EVALUATIONS, steps, ROBUST)
    return point, cost, problem.forces(truth)


def _unchanged_share(
    forces: Sequence[Matrix], others: Sequence[Matrix | None], experiments: Sequence[Experiment]
) -> float:
    """Share of the variance of some forces that other forces reproduce."""
    change, total = 0.0, 0.0
    for force, other, e in zip(forces, others, experiments, strict=True):
        if other is None:
            return 0.0
        change += float(np.sum((other - force)[e.kept] ** 2))
        total += float(np.var(force[e.kept]) * e.kept.sum())
    return 1.0 - change / max(total, 1e-300)
