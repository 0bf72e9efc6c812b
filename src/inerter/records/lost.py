"""Samples that a recorder lost while its clock, as written, went on evenly: where the displacement leaps along itself.

Before and after such a place the displacement is smooth; across it, it moves in one interval as far as it would have
in several. A spike, a step or a kink does not continue itself with some samples in between, and is none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.records.gaps import LONGEST, fill
from inerter.records.record import Record
from inerter.records.remedy import Action, Remedy
from inerter.records.smoothing import resolution

Vector = NDArray[np.float64]
_POINTS = 8  # samples on either side through which a parabola is laid
_SURE = 8.0  # standard deviations of what the two parabolas are apart where nothing is lost
_MOST = 200  # samples that may be lost at one place
_AROUND, _DEGREE = 12, 5  # samples on either side of a loss, and of the polynomial through all of them
_STEP = 4.0  # ratio of what a loss and a step leave, from which on one of them is clearly right
_WHOLE, _SAME = 0.25, 0.25  # how far from a whole number of samples, and from one velocity, a loss may look
MAD = 1.4826  # standard deviations in a median absolute deviation


@dataclass(frozen=True)
class Loss:
    """`count` samples are missing between sample `after` and the next."""

    after: int
    count: int


def losses(record: Record) -> list[Loss]:
    """Where samples are missing in a record whose times are even, and how many.

    A loss shows where the table moves on by more than its noise meanwhile; elsewhere it does no harm.
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
    noise = max(MAD * float(np.median(np.abs(leap - np.median(leap)))), _least(record, design))
    found: list[Loss | None] = []
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
            found.append(_counted(z, Loss(int(i) + points - 1, count), noise))
    return [loss for loss in found if loss is not None]


def _counted(z: Vector, loss: Loss, noise: float) -> Loss | None:
    """The same loss with the count that lets one polynomial through both sides leave the least.

    None if that is more than this noise (r.m.s.), as at a kink, or if the polynomial of an uninterrupted motion with a
    step fits as well; but a short loss is likelier than a step.
    """
    first, last = max(loss.after + 1 - _AROUND, 0), loss.after + 1 + _AROUND
    values = z[first:last]
    at = np.arange(first, first + values.size) - loss.after - 0.5
    later = np.where(at > 0.0, 1.0, 0.0)

    def left(count: int, step: bool = False) -> float:
        times = at + count * (later - 0.5)
        columns = np.polynomial.legendre.legvander(times / np.abs(times).max(), _DEGREE)
        columns = np.column_stack([columns, later]) if step else columns
        return float(np.sum((values - columns @ np.linalg.lstsq(columns, values)[0]) ** 2))

    count = min(range(max(loss.count - 3, 1), loss.count + 4), key=left)
    lost, stepped = left(count), left(0, step=True)
    likely = lost < _STEP * stepped if count <= LONGEST else _STEP * lost < stepped
    return Loss(loss.after, count) if likely and lost < values.size * noise**2 else None


def mended(record: Record, gaps: str | float) -> Record:
    """The record as `read_record(..., gaps=gaps)` gives it: as it is, with lost samples put in, or its longest part.

    Raises `RecordError` where more samples are lost at one place than `gaps` allows to put in.
    """
    lost = losses(record) if gaps != "refuse" else []
    if not lost:
        return record
    if gaps == "longest":
        cuts = [0, *(loss.after + 1 for loss in lost), record.time.size]
        start, stop = max(pairwise(cuts), key=lambda part: part[1] - part[0])
        said = f"Samples {start} to {stop - 1} were kept: the longest stretch in which none is lost."
        return record.samples(slice(start, stop), said)
    most = max(lost, key=lambda loss: loss.count)
    limit = LONGEST if isinstance(gaps, str) else math.floor(gaps / record.interval * (1.0 + 1e-6))
    if most.count > limit:
        raise RecordError(
            f"{record.source}: {most.count} samples are lost at {record.time[most.after]:g} s while the clock goes on, "
            f"too many to put in ({limit} at most). Use ",
            *(Remedy(Action.GAPS, "longest"), ", or a number of s if you trust an interpolation."),
        )
    return restored(record, lost)[0]


def restored(record: Record, lost: list[Loss]) -> tuple[Record, NDArray[np.bool_]]:
    """The record with the lost samples put in by cubic splines, and which of its samples were measured."""
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
            changes[role] = fill(time, spread, ~measured)
    said = f"Samples that were lost while the clock went on, put in: {int(count.sum())}, at {len(lost)} places."
    return record.noted(said, time=time, **changes), measured


def _least(record: Record, design: Vector) -> float:
    """What the steps of the encoder alone keep two parabolas apart."""
    return resolution(record.displacement) / math.sqrt(6.0) * float(np.linalg.norm(design[0]))
