"""Filters on the outputs of an index: every method answers as it does for an output, times the filter."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy
from campaigns import sampled
from filtered import Weighed, iso_2631_wk, random_filter, some_filters
from nodal import Nodal
from quadrature import h2_by_quadrature
from random_mechanisms import FAMILIES, mechanisms, opened
from wang_su import J1, J3, J5, ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, Filter, Friction, Inerter, Spring, free
from inerter.errors import MechanismError
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.notes import parts_of
from inerter.methods.realisations import realisation_seeds

rational = pytest.importorskip("rational_norms", reason="python-flint is not installed")
WK = iso_2631_wk()
k, shaft = Spring(120e3), Spring(1e6) | Damper(3200.0)


def members(seed, count):
    """Random mechanisms of all families with a random filter on one of their indices."""
    for family in FAMILIES:
        rng = np.random.default_rng([seed, *family.encode()])
        for i, mechanism in enumerate(mechanisms(family, seed, count, 1.0)):
            index = (J1, J3, J5)[i % 3]
            try:
                definition = index.definition(mechanism)
                linear_problem(mechanism, definition, CONVENTIONS["exact"])
            except MechanismError:
                continue
            yield mechanism, Weighed(index, some_filters(rng, definition))


@pytest.mark.parametrize("seed", sampled(range(21), [0], kept=1))
def test_norms_of_random_vehicles_with_random_filters(seed):
    """Against rational arithmetic: a value is right to 1e-9, or nan with its reason."""
    assert sum(rational.is_right(*member) for member in members(seed, 6)) >= 15


@pytest.mark.parametrize("seed", sampled(range(100, 121), [100], kept=1))
def test_compiled_norms_and_gradients_with_random_filters(seed):
    """Values against rational arithmetic, gradients against its differences.

    Gradients of what is hardly damped are differences of values, with a filter or without, and not looked at here.
    """
    checked = 0
    for mechanism, index in members(seed, 3):
        made, values = opened(mechanism)
        expected = rational.index_value(mechanism, index)
        if not values or expected is None or expected is rational.INFINITE or index.index is J5:
            continue
        rational.assert_compiled_value(made, index, values)
        poles = np.linalg.eigvals(it.state_space(mechanism).A)
        if np.any(-poles.real < 1e-5 * np.abs(poles)):
            continue
        rational.assert_gradient(made, index, values)
        checked += 1
    assert checked >= 3


@pytest.mark.parametrize("case", sampled(["Wk", "one each", "late axle"], ["Wk"], kept=1))
def test_the_norm_is_the_integral_of_both_responses(case):
    """By quadrature of |H|^2 |F|^2 over frequency, with dynamic stiffness in place of states; and the gradient."""
    c, b = Damper(free(1e3, 1e5, "c")), Inerter(free(10.0, 2e3, "b"))
    design = paper_quarter_car(k | c - shaft - b) if case == "Wk" else paper_half_car(k | c | b, k | c - b)
    band = Filter([5.0, 0.0], [1.0, 5.0, 400.0])
    index = {"Wk": Weighed(J1, WK), "one each": Weighed(J1, (WK, band)), "late axle": Weighed(J3, band)}[case]
    values, step = {"c": 6e3, "b": 200.0}, 1e-3
    mechanism = design.mechanism()
    problem = linear_problem(mechanism, index.definition(mechanism), CONVENTIONS["exact"])

    def by_quadrature(at):
        total = 0.0
        for weight, name, one in zip(
            problem.weights, problem.descriptor.outputs, problem.definition.filters, strict=True
        ):

            def response(omega, name=name, one=one):
                nodal = Nodal(mechanism.with_values(at), omega)
                across = np.array([nodal.response(name, source) for source in problem.descriptor.inputs], complex).T
                s = 1j * omega[:, None]
                return across * np.polyval(one.numerator, s) / np.polyval(one.denominator, s)

            total += weight * h2_by_quadrature(response, problem.delays, edge=4000.0)
        return total

    expected = by_quadrature(values)
    assert it.evaluate(design.with_values(values), index, it.Norm()).value == pytest.approx(expected, rel=1e-8)
    assert it.evaluate_many(design, index, values, it.Norm())[0, 0] == pytest.approx(expected, rel=1e-8)
    names = list(design.free_values())
    value, gradient = it.Norm().objective(design, index).value_and_gradient(np.array([values[name] for name in names]))
    for name, found in zip(names, gradient, strict=True):
        f = [by_quadrature(values | {name: values[name] * math.exp(step * i)}) for i in (-1, 1)]
        assert found * values[name] == pytest.approx((f[1] - f[0]) / (2.0 * step), rel=0.0, abs=2e-6 * value)


def test_designs_are_searched_with_the_filter():
    c, b = Damper(free(100.0, 1e5, "c")), Inerter(free(1.0, 2e3, "b"))
    index = Weighed(J1, WK)
    best = it.optimise(paper_quarter_car(k | c - b), index, it.Norm(), seed=0)
    assert best.status.ok
    plain = it.optimise(paper_quarter_car(k | c - b), J1, it.Norm(), seed=0)
    assert best.value < it.evaluate(plain.design, index, it.Norm()).value
    for name, factor in (("c", 0.97), ("c", 1.03), ("b", 0.97), ("b", 1.03)):
        beside = best.parameters | {name: best.parameters[name] * factor}
        there = it.evaluate(paper_quarter_car(k | c - b).with_values(beside), index, it.Norm()).value
        assert there >= best.value


@pytest.mark.parametrize("conventions", sampled(CONVENTIONS, ["exact"]))
def test_indices_with_and_without_filters_are_valued_side_by_side(conventions):
    design = paper_half_car(k | Damper(free(1e3, 1e5, "c")) - Inerter(200.0), k | Damper(4e3))
    band = Filter([5.0, 0.0], [1.0, 5.0, 400.0])
    indices = [J1, Weighed(J1, WK), Weighed(J1, (WK, band)), Weighed(J1, (band, None)), J3, Weighed(J3, WK), J5]
    points = {"c": np.array([2e3, 5e3])}
    method = it.Norm(conventions)
    together = it.evaluate_many(design, indices, points, method)
    for row, c in zip(together, points["c"].tolist(), strict=True):
        alone = [it.evaluate(design.with_values({"c": c}), index, method).value for index in indices]
        assert row == pytest.approx(alone, rel=1e-8)


def test_what_a_body_does_over_a_road_is_finite_behind_a_filter_that_is_zero_at_rest():
    """The height of a body drifts with the road; s^2 over two poles takes the drift away."""
    mechanism = paper_quarter_car(k | Damper(4e3) - Inerter(100.0)).mechanism()
    height = replace(mechanism, measures=replace(mechanism.measures, comfort=(it.OutputWeight("sprung_displacement"),)))
    for passed, finite in ((Filter([1.0, 0.0], [1.0, 1.0]), True), (Filter([1.0, 2.0], [1.0, 1.0]), False)):
        found, expected = (
            it.evaluate(height, Weighed(J1, passed), it.Norm()),
            rational.index_value(height, Weighed(J1, passed)),
        )
        assert found.status.ok == finite
        assert found.value == (pytest.approx(expected, rel=1e-9) if finite else math.inf)


def series(friction):
    return paper_quarter_car(k | Damper(7353.0) - shaft - (Inerter(328.72) | Friction(friction, "f")))


def test_statistical_linearisation_is_the_norm_with_its_dampers():
    """The damper of a friction is that of the whole motion, with a filter on the index or without."""
    index, method = Weighed(J1, WK), it.StatisticalLinearisation()
    found = it.evaluate(series(100.0), index, method)
    assert found.status.ok
    assert found.notes == it.evaluate(series(100.0), J1, method).notes
    (damping,) = (
        part for note in found.notes if "damper of" in note for part in parts_of(note) if isinstance(part, float)
    )
    damped = paper_quarter_car(k | Damper(7353.0) - shaft - (Inerter(328.72) | Damper(damping)))
    assert found.value == pytest.approx(it.evaluate(damped, index, it.Norm()).value, rel=1e-6)
    opened_up = paper_quarter_car(k | Damper(free(1e3, 5e4, "c")) - shaft - (Inerter(328.72) | Friction(100.0)))
    objective, step = method.objective(opened_up, index), 1e-4
    value, gradient = objective.value_and_gradient(np.array([7353.0]))
    assert value == pytest.approx(found.value, rel=1e-9)
    ends = objective.values(7353.0 * np.exp(step * np.array([[1.0], [-1.0]])))
    assert gradient[0] * 7353.0 == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=1e-5 * value)
    assert it.evaluate_many(opened_up, index, {"c": 7353.0}, method)[0, 0] == pytest.approx(value, rel=1e-9)


def in_time(samples, step, one):
    """Periodic samples through a filter in the time domain, in sections by Tustin's rule, run until they repeat."""
    top, bottom = ([float(c) for c in p] for p in (one.numerator, one.denominator))
    zeros, poles, gain = scipy.signal.tf2zpk(top, bottom)
    sections = scipy.signal.zpk2sos(*scipy.signal.bilinear_zpk(zeros, poles, gain, 1.0 / step))
    return scipy.signal.sosfilt(sections, np.tile(samples, 4))[-samples.size :]


