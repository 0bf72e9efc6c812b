"""Fronts over networks: by another way for each network, against random designs, and with whatever shares the work."""

from __future__ import annotations

import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
import pytest
from campaigns import sampled
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter import Spring
from inerter.errors import DesignError, PerformanceIndexError, Status, StatusKind
from inerter.files.study.search_parts import NetworkFrontResult
from inerter.kernels.network_norms import TradeOff, excess_in, norm_space
from inerter.methods.network_norm import join_indices
from inerter.network_search import fronts, plan
from inerter.network_search.plan import plan_search

COMFORT, LOAD, TRAVEL = it.RideComfort(ROAD), it.TyreLoad(ROAD), it.SuspensionTravel(ROAD)
BOUNDS = {"springs": (1e2, 1e7), "dampers": (1e1, 1e6), "inerters": (1e-2, 1e5)}
NORM = it.Norm()


def car(most: int, **more) -> it.QuarterCar:
    return paper_quarter_car(Spring(120e3) | it.any_network(most, **{**BOUNDS, **more}))


@cache
def found(most: int, points: int = 25) -> it.NetworkFront:
    return it.search(car(most), (COMFORT, LOAD), NORM, points=points)


def facts(result: it.NetworkFront) -> list[tuple]:
    by_size = [(n, one.layout, one.values, one.parameters) for n, own in result.by_elements.items() for one in own]
    return [*by_size, result.n_searched, result.n_bounded, *result.failed]


def gain_on(front: np.ndarray, values: np.ndarray) -> float:
    """How far the best of some designs is below a point of the front in every index, in parts of their ranges."""
    size = np.ptp(front, axis=0)
    return max(float(np.min((front - one) / size, axis=1).max()) for one in values)


@pytest.mark.parametrize(("most", "points"), sampled([(2, 9), (3, 9), (4, 25)], seldom=[(3, 9), (4, 25)]))
def test_no_front_of_one_network_is_better(most, points):
    """By `pareto_front`, a minimax search in other code, for the networks on the front and for two others."""
    result = found(most, points)
    plan = result.searches[0].ranking[0].plan
    others = [one.topology for one in result.searches[1].ranking[:2]]
    for topology in dict.fromkeys([*(one.topology for one in result.front), *others]):
        alone = it.pareto_front(plan.design(topology), [COMFORT, LOAD], NORM, points=points)
        assert gain_on(result.values, alone.values) < 1e-6, topology
        own = np.array([one.values for one in result.front if one.topology == topology]).reshape(-1, 2)
        if len(own):
            assert gain_on(alone.values, own) < 0.02  # its points are at other places of the same front


@pytest.mark.parametrize("most", sampled([2, 4], [2], [4]))
def test_no_random_design_is_better(most):
    """20000 designs: of all networks, and near those on the front."""
    result, rng = found(most), np.random.default_rng(most)
    plans = [one.ranking[0].plan for one in result.searches]
    topologies = plans[0].topologies
    tried, worst = 0, -np.inf
    for number in range(400):
        near = number % 2 == 0
        one = result.front[int(rng.integers(len(result.front)))]
        topology = one.topology if near else topologies[int(rng.integers(len(topologies)))]
        lower, upper = np.array(plans[0].ends(topology)).T
        over = [plan.compiled_index.over(plan.network(topology)) for plan in plans]
        points = lower * (upper / lower) ** rng.random((50, lower.size))
        if near:
            points = np.array([*one.parameters.values()]) * np.exp(rng.normal(0.0, 0.03, points.shape))
            points = np.clip(points, lower, upper)
        values = np.column_stack([each.values(points) for each in over])
        tried += len(values)
        values = values[np.all(np.isfinite(values), axis=1)]
        if len(values):
            worst = max(worst, gain_on(result.values, values))
    assert tried == 20000
    assert worst < 1e-6


@pytest.mark.campaign
def test_networks_are_left_out_only_where_they_are_no_better(monkeypatch):
    """With all networks searched at all aims the front is the same."""
    short = found(3)
    assert short.n_bounded > short.n_searched
    monkeypatch.setattr(fronts, "_next_tasks", _all_tasks)
    full = it.search(car(3), (COMFORT, LOAD), NORM)
    assert full.n_bounded == 0
    assert full.values == pytest.approx(short.values, rel=1e-5)
    assert full.networks == short.networks


