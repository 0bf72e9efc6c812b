"""How uncertain a fit says it is, against textbooks, where what is left is known in closed form."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from scipy.stats import norm, t

import inerter as it
from inerter.identification import bootstrap as bootstrapping
from inerter.identification.experiment import experiment_of
from inerter.identification.friction_law import friction_law
from inerter.identification.intervals import best_fit_of
from inerter.identification.noise import uniform_whitening
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.residual_tests import NoiseReference, mean_square
from inerter.identification.staged_protocol import _friction
from inerter.identification.statements.identifiability import Verdict

LEVEL, STROKE, PERIODS, RATE = 10.0, 400, 12, 100.0  # [N], samples in a stroke, periods of two strokes, [Hz]
BLOCKS = 24  # of time, over which a friction law sums its errors: here a stroke each


def slid(level: np.ndarray) -> it.FrictionLaw:
    """The law of a device that slides from end to end, with a friction [N] of this size at each sample."""
    time = (np.arange(2 * PERIODS * STROKE) + 0.5) / RATE
    angle = np.pi * (np.arange(time.size) + 0.5) / STROKE
    return friction_law(it.Record(time, 1e-3 * np.cos(angle), -np.sign(np.sin(angle)) * level))


def test_of_independent_errors_a_level_is_as_uncertain_as_in_linear_regression() -> None:
    """Errors whose sums over any time vanish, so that blocks of them say nothing."""
    sizes = np.random.default_rng(1).uniform(0.02, 0.06, PERIODS * STROKE // 2)
    errors = (sizes[:, None] * [1.0, -1.0, -1.0, 1.0]).ravel()
    law = slid(LEVEL + errors)
    low, high = law.interval
    assert law.samples > 0.8 * errors.size
    assert law.level == pytest.approx(LEVEL, rel=1e-3)
    expected = t.ppf(0.975, BLOCKS - 1) * float(np.std(errors)) / np.sqrt(law.samples)
    assert 0.5 * (high - low) == pytest.approx(expected, rel=0.1)


def test_of_errors_that_stay_for_a_stroke_there_are_as_many_as_strokes() -> None:
    each = np.repeat(np.random.default_rng(2).normal(0.0, 0.1, PERIODS), 2)
    low, high = slid(LEVEL + np.repeat(each, STROKE)).interval
    expected = t.ppf(0.975, BLOCKS - 1) * float(np.std(each, ddof=1)) / np.sqrt(BLOCKS)
    assert 0.5 * (high - low) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("biased", [False, True])
@pytest.mark.parametrize("draws", sampled([3, 5, 12], [3]))
def test_the_interval_of_few_draws_is_that_of_another_draw(
    draws: int, biased: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Student's prediction interval, where scatter and curvature contradict each other; the prior is one draw more."""
    table = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0), seed=0)
    experiment = experiment_of(table.run(it.cosine(1e-3, 3.0), duration=1.0))
    rig = it.Rig(it.Inerter(it.free(10.0, 500.0, name="b")) | it.Friction(10.0))
    problem = FitProblem(rig, space_of(rig), [experiment], [uniform_whitening(experiment.kept, 0.12)])
    optimum = replace(best_fit_of(problem, problem.space.coordinates_of({"b": 113.0})), widening=np.ones(1))
    scatter = np.random.default_rng(draws).normal(0.0, 50.0 * optimum.errors, (draws, 1))
    scatter += (4.0 * np.std(scatter) if biased else 0.0) - np.mean(scatter)  # significant, or none at all
    left = iter(scatter)

    def improve(*arguments: Any) -> tuple[Any, ...]:
        return optimum.point + next(left), optimum.cost, None, None

    monkeypatch.setattr(bootstrapping, "improve", improve)
    found = bootstrapping.bootstrap(problem, optimum, seed=0, draws=draws)
    expected = t.ppf(0.975, draws) * np.std(scatter, axis=0, ddof=0) * np.sqrt(1.0 + biased / draws)
    assert norm.ppf(0.975) * found.optimum.errors == pytest.approx(expected, rel=1e-3)
    assert found.bias == pytest.approx(min(4.0 * np.std(scatter), 2.0 * found.optimum.errors[0]) if biased else 0.0)


@pytest.mark.parametrize("draws", [5, 12])
def test_intervals_of_scatter_and_curvature_cover_95_percent(draws: int) -> None:
    """Of ratios drawn from the prior; half of them are 1, where more than 98 % would be too wide."""
    random, count = np.random.default_rng(draws), 200_000
    larger = np.exp(random.exponential(2.0, count))  # with density r^-1.5 / 2 above 1
    ratio = np.where(random.random(count) < 0.5, 1.0, larger)
    scatter = ratio * random.chisquare(draws - 1, count) / (draws - 1)
    error = np.sqrt(ratio) * random.standard_normal(count)
    covered = np.abs(error) < norm.ppf(0.975) * np.sqrt(bootstrapping.predictive_widening(scatter, draws))
    assert covered.mean() == pytest.approx(0.95, abs=2e-3)
    assert 0.95 < covered[ratio == 1.0].mean() < 0.98


@dataclass
class Still:
    """What a `FitProblem` is to a judge: one record, and a device without force."""

    force: np.ndarray
    offset: bool = False

    @property
    def experiments(self) -> list[Any]:
        return [SimpleNamespace(record=SimpleNamespace(force=self.force))]

    def forces(self, point: np.ndarray) -> list[np.ndarray]:
        return [np.zeros(self.force.size)]


@pytest.mark.parametrize("spread", [0.02, 0.1, 0.2])
@pytest.mark.parametrize(("deviations", "sound"), [(2.9, True), (3.1, False)])
def test_a_misfit_may_be_a_tenth_and_three_standard_deviations_of_sound_sensors(
    spread: float, deviations: float, sound: bool
) -> None:
    white = 0.01 * np.random.default_rng(4).standard_normal(400)
    sizes = 1.0 + spread * np.array([-1.0, 0.0, 1.0])  # whose standard deviation is the spread
    judged = uniform_whitening(np.ones(white.size, dtype=bool), 1.0)
    judge = NoiseReference([judged], [judged], [sizes[:, None] * white])
    usual = np.sqrt(np.mean(sizes**2))
    residual = (1.1 + deviations * spread) * usual * white
    misfit = judge.misfit(Still(residual), np.zeros(0))  # type: ignore[arg-type]
    assert mean_square(residual) == pytest.approx(((1.1 + deviations * spread) * usual) ** 2 * mean_square(white), 1e-3)
    assert misfit.is_noise_limited == sound


def test_an_interval_of_a_friction_test_is_two_quantiles_of_its_standard_error() -> None:
    law = slid(LEVEL + np.repeat(np.random.default_rng(5).normal(0.0, 0.1, 2 * PERIODS), STROKE))
    parameter, verdict = _friction(law)
    low, high = parameter.interval
    assert (parameter.value, verdict.verdict) == (law.level, Verdict.IDENTIFIED)
    assert norm.sf((high - low) / (2.0 * parameter.standard_error)) == pytest.approx(0.025, rel=1e-3)
