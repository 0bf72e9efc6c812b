"""A load cell that cuts the force off: what it read at its limit is left out, whether the limit is stated or seen."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from troubled_rig import Device, Sensors, Tones, measured

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.recording_faults import _saturation
from inerter.records.saturation import _expected_at_turn, is_flat, plateaus, saturated_samples

MODEL = (it.Spring(1e6) | it.Damper(3200.0)) - (
    it.Inerter(it.free(1.0, 500.0, name="b")) | it.Friction(it.free(0.0, 100.0, name="f"))
)
LIMIT = 0.93  # of the largest force


CASES = [(seed, known) for seed in range(12) for known in (False, True)]


@pytest.mark.parametrize(("seed", "known"), sampled(CASES, often=[(0, True)], kept=0))
def test_a_force_that_is_cut_off_gives_the_same_device(seed: int, known: bool) -> None:
    """With all samples the friction alone would be wrong by more than its interval says."""
    random = np.random.default_rng([31, seed])
    b, f = float(random.uniform(60.0, 200.0)), float(random.uniform(5.0, 30.0))
    motion = Tones((1e-3, 3e-4), (4.0, 9.0), (0.0, float(random.uniform(0.0, 3.0))))
    sensors = Sensors(cell=300.0)
    time, displacement, force = measured(Device(b=b, f=f, ks=1e6, cs=3200.0), motion, sensors, 1.0, seed)
    limit = LIMIT * float(np.abs(force).max())
    read = np.clip(force, -limit, limit)
    record = it.Record(
        time, displacement, read, force_bandwidth=300.0, force_range=limit if known else None, source="clipped"
    )
    cut = saturated_samples(record)
    assert np.all(cut[force != read])
    assert np.count_nonzero(cut & (force == read)) <= 0.002 * force.size
    assert len(plateaus(record)) >= 1
    fit = it.identify(record, MODEL, starts=8)
    assert fit.status.ok
    for name, true in (("b", b), ("f", f)):
        low, high = fit.parameters[name].interval
        assert low - 0.5 * (high - low) < true < high + 0.5 * (high - low)


def test_the_turn_of_a_triangle_is_estimated_from_a_tenth_of_its_range() -> None:
    """Of 2 band / slope samples within the band, sqrt(step / band) are within one step of the extreme."""
    slope, peak = 0.5, 100.0
    force = peak - slope * np.abs(np.arange(-400.0, 401.0))
    for step in (0.1, 1.0):
        band = 0.1 * (peak - force.min())
        expected = 2.0 * band / slope * np.sqrt(step / band)
        assert _expected_at_turn(force, peak, step) == pytest.approx(expected, abs=2.0 * np.sqrt(step / band))


@pytest.mark.parametrize("noise", [0.0, 0.2, 0.5])
@pytest.mark.parametrize("frequencies", [(3.0,), (2.0, 5.3), (1.1, 3.7, 8.9)])
def test_a_force_that_is_flat_at_no_extreme_is_not_called_clipped(frequencies: tuple[float, ...], noise: float) -> None:
    random, time = np.random.default_rng(4), np.arange(4000) / 1000.0
    phases = random.uniform(0.0, 6.0, len(frequencies))
    smooth = 100.0 * sum(np.sin(2.0 * np.pi * f * time + p) for f, p in zip(frequencies, phases, strict=True))
    drawn = noise * random.standard_normal(time.size)
    limit = 0.8 * float(smooth.max())
    for clipped in (False, True):
        force = (np.minimum(smooth, limit) if clipped else smooth) + drawn
        assert is_flat(force, float(force.max()), noise) == clipped
        assert not is_flat(-force, float(-force.min()), noise)
        record = it.Record(time, 1e-3 * smooth, force, force_noise=noise or None)
        cause = _saturation([experiment_of(record)])
        assert (cause is not None) == clipped
        if cause is not None:
            (unknown,) = cause.unknowns
            said = cause.name.sentence(cause.details({unknown.name: limit}))
            assert "clipped above" in said
            assert "below" not in said
