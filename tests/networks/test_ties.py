"""Values that follow from others: arithmetic against numbers, slopes against differences, and in designs."""

from __future__ import annotations

import numpy as np
import pytest
from slopes import assert_slopes
from strategies import random_half_car
from wang_su import J1, J3, J5, paper_quarter_car

import inerter as it
from inerter.methods.composite_index import objective_of

NORM = it.Norm()


def random_tie(rng, depth=3):
    """A tie of x and y with a function that says the same in numbers."""
    if depth == 0 or rng.random() < 0.2:
        name, factor, plus = str(rng.choice(["x", "y"])), float(rng.uniform(0.5, 2.0)), float(rng.uniform(0.0, 1.0))
        return it.tied(name, factor, plus), lambda v: factor * v[name] + plus
    (a, f), (b, g) = random_tie(rng, depth - 1), random_tie(rng, depth - 1)
    number = float(rng.uniform(0.5, 2.0))
    return [
        (a + b, lambda v: f(v) + g(v)),
        (a - b, lambda v: f(v) - g(v)),
        (a * b, lambda v: f(v) * g(v)),
        (a / b, lambda v: f(v) / g(v)),
        (number / a, lambda v: number / f(v)),
        (number - a * number, lambda v: number - f(v) * number),
    ][int(rng.integers(6))]


@pytest.mark.parametrize("number", range(40))
def test_arithmetic_of_ties_and_their_slopes(number):
    rng = np.random.default_rng(number)
    tie, function = random_tie(rng)
    at = {"x": float(rng.uniform(1.0, 3.0)), "y": float(rng.uniform(1.0, 3.0))}
    value, slopes = tie.slopes(at)
    assert value == pytest.approx(function(at), rel=1e-12)
    assert tie.substitute(at) == pytest.approx(function(at), rel=1e-12)
    if len(tie.names) == 2:
        assert tie.substitute({"x": at["x"]}).substitute({"y": at["y"]}) == pytest.approx(function(at), rel=1e-12)
    for name, slope in slopes.items():
        step = 1e-6
        up, down = (function({**at, name: at[name] + h}) for h in (step, -step))
        assert slope == pytest.approx((up - down) / (2.0 * step), rel=1e-5, abs=1e-6 * (1.0 + abs(value)))


def half_car(front_stiffness=None, seed=11):
    """A half car whose rear strut is 0.8 times the front one, and whose front has a spring made up to 60 kN/m."""
    stiff = it.Spring(it.free(8e4, 4e5, "k1")) - it.Spring(1.0 / (1.0 / 6e4 - 1.0 / it.tied("k1")), "k2")
    front = stiff | it.Damper(it.free(300.0, 3e4, "c")) - it.Inerter(it.free(1.0, 1e3, "b"))
    rear = it.Spring(5e4) | it.Damper(it.tied("c", factor=0.8), "cr") - it.Inerter(it.tied("b", factor=0.8), "br")
    return random_half_car(np.random.default_rng(seed), front, rear)


@pytest.mark.parametrize("index", [J1, J3, J5], ids=["J1", "J3", "J5"])
def test_tied_designs_are_those_of_their_numbers(index):
    car, rng = half_car(), np.random.default_rng(3)
    points = {"k1": rng.uniform(8e4, 4e5, 5), "c": rng.uniform(500.0, 8e3, 5), "b": rng.uniform(5.0, 500.0, 5)}
    found = it.evaluate_many(car, index, points, NORM)[:, 0]
    for i in range(5):
        k1, c, b = (float(points[name][i]) for name in ("k1", "c", "b"))
        k2 = 1.0 / (1.0 / 6e4 - 1.0 / k1)
        front = it.Spring(k1) - it.Spring(k2) | it.Damper(c) - it.Inerter(b)
        rear = it.Spring(5e4) | it.Damper(0.8 * c) - it.Inerter(0.8 * b)
        other = random_half_car(np.random.default_rng(11), front, rear)
        assert found[i] == pytest.approx(it.evaluate(other, index, NORM).value, rel=1e-9)
        design = car.with_values({"c": c}).with_values({"k1": k1, "b": b})
        assert it.evaluate(design, index, NORM).value == pytest.approx(found[i], rel=1e-9)
        assert it.evaluate(design, it.static_stiffness("front"), NORM).value == pytest.approx(6e4, rel=1e-12)
    assert list(car.free_values()) == ["k1", "c", "b"]