def _all_tasks(left, level, bounds):
    return [fronts.FrontTask(one, left[one].parameters, tuple(range(level.size))) for one in sorted(left)]


def test_whatever_shares_the_work_the_front_is_the_same():
    with ProcessPoolExecutor(2, get_context("fork")) as executor:
        shared = it.search(car(3), (COMFORT, LOAD), NORM, executor=executor)
    assert facts(shared) == facts(found(3))


@pytest.mark.parametrize("most", sampled([2, 4], [2]))
def test_points_are_designs_with_their_values(most):
    result = found(most)
    for number, several in result.by_elements.items():
        for one in several:
            assert one.n_elements <= number
            assert one.status.ok
            for value, index in zip(one.values, (COMFORT, LOAD), strict=True):
                assert it.evaluate(one.design, index, NORM).value == pytest.approx(value, rel=1e-8)
        for one, other in pairwise(several):
            assert one.values[0] < other.values[0]
            assert one.values[1] > other.values[1]


def test_ends_are_the_best_networks_of_each_index():
    result = found(4)
    for index, point in ((0, result.front[0]), (1, result.front[-1])):
        best = result.searches[index].ranking[0]
        assert point.values[index] == pytest.approx(best.value, rel=1e-6)


def test_with_more_elements_no_front_is_worse():
    result = found(4)
    tables = [np.array([one.values for one in several]) for several in result.by_elements.values()]
    size = np.ptp(result.values, axis=0)
    for smaller, larger in pairwise(tables):
        for one in smaller:  # some design of the larger front is no worse, but for the distance of its points
            assert np.min(np.max((larger - one) / size, axis=1)) < 0.1


@pytest.mark.campaign
def test_three_indices():
    result = it.search(car(2, springs=None), (COMFORT, LOAD, TRAVEL), NORM, points=10)
    assert result.values.shape[1] == 3
    for index in range(3):
        assert result.values[:, index].min() == pytest.approx(result.searches[index].ranking[0].value, rel=1e-6)
    alone = it.pareto_front(
        result.front[0].plans[0].design(result.front[0].topology), [COMFORT, LOAD, TRAVEL], NORM, points=10
    )
    assert gain_on(result.values, alone.values) < 1e-6


@pytest.mark.campaign
def test_a_limit_holds_along_the_front():
    limits = [it.at_most(TRAVEL, 3e-3)]
    result = it.search(car(2, springs=None), (COMFORT, LOAD), NORM, subject_to=limits, points=3)
    assert len(result.front) == 3
    for one in result.front:
        assert it.evaluate(one.design, TRAVEL, NORM).value <= 3e-3 * (1.0 + 1e-6)
    alone = it.pareto_front(
        result.front[0].plans[0].design(result.front[0].topology), [COMFORT, LOAD], NORM, subject_to=limits, points=3
    )
    assert gain_on(result.values, alone.values) < 1e-5


def test_a_point_keeps_the_doubt_of_its_search(monkeypatch):
    """Of the search for an end, and of that for a point between the ends, also from a folder."""
    doubt = Status(StatusKind.INACCURATE, "another start found a better one")

    def points(*given, **more):
        return [replace(one, status=doubt) for one in fronts_of_a_network(*given, **more)]

    fronts_of_a_network = fronts.points_at_aims
    monkeypatch.setattr(fronts, "points_at_aims", points)
    searched = fronts.plan_front(car(2, springs=None), (COMFORT, it.LoadCarrying()), NORM, (), 0, None, 3)
    searches = it.search(car(2, springs=None), (COMFORT, it.LoadCarrying()), NORM, points=3).searches
    first = replace(searches[0], ranking=tuple(replace(one, status=doubt) for one in searches[0].ranking))
    waves = fronts.front_waves(searched, [first, searches[1]])
    found: list[fronts.NetworkPoints] | None = None
    try:
        while True:
            scale, tasks = waves.send(found)
            found = [
                NetworkFrontResult("any", 1, "n", json.loads(json.dumps(_as_data(one)))).network_points()
                for one in fronts.front_group(searched, scale, tasks)
            ]
    except StopIteration as end:
        result = end.value
    assert len(result.front) > 1
    assert [one.status for one in result.front[:-1]] == [doubt] * (len(result.front) - 1)


