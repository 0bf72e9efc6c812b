"""The IRI against coefficients that the World Bank printed, against explicit steps, and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import inerter as it
from inerter.errors import RecordError
from inerter.roads.iri import SPEED, transition

# Sayers, Gillespie and Paterson (1986), World Bank Technical Paper 46: the golden car over 250 mm at 80 km/h, to the
# seven digits of its program.
PRINTED = np.array(
    [
        [0.9966071, 0.01091514, -0.002083274, 0.0003190145],
        [-0.5563044, 0.9438768, -0.8324718, 0.05064701],
        [0.02153176, 0.002126763, 0.7508714, 0.008221888],
        [3.335013, 0.3376467, -39.12762, 0.4347564],
    ]
)
PRINTED_SLOPE = np.array([0.005476107, 1.388776, 0.2275968, 35.79262])


def triangle(x):
    """The test profile of that paper: up by 1 mm a metre from 1 to 3 m, and down again until 5 m; in metres."""
    return 1e-3 * np.interp(x, [1.0, 3.0, 5.0], [0.0, 2.0, 0.0])


def procedure(height, interval, ST, PR):
    """The paper's program, step by step."""
    span = max(1, int(0.25 / interval + 0.5 + 1e-9))
    eleven = int(11.0 / interval + 0.5)
    start = (height[eleven] - height[0]) / (eleven * interval)
    z, total, count = np.array([start, 0.0, start, 0.0]), 0.0, height.size - span
    for i in range(count):
        z = ST @ z + PR * (height[i + span] - height[i]) / (span * interval)
        total += abs(z[0] - z[2])
    return 1e3 * total / count


def test_the_printed_transition_of_the_golden_car():
    ST, PR = transition(0.25)
    np.testing.assert_allclose(ST, PRINTED, rtol=1e-6, atol=2e-7)
    np.testing.assert_allclose(PR, PRINTED_SLOPE, rtol=1e-6, atol=2e-7)


def test_the_triangle_of_technical_paper_46():
    """By the printed coefficients, whose program it was the test of."""
    x = np.arange(0.0, 30.0 + 1e-9, 0.25)
    found = it.iri(it.Profile(x, triangle(x)))
    assert found == pytest.approx(procedure(triangle(x), 0.25, PRINTED, PRINTED_SLOPE), rel=2e-6)


def explicit(interval, parts=40):
    """Transition over an interval by classical Runge-Kutta steps of the equations of motion, in their own letters."""

    def rates(z, slope):
        zs, vs, zu, vu = z
        force = 63.3 * (zu - zs) + 6.0 * (vu - vs)
        return np.array([vs, force, vu, (653.0 * (slope - zu) - force) / 0.15])

    def moved(z, slope):
        h = interval / SPEED / parts
        for _ in range(parts):
            a = rates(z, slope)
            b = rates(z + h / 2 * a, slope)
            c = rates(z + h / 2 * b, slope)
            z = z + h / 6 * (a + 2 * b + 2 * c + rates(z + h * c, slope))
        return z

    return np.array([moved(e, 0.0) for e in np.eye(4)]).T, moved(np.zeros(4), 1.0)


def random_profile(seed):
    rng = np.random.default_rng(seed)
    interval = float(rng.choice([0.01, 0.05, 0.1, 0.125, 0.25, 0.3, 0.5]))
    count = int(rng.uniform(12.0, 60.0) / interval)
    height = np.cumsum(rng.normal(0.0, 2e-3 * np.sqrt(interval), count))
    return interval, height


def check_one(seed):
    interval, height = random_profile(seed)
    found = it.iri(it.Profile(interval * np.arange(height.size), height))
    assert found == pytest.approx(procedure(height, interval, *explicit(interval)), rel=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_random_profiles_by_explicit_steps(seed):
    check_one(seed)


@pytest.mark.campaign
def test_many_random_profiles_by_explicit_steps():
    for seed in range(6, 200):
        check_one(seed)


def test_a_constant_grade_has_none():
    x = np.arange(0.0, 100.0, 0.1)
    assert it.iri(it.Profile(x, 0.05 * x)) == pytest.approx(0.0, abs=1e-11)


def test_a_sine_by_its_transfer_function():
    """After the start, the travel is a sine: its mean absolute value is 2 / pi of the amplitude."""
    interval, wave, amplitude = 0.02, 2.0, 1e-3
    x = np.arange(0.0, 2000.0, interval)
    omega = 2 * np.pi * SPEED / wave
    s = 1j * omega
    M = np.array([[s**2 + 6.0 * s + 63.3, -(6.0 * s + 63.3)], [-(6.0 * s + 63.3), 0.15 * s**2 + 6.0 * s + 716.3]])
    zs, zu = np.linalg.solve(M, [0.0, 653.0])
    averaged = np.sinc(0.25 / wave)  # slopes over 250 mm (of 240 or 260: rounding of the base)
    expected = 1e3 * 2 / np.pi * abs(zs - zu) * (2 * np.pi / wave) * amplitude * averaged
    found = it.iri(it.Profile(x, amplitude * np.sin(2 * np.pi * x / wave)))
    assert found == pytest.approx(expected, rel=5e-3)


def test_two_tracks_have_the_mean():
    x = np.arange(0.0, 50.0, 0.25)
    left, right = np.random.default_rng(1).normal(0, 1e-3, (2, x.size))
    alone = [it.iri(it.Profile(x, heights)) for heights in (left, right)]
    assert it.iri(it.Profile(x, left, right)) == pytest.approx(np.mean(alone), rel=1e-14)


def test_what_has_none():
    x = np.arange(0.0, 20.0, 0.25)
    for profile, sentence in (
        (it.Profile(x[:20], 0 * x[:20]), "at least 11 m"),
        (it.Profile(4 * x, 0 * x), "are up to 1 m"),
        (x, "requires a Profile"),
    ):
        with pytest.raises(RecordError, match=sentence):
            it.iri(profile)
