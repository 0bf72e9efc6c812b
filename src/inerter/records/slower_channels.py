"""Channels that were read at a lower rate than that of the record, and held or interpolated between readings.

Recorders that merge channels of different rates write such records. Between readings the channel contains nothing
measured: a held one is late, by half an interval of the readings on average, and a line cuts the turns of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inerter.records.record import Record
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
_MOST = 20  # samples from one reading to the next: less often, a triangular motion only turns
_FEWEST = 30  # readings
_ROUNDING = 1e-9  # of the largest value
_SLIGHT = 0.02  # of the largest second differences: what digits of a file may leave
_SECOND = 2.01  # steps that rounding may leave of a second difference
_CHANGE = 1.5  # steps, median of the changes: smaller ones are those of an encoder at constant speed


@dataclass(frozen=True)
class SlowerChannel:
    """A channel with a reading at sample `first` and each `every` samples after it."""

    first: int
    every: int
    way: Literal["held", "interpolated"]

    @property
    def readings(self) -> slice:
        """The samples that were read."""
        return slice(self.first, None, self.every)


def slower_channel(values: Vector) -> SlowerChannel | None:
    """The readings of a channel that is held or linear between them; None if it has the rate of the record.

    >>> slower_channel(np.repeat(np.random.default_rng(0).normal(size=100), 4))
    SlowerChannel(first=0, every=4, way='held')
    """
    step, rounding = resolution(values), _ROUNDING * float(np.max(np.abs(values)))
    for order, way in ((1, "held"), (2, "interpolated")):
        change = np.abs(np.diff(values, order))
        largest = float(np.quantile(change, 1.0 - 0.5 / _MOST))
        at = np.flatnonzero(change > max(rounding, (order - 1) * max(_SECOND * step, _SLIGHT * largest)))
        every = int(np.gcd.reduce(np.diff(at))) if at.size >= _FEWEST else 1
        if 2 <= every <= _MOST and float(np.median(change[at])) > _CHANGE * step:
            return SlowerChannel(int(at[0] + 1) % every, every, "held" if way == "held" else "interpolated")
    return None


def at_readings(record: Record) -> Record:
    """The record at the readings of its slower channels alone."""
    for role in ("displacement", "force"):
        found = slower_channel(getattr(record, role)) if record.uniform else None
        if found is not None:
            record = record.samples(
                found.readings,
                f"The {role} was {found.way} between readings: one of every {found.every} samples is kept.",
            )
    return record
