"""Indices over operating conditions: against each condition by itself, gradients against differences, optima."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from slopes import assert_slopes, value_and_gradient
from wang_su import J1, J3, J5, ROAD, paper_quarter_car

import inerter as it
from inerter.errors import DesignError
from inerter.methods.composite_index import objective_of

NORM = it.Norm()
USE = it.Conditions(
    [
        it.Condition(3.0, road={"speed": 15.0}),
        it.Condition(5.0, road={"speed": 30.0}, vehicle={"sprung_mass": 240.0, "k": 9e4}),
        it.Condition(2.0, road=it.Road(roughness=2e-6, speed=10.0), vehicle={"tyre_stiffness": 1.5e5}, name="laden"),
    ]
)


def car():
    return paper_quarter_car(
        it.Spring(1.2e5) | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(it.free(1.0, 2e3, "b"))
    )


def by_hand(index, design):
    """The values in the three conditions."""
    on = lambda road: dataclasses.replace(index, road=road) if hasattr(index, "road") else index  # noqa: E731
    heavy = dataclasses.replace(design, sprung_mass=240.0)
    damper = design.strut.parts[1]
    heavy = dataclasses.replace(heavy, strut=it.Spring(9e4) | damper)
    stiff = dataclasses.replace(design, tyre_stiffness=1.5e5)
    roads = [it.Road(5e-7, 15.0), it.Road(5e-7, 30.0), it.Road(2e-6, 10.0)]
    cars = [design, heavy, stiff]
    return [it.evaluate(one, on(road), NORM).value for one, road in zip(cars, roads, strict=True)]


@pytest.mark.parametrize("index", [J1, J3, J5], ids=["J1", "J3", "J5"])
def test_mean_and_worst_are_those_of_the_conditions(index):
    rng = np.random.default_rng(0)
    points = {"c": rng.uniform(1e3, 2e4, 4), "b": rng.uniform(10.0, 1e3, 4)}
    many = it.evaluate_many(car(), [USE.mean(index), USE.worst(index), index], points, NORM)
    for i in range(4):
        design = car().with_values({name: float(column[i]) for name, column in points.items()})
        values = by_hand(index, design)
        expected = [np.dot([0.3, 0.5, 0.2], values), max(values), it.evaluate(design, index, NORM).value]
        assert many[i] == pytest.approx(expected, rel=1e-9)
        for over, value in zip((USE.mean(index), USE.worst(index)), expected, strict=False):
            assert it.evaluate(design, over, NORM).value == pytest.approx(value, rel=1e-12)


def test_a_seat_over_conditions():
    """Numbers of the vehicle below, of the occupant, and of elements that both have."""
    below = paper_quarter_car(it.Spring(1.2e5) | it.Damper(it.free(100.0, 1e5, "c")))
    seat = it.Seat(below, mass=70.0, network=it.Spring(2e4) | it.Damper(1.5e3, name="cs"))
    use = it.Conditions(
        [
            it.Condition(1.0, vehicle={"mass": 100.0, "sprung_mass": 240.0}),
            it.Condition(1.0, vehicle={"cs": 900.0, "k": 5e4, "tyre_stiffness": 1.5e5}),
        ]
    )
    named = dataclasses.replace(seat, network=it.Spring(2e4, name="k") | it.Damper(1.5e3, name="cs"))
    heavy = it.Seat(dataclasses.replace(below, sprung_mass=240.0), mass=100.0, network=named.network)
    softer = paper_quarter_car(it.Spring(5e4) | below.strut.parts[1])
    softer = dataclasses.replace(softer, tyre_stiffness=1.5e5)
    soft = it.Seat(softer, mass=70.0, network=it.Spring(5e4, name="k") | it.Damper(900.0, name="cs"))
    expected = [it.evaluate(one.with_values({"c": 3e3}), J1, NORM).value for one in (heavy, soft)]
    found = it.evaluate(named.with_values({"c": 3e3}), use.mean(J1), NORM).value
    assert found == pytest.approx(np.mean(expected), rel=1e-12)
    with pytest.raises(DesignError, match="sprung_mass, unsprung_mass, tyre_stiffness, mass, k, c, cs"):
        it.evaluate(seat.with_values({"c": 3e3}), it.Conditions([it.Condition(1.0, vehicle={"m": 1.0})]).mean(J1), NORM)


@pytest.mark.parametrize("index", [J1, J5], ids=["J1", "J5"])
@pytest.mark.parametrize("worst", [False, True])
def test_gradients_over_conditions(index, worst):
    objective = objective_of(car(), USE.worst(index) if worst else USE.mean(index), NORM)
    point = np.array([7e3, 400.0])
    value, gradient = value_and_gradient(objective, point)
    assert value == pytest.approx(float(objective.values(point[None])[0]), rel=1e-9)
    assert_slopes(objective, point, gradient, step=1e-5, abs=2e-5 * value)


@pytest.mark.parametrize("over", [USE.mean(J1), USE.worst(J1), USE.mean(J5), USE.worst(J5)])
def test_optima_over_conditions(over):
    best = it.optimise(car(), over, NORM)
    assert best.status.ok
    assert best.n_converged > best.n_starts // 2
    rng = np.random.default_rng(1)
    near = {
        n: np.minimum(v * np.exp(rng.normal(0.0, 0.1, 500)), 2e3 if n == "b" else 1e5)
        for n, v in best.parameters.items()
    }
    assert np.nanmin(it.evaluate_many(car(), over, near, NORM)) >= best.value * (1.0 - 1e-8)


def test_a_limit_over_conditions():
    free = it.optimise(car(), USE.mean(J1), NORM)
    least = it.optimise(car(), USE.worst(J5), NORM).value
    here = it.evaluate(free.design, USE.worst(J5), NORM).value
    limit = it.at_most(USE.worst(J5), float(np.sqrt(least * here)))
    best = it.optimise(car(), USE.mean(J1), NORM, subject_to=[limit])
    assert best.limits[0].value == pytest.approx(limit.value, rel=1e-6)
    assert best.value > free.value


def test_simulated_means_have_errors():
    design = paper_quarter_car(it.Spring(1.2e5) | it.Damper(7e3) - (it.Inerter(300.0) | it.Friction(20.0)))
    use = it.Conditions([it.Condition(1.0, road={"speed": 15.0}), it.Condition(3.0, vehicle={"sprung_mass": 240.0})])
    method = it.ExpectedValue(realisations=4, seed=0)
    found = it.evaluate(design, use.mean(J1), method)
    one = it.evaluate(design, it.RideComfort(it.Road(5e-7, 15.0)), method)
    other = it.evaluate(dataclasses.replace(design, sprung_mass=240.0), J1, method)
    assert found.value == pytest.approx(0.25 * one.value + 0.75 * other.value, rel=1e-12)
    assert found.standard_error == pytest.approx(0.25 * one.standard_error + 0.75 * other.standard_error, rel=1e-12)
    two = it.compare(design, dataclasses.replace(design, unsprung_mass=30.0), use.mean(J1), method)
    assert two.difference.standard_error < found.standard_error
    worst = it.evaluate(design, use.worst(J1), method)
    assert worst.value == max(one.value, other.value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda: it.Conditions([]), "at least one"),
        (lambda: it.Conditions(J1), "are a list of Condition"),
        (lambda: it.Condition(0.0), "positive number, got 0.0"),
        (lambda: it.Condition(road={"sped": 3.0}), "numbers of one by name"),
        (lambda: it.Condition(road="B"), "The road of a condition"),
        (lambda: it.Condition(vehicle=3.0), "numbers of the vehicle by name"),
        (lambda: USE.mean("J1"), "Conditions require an index"),
        (
            lambda: it.optimise(car(), it.Conditions([it.Condition(vehicle={"mass": 1.0})]).mean(J1), NORM),
            "unknown value",
        ),
        (lambda: it.optimise(car(), it.Conditions([it.Condition(vehicle={"k": "a"})]).mean(J1), NORM), "finite number"),
    ],
)
def test_conditions_that_cannot_be(given, said):
    with pytest.raises(it.InerterError, match=said):
        given()


def seated(given, mass):
    return it.Seat(given, mass, it.Spring(12e3, "ks") | it.Damper(300.0, "cs"))


CAR = it.QuarterCar(250.0, 35.0, 1.8e5, it.Spring(2.5e4, "k1") | it.Damper(1500.0))
TRAIN = it.Mechanism(
    coordinates=(it.Coordinate("sprung", 250.0), it.Coordinate("bogie", 35.0)),
    struts=(it.Strut("strut", CAR.strut, upper={"sprung": 1.0}, lower={"bogie": 1.0}),),
    tyres=(it.Tyre("tyre", it.Spring(1.8e5, "kt"), port={"bogie": 1.0}, road="road"),),
    roads=(it.RoadInput("road"),),
)


class Given:
    """A vehicle that says nothing of what it is made of, and makes its elements anew whenever it is asked."""

    def mechanism(self):
        return dataclasses.replace(TRAIN, tyres=(dataclasses.replace(TRAIN.tyres[0], network=it.Spring(1.8e5, "kt")),))

    def free_values(self):
        return {}

    def with_values(self, values):
        return self


SEATED = {
    "sprung_mass": (CAR, lambda: seated(dataclasses.replace(CAR, sprung_mass=200.0), 70.0), 200.0),
    "tyre_stiffness": (CAR, lambda: seated(dataclasses.replace(CAR, tyre_stiffness=2e5), 70.0), 2e5),
    "mass": (CAR, lambda: seated(CAR, 90.0), 90.0),
    "k1": (CAR, lambda: seated(dataclasses.replace(CAR, strut=it.Spring(3e4) | it.Damper(1500.0)), 70.0), 3e4),
    "kt": (TRAIN, lambda: seated(dataclasses.replace(CAR, tyre_stiffness=2e5), 70.0), 2e5),
    "bogie": (TRAIN, lambda: seated(dataclasses.replace(CAR, unsprung_mass=50.0), 70.0), 50.0),
}


@pytest.mark.parametrize("name", SEATED)
def test_numbers_of_a_vehicle_that_carries_a_seat(name):
    below, other, value = SEATED[name]
    use = it.Conditions([it.Condition(vehicle={name: value})])
    expected = it.evaluate(other(), J1, NORM).value
    assert it.evaluate(seated(below, 70.0), use.mean(J1), NORM).value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("carried", [False, True])
def test_elements_of_a_vehicle_that_makes_them_anew(carried):
    given, same = (seated(Given(), 70.0), seated(TRAIN, 70.0)) if carried else (Given(), TRAIN)
    use = it.Conditions([it.Condition(vehicle={"kt": 3e5})])
    index = it.RandomResponse({"sprung_acceleration": 1.0}, ROAD)
    expected = it.evaluate(same, use.mean(index), NORM).value
    assert it.evaluate(given, use.mean(index), NORM).value == pytest.approx(expected, rel=1e-12)
    scattered = [it.tolerance_analysis(one, index, NORM, spread={"kt": 0.1}, samples=16).mean for one in (given, same)]
    assert scattered[0] == pytest.approx(scattered[1], rel=1e-12)


def test_what_stands_for_the_tyre_of_a_model_is_not_its_name():
    for vehicle in (CAR, seated(CAR, 70.0)):
        with pytest.raises(it.InerterError, match="unknown value 'k'"):
            it.evaluate(vehicle, it.Conditions([it.Condition(vehicle={"k": 3e5})]).mean(J1), NORM)


def test_a_name_of_an_element_and_of_a_coordinate_is_refused():
    """Otherwise a condition or a tolerance of the mass would silently be one of the inerter, whose symbol is b."""

    def train(mass, name):
        strut = it.Strut("strut", CAR.strut | it.Inerter(30.0, name), upper={"b": 1.0}, lower={"bogie": 1.0})
        return dataclasses.replace(TRAIN, coordinates=(it.Coordinate("b", mass), TRAIN.coordinates[1]), struts=(strut,))

    index = it.RandomResponse({"b_acceleration": 1.0}, ROAD)
    heavy = it.Conditions([it.Condition(vehicle={"b": 600.0})]).mean(index)
    expected = it.evaluate(train(600.0, "b1"), index, NORM).value
    assert it.evaluate(train(250.0, "b1"), heavy, NORM).value == pytest.approx(expected, rel=1e-12)
    ambiguous = "'b' is ambiguous: an element and the mass of a coordinate"
    with pytest.raises(DesignError, match=ambiguous):
        it.evaluate(train(250.0, None), heavy, NORM)
    with pytest.raises(DesignError, match=ambiguous):
        it.tolerance_analysis(train(250.0, None), index, NORM, spread={"b": 0.1}, samples=16)
