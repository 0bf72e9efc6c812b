"""The weight on every tyre against balances of forces and moments written out, and what has none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from wang_su import paper_half_car, paper_quarter_car

import inerter as it
from inerter.errors import MechanismError

G = 9.80665
STRUT = it.Spring(2e4) | it.Damper(it.free(100.0, 1e4, name="c")) - it.Inerter(30.0)


def axles(levers, masses, body=1000.0, inertia=1500.0, strut=STRUT, **parts):
    names = [f"axle{i}" for i in range(len(levers))]
    return it.Mechanism(
        coordinates=(
            it.Coordinate("body", body),
            it.Coordinate("pitch", inertia, angle=True),
            *(it.Coordinate(n, m) for n, m in zip(names, masses, strict=True)),
        ),
        struts=(
            *(
                it.Strut(f"s_{n}", strut, {"body": 1.0, "pitch": lever}, {n: 1.0})
                for n, lever in zip(names, levers, strict=True)
            ),
            *parts.get("struts", ()),
        ),
        tyres=tuple(it.Tyre(f"t_{n}", it.Spring(2e5) | it.Damper(50.0), {n: 1.0}, f"r_{n}") for n in names),
        roads=tuple(it.RoadInput(f"r_{n}") for n in names),
    )


@pytest.mark.parametrize("seed", range(20))
def test_two_axles_by_moments(seed):
    a, b, m1, m2, body = np.random.default_rng(seed).uniform([0.3, 0.3, 5, 5, 100], [3, 3, 100, 100, 3000])
    found = it.static_tyre_loads(axles([a, -b], [m1, m2], body))
    assert found["t_axle0"] == pytest.approx(G * (m1 + body * b / (a + b)), rel=1e-12)
    assert found["t_axle1"] == pytest.approx(G * (m2 + body * a / (a + b)), rel=1e-12)


def test_the_cars():
    strut = it.Spring(1e5) | it.Damper(it.free(1.0, 2.0))
    assert it.static_tyre_loads(paper_quarter_car(strut)) == {"tyre": pytest.approx(G * 206.75)}
    found = it.static_tyre_loads(paper_half_car(strut, strut))
    assert found["tyre_front"] == pytest.approx(G * (25.0 + 363.5 * 1.265 / 2.04))
    assert found["tyre_rear"] == pytest.approx(G * (20.0 + 363.5 * 0.775 / 2.04))


def test_three_axles_share_as_evenly_as_balance_allows():
    """Among all loads that balance the body, those of the smallest sum of squares, by Lagrange's multipliers."""
    levers, masses, body = np.array([2.1, -1.2, -2.4]), np.array([350.0, 300.0, 320.0]), 9000.0
    found = np.array(list(it.static_tyre_loads(axles(levers, masses, body)).values()))
    balance = np.array([np.ones(3), levers])
    right = np.array([G * (body + masses.sum()), G * levers @ masses])
    expected = balance.T @ np.linalg.solve(balance @ balance.T, right)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_damper_to_the_ground_carries_nothing():
    sky = it.Strut("sky", it.Damper(1e3), {"body": 1.0}, it.GROUND)
    plain, held = axles([1.0, -1.5], [40.0, 30.0]), axles([1.0, -1.5], [40.0, 30.0], struts=(sky,))
    assert it.static_tyre_loads(held) == pytest.approx(it.static_tyre_loads(plain))


def test_two_tyres_on_one_road_are_told_apart():
    car = it.Mechanism(
        coordinates=(it.Coordinate("beam", 100.0),),
        struts=(it.Strut("none", it.Damper(1.0), {"beam": 1.0}, it.GROUND),),
        tyres=tuple(it.Tyre(n, it.Spring(1e5), {"beam": 1.0}, "road") for n in ("inner", "outer")),
        roads=(it.RoadInput("road"),),
    )
    assert it.static_tyre_loads(car) == pytest.approx({"inner": 50 * G, "outer": 50 * G})


UNKNOWN = {
    "a spring to the ground": (
        {"struts": (it.Strut("sky", it.Spring(1e3), {"body": 1.0}, it.GROUND),)},
        "one to the ground",
    ),
    "on dampers alone": ({"strut": it.Damper(1e3)}, "rests on no spring"),
    "in series with a damper": ({"strut": it.Spring(1e4) - it.Damper(1e3)}, "rests on no spring"),
}


@pytest.mark.parametrize(("parts", "sentence"), UNKNOWN.values(), ids=UNKNOWN.keys())
def test_what_is_not_known_is_said(parts, sentence):
    with pytest.raises(MechanismError, match=sentence):
        it.static_tyre_loads(axles([1.0, -1.5], [40.0, 30.0], **parts))


def test_a_tyre_that_would_hang():
    with pytest.raises(MechanismError, match="'t_axle0' would carry a negative load"):
        it.static_tyre_loads(axles([1.0, 0.4], [5.0, 5.0]))


def test_a_mechanism_without_any_spring_says_that_its_weight_rests_on_none():
    car = it.QuarterCar(300.0, 40.0, 2e5, it.Damper(1.5e3)).mechanism()
    (tyre,) = car.tyres
    with pytest.raises(MechanismError, match="rests on no spring"):
        it.static_tyre_loads(replace(car, tyres=(replace(tyre, network=it.Damper(1e3)),)))


def test_a_lever_that_does_not_follow_the_vehicle_is_told():
    car = it.QuarterCar(300.0, 40.0, 2e5, it.Spring(2e4) | it.Damper(1.5e3)).mechanism()
    (tyre,) = car.tyres
    with pytest.raises(MechanismError, match="levers of a strut or tyre do not follow"):
        it.static_tyre_loads(replace(car, tyres=(replace(tyre, port={"unsprung": 1.07}),)))
