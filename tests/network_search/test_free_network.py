"""Free networks: what they accept, and one sentence where a design with one is not searched."""

from __future__ import annotations

import numpy as np
import pytest
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, Inerter, Spring
from inerter.errors import DesignError, NetworkError
from inerter.networks.free_network import free_networks, with_free_networks

COMFORT, NORM = it.RideComfort(ROAD), it.Norm()
SPRINGS = {"springs": (1e3, 1e6)}


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({}, "needs bounds of at least one kind"),
        ({"max_elements": 0, **SPRINGS}, "from 1 to 7 elements, got min_elements=1 and max_elements=0"),
        ({"max_elements": 8, **SPRINGS}, "max_elements=8"),
        ({"max_elements": 2.5, **SPRINGS}, "max_elements must be a whole number, got 2.5"),
        ({"max_elements": "3", **SPRINGS}, "max_elements must be a whole number, got '3'"),
        ({"max_elements": True, **SPRINGS}, "max_elements must be a whole number, got True"),
        ({"min_elements": 3, **SPRINGS}, "min_elements=3 and max_elements=2"),
        ({"springs_at_most": -1, **SPRINGS}, "springs_at_most must be a whole number, got -1"),
        ({"dampers_at_most": 0.5, **SPRINGS}, "dampers_at_most must be a whole number, got 0.5"),
        ({"bridges": "yes", **SPRINGS}, "bridges must be True or False, got 'yes'"),
        ({"name": "two words", **SPRINGS}, "A name must be"),
        ({"springs": 1e3}, "springs needs the lower and upper bound of a stiffness"),
        ({"dampers": (1.0, 2.0, 3.0)}, r"dampers needs .* \[N s/m\], such as \(10, 1e6\), got \(1.0, 2.0, 3.0\)"),
        ({"inerters": (2.0, 1.0)}, "0 <= lower < upper"),
        ({"springs": (0.0, 1.0)}, "its lower bound is 0 N/m"),
        ({"springs": (1.0, float("inf"))}, "must be a finite number"),
        ({"springs": (1.0, "2")}, "must be a finite number"),
    ],
)
def test_an_input_that_is_not_valid_is_told_in_one_sentence(given, says):
    with pytest.raises(NetworkError, match=says) as failure:
        it.any_network(**{"max_elements": 2} | given)
    assert "\n" not in str(failure.value)


def test_bounds_may_be_any_pair_or_a_free_value():
    pairs = [(1e3, 1e6), [1e3, 1e6], np.array([1e3, 1e6]), it.free(1e3, 1e6)]
    assert len({it.any_network(np.int64(2), springs=pair) for pair in pairs}) == 1


@pytest.mark.parametrize("part", ["beside", "in series", "in a bridge"])
def test_a_free_network_is_found_and_replaced_anywhere(part):
    place, c = it.any_network(2, **SPRINGS), Damper(1e3)
    strut = {"beside": c | place, "in series": c - (c | place), "in a bridge": it.Bridge(c, place, c, c, c)}[part]
    assert free_networks(strut) == [place]
    chosen = with_free_networks(strut, {place: Inerter(3.0)})
    assert free_networks(chosen) == []
    assert [element.value for element in chosen.elements()].count(3.0) == 1


def test_kinds_are_at_most_as_many_as_asked():
    bounds = {"springs": (1.0, 2.0), "dampers": (1.0, 2.0), "inerters": (1.0, 2.0)}
    everything = it.any_network(4, **bounds).topologies()
    some = it.any_network(4, **bounds, min_elements=2, springs_at_most=1, dampers_at_most=0).topologies()
    assert some == [t for t in everything if t.size >= 2 and t.counts["k"] <= 1 and t.counts["c"] == 0]


DESIGN = paper_quarter_car(Spring(120e3) | it.any_network(2, dampers=(10.0, 1e6)))
CALLS = {
    "evaluate": lambda: it.evaluate(DESIGN, COMFORT, it.Norm()),
    "evaluate by simulation": lambda: it.evaluate(DESIGN, COMFORT, it.ExpectedValue()),
    "evaluate_many": lambda: it.evaluate_many(DESIGN, [COMFORT], {}, it.Norm()),
    "compare": lambda: it.compare(DESIGN, DESIGN, COMFORT, it.Norm()),
    "optimise": lambda: it.optimise(DESIGN, COMFORT, it.Norm()),
    "pareto_front": lambda: it.pareto_front(DESIGN, [COMFORT, it.TyreLoad(ROAD)], it.Norm()),
    "state_space": lambda: it.state_space(DESIGN),
    "static_tyre_loads": lambda: it.static_tyre_loads(DESIGN),
    "simulate": lambda: it.simulate(DESIGN, road=it.sine(1e-3, 1.0), duration=0.1),
    "admittance": lambda: DESIGN.strut.admittance(1j),
}


@pytest.mark.parametrize("call", CALLS)
def test_a_design_whose_network_is_not_chosen_is_refused(call):
    with pytest.raises(DesignError, match=r"any_network\(\.\.\.\), which is not a network yet. Use search"):
        CALLS[call]()


def search(vehicle, index=COMFORT, method=NORM, **more):
    return it.search(vehicle, index, method, **more)


FIXED, TWO = Spring(1e5) | Damper(1e3), it.any_network(2, **SPRINGS)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: search(paper_quarter_car(FIXED), COMFORT), "one free network, .* got no free network"),
        (
            lambda: search(paper_half_car(FIXED | TWO, FIXED | it.any_network(1, **SPRINGS)), COMFORT),
            "got 2 different free networks",
        ),
        (lambda: search(DESIGN, COMFORT, jobs=-1), "`jobs` must be a positive integer, got -1"),
        (lambda: search(DESIGN, COMFORT, seed=-1), "`seed` must be a non-negative integer, got -1"),
        (lambda: search(DESIGN, COMFORT, starts=0), "`starts` must be a positive integer, got 0"),
        (lambda: search(DESIGN, "J1"), "Expected an index .* got 'J1'"),
        (lambda: search(DESIGN, COMFORT, "norm"), "Expected a method .* got 'norm'"),
        (lambda: search(3), "Expected a vehicle"),
        (lambda: search(DESIGN, it.RandomResponse({"nothing": 1.0}, ROAD)), "Unknown output 'nothing'"),
        (
            lambda: search(DESIGN, COMFORT, subject_to=[it.at_most(it.RandomResponse({"nothing": 1.0}, ROAD), 1.0)]),
            "Unknown output 'nothing'",
        ),
        (
            lambda: search(paper_quarter_car(FIXED | it.any_network(2, **SPRINGS, min_elements=2)), COMFORT),
            "There is no network to search",
        ),
    ],
)
def test_a_search_that_is_not_valid_is_told_in_one_sentence(call, says):
    with pytest.raises(it.InerterError, match=says) as failure:
        call()
    assert "\n" not in str(failure.value)
