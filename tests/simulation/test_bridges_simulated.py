"""Random bridges with friction and gaps: both integrators, and the energy balance."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import random_network
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter import Bridge, Damper, Spring
from inerter.errors import MechanismError

NAMES = ("sprung_velocity", "unsprung_velocity", "sprung_displacement")
DURATION, SAMPLING, STEPS = 0.4, 2e-4, (4e-5, 1e-5)


@pytest.mark.parametrize(("begin", "count"), sampled([(0, 4), (4, 6), (10, 10), (20, 10), (30, 10)], [(0, 4)], kept=1))
def test_random_bridges_by_both_integrators(begin, count):
    orders = []
    for seed in range(begin, begin + count):
        rng = np.random.default_rng(seed)
        car = paper_quarter_car(Spring(2e4) | Damper(500.0) | Bridge(*(random_network(rng, 1) for _ in "abcde")))
        road = it.multisine(ROAD, seed=seed)
        try:
            run = it.simulate(car, road=road, duration=DURATION, step=SAMPLING, energy=True)
        except MechanismError:  # a gap between inertias: ill-posed, and refused
            continue
        assert run.status.ok
        assert run.energy.relative_residual < 1e-8
        errors = []
        for step in STEPS:
            every = round(SAMPLING / step)
            check = it.simulate(car, road=road, duration=DURATION, step=step, every=every, integrator="time-stepping")
            errors.append(max(float(np.sqrt(np.mean((check[n] - run[n]) ** 2))) / run.rms(n) for n in NAMES))
        assert errors[1] < 1e-3, (seed, errors)
        orders.append(np.log(errors[0] / errors[1]) / np.log(STEPS[0] / STEPS[1]))
    assert len(orders) >= count // 3
    assert np.median(orders) > 0.8, orders
