"""Processing steps for a record, each of which adds a sentence to its notes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import detrend as without_line

from inerter.errors import RecordError
from inerter.formatting import format_alike, format_number, format_quantity
from inerter.records.filtering import HIGHEST, low_pass
from inerter.records.gaps import LONGEST, SCATTER, fill_missing_values, missing_rows
from inerter.records.record import CHANNELS, Record
from inerter.records.remedy import Action, Remedy
from inerter.validation import check_positive, is_number

Vector = NDArray[np.float64]
BOTH = ("displacement", "force")
MOST = 10**8  # samples of one channel


def detrend(record: Record, channels: tuple[str, ...] = BOTH) -> Record:
    """The record without the least-squares straight line of each of these channels.

    Over whole periods it takes drift and offset alone; over less, part of the motion too.

    Raises `RecordError` for an unknown channel.
    """
    changes = {role: without_line(_channel(record, role)) for role in channels}
    return record.with_notes(
        *(f"Detrended the {role}: {_span(record, role, changes[role])} subtracted." for role in channels),
        **changes,
    )


def remove_offset(
    record: Record, channels: tuple[str, ...] = BOTH, start: float | None = None, stop: float | None = None
) -> Record:
    """The record without the mean of each of these channels between `start` and `stop` [s], where it should be zero.

    By default the mean is over the whole record, or as many whole periods as there are if its period is known.

    Raises `RecordError` for an unknown channel, or fewer than 4 samples in the interval.
    """
    if start is None and stop is None and record.period and record.duration > record.period:
        start, stop = _first(record), _first(record) + math.floor(record.duration / record.period) * record.period
        stop -= 0.5 * record.interval  # the sample that begins the next period
    part = record.trim(start, stop)
    offsets = {role: float(np.mean(_channel(part, role))) for role in channels}
    return record.with_notes(
        *(
            f"Offset of the {role} removed: {format_quantity(offset, CHANNELS[role], 6)}."
            for role, offset in offsets.items()
        ),
        **{role: _channel(record, role) - offset for role, offset in offsets.items()},
    )


def reverse_force(record: Record) -> Record:
    """The record with reversed force: positive in tension, where the load cell counts compression as positive."""
    return record.with_notes("The sign of the force was reversed.", force=-record.force)


def shift_force(record: Record, delay: float) -> Record:
    """The record with the force shifted earlier by `delay` [s], by which it was recorded late (negative: early).

    Between samples a cubic spline goes through the force; samples without a partner are cut off.

    Raises `RecordError` if the record is not longer than the delay.
    """
    if not is_number(delay):
        raise RecordError(f"A delay must be a finite number of s, got {delay!r}.")
    time = record.time
    slack = 1e-6 * record.interval
    inside = (time + delay >= time[0] - slack) & (time + delay <= time[-1] + slack)
    if inside.sum() < 4:
        raise RecordError(
            f"A delay of {format_quantity(delay, 's', 6)} leaves fewer than 4 samples of "
            f"{format_quantity(record.duration, 's', 6)}."
        )
    force = CubicSpline(time, record.force)(time[inside] + delay)
    others = {role: values[inside] for role, values in record.channels().items() if role != "force"}
    return record.with_notes(f"The force was moved {format_quantity(delay, 's', 6)} earlier.", **others, force=force)


def resample(record: Record, interval: float | None = None) -> Record:
    """The record on even times, `interval` [s] apart (default: the median interval).

    For longer intervals a zero-phase anti-aliasing filter at 0.4 of the new rate is applied first. A cubic spline gives
    the values between samples.

    Raises `RecordError` for an interval that is not positive, or leaves fewer than 4 samples or more than 1e8.
    """
    usual = float(np.median(np.diff(record.time)))
    step = usual if interval is None else interval
    check_positive(RecordError, "The interval between samples", step, "s")
    count = math.floor(record.duration / step * (1.0 + 1e-9)) + 1
    if not 4 <= count <= MOST:
        raise RecordError(
            f"An interval of {format_quantity(step, 's', 6)} makes {format_number(count, 3)} samples of "
            f"{format_quantity(record.duration, 's', 6)}; between 4 and 1e8 are kept."
        )
    time: Vector = _first(record) + step * np.arange(count, dtype=float)
    before, after = format_alike([usual, step], "s", 6)
    sentence = f"Resampled from {before} (median) to {after}"
    if step <= 1.001 * usual:
        changes = {role: _spline(record.time, values, time) for role, values in _measured_channels(record).items()}
        return record.with_notes(sentence + " by a cubic spline.", time=time, **changes)
    fine: Vector = np.linspace(record.time[0], record.time[-1], round(record.duration / usual) + 1)
    bandwidth = HIGHEST / step
    changes = {}
    for role, values in _measured_channels(record).items():
        even = values if record.uniform else _spline(record.time, values, fine)
        spacing = float(fine[1] - fine[0])
        changes[role] = _spline(fine, low_pass(even, spacing, min(bandwidth, HIGHEST / spacing)), time)
    return record.with_notes(
        f"{sentence}, after a zero-phase filter at {format_quantity(bandwidth, 'Hz')}.", time=time, **changes
    )


def fill_gaps(record: Record, longest: float) -> Record:
    """The record with gaps of up to `longest` [s] in its times filled by a cubic spline.

    Raises `RecordError` if a gap is longer.
    """
    check_positive(RecordError, "The longest gap to fill", longest, "s")
    steps = np.diff(record.time)
    usual = float(np.median(steps))
    left_out = np.maximum(np.round(steps / usual).astype(int) - 1, 0)
    if not left_out.any():
        return record.with_notes("The times have no gaps to fill.")
    if np.max(steps) > longest:
        at = format_quantity(float(record.time[int(np.argmax(steps))]), "s", 6)
        gap, limit = format_alike([float(np.max(steps)), longest], "s")
        raise RecordError(
            f"{record.source!r} has a gap of {gap} after {at}, longer than the limit of {limit}. "
            f"Trim the record to one side of the gap."
        )
    parts = [np.linspace(a, b, n + 2)[:-1] for a, b, n in zip(record.time, record.time[1:], left_out, strict=False)]
    time = np.append(np.concatenate(parts), record.time[-1])
    new = ~np.isin(time, record.time)
    changes = {role: _interpolate_new(time, values, new) for role, values in _measured_channels(record).items()}
    count, most = int(new.sum()), int(left_out.max())
    note = f"Samples missing in the times, interpolated: {count}, up to {most} in a row."
    return record.with_notes(note, time=time, **changes)


def with_missing_times(record: Record, gaps: str | float) -> Record:
    """The record as `read_record(..., gaps=gaps)` returns it: with rows missing in an even clock filled, or without.

    "longest" keeps the longest part without missing rows, and "refuse" the unchanged record.

    Raises `RecordError` where more samples are missing at one place than `gaps` allows to fill.
    """
    if gaps == "refuse" or record.uniform:
        return record
    missing = missing_rows(record.time)
    if missing is None:
        return record
    if gaps == "longest":
        cuts = [0, *(missing.after + 1).tolist(), record.time.size]
        start, stop = max(pairwise(cuts), key=lambda part: part[1] - part[0])
        said = f"Samples {start} to {stop - 1} were kept: the longest part without gaps in the times."
        return record.samples(slice(start, stop), said)
    steps = np.diff(record.time)
    limit = (LONGEST + 1) * float(np.median(steps)) if isinstance(gaps, str) else float(gaps)
    most = int(np.argmax(steps))
    if steps[most] > limit * (1.0 + SCATTER):
        raise RecordError(
            f"{record.source}: {missing.counts.max()} samples are missing in the times after "
            f"{format_quantity(record.time[most], 's', 6)}, too many to interpolate (at most "
            f"{format_quantity(limit, 's', 6)}). Use ",
            *(Remedy(Action.GAPS, "longest"), ", or a longer limit in s if interpolation is acceptable."),
        )
    return fill_gaps(record, float(steps[most]))


def _interpolate_new(time: Vector, values: Vector, new: NDArray[np.bool_]) -> Vector:
    spread = np.zeros(time.size)
    spread[~new] = values
    return fill_missing_values(time, spread, new)


def _spline(time: Vector, values: Vector, at: Vector) -> Vector:
    result: Vector = CubicSpline(time, values)(np.clip(at, time[0], time[-1]))
    return result


def _measured_channels(record: Record) -> dict[str, Vector]:
    return {role: values for role, values in record.channels().items() if role != "time"}


def _channel(record: Record, role: str) -> Vector:
    channels = _measured_channels(record)
    if role not in channels:
        raise RecordError(f"{record.source!r} has no channel {role!r}; it has {', '.join(channels)}.")
    return channels[role]


def _span(record: Record, role: str, left: Vector) -> str:
    line = _channel(record, role) - left
    first, last = format_alike([line[0], line[-1]], CHANNELS[role])
    return f"{first} at the start and {last} at the end"


def _first(record: Record) -> float:
    return float(record.time[0])
