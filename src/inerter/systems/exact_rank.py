"""Linear algebra of incidence rows in fractions: what is independent of what is decided without a tolerance.

Levers of a vehicle are doubles, and so are their products with whole numbers; nothing here rounds before the end.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Row = list[Fraction]
FractionRows = list[Row]


def exact(matrix: NDArray[np.float64]) -> FractionRows:
    """The rows of a matrix of doubles, which are fractions."""
    known: dict[float, Fraction] = {}
    return [[known.setdefault(x, Fraction(x)) for x in row] for row in matrix.tolist()]


def to_matrix(rows: FractionRows, columns: int) -> NDArray[np.float64]:
    """Rows of fractions as a matrix of so many columns."""
    return np.array([[float(x) for x in row] for row in rows]).reshape(len(rows), columns)


def transpose(rows: FractionRows, columns: int) -> FractionRows:
    """The transpose of rows of so many columns."""
    return [[row[j] for row in rows] for j in range(columns)]


def product(left: FractionRows, right: FractionRows, columns: int) -> FractionRows:
    """Left @ right, where right has so many columns."""
    zero = Fraction(0)
    result = []
    for row in left:
        total = [zero] * columns
        for x, other in zip(row, right, strict=True):
            if x:
                total = [t + x * y if y else t for t, y in zip(total, other, strict=True)]
        result.append(total)
    return result


class Basis:
    """Independent rows, reduced one by one, each with the combination it results from."""

    def __init__(self) -> None:
        self.reduced: list[tuple[int, Row]] = []  # the place of the leading one, and the row

    def rest(self, row: Sequence[Fraction]) -> Row:
        """Remainder of `row` after subtraction of its part in the span of the basis; zero if the row lies in it."""
        rest = list(row)
        for place, known in self.reduced:
            factor = rest[place]
            if factor:
                rest = [x - factor * y if y else x for x, y in zip(rest, known, strict=True)]
        return rest

    def add(self, row: Sequence[Fraction]) -> bool:
        """Add a row; False if the basis spans it already."""
        rest = self.rest(row)
        place = next((i for i, x in enumerate(rest) if x), None)
        if place is None:
            return False
        self.reduced.append((place, [x / rest[place] for x in rest]))
        return True


def independent(rows: FractionRows, before: FractionRows | None = None) -> list[int]:
    """Numbers of the first rows that, with those `before`, are independent and span all rows."""
    basis = Basis()
    for row in before or []:
        basis.add(row)
    return [i for i, row in enumerate(rows) if basis.add(row)]


def null_space(rows: FractionRows, columns: int) -> FractionRows:
    """A basis (as rows) of the vectors that every row annihilates, with an identity block in it."""
    spanned = Basis()
    for row in rows:
        spanned.add(row)
    solved: list[tuple[int, Row]] = []
    for place, row in reversed(spanned.reduced):
        for other, known in solved:
            if row[other]:
                factor = row[other]
                row = [x - factor * y for x, y in zip(row, known, strict=True)]
        solved.append((place, row))
    leading = {place for place, _ in solved}
    basis = []
    for free in range(columns):
        if free not in leading:
            vector = [Fraction(int(i == free)) for i in range(columns)]
            for place, row in solved:
                vector[place] = -row[free]
            basis.append(vector)
    return basis


def weights(rows: FractionRows, targets: FractionRows) -> list[Row | None]:
    """Coefficients with which the rows sum to each target; None where the target is not in their span."""
    count, zero = len(rows), Fraction(0)
    basis = Basis()
    for i, row in enumerate(rows):
        basis.add([*row, *(Fraction(int(i == j)) for j in range(count))])
    found: list[Row | None] = []
    for target in targets:
        rest = basis.rest([*target, *([zero] * count)])
        found.append(None if any(rest[: len(target)]) else [-x for x in rest[len(target) :]])
    return found
