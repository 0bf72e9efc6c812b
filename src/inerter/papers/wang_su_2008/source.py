"""Printed tables of the paper as data, and its designs as study files."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import as_file, files

from inerter.files.study.loading import load_study
from inerter.files.study.study import Study
from inerter.indices.definition import Index
from inerter.indices.load_carrying import LoadCarrying
from inerter.vehicle.vehicle import Vehicle

_DATA = files("inerter.papers.wang_su_2008") / "data"
_LINEAR = {"none": "", "ideal": "", "elastic": "-soft", "elastic soft": "-soft", "elastic hard": "-hard"}
_FRICTION = {
    "friction 10 N": "-10N",
    "friction 20 N": "-20N",
    "friction 100 N": "-100N",
    "elastic + friction 10 N": "-soft-10N",
    "elastic soft + friction 10 N": "-soft-10N",
}
_DESIGN_COLUMNS = ("c", "b", "c_f", "c_r", "b_f", "b_r")
_FORCE = {"quarter-car": 1000.0, "half-car": 2000.0}  # amplitudes of the sine for J5 [N]


@dataclass(frozen=True)
class PrintedRow:
    """A row of a table: the design that was printed, and the value as it was printed."""

    table: int
    index: str
    case: int
    nonlinearity: str
    layout: str  # of the study files
    parameters: dict[str, float]
    printed: str
    improvement: str  # as printed, per cent; empty where there is none

    @property
    def value(self) -> float:
        """The printed number."""
        return float(self.printed)

    @property
    def last_digit(self) -> float:
        """Value of one unit of the last printed digit."""
        mantissa, _, exponent = self.printed.partition("e")
        decimals = len(mantissa.partition(".")[2])
        return 10.0 ** (int(exponent or 0) - decimals)

    @property
    def has_friction(self) -> bool:
        """Whether the design has friction."""
        return self.nonlinearity in _FRICTION

    @property
    def study(self) -> str:
        """Name of the study file that has its layout."""
        half = "1" if self.table == 1 else "2"
        return ("friction" if self.has_friction else "table") + half

    @property
    def title(self) -> str:
        """The design in words."""
        kind = "" if self.nonlinearity == "none" else f", {self.nonlinearity}"
        return f"{self.layout.split('-')[0]}{kind}"

    def design(self) -> Vehicle:
        """The printed design."""
        vehicle: Vehicle = study(self.study).design(self.layout).with_values(self.parameters)
        return vehicle

    def asks(self) -> Index:
        """Index of the row, with the settings of its study."""
        return index_of(self.index, study(self.study))


def index_of(symbol: str, source: Study) -> Index:
    """Index as defined in the paper: J5 with the amplitude of its force, others with the settings of the study."""
    return LoadCarrying(amplitude=_FORCE[source.model]) if symbol == "J5" else source.index(symbol)


@cache
def study(name: str) -> Study:
    """Study of that name: `table1`, `table2`, `figure11`, `friction1` or `friction2`."""
    with as_file(_DATA / f"{name}.toml") as path:
        return load_study(path)


def linear_rows() -> list[PrintedRow]:
    """All rows of Tables 1 to 3 that are norms of a linear design."""
    found = [row for table, column in ((1, "j_linear"), (2, "j"), (3, "j_linear")) for row in _rows(table, column)]
    return [row for row in found if not row.has_friction]


def simulated_rows(table: int) -> list[PrintedRow]:
    """The rows of a table that were simulated: by the expected value in Tables 1 and 3, by Method 1 in Table 2."""
    if table == 2:
        return [row for row in _rows(2, "j") if row.has_friction]
    return list(_rows(table, "expectation"))


def _rows(table: int, column: str) -> Iterator[PrintedRow]:
    lines = (_DATA / f"table{table}.csv").read_text(encoding="utf-8").splitlines()
    for entry in csv.DictReader(line for line in lines if not line.startswith("#")):
        if entry[column]:
            yield PrintedRow(
                table,
                entry["index"],
                int(entry["case"]),
                entry["nonlinearity"],
                entry["layout"] + {**_LINEAR, **_FRICTION}[entry["nonlinearity"]],
                {name: float(entry[name]) for name in _DESIGN_COLUMNS if entry.get(name)},
                entry[column],
                entry["improvement_percent"],
            )
