"""Apparent mass, force over acceleration at each frequency, from which a reversed sign and a delay are found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import csd, welch

from inerter.records.record import Record
from inerter.records.smoothing import Motion

Vector = NDArray[np.float64]
COHERENT = 0.8  # least magnitude-squared coherence of a line that counts
_SEGMENTS = 6  # of the record, half of each in the next


@dataclass(frozen=True, eq=False)
class RatioLines:
    """The ratio of two channels at the frequencies where the first is excited and the other follows it."""

    omega: Vector  # (m,) [rad/s]
    ratio: NDArray[np.complex128]  # (m,) second over first
    phase_error: Vector  # (m,) [rad] standard error of its phase

    @property
    def spread(self) -> float:
        """The highest frequency over the lowest, 1 where there are none."""
        return float(self.omega[-1] / self.omega[0]) if self.omega.size else 1.0


def ratio_lines(first: Vector, second: Vector, interval: float, highest: float) -> RatioLines:
    """The ratio second/first up to the `highest` frequency [Hz], from averaged spectra.

    A line counts if the first channel has at least 1e-4 of its largest density there, and the squared coherence is at
    least 0.8. The error of the phase is that of the averages: sqrt((1 - C) / (2 C k)) for k segments.
    """
    size = min(max(first.size * 2 // (_SEGMENTS + 1), 8), 1 << 18, first.size)
    first, second = first - np.mean(first), second - np.mean(second)
    frequency, power = welch(first, 1.0 / interval, nperseg=size)
    _, other = welch(second, 1.0 / interval, nperseg=size)
    _, cross = csd(first, second, 1.0 / interval, nperseg=size)
    with np.errstate(divide="ignore", invalid="ignore"):
        coherence = np.nan_to_num(np.abs(cross) ** 2 / (power * other))
    found = (power >= 1e-4 * np.max(power)) & (coherence >= COHERENT) & (frequency <= highest)
    found[:2] = False
    segments = max((2 * first.size // size - 1) * 0.75, 1.0)  # neighbours share half of their samples
    kept = np.clip(coherence[found], 0.0, 1.0 - 1e-12)
    return RatioLines(
        2.0 * np.pi * frequency[found], cross[found] / power[found], np.sqrt((1.0 - kept) / (2.0 * kept * segments))
    )


def force_over_acceleration(record: Record, motion: Motion) -> RatioLines:
    """The apparent mass of the device, where the displacement exceeds its noise floor."""
    acceleration = motion.acceleration if record.acceleration is None else record.acceleration
    return ratio_lines(acceleration, record.force, record.interval, highest=motion.highest)
