"""Zero-phase low-pass filtering of whole records, without ringing at the ends."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt, sosfreqz

from inerter.errors import RecordError
from inerter.formatting import format_alike

Vector = NDArray[np.float64]
ORDER = 4  # of the filter, which runs forwards and backwards
HIGHEST = 0.4  # of the sampling rate: the highest bandwidth
_SETTLED = 5.0  # time constants 1/bandwidth by which the record is continued at both ends


def low_pass(values: Vector, interval: float, bandwidth: float) -> Vector:
    """The values low-pass filtered at `bandwidth` [Hz]: a Butterworth filter of order 4, forwards and backwards.

    The gain is 1/2 at the bandwidth and there is no phase. Beyond its ends the record is continued by a cubic through
    its last 1/bandwidth, so that value, slope and curvature go on smoothly.

    Raises `RecordError` unless the bandwidth is below half the sampling rate.
    """
    sections = _sections(interval, bandwidth)
    window = max(round(1.0 / (bandwidth * interval)), 8)
    pad = min(round(_SETTLED * window), values.size - 1)
    mean = float(np.mean(values))
    head = _extrapolate(values[::-1] - mean, window, pad)[::-1]
    tail = _extrapolate(values - mean, window, pad)
    padded = np.concatenate((head, values - mean, tail))
    result: Vector = sosfiltfilt(sections, padded, padtype="odd", padlen=min(3 * ORDER, padded.size - 1))
    return result[pad : pad + values.size] + mean


def gain(frequency: Vector, interval: float, bandwidth: float) -> Vector:
    """The gain of `low_pass` at these frequencies [Hz]."""
    _, response = sosfreqz(_sections(interval, bandwidth), worN=2.0 * np.pi * np.asarray(frequency) * interval)
    squared: Vector = np.abs(response) ** 2
    return squared


@lru_cache(64)  # a fit filters a record with the same one hundreds of times
def _sections(interval: float, bandwidth: float) -> Vector:
    if not 0.0 < bandwidth < 0.5 / interval:
        most, given = format_alike([0.5 / interval, bandwidth], "Hz")
        raise RecordError(f"A bandwidth must lie between 0 and half the sampling rate, {most}, got {given}.")
    sections: Vector = butter(ORDER, bandwidth, fs=1.0 / interval, output="sos")
    return sections


def _extrapolate(values: Vector, window: int, pad: int) -> Vector:
    """`pad` values beyond the last one: a cubic over two windows, then straight, with the noise fading out."""
    window = min(window, values.size)
    past = np.arange(1 - window, 1) / window
    cubic = np.polynomial.Polynomial.fit(past, values[-window:], 3, domain=[-1.0, 1.0], window=[-1.0, 1.0])
    beyond = np.arange(1, pad + 1) / window
    near = np.minimum(beyond, 2.0)
    trend: Vector = cubic(near) + cubic.deriv()(near) * (beyond - near)
    rest = values[-window:] - cubic(past)
    count = min(pad, window - 1)
    reflected = 2.0 * rest[-1] - rest[-2 : -2 - count : -1] if count < window - 1 else 2.0 * rest[-1] - rest[-2::-1]
    trend[:count] += np.cos(0.5 * np.pi * beyond[:count]) ** 2 * reflected
    return trend
