"""Trade-offs of study files: fronts are those of Python, in files, in words and in a figure."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from study_text import assert_refused, assert_survives, load_text, study_text

import inerter as it
from inerter.errors import StudyError
from inerter.figures.study import study_figures
from inerter.figures.style import style_context
from inerter.files.study.running import StudyResult, run_study
from inerter.files.study.study import Study
from inerter.files.study.tasks import TaskResults
from inerter.report.page import report
from inerter.report.study_contents import StudyContents
from inerter.report.text import table_lines
from inerter.table import records
from inerter.tasks.fronts import FrontAnswer, Fronts

FREE = """k = "30 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = { from = "1 kg", to = "2000 kg" }"""
ASK = 'trade_off = ["J1", "tyre-load"]\noptimise = "norm"\npoints = 5\n'


def study_of(folder: Path, settings: str, elements: str = FREE) -> Study:
    return load_text(folder, study_text(settings, elements=elements))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> StudyResult:
    folder = tmp_path_factory.mktemp("front")
    return run_study(study_of(folder, ASK), folder / "out")


@pytest.mark.campaign
def test_a_front_is_that_of_python(found: StudyResult) -> None:
    study = found.study
    assert study.indices == ("J1", "tyre-load")
    for layout in study.layouts:
        by_hand = it.pareto_front(
            study.design(layout), [it.RideComfort(study.road), it.TyreLoad(study.road)], it.Norm(), points=5, seed=0
        )
        row = found.data.sel(layout=layout)
        np.testing.assert_array_equal(row["front_value"].values[: len(by_hand.values)], by_hand.values)
        assert np.flatnonzero(row["front_knee"].values).tolist() == [by_hand.knee]
        for i, index in enumerate(study.indices):  # its ends are the single optima
            best = float(row["value"].sel(index=index).item())
            assert float(row["front_value"][:, i].min()) == pytest.approx(best, rel=1e-6)


