"""Levers that are one lever but for rounding: every analysis sees one mechanism, whichever way they were computed."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal
from quadrature import h2_by_quadrature
from strategies import random_network

import inerter as it
from inerter import Coordinate, Damper, Force, Friction, Mechanism, RoadInput, Spring, Strut, Tyre, state_space
from inerter.systems.piecewise import piecewise

OUTPUTS = ("body_acceleration", "roll_acceleration", "pitch_acceleration", "bar_travel", "diagonal_travel", "bar_force")


def rounded(rng, lever):
    """The lever as another way of computing it would round it."""
    return float(lever * (1.0 + rng.integers(-4, 5) * 2.0**-52))


def differing(rng, row):
    return {name: lever if lever in (-1.0, 1.0) else rounded(rng, lever) for name, lever in row.items()}


def summed(*terms):
    """The travel that is so many times each of these travels, added up as it comes."""
    row = {}
    for share, travel in terms:
        for name, lever in travel.items():
            row[name] = row.get(name, 0.0) + share * lever
    return {name: lever for name, lever in row.items() if lever != 0.0}


def damped(rng, beside):
    """A spring and a damper, with a random network beside them or none."""
    both = Spring(float(rng.uniform(1e4, 4e4))) | Damper(float(rng.uniform(500.0, 3e3)))
    return both | random_network(rng, 2, 3) if beside else both


def full_car(rng, one_road=False):
    """A body on four wheels, and struts whose travels are sums of those at the wheels; plain ones on one road."""
    half, front, rear = (float(x) for x in rng.uniform(0.4, 1.7, 3))
    places = [(front, half), (front, -half), (-rear, half), (-rear, -half)]
    corners = [{"body": 1.0, "pitch": x, "roll": y, f"wheel{i}": -1.0} for i, (x, y) in enumerate(places)]
    share = float(rng.uniform(0.2, 0.8))
    others = {
        "bar": summed((1.0, corners[0]), (-1.0, corners[1])),
        "bar_rear": summed((1.0, corners[2]), (-1.0, corners[3])),
        "diagonal": summed((share, corners[0]), (1.0 - share, corners[3])),
        "twin": dict(corners[2]),
        "mean": summed((0.5, corners[0]), (0.5, corners[1])),
    }
    struts = [Strut(f"corner{i}", damped(rng, not one_road), differing(rng, row), {}) for i, row in enumerate(corners)]
    struts += [Strut(name, damped(rng, not one_road), differing(rng, row), {}) for name, row in others.items()]
    roads = ["road"] if one_road else [f"road{i}" for i in range(4)]
    return Mechanism(
        coordinates=(
            Coordinate("body", 900.0),
            Coordinate("pitch", 1400.0, angle=True),
            Coordinate("roll", 450.0, angle=True),
            *(Coordinate(f"wheel{i}", float(rng.uniform(25.0, 50.0))) for i in range(4)),
        ),
        struts=tuple(struts),
        tyres=tuple(Tyre(f"tyre{i}", Spring(2e5), {f"wheel{i}": 1.0}, roads[i % len(roads)]) for i in range(4)),
        roads=tuple(map(RoadInput, roads)),
        forces=(Force("load", {"body": 1.0}),),
    )


@pytest.mark.parametrize("chunk", sampled(range(20), [0], kept=2))
def test_dependent_struts_agree_with_the_nodal_solve_however_their_levers_are_rounded(chunk):
    for seed in range(5 * chunk, 5 * chunk + 5):
        rng = np.random.default_rng([41, seed])
        mechanism = full_car(rng)
        omega = 2 * np.pi * 10 ** rng.uniform(-1, 2, 10)
        system = state_space(mechanism, outputs=OUTPUTS)
        G, nodal = it.frequency_response(system, omega), Nodal(mechanism, omega)
        for i, output in enumerate(OUTPUTS):
            for kind in (slice(0, 4), slice(4, 5)):
                expected = np.array([nodal.response(output, name) for name in system.inputs[kind]]).T
                error = np.abs(G[:, i, kind] - expected).max(axis=1) / np.abs(expected).max(axis=1)
                assert error.max() < 1e-9, (seed, output)


@pytest.mark.parametrize("seed", sampled(range(12), often=[0], kept=0))
def test_norms_of_dependent_struts_are_those_of_quadrature(seed):
    mechanism = full_car(np.random.default_rng([42, seed]), one_road=True)
    for output in ("body_acceleration", "roll_acceleration", "diagonal_travel"):

        def response(omega, output=output):
            return np.array(Nodal(mechanism, omega).response(output, "road"), complex)[:, None]

        norm = it.h2_norm(state_space(mechanism, "road", output))
        assert norm == pytest.approx(h2_by_quadrature(response, [0.0], 1e4), rel=1e-8)


@pytest.mark.campaign
def test_a_simulated_impulse_has_the_energy_of_the_norm():
    """A step of the road is an impulse of its velocity: what an output is then, squared and added up, is its norm's."""
    mechanism = full_car(np.random.default_rng(43), one_road=True)
    run = it.simulate(mechanism, road=it.step(1.0, 0.0005), duration=12.0, step=5e-4, energy=False)
    for output in ("body_acceleration", "diagonal_travel"):
        squared = float(np.trapezoid(run[output] ** 2, run.time))
        assert math.sqrt(squared) == pytest.approx(it.h2_norm(state_space(mechanism, "road", output)), rel=1e-3)


