"""Quarter-car J1 and J3 against the textbook's integrals in rational arithmetic, and the two conventions."""

import math
from fractions import Fraction

import numpy as np
import pytest
from exact import h2_square, quarter_car_norms, root
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import logarithmic, random_network, random_quarter_car
from wang_su import J1, J3, J5, ROAD, paper_half_car, paper_quarter_car

from inerter import (
    GROUND,
    Coordinate,
    Damper,
    Force,
    HalfCar,
    Inerter,
    Mechanism,
    Norm,
    PeakResponse,
    QuarterCar,
    RideComfort,
    Road,
    Spring,
    Strut,
    TyreLoad,
    evaluate,
    frequency_response,
    state_space,
)


def both(car):
    return [evaluate(car, index, Norm()).value for index in (J1, J3)]


@given(logarithmic(1e3, 1e6), logarithmic(1e2, 1e5), logarithmic(50, 2e3), logarithmic(5, 200), logarithmic(5e4, 1e6))
def test_conventional_strut_by_hand(k, c, m, mu, kt):
    """The fourth-order integral of Newton, Gould and Kaiser, worked out for a spring and a damper.

    J1^2 = F^2 kt (c^2 kt + k^2 (m + mu)) / (2 c m^2).
    """
    factor = 2.0 * math.pi * math.sqrt(ROAD.roughness * ROAD.speed)
    J1_by_hand = factor * math.sqrt(kt * (c**2 * kt + k**2 * (m + mu)) / (2.0 * c * kt * m**2))
    car = QuarterCar(m, mu, kt, Spring(k) | Damper(c))
    assert evaluate(car, J1, Norm()).value == pytest.approx(J1_by_hand, rel=1e-9)


def test_the_rational_integral_is_that_of_one_degree_of_freedom():
    assert root(h2_square([Fraction(1)], [Fraction(4), Fraction(1), Fraction(1)])) == math.sqrt(1 / 8)
    assert h2_square([*map(Fraction, (2, 1))], [*map(Fraction, (1, 3, 3, 1))]) == Fraction(
        13, 16
    )  # by partial fractions


LAYOUTS = {
    "S1": lambda k, c, b: Spring(k) | Damper(c),
    "S2": lambda k, c, b: Spring(k) | Damper(c) | Inerter(b),
    "S3": lambda k, c, b: Spring(k) | Damper(c) - Inerter(b),
    "elastic S2": lambda k, c, b: Spring(k) | Damper(c) | (Spring(1e6) | Damper(3200.0)) - Inerter(b),
    "elastic S3": lambda k, c, b: Spring(k) | Damper(c) - (Spring(1e6) | Damper(3200.0)) - Inerter(b),
}


