"""Where statistical linearisation says ok it is within 3 % of simulation; where it is not, it says so."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from wang_su import paper_half_car, paper_quarter_car
from white_noise import ROAD, drawn

import inerter as it
from inerter import Damper, Friction, Inerter, Spring

INDICES = (it.RideComfort(ROAD), it.TyreLoad(ROAD), it.LoadCarrying(amplitude=1000.0))
METHOD = it.StatisticalLinearisation()


def half_car(number):
    """Frictions in both struts, one beside the damper and one beside an inerter in series with it."""
    rng = np.random.default_rng([1968, number])
    front, rear = np.exp(rng.uniform(np.log(3.0), np.log(2000.0), 2))
    k = Spring(float(rng.uniform(15e3, 120e3)))
    damper, inner = (Damper(float(np.exp(rng.uniform(np.log(500.0), np.log(2e4))))) for _ in range(2))
    b = Inerter(float(np.exp(rng.uniform(np.log(20.0), np.log(800.0)))))
    return paper_half_car(k | damper | Friction(float(front)), k | damper | inner - (b | Friction(float(rear))))


def judged(car, indices=INDICES):
    """For each index whether the method trusts itself, after checking that it may."""
    trusted = []
    for index in indices:
        found = it.evaluate(car, index, METHOD)
        trusted.append(found.status.ok)
        simulated = it.evaluate(car, index, it.ExpectedValue(realisations=16))
        if not found.status.ok or not simulated.status.ok:
            continue
        reach = 0.03 * simulated.value + 4.0 * simulated.standard_error
        assert abs(found.value - simulated.value) < reach, (index.symbol, found, simulated.value)
    return trusted


CARS = {"screw": lambda: drawn(4).vehicle, "locking": lambda: drawn(12).vehicle, "half car": lambda: half_car(0)}


@pytest.mark.parametrize("name", sampled(CARS, ["screw"]))
def test_ok_means_within_three_per_cent(name):
    judged(CARS[name]())


ALIKE = {
    "friction alone": Friction(3000.0),
    "alike for J1": Damper(800.0) | Inerter(266.0) - Friction(400.0),
    "alike for J3": Damper(800.0) | Inerter(209.77) - Friction(400.0),
}


@pytest.mark.parametrize("name", sampled(ALIKE, ["alike for J1"], ["alike for J3"]))
def test_alike_without_friction_and_with_a_rigid_link_is_not_alike_between(name):
    judged(paper_quarter_car(Spring(120e3) | ALIKE[name]))


MOSTLY_STUCK = {  # the front one, or the rear one; the other slips
    "front": (7.27e-7, 34.8, (524.0, 580.0, 38.7, 26.1, 174e3, 225e3, 1.42, 1.38), Damper(5e3) | Friction(671.0)),
    "rear": (9.82e-7, 16.4, (816.0, 1381.0, 27.5, 39.8, 111e3, 128e3, 1.39, 1.77), Damper(634.0) | Friction(13.5)),
}
BEHIND_SHAFTS = {
    "front": Spring(21.3e3) | Damper(510.0) | ((Spring(793e3) | Damper(2022.0)) - (Inerter(223.0) | Friction(34.3))),
    "rear": Spring(28.6e3) | Damper(3815.0) | ((Spring(916e3) | Damper(2666.0)) - (Inerter(56.7) | Friction(399.0))),
}


@pytest.mark.parametrize("where", sampled(MOSTLY_STUCK, kept=0))
def test_a_sum_over_struts_is_no_surer_than_the_strut_that_sticks(where):
    """What the travel of one strut gains with a softer damper, the other loses: in the sum, but not in its error."""
    roughness, speed, quantities, network = MOSTLY_STUCK[where]
    car = it.HalfCar(*quantities, Spring(25e3) | network, BEHIND_SHAFTS[where])
    travel = it.SuspensionTravel(it.Road(roughness=roughness, speed=speed))
    simulated = it.evaluate(car, travel, it.ExpectedValue(realisations=16))
    assert abs(it.evaluate(car, travel, METHOD).value / simulated.value - 1.0) > 0.03
    assert judged(car, [travel]) == [False]


def behind_a_spring(number):
    """A quarter car with friction in series with a spring (a Jenkins element), and indices on its road."""
    rng = np.random.default_rng([1966, number])
    kappa, speed, sprung, unsprung, tyre, k, c, ks, f = np.exp(
        rng.uniform(
            np.log([3e-7, 10.0, 150.0, 20.0, 1e5, 15e3, 300.0, 5e4, 20.0]),
            np.log([3e-6, 35.0, 500.0, 60.0, 3e5, 1e5, 4e3, 1e6, 1500.0]),
        )
    ).tolist()
    car = it.QuarterCar(sprung, unsprung, tyre, Spring(k) | Damper(c) | Spring(ks) - Friction(f))
    road = it.Road(roughness=kappa, speed=speed)
    return car, [it.SuspensionTravel(road), it.RideComfort(road), it.TyreLoad(road)]


@pytest.mark.parametrize("first", sampled(range(0, 60, 6), kept=1))
def test_ok_means_within_three_per_cent_behind_a_spring(first):
    trusted = [judged(*behind_a_spring(n)) for n in range(first, first + 6)]
    assert np.mean(trusted) > 0.15


@pytest.mark.parametrize(
    ("road", "car", "inner", "index"),
    [
        ((1.246e-6, 15.56), (322.7, 57.63, 182.9e3), (27.23e3, 3959.0, 954e3, 250.3), it.SuspensionTravel),
        ((4.683e-7, 15.0), (167.7, 55.89, 149.4e3), (20.94e3, 300.0, 59.92e3, 50.53), it.RideComfort),
    ],
)
def test_friction_behind_a_spring_is_not_known_to_three_per_cent(road, car, inner, index):
    """It is elastic for as long as the friction sticks: 3.6 and 3.3 % less than simulated, twice what others may be."""
    k, c, ks, f = inner
    index = index(it.Road(*road))
    assert judged(it.QuarterCar(*car, Spring(k) | Damper(c) | Spring(ks) - Friction(f)), [index]) == [False]


def wheel_acceleration(road):
    return it.RandomResponse({"unsprung_acceleration": 1.0}, road)


FORCED = {  # road; masses and tyre; spring and damper, and beside them inertance, spring and friction
    "spring 1": (
        (1.507e-6, 12.22),
        (194.7, 24.85, 216.1e3),
        Spring(30630.0) | Damper(608.1, "c"),
        None,
        70280.0,
        88.51,
    ),
    "spring 2": ((1.058e-6, 12.71), (442.8, 20.75, 131.3e3), Spring(25330.0) | Damper(3715.0, "c"), None, 59e3, 17.6),
    "inerter 1": (
        (7.957e-7, 13.14),
        (340.0, 36.0, 131.9e3),
        Spring(14410.0) | Damper(1945.0, "c"),
        18.44,
        520.3e3,
        82.49,
    ),
    "inerter 2": (
        (2.204e-6, 20.6),
        (259.5, 38.59, 147.5e3),
        Spring(13710.0) | Damper(3756.0, "c"),
        7.02,
        411.7e3,
        32.11,
    ),
}


@pytest.mark.parametrize("name", sampled(FORCED, ["spring 1"]))
@pytest.mark.parametrize("index", [wheel_acceleration, it.RideComfort, lambda road: it.ElementVelocity(road, "c")])
def test_an_output_is_as_far_off_as_what_friction_does_to_it(name, index):
    """Most of the acceleration of a wheel is there without friction: little of its range, but much of its error."""
    road, car, plain, b, ks, f = FORCED[name]
    inner = Friction(f) if b is None else Inerter(b) | Friction(f)
    quarter = it.QuarterCar(*car, plain | Spring(ks) - inner)
    found, simulated = (
        it.evaluate(quarter, index(it.Road(*road)), m) for m in (METHOD, it.ExpectedValue(realisations=16))
    )
    error = abs(found.value / simulated.value - 1.0)
    assert error <= found.error_bound + 4.0 * simulated.standard_error / simulated.value
    assert found.status.ok == (found.error_bound <= 0.03)


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("car", "strut", "index", "road"),
    [
        (
            (351.3, 39.22, 158e3),
            Spring(13760.0) | Damper(3915.0) | (Spring(1.396e6) - (Inerter(30.12) | Friction(175.4))),
            it.SuspensionTravel,
            (1.52e-6, 11.17),
        ),
        (
            (187.8, 31.23, 122.9e3),
            Spring(13620.0) | Damper(3991.0) | (Spring(1.98e6) - (Inerter(7.39) | Friction(23.27))),
            wheel_acceleration,
            (6.917e-7, 12.93),
        ),
    ],
    ids=["travel", "acceleration of a wheel"],
)
def test_beside_an_inerter_on_springs_errors_are_within_their_bounds(car, strut, index, road):
    """A travel, and the acceleration of a wheel, of which a first bound was half the error."""
    quarter, asked = it.QuarterCar(*car, strut), index(it.Road(*road))
    found, simulated = (it.evaluate(quarter, asked, m) for m in (METHOD, it.ExpectedValue(realisations=64)))
    error = abs(found.value / simulated.value - 1.0)
    assert error > 0.01
    assert error <= found.error_bound


@pytest.mark.parametrize(
    ("car", "inner", "force", "output"),
    [
        ((223.0, 21.16, 247.1e3), Damper(833.6) | Friction(10.09), (32350.0, 123.7e3, 242.3), "tyre_load"),
        ((346.6, 37.7, 166.4e3), Inerter(42.32) | Friction(7.282), (29040.0, 858.7e3, 586.1), "ks_force"),
    ],
    ids=["two frictions", "beside an inerter"],
)
def test_a_peak_counts_the_harmonics_that_friction_forces_add(car, inner, force, output):
    """The load of a tyre has the whole force of the friction above it, with all harmonics of a square wave."""
    k, ks, other = force
    series = inner - Spring(ks, "ks")
    strut = Spring(k) | series | (Friction(other) if output == "tyre_load" else Damper(other))
    peak = it.PeakResponse("sprung_force", output, amplitude=416.756 if output == "tyre_load" else 43.546)
    found, simulated = (it.evaluate(it.QuarterCar(*car, strut), peak, m) for m in (METHOD, it.ExpectedValue()))
    assert abs(found.value / simulated.value - 1.0) > 0.03
    assert not found.status.ok


def test_many_at_once_have_no_value_that_one_would_not_trust():
    c = Damper(it.free(1e-8, 1.0, name="c"))
    car = paper_quarter_car(Spring(120e3) | c | Inerter(1e-6) - Friction(30.0))
    assert it.evaluate(car.with_values({"c": 1e-6}), INDICES[2], METHOD).status.kind == "marginal"
    assert np.isnan(it.evaluate_many(car, INDICES[2], {"c": [1e-6]}, METHOD)).all()


@pytest.mark.parametrize("index", INDICES, ids=["J1", "J3", "J5"])
def test_between_slip_and_stick_it_is_not_ok_and_at_both_ends_it_is(index):
    car = drawn(4)
    forces = np.geomspace(1.0, 1e5, 26)
    known = [it.evaluate(replace(car, f=float(f)).vehicle, index, METHOD) for f in forces]
    ok = [found.status.ok for found in known]
    assert ok[0]
    assert ok[-1]
    assert not all(ok)
    assert np.count_nonzero(np.diff(ok)) == 2
    told = next(found for found in known if not found.status.ok)
    assert told.status.kind == "inaccurate"
    assert "the error may exceed 3 %" in told.status.message
    (bound,) = re.findall(r"3 %, but not (\S+) %", told.status.message)
    assert 3.0 < float(bound) < 100.0


@pytest.mark.parametrize("first", sampled(range(0, 100, 10), seldom=range(0, 100, 10)))
def test_ok_means_within_three_per_cent_for_many(first):
    trusted = [judged(car) for n in range(first, first + 10) for car in (drawn(n).vehicle, half_car(n))]
    assert np.mean(trusted) > 0.25  # half of these cars have friction for their main damper


@pytest.mark.parametrize("force", [20.0, 60.0])
def test_the_motion_across_a_friction_that_sticks_is_not_known(force):
    """It is all slip: 6e-5 m by simulation, against 9e-7 m of the damper that holds. The force through it is known."""
    mass = it.Mechanism(
        coordinates=(it.Coordinate("mass", 50.0),),
        struts=(it.Strut("strut", Spring(2e4) | Damper(300.0) | Friction(force), {"mass": 1.0}, {}),),
        forces=(it.Force("push", {"mass": 1.0}),),
    )
    shaped = it.FilteredExcitation(it.WhiteForce("push", 4.0), it.Filter([30.0], [1.0, 30.0]))
    status = {
        name: it.evaluate(mass, it.RandomResponse({name: 1.0}, shaped), METHOD).status
        for name in ("mass_displacement", "mass_velocity", "strut_force")
    }
    assert [str(status[name].kind) for name in status] == ["inaccurate", "inaccurate", "ok"]
    many = [it.RandomResponse({name: 1.0}, shaped) for name in status]
    assert np.isnan(it.evaluate_many(mass, many, {}, METHOD)).tolist() == [[True, True, False]]


def linked(number):
    """A light link with friction beside the strut of a random car: its friction hardly matters but to its own force."""
    rng = np.random.default_rng([1969, number])

    def between(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    strut = Spring(between(1e4, 4e4)) | Damper(between(800.0, 4e3))
    car = it.QuarterCar(between(150.0, 500.0), between(20.0, 60.0), between(1e5, 3e5), strut).mechanism()
    f, k = Friction(between(2.0, 40.0), "f"), Spring(10.0)
    light, stiff = Damper(1.0), Spring(between(1e5, 1e7))
    links = (Spring(between(5.0, 5e3)) | f, f - Damper(between(1e3, 5e3)) | k, light | f, (f | light) - stiff | k)
    link = it.Strut("link", links[number % len(links)], {"sprung": 1.0}, {"unsprung": 1.0})
    return replace(car, struts=(*car.struts, link))


@pytest.mark.parametrize("number", sampled(range(12), often=(0, 1), kept=0))
def test_the_force_of_a_link_is_not_that_of_its_equivalent_damper(number):
    car, road = linked(number), it.Road(roughness=1e-6, speed=20.0)
    index = it.RandomResponse({"link_force": 1.0}, road)
    found = it.evaluate(car, index, METHOD)
    simulated = it.evaluate(car, index, it.ExpectedValue(realisations=8))
    off, error = simulated.value / found.value - 1.0, simulated.standard_error / found.value
    assert abs(off) <= found.error_bound + 4.0 * error
    assert found.status.ok == (found.error_bound <= METHOD.promise)
    assert it.evaluate(car, it.TyreLoad(road), METHOD).status.ok
