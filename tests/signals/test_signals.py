"""What is true of every signal: its derivative, its grid, its past, its period, its breaks and its end."""

from __future__ import annotations

import math
import pickle
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from wang_su import ROAD

from inerter.errors import SignalError
from inerter.signals.harmonics import cosine, flat_multisine, multisine, sine
from inerter.signals.records import held_noise
from inerter.signals.signal import Signal
from inerter.signals.transients import bump, chirp, step

RNG = np.random.default_rng(0)
TIMES = np.concatenate([[0.0], np.cumsum(RNG.uniform(0.05, 0.2, 20))])
VALUES = RNG.standard_normal(21)
CLOSED = np.append(VALUES[:-1], VALUES[0])

SIGNALS = {
    "multisine": multisine(ROAD, seed=1, lowest=0.5, highest=20.0),
    "flat": flat_multisine(seed=2, rms=3.0, lowest=0.4, highest=6.0),
    "sine": sine(0.5, frequency=1.7, phase=0.3, speed=10.0),
    "cosine": cosine(2.0, frequency=0.9),
    "noise": held_noise(seed=3, power=1e-2, interval=0.125, duration=2.0),
    "chirp": chirp(1.5, lowest=0.5, highest=8.0, duration=3.0),
    "step": step(0.1, time=0.7),
    "bump": bump(0.2, length=5.0, speed=10.0, start=0.3),
    "cubic": Signal.sampled(TIMES, VALUES),
    "cubic with slopes": Signal.sampled(TIMES, VALUES, derivative=VALUES[::-1]),
    "periodic cubic": Signal.sampled(TIMES, CLOSED, periodic=True),
    "linear": Signal.sampled(TIMES, VALUES, "linear"),
    "periodic linear": Signal.sampled(TIMES, CLOSED, "linear", periodic=True),
    "zero": Signal.sampled(TIMES, VALUES, "zero"),
    "periodic zero": Signal.sampled(TIMES, VALUES, "zero", periodic=True),
    "a table that begins before zero": Signal.sampled(TIMES - 0.9, VALUES),
    "a road, held": multisine(ROAD, seed=1, lowest=0.5, highest=20.0).held(0.05),
    "a chirp, held": chirp(1.5, 0.5, 8.0, duration=3.0).held(0.07),
    "a step, held": step(0.1, time=0.7).held(0.2, duration=2.0),
    "a sum": 2.0 * sine(0.5, 1.0) + Signal.sampled(TIMES, VALUES, "linear") + step(0.3, time=0.31),
}

each_signal = pytest.mark.parametrize("signal", SIGNALS.values(), ids=SIGNALS.keys())
names = st.sampled_from(sorted(SIGNALS))


def end_of(signal: Signal) -> float:
    return 4.0 if signal.duration is None else min(signal.duration, 4.0)


@given(names, st.floats(-2.0, 4.0))
def test_derivative_is_that_of_the_value(name, time):
    """Central differences inside one formula, at the step that balances rounding and truncation."""
    signal, delta = SIGNALS[name], 2e-5
    time = min(time, end_of(signal) - 2 * delta)
    if signal.breaks(time - 2 * delta, time + 2 * delta).size:
        return
    around = signal(np.array([time - delta, time + delta]))
    scale = 1e3 * max(np.abs(signal(np.linspace(-2.0, end_of(signal), 200))).max(), 1e-3)
    assert (around[1] - around[0]) / (2 * delta) == pytest.approx(float(signal.sample(time)[1]), abs=1e-7 * scale)


@given(names, st.floats(-2.0, 1.0), st.floats(1e-4, 0.1), st.integers(0, 60))
def test_grid_is_sample(name, start, spacing, count):
    signal = SIGNALS[name]
    times = start + spacing * np.arange(count)
    if count and signal.duration is not None and times[-1] > signal.duration:
        count = int((signal.duration - start) / spacing)
        times = times[:count]
    for quick, slow in zip(signal.grid(start, spacing, count), signal.sample(times), strict=True):
        assert quick.shape == (count,)
        np.testing.assert_allclose(quick, slow, rtol=0.0, atol=1e-11 * max(np.abs(slow).max(initial=0.0), 1e-6))


@each_signal
def test_shape_follows_the_times(signal):
    times = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
    value, slope = signal.sample(times)
    assert value.shape == slope.shape == signal(times).shape == (2, 3)
    assert signal(times[1, 2]) == pytest.approx(value[1, 2], rel=1e-12, abs=1e-12)
    assert signal.sample(0.6)[0].shape == ()
    assert isinstance(signal(0.6), float)
    assert signal.sample([])[0].shape == (0,)


