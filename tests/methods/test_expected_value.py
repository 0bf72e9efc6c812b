"""Mean values over random roads against single simulations, quadrature and the norm; and what the method owns up to."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
import scipy.stats
from campaigns import sampled
from uneven import OneSidedStop
from wang_su import J1, J3, ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import (
    Coordinate,
    Damper,
    ExpectedValue,
    Friction,
    Gap,
    Inerter,
    Mechanism,
    Norm,
    QuarterCar,
    RideComfort,
    Road,
    Spring,
    Strut,
    TyreLoad,
)
from inerter.errors import DesignError, PerformanceIndexError
from inerter.methods import out_of_band
from inerter.methods.linear import CONVENTIONS
from inerter.methods.objective import Differentiable
from inerter.methods.out_of_band import on_roads, out_of_band_contribution
from inerter.methods.realisations import realisation_seeds
from inerter.systems.piecewise import piecewise

LATE = 2.04 / 25.0
k, shaft = Spring(120e3), Spring(1e6) | Damper(3200.0)
TWO = ExpectedValue(realisations=2, seed=5)
HELD = ExpectedValue(realisations=2, seed=5, conventions="paper2008")


def quarter_car(friction):
    return paper_quarter_car(k | Damper(7544.2) - (Inerter(366.52) | Friction(friction, "f")))


def half_car(friction):
    return paper_half_car(
        k | Damper(4e3) - (Inerter(300.0) | Friction(friction)), Spring(100e3) | Damper(3e3) | Friction(0.5 * friction)
    )


OUTPUTS = {
    "quarter J1": (quarter_car, J1, {"sprung_acceleration": 1.0}),
    "quarter J3": (quarter_car, J3, {"tyre_load": 1.0}),
    "half J1": (half_car, J1, {"sprung_acceleration": 1.0, "pitch_acceleration": 1.02}),
    "half J3": (half_car, J3, {"tyre_front_load": 1.0, "tyre_rear_load": 1.0}),
    "half J3 filtered": (half_car, TyreLoad(ROAD, high_pass=20.0), {"tyre_front_load": 1.0, "tyre_rear_load": 1.0}),
}


def roads(method):
    return [it.multisine(ROAD, seed=seed) for seed in realisation_seeds(method.seed, 0, method.realisations)]


def high_passed(samples, step, corner):
    """Periodic samples through s/(s + corner) as a recursion in time (Tustin), run until it repeats."""
    b, a = scipy.signal.bilinear([1.0, 0.0], [1.0, corner], 1.0 / step)
    return scipy.signal.lfilter(b, a, np.tile(samples, 3))[-samples.size :]


def outside(car, output, corner):
    """Mean square of a linear output from the road but for the lines of its multisine, by quadrature over frequency."""
    inputs = [r.name for r in car.mechanism().roads]
    system = it.state_space(car, inputs, output).with_delays("road", [0.0, LATE][: len(inputs)])

    def gain(frequencies):
        s = 2j * np.pi * frequencies
        response = it.frequency_response(system, 2.0 * np.pi * frequencies)[:, 0, :].sum(axis=1)
        return np.abs(response * (1.0 if corner is None else s / (s + corner))) ** 2

    grid = np.geomspace(1e-3, 1e5, 40_001)
    whole = np.trapezoid(gain(grid), grid)
    lines = 0.1 * gain(0.1 * np.arange(1.0, 10_001.0)).sum()
    return 2.0 * (2.0 * np.pi) ** 2 * ROAD.roughness * ROAD.speed * (whole - lines)


@pytest.mark.parametrize("case", sampled(OUTPUTS, list(OUTPUTS)[:2]))
def test_each_road_is_one_simulation_and_what_lies_outside_its_band_is_added(case):
    design, index, weights = OUTPUTS[case]
    car, corner = design(100.0), index.high_pass if index is not J1 and index is not J3 else None
    estimate = it.evaluate(car, index, TWO)
    assert estimate.status.ok
    assert estimate.unit == index.unit
    assert not estimate.notes
    for value, road in zip(estimate.samples, roads(TWO), strict=True):
        run = it.simulate(car, road=road, initial="periodic")
        expected = 0.0
        for name, weight in weights.items():
            samples = run[name][:-1] if corner is None else high_passed(run[name][:-1], 2e-4, corner)
            expected += weight * math.sqrt(np.mean(samples**2) + outside(design(0.0), name, corner))
        assert value == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize("case", [case for case in OUTPUTS if "filtered" not in case])
def test_under_the_papers_conventions_roads_are_held_and_nothing_is_added(case):
    design, index, weights = OUTPUTS[case]
    estimate = it.evaluate(design(100.0), index, HELD)
    assert estimate.status.ok
    for value, road in zip(estimate.samples, roads(HELD), strict=True):
        run = it.simulate(design(100.0), road=road.held(1e-3), initial="periodic", step=1e-3)
        expected = 0.0
        for name, weight in weights.items():
            samples = run[name][:-1]
            filtered = high_passed(samples, 1e-3, 2.0 * np.pi) if case == "half J3" else samples
            expected += weight * math.sqrt(np.mean(filtered**2))
        assert value == pytest.approx(expected, rel=1e-4 if case == "half J3" else 2e-6)


@pytest.mark.parametrize("index", [J1, J3], ids=["J1", "J3"])
@pytest.mark.parametrize("design", [quarter_car, half_car], ids=["quarter", "half"])
def test_friction_that_vanishes_leaves_the_norm(design, index):
    norm = it.evaluate(design(0.0), index, Norm()).value
    linear = it.evaluate(design(0.0), index, TWO)
    assert (linear.value, linear.standard_error, linear.realisations) == (norm, 0.0, 0)
    values = [np.array(it.evaluate(design(f), index, TWO).samples) for f in (1e-6, 1e-3, 1.0)]
    away = [np.abs(found / norm - 1.0).max() for found in values]
    assert away[0] < 2e-6
    assert away[0] < away[1] < 1e-4
    assert away[2] < 5e-3


def test_a_closed_gap_and_a_friction_of_zero_are_linear():
    car = paper_quarter_car(k | Damper(4e3) - shaft - Gap(0.0) - (Inerter(300.0) | Friction(0.0)))
    assert it.evaluate(car, J1, TWO).value == it.evaluate(car, J1, Norm()).value
    held = it.evaluate(car, J1, HELD)
    assert held.realisations == 2
    assert held.value == pytest.approx(it.evaluate(car, J1, Norm("paper2008")).value, rel=0.01)


def test_a_gap_is_simulated_and_closes_onto_the_norm():
    def car(width):
        return paper_quarter_car(k | Damper(4e3) - shaft - Gap(width) - Inerter(300.0))

    norm = it.evaluate(car(0.0), J3, Norm()).value
    wide, narrow = (it.evaluate(car(width), J3, TWO) for width in (1e-3, 1e-7))
    assert wide.status.ok
    assert not wide.notes
    for value, road in zip(wide.samples, roads(TWO), strict=True):
        run = it.simulate(car(1e-3), road=road, initial="periodic")
        expected = np.mean(run["tyre_load"][:-1] ** 2) + outside(car(0.0), "tyre_load", None)
        assert value == pytest.approx(math.sqrt(expected), rel=2e-5)
    assert narrow.value == pytest.approx(norm, rel=1e-3)
    assert abs(wide.value - norm) > 10.0 * abs(narrow.value - norm)


def with_a_load(grip):
    car = paper_quarter_car(k | Damper(4e3)).mechanism()
    parts = (car.tyres, car.roads, car.forces, car.measures)
    load = Strut("grip", grip, {"load": 1.0}, {"sprung": 1.0})
    return Mechanism((*car.coordinates, Coordinate("load", 20.0)), (*car.struts, load), *parts)


@pytest.mark.marathon
def test_a_part_that_friction_alone_holds_moves_as_it_is_held():
    """A strong grip makes a heavier body, whose norm comes out; a weak one none, and then the load drifts."""
    for force, mass, kind, share in ((5e3, 201.75, "ok", 1e-7), (1e-3, 181.75, "inaccurate", 1e-4)):
        found = it.evaluate(with_a_load(Friction(force)), J3, TWO)
        assert found.status.kind == kind
        assert not found.notes
        alone = it.evaluate(it.QuarterCar(mass, 25.0, 120e3, k | Damper(4e3)), J3, Norm())
        assert found.value == pytest.approx(alone.value, rel=share)


def test_friction_as_the_only_damping_is_simulated():
    """The linear car is undamped and its norm infinite; that of the real one is not."""
    found = it.evaluate(paper_quarter_car(k | Friction(500.0)), J1, TWO)
    assert found.status.ok
    assert not found.notes
    short = it.evaluate(paper_quarter_car(k | Friction(500.0)), J1, replace(TWO, period=10))
    for value, road in zip(short.samples, roads(TWO), strict=True):
        run = it.simulate(paper_quarter_car(k | Friction(500.0)), road=road, initial="periodic")
        assert value == pytest.approx(run["sprung_acceleration"][:-1].std(), rel=1e-3)


@pytest.mark.campaign
def test_a_strut_that_sticks_on_an_undamped_tyre_has_no_steady_state():
    for strut in (
        k | Damper(500.0) | Friction(1e5),
        k | Friction(1e5),
        k | Damper(4e3) - Inerter(300.0) | Friction(1e5),
    ):
        for index in (J1, J3):
            found = it.evaluate(paper_quarter_car(strut), index, TWO)
            assert math.isnan(found.value)
            assert found.status.kind == "marginal"
            assert "almost undamped mode at 24.1 rad/s" in found.status.message  # root of 120e3 / 206.75
    held = ROAD.velocity_intensity * 120e3 / math.sqrt(2.0 * 800.0 * 206.75)  # one mass on tyre and skyhook damper
    assert it.evaluate(skyhook(k | Damper(500.0) | Friction(1e5)), J1, TWO).value == pytest.approx(held, rel=1e-6)


def skyhook(strut):
    """A quarter car whose body a damper holds to the ground."""
    car = paper_quarter_car(strut).mechanism()
    sky = Strut("sky", Damper(800.0), {"sprung": 1.0}, it.GROUND)
    return Mechanism(car.coordinates, (*car.struts, sky), car.tyres, car.roads, car.forces, car.measures)


def test_what_cannot_be_simulated_says_so():
    stiff = it.evaluate(paper_quarter_car(k | Damper(4e3) | Damper(1e5) - (Inerter(1e-4) | Friction(10.0))), J1, TWO)
    assert math.isnan(stiff.value)
    assert stiff.status.kind == "failed"
    assert "faster than the step" in stiff.status.message
    ringing = it.evaluate(paper_quarter_car(k | Damper(0.3) | Friction(1e-4)), J1, HELD)
    assert ringing.status.kind == "inaccurate"
    assert "periods" in ringing.status.message
    free = paper_quarter_car(k | Damper(it.free(1.0, 2e5, "c")) | Damper(1e5) - (Inerter(1e-4) | Friction(10.0)))
    assert np.isnan(it.evaluate_many(free, J1, {"c": [4e3]}, TWO)).all()
    assert TWO.objective(free, J1).values(np.array([[4e3]])) == math.inf


@pytest.mark.marathon
def test_a_gap_that_springs_alone_close_is_marginal_or_rattles():
    gap = paper_quarter_car(k | shaft - Gap(1e-3) - Spring(1e4))
    assert it.evaluate(paper_quarter_car(k | Gap(1e-3) - Spring(1e4)), J1, TWO).status.kind == "marginal"
    assert it.evaluate(gap, J1, TWO).status.kind in ("ok", "inaccurate")


@pytest.mark.parametrize("index", sampled([J1, J3], seldom=[J3]), ids=["J1", "J3"])
def test_a_resonance_between_the_lines_of_the_road_asks_for_a_longer_one(index):
    """And where the longest does not resolve it either, there is no value."""
    soft = paper_quarter_car(k | Damper(300.0) | Friction(20.0))
    found = it.evaluate(soft, index, ExpectedValue(realisations=8))
    assert found.status.ok
    assert found.period == 160
    for period in (80, 320):
        longer = it.evaluate(soft, index, ExpectedValue(realisations=4, period=period, seed=1))
        assert longer.period == period
        assert abs(found.value - longer.value) < 3.0 * math.hypot(found.standard_error, longer.standard_error)
    for period in (None, 10):
        ringing = it.evaluate(paper_quarter_car(k | Damper(2.0) | Friction(1.0)), index, replace(TWO, period=period))
        assert math.isnan(ringing.value)
        assert ringing.status.kind == "marginal"
        assert f"roads of up to {period or 640} s" in ringing.status.message


@pytest.mark.parametrize("index", sampled([J1, J3], seldom=[J3]), ids=["J1", "J3"])
def test_play_that_rattles_on_has_a_value_of_its_own(index):
    wide = Spring(3e4) | Damper(500.0) | shaft - (Inerter(330.0) | Friction(50.0)) - (Spring(2e3) | Gap(0.01))
    rattling = it.evaluate(paper_quarter_car(wide), index, replace(TWO, period=10))
    assert rattling.status.kind == "inaccurate"
    assert "nothing is added" in rattling.notes[0]


def test_the_bound_holds_where_one_peak_of_a_longer_road_sets_an_inerter_coasting_for_good():
    """In a gap of four times the r.m.s. travel, which the usual roads do not close, and one of two of 160 s does."""
    road = Road(5.6e-7, 5.0)
    elastic = Spring(1.16e6) | Damper(2650.0)
    strut = Spring(17.7e3) | Damper(1420.0) | elastic - Gap(0.01294) - Inerter(33.0)
    car = QuarterCar(244.0, 25.0, 203e3, strut)
    usual, long = (it.evaluate(car, RideComfort(road), replace(TWO, period=period)) for period in (None, 160))
    assert long.value > 1.05 * usual.value
    assert long.value < (1.0 + usual.error_bound) * usual.value
    assert not usual.status.ok


def test_an_inerter_that_friction_holds_behind_an_open_gap_has_a_finite_bound():
    """The model with closed gaps has 50 times its motion; the value is the norm without the branch."""
    branch = Spring(5e5) | Damper(2e3)
    held = QuarterCar(
        300.0, 30.0, 2e5, Spring(3e4) | Damper(1500.0) | branch - Gap(0.2) - (Inerter(50.0) | Friction(10.0))
    )
    road = RideComfort(Road(1e-6, 20.0))
    found = it.evaluate(held, road, TWO)
    plain = it.evaluate(QuarterCar(300.0, 30.0, 2e5, Spring(3e4) | Damper(1500.0)), road, it.Norm())
    assert found.value == pytest.approx(plain.value, rel=1e-6)
    assert found.error_bound < 2.0


@pytest.mark.parametrize(
    ("element", "words"),
    [(OneSidedStop(2e-3, "bump"), "stop 'bump' in 'strut'"), (Gap(2e-3, "g"), "gap 'g' in 'strut'")],
)
def test_a_note_names_the_element_that_no_damper_represents(element, words):
    car = paper_quarter_car(Spring(80e3) | Damper(100.0) | element - Spring(3e5))
    estimate = it.evaluate(car, J1, replace(TWO, period=10))
    assert estimate.notes[0].startswith(f"no damper represents {words}: added above 1000 Hz ")


@pytest.mark.campaign
def test_play_that_no_linear_model_resembles_warns_in_its_status_alone():
    """The model has less motion on the lines of the road than the simulation lacks beyond them."""
    car = QuarterCar(250.0, 35.0, 150e3, Spring(10.93e3) | Damper(84.9) | Gap(1.1e-3) - Spring(514e3))
    estimate = it.evaluate(car, TyreLoad(ROAD), ExpectedValue(realisations=2))
    assert estimate.status.kind == "inaccurate"


def test_the_same_seed_gives_the_same_roads_whatever_the_threads():
    one = it.evaluate(quarter_car(100.0), J3, ExpectedValue(realisations=5, seed=3, jobs=1))
    assert one == it.evaluate(quarter_car(100.0), J3, ExpectedValue(realisations=5, seed=3, jobs=3))
    fewer = it.evaluate(quarter_car(100.0), J3, ExpectedValue(realisations=3, seed=3))
    assert one.samples[:3] == fewer.samples
    assert len(set(one.samples)) == 5
    other = it.evaluate(quarter_car(100.0), J3, ExpectedValue(realisations=5, seed=4))
    assert not set(one.samples) & set(other.samples)
    assert it.evaluate(quarter_car(100.0), J3, ExpectedValue()).realisations == 8


def test_seeds_of_realisations_do_not_meet():
    seeds = [realisation_seeds(seed, 0, 50) for seed in range(20)]
    assert len({s for row in seeds for s in row}) == 1000
    assert realisation_seeds(7, 10, 50) == seeds[7][10:]


def test_the_interval_is_students():
    for count in (2, 3, 7):
        found = it.evaluate(quarter_car(100.0), J1, ExpectedValue(realisations=count, seed=1))
        error = scipy.stats.sem(found.samples)
        assert found.value == pytest.approx(math.sqrt(np.mean(np.square(found.samples))), rel=1e-14)
        assert found.standard_error == pytest.approx(error, rel=1e-12)
        expected = scipy.stats.t.interval(0.95, count - 1, loc=found.value, scale=error)
        assert found.interval == pytest.approx(expected, rel=1e-12)


def test_a_relative_error_is_reached_or_missed_with_a_sentence(monkeypatch):
    found = it.evaluate(quarter_car(100.0), J3, ExpectedValue(relative_error=1e-3, seed=2))
    assert found.status.ok
    assert found.standard_error <= 1e-3 * found.value
    assert found.realisations == len(found.samples) > 8
    coarse = it.evaluate(quarter_car(100.0), J3, ExpectedValue(relative_error=0.05, seed=2))
    assert coarse.realisations == 8
    assert coarse.samples == found.samples[:8]
    monkeypatch.setattr("inerter.methods.out_of_band.MOST_ROADS", 16)
    missed = it.evaluate(quarter_car(100.0), J3, ExpectedValue(relative_error=1e-5, seed=2))
    assert missed.status.kind == "inaccurate"
    assert missed.realisations == 16
    assert "after 16 roads" in missed.status.message


def test_many_designs_and_objectives_are_single_estimates():
    f, b = Friction(it.free(1.0, 200.0, "f")), Inerter(it.free(10.0, 500.0, "b"))
    car = paper_quarter_car(k | Damper(7e3) - (b | f))
    points = {"f": [10.0, 100.0], "b": [300.0, 200.0]}
    many = it.evaluate_many(car, [J1, J3], points, TWO)
    objective = TWO.objective(car, J3)
    assert not isinstance(objective, Differentiable)
    for row, f, b in zip(many, *points.values(), strict=True):
        expected = [it.evaluate(car.with_values({"f": f, "b": b}), index, TWO).value for index in (J1, J3)]
        assert row.tolist() == expected
        order = [{"f": f, "b": b}[name] for name in car.free_values()]
        assert objective.values(np.array([order])) == pytest.approx(expected[1], rel=1e-14)


def test_an_adaptive_method_fixes_its_roads_for_a_search():
    car = paper_quarter_car(k | Damper(it.free(6e3, 9e3, "c")) - (Inerter(366.52) | Friction(100.0)))
    adaptive = ExpectedValue(relative_error=2e-3, seed=2)
    roads = it.evaluate(car.with_values({"c": math.sqrt(6e3 * 9e3)}), J3, adaptive).realisations
    expected = it.evaluate(car.with_values({"c": 6e3}), J3, ExpectedValue(realisations=roads, seed=2)).value
    assert adaptive.objective(car, J3).values(np.array([[6e3]])) == pytest.approx(expected, rel=1e-14)


WRONG = {
    "one road": (lambda: ExpectedValue(realisations=1), "an integer of at least 2, got 1"),
    "half a road": (lambda: ExpectedValue(realisations=2.5), "an integer of at least 2, got 2.5"),
    "roads as truth": (lambda: ExpectedValue(realisations=True), "got True"),
    "roads as text": (lambda: ExpectedValue(realisations="4"), "got '4'"),
    "a negative seed": (lambda: ExpectedValue(seed=-1), "The seed must be a non-negative integer"),
    "a seed that is none": (lambda: ExpectedValue(seed=1.5), "The seed must be a non-negative integer"),
    "no length": (lambda: ExpectedValue(period=0), "length of a road in seconds must be a positive integer, got 0"),
    "half a second": (lambda: ExpectedValue(period=0.5), "a positive integer, got 0.5"),
    "no threads": (lambda: ExpectedValue(jobs=0), "number of threads must be a positive integer"),
    "both": (lambda: ExpectedValue(realisations=4, relative_error=0.01), "not both"),
    "no error": (lambda: ExpectedValue(relative_error=0.0), "between 0 and 1, got 0.0"),
    "an error of nan": (lambda: ExpectedValue(relative_error=math.nan), "between 0 and 1"),
    "an error as text": (lambda: ExpectedValue(relative_error="1 %"), "between 0 and 1"),
    "unknown conventions": (lambda: ExpectedValue(conventions="2008"), "available: exact, paper2008"),
    "conventions in a list": (lambda: ExpectedValue(conventions=[]), "Unknown conventions"),
    "no seed": (lambda: ExpectedValue(seed=None), "The seed must be a non-negative integer"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_numbers_are_one_clear_error(case):
    request, words = WRONG[case]
    with pytest.raises(PerformanceIndexError) as refusal:
        request()
    assert words in str(refusal.value)


def test_free_values_are_refused():
    with pytest.raises(DesignError, match="free values: f"):
        it.evaluate(paper_quarter_car(k | Friction(it.free(1.0, 2.0, "f"))), J1, TWO)


@pytest.mark.parametrize("seed", sampled(range(6), range(2)))
def test_a_fast_wheel_is_not_smoothed_by_the_knots_of_the_road(seed):
    """With a friction that does next to nothing the value is the norm, whatever the wheel's frequency."""
    rng = np.random.default_rng([4, seed])
    car = QuarterCar(
        180.0, float(np.exp(rng.uniform(-1.0, 3.0))), float(np.exp(rng.uniform(14.0, 16.5))), k | Damper(3e3)
    )
    for index in (J1, J3):
        assert_near_the_norm(replace(car, strut=car.strut | Friction(1e-6)), car, index)


