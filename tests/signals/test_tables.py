"""Tables of samples: order, knots met exactly, periods, and the noise that is held."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from inerter.signals.records import held_noise
from inerter.signals.signal import Signal


def exact(times):
    return np.sin(3.0 * times) + times**2, 3.0 * np.cos(3.0 * times) + 2.0 * times


@pytest.mark.parametrize("with_slopes", [True, False])
def test_cubics_converge_with_order_four(with_slopes):
    fine = np.linspace(0.0, 2.0, 4001)
    errors = []
    for count in (21, 41, 81, 161):
        times = np.linspace(0.0, 2.0, count)
        value, slope = exact(times)
        table = Signal.sampled(times, value, derivative=slope if with_slopes else None)
        errors.append([np.abs(got - want).max() for got, want in zip(table.sample(fine), exact(fine), strict=True)])
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders[-1] == pytest.approx([4.0, 3.0], abs=0.2)


def test_periodic_cubics_converge_with_order_four():
    fine = np.linspace(-1.0, 3.0, 2001)
    errors = []
    for count in (21, 41, 81):
        times = np.linspace(0.0, 1.0, count)
        table = Signal.sampled(times, np.sin(2 * math.pi * times), periodic=True)
        errors.append(np.abs(table(fine) - np.sin(2 * math.pi * fine)).max())
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.1)


@given(st.integers(0, 10_000), st.integers(2, 12))
def test_cubics_are_those_of_the_spline(seed, count):
    rng = np.random.default_rng(seed)
    times, values = np.cumsum(rng.uniform(0.1, 1.0, count)), rng.standard_normal(count)
    table, spline = Signal.sampled(times, values), CubicSpline(times, values)
    between = rng.uniform(times[0], times[-1], 30)
    np.testing.assert_allclose(table(between), spline(between), atol=1e-11)
    np.testing.assert_allclose(table.sample(between)[1], spline(between, 1), atol=1e-9)


@given(st.integers(0, 10_000), st.sampled_from(["zero", "linear", "cubic"]), st.booleans(), st.integers(-5, 5))
def test_a_knot_is_met_whatever_the_rounding(seed, hold, periodic, turn):
    """At a knot and an ulp to either side stand the sample and the slope from the right."""
    rng = np.random.default_rng(seed)
    times = rng.uniform(-1.0, 1.0) + np.concatenate([[0.0], np.cumsum(rng.uniform(1e-3, 1.0, 8))])
    values = rng.standard_normal(9)
    values[-1] = values[0] if periodic and hold != "zero" else values[-1]
    table = Signal.sampled(times, values, hold, periodic=periodic)
    last = 8 if periodic else 9
    shift = turn * table.period if periodic else 0.0
    knots = times[:last] + shift
    right = table.sample(knots[: last - 1] + 1e-8 * np.diff(times)[: last - 1])[1]
    for near in (knots, np.nextafter(knots, -9e9), np.nextafter(knots, 9e9)):
        if not periodic:
            near = np.minimum(near, times[-1])
        value, slope = table.sample(near)
        np.testing.assert_allclose(value, values[:last], rtol=1e-15 if hold == "zero" else 0.0, atol=1e-11)
        np.testing.assert_allclose(slope[: last - 1], right, rtol=1e-4, atol=1e-4)


def test_a_grid_of_tenths_meets_every_knot():
    """0.1 * 6 is 0.6000000000000001 and 0.1 * 3 is above 0.3: each must show the sample that it means."""
    times = np.array([float(f"{i / 10:.1f}") for i in range(101)])
    table = Signal.sampled(times, np.arange(101.0), "zero")
    assert np.array_equal(table.grid(0.0, 0.1, 101)[0], np.arange(101.0))
    assert np.array_equal(table(np.cumsum(np.full(100, 0.1))), np.arange(1.0, 101.0))
    assert table(0.6 - 1e-6) == 5.0


def test_far_away_knots_of_a_periodic_hold():
    noise = held_noise(seed=1, power=1e-8, interval=1e-3, duration=10.0)
    once = noise.grid(0.0, 1e-3, 10_000)[0]
    assert np.array_equal(noise.grid(-20.0, 1e-3, 10_000)[0], once)
    assert np.array_equal(noise.grid(5000.0, 1e-3, 10_000)[0], once)
    assert np.array_equal(noise(0.0005 + 1e-3 * np.arange(10_000)), once)


@pytest.mark.parametrize(
    ("periodic", "ends", "breaks"),
    [
        (True, (-1.0, 2.0), [-0.5, -0.25, 0.5, 0.75, 1.5, 1.75]),
        (True, (0.5, 1.5), [0.75]),
        (False, (-9.0, 1.5), [0.5, 0.75]),  # its start included
        (False, (0.6, 1.0), [0.75]),
        (False, (-9.0, 0.2), []),
    ],
)
def test_breaks_of_a_table(periodic, ends, breaks):
    hold = "linear" if periodic else "cubic"
    table = Signal.sampled([0.5, 0.75, 1.5], [1.0, 2.0, 1.0], hold, periodic=periodic)
    np.testing.assert_allclose(table.breaks(*ends), breaks)


def test_a_zero_hold_shows_its_last_sample_at_its_end_only():
    table = Signal.sampled([0.0, 1.0, 2.0], [3.0, 4.0, 5.0], "zero")
    np.testing.assert_array_equal(table([1.999, 2.0]), [4.0, 5.0])
    again = Signal.sampled([0.0, 1.0, 2.0], [3.0, 4.0, 5.0], "zero", periodic=True)
    np.testing.assert_array_equal(again([1.999, 2.0, 3.0]), [4.0, 3.0, 4.0])


def test_tables_keep_what_they_were_given():
    times, values = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0])
    table = Signal.sampled(times, values, "linear")
    times[:], values[:] = 9.0, 9.0
    assert table(1.5) == 2.5
    with pytest.raises(ValueError, match="read-only"):
        table.coefficient[0, 0] = 1.0


# noise


def test_noise_has_its_power():
    noise = held_noise(seed=2, power=1e-8)
    samples = noise(1e-3 * np.arange(100_000))
    assert np.std(samples) == pytest.approx(3.1623e-3, rel=4 / math.sqrt(2 * 100_000))
    density = 1e-3 * np.abs(np.fft.fft(samples)) ** 2 / len(samples)
    assert np.mean(density[1:1000]) == pytest.approx(1e-8, rel=4 / math.sqrt(1000))
    assert (noise.period, noise.interval, noise.hold, noise.speed) == (100.0, 1e-3, "zero", None)


def test_noise_is_independent_and_repeats_from_its_seed():
    one = held_noise(seed=3, power=1.0, interval=0.01, duration=50.0)
    samples = one(0.01 * np.arange(5000))
    assert abs(np.corrcoef(samples[1:], samples[:-1])[0, 1]) < 4 / math.sqrt(5000)
    assert np.array_equal(samples, held_noise(3, 1.0, 0.01, 50.0)(0.01 * np.arange(5000)))
    assert not np.array_equal(samples, held_noise(4, 1.0, 0.01, 50.0)(0.01 * np.arange(5000)))
