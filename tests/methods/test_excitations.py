"""Any excitation of any mechanism: norms and gradients against rational arithmetic, and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import in_parts
from excited import random_excitation, random_outputs
from random_mechanisms import FAMILIES, mechanisms

import inerter as it
from inerter import Damper, Filter, Inerter, Spring, free
from inerter.errors import LinearSystemError, PerformanceIndexError
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.networks.transform import map_elements

rational = pytest.importorskip("rational_norms", reason="python-flint is not installed")


def members(seed, count):
    """Random mechanisms of all families, each with a random excitation and random outputs."""
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for mechanism in mechanisms(family, seed, count, 1.0):
            excitation = random_excitation(rng, mechanism)
            index = it.RandomResponse(random_outputs(rng, mechanism, excitation), excitation)
            try:
                linear_problem(mechanism, index.question(mechanism), CONVENTIONS["exact"])
            except it.MechanismError:
                continue
            yield mechanism, index


@pytest.mark.parametrize("seed", [0, *in_parts(range(1, 11), 3)])
def test_random_responses_of_random_mechanisms(seed):
    """A value is right to 1e-9, or nan with its reason."""
    right = 0
    for mechanism, index in members(seed, 4):
        expected, found = rational.index_value(mechanism, index), it.evaluate(mechanism, index, it.Norm())
        if expected is None or (math.isnan(found.value) and not found.status.ok):
            continue
        assert found.value == (math.inf if expected is rational.INFINITE else pytest.approx(expected, rel=1e-9))
        right += 1
    assert right >= 10


def opened(mechanism):
    """The mechanism with its first elements free, and the values that they had."""
    values = {}

    def freed(element):
        if len(values) >= 3 or not isinstance(element, Spring | Damper | Inerter):
            return element
        values[f"p{len(values)}"] = element.value
        return element.with_value(free(0.5 * element.value, 2.0 * element.value, name=f"p{len(values) - 1}"))

    struts = tuple(replace(strut, network=map_elements(strut.network, freed)) for strut in mechanism.struts)
    return replace(mechanism, struts=struts), values


@pytest.mark.parametrize("seed", [100, *in_parts(range(101, 111), 3)])
def test_compiled_values_and_gradients_under_random_excitations(seed):
    checked = 0
    for mechanism, index in members(seed, 2):
        made, values = opened(mechanism)
        expected = rational.index_value(mechanism, index)
        poles = np.linalg.eigvals(it.assemble(mechanism).A)
        if not values or expected in (None, rational.INFINITE) or np.any(-poles.real < 1e-5 * np.abs(poles)):
            continue
        (found,) = it.evaluate_many(made, index, values, it.Norm())[:, 0]
        assert np.isnan(found) or found == pytest.approx(expected, rel=1e-9)
        objective, point = it.Norm().objective(made, index), np.array(list(values.values()))
        value, gradient = objective.value_and_gradient(point)
        step = 5e-4

        def at(i, shift, made=made, values=values, index=index, step=step):
            moved = values | {name: v * math.exp(step * shift) for j, (name, v) in enumerate(values.items()) if j == i}
            return rational.index_value(made.with_values(moved), index)

        for i in range(point.size):
            near, far = (at(i, s) - at(i, -s) for s in (1.0, 2.0))
            slope = (8.0 * near - far) / (12.0 * step)
            assert gradient[i] * point[i] == pytest.approx(slope, rel=0.0, abs=1e-7 * value)
        checked += 1
    assert checked >= 2


@pytest.mark.parametrize("seed", [200, *in_parts(range(201, 207), 2)])
def test_peak_responses_of_random_mechanisms(seed):
    """From forces and from displacements and velocities of roads."""
    right = 0
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for mechanism in mechanisms(family, seed, 3, 1.0):
            road, force = mechanism.roads[0].name, mechanism.forces[0].name
            source = str(rng.choice([road, f"{road}_velocity", force]))
            output = str(rng.choice([c.name for c in mechanism.coordinates])) + "_acceleration"
            index = it.PeakResponse(source, output, Filter([1.0], [1e-4, 0.014, 1.0]))
            try:
                expected, found = rational.index_value(mechanism, index), it.evaluate(mechanism, index, it.Norm())
            except (LinearSystemError, it.MechanismError):
                continue
            if expected is None or (math.isnan(found.value) and not found.status.ok):
                continue
            assert found.value == (math.inf if expected is rational.INFINITE else pytest.approx(expected, rel=1e-9))
            right += 1
    assert right >= 8


def single(mass, damping, stiffness=0.0):
    network = Damper(damping) if stiffness == 0.0 else Spring(stiffness) | Damper(damping)
    strut = it.Strut("support", network, upper={"mass": 1.0}, lower=it.GROUND)
    return it.Mechanism((it.Coordinate("mass", mass),), (strut,), forces=(it.Force("push", {"mass": 1.0}),))


def test_a_single_mass_in_closed_form():
    """Variances of displacement and velocity are S/(2 c k) and S/(2 c m) under force, times m^2 under the ground."""
    m, c, k, S = 3.0, 0.7, 50.0, 4.0
    one, push, quake = single(m, c, k), it.WhiteForce("push", S), it.GroundAcceleration(S)
    expected = {
        ("mass_displacement", push): S / (2.0 * c * k),
        ("mass_velocity", push): S / (2.0 * c * m),
        ("support_force", push): S / (2.0 * c * k) * k**2 + c**2 * S / (2.0 * c * m),
        ("mass_relative_displacement", quake): S * m**2 / (2.0 * c * k),
        ("mass_relative_velocity", quake): S * m / (2.0 * c),
        ("mass_acceleration", quake): S / m**2 * (m**2 * k / (2.0 * c) + m * c / 2.0),
    }
    for (name, excitation), variance in expected.items():
        found = it.evaluate(one, it.RandomResponse({name: 1.0}, excitation), it.Norm())
        assert found.value == pytest.approx(math.sqrt(variance), rel=1e-12)
    assert it.evaluate(single(m, c), it.RandomResponse({"mass_velocity": 1.0}, push), it.Norm()).value == pytest.approx(
        math.sqrt(S / (2.0 * c * m)), rel=1e-12
    )
    below = it.evaluate(one, it.RandomResponse({"mass_acceleration": 1.0}, push), it.Norm())
    assert math.isinf(below.value)
    assert "white noise passes straight" in below.status.message


def test_motions_that_the_ground_carries_are_refused_with_the_ones_to_ask_for():
    quake = it.RandomResponse({"mass_displacement": 1.0}, it.GroundAcceleration(1.0))
    with pytest.raises(PerformanceIndexError, match=r"no bounds.*mass_relative_displacement"):
        it.evaluate(single(1.0, 0.1, 1.0), quake, it.Norm())
