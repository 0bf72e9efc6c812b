"""Small changes to a record, each of which leaves a sentence in its notes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import detrend as without_line

from inerter.checks import is_number
from inerter.errors import RecordError
from inerter.records.filtering import HIGHEST, low_pass
from inerter.records.gaps import LONGEST, SCATTER, fill, missing_rows
from inerter.records.record import CHANNELS, Record
from inerter.records.remedy import Action, Remedy

Vector = NDArray[np.float64]
BOTH = ("displacement", "force")
MOST = 10**8  # samples of one channel


def detrend(record: Record, channels: tuple[str, ...] = BOTH) -> Record:
    """Without the straight line of least squares through each of these channels.

    Over whole periods it takes drift and offset alone; over less, part of the motion too.

    Raises `RecordError` for a channel that is not there.
    """
    changes = {role: without_line(_channel(record, role)) for role in channels}
    return record.noted(
        *(f"Detrended the {role}: {_span(record, role, changes[role])} were taken away." for role in channels),
        **changes,
    )


def remove_offset(
    record: Record, channels: tuple[str, ...] = BOTH, start: float | None = None, stop: float | None = None
) -> Record:
    """Without the mean of each of these channels, taken from `start` to `stop` [s]: a stretch where it should be zero.

    By default the mean is over the whole record, or as many whole periods as there are if its period is known.

    Raises `RecordError` for a channel that is not there, or fewer than 4 samples in the stretch.
    """
    if start is None and stop is None and record.period and record.duration > record.period:
        start, stop = _first(record), _first(record) + math.floor(record.duration / record.period) * record.period
        stop -= 0.5 * record.interval  # the sample that begins the next period
    part = record.trim(start, stop)
    offsets = {role: float(np.mean(_channel(part, role))) for role in channels}
    return record.noted(
        *(f"Offset of the {role} removed: {offset:.6g} {CHANNELS[role]}." for role, offset in offsets.items()),
        **{role: _channel(record, role) - offset for role, offset in offsets.items()},
    )


def reverse_force(record: Record) -> Record:
    """With the force of the other sign: positive in tension, where the load cell counts compression."""
    return record.noted("The sign of the force was reversed.", force=-record.force)


def shift_force(record: Record, delay: float) -> Record:
    """With the force moved earlier by `delay` [s], by which it was recorded late (negative: early).

    Between samples a cubic spline goes through the force; samples without a partner are cut off.

    Raises `RecordError` if the record is not longer than the delay.
    """
    if not is_number(delay):
        raise RecordError(f"A delay must be a finite number of s, got {delay!r}.")
    time = record.time
    slack = 1e-6 * record.interval
    inside = (time + delay >= time[0] - slack) & (time + delay <= time[-1] + slack)
    if inside.sum() < 4:
        raise RecordError(f"A delay of {delay:g} s leaves fewer than 4 samples of {record.duration:g} s.")
    force = CubicSpline(time, record.force)(time[inside] + delay)
    others = {role: values[inside] for role, values in record.channels().items() if role != "force"}
    return record.noted(f"The force was moved {delay:.6g} s earlier.", **others, force=force)


def resample(record: Record, interval: float | None = None) -> Record:
    """On even times, `interval` [s] apart (by default the median of the intervals there are).

    For longer intervals a zero-phase filter first takes away what the new samples cannot hold: above 0.4 of their
    rate. A cubic spline gives the values between samples.

    Raises `RecordError` for an interval that is not positive, or leaves fewer than 4 samples or more than 1e8.
    """
    usual = float(np.median(np.diff(record.time)))
    step = usual if interval is None else interval
    if not is_number(step) or step <= 0.0:
        raise RecordError(f"The interval between samples must be a positive number of s, got {interval!r}.")
    count = math.floor(record.duration / step * (1.0 + 1e-9)) + 1
    if not 4 <= count <= MOST:
        raise RecordError(
            f"An interval of {step:g} s makes {count:.3g} samples of {record.duration:g} s; between 4 and 1e8 are kept."
        )
    time: Vector = _first(record) + step * np.arange(count, dtype=float)
    sentence = f"Resampled from {usual:.6g} s (median) to {step:.6g} s"
    if step <= 1.001 * usual:
        changes = {role: _spline(record.time, values, time) for role, values in _measured(record).items()}
        return record.noted(sentence + " by a cubic spline.", time=time, **changes)
    fine: Vector = np.linspace(record.time[0], record.time[-1], round(record.duration / usual) + 1)
    bandwidth = HIGHEST / step
    changes = {}
    for role, values in _measured(record).items():
        even = values if record.uniform else _spline(record.time, values, fine)
        spacing = float(fine[1] - fine[0])
        changes[role] = _spline(fine, low_pass(even, spacing, min(bandwidth, HIGHEST / spacing)), time)
    return record.noted(f"{sentence}, after a zero-phase filter at {bandwidth:.4g} Hz.", time=time, **changes)


def fill_gaps(record: Record, longest: float) -> Record:
    """With samples put in where the times leave some out, for up to `longest` [s], by a cubic spline.

    Raises `RecordError` if a gap is longer.
    """
    if not is_number(longest) or longest <= 0.0:
        raise RecordError(f"The longest gap to fill must be a positive number of s, got {longest!r}.")
    steps = np.diff(record.time)
    usual = float(np.median(steps))
    left_out = np.maximum(np.round(steps / usual).astype(int) - 1, 0)
    if not left_out.any():
        return record.noted("There were no gaps in the times to fill.")
    if np.max(steps) > longest:
        at = float(record.time[int(np.argmax(steps))])
        raise RecordError(
            f"{record.source!r} has a gap of {np.max(steps):g} s after {at:g} s, longer than the {longest:g} s "
            f"to fill. Trim the record to one side of it."
        )
    parts = [np.linspace(a, b, n + 2)[:-1] for a, b, n in zip(record.time, record.time[1:], left_out, strict=False)]
    time = np.append(np.concatenate(parts), record.time[-1])
    new = ~np.isin(time, record.time)
    changes = {role: _filled(time, values, new) for role, values in _measured(record).items()}
    count, most = int(new.sum()), int(left_out.max())
    note = f"Samples that the times leave out and were interpolated: {count}, up to {most} in a row."
    return record.noted(note, time=time, **changes)


def with_missing_times(record: Record, gaps: str | float) -> Record:
    """The record as `read_record(..., gaps=gaps)` gives it: with the samples that an even clock leaves out, or without.

    "longest" keeps the longest stretch that leaves none out, and "refuse" the record as it is.

    Raises `RecordError` where more samples are left out at one place than `gaps` allows to put in.
    """
    if gaps == "refuse" or record.uniform:
        return record
    missing = missing_rows(record.time)
    if missing is None:
        return record
    if gaps == "longest":
        cuts = [0, *(missing.after + 1).tolist(), record.time.size]
        start, stop = max(pairwise(cuts), key=lambda part: part[1] - part[0])
        said = f"Samples {start} to {stop - 1} were kept: the longest stretch in which the times leave none out."
        return record.samples(slice(start, stop), said)
    steps = np.diff(record.time)
    limit = (LONGEST + 1) * float(np.median(steps)) if isinstance(gaps, str) else float(gaps)
    most = int(np.argmax(steps))
    if steps[most] > limit * (1.0 + SCATTER):
        raise RecordError(
            f"{record.source}: the times leave out {missing.counts.max()} samples after {record.time[most]:g} s, too "
            f"many to put in ({limit:g} s at most). Use ",
            *(Remedy(Action.GAPS, "longest"), ", or a number of s if you trust an interpolation."),
        )
    return fill_gaps(record, float(steps[most]))


def _filled(time: Vector, values: Vector, new: NDArray[np.bool_]) -> Vector:
    spread = np.zeros(time.size)
    spread[~new] = values
    return fill(time, spread, new)


def _spline(time: Vector, values: Vector, at: Vector) -> Vector:
    result: Vector = CubicSpline(time, values)(np.clip(at, time[0], time[-1]))
    return result


def _measured(record: Record) -> dict[str, Vector]:
    return {role: values for role, values in record.channels().items() if role != "time"}


def _channel(record: Record, role: str) -> Vector:
    channels = _measured(record)
    if role not in channels:
        raise RecordError(f"{record.source!r} has no channel {role!r}; it has {', '.join(channels)}.")
    return channels[role]


def _span(record: Record, role: str, left: Vector) -> str:
    line = _channel(record, role) - left
    return f"{line[0]:.4g} {CHANNELS[role]} at the start and {line[-1]:.4g} {CHANNELS[role]} at the end"


def _first(record: Record) -> float:
    return float(record.time[0])
