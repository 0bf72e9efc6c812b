"""Signals: functions of time with their derivative, tables of samples among them, and their sums."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from inerter.errors import SignalError
from inerter.formatting import format_alike, format_number, format_quantity, format_range
from inerter.signals.arguments import (
    MOST,
    Array,
    check_grid,
    check_span,
    positive_number,
    real_array,
    real_vector,
    speed_or_none,
    time_tolerance,
    times_within,
    whole_number,
)
from inerter.signals.tables import HOLDS, check_times, close_period, coefficients, spacing
from inerter.validation import is_number

Pair = tuple[Array, Array]


@dataclass(frozen=True, kw_only=True, eq=False)
class Signal:
    """A road height or a displacement [m], or a force [N], as a function of time [s].

    At a jump, value and derivative are the limits from the right. Before its beginning, a signal has its first value
    unless it is periodic. `multisine`, `sine`, `step` and similar functions create signals, and `Signal.sampled`
    creates one from a table.

    >>> import inerter as it
    >>> ramp = it.Signal.sampled([0.0, 1.0], [0.0, 0.2], "linear")  # s, m
    >>> isinstance(ramp, it.Signal), ramp.duration
    (True, 1.0)
    """

    label: str  # one line of text
    period: float | None = None  # [s]
    duration: float | None = None  # [s] end time of a finite signal
    highest_frequency: float | None = None  # [Hz] in a formula; a table has none
    interval: float | None = None  # [s] smallest spacing of a table
    hold: str = "cubic"  # "cubic", "linear" or "zero": interpolation between close points
    speed: float | None = None  # [m/s] of the vehicle, which gives the delay between axles
    __array_ufunc__: ClassVar[None] = None  # so that a NumPy number times a signal is a signal

    def __call__(self, time: ArrayLike) -> Any:
        """Values at `time` [s], in its shape.

        Raises `SignalError` as `sample` does.
        """
        return self.sample(time)[0][()]

    def sample(self, time: ArrayLike) -> Pair:
        """Value and derivative at `time` [s], in its shape.

        Raises `SignalError` if `time` does not consist of finite numbers, or is after the end.
        """
        times = real_array("The times of a signal", time)
        latest = float(times.max(initial=-math.inf))
        if self.duration is not None and latest > self.duration + time_tolerance(self.duration, self.interval):
            end, asked = format_alike([self.duration, latest], "s", 9)
            raise SignalError(
                f"The signal {self.label!r} ends at t = {end}, before the requested t = {asked}. Stop earlier, or use "
                f"a longer or periodic signal."
            )
        return self._evaluate(times)

    def grid(self, start: float, step: float, count: int) -> Pair:
        """The same as `sample(start + step * arange(count))`; fast for harmonics whose period is a multiple of `step`.

        Raises `SignalError` as `sample` does, and unless `step` is positive and `count` a non-negative integer.
        """
        check_grid(start, step, count)
        return self.sample(start + step * np.arange(count))

    def breaks(self, start: float, stop: float) -> Array:
        """Breakpoints in (start, stop) [s] between pieces of the signal; empty for a single formula.

        Times that differ from `start` or `stop` by rounding only are left out.
        """
        return np.zeros(0)

    def held(self, interval: float, duration: float | None = None) -> SampledSignal:
        """Samples at t = 0, `interval`, ... [s], each held until the next (a zero-order hold).

        Periodic or finite as the signal is. `duration` [s] truncates it, and is required for a signal that is neither
        periodic nor finite. Unless it is periodic, it has the value of t = 0 before.

        Raises `SignalError` if the period is not a whole number of intervals, or the signal is too short.
        """
        interval = positive_number("The interval of a hold", interval, "s")
        label = f"{self.label}, held for {format_quantity(interval, 's', 6)}"
        if duration is None and self.period is not None:
            count = whole_number(self.period, interval, "A period")
            time = np.linspace(0.0, self.period, count + 1)
            value = np.resize(self.grid(0.0, self.period / count, count)[0], count + 1)
            return Signal.sampled(time, value, "zero", periodic=True, speed=self.speed, label=label)
        end = self.duration if duration is None else positive_number("The duration of a held signal", duration, "s")
        if end is None:
            raise SignalError(
                f"The signal {self.label!r} is neither periodic nor finite. Give the time to hold: duration = ..."
            )
        if not 1.0 <= end / interval <= MOST:
            raise SignalError(
                f"A signal of {format_quantity(end, 's', 6)} cannot be held for {format_quantity(interval, 's', 6)}; "
                f"use from 1 to 1e8 intervals."
            )
        count = math.floor(end / interval * (1.0 + 1e-15)) + 1
        value = self.grid(0.0, interval, count)[0]
        table = Signal.sampled(interval * np.arange(count), value, "zero", speed=self.speed, label=label)
        return replace(table, duration=end)

    @staticmethod
    def sampled(
        time: ArrayLike,
        value: ArrayLike,
        hold: str = "cubic",
        derivative: ArrayLike | None = None,
        periodic: bool = False,
        speed: float | None = None,
        label: str | None = None,
    ) -> SampledSignal:
        """A table of two or more samples, joined by cubics, by lines (`"linear"`), or each held (`"zero"`).

        The cubics take `derivative` at the samples; without it, that of the cubic spline through them (not-a-knot, or
        periodic). In a periodic table the last time stands one period after the first: its value must equal the first,
        except with `"zero"`, where it is not used. Knots count as reached within 1e-9 of the smallest interval.

        Raises `SignalError` for samples that are not finite real numbers, lengths that differ, times that do not
        increase, an unknown hold, or derivatives without cubics.

        >>> Signal.sampled([0.0, 1.0, 3.0], [0.0, 2.0, 0.0], "linear")(2.0)
        np.float64(1.0)
        """
        if not isinstance(hold, str) or hold not in HOLDS:
            raise SignalError(f'hold must be one of "cubic", "linear" and "zero", got {hold!r}.')
        if derivative is not None and hold != "cubic":
            raise SignalError(f'Derivatives require hold = "cubic"; with {hold!r}, leave them out.')
        if not isinstance(periodic, bool):
            raise SignalError(f"periodic must be True or False, got {periodic!r}.")
        if label is not None and not isinstance(label, str):
            raise SignalError(f"label must be a text, got {label!r}.")
        times, values = real_vector("The times of a table", time), real_vector("The values of a table", value)
        check_times(times, len(values))
        if periodic and hold != "zero":
            values = close_period(values)
        table = coefficients(times, values, hold, derivative, periodic)
        table.setflags(write=False)
        return SampledSignal(
            time=times,
            coefficient=table,
            label=label or f"table of {len(times)} samples",
            period=float(times[-1] - times[0]) if periodic else None,
            duration=None if periodic else float(times[-1]),
            interval=spacing(times),
            hold=hold,
            speed=speed_or_none(speed),
        )

    def __add__(self, other: object) -> SignalSum:
        if not isinstance(other, Signal):
            raise SignalError(f"A signal can be added to a signal only, got {other!r}.")
        return _weighted_sum((1.0, self), (1.0, other))

    def __mul__(self, factor: object) -> SignalSum:
        if not is_number(factor):
            raise SignalError(f"A signal can be multiplied by a finite number only, got {factor!r}.")
        return _weighted_sum((float(factor), self))

    __radd__ = __add__
    __rmul__ = __mul__

    def _evaluate(self, time: Array) -> Pair:
        """Value and derivative at checked times."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True, eq=False)
