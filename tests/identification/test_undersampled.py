"""Motion faster than half the sampling rate shows is spoken of, of a rig and of a record that shows it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import inerter as it
from inerter.identification.virtual_rig import VirtualRig, highest_frequency
from inerter.records.finding_texts import RecordFinding
from inerter.records.inspection import findings

DEVICE = it.Inerter(50.0) | it.Friction(5.0)


@settings(max_examples=20, deadline=None)
@given(st.floats(1.0, 300.0), st.floats(1e-4, 1e-2), st.integers(0, 100))
def test_the_highest_frequency_of_tones(frequency: float, size: float, seed: int) -> None:
    """To the width that lines have in 4 s, beside a larger and slower tone, and of noise that is as small as said."""
    time = np.arange(8000) / 2000.0
    noise = 1e-6 * np.random.default_rng(seed).standard_normal(time.size)
    motion = 0.02 * np.sin(4.0 * time) + size * np.sin(2.0 * np.pi * frequency * time + 1.0) + noise
    assert -0.25 <= highest_frequency(motion, 1.0 / 2000.0, 3e-6) - frequency <= 4.0  # a line of the spectrum; leakage


@pytest.mark.parametrize(("sampling", "told"), [(50.0, True), (70.0, True), (200.0, False), (1000.0, False)])
def test_a_rig_that_samples_too_slowly_says_so(sampling: float, told: bool) -> None:
    rig = VirtualRig(DEVICE, sampling=sampling, table_bandwidth=80.0, force_bandwidth=100.0)
    record = rig.run(it.cosine(5e-3, 2.0) + it.cosine(2e-4, 41.0), duration=2.0)
    notes = [note for note in record.notes if "Nyquist frequency" in note]
    assert bool(notes) is told
    if told:
        assert f"{0.5 * sampling:g} Hz" in notes[0]
        assert "41" in notes[0]


@pytest.mark.parametrize(("highest", "told"), [(46.0, True), (12.0, False)])
def test_a_record_that_moves_up_to_half_its_rate_is_warned_of(highest: float, told: bool) -> None:
    """As one whose motion goes on beyond does, folded back."""
    time = np.arange(3000) * 1e-2
    frequencies = np.linspace(0.5, highest, 40)
    phases = np.random.default_rng(0).uniform(0.0, 6.28, 40)
    motion = 1e-4 * np.sum(np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases), axis=1)
    force = 1e4 * motion + 0.1 * np.random.default_rng(1).standard_normal(time.size)
    noise = 1e-7 * np.random.default_rng(2).standard_normal(time.size)
    found = findings(it.Record(time, motion + noise, force))
    assert (RecordFinding.UNDERSAMPLED in {f.kind for f in found}) is told