@pytest.mark.parametrize("passed", [WK, Filter([30.0, 0.0], [1.0, 30.0, 900.0])], ids=["Wk", "band"])
def test_a_simulated_road_is_filtered_as_in_time(passed):
    method, index = it.ExpectedValue(realisations=2, seed=3), Weighed(J1, passed)
    found = it.evaluate(series(200.0), index, method)
    assert found.status.ok
    for value, seed in zip(found.samples, realisation_seeds(3, 0, 2), strict=True):
        run = it.simulate(series(200.0), road=it.multisine(ROAD, seed=seed), initial="periodic")
        samples = in_time(run["sprung_acceleration"][:-1], 2e-4, passed)
        assert value == pytest.approx(math.sqrt(np.mean(samples**2)), rel=2e-4)


@pytest.mark.parametrize("index", [J1, J3], ids=["J1", "J3"])
def test_with_little_friction_all_methods_are_the_norm(index):
    for passed in (WK, random_filter(np.random.default_rng(5))):
        asked = Weighed(index, passed)
        norm = it.evaluate(series(0.0), asked, it.Norm()).value
        for method in (it.ExpectedValue(realisations=2), it.ApproximateLinear(realisations=2)):
            assert it.evaluate(series(0.0), asked, method).value == norm
            assert it.evaluate(series(0.01), asked, method).value == pytest.approx(norm, rel=2e-3)
        assert it.evaluate(series(0.01), asked, it.StatisticalLinearisation()).value == pytest.approx(norm, rel=1e-4)
        (simulated,) = it.ApproximateLinear(realisations=2).estimates(series(0.0), [asked], always=True)
        assert simulated.value == pytest.approx(norm, rel=1e-4)


