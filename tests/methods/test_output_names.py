"""One vocabulary: an output that one method knows all know, or a sentence of its own says why it does not."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal
from strategies import random_network, random_quarter_car
from wang_su import ROAD, paper_half_car

import inerter as it
from inerter import Damper, Friction, Gap, Inerter, Spring, frequency_response
from inerter.errors import InerterError, PerformanceIndexError
from inerter.systems.assemble import state_space
from inerter.systems.graph import full_graph, linear_graph
from inerter.systems.outputs import outputs
from inerter.vehicle.mechanism import OutputWeight, PerformanceOutputs

LINEAR = (it.Norm(), it.StatisticalLinearisation())
SIMULATING = (it.ExpectedValue(realisations=3), it.ApproximateLinear(seed=0))
k, c, b = Spring(22e3), Damper(1.5e3), Inerter(20.0)
STRUTS = {
    "linear": k | c - b | k - Spring(5e4, "k2"),
    "weak friction": k | c | b - (k | Friction(1e-6, "f")) | Damper(1.0, "c2") - Friction(1e-6, "g"),
    "tiny gap": k | c | Damper(500.0, "c2") - Gap(1e-12),
}


def asking(name, strut=STRUTS["linear"]):
    mechanism = it.QuarterCar(250.0, 35.0, 150e3, strut).mechanism()
    return replace(mechanism, measures=PerformanceOutputs(comfort=(OutputWeight(name),)))


def answer(name, strut, method):
    """The value, or the sentence that says why there is none."""
    try:
        return it.evaluate(asking(name, strut), it.RideComfort(ROAD), method).value
    except InerterError as error:
        return str(error)


@pytest.mark.parametrize("kind", sampled(STRUTS, seldom=["weak friction"]))
def test_every_output_means_the_same_to_every_method(kind):
    """Frictions and gaps are so small here that all methods must agree about everything else."""
    strut = STRUTS[kind]
    mechanism = asking("sprung_acceleration", strut)
    in_linear = outputs(mechanism, linear_graph(mechanism))
    some = np.random.default_rng(0).permutation(list(in_linear))[:4]  # simulations take long
    for name in outputs(mechanism, full_graph(mechanism)):
        methods = (*LINEAR, *SIMULATING) if name in some else LINEAR
        norm, *others = (answer(name, strut, method) for method in methods)
        if name not in in_linear:
            assert "linear analysis" in norm
            continue
        for value in others:
            if isinstance(value, str):
                assert "gap" in value
                continue
            assert value == pytest.approx(norm, rel=1e-2), (name, norm, others)


def test_what_a_friction_does_is_told_by_simulation_only():
    strut = k | c | Friction(100.0, "f")
    for name in ("f_force", "f_velocity"):
        for method in LINEAR:
            assert re.search(rf"{name}'.*expected-value", answer(name, strut, method))
    assert 0.0 < answer("f_force", strut, SIMULATING[0]) <= 100.0


def test_elements_keep_their_names_when_others_are_left_out():
    twins = paper_half_car(front=k | Damper(1e3) - Gap(1e-3), rear=k | c)
    left_out = it.HalfCar(
        363.5, 200, 25, 20, 120e3, 100e3, 0.775, 1.265, front=k | (c - Friction(9.0)), rear=k | c | Friction(1.0)
    )
    for car in (twins, left_out):
        mechanism = car.mechanism()
        labels = [branch.label for branch in full_graph(mechanism).branches]
        kept = [branch.label for branch in linear_graph(mechanism).branches]
        assert kept == [label for label in labels if label in kept]
    assert "rear.c" in kept
    assert "front.c" not in kept


def misspelt(rng, name):
    """The name with a letter lost, doubled or changed, or two of them swapped."""
    i = int(rng.integers(len(name) - 1))
    ways = (name[:i] + name[i + 1 :], name[:i] + 2 * name[i] + name[i + 1 :], name[:i] + "q" + name[i + 1 :])
    return [*ways, name[:i] + name[i + 1] + name[i] + name[i + 2 :]][int(rng.integers(4))]


@pytest.mark.parametrize("seed", sampled(range(12), [4, 8], often=[1, 3], kept=1))
def test_a_name_that_is_not_there_gets_the_same_sentence_everywhere(seed):
    rng = np.random.default_rng(seed)
    strut = [*STRUTS.values()][seed % 2]
    mechanism = asking("sprung_acceleration", strut)
    known = list(outputs(mechanism, full_graph(mechanism)))
    name = misspelt(rng, str(rng.choice(known)))
    if name in known:
        return
    car, sound, index = asking(name, strut), mechanism, it.RideComfort(ROAD)
    told = set()
    for method in (*LINEAR, *SIMULATING):
        for ask in (
            lambda m: it.evaluate(car, index, m),
            lambda m: it.evaluate_many(car, [index], {}, m),
            lambda m: it.compare(car, sound, index, m),
            lambda m: it.compare(sound, car, index, m),
        ):
            with pytest.raises(PerformanceIndexError) as error:
                ask(method)
            told.add(str(error.value))
    assert len(told) == 1
    assert told.pop().startswith(f"Unknown output {name!r}. Did you mean")


def test_an_input_that_is_not_there_gets_the_same_sentence_everywhere():
    mechanism = asking("sprung_acceleration")
    car = replace(mechanism, measures=PerformanceOutputs(load_input="sprung_farce", load_output="sprung_displacement"))
    told = set()
    for method in (*LINEAR, *SIMULATING):
        with pytest.raises(InerterError) as error:
            it.evaluate(car, it.LoadCarrying(amplitude=100.0), method)
        told.add(str(error.value))
    assert len(told) == 1


@pytest.mark.parametrize("seed", range(20))
def test_force_and_velocity_of_every_element_are_those_of_nodal_equations(seed):
    rng = np.random.default_rng([6, seed])
    car = random_quarter_car(rng, Spring(2e4) | random_network(rng, 3, 5)).mechanism()
    omega = np.exp(rng.uniform(0.0, 5.0, 8))
    nodal, labels = Nodal(car, omega), [branch.label for branch in full_graph(car).branches]
    named = [f"{label}_{what}" for label in labels for what in ("force", "velocity")]
    system = state_space(car, ["road", "sprung_force"], named)
    response = frequency_response(system, omega)
    for i, (stiffness, _, _) in enumerate(nodal.placed):
        for j, source in enumerate(system.inputs):
            elongation = nodal._elongation(i, nodal.inputs.index(source)) / (nodal.s if source == "road" else 1.0)
            for expected, found in (
                (stiffness * elongation, response[:, 2 * i, j]),
                (nodal.s * elongation, response[:, 2 * i + 1, j]),
            ):
                size = max(np.abs(expected).max(), 1e-9 * np.abs(response[:, i % 2 :: 2, j]).max())
                np.testing.assert_allclose(found, expected.astype(complex), rtol=1e-7, atol=1e-9 * float(size))
