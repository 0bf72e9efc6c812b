"""Simulated rows of Tables 1 to 3 under both conventions, compared with the printed values."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf, isfinite, log, pi, sqrt

from inerter.methods.approximate_linear import ApproximateLinear
from inerter.methods.expected_value import ExpectedValue
from inerter.methods.method import Estimate, Method, evaluate
from inerter.methods.norm import Norm
from inerter.norms.hinf import GainPeak
from inerter.papers.wang_su_2008.source import PrintedRow, linear_rows, simulated_rows
from inerter.signals.harmonics import sine
from inerter.simulation.simulate import simulate

RUNS = 4  # simulations that the paper averages
_ERROR = 1e-3  # relative standard error of what we call exact
_RUN = 20.0  # [s] of a sine from rest, as short as those of the paper can have been
_CHANCE = 3.0  # standard errors of a difference between two means of four runs
VERDICTS = EQUAL, WITHIN, STARTED, EITHER, OTHER_PEAK, DIFFERS = (
    "agrees to the printed digits",
    "within the scatter of four runs",
    "as from a start at rest",
    "either of several peaks",
    "another peak",
    "differs",
)


@dataclass(frozen=True)
class SimulatedRow:
    """Printed row with its simulated values under both conventions."""

    row: PrintedRow
    unit: str
    paper2008: float
    paper2008_error: float
    exact: float
    exact_error: float
    peaks: tuple[GainPeak, ...]  # local maxima over all frequencies, for J5 by a sine
    gains_from_rest: tuple[float, ...] = ()  # at their frequencies in a short run from rest
    exact_realisations: int = 0  # random inputs of the exact value; 0 if it does not scatter
    exact_doubt: str = ""  # its status where that is not ok
    improvement: float | None = None  # of `paper2008` over the norm of S1, for rows of Method 1 [%]

    @property
    def difference(self) -> float:
        """Relative difference of `paper2008` from the printed value."""
        return self.paper2008 / self.row.value - 1.0

    @property
    def score(self) -> float | None:
        """Difference of `paper2008` from the printed mean of four runs, in standard errors; None without scatter."""
        if not self.paper2008_error > 0.0:
            return None
        return (self.paper2008 - self.row.value) / (sqrt(2.0) * self.paper2008_error)

    @property
    def nearest(self) -> GainPeak | None:
        """The local maximum of J5 that the printed value follows most closely."""
        return min(self.peaks, key=lambda peak: abs(log(peak.gain / self.row.value)), default=None)

    @property
    def verdict(self) -> str:
        """Verdict on the agreement with the printed value, as text."""
        if abs(self.paper2008 - self.row.value) <= 1.000001 * self.row.last_digit:
            return EQUAL
        if self.score is not None:
            return WITHIN if abs(self.score) <= _CHANCE else DIFFERS
        if not self.compatible:
            return DIFFERS
        if self.peaks[0] not in self.compatible:
            return OTHER_PEAK
        return EITHER if len(self.candidates) > 1 else STARTED

    @property
    def compatible(self) -> tuple[GainPeak, ...]:
        """The local maxima of J5 whose steady gain is the printed value or more, and in a short run less."""
        pairs = zip(self.peaks, self.gains_from_rest, strict=True) if self.gains_from_rest else ()
        digit, value = self.row.last_digit, self.row.value
        return tuple(peak for peak, short in pairs if short - digit <= value <= peak.gain + digit)

    @property
    def candidates(self) -> tuple[GainPeak, ...]:
        """Peaks among `compatible` whose gains differ in print."""
        found: list[GainPeak] = []
        for peak in self.compatible:
            if all(abs(peak.gain - other.gain) > self.row.last_digit for other in found):
                found.append(peak)
        return tuple(found)


def names(table: int) -> list[str]:
    """Names of the rows of a table: index and case."""
    return [f"{row.index} {row.case}" for row in simulated_rows(table)]


def compute(table: int, name: str) -> dict[str, object]:
    """Numbers of one row, for JSON."""
    row = _row(table, name)
    as_printed, exactly = _methods(table)
    exact = evaluate(row.design(), row.asks(), exactly)
    by_sine = row.index == "J5" and table != 2  # does not scatter: both conventions ask for the same
    paper = exact if by_sine else evaluate(row.design(), row.asks(), as_printed)
    return {
        "unit": exact.unit,
        "paper2008": paper.value,
        "paper2008_error": total_error(paper),
        "exact": exact.value,
        "exact_error": total_error(exact),
        "exact_realisations": exact.realisations,
        "exact_doubt": exact.status.doubt,
        "peaks": [[peak.omega, peak.gain] for peak in exact.peaks],
        "begun": [_gain_from_rest(row, peak) for peak in exact.peaks] if by_sine else [],
        "improvement": None if table != 2 else 100.0 * (1.0 - paper.value / _norm_of_s1(row)),
        "status": [str(paper.status), str(exact.status)],
    }


def total_error(found: Estimate) -> float:
    """Standard error of a sampled value together with the bound of its other errors; zero without sampling."""
    if not found.standard_error:
        return 0.0
    bound = found.error_bound if isfinite(found.error_bound) else 0.0
    return hypot(found.standard_error, bound * found.value)


def _norm_of_s1(row: PrintedRow) -> float:
    """H2 or H-infinity norm of the traditional suspension, to which the improvements of Table 2 refer."""
    base = next(r for r in linear_rows() if (r.table, r.index, r.layout) == (row.table, row.index, "S1"))
    return evaluate(base.design(), base.asks(), Norm("paper2008")).value


def row_from_json(table: int, name: str, found: dict[str, object]) -> SimulatedRow:
    """Row from its numbers in JSON."""
    lists = ("peaks", "begun", "status", "seconds")
    numbers = {key: value for key, value in found.items() if key not in lists}
    peaks = tuple(GainPeak(*pair) for pair in found["peaks"])  # type: ignore[attr-defined]
    gains: tuple[float, ...] = tuple(found["begun"])  # type: ignore[arg-type]
    return SimulatedRow(_row(table, name), peaks=peaks, gains_from_rest=gains, **numbers)  # type: ignore[arg-type]


def _methods(table: int) -> tuple[Method, Method]:
    """Method with the settings of the paper, and with those of the exact value."""
    if table == 2:
        return ApproximateLinear(realisations=RUNS, conventions="paper2008"), ApproximateLinear()
    return ExpectedValue(realisations=RUNS, conventions="paper2008", jobs=1), ExpectedValue(
        relative_error=_ERROR, jobs=1
    )


def _row(table: int, name: str) -> PrintedRow:
    return next(row for row in simulated_rows(table) if f"{row.index} {row.case}" == name)


def _gain_from_rest(row: PrintedRow, peak: GainPeak) -> float:
    """R.m.s. displacement over r.m.s. force in a short run from rest, at the frequency of a peak."""
    if not 0.0 < peak.omega < inf:
        return peak.gain
    mechanism = row.design().mechanism()
    definition = row.asks().definition(mechanism)
    (path,), (output,) = definition.input_paths(mechanism), definition.outputs
    pushed = sine(definition.amplitude or 1.0, peak.omega / (2.0 * pi))
    run = simulate(row.design(), forces={path.input: pushed}, duration=_RUN, step=1e-3)
    return abs(output.weight) * run.rms(output.output) / run.rms(path.input)
