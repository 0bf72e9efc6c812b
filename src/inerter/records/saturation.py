"""Samples at which a load cell or its amplifier clips the force."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.records.gaps import true_runs
from inerter.records.record import Record
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
_REACH, _BAND, _WIDE = 8.0, 0.1, 0.4  # times the noise that samples of one level lie apart; of the range; of the band
FLAT = 3  # consecutive samples at the extreme value that count as clipping


@dataclass(frozen=True)
class Plateau:
    """An extreme [N] at which a force is clipped, and the largest number of consecutive samples there."""

    value: float
    longest: int


def saturated_samples(record: Record) -> NDArray[np.bool_]:
    """Samples (samples,) at the end of the load cell's range, or on a plateau of the force where that is unknown."""
    force, limit = record.force, record.force_range
    if limit is not None:
        return np.asarray(np.abs(force) >= min(limit - 0.5 * resolution(force), 0.999 * limit))
    at_end = np.zeros(force.size, dtype=bool)
    for plateau in plateaus(record):
        at_end |= _equal_to(force, plateau.value)
    return at_end


def plateaus(record: Record) -> list[Plateau]:
    """The extremes of the force at which it is constant for longer than its motion explains."""
    force, step = record.force, resolution(record.force)
    found = []
    for value in (float(np.max(force)), float(np.min(force))):
        longest = max(stop - start for start, stop in true_runs(_equal_to(force, value)))
        if longest >= FLAT and longest > 2.0 * _expected_at_turn(force, value, step):
            found.append(Plateau(value, longest))
    return found


def is_flat(force: Vector, extreme: float, noise: float) -> bool:
    """Whether a force with this r.m.s. noise stays near an extreme for longer than a smooth signal that turns there.

    A smooth one is within a share of a band for the root of that share of its time there, a clipped one for nearly all.
    Taken for flat where the noise is too large to tell.
    """
    band = _BAND * float(np.ptp(force))
    reach = max(_REACH * noise, resolution(force), 1e-6 * band)
    if reach > _WIDE * band:
        return True
    near, within = (
        max(stop - start for start, stop in true_runs(np.abs(force - extreme) <= width)) for width in (reach, band)
    )
    return near >= FLAT and near > (reach / band) ** 0.25 * within


def _equal_to(force: Vector, value: float) -> NDArray[np.bool_]:
    return np.asarray(np.abs(force - value) <= 1e-9 * abs(value))


def _expected_at_turn(force: Vector, extreme: float, step: float) -> float:
    """Samples of a smooth signal within one step of its extreme, estimated from those within 10 % of its range."""
    if step == 0.0:
        return 1.0
    band = max(0.1 * float(np.ptp(force)), 4.0 * step)
    longest = max(stop - start for start, stop in true_runs(np.abs(force - extreme) <= band))
    return max(1.0, longest * math.sqrt(step / band))
