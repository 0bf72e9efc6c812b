"""Optima against brute force on cars that nobody tuned, and what the result says about itself."""

import importlib
import math
from itertools import product

import numpy as np
import pytest
import scipy.optimize
from campaigns import sampled
from strategies import random_half_car, random_quarter_car
from wang_su import J1, J3, J5, paper_quarter_car

import inerter as it
from inerter import (
    Damper,
    Inerter,
    Norm,
    Spring,
    StatusKind,
    evaluate,
    evaluate_many,
    free,
    optimise,
)
from inerter.errors import PerformanceIndexError
from inerter.methods.multisine_lines import SampledObjective
from inerter.optimisation.local import LocalOptimum
from inerter.optimisation.optimise import has_many_optima

k, c, b = Spring(80e3), Damper(free(10.0, 1e6, "c")), Inerter(free(0.01, 1e5, "b"))
screw = Spring(1e6) | Damper(3200.0)
STRUTS = {"S1": k | c, "S2": k | c | b, "S3": k | c - b, "elastic S3": k | c - screw - b}
AGREE = {J1: 1e-6, J3: 1e-6, J5: 1e-4}


def ids(value):
    return {J1: "J1", J3: "J3", J5: "J5"}.get(value)


def family(names, *always, kept=None):
    """Each strut with each index, and those of them that are always tested."""
    return pytest.mark.parametrize(("name", "index"), sampled(product(names, AGREE), always, kept=kept), ids=ids)


def unknown_car(strut, seed=2024):
    return random_quarter_car(np.random.default_rng(seed), strut)


def grid_search(car, index, method):
    """The least value on grids that close in on it, each over a tenth of the one before, from three best places."""
    names, bounds = list(car.free_values()), [(v.lower, v.upper) for v in car.free_values().values()]
    low, high = np.log(np.array(bounds)).T
    count = {1: 400, 2: 60}[len(names)]

    def values(axes):
        mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(names))
        points = dict(zip(names, np.exp(mesh).T, strict=True))
        return mesh, evaluate_many(car, index, points, method)[:, 0]

    mesh, found = values([np.linspace(a, z, count) for a, z in zip(low, high, strict=True)])
    seeds, best = mesh[np.argsort(found)[:200:40]], math.inf
    for centre in seeds:
        width = 3.0 * (high - low) / count
        for _ in range(12):
            axes = [
                np.linspace(max(x - w, a), min(x + w, z), 15)
                for x, w, a, z in zip(centre, width, low, high, strict=True)
            ]
            mesh, found = values(axes)
            centre, width = mesh[np.argmin(found)], 0.4 * width
        best = min(best, float(found.min()))
    return best


@family(STRUTS, ("S1", J3), ("S2", J5), kept=2)
def test_no_grid_finds_less(name, index):
    car, method = unknown_car(STRUTS[name]), Norm()
    best = optimise(car, index, method, seed=1)
    expected = grid_search(car, index, method)
    assert best.status.ok
    assert best.value == pytest.approx(expected, rel=AGREE[index])
    assert best.value <= expected * (1.0 + 1e-7)


@pytest.mark.parametrize("index", sampled(AGREE, [], [J1], kept=1), ids=ids)
def test_no_evolution_finds_less_for_a_half_car_with_four_free_values(index):
    front = k | Damper(free(10.0, 1e6, "cf")) - Inerter(free(0.01, 1e5, "bf"))
    rear = k | Damper(free(10.0, 1e6, "cr")) - Inerter(free(0.01, 1e5, "br"))
    car, method = random_half_car(np.random.default_rng(7), front, rear), Norm()
    best = optimise(car, index, method, seed=0)
    objective = method.objective(car, index)
    evolved = scipy.optimize.differential_evolution(
        lambda x: objective.values(np.ascontiguousarray(np.exp(np.atleast_2d(x.T)))),
        [tuple(np.log((v.lower, v.upper))) for v in car.free_values().values()],
        vectorized=True,
        updating="deferred",
        popsize=20,
        maxiter=60,
        tol=1e-10,
        polish=False,
        rng=np.random.default_rng(0),
    )
    assert best.value <= float(evolved.fun) * (1.0 + 1e-7)