@each_signal
def test_before_the_start(signal):
    """Periodic signals go on backwards; the others keep their first value."""
    early = np.array([-3.7, -2.9, -1.1])
    value, slope = signal.sample(early)
    if signal.period is not None:
        later, rate = signal.sample(early + 4 * signal.period)
        np.testing.assert_allclose(value, later, atol=1e-12)
        np.testing.assert_allclose(slope, rate, atol=1e-10)
    elif len(getattr(signal, "terms", ())) < 2:
        assert np.all(value == value[0])
        assert np.all(slope == 0.0)


@each_signal
def test_after_the_end(signal):
    if signal.duration is None:
        assert np.isfinite(signal.sample(1e3)).all()
        return
    assert np.isfinite(signal.sample(signal.duration * (1 + 1e-15))).all()
    with pytest.raises(SignalError, match=rf"ends at t = {signal.duration:.9g} s, before the requested t = 4\.5 s\. "):
        signal.sample([0.0, 4.5])
    with pytest.raises(SignalError, match="Stop earlier"):
        signal.grid(0.0, 0.5, 20)


@each_signal
def test_breaks_lie_inside_and_increase(signal):
    start, stop = -1.3, 2.9
    breaks = signal.breaks(start, stop)
    assert np.all((breaks > start) & (breaks < stop))
    assert np.all(np.diff(breaks) > 1e-9)
    assert signal.breaks(stop, start).size == 0
    for knot in breaks[:3]:
        assert knot not in signal.breaks(knot, stop)
        assert knot not in signal.breaks(start, np.nextafter(knot, np.inf))


@each_signal
def test_between_breaks_the_formula_is_one(signal):
    """Between neighbouring breaks of a table, a cubic through four points is the signal."""
    if signal.interval is None or signal.label.startswith("2 x"):
        return
    breaks = signal.breaks(-1.3, 2.9)
    for left, right in pairwise(breaks):
        inside = left + (right - left) * np.array([0.1, 0.3, 0.6, 0.9, 0.45])
        value = signal(inside)
        cubic = np.polynomial.Polynomial.fit(inside[:4], value[:4], 3)
        assert cubic(inside[4]) == pytest.approx(value[4], abs=1e-9)


@each_signal
def test_a_signal_is_a_value(signal):
    with pytest.raises(AttributeError):
        signal.label = "other"
    copy = pickle.loads(pickle.dumps(signal))
    assert copy.label == signal.label
    assert np.array_equal(copy([0.1, 0.7]), signal([0.1, 0.7]))
    assert signal.hold in {"cubic", "linear", "zero"}
    assert "\n" not in signal.label


def test_facts():
    assert (SIGNALS["multisine"].period, SIGNALS["multisine"].highest_frequency) == (2.0, 20.0)
    assert SIGNALS["multisine"].speed == 25.0
    assert (SIGNALS["noise"].period, SIGNALS["noise"].interval, SIGNALS["noise"].hold) == (2.0, 0.125, "zero")
    assert (SIGNALS["chirp"].duration, SIGNALS["chirp"].highest_frequency) == (3.0, 8.0)
    assert (SIGNALS["bump"].speed, SIGNALS["bump"].hold, SIGNALS["step"].hold) == (10.0, "cubic", "zero")
    assert SIGNALS["cubic"].interval == pytest.approx(np.diff(TIMES).min())
    assert multisine(ROAD, seed=0).label == "multisine, 0.1 to 1000 Hz, seed 0"


# sums


def test_a_sum_is_the_sum():
    one, other = sine(1.0, 2.0), SIGNALS["cubic"]
    both = one * 3.0 + np.float64(2.0) * other
    times = np.linspace(0.0, 1.5, 40)
    for got, a, b in zip(both.sample(times), one.sample(times), other.sample(times), strict=True):
        np.testing.assert_allclose(got, 3.0 * a + 2.0 * b, rtol=1e-15, atol=1e-15)
    assert both.duration == other.duration
    assert both.interval == other.interval
    assert both.highest_frequency == 2.0
    assert both.label == "3 x (sine of 1, 2 Hz) + 2 x (table of 21 samples)"


def test_a_sum_has_the_common_period():
    assert (sine(1.0, 2.0) + cosine(1.0, 0.5)).period == 2.0
    assert (sine(1.0, 0.1) + cosine(1.0, 0.3)).period == 10.0
    assert (sine(1.0, 2.0) + sine(1.0, 3.0)).period is None  # 1 s is common, but neither period is a multiple
    assert (sine(1.0, 2.0) + step(1.0)).period is None
    assert (2.0 * sine(1.0, 2.0)).period == 0.5


