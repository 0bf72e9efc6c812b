"""The linear part: norms of the printed designs, designs found from scratch, and the elastic effect of Figure 11."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inerter.files.study.running import StudyResult
from inerter.methods.method import evaluate
from inerter.methods.norm import Norm
from inerter.papers.wang_su_2008.source import PrintedRow, linear_rows

STUDIES = ("table1", "table2", "figure11")


@dataclass(frozen=True)
class ComparedRow:
    """Printed row with the value of the same design under both conventions."""

    row: PrintedRow
    unit: str
    paper2008: float
    exact: float

    @property
    def off_by(self) -> float:
        """Difference between `paper2008` and the printed value, in units of the last printed digit."""
        return (self.paper2008 - float(self.row.printed)) / self.row.last_digit

    @property
    def agrees(self) -> bool:
        """Whether the difference is at most one unit of the last printed digit."""
        return abs(self.off_by) <= 1.0


@dataclass(frozen=True)
class FoundDesign:
    """Best design found for a printed row."""

    row: PrintedRow
    unit: str
    value: float
    parameters: dict[str, float]
    agreed: int
    starts: int

    @property
    def gain_percent(self) -> float:
        """Reduction of the found value below the printed one [%]."""
        return 100.0 * (1.0 - self.value / float(self.row.printed))


@dataclass(frozen=True, eq=False)
class LinearTables:
    """Recomputed linear results of the paper's tables."""

    compared: list[ComparedRow]
    found: list[FoundDesign]


def recompute(studies: dict[str, StudyResult]) -> LinearTables:
    """Every linear number of Tables 1 to 3, and the designs of Tables 1 and 2 as the studies find them."""
    rows = linear_rows()
    return LinearTables(
        [compared_row(row) for row in rows], [found_design(row, studies[row.study]) for row in rows if row.table < 3]
    )


def compared_row(row: PrintedRow) -> ComparedRow:
    """The printed design evaluated under both conventions."""
    index = row.asks()
    values = [evaluate(row.design(), index, Norm(conventions)).value for conventions in ("paper2008", "exact")]
    return ComparedRow(row, index.unit, *values)


def found_design(row: PrintedRow, result: StudyResult) -> FoundDesign:
    """Optimum of a study that belongs to a printed row, with the number of searches that found it."""
    best = result.data.sel({"layout": row.layout, "index": row.index, "method": "norm"})
    values = zip(best.parameter.values.tolist(), best.parameter_value.values.tolist(), strict=True)
    parameters = {name: value for name, value in values if np.isfinite(value)}
    unit = str(best.index_unit.item())
    return FoundDesign(row, unit, float(best.value), parameters, int(best.agreed), int(best.starts))
