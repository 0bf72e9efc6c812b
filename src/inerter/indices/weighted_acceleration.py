"""Frequency-weighted accelerations over time, and the values of ISO 2631-1 for them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from inerter.errors import PerformanceIndexError
from inerter.formatting import format_alike
from inerter.indices.iso2631 import iso2631_weighting
from inerter.systems.linear import LinearSystem
from inerter.validation import checked, real_numbers

Array = NDArray[np.float64]
_RUNNING = 1.0  # [s] of a running r.m.s. value
_CONSTANT = 0.05  # of the standard deviation: a mean that is no motion
_EVEN = 1e-6  # of a step, by which steps of time may differ


@dataclass(frozen=True, eq=False)
class WeightedAcceleration:
    """A frequency-weighted acceleration and the values that ISO 2631-1:1997 makes of it.

    For a rotation read rad for m.

    >>> import inerter as it
    >>> import numpy as np
    >>> time = np.arange(0.0, 20.0, 1e-3)  # s
    >>> shaken = it.frequency_weight(time, np.sin(2 * np.pi * 6.0 * time), "Wk")  # 1 m/s^2 at 6 Hz
    >>> shaken.mtvv >= shaken.rms > 0.7  # m/s^2; the weighting is nearly 1 there
    True
    """

    rms: float  # [m/s^2], 6.1
    mtvv: float  # [m/s^2] the largest running r.m.s. value over 1 s, 6.3.1
    vdv: float  # [m/s^1.75] fourth-power vibration dose value, 6.3.2
    time: Array = field(repr=False)  # [s]
    values: Array = field(repr=False)  # [m/s^2]
    constant: float = 0.0  # [m/s^2] what was taken from the acceleration before, such as gravity


@checked(PerformanceIndexError)
def frequency_weight(time: ArrayLike, acceleration: ArrayLike, weighting: str = "Wk") -> WeightedAcceleration:
    """An acceleration [m/s^2] at even steps of `time` [s] through a weighting of ISO 2631-1, from rest.

    The arguments may be `run.time` and `run["sprung_acceleration"]` of a simulation, or the columns of a record. A mean
    of more than a twentieth of the standard deviation is subtracted first, and returned as `constant`, if the record
    begins nearer to it than to zero: gravity in the signal of a sensor would otherwise act as a step. The mean of a
    shock or of braking from rest is kept. The acceleration is interpolated linearly between its samples; ten samples
    in the shortest period that matters, that of 100 Hz (with "Wf" of 0.63 Hz), are therefore necessary.

    Raises `PerformanceIndexError` for another weighting, for steps that are not even, for values that are no finite
    numbers, and for less than 1 s.

    >>> t = np.arange(0.0, 40.0, 1e-3)
    >>> felt = frequency_weight(t, np.sin(2.0 * np.pi * 8.0 * t), "Wk")
    >>> round(felt.rms * 2.0**0.5, 2), round(felt.mtvv * 2.0**0.5, 2)  # 1.036 in the standard's table
    (1.04, 1.04)
    """
    system = iso2631_weighting(weighting)
    times, given = _check_samples(time, acceleration)
    mean = float(given.mean())
    is_offset = abs(given[0] - mean) < abs(given[0])  # else taking it away would make the step that it is to spare
    constant = mean if is_offset and abs(mean) > _CONSTANT * float(given.std()) else 0.0
    given = given - constant if constant else given
    step = float(times[-1] - times[0]) / (times.size - 1)
    values = _filter_samples(system, given, step)
    energy = np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] ** 2 + values[:-1] ** 2))])
    since = times - times[0]
    late = since >= _RUNNING * (1.0 - _EVEN)
    running = energy[late] - np.interp(since[late] - _RUNNING, since, energy)
    return WeightedAcceleration(
        rms=float(np.sqrt(energy[-1] / since[-1])),
        mtvv=float(np.sqrt(running.max() / _RUNNING)),
        vdv=float(np.trapezoid(values**4, dx=step) ** 0.25),
        time=times,
        values=values,
        constant=constant,
    )


def _filter_samples(system: LinearSystem, given: Array, step: float) -> Array:
    """The output for an input that is linear between even samples, mode by mode: the poles of weightings differ."""
    matrices = (system.A, system.B, system.C, system.D)
    A, B, C, D, _ = scipy.signal.cont2discrete(matrices, step, method="foh")
    rates, modes = np.linalg.eig(A)
    enters, leaves = np.linalg.solve(modes, B.astype(complex))[:, 0], (C @ modes)[0]
    result = D[0, 0] * given
    for rate, enter, leave in zip(rates, enters, leaves, strict=True):
        result = result + scipy.signal.lfilter([0.0, leave * enter], [1.0, -rate], given).real
    return np.asarray(result)


def _check_samples(time: ArrayLike, acceleration: ArrayLike) -> tuple[Array, Array]:
    times, given = real_numbers(time), real_numbers(acceleration)
    if times is None or given is None:
        raise PerformanceIndexError("A weighted motion requires two lists of numbers, time and acceleration.")
    if times.ndim != 1 or times.shape != given.shape or not (np.all(np.isfinite(times)) and np.all(np.isfinite(given))):
        raise PerformanceIndexError(
            f"Time and acceleration must be two equally long lists of finite numbers, got shapes {times.shape} and "
            f"{given.shape}."
        )
    steps = np.diff(times)
    if not steps.size or not steps.min() > 0.0 or np.ptp(steps) > _EVEN * steps.max():
        raise PerformanceIndexError("The time of a weighted motion must be equally spaced. Interpolate it first.")
    if times[-1] - times[0] < _RUNNING * (1.0 - _EVEN):
        least, given_text = format_alike([_RUNNING, times[-1] - times[0]], "s")
        raise PerformanceIndexError(f"A weighted motion must last at least {least}, got {given_text}.")
    return times, given