def test_a_sum_takes_the_roughest_hold_and_the_known_speed():
    kerb = multisine(ROAD, seed=0) + step(0.1, time=0.25)
    assert (kerb.hold, kerb.speed) == ("zero", 25.0)
    assert (sine(1.0, 1.0) + SIGNALS["linear"]).hold == "linear"
    speeds = r"different speeds cannot be added, got (25 m/s and 10 m/s|10 m/s and 25 m/s)\."
    with pytest.raises(SignalError, match=speeds):
        SIGNALS["multisine"] + SIGNALS["sine"]


def test_knots_that_differ_by_rounding_are_one():
    """0.1 + 0.2 and 0.3 are neighbouring numbers; at the one break both have jumped."""
    pair = step(1.0, time=0.1 + 0.2) + step(1.0, time=0.3)
    breaks = pair.breaks(0.0, 1.0)
    assert len(breaks) == 1
    assert pair(breaks[0]) == 2.0


# holds


def test_held_samples_the_signal():
    road = SIGNALS["multisine"]
    held = road.held(0.05)
    assert (held.period, held.interval, held.hold, held.speed) == (2.0, 0.05, "zero", 25.0)
    times = 0.05 * np.arange(-40, 80)
    np.testing.assert_allclose(held(times), road(times), atol=1e-15)
    np.testing.assert_array_equal(held(times + 0.03), held(times))
    assert held.label == "multisine, 0.5 to 20 Hz, seed 1, held for 50 ms"


def test_held_ends_when_the_signal_ends():
    held = chirp(1.5, 0.5, 8.0, duration=3.0).held(0.07)
    assert held.duration == 3.0
    assert held(3.0) == held(42 * 0.07) == pytest.approx(chirp(1.5, 0.5, 8.0, duration=3.0)(42 * 0.07))
    short = chirp(1.0, 1.0, 2.0, duration=0.6)  # 0.6 / 0.2 < 3
    assert short.held(0.2)(0.6) == pytest.approx(short(0.6))


def test_held_needs_whole_intervals():
    with pytest.raises(SignalError, match=r"A period of 2 s is not a whole number of intervals of 0\.3 s\. .* 0\.285"):
        SIGNALS["multisine"].held(0.3)
    with pytest.raises(SignalError, match="neither periodic nor finite"):
        step(1.0).held(0.1)
    with pytest.raises(SignalError, match=r"ends at t = 3 s"):
        SIGNALS["chirp"].held(0.1, duration=5.0)
    with pytest.raises(SignalError, match=r"signal of 3 s cannot be held for 4 s"):
        SIGNALS["chirp"].held(4.0)
    with pytest.raises(SignalError, match="interval of a hold must be a positive number of s, got 0"):
        SIGNALS["chirp"].held(0)


# transients


def test_chirp_sweeps_linearly():
    """Its phase has whole turns where the integral of the frequency is whole."""
    sweep = chirp(1.0, lowest=1.0, highest=5.0, duration=4.0)
    turns = np.arange(1, 12)
    times = -1.0 + np.sqrt(1.0 + 2.0 * turns)  # t + t^2 / 2 = turns
    value, slope = sweep.sample(times)
    np.testing.assert_allclose(value, 0.0, atol=1e-13)
    np.testing.assert_allclose(slope, 2.0 * math.pi * (1.0 + times), rtol=1e-13)
    np.testing.assert_array_equal(sweep.breaks(-1.0, 1.0), [0.0])


@pytest.mark.parametrize("instant", [0.0, 0.6, 1 / 3, 12.7])
def test_a_step_has_its_new_value_at_its_time(instant):
    kerb = step(0.1, time=instant)
    late = instant + np.array([0.0, -2e-16, 2e-16, 1e-6])
    np.testing.assert_array_equal(kerb(late), 0.1)
    assert kerb(instant - 1e-9) == 0.0
    np.testing.assert_array_equal(kerb.breaks(-1.0, 20.0), [instant])


def test_bump_is_as_long_and_as_high_as_it_is_said_to_be():
    hump = bump(0.05, length=2.0, speed=10.0, start=1.0)
    np.testing.assert_allclose(
        hump([0.5, 1.0, 1.05, 1.1, 1.15, 1.2, 5.0]), [0, 0, 0.025, 0.05, 0.025, 0, 0], atol=1e-16
    )
    np.testing.assert_allclose(hump.breaks(0.0, 2.0), [1.0, 1.2])
    assert hump.highest_frequency == pytest.approx(5.0)
