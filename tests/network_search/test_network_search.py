"""Searches of networks: optima by another way, order, executors, and the rules of the results."""

from __future__ import annotations

import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
import pytest
from campaigns import sampled
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, Spring
from inerter.errors import DesignError
from inerter.network_search import plan as module
from inerter.network_search.results import TIED, reduced_topology
from inerter.networks.enumeration import Topology, enumerate_networks
from inerter.networks.equivalence import equivalence_classes

INDICES = {
    "comfort": it.RideComfort(ROAD),
    "weighted comfort": it.RideComfort(ROAD, weighting="Wk"),
    "load": it.TyreLoad(ROAD),
    "travel": it.SuspensionTravel(ROAD),
}
BOUNDS = {"springs": (1e2, 1e7), "dampers": (1e1, 1e6), "inerters": (1e-2, 1e5)}
NORM = it.Norm()


def car(most: int, **more) -> it.QuarterCar:
    return paper_quarter_car(Spring(120e3) | it.any_network(most, **{**BOUNDS, **more}))


@cache
def found(index: str, most: int, seed: int = 0) -> it.SearchResult:
    return it.search(car(most), INDICES[index], NORM, seed=seed)


def facts(result: it.SearchResult) -> list[tuple]:
    """All that a search says of its networks, but for the plan."""
    ranking = [
        (one.layout, one.value, one.parameters, one.active_bounds, one.n_converged, one.status, one.simpler, one.like)
        for one in result.ranking
    ]
    return [*ranking, *result.failed]


@pytest.mark.parametrize(
    ("index", "most", "starts"),
    [
        ("comfort", 2, 20),
        *(pytest.param(index, 4, 20, marks=pytest.mark.marathon) for index in INDICES),
    ],
)
def test_no_search_of_one_network_is_better(index, most, starts):
    """Gradient searches by states: a limit that is never reached keeps `optimise` from the compiled search."""
    unlimited = [it.at_most(INDICES["load"], 1e9)]
    for one in found(index, most).ranking:
        design = one.plan.design(one.topology)
        alone = it.optimise(design, INDICES[index], NORM, starts=starts, subject_to=unlimited)
        assert one.value <= alone.value * (1.0 + 1e-8), one.layout


@pytest.mark.parametrize("index", INDICES)
def test_values_are_those_of_the_designs(index):
    for one in found(index, 3).ranking:
        assert one.status.ok
        assert it.evaluate(one.design, INDICES[index], NORM).value == pytest.approx(one.value, rel=1e-9)
        for name, value in one.parameters.items():
            lower, upper = {"k": (1e2, 1e7), "c": (1e1, 1e6), "b": (1e-2, 1e5)}[name[0]]
            assert lower <= value <= upper
            assert (name in one.active_bounds) == (value in (lower, upper))


@pytest.mark.parametrize(("most", "seeds"), [(3, range(3)), pytest.param(4, range(10), marks=pytest.mark.marathon)])
@pytest.mark.parametrize("index", INDICES)
def test_seeds_give_the_same_best_networks(index, most, seeds):
    """Of travels of four elements the first four: the fifth has its optimum at bounds, where one start of 32 ends."""
    count = 4 if (index, most) == ("travel", 4) else 10
    best = [found(index, most, seed).ranking[:count] for seed in seeds]
    for other in best[1:]:
        assert [one.layout for one in other] == [one.layout for one in best[0]]
        assert [one.value for one in other] == pytest.approx([one.value for one in best[0]], rel=1e-8)


@pytest.mark.parametrize("way", ["threads", "processes", "other groups"])
def test_whatever_shares_the_work_the_result_is_the_same(way, monkeypatch):
    if way == "other groups":
        monkeypatch.setattr(module, "_GROUP", 5)
        shared = it.search(car(3), INDICES["load"], NORM)
    else:
        forked = get_context("fork")  # with what the modules of the tests register, as no other process has it
        with ThreadPoolExecutor(2) if way == "threads" else ProcessPoolExecutor(2, forked) as executor:
            shared = it.search(car(3), INDICES["load"], NORM, executor=executor)
    assert facts(shared) == facts(found("load", 3))


def test_what_is_sent_to_a_worker_does_not_grow_with_the_number_of_networks():
    sizes = []
    for most in (1, 4):
        sent = []
        plan = module.plan_search(car(most), INDICES["load"], NORM)
        assert len(plan.topologies) == sum(len(list(enumerate_networks(n))) for n in range(1, most + 1))
        sent.append(len(pickle.dumps(module.replace(plan))))
        sizes += sent
    assert sizes[1] < 1.1 * sizes[0]


