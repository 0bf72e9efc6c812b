"""Spikes, held values, joints, jitter, drifting clocks and lonely lines are found, and none in sound records."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray

from inerter.records.inspection import findings
from inerter.records.instants import held_value_instants, spike_instants
from inerter.records.record import Record
from inerter.records.repair import repair

Matrix = NDArray[np.float64]
NEW = {"spikes", "held", "joined", "hidden-jitter", "clock-drift", "hum", "line"}
TONES = ((1e-3, 3.0), (3e-4, 7.1))


def motion(time: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Displacement, velocity and acceleration of two tones."""
    x, v, a = np.zeros(time.size), np.zeros(time.size), np.zeros(time.size)
    for size, frequency in TONES:
        w = 2.0 * np.pi * frequency
        x, v = x + size * np.cos(w * time), v - size * w * np.sin(w * time)
        a = a - size * w**2 * np.cos(w * time)
    return x, v, a


def read(time: Matrix, x: Matrix, force: Matrix, seed: int) -> Record:
    random = np.random.default_rng(seed)
    x = np.rint((x + 3e-7 * random.standard_normal(x.size)) * 1e6) * 1e-6
    return Record(time, x, np.rint((force + 0.15 * random.standard_normal(x.size)) / 0.05) * 0.05)


def sound(seed: int, size: int = 4000) -> Record:
    time = np.arange(size) * 1e-3
    x, v, a = motion(time)
    return read(time, x, 100.0 * a + 10.0 * np.sign(v), seed)


def kinds(record: Record) -> set[str]:
    return {str(f.kind) for f in findings(record) if f.severity == "warning"} & NEW


def instants(seed: int, count: int) -> NDArray[np.int64]:
    """Places that are 60 samples apart."""
    return np.sort(np.random.default_rng([seed, 1]).choice(60, count, replace=False)) * 60 + 100


def with_spikes(seed: int) -> Record:
    record, at = sound(seed), instants(seed, 12)
    force = record.force.copy()
    force[at] += 150.0 * (-1.0) ** np.arange(at.size)
    return replace(record, force=force)


def with_spikes_of_the_encoder(seed: int) -> Record:
    record, at = sound(seed), instants(seed, 4)
    x = record.displacement.copy()
    for i, width in zip(at, (1, 2, 3, 1), strict=True):
        x[i : i + width] += 2e-4
    return replace(record, displacement=x)


def with_held_values(seed: int) -> Record:
    record = sound(seed)
    x, force = record.displacement.copy(), record.force.copy()
    for i, length in zip(instants(seed, 8), (4, 5, 6, 7, 8, 10, 12, 13), strict=True):
        x[i : i + length], force[i : i + length] = x[i], force[i]
    return replace(record, displacement=x, force=force)


def with_repeated_samples(seed: int) -> Record:
    """Single samples of the encoder that repeat the one before, of a recorder that misses one now and then."""
    record = sound(seed)
    at = instants(seed, 40)
    x = record.displacement.copy()
    x[at] = x[at - 1]
    return replace(record, displacement=x)


def joined(seed: int) -> Record:
    record, at = sound(seed), 1500 + 37 * seed
    cut = slice(at, at + 230)
    x, force = np.delete(record.displacement, cut), np.delete(record.force, cut)
    return Record(record.time[: x.size], x, force)


def jittering(seed: int) -> Record:
    time = np.arange(4000) * 1e-3
    late = time + 3e-4 * np.random.default_rng([seed, 2]).standard_normal(time.size)
    x, v, a = motion(late)
    return read(time, x, 100.0 * a + 10.0 * np.sign(v), seed)


def drifting(seed: int) -> Record:
    time = np.arange(4000) * 1e-3
    (x, *_), (_, v, a) = motion(time), motion(time * (1.0 - 4e-4))
    return read(time, x, 100.0 * a + 10.0 * np.sign(v), seed)


def humming(seed: int) -> Record:
    record = sound(seed)
    frequency = (88.1, 137.3, 212.1, 391.9)[seed % 4]
    return replace(record, force=record.force + 4.0 * np.sin(2.0 * np.pi * frequency * record.time))


def encoder_humming(seed: int) -> Record:
    record = sound(seed)
    hum = 3e-6 * np.sin(2.0 * np.pi * (50.03, 59.98)[seed % 2] * record.time + seed)
    return replace(record, displacement=record.displacement + hum)


FAULTS = {
    "spikes": with_spikes,
    "spikes of the encoder": with_spikes_of_the_encoder,
    "held": with_held_values,
    "held for a sample": with_repeated_samples,
    "joined": joined,
    "hidden-jitter": jittering,
    "clock-drift": drifting,
    "line": humming,
    "hum of the encoder": encoder_humming,
}


@pytest.mark.parametrize(
    ("fault", "seed"), sampled([(f, s) for f in FAULTS for s in range(6)], [(f, 0) for f in FAULTS], kept=6)
)
def test_a_fault_of_the_recorder_is_found_by_its_kind(fault: str, seed: int) -> None:
    record = FAULTS[fault](seed)
    found = [f for f in findings(record) if str(f.kind) == fault.partition(" ")[0]]
    assert found, kinds(record)
    assert all(len(f.sentence) < 400 and f.severity == "warning" for f in found)


