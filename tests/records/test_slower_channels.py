"""Channels that were measured at a lower rate than that of the record: found, thinned, named in fits."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray
from quick_fits import explained, quick_fit

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect
from inerter.records.finding_texts import RecordFinding
from inerter.records.inspection import findings
from inerter.records.repair import repair
from inerter.records.slower_channels import slower_channel

Vector = NDArray[np.float64]
RATE, SIZE = 200.0, 1201  # [Hz], samples
INERTANCE, DAMPING = 80.0, 300.0  # [kg], [N s/m]
TIME = np.arange(SIZE) / RATE
TONES = ((2e-3, 1.3, 0.4), (7e-4, 3.7, 2.0), (3e-4, 6.1, 4.0))  # [m], [Hz], [rad]


def moved(order: int) -> Vector:
    """A derivative of the motion."""
    return np.asarray(
        sum(a * np.real((2j * np.pi * f) ** order * np.exp(1j * (2 * np.pi * f * TIME + p))) for a, f, p in TONES)
    )


def slower(values: Vector, way: str, every: int, first: int = 0) -> Vector:
    at = np.arange(SIZE)
    if way == "held":
        return values[np.maximum((at - first) // every * every + first, 0)]
    return np.asarray(np.interp(at, at[first::every], values[first::every]))


def record(way: str = "", every: int = 4, channel: str = "displacement") -> it.Record:
    """An ideal inerter beside a damper, of which one channel may be slower."""
    random = np.random.default_rng(5)
    force = INERTANCE * moved(2) + DAMPING * moved(1)
    channels = {
        "displacement": moved(0) + 1e-7 * random.standard_normal(SIZE),
        "force": force + 50.0 + 2e-3 * float(np.std(force)) * random.standard_normal(SIZE),
    }
    if way:
        channels[channel] = slower(channels[channel], way, every)
    return it.Record(TIME, **channels)


@pytest.mark.parametrize("way", ["held", "interpolated"])
@pytest.mark.parametrize(("every", "first", "step"), [(2, 1, 0.0), (3, 0, 1e-5), (7, 4, 0.0), (5, 2, 1e-6)])
def test_readings_are_found(way: str, every: int, first: int, step: float) -> None:
    random = np.random.default_rng(every)
    values = moved(0) + 2e-6 * random.standard_normal(SIZE)
    values = slower(step * np.rint(values / step) if step else values, way, every, first)
    found = slower_channel(np.array([float(f"{v:.9g}") for v in values]))  # as a file has it
    assert found is not None
    assert (found.first, found.every, found.way) == (first, every, way)


def read_at(at: Vector) -> Vector:
    """The motion at any positions among the samples."""
    phases = 2.0 * np.pi * np.multiply.outer(at / RATE, [f for _, f, _ in TONES]) + [p for *_, p in TONES]
    return np.asarray(np.cos(phases) @ [a for a, *_ in TONES])


@pytest.mark.parametrize("step", [0.0, 1e-6])
@pytest.mark.parametrize(
    ("way", "every", "first"),
    [
        ("held", 5 / 3, 0.0),
        ("held", 10 / 3, 0.0),
        ("held", 3.57, 1.3),
        ("interpolated", 10 / 3, 1.7),
        ("interpolated", 7.8125, 0.0),
    ],
)
def test_readings_are_found_at_a_rate_that_no_whole_number_divides(
    way: str, every: float, first: float, step: float
) -> None:
    """A recorder of 1000 Hz that merges a channel of 300 Hz has a reading each three or four samples."""
    random = np.random.default_rng(7)
    at = np.arange(first - 2.0 * every, SIZE + every, every)
    readings = read_at(at) + 3e-7 * random.standard_normal(at.size)
    readings = step * np.rint(readings / step) if step else readings
    samples = np.arange(SIZE)
    held = readings[np.searchsorted(at, samples + 1e-9) - 1]
    values = held if way == "held" else np.interp(samples, at, readings)
    found = slower_channel(values)
    assert found is not None
    assert found.way == way
    assert found.every == pytest.approx(every, rel=1e-4)
    assert abs((found.first - first + 0.5 * every) % every - 0.5 * every) < (0.1 if way == "interpolated" else 0.35)
    np.testing.assert_allclose(found.readings(values), np.interp(found.positions(SIZE), at, readings), atol=5e-6)
    merged = it.Record(TIME, values, np.cumsum(random.standard_normal(SIZE)))
    assert repair(merged).interval == pytest.approx(every / RATE, rel=1e-4)


@pytest.mark.parametrize("way", ["held", "interpolated"])
def test_spikes_between_readings_hide_no_slower_channel(way: str) -> None:
    random = np.random.default_rng(3)
    readings, size = random.standard_normal(200), 797
    at = np.arange(size)
    values = np.repeat(readings, 4)[:size] if way == "held" else np.interp(at, 4.0 * np.arange(200), readings)
    values[[101, 402, 703]] += 30.0
    found = slower_channel(values)
    assert found is not None
    assert (found.first, found.every, found.way) == (0, 4, way)


NATURAL = {
    "noise": np.random.default_rng(1).standard_normal(SIZE),
    "steps of an encoder": 1e-5 * np.rint(1e5 * moved(0)),
    "an encoder at constant speed": 1e-6 * np.floor(np.arange(SIZE) / 4.0),
    "a triangular motion": np.abs((TIME * 0.8) % 1.0 - 0.5),
    "rest, then motion": np.where(TIME < 3.0, 0.0, moved(1)),
    "few bits": 1e-3 * np.rint(1e3 * moved(0)),
    "a smooth signal": moved(0),
}


@pytest.mark.parametrize("name", NATURAL)
def test_other_channels_have_the_rate_of_their_record(name: str) -> None:
    assert slower_channel(NATURAL[name]) is None


@pytest.mark.parametrize(
    ("way", "channel"),
    sampled(
        [(w, c) for c in ("force", "displacement") for w in ("interpolated", "held")],
        often=[("interpolated", "force"), ("held", "displacement")],
        kept=0,
    ),
)
def test_a_fit_names_the_slower_channel_also_where_noise_may_hide_it(way: str, channel: str) -> None:
    read = record(way, channel=channel)
    told = [f for f in findings(read) if f.kind == "slower-channel"]
    assert [f.about for f in told] == [channel]
    assert f"measured at one sample in 4 only, and {way}" in told[0].sentence
    solution = quick_fit(read, MODELS["ideal-viscous"], {"b": INERTANCE, "c": DAMPING})
    found, _ = explained(solution)
    assert found[0].name is Suspect.SLOWER
    assert found[0].explained > 0.9


def test_a_fit_names_a_record_of_which_both_channels_were_interpolated() -> None:
    """Noise of the encoder, of which a spline through the readings shows no floor, passed whole to the force."""
    random, every, noise = np.random.default_rng(6), 3, 0.1
    x, force = moved(0), INERTANCE * moved(2) + DAMPING * moved(1)
    x, force = x + 1e-6 * random.standard_normal(SIZE), force + noise * random.standard_normal(SIZE)
    read = it.Record(TIME, slower(x, "interpolated", every), slower(force, "interpolated", every))
    assert experiment_of(read).noise == pytest.approx(noise, rel=0.25)
    found, _ = explained(quick_fit(read, MODELS["ideal-viscous"], {"b": INERTANCE, "c": DAMPING}))
    assert found[0].name is Suspect.SLOWER
    assert found[0].explained > 0.9


@pytest.mark.parametrize("way", ["held", "interpolated"])
def test_a_repaired_record_has_readings_alone_and_gives_the_values(way: str) -> None:
    read = repair(record(way))
    assert read.time.size == 301
    np.testing.assert_array_equal(read.force, record().force[::4])
    solution = quick_fit(read, MODELS["ideal-viscous"], {"b": INERTANCE, "c": 1.3 * DAMPING})
    space, best = solution.problem.space, solution.optimum
    errors = dict(zip(space.names, best.errors * space.slopes(best.point), strict=True))
    for name, true in (("b", INERTANCE), ("c", DAMPING)):
        assert abs(space.values_by_name(best.point)[name] - true) < 4.0 * errors[name]
    assert repair(read).time.size == read.time.size


@pytest.mark.parametrize("every", [4, 5.5])
@pytest.mark.parametrize("role", ["force", "displacement"])
@pytest.mark.parametrize("spiked", ["force", "displacement"])
def test_spikes_are_found_beside_a_slower_channel_and_in_it(every: float, role: str, spiked: str) -> None:
    """A spike of the slower channel is held like any other reading; its plateaus are no saturation."""
    random, time = np.random.default_rng(0), np.arange(4000) / 1000.0
    omega, size = 2.0 * np.pi * np.array([2.0, 5.3]), np.array([5e-3, 1e-3])
    phase = np.outer(time, omega)
    channels = {
        "displacement": np.sin(phase) @ size + 1e-7 * random.standard_normal(4000),
        "force": -100.0 * (np.sin(phase) @ (size * omega**2)) + 0.1 * random.standard_normal(4000),
    }
    at = np.minimum((np.floor(np.arange(4000) / every) * every).astype(int), 3999)
    spike = int(round(1200 / every) * every) if spiked == role else 1201
    channels[spiked][spike] += 4.0 * float(np.ptp(channels[spiked]))
    channels[role] = channels[role][at]
    found = {f.kind: f.about for f in findings(it.Record(time, **channels, force_bandwidth=100.0))}
    assert found.get(RecordFinding.SPIKES) == spiked
    assert found.get(RecordFinding.SLOWER) == role
    assert not {RecordFinding.SATURATION, RecordFinding.JOINED, RecordFinding.SWAPPED} & set(found)
