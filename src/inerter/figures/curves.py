"""Curves of many samples, drawn as few points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
_MOST_POINTS = 4000  # of a curve; more are drawn as the range that they cover


def thin_curve(time: Matrix, values: Matrix, most: int = _MOST_POINTS) -> tuple[Matrix, Matrix]:
    """Visually identical curve with about `most` points or fewer: lowest and highest sample of each piece.

    Values that are no numbers are breaks in the curve.
    """
    size = -(-2 * time.size // most)
    if size < 3:
        return time, values
    at = np.array([i for piece in _pieces(time.size, size) for i in _extremes(values, piece)])
    return time[at], values[at]


def thinned_band(time: Matrix, low: Matrix, high: Matrix) -> tuple[Matrix, Matrix, Matrix]:
    """Visually identical band with about 2000 points or fewer: lowest and highest edge of each piece."""
    size = -(-2 * time.size // _MOST_POINTS)
    if size < 3:
        return time, low, high
    starts = np.arange(0, time.size, size)
    return time[starts], np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)


def _pieces(count: int, size: int) -> Iterator[slice]:
    yield from (slice(i, min(i + size, count)) for i in range(0, count, size))


def _extremes(values: Matrix, piece: slice) -> list[int]:
    part = values[piece]
    known = np.flatnonzero(~np.isnan(part))
    if known.size < part.size:
        breaks = [piece.start + int(np.argmax(np.isnan(part)))]
        if not known.size:
            return breaks
        ends = {piece.start + int(known[i(part[known])]) for i in (np.argmin, np.argmax)}
        return sorted({*breaks, *ends})
    return sorted({piece.start + int(np.argmin(part)), piece.start + int(np.argmax(part))})
