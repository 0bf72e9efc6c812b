"""Intervals of profiles against those of textbooks, on problems whose residuals are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import binom, t

from inerter.identification.intervals import best_fit_of, profiles

TIME = np.linspace(0.0, 1.0, 400)
SIZE = 1e-3  # of the errors: so small that none is an outlier
ALTERNATING = SIZE * np.tile([1.0, -1.0, -1.0, 1.0], 100)  # sums over blocks of time vanish
WIDER = (1.0, 1.1)  # no narrower than the textbook's; some wider, for weights that residuals were asked for


@dataclass
class Explicit:
    """What `Problem` is to intervals, with a formula in the place of simulated records."""

    formula: object  # from coordinates to values at TIME
    measured: np.ndarray
    count: int
    whitenings: tuple = (SimpleNamespace(weight=np.ones(TIME.size)),)
    experiments: tuple = ()

    @property
    def space(self):
        return SimpleNamespace(bounds=(np.full(self.count, -50.0), np.full(self.count, 50.0)))

    def residual(self, point):
        return self.formula(point) - self.measured

    def jacobian(self, point, steps):
        ends = [self.residual(point + step * axis) for step, axis in zip(steps, np.eye(self.count), strict=True)]
        return np.column_stack([(end - self.residual(point)) / step for end, step in zip(ends, steps, strict=True)])


def intervals(problem, start):
    optimum = best_fit_of(problem, np.asarray(start, dtype=float))
    found = profiles(problem, optimum)
    assert all(side.known for p in found for side in (p.lower, p.upper))
    return optimum.point, np.array([(p.lower.end, p.upper.end) for p in found])


@pytest.mark.parametrize("powers", [(0,), (0, 1), (0, 1, 2, 3)])
def test_of_a_linear_model_they_are_those_of_linear_regression(powers):
    columns = np.column_stack([TIME**p for p in powers])
    truth = 1.0 + np.arange(len(powers))
    problem = Explicit(lambda point: columns @ point, columns @ truth + ALTERNATING, truth.size)
    point, ends = intervals(problem, truth + 0.1)
    left = problem.residual(np.linalg.lstsq(columns, problem.measured)[0])
    free = TIME.size - truth.size
    errors = np.sqrt(left @ left / free * np.diag(np.linalg.inv(columns.T @ columns)))
    for sign, end in zip((-1.0, 1.0), ends.T, strict=True):
        ratio = sign * (end - point) / (t.ppf(0.975, free) * errors)
        assert np.all(ratio >= WIDER[0]), ratio
        assert np.all(ratio <= WIDER[1]), ratio


@pytest.mark.parametrize(("model", "truth"), [(lambda x: np.exp(-x * TIME), 3.0), (lambda x: np.sin(x * TIME), 9.0)])
def test_of_a_curved_model_they_end_where_the_sum_of_squares_has_risen(model, truth):
    problem = Explicit(lambda point: model(point[0]), model(truth) + 300.0 * ALTERNATING, 1)

    def squares(x):
        return float(np.sum(problem.residual([x]) ** 2))

    best = minimize_scalar(squares, bracket=(truth - 0.5, truth + 0.5)).x
    risen = squares(best) * (1.0 + t.ppf(0.975, TIME.size - 1) ** 2 / (TIME.size - 1))
    _, ends = intervals(problem, [truth])
    for sign, end in zip((-1.0, 1.0), ends[0], strict=True):
        expected = brentq(lambda x: squares(x) - risen, best, best + 2.0 * sign)
        assert WIDER[0] <= (end - best) / (expected - best) <= WIDER[1]


@pytest.mark.parametrize("end", [0.3, 0.8, 1.5])
def test_they_follow_a_valley_that_bends(end):
    """Values of the second coordinate fit as well as zero, if the first one changes with its square."""
    along = (TIME - 0.5) / np.linalg.norm(TIME - 0.5)
    slope = t.ppf(0.975, TIME.size - 2) * SIZE * np.sqrt(TIME.size / (TIME.size - 2)) / end

    def formula(x):
        across, valley = x[0], 2.0 * x[1] ** 2
        return across + across**3 - valley - valley**3 + slope * x[1] * along

    _, ends = intervals(Explicit(formula, ALTERNATING, 2), [0.0, 0.01])
    ratio = np.abs(ends[1]) / end
    assert np.all((ratio >= 0.97) & (ratio <= 1.1)), ratio


@pytest.mark.campaign
def test_they_hold_the_truth_as_often_as_they_say():
    columns = np.column_stack([np.ones(TIME.size), TIME, np.sin(9.0 * TIME)])
    truth, draws = np.array([1.0, -2.0, 0.5]), 300
    held = np.zeros(3)
    for seed in range(draws):
        errors = SIZE * np.random.default_rng(seed).standard_normal(TIME.size)
        _, ends = intervals(Explicit(lambda point: columns @ point, columns @ truth + errors, 3), truth)
        held += (ends[:, 0] < truth) & (truth < ends[:, 1])
    assert np.all(held >= binom.ppf(1e-3, draws, 0.95))
    assert np.all(held <= binom.ppf(1.0 - 1e-3, draws, 0.98))