NOTCH = Filter([1.0, 1.0, 15.0**2], [1.0, 20.0, 15.0**2])  # takes the resonance away
LOAD = it.LoadCarrying(amplitude=1000.0)
PASSED = {"notch": NOTCH, "Wk": WK, "lead": Filter([0.1, 1.0], [1.0, 1.0])}


@pytest.mark.parametrize("name", sampled(PASSED, ["notch"]))
def test_peak_gains_pass_through_a_filter(name):
    plain, asked = paper_quarter_car(k | Damper(4e3) - Inerter(100.0)), Weighed(LOAD, PASSED[name])
    expected = rational.index_value(plain.mechanism(), asked)
    assert it.evaluate(plain, asked, it.Norm()).value == pytest.approx(expected, rel=1e-9)
    opened_up = paper_quarter_car(k | Damper(free(1e3, 1e5, "c")) - Inerter(100.0))
    assert it.evaluate_many(opened_up, asked, {"c": 4e3}, it.Norm())[0, 0] == pytest.approx(expected, rel=1e-8)
    little = paper_quarter_car(k | Damper(4e3) - (Inerter(100.0) | Friction(0.01)))
    assert it.evaluate(little, asked, it.StatisticalLinearisation()).value == pytest.approx(expected, rel=1e-4)
    assert it.evaluate(little, asked, it.ExpectedValue()).value == pytest.approx(expected, rel=1e-4)
    assert it.evaluate(little, asked, it.ApproximateLinear()).value == pytest.approx(expected, rel=2e-3)


def test_with_friction_harmonic_balance_and_simulation_filter_peak_gains_alike():
    rubbing = paper_quarter_car(k | Damper(4e3) - (Inerter(100.0) | Friction(100.0)))
    simulated = it.evaluate(rubbing, Weighed(LOAD, NOTCH), it.ExpectedValue())
    balanced = it.evaluate(rubbing, Weighed(LOAD, NOTCH), it.StatisticalLinearisation())
    assert simulated.status.ok
    assert simulated.value == pytest.approx(balanced.value, rel=0.03)


def test_a_high_pass_is_a_filter_like_any_other():
    design = paper_half_car(k | Damper(4e3) - Inerter(100.0), k | Damper(3e3))
    corner = 2.0 * math.pi
    as_filter = Weighed(J3, Filter([1.0, 0.0], [1.0, corner]))
    high_pass = it.TyreLoad(ROAD, high_pass=corner)
    assert it.evaluate(design, as_filter, it.Norm()).value == it.evaluate(design, high_pass, it.Norm()).value
    papers = [it.evaluate(design, index, it.Norm("paper2008")).value for index in (J3, high_pass)]
    assert papers[0] == papers[1]
    assert it.evaluate(design, J3, it.Norm()).value > papers[0]
