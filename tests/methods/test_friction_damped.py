"""Expected values where friction does much of the damping, beside time stepping on true white noise."""

from __future__ import annotations

import math

import pytest
from campaigns import sampled
from white_noise import ROAD, ROADS, drawn, stepped

import inerter as it
from inerter.errors import StatusKind

INDICES = (it.RideComfort(ROAD), it.TyreLoad(ROAD))


def check(car, refusable=True, roads=ROADS):
    """Each value within four standard errors of the difference, and 0.2 %; returns how many had no value."""
    refused = 0
    for index, value, error in zip(INDICES, *stepped(car, roads), strict=True):
        found = it.evaluate(car.vehicle, index, it.ExpectedValue())
        if refusable and found.status.kind is StatusKind.MARGINAL and math.isnan(found.value):
            refused += 1
            continue
        assert found.status.ok, (index.symbol, found.status)
        apart = abs(found.value - value)
        assert apart < 4.0 * math.hypot(found.standard_error, error) + 2e-3 * value, (index.symbol, found.value, value)
    return refused


@pytest.mark.campaign
def test_what_friction_damps_is_simulated_on_roads_that_resolve_it():
    check(drawn(0), roads=8)


@pytest.mark.parametrize("first", sampled(range(0, 200, 5), seldom=range(0, 200, 5)))
def test_what_friction_damps_in_many_random_cars(first):
    refused = sum(check(drawn(number)) for number in range(first, first + 5))
    assert refused <= 4  # of 10 values: those whose lightest motion takes minutes to decay
