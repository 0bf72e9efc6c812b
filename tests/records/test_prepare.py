"""Each preparation does what its note says, and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bench import bench
from hypothesis import given, settings
from hypothesis import strategies as st

from inerter.errors import RecordError
from inerter.records import prepare
from inerter.records.record import Record

T = np.arange(2000) * 1e-3
OMEGA = 2.0 * np.pi * 3.0
SMOOTH = Record(T, 1e-3 * np.cos(OMEGA * T), 50.0 * np.sin(OMEGA * T), acceleration=np.cos(OMEGA * T))


def test_detrend_takes_a_line():
    drifting = replace(SMOOTH, force=SMOOTH.force + 3.0 + 2.0 * T)
    done = prepare.detrend(drifting, ("force",))
    assert np.polyfit(T, done.force, 1) == pytest.approx([0.0, 0.0], abs=1e-9)
    assert done.displacement is drifting.displacement
    assert done.notes[-1].startswith("Detrended the force: ")


def test_offsets_over_whole_periods_or_a_stretch():
    shifted = replace(SMOOTH.trim(0.0, 0.9), period=1.0 / 3.0)
    shifted = replace(shifted, force=shifted.force + 7.0)
    done = prepare.remove_offset(shifted, ("force",))
    assert done.force == pytest.approx(shifted.force - 7.0, abs=0.1)
    part = prepare.remove_offset(shifted, ("force",), 0.0, 0.1)
    assert np.mean(part.trim(0.0, 0.1).force) == pytest.approx(0.0, abs=1e-12)


def test_reversing_twice_changes_nothing():
    twice = prepare.reverse_force(prepare.reverse_force(SMOOTH))
    assert np.array_equal(twice.force, SMOOTH.force)
    assert len(twice.notes) == 2


@settings(max_examples=20)
@given(st.floats(-0.1, 0.1))
def test_shifting_moves_the_force_alone(delay):
    late = replace(SMOOTH, force=50.0 * np.sin(OMEGA * (T - delay)))
    done = prepare.shift_force(late, delay)
    assert done.force == pytest.approx(50.0 * np.sin(OMEGA * done.time), abs=1e-5)
    assert done.displacement == pytest.approx(1e-3 * np.cos(OMEGA * done.time), abs=1e-12)
    assert done.time.size == T.size - np.ceil(abs(delay) / 1e-3 - 1e-6)


@pytest.mark.parametrize("interval", [0.4e-3, 1e-3, 1.7e-3, 5e-3])
def test_resampling_keeps_a_slow_motion(interval):
    done = prepare.resample(SMOOTH, interval)
    assert done.interval == pytest.approx(interval)
    inside = (done.time > 0.1) & (done.time < 1.8)
    for role, f in (
        ("displacement", lambda t: 1e-3 * np.cos(OMEGA * t)),
        ("acceleration", lambda t: np.cos(OMEGA * t)),
    ):
        values, true = done.channels()[role], f(done.time)
        assert values[inside] == pytest.approx(true[inside], abs=2e-6 * np.max(np.abs(true)))


def test_resampling_lets_nothing_alias():
    """At 10 ms, 80 Hz would come back as 20 Hz; what the filter lets through is what its gain says."""
    fast = replace(SMOOTH, force=50.0 * np.sin(2 * np.pi * 80.0 * T))
    done = prepare.resample(fast, 10e-3)
    assert np.std(done.force[10:-10]) < 0.006 * np.std(fast.force)
    assert np.std(fast.force[::10]) > 0.9 * np.std(fast.force)


def test_uneven_times_become_even():
    uneven = T + 2e-4 * np.sin(40.0 * T)
    record = Record(uneven, np.cos(OMEGA * uneven), np.sin(OMEGA * uneven))
    done = prepare.resample(record)
    assert done.uniform
    assert done.displacement == pytest.approx(np.cos(OMEGA * done.time), abs=1e-7)


def test_gaps_in_the_times_are_filled():
    kept = np.delete(np.arange(2000), [50, 700, 701, 702])
    record = SMOOTH.with_notes(**{role: values[kept] for role, values in SMOOTH.channels().items()})
    done = prepare.fill_gaps(record, 0.01)
    assert done.time == pytest.approx(T)
    assert done.displacement == pytest.approx(SMOOTH.displacement, abs=1e-9)
    assert done.notes[-1] == "Samples missing in the times, interpolated: 4, up to 3 in a row."
    with pytest.raises(RecordError, match=r"gap of 4 ms after 0\.699 s, longer than the limit of 3 ms"):
        prepare.fill_gaps(record, 0.003)
    assert prepare.fill_gaps(SMOOTH, 0.01).notes[-1].startswith("The times have no gaps")


def test_what_cannot_be_prepared():
    for work, said in (
        (lambda: prepare.detrend(SMOOTH, ("velocity",)), "has no channel 'velocity'; it has displacement, force, acc"),
        (lambda: prepare.shift_force(SMOOTH, 3.0), "leaves fewer than 4 samples"),
        (lambda: prepare.shift_force(SMOOTH, np.nan), "finite number of s"),
        (lambda: prepare.resample(SMOOTH, 0.0), "positive number of s"),
        (lambda: prepare.resample(SMOOTH, 1.0), "between 4 and 1e8 are kept"),
        (lambda: prepare.resample(SMOOTH, 1e-12), "between 4 and 1e8 are kept"),
        (lambda: prepare.fill_gaps(SMOOTH, -1), "positive number of s"),
        (lambda: prepare.remove_offset(SMOOTH, ("force",), 5.0, 6.0), "has 0 samples"),
    ):
        with pytest.raises(RecordError, match=said):
            work()


def test_parts_of_a_record():
    record = bench()
    fit, check = record.split(0.7)
    assert np.array_equal(np.concatenate((fit.force, check.force)), record.force)
    assert record.trim(0.2, 0.4).time == pytest.approx(record.time[100:201])
    with pytest.raises(RecordError, match="a part is too short"):
        record.samples(slice(0, 6)).split(0.7)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_delay_may_leave_four_samples_and_no_fewer(sign):
    time = 1e-3 * np.arange(20)
    record = Record(time, 1e-3 * np.cos(300.0 * time), np.sin(300.0 * time))
    assert prepare.shift_force(record, sign * 16e-3).time.size == 4
    with pytest.raises(RecordError, match="fewer than 4 samples"):
        prepare.shift_force(record, sign * 17e-3)


def test_the_old_name_of_with_notes_works_with_a_warning():
    with pytest.warns(DeprecationWarning, match="`noted` is now `with_notes`"):
        noted = SMOOTH.noted("Checked.", force_noise=0.5)
    assert noted.notes[-1] == "Checked."
    assert noted.force_noise == 0.5
