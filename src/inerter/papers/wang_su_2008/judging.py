"""How claims of the paper are judged: part by part, each with what was found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import xarray as xr

from inerter.papers.wang_su_2008.between import Found
from inerter.papers.wang_su_2008.rows import SimulatedRow

HOLDS, OTHER_NUMBER, IN_PART, FAILS = "holds", "holds with another number", "holds in part", "does not hold"


@dataclass(frozen=True)
class Statement:
    """One statement within a claim: what was found, whether it holds, and with the number that the paper gives."""

    found: str
    holds: bool
    as_printed: bool = True


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and what became of its parts."""

    number: int
    statement: str
    parts: tuple[Statement, ...]
    note: str = ""

    @property
    def verdict(self) -> str:
        """In words: of all parts together."""
        holding = [part.holds for part in self.parts]
        if all(holding):
            return HOLDS if all(part.as_printed for part in self.parts) else OTHER_NUMBER
        return IN_PART if any(holding) else FAILS

    @property
    def evidence(self) -> str:
        """What was found, with a word on each part that does not hold where others do."""
        mixed = self.verdict == IN_PART
        said = [f"{part.found}{' [does not hold]' if mixed and not part.holds else ''}" for part in self.parts]
        return "; ".join(said) + "." + (f" {self.note}" if self.note else "")


@dataclass(frozen=True, eq=False)
class Evidence:
    """What claims are judged by; None or empty where that part was not computed."""

    figure11: xr.Dataset | None = None
    between: Found = field(default_factory=dict)  # its swept values; there if Figure 11 is
    curves: xr.Dataset | None = None  # of Figures 11, 13 and 14
    rows: dict[tuple[int, str], SimulatedRow] = field(default_factory=dict)  # by table and "index case"
    linear: dict[tuple[int, str], float] = field(default_factory=dict)  # exact norms, the same

    def has_tables(self, *tables: int) -> bool:
        """Whether the simulated rows of these tables are there."""
        return all(any(table == key[0] for key in self.rows) for table in tables)

    def improvement(self, table: int, index: str, case: int) -> tuple[float, float]:
        """Improvement of a row over the traditional suspension of its table [%], and its standard error.

        Of the exact values; a row that was not simulated is linear and has its norm.
        """
        (value, error), (base, base_error) = (self._exact(table, f"{index} {n}") for n in (case, 1))
        ratio = value / base
        return 100.0 * (1.0 - ratio), 100.0 * ratio * ((error / value) ** 2 + (base_error / base) ** 2) ** 0.5

    def cost(self, table: int, index: str, ideal: int, other: int) -> tuple[float, float]:
        """Percentage points of the improvement that `other` loses to `ideal`, and the standard error."""
        (best, error), (worse, other_error) = (self.improvement(table, index, case) for case in (ideal, other))
        return best - worse, (error**2 + other_error**2) ** 0.5

    def _exact(self, table: int, name: str) -> tuple[float, float]:
        row = self.rows.get((table, name))
        return (self.linear[table, name], 0.0) if row is None else (row.exact, row.exact_error)


def is_near(value: float, printed: float, step: float, error: float = 0.0) -> bool:
    """Whether a value could have been told as `printed`, which goes in steps; it is known to a standard error."""
    return abs(value - printed) <= 0.5 * step + 2.0 * error


def kilo(values: Iterable[float], between: str = " and ", digits: int = 1) -> str:
    """Values in thousands, as stiffnesses in kN/m."""
    return between.join(f"{value / 1e3:.{digits}f}" for value in values) or "(no crossing)"