@family(["S2", "S3"], ("S2", J3), kept=2)
def test_twenty_seeds_find_one_value(name, index):
    values = [optimise(paper_quarter_car(STRUTS[name]), index, Norm(), seed=seed).value for seed in range(20)]
    assert max(values) <= min(values) * (1.0 + AGREE[index])


@family(STRUTS, ("S1", J1), ("S2", J3), ("S3", J5), ("elastic S3", J1))
def test_no_small_step_improves_the_optimum(name, index):
    car = unknown_car(STRUTS[name], seed=5)
    best = optimise(car, index, Norm())
    rng, names = np.random.default_rng(0), list(best.parameters)
    steps = rng.standard_normal((400, len(names))) * 10 ** rng.uniform(-5, -1, (400, 1))
    points = {
        name: np.clip(best.parameters[name] * np.exp(steps[:, i]), free_.lower, free_.upper)
        for i, (name, free_) in enumerate(car.free_values().items())
    }
    assert evaluate_many(car, index, points, Norm()).min() >= best.value * (1.0 - 1e-7)


@pytest.mark.parametrize(
    "car",
    [
        paper_quarter_car(Spring(120e3) | c | b),
        paper_quarter_car(Spring(120e3) | c - b),
        unknown_car(STRUTS["S3"], 2024),
        unknown_car(STRUTS["S3"], 5),
        unknown_car(STRUTS["S3"], 6),
    ],
)
def test_the_best_load_carrying_has_two_peaks_of_one_height(car):
    """A minimax optimum inside its bounds, as the J5 designs of Wang and Su (2008) are."""
    best = optimise(car, J5, Norm())
    assert best.active_bounds == {}
    first, second = best.estimate.peaks[:2]
    assert second.gain == pytest.approx(first.gain, rel=1e-6)


def test_the_best_conventional_damper_is_in_closed_form():
    """J1^2 goes as c kt / m^2 + k^2 (m + mu) / (c m^2): least at c = k sqrt((m + mu) / kt)."""
    car = paper_quarter_car(STRUTS["S1"])
    best = optimise(car, J1, Norm())
    expected = 80e3 * math.sqrt((181.75 + 25.0) / 120e3)
    assert best.parameters["c"] == pytest.approx(expected, rel=1e-5)
    assert best.value == pytest.approx(evaluate(car.with_values({"c": expected}), J1, Norm()).value, rel=1e-12)


@pytest.mark.parametrize(("bounds", "side"), [((10.0, 1e3), "upper"), ((5e4, 1e6), "lower")])
def test_a_bound_that_holds_the_optimum_back_is_named(bounds, side):
    best = optimise(paper_quarter_car(k | Damper(free(*bounds, "c"))), J1, Norm())
    assert best.active_bounds == {"c": side}
    assert best.parameters["c"] == pytest.approx(bounds[0 if side == "lower" else 1], rel=1e-14)


@pytest.mark.parametrize("bounds", [(0.98, 1e3), (1e-3, 1.02)])
def test_a_bound_that_is_near_and_holds_nothing_back_is_not_named(bounds):
    """The best damping in closed form lies 2 % within it, which is a three-hundredth of the range."""
    expected = 80e3 * math.sqrt((181.75 + 25.0) / 120e3)
    best = optimise(paper_quarter_car(k | Damper(free(bounds[0] * expected, bounds[1] * expected, "c"))), J1, Norm())
    assert best.parameters["c"] == pytest.approx(expected, rel=1e-5)
    assert best.active_bounds == {}


def test_bounds_are_never_left():
    car = paper_quarter_car(k | Damper(free(100.0, 1234.5, "c")) - Inerter(free(2.0, 77.7, "b")))
    for index in (J1, J3, J5):
        best = optimise(car, index, Norm())
        for name, value in car.free_values().items():
            assert value.lower <= best.parameters[name] <= value.upper


