"""Points of a front while it is made: which of them stay, and how wide the gaps between them are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_SAME = 1e-4  # normalised distance up to which two points are one


@dataclass(frozen=True, eq=False)
class FrontPoint:
    """A design on the front: its point, its criteria, and these normalised."""

    point: Array
    values: Array
    normal: Array


def pair(found: Sequence[FrontPoint], i: int) -> tuple[bytes, bytes]:
    """What tells the gap behind a point from others."""
    return found[i].point.tobytes(), found[i + 1].point.tobytes()


def gaps(found: Sequence[FrontPoint], jumps: set[tuple[bytes, bytes]], which: Sequence[int]) -> list[tuple[float, int]]:
    """The widths of the gaps between neighbours that are no jumps, with their numbers."""
    table = np.array([one.normal for one in found])[:, list(which)]
    widths = np.linalg.norm(np.diff(table, axis=0), axis=1).tolist()
    return [(width, i) for i, width in enumerate(widths) if pair(found, i) not in jumps]


def beats(one: FrontPoint, other: FrontPoint) -> bool:
    """Whether one is better in a criterion by more than two points that are one differ, and worse in none."""
    gained = other.normal - one.normal
    return bool(np.all(gained >= -1e-12) and np.any(gained > _SAME))


def undominated(found: Sequence[FrontPoint], which: Sequence[int]) -> list[FrontPoint]:
    """Those that no other one is better than, each once, in order of the first criterion."""
    table = np.array([one.normal for one in found])[:, list(which)]
    kept: list[int] = []
    for i in np.lexsort(table.T[::-1]):
        better = np.all(table <= table[i] + 1e-12, axis=1) & np.any(table < table[i] - 1e-9, axis=1)
        twin = any(np.abs(table[i] - table[j]).max() < _SAME for j in kept)
        if not better.any() and not twin:
            kept.append(int(i))
    return [found[i] for i in kept]


def thinned(
    found: list[FrontPoint], count: int, which: Sequence[int], keep: FrontPoint | None = None
) -> list[FrontPoint]:
    """At most so many, without those that lie closest to their neighbours; the ends stay."""
    found = list(found)
    while len(found) > count:
        table = np.array([one.normal for one in found])[:, list(which)]
        width = np.linalg.norm(table[2:] - table[:-2], axis=1)
        if keep is not None:
            width = np.where([one is keep for one in found[1:-1]], np.inf, width)
        del found[1 + int(np.argmin(width))]
    return found


def sparse(found: list[FrontPoint], count: int, ends: Sequence[FrontPoint]) -> list[FrontPoint]:
    """At most so many of three criteria, without those that lie closest together; the ends stay."""
    found = list(found)
    while len(found) > count:
        table = np.array([one.normal for one in found])
        far = np.linalg.norm(table[:, None] - table[None], axis=2) + 1e9 * np.eye(len(found))
        fixed = [any(np.abs(row - end.normal).max() < _SAME for end in ends) for row in table]
        del found[int(np.argmin(np.where(fixed, np.inf, np.sort(far, axis=1)[:, :2].sum(axis=1))))]
    return found