@pytest.mark.parametrize("seed", range(2))
def test_a_repeated_sample_is_no_spike(seed: int) -> None:
    """Where the table moves fast, a sample that repeats the one before leaves the motion and comes back."""
    assert kinds(with_repeated_samples(seed)) == {"held"}
    (found,) = [f for f in findings(with_repeated_samples(seed)) if str(f.kind) == "held"]
    assert found.numbers["longest"] == 2
    assert "spikes" in kinds(with_spikes_of_the_encoder(seed))


@pytest.mark.parametrize("seed", sampled(range(20), [0, 1], kept=8))
def test_a_sound_record_has_none_of_these_faults(seed: int) -> None:
    assert kinds(sound(seed)) == set()


def test_numbers_of_the_faults() -> None:
    (found,) = [f for f in findings(with_held_values(0)) if f.about == "force" and f.severity == "warning"]
    assert found.numbers["longest"] in (13, 14)  # a value may be held that came next anyway
    (jitter,) = [f for f in findings(jittering(0)) if str(f.kind) == "hidden-jitter"]
    assert jitter.numbers["jitter"] == pytest.approx(3e-4, rel=0.1)
    (clock,) = [f for f in findings(drifting(0)) if str(f.kind) == "clock-drift"]
    assert clock.numbers["rate"] == pytest.approx(4e-4, rel=0.2)
    (line,) = [f for f in findings(humming(1)) if str(f.kind) == "line"]
    assert line.numbers["frequency"] == pytest.approx(137.3, abs=0.1)
    assert line.numbers["amplitude"] == pytest.approx(4.0, rel=0.2)
    (hum,) = [f for f in findings(encoder_humming(1)) if str(f.kind) == "hum"]
    assert hum.about == "displacement"
    assert hum.numbers["frequency"] == pytest.approx(59.98, abs=0.02)
    assert hum.numbers["amplitude"] == pytest.approx(3e-6, rel=0.05)


@pytest.mark.parametrize("frequency", [50.0, 60.0])
def test_a_motion_at_the_frequency_of_the_mains_is_no_hum(frequency: float) -> None:
    """The force follows it."""
    time = np.arange(4000) * 1e-3
    (x, v, a), w = motion(time), 2.0 * np.pi * frequency
    x, v, a = x + 3e-6 * np.sin(w * time), v + 3e-6 * w * np.cos(w * time), a - 3e-6 * w**2 * np.sin(w * time)
    assert kinds(read(time, x, 100.0 * a + 10.0 * np.sign(v), 0)) == set()


@pytest.mark.parametrize("fault", ["spikes", "spikes of the encoder", "held"])
def test_repaired_samples_are_those_that_were_replaced(fault: str) -> None:
    """Most of those are then close to the sound record, but for a friction that reverses meanwhile."""
    faulty, whole = FAULTS[fault](3), sound(3)
    repaired = repair(faulty)
    for role, noise in (("displacement", 1e-6), ("force", 0.2)):
        before, after, true = (getattr(r, role) for r in (faulty, repaired, whole))
        assert np.mean(before != after) < 0.03
        changed = before != true
        assert np.mean((before != after)[~changed]) < 0.005  # the first of those that are held is right
        if changed.any():
            left, was = (float(np.median(np.abs(values - true)[changed])) for values in (after, before))
            assert left < max(0.3 * was, noise)
    assert repair(whole).notes == ()


def test_steps_and_impacts_are_no_spikes() -> None:
    """A step, and an impact that decays through a load cell of 300 Hz at 1 kHz."""
    random = np.random.default_rng(4)
    values = 0.1 * random.standard_normal(2000)
    values[700:] += 20.0
    for at in (300, 1200, 1600):
        values[at : at + 4] += 50.0 * np.array([0.317, 0.123, -0.007, 0.0])
    assert spike_instants(values, 1) == []


def test_values_that_repeat_anyway_are_not_held() -> None:
    """Turning points of an encoder, a coarse load cell, a table that stands still, and friction without noise."""
    time = np.arange(4000) * 1e-3
    x = np.rint(1e3 * np.cos(6.0 * time)) * 1e-6
    still = np.concatenate([np.full(2000, 1e-3), x])
    coarse = np.rint(np.cos(6.0 * time) * 20.0 + 0.1 * np.random.default_rng(1).standard_normal(time.size))
    assert all(held_value_instants(values) == [] for values in (x, still, coarse, 10.0 * np.sign(np.sin(6.0 * time))))


@pytest.mark.parametrize("seed", range(8))
def test_a_table_that_has_not_begun_to_move_is_not_held(seed: int) -> None:
    """A motion that grows from rest within three seconds, or ends so, with six samples in a period."""
    random, time = np.random.default_rng([seed, 21]), np.arange(300) / 60.0
    s = np.minimum(time / 3.0, 1.0)
    x = 5e-3 * s**3 * (10.0 - 15.0 * s + 6.0 * s**2) * np.sin(2.0 * np.pi * 10.0 * time + random.uniform(0.0, 6.0))
    x = np.rint((x + 2e-7 * random.standard_normal(x.size)) * 1e6) * 1e-6
    assert held_value_instants(x) == []
    assert held_value_instants(x[::-1]) == []


def test_a_record_of_ten_seconds_between_samples_is_inspected() -> None:
    """As times in milliseconds that are read as seconds give, in which no mains hum can be seen."""
    record = sound(0, 400)
    slow = Record(1e4 * record.time, record.displacement, record.force)
    assert not {"hum", "line"} & {f.kind.value for f in findings(slow)}