def test_the_same_seed_gives_the_same_result_and_the_result_is_a_design():
    car = paper_quarter_car(STRUTS["S3"])
    one, two = (optimise(car, J5, Norm(), seed=3) for _ in range(2))
    assert one == two
    assert one.design == car.with_values(one.parameters)
    assert one.value == evaluate(one.design, J5, Norm()).value
    assert one.seed == 3
    assert 1 <= one.n_converged <= one.n_starts
    assert one.evaluations > one.n_starts


def test_a_flat_optimum_shows_in_the_ranges():
    """Two dampers side by side: only their sum matters, so that the starts agree on the value and not on the share."""
    pair = Damper(free(10.0, 1e5, "c1")) | Damper(free(10.0, 1e5, "c2"))
    best = optimise(paper_quarter_car(k | pair), J1, Norm())
    alone = optimise(paper_quarter_car(STRUTS["S1"]), J1, Norm())
    assert best.value == pytest.approx(alone.value, rel=1e-8)
    assert best.parameters["c1"] + best.parameters["c2"] == pytest.approx(alone.parameters["c"], rel=1e-3)
    assert best.n_converged > 1
    low, high = best.ranges["c1"]
    assert high > 1.5 * low


def test_an_index_that_no_value_makes_finite_says_so():
    best = optimise(paper_quarter_car(Spring(free(1e4, 1e5, "k"))), J1, Norm())
    assert best.value == math.inf
    assert best.status.kind is StatusKind.MARGINAL
    assert best.n_converged == 0


def test_more_freedom_is_never_worse():
    """An inerter in parallel may be as small as its bound, and one in series as large."""
    for index in (J1, J3, J5):
        conventional = optimise(paper_quarter_car(STRUTS["S1"]), index, Norm()).value
        for name in ("S2", "S3"):
            assert optimise(paper_quarter_car(STRUTS[name]), index, Norm()).value <= conventional * (1.0 + 1e-3)


def test_a_question_the_car_cannot_answer_is_refused_before_any_search():
    mechanism = paper_quarter_car(STRUTS["S1"]).mechanism()
    bare = type(mechanism)(mechanism.coordinates, mechanism.struts, mechanism.tyres, mechanism.roads)
    with pytest.raises(PerformanceIndexError, match=r"measures\.comfort"):
        optimise(bare, J1, Norm())


def test_as_many_starts_are_searched_as_are_asked_for():
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(it.free(500.0, 5e4)))
    assert it.optimise(car, J1, it.Norm(), starts=150).n_starts == 150
    with pytest.raises(it.InerterError, match="starts"):
        it.optimise(car, J1, it.Norm(), starts=True)


def half_car_of_many_optima(mass=520.0):
    """At walking speed the delay between the axles makes ripples over the stiffness and the inertance."""
    branch = it.Spring(it.free(1e3, 1e6, "s")) - it.Inerter(it.free(1.0, 2e3, "b"))
    front, rear = it.Spring(127e3) | it.Damper(1200.0) | branch, it.Spring(36e3) | it.Damper(200.0) | branch
    return it.HalfCar(mass, 1960.0, 22.0, 35.0, 216e3, 153e3, 0.82, 1.55, front=front, rear=rear)


def test_where_many_starts_end_at_optima_of_their_own_more_are_made():
    """Sixteen starts agree on an optimum that is five per cent above one that more of them find."""
    car, index = half_car_of_many_optima(), it.RideComfort(it.Road(5e-7, 2.17))
    better = it.evaluate(car.with_values({"s": 41_268.0, "b": 133.03}), index, it.Norm())
    best = it.optimise(car, index, it.Norm())
    assert best.status.ok
    assert best.value <= better.value * (1.0 + 1e-6)
    assert best.n_starts > 16


class SampledNorm(it.Norm):
    """A norm of which a search knows values alone, as of what is simulated."""

    def objective(self, vehicle, index):
        return SampledObjective(self.estimate, vehicle, index)


@pytest.mark.parametrize("speed", sampled([0.6, 2.17], [2.17], kept=0))
def test_a_search_by_values_alone_begins_at_the_best_of_many_optima(speed):
    """From the optima of the first sixteen starts it ended two and five per cent above."""
    car, index = half_car_of_many_optima(), it.RideComfort(it.Road(5e-7, speed))
    assert it.optimise(car, index, SampledNorm()).value <= it.optimise(car, index, it.Norm()).value * (1.0 + 1e-6)