@pytest.mark.parametrize("most", [1, 3])
def test_no_network_is_dropped_and_each_that_fails_says_why(most):
    result = found("comfort", most)
    topologies = car(most).strut.parts[1].topologies()
    layouts = [one.layout for one in result.ranking] + [layout for layout, _ in result.failed]
    assert sorted(layouts) == sorted(topology.expression for topology in topologies)
    assert result.n_networks == len(topologies)
    assert all(reason for _, reason in result.failed)
    assert {layout for layout, _ in result.failed} == {t.expression for t in topologies if not t.counts["c"]}


def test_networks_are_ranked_by_value_then_by_size_then_by_layout():
    ranking = found("comfort", 4).ranking
    for one, other in pairwise(ranking):
        tied = abs(other.value - one.value) <= 2.0 * TIED * one.value
        assert one.value < other.value or (tied and one.topology < other.topology)


@pytest.mark.parametrize("index", sampled(["comfort", "load", "travel"], ["comfort"], kept=1))
def test_networks_of_equal_admittance_have_equal_values(index):
    result = found(index, 4)
    by_topology = {one.topology: one for one in result.ranking}
    for members in equivalence_classes(by_topology):
        for topology in members:
            one = by_topology[topology]
            assert set(one.like) == {by_topology[other].layout for other in members if other != topology}
            for other in members:
                free = not one.active_bounds and not by_topology[other].active_bounds
                if free:
                    assert one.value == pytest.approx(by_topology[other].value, rel=1e-7)


@pytest.mark.parametrize("index", ["comfort", "load", "travel"])
def test_a_network_does_as_well_as_a_simpler_one(index):
    result = found(index, 4)
    by_layout = {one.layout: one for one in result.ranking}
    simpler = [one for one in result.ranking if one.simpler]
    assert simpler
    for one in simpler:
        smaller = by_layout[one.simpler]
        assert smaller.n_elements < one.n_elements
        assert smaller.value <= one.value * 1.001
        assert one.active_bounds or smaller.layout in one.like


@pytest.mark.parametrize("index", ["comfort", "load", "travel"])
def test_the_frontier_has_the_best_of_each_size_that_is_better_than_all_smaller(index):
    result = found(index, 4)
    counted = [one for one in result.ranking if not one.simpler]
    for frontier, size in (
        (result.frontier, lambda one: one.n_elements),
        (result.frontier_of_inerters, lambda one: one.topology.counts["b"]),
    ):
        assert all(size(one) < size(other) and one.value > other.value for one, other in pairwise(frontier))
        for one in frontier:
            assert one.value <= min(each.value for each in counted if size(each) <= size(one)) * (1.0 + TIED)
        best = min(one.value for one in counted)
        assert frontier[-1].value <= best * (1.0 + 1e-7)


def test_near_optimal_networks_are_within_the_share():
    result = found("comfort", 4)
    near = result.near_optimal(0.02)
    assert {one.layout for one in near} == {
        one.layout for one in result.ranking if one.value <= 1.02 * result.ranking[0].value
    }
    assert [one.n_elements for one in near] == sorted(one.n_elements for one in near)


@pytest.mark.parametrize(
    ("tree", "at", "rest"),
    [
        (("|", "k", ("-", "c", "b")), ("", "lower", ""), "k"),
        (("|", "k", ("-", "c", "b")), ("", "", "upper"), ("|", "k", "c")),
        (("|", "k", ("-", "c", "b")), ("lower", "", ""), ("-", "c", "b")),
        (("|", "k", ("-", "c", "b")), ("", "", ""), None),
        (("-", "b", ("|", "k", "c")), ("", "upper", ""), "b"),
        (("-", "b", ("|", "k", "c")), ("lower", "", ""), None),
        (("-", "b", ("|", "c", ("-", "k", "c"))), ("upper", "", "upper", ""), "c"),
        (("bridge", "k", "c", "b", "k", "c"), ("lower", "", "", "", ""), None),
    ],
)
def test_what_is_left_without_elements_at_their_bounds(tree, at, rest):
    topology = Topology(tree)
    assert topology.tree == tree
    assert reduced_topology(topology, at) == (None if rest is None else Topology(rest))


@pytest.mark.parametrize("way", ["limit", "linearisation"])
def test_limits_and_other_methods_are_searched_by_optimise(way):
    limits = [it.at_most(INDICES["load"], 560.0)] if way == "limit" else []
    method = NORM if way == "limit" else it.StatisticalLinearisation()
    result = it.search(car(2, springs=None), INDICES["comfort"], method, subject_to=limits, starts=4)
    assert result.ranking
    assert result.n_networks == 4
    for one in result.ranking:
        alone = it.optimise(one.plan.design(one.topology), INDICES["comfort"], method, subject_to=limits, starts=4)
        assert (one.value, one.parameters) == (alone.value, alone.parameters)
        if limits and one.status.ok:
            assert it.evaluate(one.design, INDICES["load"], NORM).value <= 560.0 * (1.0 + 1e-6)


