"""Dropped samples without a gap in the time channel: instants at which the displacement skips ahead.

Before and after such an instant the displacement is smooth; across it, it moves in one interval as far as otherwise in
several. A spike, a step or a kink is not continued smoothly by inserting samples, and is not counted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.formatting import format_quantity
from inerter.records.gaps import LONGEST, fill_missing_values
from inerter.records.record import Record
from inerter.records.remedy import Action, Remedy
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
_POINTS = 8  # samples on either side through which a parabola is laid
_SURE = 8.0  # standard deviations of the distance between the two parabolas where nothing is lost
_MOST = 200  # samples that may be lost at one place
_AROUND, _DEGREE = 12, 5  # samples on either side of a loss, and of the polynomial through all of them
_STEP = 4.0  # ratio of the residuals of a dropout and a step from which one of them is preferred
_WHOLE, _SAME = 0.25, 0.25  # how far from a whole number of samples, and from one velocity, a loss may look
MAD = 1.4826  # standard deviations in a median absolute deviation


@dataclass(frozen=True)
class Dropout:
    """`count` samples are missing between sample `after` and the next."""

    after: int
    count: int


def find_dropouts(record: Record) -> list[Dropout]:
    """Dropped samples of a record whose times are even: positions and counts.

    A dropout is detectable where the table moves by more than its noise meanwhile; elsewhere it does no harm.
    """
    z, points = record.displacement, _POINTS
    if not record.uniform or z.size < 4 * points:
        return []
    at = np.arange(1 - points, 1)  # of the samples before; those after are their mirror image
    design = np.linalg.pinv(np.stack([np.ones(points), at - 0.5, (at - 0.5) ** 2], axis=1))
    windows = np.lib.stride_tricks.sliding_window_view(z, points)
    before, after = windows[:-points], windows[points:][:, ::-1]
    leap = after @ design[0] - before @ design[0]  # half an interval beyond either side
    rates = before @ design[1], -(after @ design[1])  # of one interval ...
    bends = 2.0 * (before @ design[2]), 2.0 * (after @ design[2])  # ... and how they change in one
    noise = max(MAD * float(np.median(np.abs(leap - np.median(leap)))), _resolution_limit(record, design))
    found: list[Dropout | None] = []
    for i in np.flatnonzero(np.abs(leap) > _SURE * noise):
        near = slice(max(i - points, 0), i + points + 1)
        if abs(leap[i]) < np.abs(leap[near]).max():
            continue
        rate = 0.5 * float(rates[0][i] + rates[1][i])
        apart = abs(float(rates[0][i] - rates[1][i]))
        count = round(float(leap[i]) / rate) if rate != 0.0 else 0
        slack = _WHOLE * abs(rate) + 4.0 * noise
        turned = 1.5 * (count + 1) * max(abs(float(bends[0][i])), abs(float(bends[1][i])))
        smooth = apart < _SAME * abs(rate) + turned + 4.0 * noise
        if 1 <= count <= _MOST and abs(leap[i] - count * rate) < slack and smooth:
            found.append(_fit_count(z, Dropout(int(i) + points - 1, count), noise))
    return [loss for loss in found if loss is not None]


def _fit_count(z: Vector, loss: Dropout, noise: float) -> Dropout | None:
    """The same dropout with the count for which one polynomial through both sides has the smallest residual.

    None if that residual exceeds this noise (r.m.s.), as at a kink, or if the polynomial of an uninterrupted motion
    with a step fits as well; but a short dropout is likelier than a step.
    """
    first, last = max(loss.after + 1 - _AROUND, 0), loss.after + 1 + _AROUND
    values = z[first:last]
    at = np.arange(first, first + values.size) - loss.after - 0.5
    later = np.where(at > 0.0, 1.0, 0.0)

    def residual(count: int, step: bool = False) -> float:
        times = at + count * (later - 0.5)
        columns = np.polynomial.legendre.legvander(times / np.abs(times).max(), _DEGREE)
        columns = np.column_stack([columns, later]) if step else columns
        return float(np.sum((values - columns @ np.linalg.lstsq(columns, values)[0]) ** 2))

    count = min(range(max(loss.count - 3, 1), loss.count + 4), key=residual)
    lost, stepped = residual(count), residual(0, step=True)
    likely = lost < _STEP * stepped if count <= LONGEST else _STEP * lost < stepped
    return Dropout(loss.after, count) if likely and lost < values.size * noise**2 else None


def fill_dropouts(record: Record, gaps: str | float) -> Record:
    """The record as returned by `read_record(..., gaps=gaps)`: unchanged, with dropouts filled, or its longest part.

    Raises `RecordError` where more samples are dropped at one instant than `gaps` allows to fill.
    """
    lost = find_dropouts(record) if gaps != "refuse" else []
    if not lost:
        return record
    if gaps == "longest":
        cuts = [0, *(loss.after + 1 for loss in lost), record.time.size]
        start, stop = max(pairwise(cuts), key=lambda part: part[1] - part[0])
        said = f"Samples {start} to {stop - 1} were kept: the longest part without dropped samples."
        return record.samples(slice(start, stop), said)
    most = max(lost, key=lambda loss: loss.count)
    limit = LONGEST if isinstance(gaps, str) else math.floor(gaps / record.interval * (1.0 + 1e-6))
    if most.count > limit:
        raise RecordError(
            f"{record.source}: {most.count} samples dropped at {format_quantity(record.time[most.after], 's', 6)} "
            f"without a gap in the time channel, too many to interpolate (at most {limit}). Use ",
            *(Remedy(Action.GAPS, "longest"), ", or a longer limit in s if interpolation is acceptable."),
        )
    return insert_samples(record, lost)[0]


def insert_samples(record: Record, lost: list[Dropout]) -> tuple[Record, NDArray[np.bool_]]:
    """The record with the dropped samples filled by cubic splines, and a mask of its measured samples."""
    count = np.zeros(record.time.size, dtype=np.int64)
    for loss in lost:
        count[loss.after] = loss.count
    measured = np.zeros(record.time.size + int(count.sum()), dtype=bool)
    place = np.arange(record.time.size) + np.concatenate([[0], np.cumsum(count)[:-1]])
    measured[place] = True
    time = record.time[0] + record.interval * np.arange(measured.size)
    changes = {}
    for role, values in record.channels().items():
        if role != "time":
            spread = np.zeros(measured.size)
            spread[measured] = values
            changes[role] = fill_missing_values(time, spread, ~measured)
    said = (
        f"Dropped samples without a gap in the time channel, interpolated: {int(count.sum())}, at {len(lost)} places."
    )
    return record.with_notes(said, time=time, **changes), measured


def _resolution_limit(record: Record, design: Vector) -> float:
    """Distance of the two parabolas that the resolution of the encoder alone causes."""
    return resolution(record.displacement) / math.sqrt(6.0) * float(np.linalg.norm(design[0]))
