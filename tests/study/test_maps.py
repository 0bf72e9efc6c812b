"""Two places swept at once: the cases, the files, and that each point is the study of its numbers."""

from __future__ import annotations

import csv
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from campaigns import sampled
from study_text import study_text
from synthetic import terminal_text

from inerter.figures.study import draw_study, study_figures
from inerter.figures.style import style_context
from inerter.files.study.cases import cases
from inerter.files.study.loading import load_study
from inerter.files.study.running import run_study
from inerter.files.study.study import Study
from inerter.report.index_summary import sweep_headlines
from inerter.report.page import report
from inerter.report.study_contents import StudyContents
from inerter.report.tables import map_tables
from inerter.report.text import WIDTH

SWEEP = (
    'sweep = { "vehicle.sprung_mass" = ["300 kg", "200 kg", "400 kg"], '
    'k = { from = "30 kN/m", to = "90 kN/m", points = 2 } }'
)
ELEMENTS = """k = "60 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = { from = "1 kg", to = "2000 kg" }"""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = tmp_path_factory.mktemp("map") / "map.toml"
    text = study_text(f'indices = ["J1", "J3"]\noptimise = "norm"\n{SWEEP}', elements=ELEMENTS)
    path.write_text(text, encoding="utf-8")
    return load_study(path)


@pytest.fixture(scope="module")
def folder(study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "out"
    run_study(study, folder)
    return folder


@pytest.fixture
def data(folder: Path) -> xr.Dataset:
    with xr.open_dataset(folder / "results.nc") as stored:
        return stored.load()


def test_cases_go_through_all_pairs_the_second_place_first(study: Study) -> None:
    everything = cases(study)
    pairs = list(product((300.0, 200.0, 400.0), (30e3, 90e3)))
    assert [(c.layout, c.index, c.swept) for c in everything] == [
        (layout, index, pair) for layout in study.layouts for index in study.indices for pair in pairs
    ]
    assert [everything.number(case) for case in everything] == list(range(len(everything)))


@pytest.mark.campaign
def test_each_point_is_the_study_of_its_numbers(study: Study, data: xr.Dataset, tmp_path: Path) -> None:
    """The same designs, to the last digit, as a study in whose file the numbers stand."""
    assert data["value"].dims == ("layout", "index", "vehicle.sprung_mass", "k", "method")
    assert (data["vehicle.sprung_mass"].attrs["units"], data["k"].attrs["units"]) == ("kg", "N/m")
    for i, (mass, k) in enumerate(product((300.0, 200.0, 400.0), (30e3, 90e3))):
        alone = run_study(study.at((mass, k)), tmp_path / f"{i}").data
        here = data.sel({"vehicle.sprung_mass": mass, "k": k})
        for name in ("value", "improvement", "parameter_value", "other_value", "agreed", "status"):
            np.testing.assert_array_equal(here[name].values, alone[name].values)


def test_rows_of_the_table_say_where_they_are(folder: Path, data: xr.Dataset) -> None:
    with (folder / "summary.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == data["status"].size
    for row in rows:
        place = {"vehicle.sprung_mass": float(row["vehicle.sprung_mass [kg]"]), "k": float(row["k [N/m]"])}
        design = data.sel(layout=row["layout"], index=row["index"], **place).sel({"method": row["method"]})
        assert float(row["value"]) == float(design["value"])
        assert float(row["improvement_percent"]) == float(design["improvement"])


@pytest.mark.parametrize("kept", sampled([0, 5, 11, 23], seldom=[0, 5, 11]))
def test_a_map_goes_on_to_the_same_bytes(study: Study, folder: Path, tmp_path: Path, kept: int) -> None:
    """What the journal has is not computed again, and one process or two write the same."""
    again = tmp_path / "again"
    run_study(study, again)
    journal = again / "journal.jsonl"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[: kept + 1]))
    result = run_study(study, again, resume=True)
    assert result.computed == len(cases(study)) - kept
    for name in ("summary.csv", "results.nc", "study.resolved.toml"):
        assert (again / name).read_bytes() == (folder / name).read_bytes()


def test_a_map_is_told_in_words_that_fit(data: xr.Dataset) -> None:
    text = terminal_text(data)
    assert max(map(len, text.splitlines())) <= WIDTH
    assert "over sprung mass in kg in rows and k in kN/m in columns" in " ".join(text.split())
    better = data["improvement"].sel(layout="S2", index="J1").squeeze("method")
    most = better.where(better == better.max(), drop=True)
    place = f"sprung mass = {float(most['vehicle.sprung_mass'][0]):g} kg, k = {float(most['k'][0]) / 1e3:g} kN/m"
    assert place in sweep_headlines(data)[0]
    count = int((better >= 0.05).sum())
    assert f"S2 is better than S1 at {count}" in text


@pytest.mark.campaign
def test_the_figures_of_a_map_are_drawn_and_captioned(study: Study, data: xr.Dataset, tmp_path: Path) -> None:
    names = [figure.name for figure in study_figures(data)]
    assert names == ["map-J1", "map-c-J1", "map-b-J1", "map-J3", "map-c-J3", "map-b-J3"]
    files = draw_study(data.isel(index=[0], parameter=[0]), tmp_path)
    assert [file.stat().st_size > 1000 for file in files] == [True] * 4
    page = report(StudyContents(data, study), tmp_path)
    assert "over sprung mass and k" in page
    assert page.count('role="img"') == 2


def test_tables_of_a_map_hold_the_numbers_of_its_points(data: xr.Dataset) -> None:
    (first, *_) = map_tables(data)
    assert [column.heading for column in first.columns[1:]] == ["30", "90"]
    assert [row.cells[0].text for row in first.rows] == ["200", "300", "400"]
    at = data.sel({"layout": "S2", "index": "J1", "vehicle.sprung_mass": 200.0, "k": 90e3}).squeeze("method")
    assert first.rows[0].cells[2].remark == f"{float(at['value']):.4g}"
    assert first.rows[0].cells[2].text.startswith(f"{float(at['improvement']):+.1f}")


@pytest.mark.parametrize("bad", sampled([np.nan, np.inf], [np.inf]))
@pytest.mark.parametrize("everywhere", [True, False])
def test_a_map_with_values_that_are_none_is_drawn(data: xr.Dataset, *, bad: float, everywhere: bool) -> None:
    holes = data.copy(deep=True)
    holes["value"][0, 0, 0, 0] = holes["improvement"][1, 0, :, 1] = bad
    if everywhere:
        holes["value"][1, 0] = holes["improvement"][1, 0] = bad
    with style_context():
        study_figures(holes)[0].draw().draw_without_rendering()
    assert terminal_text(holes)
    assert sweep_headlines(holes)


def test_a_map_without_a_baseline_shows_values(study: Study, tmp_path: Path) -> None:
    one = replace(study, layouts={"S2": study.layouts["S2"]}, baseline=None, indices=("J1",))
    found = run_study(one, tmp_path / "one").data
    (figure, *_) = study_figures(found)
    assert "improvement" not in figure.caption
    assert "sprung mass = 400 kg" in sweep_headlines(found)[0]
    assert "improvement" not in map_tables(found)[0].caption
    with style_context():
        figure.draw().draw_without_rendering()
