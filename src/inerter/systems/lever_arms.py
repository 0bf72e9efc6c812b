"""Exact levers: rows that depend on others up to rounding are replaced by rational combinations of them.

Levers of a vehicle are doubles, and whoever wrote them had to round: 0.1 + 0.2 and 0.3 are one lever, though two
doubles, and an anti-roll strut whose lever is a sum depends on the struts at the wheels but for the last digit. Taken
by that digit they are independent by 1e-17: states that tell them apart are 1e16 times what they are made of, numbers
without a digit, and a gain that is infinite is 1e29. Nothing said so. So a row that is near to a combination of others
becomes that combination, in fractions, before anything is decided without a tolerance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.systems import exact_rank
from inerter.systems.exact_rank import FractionRows, Row
from inerter.systems.graph import Graph
from inerter.systems.incidence import incidence_rows

Matrix = NDArray[np.float64]
RANK_TOLERANCE = 1e-9  # incidence rows are scaled to one, and levers of a vehicle lie within a few decades
_LOST = 1e-7  # of a travel that rounding takes where it is made of others that nearly depend on each other
_SIMPLE = 8  # the largest denominator of a share that is taken for a simple one, such as 1 or 1/2


@dataclass(frozen=True)
class BranchRows:
    """Rows of a graph's branches over nodes and some roads, springs first, then dampers: these decide what is one."""

    shape: tuple[int, int]
    data: bytes
    nodes: int

    @staticmethod
    def of(graph: Graph, roads: Sequence[int]) -> BranchRows:
        """Branch rows of a graph over its nodes and the roads of these numbers."""
        on_nodes, on_roads = incidence_rows(
            sorted(graph.branches, key=lambda branch: branch.element.linear.order), graph
        )
        rows = np.hstack([on_nodes, on_roads[:, list(roads)]])
        return BranchRows(rows.shape, rows.tobytes(), len(graph.nodes))

    def exact_rows(self, rows: Matrix) -> FractionRows:
        """Rows over nodes, or over nodes and roads, with nearly dependent levers replaced by exact ones."""
        return [list(_snap_row(self, row.tobytes())) for row in np.asarray(rows, dtype=np.float64)]


@dataclass(frozen=True, eq=False)
class _Basis:
    """First independent rows, columns in which they differ most, and the inverse of this submatrix."""

    rows: FractionRows
    columns: tuple[int, ...]
    inverse: FractionRows
    reach: Row  # of rounding, in each column


@lru_cache(maxsize=4096)
def _snap_row(span: BranchRows, data: bytes) -> tuple[Fraction, ...]:
    given, basis = exact_rank.exact(np.frombuffer(data)[None])[0], _basis(span)
    if basis is None:
        return tuple(given)
    shares = exact_rank.product([[given[i] for i in basis.columns]], basis.inverse, len(basis.rows))[0]
    made = exact_rank.product([[_simple(share) for share in shares]], basis.rows, span.shape[1])[0]
    near = [abs(x - z) <= reach for x, z, reach in zip(given, made, basis.reach, strict=False)]
    if not all(near[: span.nodes]):
        return tuple(given)
    return tuple(z if so else x for x, z, so in zip(given, made, near, strict=False))


def _simple(share: Fraction) -> Fraction:
    """A simple fraction in place of a share that is it but for rounding: zero, one, a half."""
    near = share.limit_denominator(_SIMPLE)
    return near if abs(near - share) <= Fraction(RANK_TOLERANCE) else share


@lru_cache(maxsize=256)
def _basis(span: BranchRows) -> _Basis | None:
    """Basis of the rows of a graph's branches; None if all levers are integers, which are exact."""
    rows = np.frombuffer(span.data).reshape(span.shape)
    nodes = rows[:, : span.nodes]
    if np.array_equal(nodes, np.round(nodes)):
        return None
    sizes = np.abs(nodes).max(axis=0)
    scaled = nodes / np.where(sizes > 0.0, sizes, 1.0)
    chosen = independent_rows(scaled)
    columns = distinct_columns(scaled[chosen])
    square = exact_rank.exact(nodes[chosen][:, columns])
    inverse = exact_rank.weights(square, exact_rank.exact(np.eye(len(chosen))))
    found = [row for row in inverse if row is not None]
    reach = exact_rank.exact(RANK_TOLERANCE * np.abs(rows).max(axis=0)[None])[0]
    return _Basis(exact_rank.exact(rows[chosen]), tuple(columns), found, reach)


def is_lost(shares: Matrix, motions: Matrix, most: float = _LOST) -> bool:
    """Whether rounding takes more than `most` of travels that are `shares` of others, which move as `motions`.

    Where travels differ by 1e-8 of their size, shares of them are as large as 1e8, and what they add up to is not.
    """
    if not motions.size or not len(shares):
        return False
    terms, size = np.abs(shares) @ np.abs(motions), np.abs(shares @ motions).max()
    return bool(np.finfo(float).eps * terms.max() > most * size)


def lost_travel_message(shares: Matrix, labels: Sequence[str]) -> str:
    """Message on travels for which `is_lost` holds; `labels` are those of the elements."""
    worst = int(np.argmax(np.abs(shares).max(axis=1)))
    return (
        f"The travel of {labels[worst]!r} depends on those of others up to a relative difference of 1e-9 to 1e-6, "
        f"which is lost to rounding. Give equal levers to all digits, or let them differ by more."
    )


def independent_rows(rows: Matrix, spanned: Matrix | None = None) -> list[int]:
    """Numbers of the first rows that, with the orthonormal rows `spanned`, are independent and span all rows."""
    directions = np.zeros((0, rows.shape[1])) if spanned is None else spanned
    chosen: list[int] = []
    for i, row in enumerate(rows):
        size = np.linalg.norm(row)
        if size == 0.0:
            continue
        residual = row / size
        for _ in range(2):  # twice is enough for Gram-Schmidt
            residual = residual - directions.T @ (directions @ residual)
        if np.linalg.norm(residual) > RANK_TOLERANCE:
            directions = np.vstack([directions, residual / np.linalg.norm(residual)])
            chosen.append(i)
    return chosen


def orthonormal_null_space(rows: Matrix, tolerance: float) -> Matrix:
    """An orthonormal basis (as columns) of the vectors that every row annihilates, by singular values.

    This and `distinct_columns` are in NumPy, since SciPy's linear algebra loads for twice as long as NumPy, which a
    command that only checks a file would wait for.
    """
    _, singular, right = np.linalg.svd(rows)
    return np.asarray(right[np.count_nonzero(singular > tolerance * singular.max(initial=0.0)) :].T)


def distinct_columns(rows: Matrix) -> list[int]:
    """Numbers of the columns in which independent rows differ most, one for each row (QR with column pivoting)."""
    rest, chosen = rows, list[int]()
    for _ in rows:
        sizes = np.linalg.norm(rest, axis=0)
        chosen.append(int(np.argmax(sizes)))
        direction = rest[:, chosen[-1]] / sizes[chosen[-1]]
        rest = rest - np.outer(direction, direction @ rest)
    return chosen
