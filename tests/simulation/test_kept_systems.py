"""Systems that are kept for designs of equal values change nothing."""

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from mechanisms import random_case

import inerter as it
from inerter.errors import DesignError, InerterError
from inerter.systems import piecewise as module
from inerter.systems.piecewise import piecewise

SIGNAL = it.multisine(it.Road(roughness=5e-7, speed=25.0), seed=6, lowest=1.0)


def car(damping=3000.0, name=None, mass=181.75):
    screw = it.Inerter(300.0) | it.Friction(10.0, name=name)
    return it.QuarterCar(mass, 25.0, 1.2e5, it.Spring(1.2e5) | it.Damper(damping) - screw)


def simulated(vehicle, driven):
    run = it.simulate(vehicle, **{"duration": 0.5, "step": 5e-4} | driven)
    return run.status, run.events, run.final_state, [run[name] for name in run.outputs]


@pytest.mark.parametrize("seed", sampled(range(12), range(4), kept=4))
def test_runs_equal_those_of_systems_assembled_anew(seed, monkeypatch):
    _, vehicle, driven = random_case(seed)
    try:
        kept = [simulated(vehicle, driven) for _ in range(2)]
    except InerterError as error:
        with pytest.raises(type(error)):
            simulated(vehicle, driven)
        return
    monkeypatch.setattr(module, "structure_of", lambda mechanism: None)
    status, events, final, outputs = simulated(vehicle, driven)
    for one in kept:
        assert one[:2] == (status, events)
        assert np.array_equal(one[2], final)
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one[3], outputs, strict=True))


def test_designs_of_equal_values_share_a_system_and_no_others_do():
    system = piecewise(car())
    assert piecewise(car()) is system
    others = [
        car(damping=3000.1),
        car(name="f"),
        car(mass=181.76),
        replace(car().mechanism(), measures=it.PerformanceOutputs()),
        replace(car().mechanism(), mirror=[["sprung", "unsprung"]]),  # a list is no key
    ]
    for other in others:
        assert piecewise(other) is not system
        assert piecewise(other).mechanism == other.mechanism()


def test_designs_of_a_layout_share_its_kinematics_and_have_their_own_elements():
    systems = [piecewise(car(damping)) for damping in (2000.0, 4000.0)]
    assert systems[0].kinematics is systems[1].kinematics
    dampings = [[b.element.damping for b in system.graph.branches if b.label == "c"] for system in systems]
    assert dampings == [[2000.0], [4000.0]]


def test_a_design_that_is_refused_is_refused_again():
    free = it.QuarterCar(181.75, 25.0, 1.2e5, it.Spring(1.2e5) | it.Damper(it.free(1.0, 2.0, name="c")))
    for _ in range(2):
        with pytest.raises(DesignError, match="still has free values"):
            piecewise(free)


def test_a_kept_system_is_driven_by_other_signals():
    first, held = (it.simulate(car(), road=road, duration=0.5, step=5e-4) for road in (SIGNAL, it.sine(0.01, 2.0)))
    assert np.array_equal(it.simulate(car(), road=SIGNAL, duration=0.5, step=5e-4).final_state, first.final_state)
    assert not np.array_equal(first.final_state, held.final_state)
