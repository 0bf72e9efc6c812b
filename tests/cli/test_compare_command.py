"""`inerter compare` of two folders of results: what was asked, which values differ, and what the exit code tells."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest
import xarray as xr
from study_text import study_text

import inerter as it
from inerter.cli.main import call
from inerter.decision import result_comparison
from inerter.decision.result_comparison import ValueChange, compare_results

SETTINGS = 'indices = ["J1", "J3"]\nbaseline = "S1"'


def run(folder: Path, text: str) -> Path:
    path = folder.with_suffix(".toml")
    path.write_text(text, encoding="utf-8")
    it.run_study(it.load_study(path), folder, jobs=1)
    return folder


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("compared") / "before", study_text(SETTINGS))


def copied(folder: Path, tmp_path: Path) -> Path:
    return Path(copytree(folder, tmp_path / "copy"))


def compared(first: Path, second: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    code = call(["compare", str(first), str(second)])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    assert all(len(line) <= 80 for line in out.splitlines() if "First: " not in line)
    return code, " ".join((out + err).split())


def test_results_of_one_study_agree(before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The same quantities in other units are the same study, and its title is none of its numbers."""
    text = study_text(SETTINGS, title='title = "Another"').replace("20 kN/m", "20 N/mm").replace("25 m/s", "90 km/h")
    again = run(tmp_path / "again", text)
    code, said = compared(before, again, capsys)
    assert code == 0
    assert said.endswith("Both are of the same study. Common values: 4. Different beyond their errors: 0.")


def test_a_list_that_differs_is_shown(before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    less = run(tmp_path / "less", study_text('indices = ["J1"]\nbaseline = "S1"'))
    assert 'study.indices "J1", "J3" "J1" Only in' in compared(before, less, capsys)[1]


def test_a_road_that_is_four_times_as_rough_doubles_every_value(
    before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """R.m.s. values are proportional to the root of the roughness, and nothing else is different."""
    rough = run(tmp_path / "rough", study_text(SETTINGS).replace("5e-7", "20e-7"))
    code, said = compared(before, rough, capsys)
    assert code == 1
    assert 'differ, in SI units Key First Second road.roughness "' in said
    assert "Common values: 4. Different beyond their errors: 4." in said
    assert said.count("+100 % yes") == 4
    assert call(["compare", str(before), str(rough), "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert [entry["place"] for entry in data["entries"]] == ["road.roughness"]
    assert [value["percent"] for value in data["values"]] == pytest.approx([100.0] * 4, rel=1e-8)


def test_what_only_one_has_is_named(before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    less = study_text('indices = ["J3", "J5"]', layouts='S1 = "k | c"\nS9 = "k | c - b"')
    code, said = compared(before, run(tmp_path / "less", less), capsys)
    assert code == 1
    assert "before: layout S2, index J1." in said
    assert "less: layout S9, index J5." in said
    assert 'layouts.S9 not set "k | c - b"' in said
    assert "Common values: 1. Different beyond their errors: 0." in said


def test_values_of_a_sweep_are_compared_where_both_have_them(
    before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    swept = [
        run(tmp_path / name, study_text(f"{SETTINGS}\nsweep = {{ k = {values} }}"))
        for name, values in {"one": '["20 kN/m", "30 kN/m"]', "two": '["30 kN/m", "40 kN/m"]'}.items()
    ]
    found = compare_results(*swept)
    assert {value.point for value in found.values} == {("30 kN/m",)}
    assert (found.changes, found.only_first, found.only_second) == ((), ("k 20 kN/m",), ("k 40 kN/m",))
    assert compared(*swept, capsys)[0] == 1
    code, said = compared(before, swept[0], capsys)
    assert code == 2
    assert "sweeps nothing, " in said


def test_results_that_cannot_be_compared_are_refused(
    before: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = run(tmp_path / "other", study_text('indices = ["J1"]', layouts='mine = "k | c"'))
    edited = copied(before, tmp_path)
    with (edited / "study.resolved.toml").open("a", encoding="utf-8") as file:
        file.write("# edited\n")
    reasons = {
        other: "have no layout in common. Compare results of the same study.",
        edited: "was edited since",
        tmp_path: "is not a folder of results",
        tmp_path / "none": "is not a folder of results",
    }
    for folder, words in reasons.items():
        code, said = compared(before, folder, capsys)
        assert code == 2
        assert words in said


def test_values_agree_within_both_bounds_and_the_interval_of_their_difference(
    before: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bounds of 1 and 2 % of 10 and standard errors of 0.03 and 0.04: 0.1 + 0.2 + 1.96 x 0.05 = 0.398."""
    with xr.open_dataset(before / "results.nc", engine="h5netcdf") as data:
        results = [data.load().copy(deep=True) for _ in range(2)]
    for one, bound, error in zip(results, (0.01, 0.02), (0.03, 0.04), strict=True):
        one["value"][:], one["error_bound"][:], one["standard_error"][:] = 10.0, bound, error
    for difference, count in ((0.38, 0), (0.41, 4), (-0.37, 0), (-0.41, 4), (np.nan, 4), (np.inf, 4)):
        results[1]["value"][:] = 10.0 + difference
        read = iter(results)
        monkeypatch.setattr(result_comparison, "load_results", lambda folder, read=read: next(read))
        assert len(compare_results(before, before).changes) == count


def test_a_missing_value_differs_from_a_number_alone() -> None:
    one = ValueChange("S1", "J1", "norm", (), "m/s^2", 1.0, 1.0, 0.1, ("ok", "ok"), {})
    both = {(1.0, 1.05): False, (1.0, 1.2): True, (np.nan, 1.0): True, (np.nan, np.nan): False, (np.inf, np.inf): False}
    for (first, second), differs in both.items():
        assert replace(one, first=first, second=second).is_beyond_errors is differs
