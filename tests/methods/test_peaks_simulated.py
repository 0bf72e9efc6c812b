"""Load carrying of designs with friction and gaps: against a scan over frequencies, scaling laws and the norm."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from campaigns import sampled
from scipy.optimize import brentq
from wang_su import paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, ExpectedValue, Friction, Gap, Inerter, LoadCarrying, Norm, Spring
from inerter.errors import OK, PerformanceIndexError
from inerter.methods.harmonic_response import local_maxima
from inerter.methods.steady_squares import Squares
from inerter.simulation.trajectory import PeriodicState

k, shaft = Spring(120e3), Spring(1e6) | Damper(3200.0)
J5 = LoadCarrying(1000.0)
SIMULATED = ExpectedValue()


def parallel(size=1.0):
    return paper_quarter_car(k | Damper(9301.3) | (Inerter(328.34) | Friction(100.0 * size)))


def series(size=1.0):
    return paper_quarter_car(k | Damper(11174.5) - (Inerter(1232.42) | Friction(100.0 * size)))


def elastic(size=1.0):
    return paper_quarter_car(k | Damper(10174.3) - shaft - (Inerter(888.29) | Friction(30.0 * size)))


def backlash(size=1.0):
    return paper_quarter_car(k | Damper(5e3) | shaft - Gap(2e-3 * size) - (Inerter(300.0) | Friction(20.0 * size)))


def gain(car, frequency):
    """R.m.s. displacement over r.m.s. force under a sine, after it repeats."""
    push = it.sine(amplitude=1000.0, frequency=frequency)
    run = it.simulate(car, forces={"sprung_force": push}, initial="periodic", step=push.period / 150)
    return np.sqrt(np.mean(run["sprung_displacement"][:-1] ** 2)) / (1000.0 / np.sqrt(2.0))


@pytest.mark.parametrize("design", sampled([parallel, series, elastic, backlash], [series], seldom=[backlash]))
def test_every_maximum_of_a_fine_scan_is_there(design):
    found = it.evaluate(design(), J5, SIMULATED)
    assert found.status.ok
    assert found.value == found.peaks[0].gain == max(peak.gain for peak in found.peaks)
    assert (found.standard_error, found.interval) == (0.0, (found.value, found.value))
    frequencies = np.geomspace(0.3, 9.0, 50)  # beyond, the strut sticks where the start has left it
    scan = np.array([gain(design(), frequency) for frequency in frequencies])
    assert scan.max() <= found.value * (1.0 + 1e-5)
    inner = 1 + np.flatnonzero((scan[1:-1] > scan[:-2]) & (scan[1:-1] > scan[2:]))
    assert inner.size
    for i in inner:
        near = [p for p in found.peaks if frequencies[i - 1] < p.omega / (2.0 * np.pi) < frequencies[i + 1]]
        assert len(near) == 1
        assert scan[i] * (1.0 - 1e-5) <= near[0].gain <= scan[i] * 1.03
    for peak in (peak for peak in found.peaks if peak.omega > 0.0):
        assert peak.gain == pytest.approx(gain(design(), peak.omega / (2.0 * np.pi)), rel=1e-4)


@pytest.mark.parametrize("ratio", [1.0, 1.002, 1.02])
def test_a_peak_where_two_ranges_of_the_search_meet_is_found(ratio):
    at, repeats = 9.3, PeriodicState(1.0, 1, 0.0)
    squares = Squares(np.ones(1), OK, repeats, np.zeros(1), np.ones(1))

    def resonance(omega):
        return 1.0 / np.hypot(1.0 - (omega / at) ** 2, 0.04 * omega / at), squares

    expected = np.array([0.7, at / ratio, at * ratio])
    with ThreadPoolExecutor(1) as pool:
        highest, *_ = local_maxima(resonance, expected, 0.1, pool)
    assert 25.0 * (1.0 - 1e-4) < highest.peak.gain <= 25.0 * (1.0 + highest.missed) + 1e-2
    assert highest.peak.omega == pytest.approx(at, rel=2e-3)


@pytest.mark.parametrize("expected", [[0.7, 7.0], [12.0]])
def test_a_peak_outside_all_ranges_of_the_search_is_found(expected):
    at = 9.3
    squares = Squares(np.ones(1), OK, PeriodicState(1.0, 1, 0.0), np.zeros(1), np.ones(1))

    def resonance(omega):
        return 1.0 / np.hypot(1.0 - (omega / at) ** 2, 0.2 * omega / at), squares

    with ThreadPoolExecutor(1) as pool:
        highest, *_ = local_maxima(resonance, np.array(expected), 0.1, pool)
    assert highest.peak.gain == pytest.approx(1.0 / (0.2 * np.sqrt(1.0 - 0.1**2)), rel=1e-4)


@pytest.mark.campaign
def test_with_much_friction_no_sine_has_a_higher_gain():
    screw = (Spring(1e6) | Damper(3200.0)) - (Inerter(222.69) | Friction(1321.3))  # harmonic balance is far off
    car = it.QuarterCar(485.31, 22.930, 223.878e3, Spring(15.4108e3) | Damper(386.96) | screw)
    found = it.evaluate(car, J5, SIMULATED)
    assert found.status.ok
    assert gain(car, 24.41 / (2.0 * np.pi)) <= found.value * (1.0 + found.error_bound)


@pytest.mark.campaign
def test_with_backlash_no_sine_has_a_higher_gain():
    stop = Gap(6.618e-3) - Spring(56.9e3)
    car = it.QuarterCar(505.614, 33.588, 135.131e3, Spring(10.1279e3) | Damper(489.983) | stop)
    found = it.evaluate(car, J5, SIMULATED)
    assert found.status.ok
    assert gain(car, 9.31 / (2.0 * np.pi)) <= found.value * (1.0 + found.error_bound)


@pytest.mark.parametrize(("damping", "clearance"), sampled([(8.0, 5e-3), (20.0, 5e-3), (12.0, 7e-3)], [(8.0, 5e-3)]))
def test_a_sweep_finds_the_larger_of_several_steady_motions(damping, clearance):
    """On stops the resonance bends to higher frequencies, where a start from rest leads to a smaller motion.

    By harmonic balance with the equivalent stiffness of a spring behind a gap, at resonance: amplitude F / (c omega).
    """
    mass, stiffness, stop, force = 10.0, 4000.0, 8000.0, 10.0
    strut = Spring(stiffness) | Damper(damping) | (Gap(clearance) - Spring(stop))
    car = it.Mechanism(
        (it.Coordinate("mass", mass),),
        (it.Strut("strut", strut, {"mass": 1.0}, {}),),
        forces=(it.Force("force", {"mass": 1.0}),),
    )
    found = it.evaluate(car, it.PeakResponse("force", "mass_displacement", amplitude=force), SIMULATED)

    def unbalanced(amplitude):
        share = min(clearance / amplitude, 1.0)
        equivalent = stop * (1.0 - (np.arcsin(share) + share * np.sqrt(1.0 - share**2)) * 2.0 / np.pi)
        return force / (damping * np.sqrt((stiffness + equivalent) / mass)) - amplitude

    amplitude = brentq(unbalanced, 1e-4, 1.0)
    assert found.value == pytest.approx(amplitude / force, rel=0.03)
    assert found.error_bound < 0.03


@pytest.mark.parametrize("design", sampled([series, backlash], [series]))
def test_only_the_ratio_of_friction_and_gap_to_force_matters(design):
    one = it.evaluate(design(1.0), LoadCarrying(800.0), SIMULATED)
    other = it.evaluate(design(2.5), LoadCarrying(2000.0), SIMULATED)
    assert other.value == pytest.approx(one.value, rel=1e-5)
    assert [p.omega for p in other.peaks] == pytest.approx([p.omega for p in one.peaks], rel=5e-3)


@pytest.mark.parametrize("design", [parallel, series, elastic])
def test_a_large_force_finds_the_linear_peaks(design):
    found = it.evaluate(design(1e-5), J5, SIMULATED)
    linear = it.evaluate(design(0.0), J5, Norm())
    assert found.value == pytest.approx(linear.value, rel=1e-5)
    moving = [p for p in linear.peaks if p.omega > 0.0]
    assert [p.gain for p in found.peaks if p.omega > 0.0] == pytest.approx([p.gain for p in moving], rel=1e-5)
    assert it.evaluate(design(0.0), J5, SIMULATED).value == linear.value


def test_under_the_papers_conventions_the_linear_peak_is_followed():
    car = series()
    exact, followed = (it.evaluate(car, J5, ExpectedValue(conventions=c)) for c in ("exact", "paper2008"))
    linear = it.evaluate(series(0.0), J5, Norm()).peaks[0]
    nearest = min(exact.peaks, key=lambda peak: abs(np.log((peak.omega or 1e-9) / linear.omega)))
    assert followed.value == nearest.gain
    assert followed.peaks == exact.peaks


def test_a_half_car_answers_in_bounce():
    strut = k | Damper(8e3) - (Inerter(500.0) | Friction(50.0))
    car = paper_half_car(strut, strut)
    found = it.evaluate(car, LoadCarrying(2000.0), SIMULATED)
    harmonic = it.evaluate(car, LoadCarrying(2000.0), it.StatisticalLinearisation())
    assert found.status.ok
    assert found.value == pytest.approx(harmonic.value, rel=0.02)


@pytest.mark.parametrize("design", [series, backlash])
def test_without_an_amplitude_there_is_no_answer(design):
    with pytest.raises(PerformanceIndexError, match="depends on the force amplitude"):
        it.evaluate(design(), LoadCarrying(), SIMULATED)
    assert it.evaluate(series(0.0), LoadCarrying(), SIMULATED).status.ok
