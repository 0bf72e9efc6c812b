"""Forces of devices moved as a record was read, and its sensors' errors, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from quick_fits import quick_fit

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.models import MODELS, on_rig
from inerter.identification.sensors import encoder_noise
from inerter.systems.piecewise import piecewise


@pytest.mark.parametrize(("per_period", "accuracy"), [(7.0, 3e-5), (12.0, 1e-5)])
def test_the_force_of_an_elastic_device_of_few_samples_in_a_period(per_period: float, accuracy: float) -> None:
    """Moved by a sine just below its resonance, behind a load cell; cubics between the samples are 0.4 % off at 7."""
    frequency, ks, cs, b, bandwidth = 9.0, 8e5, 3000.0, 150.0, 60.0
    time = np.arange(300) / (per_period * frequency)
    omega = 2.0 * np.pi * frequency
    s = 1j * omega
    admittance = 1.0 / (1.0 / (cs + ks / s) + 1.0 / (b * s))
    w = 2.0 * np.pi * bandwidth
    gain = s * admittance * w**2 / (s**2 + np.sqrt(2.0) * w * s + w**2)
    displacement, force = 1e-3 * np.sin(omega * time), 1e-3 * np.imag(gain * np.exp(s * time))
    record = it.Record(time, displacement, force, force_bandwidth=bandwidth)
    device = (it.Spring(ks) | it.Damper(cs)) - it.Inerter(b)
    model = experiment_of(record, bandwidth=0.4 / record.interval).force(piecewise(on_rig(device, bandwidth)))
    assert model is not None
    late = slice(150, 280)  # the start from rest has decayed
    basis = np.column_stack([np.sin(omega * time), np.cos(omega * time)])[late]
    found, true = (np.linalg.lstsq(basis, values[late], rcond=None)[0] for values in (model, force))
    assert np.linalg.norm(found - true) < accuracy * np.linalg.norm(true)


@pytest.mark.parametrize("per_period", [7.0, 12.0])
def test_the_force_of_a_rigid_inerter_follows_its_accelerations(per_period: float) -> None:
    """At the samples of a sine; with the knots of other devices it is off by 4e-3."""
    frequency, b = 9.0, 150.0
    time = np.arange(300) / (per_period * frequency)
    omega = 2.0 * np.pi * frequency
    displacement = 1e-3 * np.sin(omega * time)
    record = it.Record(time, displacement, -b * omega**2 * displacement)
    experiment = experiment_of(record, bandwidth=0.4 / record.interval, rigid=True)
    model = experiment.force(piecewise(on_rig(it.Inerter(b), None)))
    assert model is not None
    assert np.max(np.abs(model - record.force)[30:270]) < 5e-4 * np.max(record.force)


@pytest.mark.parametrize(("rate", "count"), [(60.0, 400), (60.0, 3000), (500.0, 3000)])
def test_the_noise_of_an_encoder(rate: float, count: int) -> None:
    """Estimated from what the filter of the displacement removes: with few samples in a period a fifth of it."""
    time = np.arange(count) / rate
    motion = 2e-3 * np.sin(2.0 * np.pi * 4.3 * time) + 1e-3 * np.sin(2.0 * np.pi * 1.1 * time)
    found = [
        encoder_noise(experiment_of(it.Record(time, motion + noise, np.gradient(motion))))
        for noise in 5e-7 * np.random.default_rng(5).standard_normal((72 if count < 1000 else 24, count))
    ]
    assert np.median(found) == pytest.approx(5e-7, rel=0.03)


@pytest.mark.parametrize("per_period", [6.0, 8.0, 15.0])
def test_samples_at_the_end_that_rest_on_no_later_ones_are_not_compared(per_period: float) -> None:
    """Of a rigid inerter in motion: accelerations there are wrong by as much as they are large."""
    rate, frequencies = 100.0, np.array([0.31, 0.62, 1.0]) * 100.0 / per_period
    time, omega = np.arange(400) / rate, 2.0 * np.pi * frequencies
    turning = 1e-3 * np.exp(1j * (np.outer(time, omega) + np.array([0.3, 1.1, 2.0])))
    force = -50.0 * np.sum(turning.real * omega**2, axis=1)
    experiment = experiment_of(it.Record(time, np.sum(turning.real, axis=1), force))
    wrong = np.abs(50.0 * experiment.motion.acceleration - force)
    assert np.max(wrong[experiment.kept]) < 0.01 * np.std(force)
    assert np.mean(experiment.kept) > 0.85


def test_a_record_that_begins_at_a_turning_point_does_not_begin_at_rest() -> None:
    """Nor does one that begins in motion; a ramp from rest does, with noise that moves its first samples."""
    time = np.arange(500) / 100.0
    share = np.minimum(time / 0.5, 1.0)
    ramp = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    noise = 2e-7 * np.random.default_rng(0).standard_normal(500)
    moved = 1e-3 * np.cos(2.0 * np.pi * 3.0 * time) + 4e-4 * np.cos(2.0 * np.pi * 7.0 * time)
    late = 1e-3 * np.sin(2.0 * np.pi * 3.0 * time)
    begins = [experiment_of(it.Record(time, x + noise, moved)).kept[0] for x in (moved, late, ramp * late)]
    assert begins == [False, False, True]


@pytest.mark.parametrize("seed", range(4))
def test_a_true_model_of_a_short_record_is_within_noise_up_to_its_ends(seed: int) -> None:
    """Of a hundred samples more than a tenth at either end are left out, where the motion rests on a continuation."""
    random, time = np.random.default_rng([seed, 37]), np.arange(97) / 20.0
    omega, phase = 2.0 * np.pi * np.array([0.9, 1.9]), random.uniform(0.0, 6.28, 2)
    tones = np.array([8e-3, 4e-3]) * np.exp(1j * (np.outer(time, omega) + phase))
    x, v, a = (np.sum(((1j * omega) ** order * tones).real, axis=1) for order in range(3))
    force = 100.0 * a + 200.0 * v
    noise = 1.5e-3 * float(np.abs(force).max())
    read = force + noise * random.standard_normal(97)
    record = it.Record(time, x + 1e-7 * random.standard_normal(97), read, force_noise=noise)
    solution = quick_fit(record, MODELS["ideal-viscous"], {"b": 100.0, "c": 200.0})
    assert solution.misfit.is_noise_limited, solution.misfit


def test_the_motion_of_a_delay_is_computed_once() -> None:
    """A fit without the bandwidth of the load cell has one delay in most of its simulations."""
    time = np.arange(600) / 200.0
    record = it.Record(time, 1e-3 * np.sin(9.0 * time), -8.0 * np.sin(9.0 * time))
    e, alike = (experiment_of(record, rigid=True) for _ in range(2))
    other = replace(e, kept=~e.kept)
    late, again = e.with_delay(5e-3), other.with_delay(5e-3)
    assert again.table_in(32) is late.table_in(32)
    assert np.array_equal(again.kept, ~e.kept)
    fresh = alike.with_delay(5e-3).with_delay(5e-3)  # delayed twice
    assert np.array_equal(late.with_delay(5e-3).motion.displacement, fresh.motion.displacement)
    assert not np.array_equal(late.motion.displacement, fresh.motion.displacement)
    for n in range(20):
        e.with_delay(1e-4 * n)
    assert len(e.delayed) <= 6
    assert not e.with_motion(e.motion.displacement, e.motion.velocity).delayed
