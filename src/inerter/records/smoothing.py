"""Velocity and acceleration from a measured displacement: filtered to a stated bandwidth, then a spline.

Two differences of an encoder's samples multiply its steps by 1/interval^2: 1 um at 1 kHz becomes 1 m/s^2. So the
displacement is filtered first, as little as its spectrum allows, and the attenuation is reported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid
from scipy.interpolate import BSpline, make_interp_spline
from scipy.signal import detrend, periodogram, welch

from inerter.errors import RecordError
from inerter.formatting import format_count, format_quantity
from inerter.records.filtering import HIGHEST, gain, low_pass
from inerter.records.gaps import LONGEST, missing_rows
from inerter.records.record import Record
from inerter.records.remedy import Action, Remedy
from inerter.validation import check_positive

Vector = NDArray[np.float64]
MARGIN = 4.0  # the bandwidth over the highest frequency in the displacement
ABOVE = 5.0  # times the noise floor, that a band has to hold to count as motion
_BLOCK = 1 << 18  # samples of one spline
_DEGREE = 7  # of splines: at seven samples in a period their slope is off by 4e-6, that of cubic ones by 4e-3
_EVEN = 10  # intervals from each end, beyond which all knots that a place depends on are even
_BANDS = 6  # an octave
_NEIGHBOURS = np.array([[1.0], [2.0], [3.0]])  # at which a B-spline of degree 7 is not zero, ...
_VALUES = np.array([1191.0, 120.0, 1.0]) / 2520.0  # ... twice its values there, ...
_SLOPES = np.array([245.0, 56.0, 1.0]) / 360.0  # ... and its slopes
_FEWEST = 64  # samples that a spectrum needs to separate noise from motion
_WIDE = 256  # lines of a spectrum that give a density to 6 %
_LEVELS = 1 << 17  # values in which a step is looked for
_LONGEST = 1 << 20  # samples of one spectrum


@dataclass(frozen=True, eq=False)
class Motion:
    """The displacement of a record as a smooth curve, its derivatives, and their noise.

    Nearer to the ends than 1/bandwidth all three rest on samples of one side only and are less certain.
    """

    time: Vector  # (n,) [s]
    displacement: Vector  # (n,) [m]
    velocity: Vector  # (n,) [m/s]
    bandwidth: float  # [Hz] where the gain of the filter is 1/2
    highest: float  # [Hz] the highest frequency at which the displacement exceeds its noise floor
    attenuation: float  # relative attenuation of the filter at that frequency
    noise: float  # [m] r.m.s. of the noise in the displacement as measured
    velocity_noise: float  # [m/s] r.m.s. noise of the velocity
    acceleration_noise: float  # [m/s^2] r.m.s. noise of the acceleration
    asked: bool = False  # whether the bandwidth was given

    @cached_property
    def acceleration(self) -> Vector:
        """Acceleration [m/s^2], shape (n,)."""
        return interpolate(self.velocity, _spacing(self.time))[1]

    def smooth(self, displacement: Vector) -> tuple[Vector, Vector]:
        """Another displacement on the same times, and its velocity, by the same filter."""
        smooth = low_pass(displacement, _spacing(self.time), self.bandwidth)
        return smooth, interpolate(smooth, _spacing(self.time))[1]


def smooth_displacement(record: Record, bandwidth: float | None = None) -> Motion:
    """The displacement, velocity and acceleration below `bandwidth` [Hz], without phase.

    By default the bandwidth is four times the highest frequency at which the displacement exceeds its noise floor (at
    most 0.4 of the sampling rate), where the filter attenuates by less than 2e-5. The filter is a Butterworth of order
    4, forwards and backwards; the slope of a spline of degree 7 through the result is the velocity, and the slope of a
    spline through that the acceleration.

    Raises `RecordError` if the samples are not evenly spaced, or the bandwidth is not between 0 and half the rate.
    """
    if not record.uniform:
        raise _uneven(record)
    if bandwidth is not None:
        check_positive(RecordError, "A bandwidth", bandwidth, "Hz")
    interval = record.interval
    noise = noise_of(record.displacement, interval)
    chosen = bandwidth_of(noise, interval) if bandwidth is None else float(bandwidth)
    displacement = low_pass(record.displacement, interval, chosen)
    velocity = interpolate(displacement, _spacing(record.time))[1]
    attenuation = 1.0 - float(gain(np.array([noise.highest]), interval, chosen)[0])
    noises = _derivative_noise(noise.density, interval, chosen)
    return Motion(
        time=record.time,
        displacement=displacement,
        velocity=velocity,
        bandwidth=chosen,
        highest=noise.highest,
        attenuation=attenuation,
        noise=noise.rms,
        velocity_noise=noises[0],
        acceleration_noise=noises[1],
        asked=bandwidth is not None,
    )


def bandwidth_of(noise: Noise, interval: float) -> float:
    """The default bandwidth of `smooth_displacement` [Hz], of a displacement with this noise floor."""
    return min(MARGIN * noise.highest, HIGHEST / interval)


def _uneven(record: Record) -> RecordError:
    missing = missing_rows(record.time)
    if missing is None:
        return RecordError(
            f"The samples of {record.source!r} are not evenly spaced, as a filter requires. Use ",
            *(Remedy(Action.RESAMPLE), " first."),
        )
    places, most = missing.after.size, int(missing.counts.max())
    first = f"after {format_quantity(record.time[missing.after[0]], 's', 6)}"
    where = first if places == 1 else f"at {places} places, the first {first}, up to {most} in a row"
    remedy = Remedy(Action.FILL_GAPS) if most <= LONGEST else Remedy(Action.GAPS, "longest")
    return RecordError(
        f"{record.source}: {format_count(int(missing.counts.sum()), 'rows')} missing {where}. Use ",
        *(remedy, " first."),
    )


@dataclass(frozen=True)
class Noise:
    """Noise floor of the spectrum of a channel, and the highest frequency above it."""

    density: float  # [unit^2/Hz], one-sided
    rms: float  # [unit]
    highest: float  # [Hz] the highest frequency above the noise floor


def noise_of(values: Vector, interval: float) -> Noise:
    """The noise floor of a channel, and the highest frequency of its motion above that.

    The spectrum is averaged over sixths of an octave; its lowest wide band is the floor, unless the quantisation noise
    is larger. A record too short for a spectrum has no detectable noise, and its highest frequency is that for which
    the filter of `smooth_displacement` is at its limit.
    """
    limit = HIGHEST / (MARGIN * interval)
    if values.size < _FEWEST or np.ptp(values) == 0.0:
        return Noise(0.0, 0.0, limit)
    centre, level, lines = _bands(*_spectrum(values, interval))
    lowest = float(np.min(level[lines >= min(64, lines.max())]))
    step = resolution(values)
    steps = _step_density(values, interval, step)
    floor = max(lowest, steps)
    motion = centre[level > ABOVE * floor]
    highest = min(float(motion[-1]) if motion.size else limit, 0.5 / interval)
    rms = step / math.sqrt(12.0) if steps >= lowest else math.sqrt(0.5 * floor / interval)
    return Noise(floor, rms, highest)


def quietest(values: Vector, interval: float) -> float:
    """The r.m.s. of white noise of the density that the quietest half-octave of a spectrum has, 256 lines at least.

    A wide band, for the lowest of many narrow ones is lower than the noise by chance.
    """
    if values.size < _FEWEST or np.ptp(values) == 0.0:
        return 0.0
    _, density = _spectrum(values, interval)
    total = np.concatenate([[0.0], np.cumsum(density)])
    means, first, last = [], density.size, density.size
    while first > 1:
        first = max(min(int(last / math.sqrt(2.0)), last - _WIDE), 1)
        means.append(float(total[last] - total[first]) / (last - first))
        last = int(last * 2.0**-0.25)
    return math.sqrt(0.5 * min(means) / interval)


def resolution(values: Vector) -> float:
    """Resolution (quantisation step) of the values: all differences between distinct values are multiples of it.

    0 where none can be found: fewer than 3 steps, or steps as small as rounding. It is looked for in
    the first 131072 values.

    >>> round(resolution(np.round(np.sin(np.arange(100.0)), 2)), 6)
    0.01
    """
    levels = np.unique(values[:_LEVELS])
    rounding = 1e-12 * float(np.max(np.abs(levels)))
    steps = np.diff(levels)
    steps = steps[steps > 100.0 * rounding]
    if steps.size < 3:
        return 0.0
    multiples = steps / np.min(steps)
    if np.max(np.abs(multiples - np.round(multiples))) > 0.05 or np.min(steps) < 1e3 * rounding:
        return 0.0
    return float(np.sum(steps) / np.sum(np.round(multiples)))


def interpolate(values: Vector, interval: float, parts: int = 1) -> tuple[Vector, Vector]:
    """Values and slopes at `parts` even places in each interval, of the spline of degree 7 through even samples.

    It is computed block by block, with overlaps of 64 samples.

    >>> interpolate(np.arange(20.0) ** 2, 1.0, 2)[0][:4]
    array([0.  , 0.25, 1.  , 2.25])
    """
    found = np.empty((2, (values.size - 1) * parts + 1))
    for start in range(0, values.size - 1, _BLOCK):
        stop, first = min(start + _BLOCK, values.size - 1), max(start - 64, 0)
        block = _sample_spline(values[first : start + _BLOCK + 64], parts)
        found[:, start * parts : stop * parts + 1] = block[:, (start - first) * parts : (stop - first) * parts + 1]
    return found[0], found[1] / interval


def _sample_spline(values: Vector, parts: int) -> NDArray[np.float64]:
    """Values and slopes (2, places) of one spline, with the interval as the unit of time.

    Away from the ends its knots are even, so that all intervals have the same weights of eight coefficients.
    """
    degree = min(_DEGREE, values.size - 1 - values.size % 2)
    spline = make_interp_spline(np.arange(values.size, dtype=np.float64), values, degree)
    found = np.empty((2, (values.size - 1) * parts + 1))
    first, stop = (_EVEN, values.size - 1 - _EVEN) if values.size - 1 > 2 * _EVEN else (0, 0)
    if stop:
        even = BSpline(np.arange(2.0 * degree + 2.0), np.eye(degree + 1), degree)
        for order in range(2):
            weights = even(degree + np.arange(parts) / parts, order)
            inner = sum(spline.c[first - 3 + i : stop - 3 + i, None] * weights[:, i] for i in range(degree + 1))
            found[order, first * parts : stop * parts] = np.ravel(inner)
    for ends in (slice(0, first * parts), slice(stop * parts, None)):
        at = np.arange(found.shape[1])[ends] / parts
        found[:, ends] = spline(at), spline(at, 1)
    return found


def _spacing(time: Vector) -> float:
    """Interval of even times [s]."""
    return float(time[-1] - time[0]) / (time.size - 1)


def _spectrum(values: Vector, interval: float) -> tuple[Vector, Vector]:
    straight = detrend(values)
    if values.size <= _LONGEST:
        frequency, density = periodogram(straight, 1.0 / interval, window="hann", detrend=False)
    else:
        frequency, density = welch(straight, 1.0 / interval, window="hann", nperseg=_LONGEST, detrend=False)
    return frequency, density


def _bands(frequency: Vector, density: Vector) -> tuple[Vector, Vector, NDArray[np.int64]]:
    """The highest frequency, the mean density and the lines of each sixth of an octave; at least 8 lines in each."""
    edges = [2]
    while edges[-1] < frequency.size:
        edges.append(max(edges[-1] + 8, int(edges[-1] * 2.0 ** (1.0 / _BANDS))))
    edges = [edge for edge in edges if edge <= frequency.size - 8] + [frequency.size]
    lines = np.diff(np.array(edges))
    means = np.add.reduceat(density, np.array(edges[:-1])) / lines
    return frequency[np.array(edges[1:]) - 1], means, lines


def _step_density(values: Vector, interval: float, step: float) -> float:
    """Density of the rounding error: step^2/12 over the rate at which steps are taken, or half the sampling rate."""
    if step == 0.0:
        return 0.0
    rate = float(np.sum(np.abs(np.diff(values)))) / (step * interval * values.size)
    return step**2 / 12.0 / max(min(rate, 0.5 / interval), 1.0 / (interval * values.size))


def _derivative_noise(floor: float, interval: float, bandwidth: float) -> tuple[float, float]:
    """R.m.s. of white noise of that density after filter and splines, in velocity and acceleration."""
    top = min(0.5 / interval, 6.0 * bandwidth)
    frequency = np.linspace(0.0, top, 4001)
    theta = 2.0 * np.pi * frequency * interval
    slope = _SLOPES @ np.sin(_NEIGHBOURS * theta) / (1.0 + _VALUES @ (np.cos(_NEIGHBOURS * theta) - 1.0)) / interval
    passed = np.sqrt(floor) * gain(frequency, interval, bandwidth)
    squares = (trapezoid((passed * slope**n) ** 2, frequency) for n in (1, 2))
    velocity, acceleration = (float(np.sqrt(square)) for square in squares)
    return velocity, acceleration