class SampledSignal(Signal):
    """Piecewise polynomial through the samples of a table; created by `Signal.sampled`."""

    time: Array  # (n,) [s]
    coefficient: Array  # (order, piece), ascending, in the time since the start of the piece

    def breaks(self, start: float, stop: float) -> Array:
        check_span(start, stop)
        ends = np.clip([start, stop], self.time[0], math.inf) if self.period is None else np.array([start, stop])
        cycle, index = self._locate(ends)
        pieces = self.coefficient.shape[1]
        first, last = cycle * pieces + index
        if last - first > MOST:
            raise SignalError(
                f"The signal {self.label!r} has more than 1e8 knots from {format_range(start, stop, 's', 6)}."
            )
        turn, piece = np.divmod(np.arange(int(first), int(last) + 1), pieces)
        return times_within(self.time[piece] + turn * (self.period or 0.0), start, stop, self.interval)

    def _evaluate(self, time: Array) -> Pair:
        cycle, index = self._locate(time)
        elapsed = time - self.time[index] - cycle * (self.period or 0.0)
        value = self.coefficient[-1, index]
        slope = np.zeros_like(value)
        early = (self.period is None) & (elapsed < -time_tolerance(time, self.interval))
        elapsed = np.where(early, 0.0, elapsed)
        for part in self.coefficient[-2::-1]:
            slope = slope * elapsed + value
            value = value * elapsed + part[index]
        return value, np.where(early, 0.0, slope)

    def _locate(self, time: Array) -> tuple[Array, Any]:
        """Number of whole periods before each time, and the index of its piece."""
        reached = time + time_tolerance(time, self.interval)
        cycle = np.zeros_like(time) if self.period is None else np.floor((reached - self.time[0]) / self.period)
        pieces = self.coefficient.shape[1]
        index = np.searchsorted(self.time[:pieces], reached - cycle * (self.period or 0.0), side="right") - 1
        return cycle, np.clip(index, 0, pieces - 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class SignalSum(Signal):
    """A weighted sum of signals, created by `+` and `*`.

    Its hold is the least smooth of theirs. It is periodic only if the longest period is a multiple of every other.
    """

    terms: tuple[tuple[float, Signal], ...]

    def grid(self, start: float, step: float, count: int) -> Pair:
        return _total((weight, signal.grid(start, step, count)) for weight, signal in self.terms)

    def breaks(self, start: float, stop: float) -> Array:
        times = np.sort(np.concatenate([signal.breaks(start, stop) for _, signal in self.terms]))
        apart: NDArray[np.bool_] = np.diff(times, prepend=-math.inf) > time_tolerance(times, self.interval)
        return times[apart]

    def _evaluate(self, time: Array) -> Pair:
        return _total((weight, signal.sample(time)) for weight, signal in self.terms)


def _weighted_sum(*terms: tuple[float, Signal]) -> SignalSum:
    signals = [signal for _, signal in terms]
    speeds = {signal.speed for signal in signals if signal.speed is not None}
    if len(speeds) > 1:
        given = " and ".join(format_alike(speeds, "m/s"))
        raise SignalError(f"Signals of different speeds cannot be added, got {given}.")
    return SignalSum(
        terms=terms,
        label=" + ".join(s.label if weight == 1.0 else f"{format_number(weight)} x ({s.label})" for weight, s in terms),
        period=_common_period([signal.period for signal in signals]),
        duration=min((s.duration for s in signals if s.duration is not None), default=None),
        highest_frequency=max((s.highest_frequency for s in signals if s.highest_frequency is not None), default=None),
        interval=min((s.interval for s in signals if s.interval is not None), default=None),
        hold=min((signal.hold for signal in signals), key=HOLDS.index),
        speed=next(iter(speeds), None),
    )


def _common_period(periods: list[float | None]) -> float | None:
    """The longest of the periods if it is a whole multiple of each."""
    known = [period for period in periods if period is not None]
    longest = max(known, default=1.0)
    ratios = [longest / period for period in known]
    exact = all(abs(ratio - round(ratio)) <= 1e-14 * ratio for ratio in ratios)
    return longest if exact and len(known) == len(periods) else None


def _total(parts: Iterable[tuple[float, Pair]]) -> Pair:
    weighted = [(weight * value, weight * slope) for weight, (value, slope) in parts]
    values, slopes = zip(*weighted, strict=True)
    return sum(values[1:], values[0]), sum(slopes[1:], slopes[0])
