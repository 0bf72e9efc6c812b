"""Wang and Su (2008), Impact of inerter nonlinearities on vehicle suspension control: the linear part.

The paper's tables are data, its designs and Figure 11 are study files, and its claims are questions to their results.
Nothing here depends on a printed number but the comparison with it.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

import numpy as np
import scipy.optimize
import xarray as xr
from numpy.typing import NDArray

from inerter.methods.method import evaluate
from inerter.methods.norm import Norm
from inerter.optimisation.optimise import optimise
from inerter.study.file import load_study
from inerter.study.registry import INDEX
from inerter.study.run import FIGURES, REPORT, Progress, StudyResult, claimed, run_study
from inerter.study.values import Study
from inerter.vehicle.cars import Vehicle

KEY = "wang-su-2008"
STUDIES = ("table1", "table2", "figure11")
TABLES = ("linear-rows", "designs", "claims")
OWN_FILES = (*STUDIES, *(f"{name}.csv" for name in TABLES), FIGURES, REPORT)
_DATA = files("inerter.papers") / "data" / KEY
_LAYOUT_OF = {"none": "", "ideal": "", "elastic": "-soft", "elastic soft": "-soft", "elastic hard": "-hard"}
_WORSE = 1e-4  # two optima that differ by less, relatively, are equally good: no figure shows it
_DESIGN_COLUMNS = ("c", "b", "c_f", "c_r", "b_f", "b_r")


@dataclass(frozen=True)
class PrintedRow:
    """A linear row of a table: the design that was printed, and the value as it was printed."""

    table: int
    index: str
    case: int
    layout: str  # of the study files
    parameters: dict[str, float]
    printed: str

    @property
    def last_digit(self) -> float:
        """One unit of the last printed digit."""
        mantissa, _, exponent = self.printed.partition("e")
        decimals = len(mantissa.partition(".")[2])
        return 10.0 ** (int(exponent or 0) - decimals)


@dataclass(frozen=True)
class ComparedRow:
    """A printed row beside the value of the same design under both conventions."""

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
    """The best design that this software finds, beside the printed one."""

    row: PrintedRow
    unit: str
    value: float
    parameters: dict[str, float]
    agreed: int
    starts: int

    @property
    def gain_percent(self) -> float:
        """How much lower the found value is than the printed one."""
        return 100.0 * (1.0 - self.value / float(self.row.printed))


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, what was found, and the numbers that say so."""

    number: int
    statement: str
    verdict: str  # "holds", "holds with another number", "does not hold"
    evidence: str


@dataclass(frozen=True, eq=False)
class LinearReproduction:
    """Everything linear in the paper, recomputed."""

    compared: list[ComparedRow]
    found: list[FoundDesign]
    claims: list[Claim]
    figure11: xr.Dataset
    studies: dict[str, StudyResult]


def study(name: str) -> Study:
    """One of the studies `table1`, `table2` and `figure11`."""
    with as_file(_DATA / f"{name}.toml") as path:
        return load_study(path)


def printed_rows() -> list[PrintedRow]:
    """All rows of Tables 1 to 3 that are norms of a linear design."""
    return [row for table, column in ((1, "j_linear"), (2, "j"), (3, "j_linear")) for row in _rows(table, column)]


def reproduce_linear(
    folder: Path,
    *,
    jobs: int = 1,
    resume: bool = False,
    force: bool = False,
    progress: Progress = lambda done, total, outcome: None,
) -> LinearReproduction:
    """Recompute every linear number of Tables 1 to 3, find the designs anew, redraw Figure 11's data, judge claims 1-3.

    The three studies go to folders inside `folder`, and can be resumed there.

    Raises `StudyError` if `folder` holds something and neither `resume` nor `force` is given.
    """
    with claimed(folder, own=OWN_FILES, resume=resume, force=force):
        results = {
            name: run_study(study(name), folder / name, jobs=jobs, resume=resume, progress=progress) for name in STUDIES
        }
    rows = printed_rows()
    figure11 = results["figure11"]
    return LinearReproduction(
        compared=[compare(row) for row in rows],
        found=[_found(row, results[_study_name(row)]) for row in rows if row.table < 3],
        claims=[_claim_1(figure11), _claim_2(figure11), _claim_3(figure11)],
        figure11=figure11.data.sel({"method": "norm"}),
        studies=results,
    )


