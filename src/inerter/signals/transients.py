"""Transient signals: a sweep, a step and a bump."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from inerter.formatting import format_number, format_quantity, format_range
from inerter.signals.arguments import (
    Array,
    finite_number,
    frequency_band,
    positive_number,
    speed_or_none,
    time_tolerance,
    times_within,
)
from inerter.signals.signal import Pair, Signal


@dataclass(frozen=True, kw_only=True, eq=False)
class Chirp(Signal):
    """A sine whose frequency rises linearly from `lowest` [Hz] at t = 0 to `highest_frequency` at the end."""

    amplitude: float
    lowest: float  # [Hz]
    highest_frequency: float
    duration: float

    def breaks(self, start: float, stop: float) -> Array:
        return times_within(np.zeros(1), start, stop)

    def _evaluate(self, time: Array) -> Pair:
        elapsed = np.maximum(time, 0.0)
        rate = (self.highest_frequency - self.lowest) / self.duration
        angle = 2.0 * math.pi * (self.lowest + 0.5 * rate * elapsed) * elapsed
        slope = 2.0 * math.pi * (self.lowest + rate * elapsed) * self.amplitude * np.cos(angle)
        return self.amplitude * np.sin(angle), np.where(time < -time_tolerance(time, None), 0.0, slope)


@dataclass(frozen=True, kw_only=True, eq=False)
class StepSignal(Signal):
    """Step from zero to `height` at `time` [s]."""

    height: float
    time: float

    def breaks(self, start: float, stop: float) -> Array:
        return times_within(np.array([self.time]), start, stop)

    def _evaluate(self, time: Array) -> Pair:
        return np.where(time + time_tolerance(time, None) >= self.time, self.height, 0.0), np.zeros_like(time)


@dataclass(frozen=True, kw_only=True, eq=False)
class Bump(Signal):
    """`height` (1 - cos(2 pi x)) / 2, where x goes from 0 to 1 in the time of `passage` [s]."""

    height: float
    start: float
    passage: float

    def breaks(self, start: float, stop: float) -> Array:
        return times_within(np.array([self.start, self.start + self.passage]), start, stop)

    def _evaluate(self, time: Array) -> Pair:
        x = (time - self.start) / self.passage
        x = np.where((x > 0.0) & (x < 1.0), x, 0.0)
        slope = math.pi * self.height / self.passage * np.sin(2.0 * math.pi * x)
        return self.height * np.sin(math.pi * x) ** 2, slope


def chirp(amplitude: float, lowest: float, highest: float, duration: float, speed: float | None = None) -> Chirp:
    """A linear sweep from `lowest` to `highest` [Hz] in `duration` [s], at which it ends; zero before t = 0.

    Raises `SignalError` unless 0 < lowest <= highest, `duration` > 0 and `amplitude` is a finite number.

    >>> import inerter as it
    >>> sweep = it.chirp(1e-3, lowest=1.0, highest=10.0, duration=2.0)  # m, Hz, Hz, s
    >>> sweep.highest_frequency
    10.0
    """
    low, high = frequency_band("chirp", lowest, highest)
    size = finite_number("The amplitude of a chirp", amplitude, "its unit")
    end = positive_number("The duration of a chirp", duration, "s")
    return Chirp(
        label=f"chirp of {format_number(size)}, {format_range(low, high, 'Hz', 6)} in {format_quantity(end, 's', 6)}",
        amplitude=size,
        lowest=low,
        highest_frequency=high,
        duration=end,
        speed=speed_or_none(speed),
    )


def step(height: float, time: float = 0.0, speed: float | None = None) -> StepSignal:
    """A step from zero to `height` at `time` [s].

    Raises `SignalError` unless both are finite numbers.

    >>> import inerter as it
    >>> kerb = it.step(0.05, time=0.1)  # m, s
    >>> kerb.height, kerb.time
    (0.05, 0.1)
    """
    size, begin = (
        finite_number("The height of a step", height, "its unit"),
        finite_number("The time of a step", time, "s"),
    )
    label = f"step of {format_number(size)} at {format_quantity(begin, 's', 6)}"
    return StepSignal(label=label, height=size, time=begin, hold="zero", speed=speed_or_none(speed))


def bump(height: float, length: float, speed: float, start: float = 0.0) -> Bump:
    """A rounded bump, `height` (1 - cos(2 pi x / length)) / 2, `length` [m] long, reached at t = `start` [s].

    Raises `SignalError` unless `length` and `speed` [m/s] are positive and all are finite numbers.

    >>> bump(0.05, length=2.0, speed=10.0, start=1.0)([0.9, 1.1, 1.3])
    array([0.  , 0.05, 0.  ])
    """
    size, begin = (
        finite_number("The height of a bump", height, "its unit"),
        finite_number("The start of a bump", start, "s"),
    )
    long, fast = (
        positive_number("The length of a bump", length, "m"),
        positive_number("The speed over a bump", speed, "m/s"),
    )
    extent = f"{format_quantity(long, 'm', 6)} long at {format_quantity(fast, 'm/s', 6)}"
    return Bump(
        label=f"bump of {format_number(size)}, {extent}",
        height=size,
        start=begin,
        passage=long / fast,
        highest_frequency=fast / long,
        speed=fast,
    )
