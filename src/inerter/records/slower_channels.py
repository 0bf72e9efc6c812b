"""Channels that were read at a lower rate than that of the record, and held or interpolated between readings.

Recorders that merge channels of different rates write such records. Between readings the channel contains nothing
measured: a held one is late, by half an interval of the readings on average, and a line cuts the turns of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from inerter.formatting import format_number
from inerter.records.record import Record
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
_MOST = 20  # samples from one reading to the next: less often, a triangular motion only turns
_LEAST = {"held": 1.25, "interpolated": 2.2}  # with fewer, nearly every sample changes, or no line has three of them
_FEWEST = 30  # readings
_ROUNDING = 1e-9  # of the largest value
_SLIGHT = 0.02  # of the largest second differences: what digits of a file may leave
_SECOND = 2.01  # steps that rounding may leave of a second difference
_CHANGE = 1.5  # steps, median of the changes: smaller ones are those of an encoder at constant speed
_SURE = 20.0  # minus the logarithm of the probability that other changes are as even by chance
_ELSEWHERE = 0.05  # of the changes: those that spikes may make between readings
_ASTRAY = 0.1  # samples by which ends of lines may differ from even ones, but for a few of them
_WHOLE = 1e-3  # of a sample: rates with a smaller difference from a whole ratio have that ratio


@dataclass(frozen=True)
class SlowerChannel:
    """A channel read at sample `first` and each `every` samples after it, which may be fractions of a sample."""

    first: float
    every: float
    way: Literal["held", "interpolated"]

    def positions(self, size: int) -> Vector:
        """Positions of the readings among the samples 0 to `size` - 1 of the record."""
        return np.arange(self.first, size - 1 + _WHOLE, self.every)

    def readings(self, values: Vector) -> Vector:
        """The readings of the channel, at its positions."""
        at = self.positions(values.size)
        if self.way == "held":
            held = np.ceil(at + 0.5 * min(self.every - 1.0, 1.0)).astype(int)  # well within the samples that hold it
            return np.asarray(values[np.minimum(held, values.size - 1)])
        before = np.floor(at + _WHOLE).astype(int)  # on the line that ends at the reading
        return np.asarray(values[before] + (at - before) * (values[before] - values[np.maximum(before - 1, 0)]))

    def record_readings(self, readings: Vector, size: int) -> Vector:
        """The samples that a recorder makes of readings at these positions."""
        at = self.positions(size)
        if self.way == "interpolated":
            return np.interp(np.arange(size), at, readings)
        return readings[np.clip(np.searchsorted(at, np.arange(size) + _WHOLE) - 1, 0, at.size - 1)]


def slower_channel(values: Vector) -> SlowerChannel | None:
    """The readings of a channel that is held or linear between them; None if it has the rate of the record.

    >>> slower_channel(np.repeat(np.random.default_rng(0).normal(size=100), 4))
    SlowerChannel(first=0, every=4, way='held')
    """
    step, rounding = resolution(values), _ROUNDING * float(np.max(np.abs(values)))
    first, second = np.diff(values), np.diff(values, 2)
    largest = float(np.quantile(np.abs(second), 1.0 - 0.5 / _MOST))
    ways: tuple[tuple[Literal["held", "interpolated"], Vector, float], ...] = (
        ("held", first, rounding),
        ("interpolated", second, max(rounding, _SECOND * step, _SLIGHT * largest)),
        ("interpolated", second, rounding),  # where lines are not rounded, small bends count too
    )
    for way, change, limit in ways:
        at = np.flatnonzero(np.abs(change) > limit)
        if at.size < _FEWEST or float(np.median(np.abs(change[at]))) <= _CHANGE * step:
            continue
        on_grid = _most_even(at)
        every = int(np.gcd.reduce(np.diff(on_grid)))
        if 2 <= every <= _MOST:
            return SlowerChannel(int(on_grid[0] + 1) % every, every, way)
        grid = _even_instants(np.asarray(at, dtype=float) + 1.0) if way == "held" else _even_ends(change, at)
        if grid is not None and _LEAST[way] <= grid[1] <= _MOST:
            return SlowerChannel(*grid, way)
    return None


def _most_even(at: NDArray[np.int64]) -> NDArray[np.int64]:
    """The changes at whole multiples of one interval, where few, such as those of spikes, are elsewhere; else all."""
    for every in range(_MOST, 1, -1):
        phase = at % every
        on = phase == int(np.argmax(np.bincount(phase)))
        if np.mean(on) > 1.0 - _ELSEWHERE:
            return np.asarray(at[on])
    return at


def _even_instants(changes: Vector) -> tuple[float, float] | None:
    """First instant and interval of even readings, each of which the next sample shows; None if they are not even.

    Of a rate of simple ratio to that of the record, some readings are those of a sample.
    """
    every, first, left = _even_fit(changes)
    sure = changes.size * np.log(max(every, 1.0)) > _SURE
    return _from_start(first + float(left.min()), every) if sure and np.ptp(left) < 1.0 + _ASTRAY else None


def _even_ends(second: Vector, at: NDArray[np.int64]) -> tuple[float, float] | None:
    """First instant and interval of even ends of lines; None if there are none.

    An end between two samples bends the channel at both of them, in proportion to its distance from the other.
    """
    runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    if len(runs) < _FEWEST or any(run.size > 2 or second[run[0]] * second[run[-1]] < 0.0 for run in runs):
        return None
    ends = np.array([float(second[run] @ run / second[run].sum()) for run in runs]) + 1.0
    every, first, left = _even_fit(ends)
    return _from_start(first, every) if float(np.quantile(np.abs(left), 0.9)) < _ASTRAY else None


def _even_fit(instants: Vector) -> tuple[float, float, Vector]:
    """Interval and first of the even instants nearest to these, of which some may be missing; and the differences."""
    gaps = np.diff(instants)
    every, first, left = float(np.mean(gaps[gaps < gaps.min() + 1.5])), 0.0, instants
    for _ in range(3):
        number = np.concatenate([[0.0], np.cumsum(np.maximum(np.rint(gaps / every), 1.0))])
        every, first = (float(v) for v in np.polyfit(number, instants, 1))
        left = instants - first - every * number
    return every, first, left


def _from_start(first: float, every: float) -> tuple[float, float]:
    """The first of even instants that is not before the first sample, and their interval."""
    return (first + _WHOLE) % every - _WHOLE, every


def at_readings(record: Record) -> Record:
    """The record at the readings of its slower channels alone, and other channels interpolated to them."""
    for role in ("displacement", "force"):
        found = slower_channel(getattr(record, role)) if record.uniform else None
        if found is None:
            continue
        samples = np.arange(record.time.size)
        at = found.positions(samples.size)
        channels = {name: CubicSpline(samples, values)(at) for name, values in record.channels().items()}
        channels[role] = found.readings(getattr(record, role))
        every = format_number(found.every, 4)
        said = f"The {role} was {found.way} between readings: one of every {every} samples is kept."
        record = record.with_notes(said, **channels)
    return record
