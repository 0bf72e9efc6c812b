"""Networks of equal admittance in the results of a search."""

from __future__ import annotations

from wang_su import J1, paper_quarter_car

import inerter as it
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import plan_search
from inerter.network_search.results import collect_results
from inerter.networks.enumeration import Topology


def test_best_values_that_fewer_elements_have_too() -> None:
    """Values at equal bounds have no counterpart in another network of the class; each keeps its own."""
    bounds = {"springs": (1e3, 1e5), "inerters": (1.0, 1e3)}
    strut = it.Spring(120e3) | it.Damper(2e3) | it.any_network(5, **bounds)
    car = paper_quarter_car(strut)
    plan = plan_search(car, J1, it.Norm())
    degenerate = Topology(("|", "k", ("-", ("|", "k", "b"), ("|", "k", "b"))))
    searched = [
        SearchedNetwork(one, 1, 1, 1.0 if one == degenerate else 2.0, tuple({"k": 1e5, "b": 1.0}[s] for s in one.kinds))
        for one in plan.topologies
    ]
    found = collect_results(plan, searched)
    assert found.n_networks == len(plan.topologies)
    assert [one.value for one in found.ranking].count(1.0) == 1