def test_searches_that_do_not_agree_are_told(monkeypatch):
    module = importlib.import_module("inerter.optimisation.optimise")
    search, seeds = module._quick_search, []

    def other(vehicle, index, method, problem, starts, seed, denser=0):
        """The last one does not find the best optimum."""
        seeds.append(seed)
        found, *more = search(vehicle, index, method, problem, starts, seed, denser)
        least = min(local.value for local in found)
        return [one for one in found if len(seeds) < 3 or one.value > 1.01 * least], *more

    monkeypatch.setattr(module, "_quick_search", other)
    best = it.optimise(half_car_of_many_optima(), it.RideComfort(it.Road(5e-7, 2.17)), it.Norm())
    assert len(set(seeds)) == 3
    assert best.status.kind is StatusKind.INACCURATE
    assert "two searches from independent starts found 1.00" in best.status.message
    assert "among many local optima, so that a better one may exist" in best.status.message


@pytest.mark.parametrize(
    ("speed", "limit", "better"), [(2.17, 413.0, (41_268.0, 133.03)), (3.1, 455.0, (735_675.0, 1.0))]
)
def test_within_limits_more_starts_are_made_too(speed, limit, better):
    """Five, and one, of sixteen starts found an optimum above one that more of them find."""
    car, road = half_car_of_many_optima(), it.Road(5e-7, speed)
    index, load = it.RideComfort(road), it.RandomResponse({"tyre_front_load": 1.0}, road)
    known = car.with_values(dict(zip("sb", better, strict=True)))
    assert it.evaluate(known, load, it.Norm()).value < limit
    best = it.optimise(car, index, it.Norm(), subject_to=[it.at_most(load, limit)])
    assert best.value <= it.evaluate(known, index, it.Norm()).value * (1.0 + 1e-6)
    assert best.n_starts > 16


@pytest.mark.marathon
def test_one_optimum_alone_within_the_limits_is_searched_for_again():
    """Of sixteen starts one ends within the limit, so that nothing tells whether there is a better design."""
    car, road = half_car_of_many_optima(), it.Road(5e-7, 1.4)
    load = it.at_most(it.RandomResponse({"tyre_front_load": 1.0}, road), 247.0)
    assert it.optimise(car, it.RideComfort(road), it.Norm(), subject_to=[load]).n_starts > 16


@pytest.mark.parametrize("speed", sampled([0.6, 1.1, 2.17, 4.0], seldom=[0.6, 4.0]))
def test_no_grid_finds_a_better_one_among_many_optima(speed):
    """A grid of 40 000 points, on a car of another mass."""
    car, index = half_car_of_many_optima(300.0), it.RideComfort(it.Road(5e-7, speed))
    axes = [np.geomspace(value.lower, value.upper, 200) for value in car.free_values().values()]
    points = dict(zip(car.free_values(), (one.ravel() for one in np.meshgrid(*axes)), strict=True))
    best = it.optimise(car, index, it.Norm())
    assert best.status.ok
    assert best.value <= np.nanmin(it.evaluate_many(car, index, points, it.Norm())) * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("is_peak", "above", "are_many"),
    [
        (False, [0.0, 0.0, 2e-5, 1e-3, 0.05, 0.1], True),
        (False, [0.0, 0.0, 2e-6, 4e-6, 6e-6, 8e-6], False),  # one flat optimum
        (False, [0.0, 0.0, 0.3, 0.7, 2.0, 9.0], False),  # ends far above tell nothing of what is below
        (False, [0.0, 0.0, 0.0, 0.0, 0.0, 0.1], False),
        (True, [0.0, 0.0, 2e-5, 4e-4, 7e-4, 9e-4], False),  # not followed to their end
        (True, [0.0, 0.0, 0.01, 0.04, 0.07, 0.15], True),
    ],
)
def test_starts_that_end_alone_near_the_lowest_value_call_for_denser_searches(is_peak, above, are_many):
    found = [LocalOptimum(np.array([5e3]), 2.0 * (1.0 + part), 1) for part in above]
    assert has_many_optima(found, is_peak) == are_many