def beam(rng, first, second):
    """A beam on two struts at one place: nothing but `third` resists turning about it."""
    third = [None, Damper(300.0), Spring(2e3) - Damper(300.0)][int(rng.integers(3))]
    struts = [
        Strut("one", Spring(3e4) | Damper(2e3), {"body": 1.0, "pitch": first}, {"wheel": 1.0}),
        Strut("two", Spring(1e4) | Damper(1e3), {"body": 1.0, "pitch": second}, {"wheel": 1.0}),
    ]
    return Mechanism(
        coordinates=(Coordinate("body", 1e3), Coordinate("pitch", 400.0, angle=True), Coordinate("wheel", 40.0)),
        struts=(*struts, *([] if third is None else [Strut("third", third, {"body": 1.0, "pitch": -1.0}, {})])),
        tyres=(Tyre("tyre", Spring(2e5), {"wheel": 1.0}, "road"),),
        roads=(RoadInput("road"),),
        forces=(Force("load", {"body": 1.0}), Force("turn", {"pitch": 1.0})),
    )


@pytest.mark.parametrize("seed", sampled(range(40), [0, 1, 2, 3], kept=5))
def test_infinite_is_infinite_however_levers_are_rounded(seed):
    rng = np.random.default_rng([44, seed])
    lever = float(rng.uniform(0.2, 1.5))
    other = lever * (1.0 + int(rng.integers(1, 5)) * 2.0**-52)
    state = rng.bit_generator.state
    alike = beam(rng, lever, lever)
    rng.bit_generator.state = state
    apart = beam(rng, lever, other)
    found = []
    for mechanism in (alike, apart):
        systems = [
            state_space(mechanism, name, output)
            for name in ("road", "load", "turn")
            for output in ("body_acceleration", "pitch_velocity", "pitch_displacement", "two_travel")
        ]
        found.append([value for s in systems for value in (s.order, it.h2_norm(s), it.hinf_norm(s).value)])
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9)
    assert math.inf in found[0]


def test_frictions_at_one_place_are_one_however_their_levers_are_rounded():
    def held(first, second):
        struts = [
            Strut(f"strut{i}", Spring(2e4) | Friction(40.0), {"body": 1.0, "pitch": lever}, {})
            for i, lever in enumerate((first, second, -1.0))
        ]
        return Mechanism((Coordinate("body", 500.0), Coordinate("pitch", 300.0, angle=True)), tuple(struts))

    assert len(piecewise(held(0.3, 0.1 + 0.2)).nonlinear) == len(piecewise(held(0.3, 0.3)).nonlinear) == 2
    assert len(piecewise(held(0.3, 0.300001)).nonlinear) == 3


def apart(rng, mechanism, distance):
    """The mechanism with levers that differ by about so much of their size."""

    def moved(row):
        return {
            name: lever
            if lever in (-1.0, 1.0)
            else lever * (1.0 + float(rng.choice([-1, 1]) * distance * rng.random()))
            for name, lever in row.items()
        }

    return replace(mechanism, struts=tuple(replace(one, upper=moved(one.upper)) for one in mechanism.struts))


NEAR = [10.0**-exponent for exponent in (8.9, 8.7, 8.5, 8.0, 7.5, 7.0, 6.0, 5.0, 4.0)]