def test_a_network_has_the_status_of_its_search(monkeypatch):
    """Where each network is searched by `optimise`, as with a limit."""
    doubt = Status(StatusKind.INACCURATE, "another start found a better one")

    def doubtful(*given, **more):
        best = it.optimise(*given, **more)
        return replace(best, estimate=replace(best.estimate, status=doubt))

    monkeypatch.setattr(plan, "optimise", doubtful)
    found = it.search(car(1), COMFORT, NORM, subject_to=[it.at_most(TRAVEL, 1.0)])
    assert {one.status for one in found.ranking} == {doubt}


def _as_data(points):
    return {**vars(points), "topology": points.topology.tree}


def test_a_peak_gain_and_a_norm():
    result = it.search(car(2, springs=None), (COMFORT, it.LoadCarrying()), NORM, points=3)
    assert {one.layout for one in result.front} >= {"c1 - b1", "c1 | b1"}
    assert all(one.status.ok for one in result.front)


def test_the_number_of_points_may_be_of_any_integer_type():
    result = it.search(car(1), (COMFORT, LOAD), NORM, points=np.int64(3))
    assert facts(result) == facts(it.search(car(1), (COMFORT, LOAD), NORM, points=3))


def test_indices_without_conflict_have_a_front_of_one_point():
    rougher = it.RideComfort(it.Road(roughness=5e-6, speed=25))
    result = it.search(car(2, springs=None), (COMFORT, rougher), NORM)
    assert [one.layout for one in result.front] == ["c1 - b1"]
    assert [len(several) for several in result.by_elements.values()] == [1, 1]


def test_fewer_elements_have_their_front_where_more_have_no_conflict():
    """The bounds are at the best damper and inerter in series for both indices, not at the best damper alone."""
    narrow = {"springs": None, "dampers": (100.0, 4900.0), "inerters": (200.0, 300.0)}
    result = it.search(car(2, **narrow), (COMFORT, LOAD), NORM, points=5)
    alone = it.search(car(1, **narrow), (COMFORT, LOAD), NORM, points=5)
    assert [one.layout for one in result.front] == ["c1 - b1"]
    assert len(alone.front) > 2
    fewer = np.array([one.values for one in result.by_elements[1]])
    assert fewer == pytest.approx(alone.values, rel=1e-9)


def test_networks_without_a_value_say_why():
    result = found(2)
    assert {layout for layout, _ in result.failed} == {"k1", "b1", "k1 | b1", "k1 - b1"}
    assert all("has no damper: undamped mode: a pole at" in reason for _, reason in result.failed)


@pytest.mark.parametrize(
    ("indices", "points", "error", "words"),
    [
        ((COMFORT,), 5, PerformanceIndexError, "two or three indices"),
        ((COMFORT, COMFORT), 5, PerformanceIndexError, "repeated"),
        ((COMFORT, LOAD), 2, DesignError, "an integer from 3 to"),
        ((COMFORT, LOAD, TRAVEL), 5, DesignError, "an integer from 6 to"),
        ((COMFORT, LOAD), True, DesignError, "an integer from 3 to"),
    ],
)
def test_what_is_refused(indices, points, error, words):
    with pytest.raises(error, match=words):
        it.search(car(1), indices, NORM, points=points)


@pytest.mark.parametrize("number", range(4))
def test_the_slopes_of_the_excess_are_those_of_differences(number):
    rng = np.random.default_rng([7, number])
    plans = [plan_search(car(4), index, NORM) for index in (COMFORT, LOAD)]
    joined, criterion = join_indices([plan.compiled_index for plan in plans])
    damped = [one for one in plans[0].topologies if one.counts["c"]]
    topology = damped[int(rng.integers(len(damped)))]
    over = joined.over(plans[0].network(topology))
    values = np.array([{"k": 1e5, "c": 5e3, "b": 300.0}[kind] for kind in topology.kinds])
    values *= np.exp(rng.normal(0.0, 0.3, values.size))
    trade_off = TradeOff(criterion, np.array([2.4, 500.0]), np.array([0.1, 10.0]), 0.02)
    space, none = norm_space(over.program, over.port), np.zeros(0)

    def excess(at: np.ndarray, gradient: np.ndarray = none) -> float:
        return excess_in(at, over.program, over.port, trade_off, space, gradient)

    slopes = np.zeros(values.size)
    excess(values.copy(), slopes)
    for i, value in enumerate(values):
        step = np.zeros(values.size)
        step[i] = 1e-5 * value
        assert slopes[i] * value == pytest.approx(
            (excess(values + step) - excess(values - step)) / 2e-5, rel=1e-5, abs=1e-7
        )