def compare(row: PrintedRow) -> ComparedRow:
    """The printed design evaluated under both conventions."""
    source = study(_study_name(row))
    design: Vehicle = source.design(row.layout).with_values(row.parameters)
    index = INDEX[row.index](source)
    values = [evaluate(design, index, Norm(conventions)).value for conventions in ("paper2008", "exact")]
    return ComparedRow(row, index.unit, *values)


def _study_name(row: PrintedRow) -> str:
    return "table1" if row.table == 1 else "table2"


def _rows(table: int, column: str) -> Iterator[PrintedRow]:
    lines = (_DATA / f"table{table}.csv").read_text(encoding="utf-8").splitlines()
    for entry in csv.DictReader(line for line in lines if not line.startswith("#")):
        if entry["nonlinearity"] in _LAYOUT_OF and entry[column]:
            yield PrintedRow(
                table,
                entry["index"],
                int(entry["case"]),
                entry["layout"] + _LAYOUT_OF[entry["nonlinearity"]],
                {name: float(entry[name]) for name in _DESIGN_COLUMNS if entry.get(name)},
                entry[column],
            )


def _found(row: PrintedRow, result: StudyResult) -> FoundDesign:
    best = result.data.sel({"layout": row.layout, "index": row.index, "method": "norm"})
    values = zip(best.parameter.values.tolist(), best.parameter_value.values.tolist(), strict=True)
    parameters = {name: value for name, value in values if np.isfinite(value)}
    unit = str(best.index_unit.item())
    return FoundDesign(row, unit, float(best.value), parameters, int(best.agreed), int(best.starts))


def _curve(result: StudyResult, layout: str, index: str) -> xr.DataArray:
    curve: xr.DataArray = result.data.value.sel({"layout": layout, "index": index, "method": "norm"})
    return curve


def _optimal(source: Study, layout: str, index: str, k: float) -> float:
    vehicle = source.design(layout, k)
    return optimise(vehicle, INDEX[index](source), Norm(source.conventions), seed=source.seed).value


def crossings(result: StudyResult, index: str, one: str, other: str) -> list[float]:
    """Stiffnesses k [N/m] between the swept values at which `one` becomes worse than `other`, or no longer is.

    Worse means by more than a hundredth of a per cent: where the static compliance decides J5, layouts are equally
    good.
    """
    source, k = result.study, result.data["k"].values
    excess = _excess(result, index, one, other)

    def gap(stiffness: float) -> float:
        values = [_optimal(source, layout, index, stiffness) for layout in (one, other)]
        return values[0] / values[1] - 1.0 - _WORSE

    changes = np.flatnonzero(np.diff(excess > _WORSE))
    return [float(scipy.optimize.brentq(gap, k[i], k[i + 1], rtol=1e-5)) for i in changes]


def _excess(result: StudyResult, index: str, one: str, other: str) -> NDArray[np.float64]:
    """How much higher the optimum of `one` is than that of `other`, relative, over the swept values."""
    return np.asarray(_curve(result, one, index).values / _curve(result, other, index).values - 1.0)


def _shrinks(result: StudyResult, index: str) -> tuple[bool, list[str]]:
    """Whether the optimum is worse with a hard shaft than with none, and worse still with a soft one, at every k."""
    holds, evidence = True, []
    base = _curve(result, "S1", index).values
    for layout in ("S2", "S3"):
        ideal, hard, soft = (_curve(result, layout + kind, index).values for kind in ("", "-hard", "-soft"))
        exceptions = result.data["k"].values[(hard < ideal * (1.0 - _WORSE)) | (soft < hard * (1.0 - _WORSE))]
        holds &= exceptions.size == 0
        losses = [100.0 * (curve - ideal) / base for curve in (hard, soft)]
        but = f", but not at k = {', '.join(f'{k / 1e3:.0f}' for k in exceptions)} kN/m" if exceptions.size else ""
        evidence.append(
            f"{layout}: the benefit shrinks by up to {losses[0].max():.2f} (hard) and {losses[1].max():.2f} (soft) "
            f"percentage points{but}"
        )
    return holds, evidence


