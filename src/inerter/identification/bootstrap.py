"""Effect of sensor noise on the estimates, by a parametric bootstrap (Efron and Tibshirani 1993).

Records are drawn from the best fit: the identified device is moved as the motion was measured, and the errors of the
encoder and of the load cell are added. Each of them is fitted too. Their scatter widens the intervals, and their bias
against the device that generated them is subtracted, for what the curvature at the best fit does not contain:

- An encoder has a finite resolution. Near the turning points of a periodic motion, its rounding is the same in every
  period and does not average out.
- The noise that the smoothed displacement still has passes through the model into its force, so values that let less
  of it through seem to fit better (errors in variables).
- With impacts and stick-slip the residuals are not smooth, and the best fit is one of many close local minima.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtr
from scipy.stats import chi2

from inerter.identification.experiment import Experiment
from inerter.identification.intervals import ROBUST, BestFit, steps_of
from inerter.identification.problem import FitProblem, map_problems
from inerter.identification.search import improve
from inerter.identification.sensors import source_of
from inerter.methods.averages import CONFIDENCE, NORMAL_QUANTILE
from inerter.work.progress import counter

Matrix = NDArray[np.float64]
DRAWS = 12
_EVALUATIONS = 5
_SIGNIFICANT = 2.0  # standard errors of the mean of drawn fits, beyond which it is a bias
_RATIOS = np.geomspace(1e-3, 1e5, 161)  # of variances, at which their predictive widening is computed


@dataclass(frozen=True, eq=False)
class Bootstrap:
    """Result of a parametric bootstrap: the fit with wider intervals, its bias, and its predictability."""

    optimum: BestFit  # the same, with intervals widened by their scatter
    bias: Matrix  # of the drawn fits against the generating device, in coordinates, where it is significant
    predicted: float  # share of the variance of the force that encoder noise does not change


def bootstrap(problem: FitProblem, optimum: BestFit, seed: int, draws: int = DRAWS) -> Bootstrap:
    """Draw records from the best fit, and fit them.

    Their scatter and the residuals' autocorrelation widen the intervals by curvature, which assumes independent errors,
    for the same reason: noise that passes through the model. The larger of the two counts (`predictive_widening`).
    Where residuals exceed the sensor noise, the scatter is scaled by the same factor.
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
    ratio = np.var(moved, axis=0, ddof=1) * unexplained / np.maximum(np.diag(optimum.covariance), 1e-300)
    mean = np.mean(moved, axis=0)
    biased = np.abs(mean) > _SIGNIFICANT * np.std(moved, axis=0, ddof=1) / np.sqrt(draws)
    of_mean = np.where(biased, 1.0 + 1.0 / draws, 1.0)  # a mean that is subtracted scatters too
    wider = replace(optimum, widening=np.maximum(optimum.widening, of_mean * predictive_widening(ratio, draws)))
    bias = np.where(biased, np.clip(mean, -2.0 * wider.errors, 2.0 * wider.errors), 0.0)
    return Bootstrap(wider, np.asarray(bias), float(np.median(shares)))


def predictive_widening(ratio: Matrix, draws: int) -> Matrix:
    """Inflation factor of the variance by curvature for 95 % predictive coverage, given the sample variance over it.

    A priori the true ratio is 1, with probability one half, or above it with density r^-1.5 / 4; given the sample
    variance of `draws` normal values over that by curvature, the interval has the predictive probability of 95 %
    (Gelman et al. 2013, chapter 3, for a scaled inverse chi-square likelihood). So few draws that agree with the
    curvature widen it hardly, and those that contradict it by the factor of about Student's t.
    """
    larger = np.maximum(ratio, 1.0)
    return larger * np.interp(np.log(np.maximum(ratio, 1e-300)), np.log(_RATIOS), _widening_table(draws))


@cache
def _widening_table(draws: int) -> Matrix:
    """Predictive widening over the larger of one and the ratio, at `_RATIOS`."""
    freedom = draws - 1
    step = np.linspace(0.0, np.log(1e7), 2001)  # of the logarithm of the true ratio
    true = np.append(1.0, np.exp(step))
    prior = np.append(0.5, 0.25 * np.exp(-0.5 * step) * step[1])

    def widening(ratio: float) -> float:
        likelihood = chi2.logpdf(freedom * ratio / true, freedom) - np.log(true)
        weight = prior * np.exp(likelihood - likelihood.max())

        def excess_miss_probability(factor: float) -> float:
            missed = ndtr(-(factor * NORMAL_QUANTILE / np.sqrt(true)))
            return float(2.0 * weight @ missed / weight.sum() - (1.0 - CONFIDENCE))

        return float(brentq(excess_miss_probability, 0.5, 1e4) ** 2)

    return np.array([widening(float(ratio)) / max(float(ratio), 1.0) for ratio in _RATIOS])


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
