"""Multisines and sines: their spectra, their variance, and the fast ways to a grid against the plain sum."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from wang_su import ROAD

from inerter.signals.harmonics import Harmonics, cosine, flat_multisine, multisine, sine


def plain_sum(signal: Harmonics, times):
    """The cosines and their derivatives, added up one by one."""
    angle = 2.0 * math.pi * np.outer(times, signal.frequencies) + signal.phases
    rate = -2.0 * math.pi * signal.frequencies * signal.amplitudes
    return np.cos(angle) @ signal.amplitudes, np.sin(angle) @ rate


def largest_error(got, expected):
    return np.abs(got - expected).max() / np.abs(expected).max()


@given(st.integers(0, 2**32), st.integers(1, 300), st.integers(1, 700), st.floats(-3.0, 3.0), st.integers(1, 900))
@example(0, 40, 100, 0.0, 30)
@example(0, 40, 100, 0.0, 250)
@example(0, 50, 100, 0.0, 250)
@example(0, 120, 100, 0.0, 250)
def test_transform_is_the_plain_sum(seed, harmonics, points, start, count):
    """Also with fewer points a period than harmonics (they fold back), odd ones, and grids of several periods."""
    signal = flat_multisine(seed, rms=1.0, lowest=1.0, highest=float(harmonics))
    step = signal.period / points
    times = start + step * np.arange(count)
    peak = math.sqrt(2.0 * harmonics)
    phase = 2.0 * math.pi * harmonics * np.abs(times).max()  # a time, and so a phase, is known to a unit of rounding
    expected = plain_sum(signal, times)
    for got, want, size in zip(signal._by_transform(start, points, count), expected, (1.0, 7 * harmonics), strict=True):
        assert np.abs(got - want).max() <= (1e-13 + np.finfo(float).eps * phase) * peak * size


def test_transform_agrees_to_1e_12():
    signal = multisine(ROAD, seed=4, lowest=0.5, highest=100.0)
    start, step, count = -0.0816, 1e-3, 2000
    times = start + step * np.arange(count)
    fast = signal.grid(start, step, count)
    for got, direct, plain in zip(fast, signal.sample(times), plain_sum(signal, times), strict=True):
        assert largest_error(got, direct) < 1e-12
        assert largest_error(got, plain) < 1e-12


@given(st.floats(-5.0, 5.0), st.floats(1e-4, 0.02), st.integers(1, 500))
def test_blocks_are_the_plain_sum(start, step, count):
    signal = multisine(ROAD, seed=5, lowest=0.5, highest=40.0)
    times = start + step * np.arange(count)
    for got, want in zip(signal._by_blocks(start, step, count), plain_sum(signal, times), strict=True):
        np.testing.assert_allclose(got, want, rtol=0.0, atol=1e-11)


def test_all_ways_agree_on_the_road_of_the_paper():
    signal = multisine(ROAD, seed=6)
    start, step, count = -0.08, 2e-4, 300
    ways = signal.grid(start, step, count), signal._by_blocks(start, step, count)
    expected = plain_sum(signal, start + step * np.arange(count))
    for way in ways:
        assert largest_error(way[0], expected[0]) < 1e-12
        assert largest_error(way[1], expected[1]) < 1e-11


@pytest.mark.parametrize(("highest", "step", "start"), [(1000.0, 2e-4, 0.0), (100.0, 1e-4, 0.0137), (20.0, 1e-3, -2.0)])
def test_a_grid_takes_the_memory_of_two_transforms(highest, step, start):
    signal = multisine(ROAD, seed=9, highest=highest)
    length = round(signal.period / step)
    for count in (length // 20, length // 3, length):
        signal.grid(start, step, count)
        tracemalloc.start()
        signal.grid(start, step, count)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 2 * (2 * 8 * length) + 20_000


def test_a_grid_without_a_whole_period():
    signal = multisine(ROAD, seed=7, highest=50.0)
    times = 0.3 + 0.0123 * np.arange(400)
    assert largest_error(signal.grid(0.3, 0.0123, 400)[0], signal(times)) < 1e-12


def test_spectrum_is_that_of_the_road():
    """Two-sided, each harmonic carries A^2 / 4 at +f and at -f: the density is kappa V / f^2."""
    signal = multisine(ROAD, seed=8)
    assert len(signal.frequencies) == 10_000
    value, slope = signal.grid(0.0, 2e-4, 50_000)
    lines = np.fft.rfft(value)[1:10_001] / len(value)
    density = np.abs(lines) ** 2 / 0.1
    frequency = 0.1 * np.arange(1, 10_001)
    np.testing.assert_allclose(density, ROAD.roughness * ROAD.speed / frequency**2, rtol=1e-6)
    assert np.var(value) == pytest.approx(np.sum(2 * ROAD.roughness * ROAD.speed * 0.1 / frequency**2), rel=1e-12)
    assert np.mean(slope**2) == pytest.approx(2 * 1000.0 * ROAD.velocity_intensity**2, rel=1e-12)


def test_amplitudes_of_equation_17():
    signal = multisine(ROAD, seed=9, lowest=0.2, highest=5.0)
    omega, step = 2 * math.pi * signal.frequencies, 2 * math.pi * 0.2
    expected = np.sqrt(8 * math.pi * ROAD.roughness * ROAD.speed * step) / omega
    np.testing.assert_allclose(signal.amplitudes, expected, rtol=1e-14)


def test_the_seed_alone_decides():
    times = np.linspace(0.0, 3.0, 50)
    one, again, other = (multisine(ROAD, seed, highest=10.0) for seed in (1, 1, 2))
    assert np.array_equal(one(times), again(times))
    assert not np.allclose(one(times), other(times))


def test_phases_are_uniform():
    phases = np.sort(multisine(ROAD, seed=10).phases)
    even = np.linspace(-math.pi, math.pi, len(phases))
    assert np.abs(phases - even).max() < 2 * math.pi * 1.63 / math.sqrt(len(phases))  # Kolmogorov, 1 %


@given(st.integers(0, 1000), st.floats(1e-3, 1e3), st.floats(0.1, 3.0), st.floats(1.0, 60.0))
def test_flat_multisine_has_its_rms(seed, rms, lowest, ratio):
    signal = flat_multisine(seed, rms, lowest, lowest * ratio)
    count = len(signal.amplitudes)
    assert count == pytest.approx(ratio, abs=1.0)
    value, _ = signal.grid(0.0, signal.period / (2 * count + 1), 2 * count + 1)
    assert math.sqrt(np.mean(value**2)) == pytest.approx(rms, rel=1e-9)
    assert np.ptp(signal.amplitudes) <= 1e-12 * rms


def test_highest_is_kept_where_rounding_would_drop_it():
    assert len(flat_multisine(0, 1.0, lowest=0.1, highest=0.3).amplitudes) == 3  # 0.3 / 0.1 < 3
    assert len(flat_multisine(0, 1.0, lowest=0.1, highest=0.39).amplitudes) == 3
    assert len(flat_multisine(0, 1.0, lowest=0.7, highest=0.7).amplitudes) == 1


@given(st.floats(-2.0, 2.0), st.floats(0.01, 50.0), st.floats(-7.0, 7.0), st.floats(-2.0, 2.0))
def test_sine_and_cosine(amplitude, frequency, phase, time):
    angle, rate = 2 * math.pi * frequency * time + phase, 2 * math.pi * frequency * amplitude
    for signal, value, slope in (
        (sine(amplitude, frequency, phase), amplitude * math.sin(angle), rate * math.cos(angle)),
        (cosine(amplitude, frequency, phase), amplitude * math.cos(angle), -rate * math.sin(angle)),
    ):
        np.testing.assert_allclose(signal.sample(time), [value, slope], atol=1e-12 * (1 + abs(rate)))
    assert sine(amplitude, frequency)(0.0) == 0.0
