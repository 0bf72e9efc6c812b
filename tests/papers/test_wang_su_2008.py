"""The printed linear numbers of Wang and Su (2008)."""

from __future__ import annotations

import csv
from dataclasses import replace
from importlib.resources import files
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled

from inerter.files.study.checking import check_study
from inerter.files.study.running import run_study
from inerter.files.study.study import Study
from inerter.methods.norm import Norm
from inerter.optimisation.optimise import optimise
from inerter.papers.wang_su_2008.linear import compared_row, found_design
from inerter.papers.wang_su_2008.source import PrintedRow, linear_rows, study

ROWS = linear_rows()
DESIGNS = [row for row in ROWS if row.table < 3]


def name(row: PrintedRow) -> str:
    return f"table{row.table}-{row.index}-{row.layout}"


def source(row: PrintedRow) -> Study:
    return study(row.study)


def test_all_linear_rows_are_there() -> None:
    assert [sum(row.table == table for row in ROWS) for table in (1, 2, 3)] == [15, 21, 21]


@pytest.mark.parametrize("row", DESIGNS, ids=name)
def test_linear_values_of_tables_1_and_2(row: PrintedRow) -> None:
    """Equal to the printed value within one unit of its last digit."""
    assert abs(compared_row(row).paper2008 - float(row.printed)) <= row.last_digit


@pytest.mark.parametrize("row", [row for row in ROWS if row.table == 3], ids=name)
def test_table_3_repeats_table_2(row: PrintedRow) -> None:
    """Its linear values are those of Table 2, some with a zero for a digit that Table 2 does not have."""
    (same,) = (other for other in DESIGNS if (other.table, other.index, other.case) == (2, row.index, row.case))
    assert float(same.printed) == float(row.printed)
    assert same.parameters == row.parameters


@pytest.mark.parametrize("table", [1, 2])
def test_designs_are_read_from_the_results_of_their_study(table: int, tmp_path: Path) -> None:
    row = next(row for row in DESIGNS if (row.table, row.index, row.layout) == (table, "J1", "S1"))
    whole = source(row)
    one = replace(whole, layouts={row.layout: whole.layouts[row.layout]}, indices=(row.index,), baseline=row.layout)
    found = found_design(row, run_study(one, tmp_path / "results", jobs=1))
    assert abs(found.value - float(row.printed)) <= row.last_digit
    assert set(found.parameters) == set(row.parameters)
    assert 1 <= found.agreed <= found.starts


def test_two_seeds_find_one_peak_gain_to_the_last_digits() -> None:
    """Fewer peaks than values are equal at the optimum, so that their frequencies decide on its place."""
    table2 = study("table2")
    first, second = (
        optimise(table2.design("S2-hard"), table2.index("J5"), Norm(table2.conventions), seed=seed).value
        for seed in (0, 2)
    )
    assert abs(first / second - 1.0) < 1e-12


ALWAYS = [row for row in DESIGNS if row.table == 1 or row.layout == "S1"]
OFTEN = [row for row in DESIGNS if (row.table, row.index, row.layout) == (2, "J5", "S3-soft")]


@pytest.mark.parametrize("row", sampled(DESIGNS, ALWAYS, often=OFTEN, kept=2), ids=name)
def test_designs_are_found_from_scratch(row: PrintedRow) -> None:
    """At or below the printed value, to its printed digits, from the widest bounds and with no hint."""
    vehicle = source(row).design(row.layout)
    bounds = {(free.lower, free.upper) for free in vehicle.free_values().values()}
    assert bounds <= {(10.0, 1e6), (0.01, 1e5)}
    best = optimise(vehicle, source(row).index(row.index), Norm("paper2008"))
    assert best.status.ok
    assert best.value <= float(row.printed) + 0.5 * row.last_digit + 1e-9 * best.value


@pytest.mark.parametrize(
    ("layout", "index"),
    sampled(
        product(["S1", "S2-soft", "S3", "S3-hard"], ["J1", "J3", "J5"]),
        [("S1", "J1"), ("S1", "J3"), ("S1", "J5")],
        kept=0,
    ),
)
def test_seeds_agree_on_the_half_car(layout: str, index: str) -> None:
    half = study("table2")
    values = [optimise(half.design(layout), half.index(index), Norm("paper2008"), seed=seed).value for seed in (1, 2)]
    assert np.ptp(values) <= (1e-4 if index == "J5" else 1e-6) * min(values)


@pytest.mark.parametrize(
    "part", sampled(["table1", "table2", "figure11", "friction1", "friction2"], ["table1", "table2"], ["friction1"])
)
def test_studies_can_be_run(part: str) -> None:
    check_study(study(part))


def test_last_digit_is_that_of_the_printed_text() -> None:
    digits = {row.printed: row.last_digit for row in ROWS}
    assert digits["2.9882"] == pytest.approx(1e-4)
    assert digits["3.8761e-5"] == pytest.approx(1e-9)
    assert digits["1044.30"] == pytest.approx(0.01)


def test_tables_hold_the_rows_with_friction_too() -> None:
    text = (files("inerter.papers.wang_su_2008") / "data" / "table2.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert len(rows) == 39
    assert sum("friction" in row["nonlinearity"] for row in rows) == 39 - 21
