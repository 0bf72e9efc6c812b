"""Running studies: results on disk, interruption and resumption."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from campaigns import sampled
from study_text import ON_A_ROUGH_ROAD

from inerter.errors import StudyError
from inerter.files.common.folder import WriteMode, open_results
from inerter.files.study.cases import Outcome, cases
from inerter.files.study.checking import check_study
from inerter.files.study.journal import journal_of, results_of
from inerter.files.study.loading import load_study
from inerter.files.study.running import StudyResult, csv_text, result_names, run_study
from inerter.files.study.study import Study
from inerter.methods.method import evaluate
from inerter.work.checkpoints import Checkpoint

SWEEP = (
    f'\ntitle = "Soft and stiff springs"\n{ON_A_ROUGH_ROAD}'
    + """[elements]
k = "20 kN/m"
c = { from = "100 N s/m", to = "100 kN s/m" }
b = { from = "1 kg", to = "2000 kg" }
f = "15 N"
[layouts]
usual = "k | c"
serial = "k | c - (b | f)"
[study]
indices = ["J1", "J3"]
optimise = "norm"
sweep = { k = { from = "10 kN/m", to = "90 kN/m", points = POINTS } }
"""
)


def write(folder: Path, points: int = 3, change: tuple[str, str] = ("f", "f")) -> Path:
    path = folder / "study.toml"
    path.write_text(SWEEP.replace("POINTS", str(points)).replace(*change), encoding="utf-8")
    return path


@dataclass(frozen=True)
class Finished:
    """A study that has been run, with its results in `folder`."""

    study: Study
    result: StudyResult

    @property
    def folder(self) -> Path:
        return self.result.folder

    @property
    def journal(self) -> Path:
        return self.folder / "journal.jsonl"

    @property
    def summary(self) -> bytes:
        return (self.folder / "summary.csv").read_bytes()

    def again(self, **options: bool) -> StudyResult:
        return run_study(self.study, self.folder, **options)


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Finished:
    """Twelve cases: three stiffnesses, two layouts, two indices; read only."""
    folder = tmp_path_factory.mktemp("first")
    study = load_study(write(folder))
    return Finished(study, run_study(study, folder / "out"))


@pytest.fixture
def finished(first: Finished, tmp_path: Path) -> Finished:
    """The same in a folder of its own, to change."""
    folder = shutil.copytree(first.folder, tmp_path / "out")
    return replace(first, result=replace(first.result, folder=folder))


def lines(journal: Path) -> list[str]:
    return journal.read_text(encoding="utf-8").splitlines() if journal.exists() else []


HELD = """
from inerter.files.study import parts
left, run_part = iter(range({count})), parts.run_part
parts.run_part = lambda *given, **more: time.sleep(600.0) if next(left, None) is None else run_part(*given, **more)
"""


def start(arguments: list[str], held: int | None = None) -> subprocess.Popen[bytes]:
    """The command, heeding Ctrl-C even if the tests run in the background, where processes are born deaf to it.

    After so many cases of its own process it is `held`, so that it cannot end before it is interrupted.
    """
    heeding = "import signal, sys, time; signal.signal(signal.SIGINT, signal.default_int_handler)"
    program = f"{heeding}\n{'' if held is None else HELD.format(count=held)}\nfrom inerter.cli.main import main; main()"
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def wait_for_cases(process: subprocess.Popen[bytes], journal: Path, count: int) -> None:
    deadline = time.monotonic() + 250.0
    while len(lines(journal)) < 1 + count:
        assert process.poll() is None, process.communicate()[1].decode()
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_summary_holds_the_values_of_the_designs(first: Finished) -> None:
    study = first.study
    rows = list(csv.DictReader(first.summary.decode().splitlines()))
    assert len(rows) == len(cases(study)) == first.result.computed == 12
    for row in rows[::3]:
        values = {
            name: float(row[f"{name} [{unit}]"])
            for name, unit in (("c", "N s/m"), ("b", "kg"))
            if row[f"{name} [{unit}]"]
        }
        design = study.design(row["layout"], float(row["k [N/m]"])).with_values(values)
        again = evaluate(design, study.index(row["index"]), study.method(row["method"]))
        assert again.value == pytest.approx(float(row["value"]), rel=1e-12)
        assert again.unit == row["unit"]
        assert row["status"] == "ok"


def test_improvement_is_over_the_baseline_of_the_same_stiffness(first: Finished) -> None:
    data = first.result.data
    expected = 100.0 * (1.0 - data.value / data.value.sel(layout="usual", drop=True))
    assert np.all(data.improvement.sel(layout="usual") == 0.0)
    xr.testing.assert_allclose(data.improvement, expected.transpose(*data.improvement.dims))


def test_results_reopen_with_units(first: Finished) -> None:
    with xr.open_dataset(first.folder / "results.nc", engine="h5netcdf") as again:
        xr.testing.assert_identical(again.load().drop_attrs(), first.result.data.drop_attrs())
        assert again["k"].attrs["units"] == "N/m"
        assert "friction 'f' in 'strut' left out" in again.attrs["notes"]


def test_resolved_study_gives_the_same_results(first: Finished, tmp_path: Path) -> None:
    run_study(load_study(first.folder / "study.resolved.toml"), tmp_path / "two")
    assert (tmp_path / "two" / "summary.csv").read_bytes() == first.summary


INTERRUPTED = [(how, *size) for how in (signal.SIGINT, signal.SIGKILL) for size in ((4, 1), (30, 2))]


@pytest.mark.parametrize(("how", "points", "processes"), sampled(INTERRUPTED, seldom=INTERRUPTED[1:]))
def test_interrupted_sweep_resumes_to_the_same_bytes(
    tmp_path: Path, how: signal.Signals, points: int, processes: int
) -> None:
    study = load_study(write(tmp_path, points))
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    process = start(
        ["run", str(study.path), "-o", str(broken), "-j", str(processes)], points if processes == 1 else None
    )
    wait_for_cases(process, broken / "journal.jsonl", points // 4)
    process.send_signal(how)
    _, problems = process.communicate(timeout=250)
    if how == signal.SIGINT:
        assert process.returncode == 130
        again = f"inerter run {study.path} -o {broken} --resume -j {processes}"
        assert f"inerter: interrupted; completed results are kept. Continue with: {again}\n" in problems.decode()
        assert b"Traceback" not in problems
    kept = lines(broken / "journal.jsonl")
    assert points // 4 < len(kept) < 1 + 4 * points
    run_study(study, broken, jobs=processes, resume=True)
    run_study(study, whole)
    assert (broken / "summary.csv").read_bytes() == (whole / "summary.csv").read_bytes()
    after = lines(broken / "journal.jsonl")
    complete = [line for line in kept if line.endswith("}")]
    assert after[: len(complete)] == complete
    cases = [line for line in after if '"rows": ' not in line]  # beside searches of designs that were not done
    assert len(cases) == 1 + 4 * points  # every case once: nothing finished was computed again


@pytest.mark.campaign
def test_workers_end_with_their_parent(tmp_path: Path) -> None:
    process = start(["run", str(write(tmp_path, points=4000)), "-o", str(tmp_path / "out"), "-j", "2"])
    children: list[int] = []
    deadline = time.monotonic() + 250.0
    while len(children) < 2:  # processes are started once the work is known to be long
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.1)
        children = [int(pid) for pid in os.listdir("/proc") if pid.isdigit() and _parent(pid) == process.pid]
    process.kill()
    process.communicate()
    deadline = time.monotonic() + 60.0
    while any(Path(f"/proc/{pid}").exists() and _state(pid) != "Z" for pid in children):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def _parent(pid: str) -> int:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return -1


def _state(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"


def test_a_line_cut_short_is_dropped(finished: Finished) -> None:
    finished.journal.write_bytes(finished.journal.read_bytes()[:-100])
    summary = finished.summary
    assert finished.again(resume=True).computed == 1
    assert finished.summary == summary


def test_finished_study_resumes_without_work(finished: Finished) -> None:
    assert finished.again(resume=True).computed == 0


def test_folder_is_never_overwritten_unasked(finished: Finished) -> None:
    thesis = finished.folder / "thesis.txt"
    thesis.write_text("mine")
    with pytest.raises(
        StudyError, match=r"holds results of inerter run \(journal.jsonl, results.nc, .*\)\. .*--resume.*--force"
    ):
        finished.again()
    assert finished.again(force=True).computed == 12
    assert thesis.read_text() == "mine"


def test_journal_of_another_study_is_refused(finished: Finished, tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="another study"):
        run_study(load_study(write(tmp_path, points=6)), finished.folder, resume=True)


@pytest.mark.parametrize("text", ["", '{"format": 1, "ine'], ids=["empty", "half a header"])
def test_journal_cut_before_its_first_line_begins_anew(finished: Finished, text: str) -> None:
    finished.journal.write_text(text)
    assert finished.again(resume=True).computed == 12
    assert (finished.folder / "study.resolved.toml").exists()


def test_folder_in_use_is_refused(finished: Finished) -> None:
    with open_results(WriteMode(finished.folder, "run", result_names(), resume=True)):
        for options in ({"force": True}, {"resume": True}, {}):
            with pytest.raises(StudyError, match=r"another run is writing|holds results of"):
                finished.again(**options)


def test_resume_and_force_exclude_each_other(finished: Finished) -> None:
    with pytest.raises(StudyError, match="one of the two"):
        finished.again(resume=True, force=True)


@pytest.mark.marathon
def test_numbers_beyond_reason_are_outcomes_not_crashes(tmp_path: Path) -> None:
    path = write(tmp_path, 2, ('"100 N s/m", to = "100 kN s/m"', '"1e-300 N s/m", to = "1e300 N s/m"'))
    result = run_study(load_study(path), tmp_path / "out")
    assert len(result.data.status.values.ravel()) == 8
    for line in result.failures:
        assert "Traceback" not in line


def test_outcomes_survive_the_journal(first: Finished) -> None:
    journal = results_of(journal_of(first.study, first.journal))
    found = [one for one in journal if not isinstance(one, Checkpoint)]  # of a search that took long
    assert [outcome.part for outcome in found] == list(cases(first.study))
    for outcome in found:
        assert isinstance(outcome, Outcome)
        assert Outcome(**json.loads(json.dumps(outcome.to_json()))) == outcome


def test_ill_posed_layout_is_found_before_work(tmp_path: Path) -> None:
    path = write(tmp_path, 3, ('"k | c - (b | f)"', '"f"'))
    with pytest.raises(StudyError, match=r"layouts\.serial.*unconstrained"):
        check_study(load_study(path))


def test_undamped_layout_is_a_result_with_a_status(tmp_path: Path) -> None:
    path = write(tmp_path, 2, ('"k | c - (b | f)"', '"k | b"'))
    result = run_study(load_study(path), tmp_path / "out")
    row = result.data.sel(layout="serial", index="J1")
    assert np.all(np.isinf(row.value))
    assert np.all(row.status.str.startswith("marginal"))
    assert len(result.failures) == 4


def test_numbers_of_numpy_are_numbers_in_csv() -> None:
    assert csv_text([["a", np.float64(1.5)], [None, 2.0]]) == "a,1.5\n,2.0\n"
