"""A number of a best design is declared once: results, summary, JSON and the tables of reports have it by that."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest
import xarray as xr
from study_text import study_text

import inerter as it
from inerter.errors import DesignError
from inerter.files.study.cases import Outcome, cases, run_case
from inerter.files.study.design_numbers import DESIGN_NUMBERS, DesignNumber
from inerter.files.study.loading import load_study
from inerter.files.study.results import dataset
from inerter.files.study.running import StudyResult
from inerter.files.study.study import Study
from inerter.files.study.summary import write_summary
from inerter.report.study_data import as_data
from inerter.report.tables import design_tables
from inerter.report.text import table_lines
from inerter.vehicle.vehicle import Vehicle

ELEMENTS = """k = "120 kN/m"
c = { from = "300 N s/m", to = "10 kN s/m" }
b = { from = "1 kg", to = "900 kg" }"""


def peak(_: Study, vehicle: Vehicle) -> it.Estimate:
    return it.evaluate(vehicle, it.LoadCarrying(), it.Norm())


def refused(_: Study, vehicle: Vehicle) -> it.Estimate:
    raise DesignError("no such number")


def test_a_declared_number_is_everywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With its error bound and status, for each layout the number of its own best design."""
    monkeypatch.setitem(DESIGN_NUMBERS, "sink", DesignNumber("Sink", "body displacement under load", "m/N", peak))
    monkeypatch.setitem(DESIGN_NUMBERS, "none", DesignNumber("None", "number that nobody knows", "N", refused))
    path = tmp_path / "study.toml"
    path.write_text(
        study_text('indices = ["J1"]\noptimise = "norm"\nbaseline = "S1"', elements=ELEMENTS), encoding="utf-8"
    )
    study = load_study(path)
    outcomes = {case: Outcome(**run_case(study, case).to_json()) for case in cases(study)}
    data = dataset(study, outcomes)
    data.to_netcdf(tmp_path / "results.nc")
    write_summary(tmp_path / "summary.csv", study, data)
    rows = list(csv.DictReader((tmp_path / "summary.csv").read_text(encoding="utf-8").splitlines()))
    told = as_data(StudyResult(tmp_path, study, data, len(outcomes)))["designs"]
    with xr.open_dataset(tmp_path / "results.nc") as stored:
        for (case, outcome), row, design in zip(outcomes.items(), rows, told, strict=True):
            best = study.design(case.layout).with_values(outcome.parameters)
            expected = it.evaluate(best, it.LoadCarrying(), it.Norm())
            here = stored.sel(layout=case.layout, index=case.index)
            for found in (here["number.sink.value"], row["sink [m/N]"], design["sink"]["value"]):
                assert float(found) == pytest.approx(expected.value, rel=1e-12)
            for found in (here["number.sink.error_bound"], row["sink.error_bound"], design["sink"]["error_bound"]):
                assert float(found) == pytest.approx(expected.error_bound, rel=1e-6)
            assert (row["sink.status"], design["sink"]["status"]) == ("ok", "ok")
            assert (row["none [N]"], row["none.status"]) == ("", "failed: no such number")
            assert design["none"] == {"value": None, "error_bound": None, "status": "failed: no such number"}
    text = " ".join(table_lines(design_tables(data)[0]))
    for value in data["number.sink.value"].sel(index="J1").values:
        assert f"{value * 1e6:.2f} um/N" in text
    assert "failed: no such number" in text


def test_a_journal_without_a_number_or_with_another_one_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a run before the number was declared: it is missing, and one that is declared no longer is left out."""
    path = tmp_path / "study.toml"
    path.write_text(study_text('indices = ["J1"]'), encoding="utf-8")
    study = load_study(path)
    former = {"gone": {"value": 1.0, "error_bound": 0.0, "status": "ok"}}
    outcomes = {case: replace(run_case(study, case), numbers=former) for case in cases(study)}
    monkeypatch.setitem(DESIGN_NUMBERS, "sink", DesignNumber("Sink", "body displacement under load", "m/N", peak))
    data = dataset(study, outcomes)
    assert "number.gone.value" not in data
    assert bool(data["number.sink.value"].isnull().all())
    assert set(data["number.sink.status"].values.ravel()) == {"missing"}
    assert "missing" in " ".join(table_lines(design_tables(data)[0]))
