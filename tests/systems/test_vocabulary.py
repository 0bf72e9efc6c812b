"""One vocabulary of outputs: linear analysis, the piecewise system, both integrators and indices know all names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from random_mechanisms import FAMILIES, mechanisms
from wang_su import ROAD

import inerter as it
from inerter import Damper, Friction, Gap, Spring
from inerter.errors import InerterError, LinearSystemError, MechanismError, PerformanceIndexError, SimulationError
from inerter.methods.method import check_request
from inerter.networks.transform import map_elements
from inerter.systems.graph import full_graph, linear_graph
from inerter.systems.outputs import force_of, main_outputs, stroke_of, velocity_of
from inerter.systems.piecewise import piecewise
from inerter.vehicle.mechanism import OutputWeight, PerformanceOutputs


def with_friction_and_gaps(rng, mechanism):
    """Some of its springs and dampers with a friction beside them, or with a gap before them."""

    def changed(element):
        if not isinstance(element, Spring | Damper) or rng.random() < 0.6:
            return element
        return element | Friction(5.0) if rng.random() < 0.5 else (element | Damper(1e3)) - Gap(1e-3)

    struts = tuple(replace(strut, network=map_elements(strut.network, changed)) for strut in mechanism.struts)
    return replace(mechanism, struts=struts)


def members(seed, count):
    """Random mechanisms of all families that both linear analysis and simulation take."""
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for i, mechanism in enumerate(mechanisms(family, seed, count, 1.0)):
            made = with_friction_and_gaps(rng, mechanism) if i % 3 else mechanism
            try:
                linear_graph(made)
                it.state_space(made)
                yield made, piecewise(made)
            except MechanismError:
                continue


def asking(mechanism, name):
    return replace(mechanism, measures=PerformanceOutputs(comfort=(OutputWeight(name),)))


def misspelt(rng, name):
    at = int(rng.integers(1, len(name) - 1))
    return name[:at] + "q" + name[at + 1 :]


def weighable(mechanism, name):
    try:
        check_request(asking(mechanism, name), it.RideComfort(ROAD), it.ExpectedValue())
    except PerformanceIndexError:
        return False
    return True


@pytest.mark.parametrize("seed", sampled(range(13), often=[0], kept=0))
def test_all_analyses_know_the_same_names(seed):
    looked_at = left_out = 0
    for mechanism, system in members(seed, 3):
        names = list(system.outputs)
        runs = [
            it.simulate(mechanism, road=it.sine(1e-3, 1.0), duration=2e-3, step=1e-3, speed=20.0, integrator=integrator)
            for integrator in ("event-driven", "time-stepping")
        ]
        for run in runs:
            assert list(run.outputs) == names
            assert [run.unit(name) for name in names] == [system.outputs[name].unit for name in names]
        assert all(weighable(mechanism, name) for name in names)
        gone = {b.label for b in full_graph(mechanism).branches} - {b.label for b in linear_graph(mechanism).branches}
        unknown = {called(label) for label in gone for called in (force_of, velocity_of, stroke_of)}
        linear = [name for name in names if name not in unknown or name in main_outputs(mechanism)]
        assert it.state_space(mechanism, [road.name for road in mechanism.roads], linear).outputs == tuple(linear)
        for name in set(names) - set(linear):
            with pytest.raises(
                LinearSystemError, match="in linear analysis, which neglects friction and treats gaps as closed"
            ):
                it.state_space(mechanism, outputs=name)
        assert set(main_outputs(mechanism)) <= set(linear)
        assert set(it.state_space(mechanism).outputs) <= set(main_outputs(mechanism))
        looked_at, left_out = looked_at + 1, left_out + len(names) - len(linear)
    assert looked_at >= 10
    assert left_out >= 10


def all_who_are_asked(mechanism, name):
    signal, times = it.sine(1e-3, 1.0), {"duration": 2e-3, "step": 1e-3, "speed": 20.0}
    run, car = it.simulate(mechanism, road=signal, **times), asking(mechanism, name)
    return (
        lambda: it.state_space(mechanism, outputs=name),
        lambda: run[name],
        lambda: it.simulate_many([mechanism], outputs=[name], road=[signal], **times),
        lambda: it.evaluate(car, it.RideComfort(ROAD), it.Norm()),
        lambda: it.evaluate(car, it.RideComfort(ROAD), it.ExpectedValue()),
    )


@pytest.mark.parametrize("seed", sampled(range(3), kept=1))
def test_a_name_that_is_not_there_gets_the_same_sentence_from_all(seed):
    rng = np.random.default_rng(seed)
    for mechanism, system in members(100 + seed, 2):
        name = misspelt(rng, str(rng.choice(list(system.outputs))))
        if name in system.outputs:
            continue
        told = set()
        for ask in all_who_are_asked(mechanism, name):
            with pytest.raises(InerterError) as error:
                ask()
            assert isinstance(error.value, LinearSystemError | SimulationError | PerformanceIndexError)
            told.add(str(error.value))
        assert len(told) == 1
