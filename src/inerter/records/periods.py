"""Periodic records: their period, and the whole periods of a record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.formatting import format_alike, format_number
from inerter.records.record import Record

Matrix = NDArray[np.float64]
_REPEATS = 0.02  # difference from one period to the next, relative to that of unrelated samples, that still repeats
_AS_GOOD = 4.0  # a shorter period whose difference is at most so many times the smallest is the period
_ROUNDING = 1e-6  # of the difference: error of rounding and interpolation between lags
_WHOLE = 0.02  # intervals by which whole-sample periods may be off at the end of the record
_MANY = 2_000_000  # samples above which a period is accurate enough without alignment of its phase


@dataclass(frozen=True, eq=False)
class Periods:
    """Whole periods of a record, one in each row, at evenly spaced instants."""

    period: float  # [s]
    displacement: Matrix  # (periods, samples) [m]
    force: Matrix  # (periods, samples) [N]
    notes: tuple[str, ...]


def period_of(displacement: Matrix) -> float | None:
    """Period of a displacement in samples, if it contains at least two; None otherwise.

    The smallest lag at which the mean square of x(t + lag) - x(t) is as small as it gets, as in the difference
    function of de Cheveigne and Kawahara (2002) for pitch; refined at its multiples.
    """
    difference = _difference(displacement)
    lags = np.flatnonzero((difference[1:-1] <= difference[:-2]) & (difference[1:-1] < difference[2:])) + 1
    lags = lags[lags > np.argmax(difference > 0.5)]
    if not lags.size:
        return None
    depth = np.array([_vertex(difference, int(lag))[1] for lag in lags])
    if depth.min() > _REPEATS:
        return None
    period, _ = _vertex(difference, int(lags[np.argmax(depth <= _AS_GOOD * depth.min() + _ROUNDING)]))
    multiple = 2
    while round(multiple * period) < difference.size - 1:  # a period is known the better the more of them
        near = round(multiple * period)
        if not difference[near - 1] >= difference[near] <= difference[near + 1]:
            break
        period = _vertex(difference, near)[0] / multiple
        multiple *= 2
    return _align_phase(displacement, period) if displacement.size <= _MANY else period


def whole_periods(record: Record, period: float) -> Periods:
    """The last whole periods [s] of a record.

    Where a period is no whole number of samples, both channels are interpolated by cubic splines at evenly spaced
    instants, which leaves their ratio alone.

    Raises `RecordError` if the record is shorter than one period.
    """
    samples, notes = period / record.interval, list[str]()
    whole, available = round(samples), record.time.size
    if abs(samples - whole) * available <= _WHOLE * samples:
        count = available // max(whole, 1)
        period = whole * record.interval
    else:
        whole = math.ceil(samples)
        count = math.floor((available - 1) / samples + 1.0 / whole + 1e-9)
        notes.append(
            f"A period is {format_number(samples, 5)} samples; both channels were interpolated by cubic splines to "
            f"{whole} a period."
        )
    if count < 1 or whole < 4:
        duration, needed = format_alike([record.duration, period], "s", 6)
        raise RecordError(
            f"{record.source!r} has {available} samples in {duration}, too few for one period of {needed}. Record "
            f"longer, or at a higher rate."
        )
    x, force = (
        _fold_periods(values, samples, whole, count, bool(notes)) for values in (record.displacement, record.force)
    )
    return Periods(period, x, force, tuple(notes))


def common_periods(records: Sequence[Record]) -> list[float] | None:
    """The period [s] of each record, stated or estimated; None if no record is periodic.

    Raises `RecordError` if only some are periodic.
    """
    found = list[float | None]()
    for record in records:
        samples = period_of(record.displacement) if record.period is None else record.period / record.interval
        found.append(None if samples is None else samples * record.interval)
    known = [period for period in found if period is not None]
    if not known:
        return None
    if len(known) < len(found):
        other = records[found.index(None)].source
        raise RecordError(
            f"{other!r} is not periodic, but other records are. Estimate their responses separately, or give its "
            f"period."
        )
    return known


def _difference(displacement: Matrix) -> Matrix:
    """Mean square of x(t + lag) - x(t) over all t there are, relative to that of unrelated samples, for each lag."""
    x = displacement - displacement.mean()
    n = x.size
    lags = np.arange(n // 2 + 2)
    products = scipy.signal.correlate(x, x, method="fft")[n - 1 : n - 1 + lags.size]
    energy = np.concatenate([[0.0], np.cumsum(x**2)])
    both = energy[n - lags] + energy[n] - energy[lags]
    return np.asarray((both - 2.0 * products) / (n - lags) / (2.0 * energy[n] / n))


def _vertex(values: Matrix, at: int) -> tuple[float, float]:
    """Place and height of the parabola through three neighbours whose middle one is the lowest."""
    before, here, after = values[at - 1 : at + 2]
    bend, slope = before - 2.0 * here + after, 0.5 * (after - before)
    if bend <= 0.0:
        return float(at), float(here)
    return float(at - slope / bend), max(float(here - 0.5 * slope**2 / bend), 0.0)


def _align_phase(displacement: Matrix, period: float) -> float:
    """The period for which the phase of the strongest harmonic is the same in all periods."""
    for _ in range(3):
        whole = math.ceil(period)
        count = math.floor((displacement.size - 1) / period + 1.0 / whole + 1e-9)
        if count < 2 or whole < 4:
            return period
        amplitudes = np.fft.rfft(_fold_periods(displacement, period, whole, count, True), axis=1)[:, : whole // 2]
        harmonic = 1 + int(np.argmax(np.abs(amplitudes[:, 1:].mean(axis=0))))
        phase = np.unwrap(np.angle(amplitudes[:, harmonic]))
        period /= 1.0 + float(np.polyfit(np.arange(count), phase, 1)[0]) / (2.0 * np.pi * harmonic)
    return period


def _fold_periods(values: Matrix, samples: float, whole: int, count: int, between: bool) -> Matrix:
    if not between:
        return values[values.size - count * whole :].reshape(count, whole)
    index = np.arange(count * whole) * (samples / whole)
    at = index + max(values.size - 1 - index[-1], 0.0)
    spline = scipy.interpolate.CubicSpline(np.arange(values.size), values)
    return np.asarray(spline(np.minimum(at, values.size - 1))).reshape(count, -1)
