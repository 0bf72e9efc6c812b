"""Verdicts on claims of the paper, statement by statement: shown, contradicted or undetermined, by one rule (`RULE`).

What happens somewhere is the opposite of what is nowhere. Noise can make a statement undetermined, and never shown.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from math import hypot, inf

import scipy
import xarray as xr

from inerter.papers.wang_su_2008.between import Found
from inerter.papers.wang_su_2008.paper import CLAIMS
from inerter.papers.wang_su_2008.rows import SimulatedRow

RULE = (
    "A statement is shown if the 95 % confidence interval of the quantity in it lies inside the range that it names, "
    "contradicted if it lies outside, and undetermined if it reaches across an end. What is said of every stiffness "
    "has to be shown at each; to contradict it takes a difference that is certain among so many (Bonferroni). In "
    "brackets: the verdict; that on the printed number if there is one, which stands for the values within half of its "
    "last step; the detectable difference, which is shown in nine of ten cases. ±: half the confidence interval."
)
_RISK = 0.05  # of an interval that misses
_DETECTED = 0.9  # of differences as large as the power that is stated


class ClaimVerdict(StrEnum):
    """Verdict of the evidence on a statement."""

    SHOWN = "shown"
    CONTRADICTED = "contradicted"
    UNDETERMINED = "undetermined"

    @property
    def opposite(self) -> ClaimVerdict:
        """The verdict on the contrary statement."""
        return _OPPOSITE.get(self, self)


_OPPOSITE = {ClaimVerdict.SHOWN: ClaimVerdict.CONTRADICTED, ClaimVerdict.CONTRADICTED: ClaimVerdict.SHOWN}


def combined_verdict(verdicts: Iterable[ClaimVerdict]) -> ClaimVerdict:
    """The verdict on several statements together: contradicted by any, shown only by all."""
    found = set(verdicts)
    for verdict in (ClaimVerdict.CONTRADICTED, ClaimVerdict.UNDETERMINED):
        if verdict in found:
            return verdict
    return ClaimVerdict.SHOWN


@dataclass(frozen=True)
class EstimatedQuantity:
    """A quantity as it was found: its value, standard error and degrees of freedom, and why it may be wrong if it may.

    A standard error of 0 is that of a computed optimum or norm, which does not scatter.
    """

    value: float
    error: float = 0.0
    freedom: float = inf
    doubt: str = ""  # the status of an estimate in it that is not ok

    def half_width(self, comparisons: int = 1) -> float:
        """Half the 95 % confidence interval, or one so wide that so many hold together with that confidence."""
        return _quantile(1.0 - 0.5 * _RISK / comparisons, self.freedom) * self.error

    def detectable(self, comparisons: int = 1) -> float:
        """Distance of a true value from the end of a range that is detected in nine of ten cases."""
        return self.half_width(comparisons) + _quantile(_DETECTED, self.freedom) * self.error

    def minus(self, other: EstimatedQuantity) -> EstimatedQuantity:
        """Difference of two independent quantities."""
        return EstimatedQuantity(
            self.value - other.value,
            hypot(self.error, other.error),
            min(self.freedom, other.freedom),
            self.doubt or other.doubt,
        )

    def times(self, factor: float) -> EstimatedQuantity:
        """Quantity times a factor, as for another unit."""
        return replace(self, value=factor * self.value, error=abs(factor) * self.error)


def _quantile(share: float, freedom: float) -> float:
    # As `scipy.stats` has them, which takes a quarter of a second to load, in each process anew.
    return float(scipy.special.ndtri(share) if freedom == inf else scipy.special.stdtrit(freedom, share))


def within(found: EstimatedQuantity, low: float = -inf, high: float = inf, comparisons: int = 1) -> ClaimVerdict:
    """Whether a quantity lies from `low` to `high`, by its 95 % confidence interval."""
    reach = found.half_width(comparisons)
    if found.doubt or not abs(found.value) < inf:
        return ClaimVerdict.UNDETERMINED
    if low <= found.value - reach and found.value + reach <= high:
        return ClaimVerdict.SHOWN
    if found.value + reach < low or found.value - reach > high:
        return ClaimVerdict.CONTRADICTED
    return ClaimVerdict.UNDETERMINED


def everywhere(found: Sequence[EstimatedQuantity], low: float = -inf, high: float = inf) -> ClaimVerdict:
    """Whether all quantities lie from `low` to `high`."""
    if all(within(one, low, high) is ClaimVerdict.SHOWN for one in found):
        return ClaimVerdict.SHOWN
    certain = [within(one, low, high, len(found)) for one in found]
    return ClaimVerdict.CONTRADICTED if ClaimVerdict.CONTRADICTED in certain else ClaimVerdict.UNDETERMINED


def somewhere_above(found: Sequence[EstimatedQuantity], level: float) -> ClaimVerdict:
    """Whether any quantity lies above `level`."""
    return everywhere(found, high=level).opposite


def rounding_interval(printed: float, step: float) -> tuple[float, float]:
    """Range of values that round to `printed`, in multiples of `step`."""
    return printed - 0.5 * step, printed + 0.5 * step


@dataclass(frozen=True)
class ClaimPart:
    """One statement of a claim: the finding, the verdict on it, and the verdict on the printed number.

    `power` is the smallest detectable difference, in words; empty where nothing scatters.
    """

    found: str
    verdict: ClaimVerdict
    number: ClaimVerdict | None = None  # None: no number is printed, or what has it was not shown
    power: str = ""

    @property
    def text(self) -> str:
        """Finding and verdicts as text."""
        number = f"; printed number {self.number}" if self.number is not None else ""
        power = f"; detectable: {self.power}" if self.power else ""
        return f"{self.found} [{self.verdict}{number}{power}]"


def statement(
    found: str,
    verdict: ClaimVerdict,
    number: ClaimVerdict | None = None,
    *,
    by: Sequence[EstimatedQuantity] = (),
    unit: str = "%",
    at_once: int = 1,
) -> ClaimPart:
    """A statement judged by quantities in `unit`; `at_once` are those compared for one verdict."""
    power = max((one.detectable(at_once) for one in by), default=0.0)
    doubts = dict.fromkeys(one.doubt for one in by if one.doubt)
    said = f"unreliable ({'; '.join(doubts)}): {found}" if doubts else found
    kept = number if verdict is ClaimVerdict.SHOWN else None
    return ClaimPart(said, verdict, kept, f"{power:.2g} {unit}" if power > 0.0 else "")


@dataclass(frozen=True)
class Claim:
    """Claim of the paper, with the verdicts on its statements."""

    number: int
    parts: Sequence[ClaimPart]
    note: str = ""

    @property
    def statement(self) -> str:
        """The claim as the paper states it."""
        return CLAIMS[self.number]

    @property
    def verdict(self) -> ClaimVerdict:
        """Verdict on all statements together."""
        return combined_verdict(part.verdict for part in self.parts)

    @property
    def printed_numbers(self) -> ClaimVerdict | None:
        """Verdict on the printed numbers of all statements; None if no number is printed or shown."""
        found = [part.number for part in self.parts if part.number is not None]
        return combined_verdict(found) if found else None

    @property
    def headline(self) -> str:
        """The verdict in words, with how many statements it rests on, and that on the printed numbers."""
        alike = sum(part.verdict is self.verdict for part in self.parts)
        some = "" if self.verdict is ClaimVerdict.SHOWN else f" in {alike} of {len(self.parts)} statements"
        numbers = self.printed_numbers
        return f"{self.verdict}{some}" + (f"; printed numbers {numbers}" if numbers is not None else "")

    @property
    def evidence(self) -> str:
        """Findings and verdicts of all statements as text."""
        return "; ".join(part.text for part in self.parts) + "." + (f" {self.note}" if self.note else "")


@dataclass(frozen=True, eq=False)
class Evidence:
    """Results by which claims are judged; None or empty where not computed."""

    figure11: xr.Dataset | None = None
    between: Found = field(default_factory=dict)  # its swept values; there if Figure 11 is
    curves: xr.Dataset | None = None  # of Figures 11, 13 and 14
    rows: dict[tuple[int, str], SimulatedRow] = field(default_factory=dict)  # by table and "index case"
    linear: dict[tuple[int, str], float] = field(default_factory=dict)  # exact norms, the same

    def has_tables(self, *tables: int) -> bool:
        """Whether simulated rows of each of these tables are available."""
        return all(any(table == key[0] for key in self.rows) for table in tables)

    def improvement(self, table: int, index: str, case: int) -> EstimatedQuantity:
        """Improvement of a row over the traditional suspension of its table [%].

        Of the exact values; a row that was not simulated is linear and has its norm.
        """
        found, base = (self._exact(table, f"{index} {n}") for n in (case, 1))
        ratio = found.value / base.value
        error = 100.0 * ratio * hypot(found.error / found.value, base.error / base.value)
        return replace(found.minus(base), value=100.0 * (1.0 - ratio), error=error)

    def cost(self, table: int, index: str, ideal: int, other: int) -> EstimatedQuantity:
        """Percentage points of the improvement that `other` loses to `ideal`."""
        return self.improvement(table, index, ideal).minus(self.improvement(table, index, other))

    def _exact(self, table: int, name: str) -> EstimatedQuantity:
        row = self.rows.get((table, name))
        return EstimatedQuantity(self.linear[table, name]) if row is None else exact_value(row)


def exact_value(row: SimulatedRow) -> EstimatedQuantity:
    """The exact value of a simulated row."""
    freedom = row.exact_realisations - 1 if row.exact_realisations > 1 else inf
    return EstimatedQuantity(row.exact, row.exact_error, freedom, row.exact_doubt)


def kilo(values: Iterable[float], between: str = " and ", digits: int = 1) -> str:
    """Values in thousands, as stiffnesses in kN/m."""
    return between.join(f"{value / 1e3:.{digits}f}" for value in values) or "(no crossing)"