def test_values_that_break_a_limit_with_real_inerters_are_infeasible():
    """An ideal network keeps it by 0.3 %; whether an elastic shaft and friction do, its load says, evaluated alone."""
    most, parallel, shaft = 561.0, Spring(120e3) | Damper(3e3), Spring(1e6) | Damper(3200.0)
    design, limits = parallel | it.any_network(1, inerters=(100.0, 100.1)), [it.at_most(INDICES["load"], most)]
    result = it.search(paper_quarter_car(design), INDICES["comfort"], NORM, subject_to=limits, starts=1)
    method = it.StatisticalLinearisation()
    (real,) = it.with_friction_and_elasticity(result.ranking, method, frictions=[1.0, 100.0])
    inerter = it.Inerter(real.found.parameters["b1"])
    broken = []
    for arm, estimate in [
        (inerter, real.elastic),
        *((inerter | it.Friction(friction), own) for friction, own in real.with_friction.items()),
    ]:
        load = it.evaluate(paper_quarter_car(parallel | shaft - arm), INDICES["load"], method).value
        broken.append(load > most)
        assert (estimate.status.kind is it.StatusKind.INFEASIBLE) == broken[-1]
        assert (f"{load:.1f}"[:5] in estimate.status.message) == broken[-1]
    assert broken == [True, True, False]


def test_a_network_that_cannot_keep_a_limit_is_not_ranked_and_says_so():
    limits = [it.at_most(INDICES["load"], 560.0)]  # which no damper alone keeps
    result = it.search(car(2, springs=None), INDICES["comfort"], NORM, subject_to=limits, starts=4)
    assert "c1" not in [one.layout for one in result.ranking]
    assert any(layout == "c1" and reason for layout, reason in result.failed)
    assert result.n_networks == 4


def test_two_places_have_the_same_network_with_the_same_values():
    place = it.any_network(2, dampers=BOUNDS["dampers"], inerters=BOUNDS["inerters"])
    half = paper_half_car(Spring(60e3) | place, Spring(50e3) | place)
    result = it.search(half, INDICES["comfort"], NORM, starts=4)
    assert result.n_networks == 4
    best = result.ranking[0]
    assert set(best.parameters) == set(best.topology.names())
    front, rear = (list(strut.elements())[1:] for strut in (best.design.front, best.design.rear))
    assert [element.value for element in front] == [element.value for element in rear] == [*best.parameters.values()]


def test_free_values_beside_the_network_are_found_with_it():
    strut = Spring(it.free(8e4, 2e5, name="k")) | it.any_network(2, dampers=BOUNDS["dampers"])
    (one,) = it.search(paper_quarter_car(strut), INDICES["load"], NORM, starts=6).ranking
    alone = it.optimise(
        paper_quarter_car(Spring(it.free(8e4, 2e5, name="k")) | Damper(it.free(1e1, 1e6, name="c1"))),
        INDICES["load"],
        NORM,
        starts=6,
    )
    assert one.parameters == pytest.approx(alone.parameters, rel=1e-5)


def test_a_free_value_beside_the_network_stays_apart_whatever_its_name():
    """An element `valve` whose free value is called as the first damper of a network would be."""

    def with_valve(name: str) -> it.QuarterCar:
        strut = Spring(120e3) | Damper(it.free(1e2, 1e5, name), "valve") - it.Spring(5e5, "top")
        return paper_quarter_car(strut | it.any_network(1, dampers=(1e2, 1e5)))

    (named,), (other,) = (it.search(with_valve(name), INDICES["comfort"], NORM).ranking for name in ("c1", "x"))
    assert named.value == pytest.approx(other.value, rel=1e-9)
    assert sorted(named.parameters) == ["c1", "c2"]


def test_free_values_beside_the_network_that_are_at_a_bound_are_marked():
    strut = Spring(it.free(8e4, 9e4, name="k")) | it.any_network(1, dampers=BOUNDS["dampers"])
    (one,) = it.search(paper_quarter_car(strut), INDICES["comfort"], NORM, starts=4).ranking
    assert one.parameters["k"] == 8e4
    assert one.active_bounds == {"k": "lower"}
    front = it.search(paper_quarter_car(strut), (INDICES["comfort"], INDICES["load"]), NORM, points=3, starts=4).front
    assert front[0].active_bounds == {"k": "lower"}


