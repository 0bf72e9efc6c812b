"""Clock faults that the times do not show: sampling jitter, and channels with different clocks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from inerter.records.dropouts import MAD
from inerter.records.record import Record
from inerter.records.smoothing import Motion, resolution

Vector = NDArray[np.float64]
_LOUDER = 6.0  # ratio of the variances of the displacement at high and at low speed
_LEAST_JITTER = 5e-3  # of an interval
_PARTS = 8  # of a record, whose delays are compared
_ALIKE = 1.6  # ratio of the r.m.s. motions of the parts
_SURE = 1e-5  # p-value of a trend of the delay
_LEAST_DRIFT = 0.05  # of an interval over the record
_STEADY = 0.8  # share of the variance of the delays that a straight line explains


@dataclass(frozen=True)
class ClockDrift:
    """Growth of the delay of the force over the record [s], its standard error [s], and relative to the time."""

    growth: float
    error: float
    rate: float


def jitter(record: Record, motion: Motion) -> float | None:
    """Standard deviation of the sampling instants [s] estimated from the displacement; None if not detectable.

    A sample that is taken too late by dt is off by velocity * dt, so that the scatter about the smoothed motion grows
    with speed. The scatter of rounding is there at any speed.
    """
    inner = slice(record.time.size // 50, -record.time.size // 50)
    off, speed = (record.displacement - motion.displacement)[inner], np.abs(motion.velocity)[inner]
    if off.size < 200:
        return None
    low, high = np.quantile(speed, (0.25, 0.75))
    slow, fast = speed <= low, speed >= high
    passed = 1.0 - min(2.0 * motion.bandwidth * record.interval, 0.9)
    least = resolution(record.displacement) ** 2 / 12.0 * passed
    quiet, loud = (max((MAD * float(np.median(np.abs(off[part])))) ** 2, least) for part in (slow, fast))
    squares = float(np.mean(speed[fast] ** 2) - np.mean(speed[slow] ** 2))
    if loud < _LOUDER * quiet or squares <= 0.0:
        return None
    size = math.sqrt((loud - quiet) / squares / passed)
    return size if size > _LEAST_JITTER * record.interval else None


def clock_drift(record: Record, motion: Motion) -> ClockDrift | None:
    """Steady growth of the delay between displacement and force over the record; None if not significant.

    The force is modelled by a constant law, linear in position, velocity, acceleration and direction, and the delay of
    its residual is compared between the parts of the record. The error of that law is the same in all of them only if
    the motion is: growing amplitudes and sweeps are therefore rejected.
    """
    size = record.time.size // (_PARTS + 1)
    if size < 64:
        return None
    first = record.time.size - _PARTS * size  # the start, where the device may begin from rest, is left out
    parts = [slice(first + k * size, first + (k + 1) * size) for k in range(_PARTS)]
    signals = (motion.displacement, motion.velocity, motion.acceleration, np.sign(motion.velocity))
    columns = np.column_stack([np.ones(record.time.size), *signals])
    columns /= np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    weights, *_ = np.linalg.lstsq(columns[first:], record.force[first:], rcond=None)
    smooth = columns[:, :4] @ weights[:4]
    rest, rate = record.force - columns @ weights, np.gradient(smooth, record.interval)
    sizes = np.array([[float(np.std(v[p])) for v in (motion.velocity, motion.acceleration)] for p in parts])
    if np.any(sizes.max(axis=0) > _ALIKE * sizes.min(axis=0)):
        return None
    late = np.array([-float(rest[p] @ rate[p]) / max(float(rate[p] @ rate[p]), 1e-300) for p in parts])
    return _trend(record, np.array([record.time[p].mean() for p in parts]), late)


def _trend(record: Record, time: Vector, late: Vector) -> ClockDrift | None:
    columns = np.column_stack([np.ones(time.size), time - time.mean()])
    solution, *_ = np.linalg.lstsq(columns, late, rcond=None)
    left = late - columns @ solution
    degrees = time.size - 2
    error = math.sqrt(float(left @ left) / degrees / float(np.sum((time - time.mean()) ** 2)))
    rate, total = float(solution[1]), float(np.sum((late - late.mean()) ** 2))
    p = 2.0 * float(student.sf(abs(rate) / max(error, 1e-300), degrees))
    explained = 1.0 - float(left @ left) / max(total, 1e-300)
    growth = rate * record.duration
    if p > _SURE or explained < _STEADY or abs(growth) < _LEAST_DRIFT * record.interval:
        return None
    return ClockDrift(growth, error * record.duration, rate)
