"""Errors that are drawn like those of an encoder, against readings of an encoder by its definition."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray

import inerter as it
from inerter.identification.experiment import Experiment, experiment_of
from inerter.identification.sensors import periodic_displacement, simulate_measurement

READINGS = 150
INTERVAL = 1e-3  # [s]


def starting(random: np.random.Generator) -> tuple[NDArray[np.float64], int]:
    """A motion [m] from rest that does not repeat within the record, and the sample at which it starts."""
    wait, time = int(random.integers(0, 400)) * int(random.integers(0, 2)), INTERVAL * np.arange(1200)
    moved = np.zeros(time.size)
    for frequency, amplitude in ((random.uniform(0.3, 0.6), 3e-2), (random.uniform(4.0, 9.0), 1e-3)):
        moved += amplitude * (1.0 - np.cos(2.0 * np.pi * frequency * np.maximum(time - INTERVAL * wait, 0.0)))
    return moved, wait


def since_the_start(motions: list[NDArray[np.float64]], among: slice) -> float:
    """R.m.s. of how far the way from the first sample on scatters."""
    ways = np.array([motion[among] - motion[0] for motion in motions])
    return float(np.sqrt(np.mean(np.var(ways, axis=0))))


def read(motion: NDArray[np.float64], step: float, noise: float, random: np.random.Generator) -> NDArray[np.float64]:
    """By an encoder that may stand anywhere between two of its steps."""
    at = motion + step * random.uniform(0.0, 1.0)
    return np.asarray(step * np.rint((at + noise * random.standard_normal(at.size)) / step) - at + motion)


def experiment(motion: NDArray[np.float64], step: float, noise: float, random: np.random.Generator) -> Experiment:
    at = motion + step * random.uniform(0.0, 1.0)
    taken = step * np.rint((at + noise * random.standard_normal(at.size)) / step)
    known = float(np.hypot(noise, step / np.sqrt(12.0)))
    time, force = np.asarray(INTERVAL * np.arange(motion.size, dtype=np.float64)), np.gradient(motion)
    return experiment_of(it.Record(time, taken, force, source="encoder", displacement_noise=known))


@pytest.mark.parametrize("seed", sampled(range(8), [0], kept=1))
def test_where_a_table_starts_is_as_uncertain_as_the_encoder_reads(seed: int) -> None:
    """What a gap is told by first is the way to its first contact; that is read from one step of the encoder on."""
    random = np.random.default_rng([11, seed])
    step = 10.0 ** random.uniform(-6.3, -5.3)
    noise = step * random.uniform(0.05, 0.4)
    motion, wait = starting(random)
    given = experiment(motion, step, noise, random)
    drawn = [
        simulate_measurement(given, periodic_displacement(given), given.record.force, random).motion.displacement
        for _ in range(READINGS)
    ]
    true = [given.motion.smooth(read(motion, step, noise, random))[0] for _ in range(READINGS)]
    among = slice(wait + 3, wait + 40)
    assert since_the_start(drawn, among) == pytest.approx(since_the_start(true, among), rel=0.25)


@pytest.mark.parametrize("fastest", [40.0, 100.0])
def test_rounding_is_drawn_again_where_few_samples_in_a_period_leave_it_in_the_smoothed_motion(fastest: float) -> None:
    """A filter that passes most errors leaves the motion near the steps that were read, where none would be drawn."""
    random = np.random.default_rng(12)
    step, time = 1e-6, INTERVAL * np.arange(1200)
    motion = 2e-4 * (1.0 - np.cos(71.0 * time)) + 3e-5 * (1.0 - np.cos(2.0 * np.pi * fastest * time))
    given = experiment(motion, step, 0.05 * step, random)
    true = given.motion.smooth(motion)[0]
    drawn = simulate_measurement(given, periodic_displacement(given), given.record.force, random).motion
    again = drawn.displacement - given.motion.smooth(given.motion.displacement)[0]
    among = slice(100, 1100)
    expected = given.motion.smooth(read(motion, step, 0.05 * step, random))[0] - true
    assert np.std(again[among]) == pytest.approx(np.std(expected[among]), rel=0.2)
