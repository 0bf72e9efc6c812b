"""A model's response to the displacement of a record, and its linear response."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

import inerter as it
from inerter.errors import LinearSystemError
from inerter.identification.response import smooth_record

SHAFT = it.Spring(1e6) | it.Damper(3200.0)
BALL_SCREW = SHAFT - (it.Inerter(113.0) | it.Friction(10.0))  # Wang and Su (2008), sec. 4.3
RATE = 1000.0


def measured(device, source, duration, seed=0, step=2e-4):
    """A record of a simulated rig: encoder of 1 um, load cell of 0.02 kg, noise of 0.3 um and 0.5 N."""
    run = it.simulate(it.Rig(device), displacement=source, duration=duration, step=step, every=round(1.0 / RATE / step))
    rng = np.random.default_rng(seed)
    x, force = (run[name] + s * rng.normal(size=run.time.size) for name, s in (("displacement", 3e-7), ("force", 0.5)))
    return it.Record(run.time, 1e-6 * np.round(x / 1e-6), 0.196 * np.round(force / 0.196))


def noise(seed, duration, rms, lowest=0.5, highest=15.0):
    count = round(duration * RATE) + 1
    pass_band = butter(4, [lowest, highest], "bandpass", fs=RATE, output="sos")
    x = sosfiltfilt(pass_band, np.random.default_rng(seed).normal(size=count))
    return it.Signal.sampled(np.arange(count) / RATE, rms / x.std() * x)


def test_the_response_to_a_sine_is_that_of_the_describing_function():
    """Friction takes j 4 f / (pi |X_b|) at the flywheel (Gelb and Vander Velde 1968), which the shaft turns a little.

    The larger the amplitude, the smaller its part, and the nearer the linear response.
    """
    omega = 2.0 * np.pi * 3.0
    shaft, b, strays = 1e6 + 3200j * omega, 113.0, []
    for amplitude in (5e-4, 1e-3, 5e-3):
        found = it.model_response(BALL_SCREW, measured(BALL_SCREW, it.cosine(amplitude, 3.0), 4.0))
        flywheel = amplitude
        for _ in range(100):
            held = -b * omega**2 + 4j * 10.0 / np.pi / flywheel
            flywheel = abs(shaft / (shaft + held)) * amplitude
        expected = shaft * held / (shaft + held)
        assert found.omega == pytest.approx([omega], rel=1e-5)
        assert np.abs(found.value / expected - 1.0) < 0.02
        strays.append(float(np.abs(found.value / it.linear_response(BALL_SCREW, omega).value - 1.0)[0]))
    assert strays == sorted(strays, reverse=True)
    assert strays[-1] < 0.07


@pytest.mark.parametrize(
    "source", [it.cosine(1e-3, 3.0), it.flat_multisine(0, 2e-4, 1.0, 20.0)], ids=["sine", "multisine"]
)
def test_the_true_model_lies_in_the_band_where_the_linear_one_does_not(source):
    record = measured(BALL_SCREW, source, 12.0)
    found, model = it.frequency_response(record), it.model_response(BALL_SCREW, record)
    linear = it.linear_response(BALL_SCREW, found.omega)
    assert model.omega == pytest.approx(found.omega, rel=1e-9)
    near = 3.0 * (found.band[1] - found.band[0]) / 2.0 + 2e-3 * found.gain
    assert np.mean(np.abs(model.gain - found.gain) < near) > 0.9
    assert np.mean(np.abs(linear.gain - found.gain) < near) < 0.5
    assert np.all(np.isinf(model.averages))
    assert np.array_equal(model.band, [model.gain, model.gain])


def test_a_random_record_by_the_same_estimator():
    record = measured(BALL_SCREW, noise(0, 30.0, 3e-4), 30.0)
    found, model = it.frequency_response(record), it.model_response(BALL_SCREW, record)
    assert np.isin(model.omega, found.omega).all()
    kept = found.lines(np.isin(found.omega, model.omega))
    assert kept.omega.size > 0.9 * found.omega.size
    assert np.median(np.abs(model.value / kept.value - 1.0)) < 0.02
    assert np.median(np.abs(model.coherence - kept.coherence)) < 0.02  # friction takes as much of it in both
    assert "Butterworth" in model.notes[0]


def test_a_linear_model_answers_its_linear_response():
    device = it.Spring(2e4) | it.Damper(300.0) - it.Inerter(40.0)
    record = measured(device, it.flat_multisine(1, 3e-4, 0.5, 20.0), 8.0)
    model = it.model_response(it.Rig(device), record)
    assert model.value == pytest.approx(it.linear_response(device, model.omega).value, rel=1e-6)
    assert it.linear_response(device, 3.0).value == pytest.approx(3j * device.admittance(3j))


def test_backlash_takes_the_force_of_small_motions():
    device = SHAFT - it.Gap(2e-4) - (it.Inerter(113.0) | it.Friction(10.0))
    small, large = (it.model_response(device, measured(device, it.cosine(size, 3.0), 4.0)) for size in (1.5e-4, 4e-3))
    assert small.gain.tolist() == [0.0]  # in the play
    assert large.gain[0] > 0.9 * it.linear_response(device, large.omega).gain[0]
    assert "Gaps closed: gap." in it.linear_response(device, 1.0).notes


def test_smoothing_takes_the_steps_of_the_encoder_and_leaves_the_motion():
    time = np.arange(5000) / RATE
    true = 1e-3 * np.sin(2.0 * np.pi * 2.0 * time)
    record = it.Record(time, 1e-6 * np.round(true / 1e-6), time)
    inner = slice(500, -500)
    error = [np.std(np.diff(r.displacement - true, 2)[inner]) for r in (record, smooth_record(record, 20.0))]
    assert error[1] < 1e-2 * error[0]
    assert np.abs(smooth_record(record, 20.0).displacement - true)[inner].max() < 2e-7
    assert "half the sampling rate" in smooth_record(record, 450.0).notes[-1]


def test_frequencies_that_are_none():
    for omega in ([0.0], [-1.0], [np.nan], [[1.0, 2.0]], "many"):
        with pytest.raises(LinearSystemError, match="positive frequencies"):
            it.linear_response(BALL_SCREW, omega)