@pytest.mark.parametrize("index", [J1, J3], ids=["J1", "J3"])
def test_gradients_of_tied_designs(index):
    objective, point = objective_of(half_car(), index, NORM), np.array([2e5, 3e3, 80.0])
    value, gradient = objective.value_and_gradient(point)
    assert_slopes(objective, point, gradient, step=1e-5, abs=1e-6 * value)


@pytest.mark.campaign
def test_an_optimum_of_tied_values():
    best = it.optimise(half_car(), J1, NORM)
    assert best.n_converged > 1
    assert "b" not in best.active_bounds
    for name, factor in (("c", 1.02), ("c", 0.98), ("b", 1.02), ("b", 0.98)):
        other = {**best.parameters, name: best.parameters[name] * factor}
        assert it.evaluate(half_car().with_values(other), J1, NORM).value >= best.value * (1.0 - 1e-9)
    values = {e.label: e.value for e in best.design.rear.elements()}
    assert values["cr"] == pytest.approx(0.8 * best.parameters["c"], rel=1e-15)


def test_a_tie_that_cannot_be_met_is_nowhere_chosen():
    soft = it.Spring(it.free(1e4, 4e5, "k1")) - it.Spring(1.0 / (1.0 / 6e4 - 1.0 / it.tied("k1")))
    car = paper_quarter_car(soft | it.Damper(it.free(100.0, 1e5, "c")))
    found = it.evaluate_many(car, J1, {"k1": [2e4, 5.9e4, 6.1e4, 1e5], "c": 2e3}, NORM)[:, 0]
    assert np.isnan(found).tolist() == [True, True, False, False]
    assert it.optimise(car, J1, NORM).parameters["k1"] > 6e4
    with pytest.raises(it.InerterError, match="must be positive"):
        car.with_values({"k1": 2e4, "c": 2e3})


def test_labels_stay_when_values_are_fixed():
    damper = it.Damper(it.free(1.0, 1e5, "front_damping"))
    car = paper_quarter_car(it.Spring(1e5) | damper | it.Inerter(it.free(1, 9)))
    fixed = car.with_values({"front_damping": 2e3, "b": 3.0})
    assert [element.label for element in fixed.strut.elements()] == ["k", "front_damping", "b"]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda: it.tied(3.0), "A name must be a letter"),
        (lambda: it.tied(None), "Give its name"),
        (lambda: it.tied("c", factor=float("inf")), "finite numbers"),
        (lambda: it.tied("c") + "d", "finite numbers"),
        (
            lambda: paper_quarter_car(it.Damper(it.tied("c")) | it.Spring(1.0)),
            "'c' is tied to 'c', which is not a free",
        ),
        (lambda: it.evaluate(half_car(), J1, NORM), "still has free values: k1, c, b"),
        (lambda: it.simulate(half_car(), road=it.sine(1e-3, 1.0), duration=0.1), "free"),
        (lambda: it.Damper(it.tied("c")).admittance(1j), "is free"),
    ],
)
def test_ties_that_cannot_be(given, said):
    with pytest.raises(it.InerterError, match=said):
        given()


def test_ties_reach_methods_that_simulate():
    friction = it.Friction(20.0)
    strut = it.Spring(1.2e5) | it.Damper(it.free(1e3, 3e4, "c")) - (it.Inerter(it.tied("c", factor=0.05)) | friction)
    car = paper_quarter_car(strut)
    for method in (it.StatisticalLinearisation(), it.ExpectedValue(realisations=2)):
        many = it.evaluate_many(car, J1, {"c": [4e3, 8e3]}, method)[:, 0]
        ones = [it.evaluate(car.with_values({"c": c}), J1, method).value for c in (4e3, 8e3)]
        assert many == pytest.approx(ones, rel=1e-9)


def test_the_old_name_of_substitute_works_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="`fixed` is now `substitute`"):
        assert it.tied("k", 2.0).fixed({"k": 3.0}) == 6.0
