"""Optima of simulated indices: against a simplex search on the same roads, and over the best linear design."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.optimize
from wang_su import J1, paper_quarter_car

import inerter as it
from inerter import Damper, ExpectedValue, Friction, Gap, Inerter, LoadCarrying, Norm, Spring, free
from inerter.errors import StatusKind
from inerter.optimisation.constrained_search import ConstrainedProblem, trust_region
from inerter.optimisation.local import LocalOptimum, descend
from inerter.work.progress import ProgressStep, receiving_steps

k, shaft = Spring(120e3), Spring(1e6) | Damper(3200.0)
c = Damper(free(500.0, 5e4, "c"))


def value(car, point, index, method):
    return it.evaluate(car.with_values(dict(zip(car.free_values(), point, strict=True))), index, method).value


def simplex(car, index, method, starts):
    """The least value that Nelder and Mead find in logarithms."""
    found = [
        scipy.optimize.minimize(
            lambda x: np.log(value(car, np.exp(x), index, method)),
            np.log(start),
            method="Nelder-Mead",
            options={"xatol": 2e-3, "fatol": 1e-5, "maxfev": 60},
        ).fun
        for start in starts
    ]
    return float(np.exp(min(found)))


@pytest.mark.marathon
def test_friction_moves_the_optimum_and_no_simplex_finds_less():
    car = paper_quarter_car(k | c - (Inerter(free(10.0, 5e3, "b")) | Friction(100.0)))
    method = ExpectedValue(realisations=2, seed=0)
    best = it.optimise(car, J1, method)
    linear = it.optimise(car, J1, Norm())
    start = list(linear.parameters.values())
    at_linear = value(car, start, J1, method)
    assert best.status.ok
    assert best.value <= at_linear * (1.0 + 1e-12)
    assert best.value == pytest.approx(simplex(car, J1, method, [[4e3, 150.0]]), rel=1e-3)
    assert best.value == it.evaluate(best.design, J1, method).value
    assert best.design == car.with_values(best.parameters)
    assert best.gain_over_linear == it.compare(best.design, linear.design, J1, method)
    assert best.gain_over_linear.second.value == at_linear
    assert best.gain_over_linear.difference.value <= 0.0
    assert 1 <= best.n_converged <= best.n_starts
    assert best.evaluations > best.n_starts


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("branch", "index", "method", "starts", "least"),
    [
        (shaft - Gap(5e-4) - Inerter(300.0), J1, ExpectedValue(realisations=2, seed=0), 2, 1e3),
        (Inerter(1000.0) | Friction(100.0), LoadCarrying(1000.0), ExpectedValue(), 1, 2e3),
    ],
    ids=["a gap, without statistical linearisation", "load carrying"],
)
def test_no_scan_finds_less(branch, index, method, starts, least):
    car = paper_quarter_car(k | c - branch)
    best = it.optimise(car, index, method, starts=starts)
    assert best.status.ok
    scan = np.geomspace(least, 3e4, 25)
    assert best.value <= min(value(car, [point], index, method) for point in scan) * (1.0 + 1e-4)
    assert best.gain_over_linear is not None
    assert best.gain_over_linear.difference.value <= 0.0


def test_a_free_friction_has_no_best_linear_design():
    """Linear analysis does not see it, so that there is nothing to compare with; less friction is better here."""
    car = paper_quarter_car(k | Damper(7544.2) - (Inerter(366.52) | Friction(free(1.0, 100.0, "f"))))
    best = it.optimise(car, J1, ExpectedValue(realisations=2, seed=0, conventions="paper2008"), starts=1)
    assert best.gain_over_linear is None
    assert best.parameters["f"] < 5.0
    assert best.status.ok


def test_by_the_norm_there_is_nothing_over_linear():
    assert it.optimise(paper_quarter_car(k | c), J1, Norm()).gain_over_linear is None
    best = it.optimise(paper_quarter_car(k | c), J1, it.StatisticalLinearisation())
    assert best.gain_over_linear.difference.value == pytest.approx(0.0, abs=1e-9)


def test_a_gain_over_a_linear_design_that_breaks_the_limits_is_not_ok():
    """Dampers up to 600 N s/m do not keep the travel that friction keeps."""
    car = paper_quarter_car(k | Damper(free(100.0, 600.0, "c")) | Friction(60.0))
    travel, method = it.SuspensionTravel(J1.road), it.StatisticalLinearisation()
    stiffest = car.with_values({"c": 600.0})
    least = it.evaluate(stiffest, travel, Norm()).value
    limit = it.at_most(travel, 0.5 * (least + it.evaluate(stiffest, travel, method).value))
    assert limit.value < 0.97 * least
    best = it.optimise(car, J1, method, subject_to=[limit])
    assert best.status.kind is not StatusKind.INFEASIBLE
    assert best.limits[0].value <= limit.value * (1.0 + 1e-7)
    assert best.gain_over_linear.second.status.kind is StatusKind.INFEASIBLE
    assert best.gain_over_linear.status.message.startswith("best linear design: no feasible design")


class Bowl:
    """(x / 3)^2 + (3 / x)^2 in each value, whose asked points are counted."""

    def __init__(self):
        self.asked = 0

    def values(self, points):
        self.asked += len(points)
        return np.sum((points / 3.0) ** 2 + (3.0 / points) ** 2, axis=1)


class Steps(list):
    """The steps that are reported."""

    def tell(self, step: ProgressStep) -> None:
        self.append(step)

    def count_evaluation(self) -> None:
        pass


@pytest.mark.parametrize("size", [1, 3])
def test_a_costly_search_counts_each_evaluation_once(size):
    bowl, steps = Bowl(), Steps()
    with receiving_steps(steps):
        found = trust_region(ConstrainedProblem(bowl, (), np.full(size, 1.0), np.full(size, 10.0)), np.full(size, 2.0))
    np.testing.assert_allclose(found.point, 3.0, rtol=1e-2)
    assert [step.done for step in steps] == list(range(1, bowl.asked + 1))
    assert found.evaluations == bowl.asked
    assert {step.total for step in steps} == {60 * size}


def test_no_design_is_simulated_twice(monkeypatch):
    """Also not for the comparison with the best linear design."""
    asked = []

    def estimate(self, vehicle, index):
        asked.append(tuple(vehicle.strut.elements()))
        return simulated(self, vehicle, index)

    simulated = ExpectedValue.estimate
    monkeypatch.setattr(ExpectedValue, "estimate", estimate)
    car, method = paper_quarter_car(k | c | Friction(20.0)), ExpectedValue(realisations=2, seed=0, jobs=1)
    best = it.optimise(car, J1, method, seed=0)
    assert len(asked) == len(set(asked)) > 5
    monkeypatch.undo()
    linear = it.optimise(car, J1, Norm(), seed=0).design
    assert best.gain_over_linear.first == it.evaluate(best.design, J1, method)
    assert best.gain_over_linear.second == it.evaluate(linear, J1, method)


class LogarithmicBowl:
    """An index with its minimum at 3, and the number of times it was asked for."""

    asked = 0

    def value_and_gradient(self, point):
        self.asked += 1
        distance = np.log(point / 3.0)
        return float(1.0 + distance @ distance), 2.0 * distance / point


def test_a_search_that_comes_close_to_a_known_end_has_that():
    lower, upper, start = np.full(2, 0.1), np.full(2, 100.0), np.array([0.7, 40.0])
    alone, told = LogarithmicBowl(), LogarithmicBowl()
    found = descend(alone, start, lower, upper)
    np.testing.assert_allclose(found.point, 3.0, rtol=1e-6)
    known = [LocalOptimum(np.full(2, 1.0), np.inf, 7), LocalOptimum(np.array([3.001, 2.999]), 1.0 + 1e-6, 7)]
    again = descend(told, start, lower, upper, known)
    assert np.array_equal(again.point, known[1].point)
    assert again.value == known[1].value
    assert again.evaluations == told.asked <= alone.asked
