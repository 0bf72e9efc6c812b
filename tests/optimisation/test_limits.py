"""Optima within limits: against a second solver of another kind, against themselves with limits moved, and in words."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.optimize
from campaigns import sampled
from hypothesis import given
from hypothesis import strategies as st
from strategies import random_half_car, random_quarter_car
from wang_su import J1, J3, J5, paper_quarter_car

import inerter as it
from inerter.errors import ErrorSource, Status, StatusKind
from inerter.methods.multisine_lines import SampledObjective
from inerter.optimisation.active_constraints import ConstraintResult, with_limits
from inerter.optimisation.constrained_search import ConstrainedProblem
from inerter.optimisation.limits import Bound, Sense, bounds_of, for_each

NORM = it.Norm()
RESPONSE = it.RandomResponse({"force": 1.0}, it.WhiteForce("push", 1.0))  # whose outputs decide its unit


def strut(rng):
    """A strut of two to four free values."""
    free = lambda low, high, name: it.free(low, high, name=name)  # noqa: E731
    damper, inerter = it.Damper(free(100.0, 1e5, "c")), it.Inerter(free(1.0, 3e3, "b"))
    spring = it.Spring(free(5e4, 4e5, "k1"))
    return [
        it.Spring(80e3) | damper - inerter,
        it.Spring(80e3) | damper | inerter,
        it.Spring(60e3) | damper - spring - inerter,
        it.Spring(free(3e4, 3e5, "k")) | damper - inerter,
        it.Spring(free(3e4, 3e5, "k")) | damper - inerter - (spring | it.Damper(1e3)),
    ][int(rng.integers(5))]


def problem(number):
    """A random car, an index, one or two limits that hold its optimum back or nearly so, and a step to move them by."""
    rng = np.random.default_rng([number, 2031])
    while True:
        car = random_quarter_car(rng, strut(rng))
        index, first, second = rng.permutation(np.array([J1, J3, J5], dtype=object)).tolist()
        free = it.optimise(car, index, NORM)
        worst, best = it.evaluate(free.design, first, NORM).value, it.optimise(car, first, NORM).value
        if worst > 1.1 * best:  # else the two hardly contradict each other
            break
    limits = [it.at_most(first, best * (worst / best) ** float(rng.uniform(0.3, 0.95)))]
    step = 3e-4 * np.log(worst / best)
    if number % 2:
        within = it.optimise(car, second, NORM, subject_to=limits).value
        here = it.evaluate(it.optimise(car, index, NORM, subject_to=limits).design, second, NORM).value
        if here > 1.02 * within:
            limits.append(it.at_most(second, within * (here / within) ** float(rng.uniform(0.5, 1.2))))
            step = min(step, 3e-4 * np.log(here / within))
    return car, index, limits, step


def by_evolution(car, index, limits, seed=0):
    """The same problem by differential evolution: no gradients, no starts, no logarithm of the index."""
    bounds = [tuple(np.log((v.lower, v.upper))) for v in car.free_values().values()]
    functions = [it.Norm().objective(car, one) for one in (index, *(limit.of for limit in limits))]
    at = lambda f, x: f.values(np.ascontiguousarray(np.exp(np.atleast_2d(x.T))))  # noqa: E731
    scale = float(at(functions[0], np.array([[0.5 * (a + b)] for a, b in bounds]))[0])

    def penalised(x):
        over = sum(
            np.maximum(at(f, x) / limit.value - 1.0, 0.0) for f, limit in zip(functions[1:], limits, strict=True)
        )
        value = at(functions[0], x)
        return np.where(over > 0.0, scale * (1e3 + np.minimum(over, 1e6)), value)

    found = scipy.optimize.differential_evolution(
        penalised, bounds, vectorized=True, updating="deferred", popsize=24, maxiter=400, tol=1e-10, polish=False,
        mutation=(0.4, 0.9), rng=np.random.default_rng(seed),
    )  # fmt: skip
    return float(found.fun)


@pytest.mark.parametrize("number", sampled(range(50), [7], kept=1))
def test_a_second_solver_finds_the_same_optimum(number):
    car, index, limits, _ = problem(number)
    best = it.optimise(car, index, NORM, subject_to=limits)
    assert best.status.ok
    for held in best.limits:
        assert held.value <= held.limit.value * (1.0 + 1e-6)
    other = by_evolution(car, index, limits)
    assert best.value <= other * (1.0 + 1e-7)
    assert other <= best.value * (1.0 + 2e-3)  # evolution creeps along what is limited


@pytest.mark.parametrize("number", sampled(range(50), kept=1))
def test_what_a_limit_costs_is_what_moving_it_costs(number):
    car, index, limits, step = problem(number)
    best = it.optimise(car, index, NORM, subject_to=limits)
    for i, held in enumerate(best.limits):
        moved = []
        for factor in np.exp([step, -step]).tolist():
            others = [*limits[:i], it.at_most(limits[i].of, limits[i].value * factor), *limits[i + 1 :]]
            moved.append(it.optimise(car, index, NORM, subject_to=others).value)
        rising, falling = np.log(moved[0] / best.value) / step, np.log(best.value / moved[1]) / step
        assert min(rising, falling) - 1e-3 <= held.sensitivity <= max(rising, falling) + 1e-3
        assert held.sensitivity == pytest.approx(0.5 * (rising + falling), rel=3e-2, abs=2e-3)
        assert best.sensitivities[held.label] == held.sensitivity
        assert (held.label in best.active_limits) == held.active


def quarter(low=100.0):
    return paper_quarter_car(it.Spring(120e3) | it.Damper(it.free(low, 1e5, "c")) - it.Inerter(it.free(1.0, 2e3, "b")))


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("limit", "sign"), [(it.at_least(J3, 560.0), 1.0), (it.equal(J3, 510.0), 1.0), (it.equal(J5, 3e-5), -1.0)]
)
def test_limits_from_below_and_equalities(limit, sign):
    best = it.optimise(quarter(), J1, NORM, subject_to=[limit])
    (held,) = best.limits
    assert held.value == pytest.approx(limit.value, rel=1e-6)
    values = [
        it.optimise(quarter(), J1, NORM, subject_to=[type(limit)(limit.of, limit.sense, limit.value * f)]).value
        for f in (1.0 + 1e-3, 1.0 - 1e-3)
    ]
    slope = np.log(values[0] / values[1]) / np.log(1.001 / 0.999)
    assert held.sensitivity == pytest.approx(slope, rel=2e-2)
    assert np.sign(slope) == sign


def test_a_limit_that_does_not_matter_changes_nothing():
    alone, within = (
        it.optimise(quarter(), J1, NORM),
        it.optimise(quarter(), J1, NORM, subject_to=[it.at_most(J3, 900.0)]),
    )
    assert within.value == pytest.approx(alone.value, rel=1e-9)
    assert within.active_limits == ()
    assert list(within.sensitivities.values()) == [0.0]


def test_what_nothing_keeps_is_said_with_the_nearest_that_is():
    best = it.optimise(quarter(), J1, NORM, subject_to=[it.at_most(J3, 490.0)])
    assert best.status.kind is it.StatusKind.INFEASIBLE
    assert best.limits[0].value == pytest.approx(it.optimise(quarter(), J3, NORM).value, rel=1e-6)
    assert "r.m.s. dynamic tyre load at most 490 N" in best.status.message
    assert "501.2 N" in best.status.message
    assert np.isnan(best.limits[0].sensitivity)


@pytest.mark.parametrize(
    ("limit", "bound", "kind"),
    [
        (it.at_most(J3, 119.0), 0.2, "inaccurate"),
        (it.at_most(J3, 121.0), 0.2, "ok"),
        (it.at_least(J3, 81.0), 0.2, "inaccurate"),
        (it.at_least(J3, 79.0), 0.2, "ok"),
        (it.equal(J3, 100.0), 0.2, "inaccurate"),
        (it.at_most(J3, 1e9), np.nan, "inaccurate"),
        (it.at_most(J3, 1e9), 1e-14, "inaccurate"),  # by something that no bound covers
    ],
)
def test_an_uncertain_quantity_makes_an_optimum_uncertain_where_its_error_may_break_the_limit(limit, bound, kind):
    doubt = Status(StatusKind.INACCURATE, "as an example")
    estimate = it.Estimate(100.0, "N", doubt, error_sources=(ErrorSource("road", bound),))
    best = with_limits(it.Estimate(1.0, "m/s^2"), [ConstraintResult(limit, estimate, False, 0.0)])
    assert str(best.status.kind) == kind


def test_a_limit_over_two_tyres_holds_for_each():
    rng = np.random.default_rng(5)
    front, rear = (it.Spring(60e3) | it.Damper(it.free(100.0, 1e5, name)) for name in ("cf", "cr"))
    car = random_half_car(rng, front, rear)
    free = it.optimise(car, J1, NORM)
    each = [it.evaluate(free.design, one, NORM).value for one in for_each(J3, car)]
    limit = 0.97 * max(each)
    best = it.optimise(car, J1, NORM, subject_to=[it.at_most(J3, limit)])
    assert [held.limit.of.output for held in best.limits] == ["tyre_front_load", "tyre_rear_load"]
    assert best.status.ok
    assert max(held.value for held in best.limits) == pytest.approx(limit, rel=1e-6)
    whole = it.evaluate(best.design, J3, NORM).value
    assert whole == pytest.approx(sum(held.value for held in best.limits), rel=1e-12)
    assert for_each(J1, car) == [J1]  # bounce and pitch add up to what is felt


@dataclass(frozen=True)
class WithoutGradients(it.Norm):
    """Norms of which a search knows the values alone, as of what is simulated."""

    def objective(self, vehicle, index):
        return SampledObjective(self.estimate, vehicle, index)


@pytest.mark.campaign
@pytest.mark.parametrize("limit", [it.at_most(J5, 2.7e-5), it.at_least(J3, 520.0), it.equal(J3, 510.0)])
def test_searches_without_gradients_find_the_same(limit):
    best = it.optimise(quarter(), J1, NORM, subject_to=[limit])
    other = it.optimise(quarter(), J1, WithoutGradients(), subject_to=[limit])
    assert other.status.ok
    assert other.value == pytest.approx(best.value, rel=2e-4)
    assert other.limits[0].value == pytest.approx(limit.value, rel=2e-4)
    assert other.active_limits == best.active_limits
    assert np.isnan(other.limits[0].sensitivity)


@pytest.fixture
def screw_car():
    screw = it.Inerter(it.free(1.0, 2e3, "b")) | it.Friction(20.0)
    return paper_quarter_car(it.Spring(120e3) | it.Damper(it.free(100.0, 1e5, "c")) - screw)


def test_limits_with_friction(screw_car):
    limit = it.at_most(it.LoadCarrying(amplitude=1000.0), 2.7e-5)
    best = it.optimise(screw_car, J1, it.StatisticalLinearisation(), subject_to=[limit])
    assert best.limits[0].value == pytest.approx(limit.value, rel=1e-6)
    assert best.limits[0].sensitivity < 0.0
    assert best.gain_over_linear is not None


@pytest.mark.campaign
def test_limits_of_what_is_simulated(screw_car):
    car, method = screw_car, it.ExpectedValue(realisations=2, seed=0)
    least, here = it.optimise(car, J3, method).value, it.evaluate(it.optimise(car, J1, method).design, J3, method).value
    limit = it.at_most(J3, 0.5 * (least + here))
    best = it.optimise(car, J1, method, subject_to=[limit])
    assert best.status.ok
    assert best.limits[0].value == pytest.approx(limit.value, rel=3e-3)
    assert best.limits[0].value <= limit.value * (1.0 + 1e-4)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda: it.at_most(J1, 0.0), "must be a positive number of m/s\\^2"),
        (lambda: it.at_most(J1, float("nan")), "must be a positive number"),
        (
            lambda: it.at_most(RESPONSE, -1.0),
            "must be a positive number, got -1.0",
        ),
        (lambda: it.at_most("J1", 1.0), "requires an index"),
        (lambda: it.at_most(it.RideComfort, 1.0), "requires an index"),
        (lambda: it.optimise(quarter(), J1, NORM, subject_to=it.at_most(J3, 1.0)), "must be a list of constraints"),
        (lambda: it.optimise(quarter(), J1, NORM, subject_to=[J3]), "must be a list of constraints"),
        (lambda: it.optimise(quarter(), J1, NORM, subject_to="J3"), "must be a list of constraints"),
        (
            lambda: it.optimise(quarter(), J1, NORM, subject_to=[it.equal(it.static_stiffness("front"), 1.0)]),
            "Unknown mount 'front'",
        ),
    ],
)
def test_limits_that_cannot_be(given, said):
    with pytest.raises(it.InerterError, match=said):
        given()


def test_weighted_comfort_with_a_limit_on_travel():
    road = it.Road.iso8608("B", speed=25.0)
    comfort, travel = it.RideComfort(road, weighting="Wk"), it.SuspensionTravel(road)
    best = it.optimise(quarter(), comfort, NORM, subject_to=[it.at_most(travel, 0.003)])
    assert best.limits[0].value == pytest.approx(0.003, rel=1e-7)
    names, slopes = list(best.parameters), []
    for index in (comfort, travel):  # at the optimum the gradients balance
        logs = []
        for name in names:
            ends = [{**best.parameters, name: best.parameters[name] * factor} for factor in (1.0 + 1e-4, 1.0 - 1e-4)]
            up, down = (it.evaluate(quarter().with_values(end), index, NORM).value for end in ends)
            logs.append(np.log(up / down) / 2e-4)
        slopes.append(np.array(logs))
    assert slopes[0] == pytest.approx(best.limits[0].sensitivity * slopes[1], abs=1e-6)
    assert best.sensitivities == {"r.m.s. suspension travel at most 3 mm": best.limits[0].sensitivity}


@pytest.mark.parametrize("seed", sampled(range(4), [0], kept=1))
def test_a_peak_gain_that_some_design_has_can_be_asked_for(seed):
    """Its highest peak is the one that has to be there, whichever of two unequal ones that is."""
    rng = np.random.default_rng([seed, 77])
    car = random_quarter_car(
        rng, it.Spring(80e3) | it.Damper(it.free(100.0, 1e5, "c")) | it.Inerter(it.free(1.0, 3e3, "b"))
    )
    while True:
        point = {"c": 10.0 ** rng.uniform(2.5, 4.5), "b": 10.0 ** rng.uniform(0.5, 3.0)}
        there = it.evaluate(car.with_values(point), J5, NORM)
        if len(there.peaks) > 1 and there.peaks[1].gain < 0.9 * there.value:
            break
    best = it.optimise(car, J1, NORM, subject_to=[it.equal(J5, there.value)])
    assert best.status.ok, best.status
    assert it.evaluate(best.design, J5, NORM).value == pytest.approx(there.value, rel=1e-6)
    assert best.value <= it.evaluate(car.with_values(point), J1, NORM).value * (1.0 + 1e-9)
    more, less = (it.optimise(car, J1, NORM, subject_to=[it.equal(J5, there.value * f)]) for f in (1.001, 0.999))
    slope = np.log(more.value / less.value) / np.log(1.001 / 0.999)
    assert best.limits[0].sensitivity == pytest.approx(slope, rel=0.02, abs=1e-4)


@pytest.mark.parametrize("number", range(4))
def test_a_start_counts_the_less_the_further_it_is_beyond_a_limit(number):
    car, index, limit = random_quarter_car(np.random.default_rng(number), strut(np.random.default_rng(number))), J1, J3
    names = list(car.free_values().values())
    lower, upper = np.array([v.lower for v in names]), np.array([v.upper for v in names])
    points = np.exp(np.random.default_rng(number).uniform(np.log(lower), np.log(upper), (40, lower.size)))
    values, limited = (NORM.objective(car, one).values(points) for one in (index, limit))
    bound = float(np.median(limited))
    found = ConstrainedProblem(
        NORM.objective(car, index), bounds_of(car, [it.at_most(limit, bound)], NORM), lower, upper
    )
    factor = found.values(points) / values
    np.testing.assert_allclose(factor[limited <= bound], 1.0, rtol=1e-12)
    beyond = np.argsort(limited)[np.sort(limited) > bound]
    assert np.all(factor[beyond] > 1.0)
    assert np.all(np.diff(factor[beyond]) > 0.0)


@given(st.floats(-5.0, 5.0))
def test_an_equality_is_violated_by_the_worse_of_both_sides(off: float) -> None:
    most, least, equal = (float(sense.excess(np.array(off))) for sense in (Sense.AT_MOST, Sense.AT_LEAST, Sense.EQUAL))
    assert most == off == -least
    assert equal == max(most, least)


@pytest.mark.parametrize("sense", Sense)
def test_an_unknown_or_infinite_quantity_violates_every_limit(sense: Sense) -> None:
    road = it.Road(5e-7, 25.0)
    bound = Bound(it.at_most(it.TyreLoad(road), 500.0), _Constant())
    bound = replace(bound, limit=replace(bound.limit, sense=sense))
    assert bound.excess(np.array([[np.nan], [np.inf]])).tolist() == [np.inf, np.inf]


class _Constant:
    """The quantity is the only value of each point."""

    def values(self, points: np.ndarray) -> np.ndarray:
        return points[:, 0]


def test_an_equality_that_no_free_value_changes_keeps_no_search_from_the_optimum() -> None:
    """The spring is fixed, so that the equality holds everywhere, to rounding, and has no slope."""
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(20e3) | it.Damper(it.free(300.0, 8e3, name="c")))
    free = it.optimise(car, J1, NORM)
    grip = it.at_most(J3, 0.98 * it.evaluate(free.design, J3, NORM).value)
    plain, fixed = (
        it.optimise(car, J1, NORM, subject_to=limits)
        for limits in ([grip], [it.equal(it.static_stiffness("strut"), 20e3), grip])
    )
    assert plain.value > 1.0001 * free.value
    assert fixed.value == pytest.approx(plain.value, rel=1e-9)
    assert (fixed.status.kind, fixed.n_converged) == (plain.status.kind, plain.n_converged)


@pytest.mark.parametrize(("index", "other"), [(J1, J3), (J3, J1), (J5, J1)])
def test_limits_that_the_best_design_keeps_are_no_search_of_their_own(index, other, monkeypatch):
    """A design that no other one betters anywhere is the best of those within limits, too, if it keeps them."""
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(it.free(1.0, 3e3, "b")))
    best = it.optimise(car, index, NORM)
    known = it.evaluate(best.design, other, NORM).value
    narrow = it.optimise(car, index, NORM, subject_to=[it.at_most(other, 0.98 * known)])
    assert narrow.value > best.value * (1.0 + 1e-6)  # a limit that it does not keep
    monkeypatch.setattr(ConstrainedProblem, "rows", lambda *given: pytest.fail("searched within limits"))
    limits = [it.at_most(other, 1.01 * known), it.at_least(other, 0.5 * known)]
    within = it.optimise(car, index, NORM, subject_to=limits)
    assert within.value == pytest.approx(best.value, rel=1e-12)
    assert within.status.ok
    assert [held.value for held in within.limits] == pytest.approx([known, known], rel=1e-6)
    assert not within.active_limits
    assert list(within.sensitivities.values()) == pytest.approx([0.0, 0.0], abs=1e-9)
