"""Points of a Pareto front during its computation: dominance, thinning, and gaps between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, Status

Array = NDArray[np.float64]
SAME = 1e-4  # normalised distance within which two points are equal


@dataclass(frozen=True, eq=False)
class FrontPoint:
    """A design on the front: its point, its criteria, these normalised, and the status of its search."""

    point: Array
    values: Array
    normal: Array
    status: Status = OK


def gap_key(found: Sequence[FrontPoint], i: int) -> tuple[bytes, bytes]:
    """Key of the gap after a point."""
    return found[i].point.tobytes(), found[i + 1].point.tobytes()


def gaps(found: Sequence[FrontPoint], jumps: set[tuple[bytes, bytes]], which: Sequence[int]) -> list[tuple[float, int]]:
    """Widths and numbers of the gaps between neighbours, except discontinuities."""
    table = np.array([one.normal for one in found])[:, list(which)]
    widths = np.linalg.norm(np.diff(table, axis=0), axis=1).tolist()
    return [(width, i) for i, width in enumerate(widths) if gap_key(found, i) not in jumps]


def dominates(one: FrontPoint, other: FrontPoint) -> bool:
    """Whether `one` is better in a criterion by more than the tolerance, and worse in none."""
    gained = other.normal - one.normal
    return bool(np.all(gained >= -1e-12) and np.any(gained > SAME))


def non_dominated(found: Sequence[FrontPoint], which: Sequence[int]) -> list[FrontPoint]:
    """The non-dominated points without duplicates, in order of the first criterion."""
    table = np.array([one.normal for one in found])[:, list(which)]
    kept: list[int] = []
    for i in np.lexsort(table.T[::-1]):
        better = np.all(table <= table[i] + 1e-12, axis=1) & np.any(table < table[i] - 1e-9, axis=1)
        twin = any(np.abs(table[i] - table[j]).max() < SAME for j in kept)
        if not better.any() and not twin:
            kept.append(int(i))
    return [found[i] for i in kept]


def thin_out(
    found: list[FrontPoint], count: int, which: Sequence[int], keep: FrontPoint | None = None
) -> list[FrontPoint]:
    """At most `count` points, without those closest to their neighbours; the ends are kept."""
    found = list(found)
    while len(found) > count:
        table = np.array([one.normal for one in found])[:, list(which)]
        width = np.linalg.norm(table[2:] - table[:-2], axis=1)
        if keep is not None:
            width = np.where([one is keep for one in found[1:-1]], np.inf, width)
        del found[1 + int(np.argmin(width))]
    return found


def triangle_steps(count: int) -> int:
    """The number of steps on each side of a triangle of at least `count` evenly spaced points."""
    return int(np.ceil(0.5 * (np.sqrt(8.0 * count + 1.0) - 3.0)))


def thin_out_triangle(found: list[FrontPoint], count: int, ends: Sequence[FrontPoint]) -> list[FrontPoint]:
    """At most `count` points of three criteria, without those closest together; the ends are kept."""
    found = list(found)
    while len(found) > count:
        table = np.array([one.normal for one in found])
        far = np.linalg.norm(table[:, None] - table[None], axis=2) + 1e9 * np.eye(len(found))
        fixed = [any(np.abs(row - end.normal).max() < SAME for end in ends) for row in table]
        del found[int(np.argmin(np.where(fixed, np.inf, np.sort(far, axis=1)[:, :2].sum(axis=1))))]
    return found
