"""The event-driven integrator against time stepping, which shares nothing with it but the mechanism's graph."""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import random_case

from inerter import Trajectory, simulate
from inerter.errors import MechanismError
from inerter.networks.elements import Inerter, Spring
from inerter.systems.graph import full_graph

CHUNKS = [(n, 10) for n in range(30)]  # number and how many members
DURATION, SAMPLING = 0.6, 2e-4
STEPS = (4e-5, 1e-5, 2.5e-6, 1e-6)
_STILL = 1e-5  # [m, m/s, N] what moves less, does so by rounding


def compared(vehicle) -> list[str]:
    """Outputs that jump nowhere: motions of masses and inerters, and forces of springs."""
    mechanism = vehicle.mechanism()
    names = [f"{c.name}_{what}" for c in mechanism.coordinates for what in ("velocity", "displacement")]
    for branch in full_graph(mechanism).branches:
        if isinstance(branch.element, Spring | Inerter):
            names.append(f"{branch.label}_{'force' if isinstance(branch.element, Spring) else 'velocity'}")
    return names


def away_from_jumps(run: Trajectory, signal) -> np.ndarray:
    """Samples at which no held signal jumps: the integrators differ in which side they report."""
    kept = np.ones(run.time.size, dtype=bool)
    if signal.hold == "zero":
        for delay in (0.0, 2.04 / signal.speed):
            phase = ((run.time - delay) / signal.interval) % 1.0
            kept &= np.minimum(phase, 1.0 - phase) > 1e-6
    return kept


def differences(vehicle, inputs: dict) -> list[float]:
    """Largest difference over r.m.s. value of any output, for finer and finer time stepping, until it is below 1e-3.

    An output that hardly moves is measured on 2 % of the largest of its unit: with steps of some microseconds the
    rounding of time stepping (its matrix grows with mass over step) is of that order.
    """
    run = simulate(vehicle, duration=DURATION, step=SAMPLING, energy=True, **inputs)
    assert run.integration_status.ok
    assert run.energy.relative_residual < 1e-8
    (signal,) = inputs.values()
    names, largest = compared(vehicle), dict[str, float]()
    for name in names:
        largest[run.unit(name)] = max(largest.get(run.unit(name), _STILL), run.rms(name))
    kept, found = away_from_jumps(run, signal), []
    for step in STEPS:
        every = round(SAMPLING / step)
        check = simulate(vehicle, duration=DURATION, step=step, every=every, integrator="time-stepping", **inputs)
        assert check.integration_status.ok
        worst = 0.0
        for name in names:
            size = max(run.rms(name), 0.02 * largest[run.unit(name)])
            worst = max(worst, float(np.sqrt(np.mean((check[name] - run[name])[kept] ** 2))) / size)
        found.append(worst)
        if worst < 1e-3 and len(found) > 1:
            break
    return found


@pytest.mark.parametrize(("chunk", "cases"), sampled([(12, 4), *CHUNKS], [(12, 4)], often=[(0, 10)], kept=0))
def test_the_difference_vanishes_with_the_step_of_time_stepping(chunk, cases):
    orders, done = [], 0
    for seed in count(1000 * chunk):
        _, vehicle, inputs = random_case(seed)
        try:
            errors = differences(vehicle, inputs)
        except MechanismError:  # such as a gap between inertias: ill-posed, and refused
            continue
        assert errors[-1] < 1e-3, (seed, errors)
        if errors[0] > 1e-6:
            orders.append(np.log(errors[0] / errors[1]) / np.log(STEPS[0] / STEPS[1]))
        done += 1
        if done == cases:
            break
    assert np.median(orders) > 0.8, orders
