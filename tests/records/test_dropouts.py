"""Samples that are lost while the clock goes on: random motions with random losses, and the same without."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import inerter as it
from inerter.errors import RecordError
from inerter.records.dropouts import Dropout, fill_dropouts, find_dropouts
from inerter.records.inspection import findings

NOISE = 0.3e-6  # [m]
STEP = 1e-6  # [m] of the encoder


def bench(random: np.random.Generator, size: int = 3000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, a displacement of some tones, and its velocity; read by an encoder."""
    time = np.arange(size) * 1e-3
    frequencies = np.exp(random.uniform(np.log(0.5), np.log(12.0), random.integers(1, 6)))
    phases = random.uniform(0.0, 2.0 * np.pi, frequencies.size)
    speeds = random.uniform(0.01, 0.05, frequencies.size)
    turns = 2.0 * np.pi * np.outer(time, frequencies) + phases
    displacement = np.cos(turns) @ (speeds / (2.0 * np.pi * frequencies))
    velocity = -np.sin(turns) @ speeds
    read = displacement + NOISE * random.standard_normal(size)
    return time, STEP * np.rint(read / STEP), velocity


def cut(random: np.random.Generator) -> tuple[it.Record, list[Dropout], np.ndarray]:
    """A record that lacks some samples where the table moves fast, what it lacks, and the whole displacement."""
    time, displacement, velocity = bench(random)
    fast = np.flatnonzero(np.abs(velocity) > 0.5 * np.abs(velocity).max())
    places = np.sort(random.choice(fast[(fast > 100) & (fast < 2800)], 2, replace=False))
    while np.diff(places)[0] < 60:
        places = np.sort(random.choice(fast[(fast > 100) & (fast < 2800)], 2, replace=False))
    counts = random.integers(2, 9, 2)
    kept = np.ones(time.size, dtype=bool)
    for place, count in zip(places, counts, strict=True):
        kept[place : place + count] = False
    lost = [
        Dropout(int(places[0]) - 1, int(counts[0])),
        Dropout(int(places[1]) - 1 - int(counts[0]), int(counts[1])),
    ]
    whole = displacement
    force = np.sin(3.0 * time)
    return it.Record(time[: kept.sum()], whole[kept], force[kept], source="cut"), lost, whole


@pytest.mark.parametrize("seed", range(60))
def test_every_loss_is_found_with_its_count_and_put_in_again(seed: int) -> None:
    random = np.random.default_rng([7, seed])
    record, lost, whole = cut(random)
    assert find_dropouts(record) == lost
    filled = fill_dropouts(record, "fill")
    assert filled.time.size == whole.size
    assert np.abs(filled.displacement - whole).max() < 10.0 * STEP
    assert np.ptp(np.diff(filled.time)) < 1e-9
    assert find_dropouts(filled) == []


@pytest.mark.parametrize("seed", range(60))
def test_a_whole_record_lacks_nothing(seed: int) -> None:
    """Motions, spikes, steps and pauses of the table are no lost samples."""
    random = np.random.default_rng([8, seed])
    time, displacement, _ = bench(random)
    place = int(random.integers(200, 2800))
    spoilt = [displacement, displacement.copy(), displacement.copy(), displacement.copy()]
    spoilt[1][place] += 1e-3
    spoilt[2][place:] += 1e-3
    spoilt[3][place:] = displacement[place]
    for values in spoilt:
        assert find_dropouts(it.Record(time, values, np.sin(time))) == []


def test_what_is_done_about_them(tmp_path: Path) -> None:
    record, lost, _ = cut(np.random.default_rng(3))
    path = tmp_path / "cut.csv"
    it.write_record(record, path)
    left = it.read_record(path)
    found = next(finding for finding in findings(left) if finding.kind == "lost-samples")
    assert found.severity == "warning"
    assert f"about {sum(loss.count for loss in lost)} samples" in found.sentence
    filled = it.read_record(path, gaps="fill")
    assert filled.time.size == record.time.size + sum(loss.count for loss in lost)
    assert "interpolated" in filled.notes[-1]
    longest = it.read_record(path, gaps="longest")
    parts = np.diff([0, *(loss.after + 1 for loss in lost), record.time.size])
    assert longest.time.size == parts.max()
    with pytest.raises(RecordError, match="too many to interpolate"):
        it.read_record(path, gaps=1e-3)