def test_free_inerters_beside_the_network_stay_ideal():
    strut = Spring(120e3) | it.Inerter(it.free(1, 50, "b")) | Damper(3e3)
    place = it.any_network(1, inerters=(1, 50))
    (one,) = it.search(paper_quarter_car(strut | place), INDICES["comfort"], NORM, starts=4).ranking
    (real,) = it.with_friction_and_elasticity([one], it.StatisticalLinearisation(), frictions=[10.0])
    device = it.RealInerter().network(it.Inerter(one.parameters["b1"], "b1"), 10.0)
    fixed = Spring(120e3) | it.Inerter(one.parameters["b"]) | Damper(3e3) | device
    expected = it.evaluate(paper_quarter_car(fixed), INDICES["comfort"], it.StatisticalLinearisation())
    assert real.with_friction[10.0].value == pytest.approx(expected.value, rel=1e-12)


@pytest.mark.parametrize("friction", [-10.0, float("nan"), "10", None])
def test_a_friction_that_no_inerter_has_is_refused(friction):
    best, method = found("comfort", 2).ranking[0], it.StatisticalLinearisation()
    assert best.topology.counts["b"]
    with pytest.raises(DesignError, match="friction of a real inerter must be a non-negative number of N"):
        it.optimise_with_real_inerters(best, method, friction=friction, starts=1)
    with pytest.raises(DesignError, match="friction of a real inerter must be a non-negative number of N"):
        it.with_friction_and_elasticity([best], method, frictions=[friction])


def test_what_is_no_network_of_a_search_is_refused():
    result, method = found("comfort", 2), it.StatisticalLinearisation()
    with pytest.raises(DesignError, match=r"search\(\.\.\.\)\.ranking"):
        it.optimise_with_real_inerters(result, method)
    with pytest.raises(DesignError, match=r"search\(\.\.\.\)\.ranking"):
        it.with_friction_and_elasticity(result, method)
    with pytest.raises(DesignError, match="`frictions` must be a list of forces"):
        it.with_friction_and_elasticity(result.ranking[:1], method, frictions=10.0)
    for share in (-0.01, float("nan"), "1 %"):
        with pytest.raises(DesignError, match="share must be a non-negative number"):
            result.near_optimal(share)


def test_an_index_that_depends_on_what_carries_weight():
    """Static loads are known only with a spring between body and wheel, which here the network has to be."""
    coefficient = it.DynamicLoadCoefficient(ROAD)
    result = it.search(paper_quarter_car(it.any_network(2, **BOUNDS)), coefficient, NORM, starts=4)
    assert [one.layout for one in result.ranking] == ["k1 | c1"]
    assert dict(result.failed)["c1"].startswith("The static tyre loads are not known")
    weight = 9.80665 * (181.75 + 25.0)
    load = it.evaluate(result.ranking[0].design, INDICES["load"], NORM).value
    assert result.ranking[0].value == pytest.approx(load / weight, rel=1e-9)


def test_a_network_beside_a_tyre_is_searched_where_it_has_a_value():
    """A damper on the velocity of the road passes white noise, so that only springs are left."""
    fixed = paper_quarter_car(Spring(120e3) | Damper(2e3)).mechanism()
    (tyre,) = fixed.tyres
    place = it.any_network(2, springs=(1e4, 1e6), dampers=(1e1, 1e6))
    network = tyre.network | place
    softened = replace(fixed, tyres=(replace(tyre, network=network),))
    result = it.search(softened, INDICES["comfort"], NORM, starts=4)
    assert result.n_networks == 4


def test_names_of_the_elements_are_those_that_are_left():
    strut = Spring(120e3, "k1") | it.any_network(2, springs=BOUNDS["springs"], dampers=BOUNDS["dampers"])
    result = it.search(paper_quarter_car(strut), INDICES["comfort"], NORM)
    assert {name for one in result.ranking for name in one.parameters} == {"k2", "c1"}
    assert all(np.isfinite(one.value) for one in result.ranking)


@pytest.mark.parametrize("number", sampled(range(30), range(1), kept=1))
def test_networks_with_bridges_are_searched_too(number):
    rng = np.random.default_rng([61, number])
    kinds = ("springs", "dampers") if rng.random() < 0.5 else ("dampers", "inerters")
    place = it.any_network(5, **{kind: BOUNDS[kind] for kind in kinds}, min_elements=5, bridges=True)
    result = it.search(paper_quarter_car(Spring(120e3) | place), INDICES["comfort"], NORM, starts=4)
    assert any(one.layout.startswith("bridge") for one in result.ranking)
    assert all(one.status.ok for one in result.ranking)