@pytest.mark.parametrize("speed", sampled([25.0, 23.7, 31.3], [23.7]))
def test_axles_that_meet_the_road_between_knots_lose_nothing_to_them(speed):
    road, strut = Road(roughness=5e-7, speed=speed), Spring(3e4) | Damper(2e3)
    car, slipping = paper_half_car(strut, strut), paper_half_car(strut | Friction(1e-6), strut | Friction(1e-6))
    for index in (RideComfort(road), TyreLoad(road), TyreLoad(road, high_pass=6.28)):
        assert_near_the_norm(slipping, car, index)


def assert_near_the_norm(car, linear, index):
    """To 1e-6, and within what the method says of itself."""
    found, norm = it.evaluate(car, index, TWO), it.evaluate(linear, index, Norm()).value
    assert found.value == pytest.approx(norm, rel=1e-6)
    assert abs(found.value - norm) < 3.0 * found.standard_error + found.error_bound * norm


@pytest.mark.parametrize("scale", [1.0, 0.1, 1e-4])
def test_what_lies_outside_the_band_is_uncertain_by_at_most_itself(scale):
    """Also where the linear model of the motion that is found is of no use."""
    system = piecewise(quarter_car(30.0).mechanism())
    definition = J1.definition(system.mechanism)
    design = on_roads(system, definition, CONVENTIONS["exact"], seed=0)
    with ThreadPoolExecutor(1) as pool:
        found = [replace(ran, power=scale * ran.power) for ran in design.runs(0, 2, pool)]
    missing = out_of_band_contribution(design, found)
    mean_square = np.mean([ran.power[:1] for ran in found], axis=0)
    part = float(np.max(np.abs(missing.power) / (mean_square + missing.power)))
    assert missing.beyond <= part
    if scale < 0.01:
        assert missing.beyond == pytest.approx(part - 2.0 * missing.unseen, rel=1e-3)


@pytest.mark.parametrize("index", [J1, J3])
def test_images_of_lines_are_as_good_as_by_elimination(index, monkeypatch):
    friction = Friction(10.0)
    car = paper_half_car(
        k | Damper(3705.4) | Inerter(128.57) | friction, k | Damper(3705.4) | Inerter(128.57) | friction
    )
    found = it.evaluate(car, index, TWO).value
    monkeypatch.setattr(out_of_band, "_IMAGES_WITHIN", 0.0)  # which no sum over modes keeps
    assert found == pytest.approx(it.evaluate(car, index, TWO).value, rel=1e-13)