@pytest.mark.parametrize(("distance", "seed"), sampled(product(NEAR, range(6)), [(NEAR[2], 0), (NEAR[5], 4)], kept=17))
def test_matrices_of_struts_that_nearly_depend_on_each_other_are_right_or_refused(distance, seed):
    rng = np.random.default_rng([46, seed, round(-10 * math.log10(distance))])
    mechanism = apart(rng, full_car(rng, one_road=True), distance)
    omega = 2 * np.pi * 10 ** rng.uniform(-1, 2, 8)
    outputs = ("body_acceleration", "roll_acceleration", "bar_force", "diagonal_force")
    try:
        system = state_space(mechanism, ["road", "load"], outputs)
    except it.InerterError as error:
        assert "depends on those of others up to a relative difference of" in str(error)  # noqa: PT017 - either is right
        assert distance < 1e-6
        return
    G, nodal = it.frequency_response(system, omega), Nodal(mechanism, omega)
    for i, output in enumerate(outputs):
        for j, name in enumerate(("road", "load")):
            expected = np.array(nodal.response(output, name)).astype(complex)
            assert np.abs(G[:, i, j] - expected).max() <= 1e-6 * np.abs(expected).max(), (output, name)


@pytest.mark.parametrize(("distance", "seed"), sampled(product(NEAR, range(6)), [(NEAR[5], 1), (NEAR[8], 2)], kept=17))
def test_simulations_change_as_little_as_levers_do(distance, seed):
    rng = np.random.default_rng([47, seed])
    alike = full_car(rng, one_road=True)
    first, second = (
        it.simulate(one, road=it.step(0.01, 0.01), duration=0.5, step=1e-3, energy=False)
        for one in (alike, apart(rng, alike, distance))
    )
    for output in ("body_acceleration", "roll_acceleration", "diagonal_travel", "bar_travel"):
        changed = np.abs(first[output] - second[output]).max()
        assert changed <= 30.0 * distance * np.abs(first[output]).max(), output


def pushed(lever):
    """A lever on two struts, pushed at `lever`: over that, its motion is the same."""
    return it.Mechanism(
        coordinates=(it.Coordinate("arm", 2.0, angle=True), it.Coordinate("wheel", 1.0)),
        struts=(
            it.Strut("stay", it.Spring(100.0) | it.Damper(1.0), {"arm": 0.7}, it.GROUND),
            it.Strut("strut", it.Spring(50.0) | it.Damper(1.0), {"arm": 0.3}, {"wheel": 1.0}),
        ),
        forces=(it.Force("push", {"arm": lever}),),
    )


@pytest.mark.parametrize("lever", [0.3, 1e-4, 1e-6, 1e-8])
def test_a_motion_is_proportional_to_a_short_lever(lever):
    index = it.PeakResponse("push", "arm_displacement")
    own, whole = (it.evaluate(pushed(one), index, it.Norm()) for one in (lever, 1.0))
    assert own.value / lever == pytest.approx(whole.value, rel=1e-9)


@pytest.mark.parametrize("lever", [5e-9, 3e-10, -3e-10, 1e-12])
def test_a_lever_that_would_be_lost_is_refused(lever):
    with pytest.raises(it.InerterError, match=r"lever arm of 'arm' in force 'push' is .*e-.*, less than 1e-08 of its"):
        pushed(lever)


def test_a_short_axle_of_a_long_car_is_refused_and_not_lost():
    """With 0.4 m in front of 1e9 m behind, pitch acceleration was zero, and "ok"."""
    strut = it.Spring(1e6) | it.Damper(1e4)
    with pytest.raises(it.InerterError, match="Give lever arms within eight decades, or 0"):
        it.HalfCar(1.0, 7e3, 1.0, 1.0, 10.0, 10.0, 0.4, 1e9, front=strut, rear=strut).mechanism()


def test_a_lever_of_the_size_of_a_rounding_is_zero():
    at_zero, rounded = (
        it.evaluate(pushed(lever), it.PeakResponse("push", "arm_displacement"), it.Norm())
        for lever in (0.0, 0.1 + 0.2 - 0.3)
    )
    assert at_zero.value == rounded.value == 0.0


def test_a_small_car_has_the_pitch_of_a_large_one():
    """The moment on the body has no lever: with all lengths at another scale nothing changes."""
    strut, values = it.Spring(2e4) | it.Damper(1e3), []
    for size in (1.0, 2.0**-30):
        car = it.HalfCar(300.0, 200.0 * size**2, 25.0, 20.0, 1e5, 1e5, 0.8 * size, 1.2 * size, front=strut, rear=strut)
        values.append(it.evaluate(car, it.RideComfort(it.Road(1e-6, 20.0 * size)), it.Norm()).value / math.sqrt(size))
    assert values[1] == pytest.approx(values[0], rel=1e-9)