def test_the_table_has_a_row_a_point_that_is_its_design(found: StudyResult) -> None:
    with (found.folder / "fronts.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == int(np.isfinite(found.data["front_value"].sel(criterion="J1")).sum())
    for row in rows:
        design = found.study.design(row["layout"])
        values = {
            name: float(row[f"{name} [{unit}]"])
            for name, unit in (("c", "N s/m"), ("b", "kg"))
            if name in design.free_values()
        }
        alone = it.evaluate(design.with_values(values), it.TyreLoad(found.study.road), it.Norm())
        assert float(row["tyre-load [N]"]) == pytest.approx(alone.value, rel=1e-9)
        assert 0.0 < float(row["tyre-load_error_bound"]) < 1e-9
        assert row["tyre-load_standard_error"] == ""
        assert row["status"] == "ok"
    assert [row["knee"] for row in rows].count("yes") == 2


def test_a_front_is_told_and_drawn(found: StudyResult, tmp_path: Path) -> None:
    results = TaskResults(found.study, found.data, found.answers)
    (sentence,) = Fronts().sentences(results)
    assert sentence.startswith("Trade-off between ride comfort and dynamic tyre load, at the knee: S1 ")
    assert "designs of S1" in sentence
    table = Fronts().table(results)
    assert max(map(len, table_lines(table))) <= 80
    shown = [tuple(cell.text for cell in cells[:2]) for _, cells in table.shown_rows()]
    assert shown[:3] == [("S1", "least J1"), ("S1", "knee"), ("S1", "least tyre-load")]
    (figure,) = [figure for figure in study_figures(found.data) if figure.name == "front"]
    title = found.data["front_value"].attrs["title"]
    assert all(text.startswith(title) for text in (sentence, table.caption, figure.caption))
    with style_context():
        figure.draw().draw_without_rendering()
    page = report(StudyContents(found.data, found.study, found.answers), tmp_path)
    assert ">Trade-off</h2>" in page
    assert re.search(r'>S2</th>\s*<td class="words">knee</td>', page)


@pytest.mark.parametrize(
    ("settings", "more", "words"),
    [
        (
            'quantile = 0.9\ntolerance = { b = "5 %" }',
            "",
            "ride comfort, 90 % quantile and dynamic tyre load, 90 % quantile",
        ),
        (
            'conditions = "worst"',
            '[[conditions]]\n"road.speed" = "15 m/s"\n[[conditions]]\n"road.speed" = "30 m/s"',
            "ride comfort, worst over conditions and dynamic tyre load, worst over conditions",
        ),
    ],
)
def test_a_front_says_of_which_values_it_is(tmp_path: Path, settings: str, more: str, words: str) -> None:
    """The first layout may have none of the elements with tolerances."""
    study = study_of(tmp_path, f"{ASK}{settings}\n{more}")
    assert Fronts().table(TaskResults(study, xr.Dataset(), [])).caption.startswith(f"Trade-off between {words}: ")
    answer = FrontAnswer(
        layout="S2", status="ok", values=[[2.0, 500.0]], parameters=[{"c": 7e3}], statuses=["ok"], jumps=[], knee=0
    )
    (sentence,) = Fronts().sentences(TaskResults(study, xr.Dataset(), [answer]))
    assert sentence.startswith(f"Trade-off between {words}, at the knee: S2 ")


def test_values_of_a_front_have_the_digits_that_their_errors_allow(tmp_path: Path) -> None:
    study = study_of(tmp_path, ASK)
    known = {"layout": "S2", "status": "ok", "values": [[2.0123, 512.34]], "parameters": [{"c": 7e3}]}
    for errors, words in (
        ({}, "2.012 m/s^2 and 512.3 N"),
        ({"error_bounds": [[0.03, 0.03]]}, "2 m/s^2 and 510 N"),
        ({"standard_errors": [[0.05, 20.0]], "error_bounds": [[None, None]]}, "2.012 +- 0.050 m/s^2 and 512 +- 20 N"),
    ):
        answer = FrontAnswer(**known, statuses=["ok"], jumps=[], knee=0, **errors)
        (sentence,) = Fronts().sentences(TaskResults(study, xr.Dataset(), [answer]))
        assert words in sentence
        (row,) = records(Fronts().table(TaskResults(study, xr.Dataset(), [answer])))
        for key, given in (("error_bound", "error_bounds"), ("standard_error", "standard_errors")):
            assert [row[f"{name}_{key}"] for name in study.trade_off] == errors.get(given, [[None, None]])[0]


@pytest.mark.parametrize("method", [it.Norm(), it.StatisticalLinearisation()])
def test_a_front_knows_the_errors_of_its_values(method: it.Method) -> None:
    free = it.Spring(60e3) | it.Damper(it.free(1e3, 1e4, name="c")) | it.Friction(100.0)
    road = it.Road(5e-7, 25.0)
    front = it.pareto_front(
        it.QuarterCar(250.0, 35.0, 180e3, free), [it.RideComfort(road), it.TyreLoad(road)], method, points=3
    )
    np.testing.assert_array_equal([[one.value for one in row] for row in front.estimates], front.values)
    assert all(one.error_bound > 0.0 for row in front.estimates for one in row)


@pytest.mark.campaign
def test_an_interrupted_front_goes_on_to_the_same_bytes(found: StudyResult, tmp_path: Path) -> None:
    again = run_study(found.study, tmp_path / "again").folder
    journal = again / "journal.jsonl"
    journal.write_bytes(b"".join(journal.read_bytes().splitlines(keepends=True)[:-1]))
    run_study(found.study, again, resume=True)
    for name in ("fronts.csv", "summary.csv", "results.nc"):
        assert (again / name).read_bytes() == (found.folder / name).read_bytes()
    with xr.open_dataset(again / "results.nc") as stored:
        np.testing.assert_array_equal(stored["front_value"], found.data["front_value"])


@pytest.mark.marathon
def test_a_front_within_limits_that_nothing_keeps_says_so(tmp_path: Path) -> None:
    study = study_of(tmp_path, ASK + 'subject_to = { J3 = { at_most = "1 N" } }')
    result = run_study(study, tmp_path / "out")
    assert [front.status for front in result.answers] == ["infeasible"] * 2
    assert any(line.startswith("front of S1: infeasible") for line in result.failures)
    table = Fronts().table(TaskResults(study, result.data, result.answers))
    assert all("infeasible" in row.status for row in table.rows)
    assert all(cell.content is None for row in table.rows for cell in row.cells[3:-1])
    assert "front" not in [figure.name for figure in study_figures(result.data)]
    assert report(StudyContents(result.data, study), tmp_path)


def test_a_trade_off_survives_being_written(found: StudyResult, tmp_path: Path) -> None:
    assert_survives(found.study, tmp_path)


BAD: dict[str, tuple[str, str, list[str]]] = {
    "of one": ('trade_off = ["J1"]\noptimise = "norm"', "study.trade_off", ["1 indices", "two or three"]),
    "of four": (
        'trade_off = ["J1", "J3", "J5", "suspension-travel"]\noptimise = "norm"',
        "study.trade_off",
        ["4 indices"],
    ),
    "of the same": (
        'indices = ["J1"]\ntrade_off = ["J1", "ride-comfort"]\noptimise = "norm"',
        "study.trade_off",
        ["the same index twice"],
    ),
    "of nothing": ('trade_off = ["J1", "J9"]\nindices = ["J1"]\noptimise = "norm"', "study.trade_off", ['"J9"']),
    "a word": ('trade_off = "J1"\nindices = ["J1"]\noptimise = "norm"', "study.trade_off", ["expected a list"]),
    "two points": (ASK.replace("points = 5", "points = 2"), "study.points", ["from 3 to 1000"]),
    "few points of three": (
        'trade_off = ["J1", "J3", "J5"]\noptimise = "norm"\npoints = 4',
        "study.points",
        ["at least 6"],
    ),
    "points of nothing": ('indices = ["J1"]\noptimise = "norm"\npoints = 7', "study.points", ["no front"]),
    "over a sweep": (ASK + 'sweep = { k = ["1 N/m", "2 N/m"] }', "study.trade_off", ["together with a sweep"]),
}


@pytest.mark.parametrize(("settings", "place", "words"), BAD.values(), ids=BAD)
def test_a_bad_trade_off_is_refused_with_its_place(tmp_path: Path, settings: str, place: str, words: list[str]) -> None:
    assert_refused(lambda: study_of(tmp_path, settings), place, words)


def test_a_trade_off_needs_a_search(tmp_path: Path) -> None:
    fixed = 'k = "20 kN/m"\nc = "1 kN s/m"\nb = "30 kg"'
    with pytest.raises(StudyError, match=r"study\.trade_off: nothing is optimised"):
        study_of(tmp_path, 'trade_off = ["J1", "J3"]', fixed)