def _claim_1(result: StudyResult) -> Claim:
    holds, evidence = _shrinks(result, "J1")
    return Claim(
        1,
        "Elastic effect only: the benefit in J1 shrinks, more so with the softer setting.",
        _verdict(holds),
        "; ".join(evidence) + ".",
    )


def _claim_2(result: StudyResult) -> Claim:
    lines, holds, places, gains = [], True, [], []
    for kind in ("soft", "hard"):
        excess = _excess(result, "J3", f"S3-{kind}", "S3")
        found = crossings(result, "J3", f"S3-{kind}", "S3")
        holds &= bool(excess[0] < 0.0 < excess[-1]) and len(found) == 1
        places += found
        gains.append(-100.0 * float(excess.min()))
        lines.append(f"{kind}: better below k = {_kilo(found)} kN/m, by at most {gains[-1]:.2f} %")
    as_printed = all(abs(place - 120e3) <= 5e3 for place in places)
    return Claim(
        2,
        "Elastic effect only: J3 of S3 is slightly better than with an ideal inerter below k = 120 kN/m, worse above.",
        _verdict(holds, as_printed),
        "; ".join(lines) + ".",
    )


def _claim_3(result: StudyResult) -> Claim:
    shrinks, evidence = _shrinks(result, "J5")
    near = False
    for kind in ("soft", "hard"):
        found = crossings(result, "J5", f"S3-{kind}", "S1")
        there = _optimal(result.study, f"S3-{kind}", "J5", 55e3) / _optimal(result.study, "S1", "J5", 55e3) - 1.0
        near |= there > _WORSE
        where = f", and worse from k = {_kilo(found, ' to ')} kN/m" if len(found) == 2 else ""
        evidence.append(f"at 55 kN/m S3 {kind} is {abs(100.0 * there):.2f} % {_worse(there)} than S1{where}")
    return Claim(
        3,
        "Elastic effect only: the benefit in J5 shrinks, more so with the softer setting; elastic S3 is worse than S1 "
        "near k = 55 kN/m.",
        _verdict(near, shrinks),
        "; ".join(evidence) + ".",
    )


def _verdict(holds: bool, as_printed: bool = True) -> str:
    return ("holds" if as_printed else "holds with another number") if holds else "does not hold"


def _worse(excess: float) -> str:
    return "worse" if excess > 0.0 else "better"


def _kilo(values: list[float], between: str = " and ") -> str:
    return between.join(f"{value / 1e3:.1f}" for value in values) or "(no crossing)"


def tables(reproduction: LinearReproduction) -> dict[str, list[dict[str, Any]]]:
    """The reproduction as plain rows, by the name of the file that holds them."""
    return {
        "linear-rows": [
            {
                "table": c.row.table,
                "index": c.row.index,
                "case": c.row.case,
                "layout": c.row.layout,
                "unit": c.unit,
                "printed": float(c.row.printed),
                "paper2008": c.paper2008,
                "exact": c.exact,
                "off_by_last_digits": c.off_by,
                "exact_over_printed_percent": 100.0 * (c.exact / float(c.row.printed) - 1.0),
                "agrees": c.agrees,
                **{f"{name} printed": value for name, value in c.row.parameters.items()},
            }
            for c in reproduction.compared
        ],
        "designs": [
            {
                "table": f.row.table,
                "index": f.row.index,
                "case": f.row.case,
                "layout": f.row.layout,
                "unit": f.unit,
                "printed": float(f.row.printed),
                "found": f.value,
                "gain_percent": f.gain_percent,
                "agreed": f.agreed,
                "starts": f.starts,
                **{f"{name} printed": value for name, value in f.row.parameters.items()},
                **{f"{name} found": value for name, value in f.parameters.items()},
            }
            for f in reproduction.found
        ],
        "claims": [
            {"claim": c.number, "statement": c.statement, "verdict": c.verdict, "evidence": c.evidence}
            for c in reproduction.claims
        ],
    }
