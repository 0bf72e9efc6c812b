"""Swept values in text, page and figures have the unit in which the file gives them; files of results are in SI."""

from __future__ import annotations

import csv

import pytest
from campaigns import sampled
from study_text import study_text

from inerter.cli.main import call
from inerter.figures.labels import swept_scale
from inerter.files.study.loading import load_study
from inerter.files.study.running import run_study

SWEPT = {  # the sweep, what is to be read, what is not, and the values in SI units
    "km/h": ('road.speed = ["40 km/h", "80 km/h"]', "in km/h", "11.11", (40 / 3.6, 80 / 3.6)),
    "Gd(n0)": ('road.roughness = ["16e-6 m^3", "64e-6 m^3"]', "in m^3", "8e-08", (8e-8, 32e-8)),
    "tonnes": ('vehicle.sprung_mass = ["0.2 t", "0.4 t"]', "in t ", "200 kg", (200.0, 400.0)),
    "pounds": ('k = ["100 lbf/in", "200 lbf/in"]', "in lbf/in", "17.51", (17512.68, 35025.37)),
    "prefix": ('k = ["20 kN/m", "40 kN/m"]', "in kN/m", "20000", (2e4, 4e4)),
}


def text_of_run(text, folder, capsys):
    """What the command prints of a study with this text, which it runs into `out`, in one line."""
    (folder / "study.toml").write_text(text, encoding="utf-8")
    assert call(["run", str(folder / "study.toml"), "-o", str(folder / "out"), "-j", "1"]) == 0
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("name", sampled(SWEPT, ["km/h"], kept=1))
def test_swept_values_are_told_as_the_file_wrote_them(tmp_path, capsys, name):
    sweep, told, other, values = SWEPT[name]
    text = text_of_run(study_text(f'indices = ["J1"]\n[study.sweep]\n{sweep}'), tmp_path, capsys)
    assert told in text
    assert other not in text
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert other not in page.partition("</table>")[0].rpartition("<svg")[0] or name == "prefix"
    with open(tmp_path / "out" / "summary.csv", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    column = next(key for key in rows[0] if key.split(" [")[0] in sweep)
    assert sorted({float(row[column]) for row in rows}) == pytest.approx(values, rel=1e-5)


def test_units_that_differ_within_a_sweep_are_told_in_si(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(study_text('indices = ["J1"]\nsweep = { road.speed = ["36 km/h", "20 m/s"] }'), encoding="utf-8")
    result = run_study(load_study(path), tmp_path / "out", jobs=1)
    assert swept_scale(result.data, "road.speed").unit == "m/s"


@pytest.mark.usefixtures("undrawn")
def test_the_answer_of_a_study_with_tolerances_is_about_them(tmp_path, capsys):
    """The layout with the lower quantile of tolerances.csv, and the best one without scatter if that is another."""
    settings = 'indices = ["J1"]\ntolerance = { k = "20 %", c = "15 %", b = "90 %" }'
    text = text_of_run(study_text(settings, layouts='S1 = "k | c"\nS2 = "k | c | b"'), tmp_path, capsys)
    with open(tmp_path / "out" / "tolerances.csv", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    best = min(rows, key=lambda row: float(row["quantile_0.95"]))
    said = f"With tolerances {best['layout']} is best for ride comfort: 95 % of cases are below "
    assert said in text
    told = float(text.partition(said)[2].split(" m/s^2")[0])
    assert told == pytest.approx(float(best["quantile_0.95"]), rel=5e-4)
    nominal = min(rows, key=lambda row: float(row["nominal"]))
    assert (f"Without tolerances {nominal['layout']} is best" in text) == (nominal is not best)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "With tolerances" in page


@pytest.mark.usefixtures("undrawn")
def test_a_distribution_that_is_one_value_is_due_to_nothing(tmp_path, capsys):
    """The travel of a spring beside a damper does not depend on the spring."""
    settings = 'indices = ["suspension-travel"]\ntolerance = { k = "20 %" }'
    text = text_of_run(study_text(settings, layouts='S1 = "k | c"'), tmp_path, capsys)
    assert "With tolerances S1 is best" in text
    assert "due to" not in text.partition("With tolerances")[2]
