"""The simulated rows of Tables 1 to 3, each by both conventions, and how they compare with what was printed."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Estimate, Method, evaluate
from inerter.methods.norm import Norm
from inerter.norms.hinf import Peak
from inerter.papers.wang_su_2008.source import PrintedRow, linear_rows, simulated_rows

RUNS = 4  # simulations that the paper averages
_ERROR = 1e-3  # relative standard error of what we call exact
# relative differences that the conventions, four runs and printed digits explain, by table
_TOLERANCES = {
    (1, "linear"): 1e-3,
    (1, "friction 10 N"): 2e-3,
    (1, "friction 100 N"): 7e-3,
    (3, "linear"): 3e-3,
    (3, "friction 10 N"): 8e-3,
    (3, "friction 100 N"): 8e-3,
    (2, "friction 10 N"): 15e-3,
    (2, "friction 20 N"): 15e-3,
}
VERDICTS = EQUAL, WITHIN, DIFFERS = "agrees to the printed digits", "within the tolerance", "differs"
_PEAK_TOLERANCE = {1: 3e-3, 2: 3e-2, 3: 3e-3}


@dataclass(frozen=True)
class SimulatedRow:
    """A printed row beside its values under both conventions."""

    row: PrintedRow
    unit: str
    paper2008: float
    paper2008_error: float
    exact: float
    exact_error: float
    peaks: tuple[Peak, ...]  # local maxima over all frequencies, for J5 by a sine
    omega: float | None  # of the one that the printed value belongs to [rad/s]
    improvement: float | None = None  # of `paper2008` over the norm of S1, for rows of Method 1 [%]

    @property
    def difference(self) -> float:
        """Relative difference of `paper2008` from the printed value."""
        return self.paper2008 / self.row.value - 1.0

    @property
    def tolerance(self) -> float:
        """The relative difference that is expected."""
        if self.row.index == "J5":
            return _PEAK_TOLERANCE[self.row.table]
        kind = self.row.nonlinearity.rpartition("+ ")[2] if self.row.has_friction else "linear"
        return _TOLERANCES[self.row.table, kind]

    @property
    def verdict(self) -> str:
        """In words."""
        if abs(self.paper2008 - self.row.value) <= 1.000001 * self.row.last_digit:
            return EQUAL
        return WITHIN if abs(self.difference) <= self.tolerance else DIFFERS


def names(table: int) -> list[str]:
    """What tells the rows of a table apart."""
    return [f"{row.index} {row.case}" for row in simulated_rows(table)]


def compute(table: int, name: str) -> dict[str, object]:
    """The numbers of one row, as JSON has them."""
    row = _row(table, name)
    as_printed, exactly = _methods(table)
    exact = evaluate(row.design(), row.asks(), exactly)
    if row.index == "J5" and table != 2:  # the paper followed one of the peaks that there are
        peak = _followed(row, exact)
        paper, error, omega, status = peak.gain, 0.0, peak.omega, exact.status
    else:
        estimate = evaluate(row.design(), row.asks(), as_printed)
        paper, error, omega, status = estimate.value, estimate.standard_error or 0.0, None, estimate.status
    return {
        "unit": exact.unit,
        "paper2008": paper,
        "paper2008_error": error,
        "exact": exact.value,
        "exact_error": exact.standard_error or 0.0,
        "peaks": [[peak.omega, peak.gain] for peak in exact.peaks],
        "omega": omega,
        "improvement": None if table != 2 else 100.0 * (1.0 - paper / _norm_of_s1(row)),
        "status": [str(status), str(exact.status)],
    }


def _norm_of_s1(row: PrintedRow) -> float:
    """The traditional suspension that the improvements of Table 2 are printed over."""
    base = next(r for r in linear_rows() if (r.table, r.index, r.layout) == (row.table, row.index, "S1"))
    return evaluate(base.design(), base.asks(), Norm("paper2008")).value


def judged(table: int, name: str, found: dict[str, object]) -> SimulatedRow:
    """A row from its numbers."""
    numbers = {key: value for key, value in found.items() if key not in ("peaks", "status", "seconds")}
    peaks = tuple(Peak(*pair) for pair in found["peaks"])  # type: ignore[attr-defined]
    return SimulatedRow(_row(table, name), peaks=peaks, **numbers)  # type: ignore[arg-type]


def _methods(table: int) -> tuple[Method, Method]:
    """The paper's method as the paper used it, and at its best."""
    if table == 2:
        return ApproximateLinear(realisations=RUNS, conventions="paper2008"), ApproximateLinear()
    return ExpectedValue(realisations=RUNS, conventions="paper2008", jobs=1), ExpectedValue(
        relative_error=_ERROR, jobs=1
    )


def _row(table: int, name: str) -> PrintedRow:
    return next(row for row in simulated_rows(table) if f"{row.index} {row.case}" == name)


def _followed(row: PrintedRow, estimate: Estimate) -> Peak:
    """The local maximum that the paper must have followed: the one whose height is closest to the printed value."""
    return min(estimate.peaks, key=lambda peak: abs(log(peak.gain / row.value)))
