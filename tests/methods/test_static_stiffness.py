"""Static stiffness of random struts: against a slow motion's dynamic stiffness, and gradients against differences."""

from __future__ import annotations

import numpy as np
import pytest
from slopes import assert_slopes
from strategies import random_network
from wang_su import paper_quarter_car

import inerter as it
from inerter.methods.composite_index import objective_of
from inerter.networks.transform import map_elements


def slow(network):
    """Dynamic stiffness at a frequency so low that only springs hold."""
    omega = 1e-9
    return float(np.real(1j * omega * network.admittance(1j * omega)))


@pytest.mark.parametrize("number", range(60))
def test_static_stiffness_is_that_of_a_slow_motion(number):
    network = random_network(np.random.default_rng([number, 8]))
    car = paper_quarter_car(network)
    found = it.evaluate(car, it.static_stiffness("strut"), it.Norm())
    assert found.value == pytest.approx(slow(network), rel=1e-6, abs=1e-6)
    assert found.unit == "N/m"
    free = paper_quarter_car(map_elements(network, lambda e: e.with_value(it.free(0.1 * e.value, 10.0 * e.value))))
    objective = objective_of(free, it.static_stiffness("strut"), it.Norm())
    point = np.array([np.sqrt(v.lower * v.upper) for v in free.free_values().values()])
    value, gradient = objective.value_and_gradient(point)
    assert value == pytest.approx(found.value, rel=1e-9)
    assert_slopes(objective, point, gradient, rel=1e-6, abs=1e-6 * max(value, 1.0))


def test_gaps_are_closed_and_friction_lets_go():
    strut = it.Spring(1e4) | it.Spring(3e4) - it.Gap(1e-3) - it.Spring(6e4) | it.Spring(9e4) - it.Friction(5.0)
    assert it.evaluate(paper_quarter_car(strut), it.static_stiffness("strut"), it.ExpectedValue()).value == 3e4
    assert it.evaluate(paper_quarter_car(strut), it.static_stiffness("tyre"), it.Norm()).value == 120e3
