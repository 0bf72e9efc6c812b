"""Masses, stiffnesses and damping of a vehicle that an optimiser may choose."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray
from slopes import assert_slopes, value_and_gradient
from wang_su import ROAD

import inerter as it
from inerter.vehicle.replace_values import replace_values

Array = NDArray[np.float64]
STRUT = it.Spring(120e3) | it.Damper(3e3) - it.Inerter(200.0)
NORM = it.Norm()


def _around(value: float) -> it.Free:
    return it.free(0.5 * value, 2.0 * value)


def _cars(of: object) -> dict[str, it.Vehicle]:
    """Vehicles whose quantities are numbers, or what `of` makes of these."""
    make: object = of
    assert callable(make)
    half = {"distance_front": 1.2, "distance_rear": 1.5, "front": STRUT, "rear": STRUT}
    half |= {"sprung_mass": make(600.0), "pitch_inertia": make(900.0)}
    half |= {"unsprung_mass_front": make(40.0), "unsprung_mass_rear": make(35.0)}
    half |= {"tyre_stiffness_front": make(200e3), "tyre_stiffness_rear": make(180e3)}
    mount = it.Spring(4e3) | it.Damper(200.0)
    quarter = it.QuarterCar(make(250.0), make(35.0), make(150e3), STRUT)
    return {
        "quarter": quarter,
        "half": it.HalfCar(**half),
        "full": it.FullCar(**half, roll_inertia=make(300.0), track_front=1.5, track_rear=1.4),
        "seat": it.Seat(quarter, make(60.0), it.Spring(10e3) | it.Damper(400.0)),
        "absorber": it.Absorber(make(1e3), make(40e3), make(50.0), mount, primary_damping=make(100.0)),
    }


CARS, FREE = _cars(float), _cars(_around)
INDICES = {
    "comfort": it.RideComfort(ROAD),
    "load": it.TyreLoad(ROAD),
    "carrying": it.LoadCarrying(),
    "pushed": it.RandomResponse({"primary_velocity": 1.0}, it.WhiteForce("primary_force", 1.0)),
    "shaken": it.RandomResponse({"primary_acceleration": 1.0, "mount_travel": 9.0}, it.GroundAcceleration(1.0)),
}
ASKED = [(car, name) for car in CARS for name in INDICES if (car == "absorber") == (name in ("pushed", "shaken"))]


@pytest.mark.parametrize(("car", "name"), sampled(ASKED, [("quarter", "load"), ("absorber", "shaken")]))
def test_an_index_of_free_quantities_is_that_of_designs_with_these_numbers(car: str, name: str) -> None:
    free, index = FREE[car].free_values(), INDICES[name]
    rng = np.random.default_rng(7)
    points = {n: rng.uniform(f.lower, f.upper, 3) for n, f in free.items()}
    found = NORM.estimate_many(FREE[car], [index], points)[:, 0]
    rows = [dict(zip(points, row, strict=True)) for row in zip(*points.values(), strict=True)]
    alone = [it.evaluate(replace_values(CARS[car], row), index, NORM).value for row in rows]
    np.testing.assert_allclose(found, alone, rtol=1e-9)


@pytest.mark.parametrize(("car", "name"), sampled(ASKED, [("seat", "comfort"), ("absorber", "shaken")]))
def test_gradients_over_quantities_are_the_differences_of_values(car: str, name: str) -> None:
    objective = NORM.objective(FREE[car], INDICES[name])
    point = np.array([sqrt(f.lower * f.upper) * 1.1 for f in FREE[car].free_values().values()])
    value, gradient = value_and_gradient(objective, point)
    assert_slopes(objective, point, gradient, step=1e-4, rel=1e-5, abs=1e-6 * value)


def test_a_mass_on_moving_ground_against_its_closed_form() -> None:
    c, k, intensity = 30.0, 4e3, 0.2
    swing = it.Strut("swing", it.Spring(k) | it.Damper(c), upper={"mass": 1.0}, lower=it.GROUND)
    mass = it.Mechanism(coordinates=(it.Coordinate("mass", it.free(50.0, 500.0)),), struts=(swing,))
    index = it.RandomResponse({"mass_relative_displacement": 1.0}, it.GroundAcceleration(intensity))
    objective = NORM.objective(mass, index)
    value, gradient = objective.value_and_gradient(np.array([120.0]))
    assert value == pytest.approx(120.0 * sqrt(intensity / (2.0 * c * k)), rel=1e-12)  # force m a: S m^2 / (2 c k)
    assert gradient == pytest.approx([sqrt(intensity / (2.0 * c * k))], rel=1e-9)
    assert mass.free_values() == {"mass": it.Free(50.0, 500.0, "mass")}


def test_the_best_support_of_an_absorber_is_that_of_another_search() -> None:
    mount = it.Spring(it.free(1e2, 1e5, name="k")) | it.Damper(it.free(1.0, 1e4, name="c"))
    absorber = it.Absorber(1e3, it.free(30e3, 60e3), it.free(20.0, 60.0, name="m"), mount, primary_damping=50.0)
    shaken = it.RandomResponse({"primary_relative_displacement": 1.0}, it.GroundAcceleration(1e-2))
    best = it.optimise(absorber, shaken, NORM, seed=0)
    assert list(best.parameters) == ["primary_stiffness", "k", "c", "m"]
    assert best.design.mass == best.parameters["m"] == pytest.approx(60.0)  # the heavier the better
    assert best.design.primary_stiffness == pytest.approx(60e3)  # and the stiffer
    tuned = it.Absorber(1e3, 60e3, 60.0, mount, primary_damping=50.0)
    assert best.value == pytest.approx(it.optimise(tuned, shaken, NORM, seed=1).value, rel=1e-9)


def test_an_optimum_inside_is_where_its_neighbours_are_worse() -> None:
    mount = it.Spring(2e3) | it.Damper(60.0)
    best = it.optimise(it.Absorber(1e3, 40e3, it.free(5.0, 500.0), mount), INDICES["pushed"], NORM, seed=0)
    assert 10.0 < best.design.mass == best.parameters["mass"] < 400.0
    for factor in (0.97, 1.03):
        other = it.Absorber(1e3, 40e3, factor * best.design.mass, mount)
        assert it.evaluate(other, INDICES["pushed"], NORM).value > best.value


def test_statistical_linearisation_takes_a_free_mass_like_a_number() -> None:
    strut = it.Spring(20e3) | it.Damper(1500.0) | it.Friction(20.0)
    car = it.QuarterCar(it.free(200.0, 300.0), 35.0, 150e3, strut)
    method = it.StatisticalLinearisation()
    found = method.estimate_many(car, [it.RideComfort(ROAD)], {"sprung_mass": np.array([240.0])})[0, 0]
    alone = it.evaluate(it.QuarterCar(240.0, 35.0, 150e3, strut), it.RideComfort(ROAD), method)
    assert found == pytest.approx(alone.value, rel=1e-9)


def test_free_masses_and_scatter() -> None:
    car = it.QuarterCar(it.free(200.0, 300.0, name="m"), 35.0, 150e3, STRUT)
    scattered = it.tolerance_analysis(
        car.with_values({"m": 250.0}), it.RideComfort(ROAD), NORM, spread={"sprung_mass": 0.1}, samples=64
    )
    assert scattered.quantile(0.05) < it.evaluate(car.with_values({"m": 250.0}), it.RideComfort(ROAD), NORM).value


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (
            lambda: it.HalfCar(600.0, 900.0, 40.0, 35.0, 2e5, 2e5, it.free(1.0, 2.0), 1.5, STRUT, STRUT),
            "The distance front of the half car cannot be free: the equations of motion are not linear in it",
        ),
        (
            lambda: it.QuarterCar(it.free(0.0, 300.0), 35.0, 150e3, STRUT),
            "The sprung mass of the quarter car must be positive, and its lower bound is 0 kg",
        ),
        (
            lambda: it.evaluate(FREE["quarter"], INDICES["comfort"], NORM),
            "The design still has free values: tyre_stiffness, sprung_mass, unsprung_mass",
        ),
        (
            lambda: it.optimise(
                it.QuarterCar(it.free(200.0, 300.0), 35.0, 150e3, STRUT), it.DynamicLoadCoefficient(ROAD), NORM
            ),
            "The static tyre loads are not known: the mass of 'sprung' is free",
        ),
        (
            lambda: it.QuarterCar(it.free(200.0, 300.0, name="k"), 35.0, 150e3, it.Spring(it.free(1e3, 2e3, name="k"))),
            "The free value 'k' has two ranges",
        ),
        (
            lambda: it.simulate(FREE["quarter"], road=it.multisine(ROAD, seed=0), duration=1.0, step=1e-3),
            "still has free values",
        ),
    ],
)
def test_what_cannot_be_is_said(make: object, said: str) -> None:
    with pytest.raises(it.InerterError, match=said):
        make()  # type: ignore[operator]


def _free_inerter(name: str, value_name: str | None = None) -> it.Network:
    return it.Spring(120e3) | it.Inerter(it.free(20.0, 500.0, name=value_name), name=name)


FREE_MASS = it.free(20.0, 500.0)
TWICE = {
    "quantity": lambda network: it.QuarterCar(250.0, FREE_MASS, 150e3, network("unsprung_mass")),
    "in another strut": lambda network: it.Seat(
        it.QuarterCar(250.0, 35.0, 150e3, network("mass")), FREE_MASS, it.Spring(10e3)
    ),
    "below a stage": lambda network: it.Seat(
        it.QuarterCar(250.0, FREE_MASS, 150e3, STRUT), 60.0, network("unsprung_mass")
    ),
    "of one part, with the name of another": lambda network: it.Seat(
        it.Absorber(1e3, 40e3, 50.0, network("mass")), FREE_MASS, it.Spring(10e3), place={"primary": 1.0}
    ),
    "coordinate": lambda network: it.Mechanism(
        (it.Coordinate("body", FREE_MASS),), (it.Strut("strut", network("body"), {"body": 1.0}, it.GROUND),)
    ),
}


@pytest.mark.parametrize("where", TWICE)
def test_a_quantity_and_an_element_are_one_free_value_only_where_both_were_given_its_name(where: str) -> None:
    with pytest.raises(it.InerterError, match=r"is free twice, as .* and as an element: they would be one value"):
        TWICE[where](_free_inerter)
    apart = TWICE[where](lambda name: _free_inerter("b"))
    assert len(apart.free_values()) == 2
    assert apart.with_values({"b": 30.0}).free_values().keys() == apart.free_values().keys() - {"b"}


def test_two_free_quantities_of_one_name_are_refused_until_one_is_named() -> None:
    absorber = it.Absorber(1e3, 40e3, FREE_MASS, it.Spring(4e3) | it.Damper(200.0))
    with pytest.raises(it.InerterError, match="'mass' is free in two parts of the vehicle: they would be one value"):
        it.Seat(absorber, FREE_MASS, it.Spring(10e3), place={"primary": 1.0})
    apart = it.Seat(absorber, it.free(20.0, 500.0, name="driver"), it.Spring(10e3), place={"primary": 1.0})
    assert apart.free_values().keys() == {"mass", "driver"}


def test_free_values_that_were_given_one_name_are_one() -> None:
    car = it.QuarterCar(250.0, it.free(20.0, 500.0, name="both"), 150e3, _free_inerter("b", "both"))
    assert list(car.free_values()) == ["both"]
    assert car.with_values({"both": 40.0}).unsprung_mass == 40.0