@pytest.mark.parametrize("name", LAYOUTS)
@settings(max_examples=40)
@given(k=logarithmic(1e4, 3e5), c=logarithmic(1e2, 3e4), b=logarithmic(10.0, 1e4))
def test_layouts_in_rational_arithmetic(name, k, c, b):
    car = paper_quarter_car(LAYOUTS[name](k, c, b))
    expected = np.array(quarter_car_norms(car)) * ROAD.velocity_intensity
    np.testing.assert_allclose(both(car), expected, rtol=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_random_struts_in_rational_arithmetic(seed):
    rng = np.random.default_rng(seed)
    car = random_quarter_car(rng, Spring(3e4) | Damper(500.0) | random_network(rng, depth=2, most=5))
    expected = np.array(quarter_car_norms(car)) * ROAD.velocity_intensity
    np.testing.assert_allclose(both(car), expected, rtol=1e-9)


def stiff_designs(count):
    """The far corner of the bounds of an optimisation: a hard damper on next to no inertance."""
    rng = np.random.default_rng(3)
    return zip(10 ** rng.uniform(4.5, 6.0, count), 10 ** rng.uniform(-2.0, 0.0, count), strict=True)


def test_a_stiff_design_is_right_or_says_that_it_is_not():
    silent = 0
    for c, b in stiff_designs(150):
        car = paper_quarter_car(LAYOUTS["S3"](120e3, c, b))
        for index, norm in zip((J1, J3), quarter_car_norms(car), strict=True):
            estimate = evaluate(car, index, Norm())
            wrong = abs(estimate.value / (norm * ROAD.velocity_intensity) - 1.0) > 1e-6
            silent += wrong and estimate.status.ok
    assert silent == 0


def test_both_conventions_are_one_where_the_road_arrives_once():
    car = paper_quarter_car(LAYOUTS["S3"](120e3, 3e3, 200.0))
    for index in (J1, J3, J5):
        assert evaluate(car, index, Norm("paper2008")).value == evaluate(car, index, Norm()).value


def test_conventions_of_the_half_car_differ_by_delay_and_filter_only():
    """Pade(5) moves J1 by up to 0.2 %; the filter lowers J3 by about 4 %; J5 has neither."""
    car = paper_half_car(Spring(120e3) | Damper(4e3), Spring(100e3) | Damper(4e3))
    ratio = [
        evaluate(car, index, Norm("paper2008")).value / evaluate(car, index, Norm()).value for index in (J1, J3, J5)
    ]
    assert 0.0 < abs(ratio[0] - 1.0) < 2e-3
    assert 0.90 < ratio[1] < 0.99
    assert ratio[2] == 1.0


def test_an_explicit_filter_is_the_convention_s_filter():
    car = paper_half_car(Spring(120e3) | Damper(4e3), Spring(100e3) | Damper(4e3))
    explicit = TyreLoad(ROAD, high_pass=2.0 * math.pi)
    assert evaluate(car, explicit, Norm("paper2008")).value == evaluate(car, J3, Norm("paper2008")).value
    assert evaluate(car, explicit, Norm()).value < evaluate(car, J3, Norm()).value


@pytest.mark.campaign
@given(logarithmic(1e-9, 1e-3), logarithmic(1.0, 100.0))
def test_indices_grow_with_the_root_of_roughness_and_speed(roughness, speed):
    car, road = paper_quarter_car(LAYOUTS["S2"](120e3, 3e3, 200.0)), Road(roughness, speed)
    factor = math.sqrt(roughness * speed / (ROAD.roughness * ROAD.speed))
    for index in (RideComfort, TyreLoad):
        expected = factor * evaluate(car, index(ROAD), Norm()).value
        assert evaluate(car, index(road), Norm()).value == pytest.approx(expected, rel=1e-12)


@given(st.floats(0.1, 10.0))
def test_a_car_twice_as_heavy_and_twice_as_stiff_rides_the_same(size):
    k, c, b = 60e3, 3e3, 150.0
    one = paper_quarter_car(LAYOUTS["S3"](k, c, b))
    other = QuarterCar(181.75 * size, 25.0 * size, 120e3 * size, LAYOUTS["S3"](k * size, c * size, b * size))
    factors = (1.0, size, 1.0 / size)
    for index, factor in zip((J1, J3, J5), factors, strict=True):
        expected = factor * evaluate(one, index, Norm()).value
        assert evaluate(other, index, Norm()).value == pytest.approx(expected, rel=1e-9)


def test_a_symmetric_half_car_is_two_quarter_cars():
    """With I = m l^2 each end of the body moves by itself: a quarter car of half the mass."""
    strut = LAYOUTS["S3"](60e3, 3e3, 150.0)
    length, mass = 1.1, 360.0
    half = HalfCar(mass, mass * length**2, 25.0, 25.0, 120e3, 120e3, length, length, strut, strut)
    quarter = QuarterCar(mass / 2.0, 25.0, 120e3, strut)
    assert evaluate(half, J3, Norm()).value == pytest.approx(2.0 * evaluate(quarter, J3, Norm()).value, rel=1e-10)
    omega = np.geomspace(1.0, 100.0, 9)
    front = frequency_response(state_space(half, "road_front", ["sprung_acceleration", "pitch_acceleration"]), omega)[
        :, :, 0
    ]
    alone = frequency_response(state_space(quarter, "road", "sprung_acceleration"), omega)[:, 0, 0]
    np.testing.assert_allclose(front[:, 0] + length * front[:, 1], alone, rtol=1e-10)
    np.testing.assert_allclose(front[:, 0], length * front[:, 1], rtol=1e-10)


def test_load_carrying_is_the_largest_compliance():
    car = paper_quarter_car(LAYOUTS["S3"](60e3, 3e3, 150.0))
    estimate = evaluate(car, J5, Norm())
    system = state_space(car, "sprung_force", "sprung_displacement")
    grid = np.abs(frequency_response(system, np.linspace(0.0, 300.0, 300001)))[:, 0, 0]
    assert estimate.value == pytest.approx(grid.max(), rel=1e-7)
    assert estimate.value >= grid.max() * (1.0 - 1e-12)
    assert estimate.peaks[0].gain == estimate.value


@pytest.mark.parametrize("strut", [Spring(1e5), Inerter(50.0), Damper(1e3), Spring(1e5) | Inerter(50.0)])
def test_an_undamped_or_unsupported_car_is_said_to_be_so(strut):
    car = paper_quarter_car(strut)
    assert evaluate(car, J5, Norm()).value == math.inf
    assert not evaluate(car, J5, Norm()).status.ok
    comfort = evaluate(car, J1, Norm())
    assert comfort.status.ok == (comfort.value < math.inf) == isinstance(strut, Damper)


@pytest.mark.parametrize("inertance", [0.0, 40.0, 366.52])
def test_undamped_modes_are_at_the_roots_of_the_characteristic_equation(inertance):
    """det(K - omega^2 M) = 0 of two masses with b across the strut, by the formula of the quadratic equation."""
    m, mu, k, kt, b = 250.0, 35.0, 30e3, 180e3, inertance
    strut = Spring(k) | Inerter(b) if b else Spring(k)
    square, linear, constant = m * mu + b * (m + mu), k * (m + mu) + kt * (m + b), k * kt
    root = math.sqrt(linear**2 - 4.0 * square * constant)
    expected = [math.sqrt((linear + sign * root) / (2.0 * square)) for sign in (-1.0, 1.0)]
    car = QuarterCar(m, mu, kt, strut)
    pushed = evaluate(car, J5, Norm())
    assert [peak.omega for peak in pushed.peaks] == pytest.approx(expected, rel=1e-14)
    for found in (pushed, evaluate(car, J1, Norm())):
        assert found.value == math.inf
        said = complex(found.status.message.rpartition("a pole at ")[2].removesuffix(" rad/s").replace(" ", ""))
        assert said == pytest.approx(1j * expected[0], rel=1e-3)


def test_two_equal_undamped_modes_are_one_pole():
    """Both halves of a car that is coupled by nothing: k / m = 700 twice."""
    masses = (Coordinate("one", 11.0), Coordinate("other", 11.0))
    struts = tuple(Strut(f"under_{c.name}", Spring(7700.0), {c.name: 1.0}, GROUND) for c in masses)
    pair = Mechanism(coordinates=masses, struts=struts, forces=(Force("push", {"one": 1.0, "other": 0.5}),))
    found = evaluate(pair, PeakResponse("push", "other_displacement"), Norm())
    assert [peak.omega for peak in found.peaks] == pytest.approx([math.sqrt(700.0)], rel=1e-14)


def test_a_damper_in_the_tyre_lets_white_noise_through():
    mechanism = paper_quarter_car(LAYOUTS["S1"](60e3, 3e3, 1.0)).mechanism()
    tyre = type(mechanism.tyres[0])("tyre", Spring(120e3) | Damper(50.0), {"unsprung": 1.0}, "road")
    damped = type(mechanism)(
        mechanism.coordinates, mechanism.struts, (tyre,), mechanism.roads, mechanism.forces, mechanism.measures
    )
    assert evaluate(damped, J3, Norm()).status.kind == "direct-term"
    assert evaluate(damped, J3, Norm()).value == math.inf
    assert evaluate(damped, J1, Norm()).status.ok
