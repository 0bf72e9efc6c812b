"""Velocity and acceleration of known motions, from what an encoder makes of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from inerter.errors import RecordError
from inerter.records.filtering import gain, low_pass
from inerter.records.record import Record
from inerter.records.smoothing import interpolate, noise_of, resolution, smooth_displacement
from inerter.report.options import as_options


def motion(rows, rate, duration, step=0.0, noise=0.0, phase=1.0, seed=0):
    """The record of a sum of cosines (frequency, amplitude), and its true displacement, velocity, acceleration."""
    time = np.arange(round(duration * rate)) / rate
    waves = [(a, 2 * np.pi * f, 2 * np.pi * f * time + phase * (1 + i**2)) for i, (f, a) in enumerate(rows)]
    truth = (
        sum(a * np.cos(p) for a, w, p in waves),
        sum(-a * w * np.sin(p) for a, w, p in waves),
        sum(-a * w**2 * np.cos(p) for a, w, p in waves),
    )
    read = truth[0] + np.random.default_rng(seed).normal(0.0, noise, time.size)
    read = np.round(read / step) * step if step else read
    return Record(time, read, np.zeros(time.size)), truth


def inner(values, found, periods=1.0):
    """Without the ends, where only one side is known."""
    cut = int(periods / (found.bandwidth * (found.time[1] - found.time[0]))) + 1
    return values[cut:-cut]


CASES = {
    "slow staircase": ([(0.1, 1e-3)], 1000.0, 30.0, 1e-6, 0.0),
    "slow staircase at 10 kHz": ([(0.1, 1e-3)], 10000.0, 12.0, 1e-6, 0.0),
    "3 Hz": ([(3.0, 1e-3)], 1000.0, 5.0, 1e-6, 0.0),
    "3 Hz in noise": ([(3.0, 1e-3)], 1000.0, 5.0, 0.0, 2e-6),
    "noise and steps": ([(3.0, 1e-3), (11.0, 1e-4)], 1000.0, 5.0, 1e-6, 1e-6),
    "thirty lines": ([(float(f), 1e-4) for f in range(1, 31)], 1000.0, 10.0, 1e-6, 0.0),
    "short": ([(3.0, 1e-3)], 1000.0, 0.7, 1e-6, 1e-6),
}


@pytest.mark.parametrize("name", CASES)
def test_errors_are_as_stated(name):
    """The scatter of the derivatives is that stated; steps that are taken in order scatter less than white noise."""
    rows, rate, duration, step, noise = CASES[name]
    record, (_, velocity, acceleration) = motion(rows, rate, duration, step, noise)
    found = smooth_displacement(record)
    assert found.highest >= max(f for f, _ in rows)
    assert found.attenuation < 2e-5
    scatter = (inner(found.velocity - velocity, found), inner(found.acceleration - acceleration, found))
    for errors, stated in zip(scatter, (found.velocity_noise, found.acceleration_noise), strict=True):
        assert stated / (6.0 if "staircase" in name else 2.0) < np.std(errors) < 2.0 * stated
    assert found.noise == pytest.approx(np.hypot(noise, step / np.sqrt(12)), rel=0.3)


def test_the_ends_do_not_ring():
    """At a turning point, where reflecting the record would bend it the wrong way."""
    record, (_, velocity, acceleration) = motion([(3.0, 1e-3)], 1000.0, 2.0, 1e-6, phase=0.0)
    found = smooth_displacement(record)
    assert np.max(np.abs(found.velocity - velocity)) < 0.02 * np.max(np.abs(velocity))
    assert np.max(np.abs(found.acceleration - acceleration)) < 0.15 * np.max(np.abs(acceleration))


def test_twice_differentiated_encoder_signal():
    """The trap: two differences of steps of 1 um at 1 kHz are wrong by far more than the acceleration itself."""
    record, (_, _, acceleration) = motion([(0.1, 1e-3)], 1000.0, 20.0, 1e-6)
    found = smooth_displacement(record)
    naive = np.gradient(np.gradient(record.displacement, 1e-3), 1e-3)
    assert np.std(naive - acceleration) > 100.0 * np.std(acceleration)
    assert np.std(inner(found.acceleration - acceleration, found)) < 0.1 * np.std(acceleration)


@pytest.mark.parametrize("ratio", [0.25, 0.5, 1.0, 1.5])
def test_a_given_bandwidth_attenuates_as_stated(ratio):
    record, (displacement, _, _) = motion([(10.0, 1e-3)], 1000.0, 5.0)
    found = smooth_displacement(record, bandwidth=10.0 / ratio)
    left = np.std(inner(found.displacement, found, 8.0)) / np.std(inner(displacement, found, 8.0))
    assert left == pytest.approx(1.0 / (1.0 + ratio**8), rel=5e-3)  # |H|^2 of a Butterworth filter of order 4
    assert left == pytest.approx(gain(np.array([10.0]), 1e-3, 10.0 / ratio)[0], rel=1e-3)


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_polynomials_pass(degree):
    time = np.linspace(-1.0, 1.0, 401)
    assert low_pass(time**degree, 5e-3, 5.0) == pytest.approx(time**degree, abs=2e-4)


def test_noise_and_steps_that_are_known():
    rng = np.random.default_rng(1)
    white = rng.normal(0.0, 2e-6, 20000)
    assert noise_of(white, 1e-3).rms == pytest.approx(2e-6, rel=0.15)
    for step in (1e-6, 0.02 * 9.80665, 3.7):
        values = np.round(rng.normal(0.0, 50 * step, 5000) / step) * step
        assert resolution(values) == pytest.approx(step, rel=1e-9)
        assert resolution(values + 1e3 * step + 0.3 * step) == pytest.approx(step, rel=1e-6)
        assert resolution(values + 2e6 * step) == pytest.approx(step, rel=1e-6)  # such as 1 um, 2 m from the zero
    assert resolution(white) == 0.0
    assert resolution(np.ones(10)) == 0.0


def test_records_too_short_to_tell():
    record, _ = motion([(3.0, 1e-3)], 100.0, 0.2, 1e-6)
    found = smooth_displacement(record)
    assert found.noise == 0.0
    assert found.bandwidth == pytest.approx(40.0)
    four = smooth_displacement(Record(np.arange(4.0), np.arange(4.0), np.zeros(4)))
    assert four.velocity == pytest.approx(np.ones(4), abs=0.05)


def test_blocks_make_no_difference(monkeypatch):
    record, _ = motion([(3.0, 1e-3)], 1000.0, 2.0, 1e-6)
    whole = smooth_displacement(record)
    monkeypatch.setattr("inerter.records.smoothing._BLOCK", 333)
    parts = smooth_displacement(record)
    assert parts.acceleration == pytest.approx(whole.acceleration, abs=1e-12)


@pytest.mark.parametrize("parts", [1, 4])
@pytest.mark.parametrize("count", [2, 3, 8, 9, 20, 21, 22, 23, 60])
def test_between_samples_it_is_a_spline_of_degree_7(count, parts):
    """Weights that all even intervals share, against the recursion of de Boor in each of them."""
    rng = np.random.default_rng(count)
    values, interval = rng.normal(size=count), 10.0 ** rng.uniform(-4.0, 2.0)
    spline = make_interp_spline(interval * np.arange(count), values, min(7, count - 1 - count % 2))
    at = interval * np.arange((count - 1) * parts + 1) / parts
    found, slope = interpolate(values, interval, parts)
    assert found == pytest.approx(spline(at), abs=1e-12 * np.ptp(values))
    assert slope == pytest.approx(spline(at, 1), abs=1e-11 * np.ptp(values) / interval)


def test_what_cannot_be_smoothed():
    record, _ = motion([(3.0, 1e-3)], 100.0, 1.0)
    uneven = Record(record.time**1.1, record.displacement, record.force)
    with pytest.raises(RecordError, match=r"not evenly spaced.*resample"):
        smooth_displacement(uneven)
    with pytest.raises(RecordError, match="half the sampling rate, 50 Hz, got 60 Hz"):
        smooth_displacement(record, bandwidth=60.0)
    with pytest.raises(RecordError, match="positive number of Hz, got -1"):
        smooth_displacement(record, bandwidth=-1)


@pytest.mark.parametrize(
    ("left_out", "words"),
    [
        ([200], "1 row missing after {first:.6g} s. "),
        ([200, 201], "2 rows missing after {first:.6g} s. "),
        ([50, 51, 52, 300], "4 rows missing at 2 places, the first after {first:.6g} s, up to 3 in a row. "),
    ],
)
def test_missing_rows_are_named_with_their_places_and_what_fills_them(left_out, words):
    """Instead of a word on filters, which would resample over the holes."""
    record, _ = motion([(3.0, 1e-3)], 100.0, 5.0)
    kept = np.delete(np.arange(record.time.size), left_out)
    holed = Record(record.time[kept], record.displacement[kept], record.force[kept])
    with pytest.raises(RecordError) as error:
        smooth_displacement(holed)
    assert words.format(first=record.time[left_out[0] - 1]) in str(error.value)
    assert "--gaps fill" in "".join(map(str, as_options(error.value.args)))
    assert "resample" not in str(error.value)


def test_few_samples_in_a_period_give_the_slope():
    """Of a tone of 50 Hz at 350 Hz, where the slope of a cubic spline is 0.4 % too small."""
    record, (_, velocity, acceleration) = motion([(50.0, 1e-3)], 350.0, 2.0)
    found = smooth_displacement(record, bandwidth=140.0)
    for values, truth in ((found.velocity, velocity), (found.acceleration, acceleration)):
        inside, true = inner(values, found, 5.0), inner(truth, found, 5.0)
        assert inside @ true / (true @ true) == pytest.approx(1.0, abs=2e-5)
