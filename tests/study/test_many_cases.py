"""Large sweeps: what is kept of each case, how results are put together, and how an interrupted sweep goes on."""

from __future__ import annotations

import csv
import json
import os
import random
import re
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from campaigns import sampled
from study_text import load_text, study_text
from synthetic import terminal_text

from inerter.cli.main import call
from inerter.cli.pace import Pace
from inerter.cli.progress import progress
from inerter.figures.curves import thinned_band
from inerter.figures.labels import one_method
from inerter.files.study import checking, summary
from inerter.files.study.cases import Case, Cases, Outcome, cases, portable
from inerter.files.study.journal import journal_of, results_of
from inerter.files.study.loading import load_study
from inerter.files.study.results import DatasetBuilder, dataset
from inerter.files.study.running import run_study
from inerter.files.study.study import Study
from inerter.report.page import report
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.tables import sweep_tables
from inerter.work.journal import Journal

WORDS = ("lower", "upper", "")


def study_of(folder: Path, points: int, settings: str = "") -> Study:
    sweep = f'sweep = {{ k = {{ from = "10 kN/m", to = "90 kN/m", points = {points} }} }}'
    elements = 'k = "20 kN/m"\nc = { from = "1 kN s/m", to = "9 kN s/m" }\nb = "30 kg"'
    text = study_text(f'indices = ["J1", "J3"]\noptimise = "norm"\n{sweep}\n{settings}', elements=elements)
    return load_text(folder, text, f"many{points}.toml")


def drawn(study: Study, case: Case, threads: int = 1) -> Outcome:
    """An outcome of random numbers, which depend on its case alone; some are not ok, some are not finite."""
    draw = random.Random(f"{case.layout} {case.index} {case.point}")
    value = draw.choice([1.0, 1.0, 1.0, np.inf, np.nan]) * draw.uniform(1.0, 2.0)
    kind = draw.choice(["ok", "ok", "ok", "marginal", "failed"])
    values = {i: value if i == case.index else draw.uniform(1.0, 2.0) for i in study.indices}
    c = draw.uniform(1e3, 9e3)
    return Outcome(
        *(case.layout, case.index, case.point),
        parameters={"c": c},
        active_bounds={"c": draw.choice(WORDS)},
        ranges={"c": (0.9 * c, c)},
        starts=8,
        agreed=draw.randrange(9),
        evaluations=draw.randrange(1000),
        values={"norm": values},
        standard_errors={"norm": dict.fromkeys(study.indices)},
        status={"norm": kind},
        message="" if kind == "ok" else f"it is {draw.random():.2f} bad",
        notes=[["c taken as ", draw.uniform(0.0, 1.0), " N s/m"], ["left out"]],
    )


def row_of(study: Study, outcome: Outcome, base: Outcome) -> dict[str, str]:
    """What the table says of an outcome, from that and the baseline's alone."""
    value, ours = outcome.values["norm"][outcome.index], base.values["norm"][outcome.index]
    best = np.isfinite(value)
    improvement = 100.0 * (1.0 - value / ours) if np.isfinite(ours) else np.nan
    kind, bound = outcome.status["norm"], outcome.active_bounds["c"]
    (swept,) = study.sweeps
    return {
        "layout": outcome.layout,
        "index": outcome.index,
        "k [N/m]": repr(swept.values[outcome.point]),
        "value": "" if np.isnan(value) else repr(value),
        "improvement_percent": "" if np.isnan(improvement) else repr(float(improvement)),
        "status": kind if kind == "ok" else f"{kind}: {outcome.message}",
        "c [N s/m]": repr(outcome.parameters["c"]) if best else "",
        "at_bound": f"c:{bound}" if best and bound else "",
        "agreed": str(outcome.agreed),
    }


@pytest.fixture
def swift(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[..., Outcome]], None]:
    """Cases are what a function says, and so few at a time that boundaries lie everywhere."""
    monkeypatch.setattr(summary, "_AT_ONCE", 7)
    monkeypatch.setattr("inerter.report.writing.draw_study", lambda *arguments: None)

    def use(work: Callable[..., Outcome]) -> None:
        monkeypatch.setattr(Case, "compute", lambda case, study, designs, threads: work(study, case, threads))

    use(drawn)
    return use


def test_each_row_of_the_table_is_its_outcome(tmp_path: Path, swift: object) -> None:
    study = study_of(tmp_path, 75)
    run_study(study, tmp_path / "out")
    everything = [drawn(study, case) for case in cases(study)]
    first = {(o.index, o.point): o for o in everything if o.layout == study.baseline}
    with (tmp_path / "out" / "summary.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(everything) == 300
    for row, outcome in zip(rows, everything, strict=True):
        expected = row_of(study, outcome, first[outcome.index, outcome.point])
        assert {name: row[name] for name in expected} == expected


def test_the_order_in_which_outcomes_come_is_no_matter(tmp_path: Path) -> None:
    study = study_of(tmp_path, 40)
    everything = {case: drawn(study, case) for case in cases(study)}
    one, shuffled = dataset(study, everything), [*everything.values()]
    random.Random(0).shuffle(shuffled)
    gathered = DatasetBuilder(study)
    for outcome in shuffled:
        gathered.enter(Outcome(**json.loads(json.dumps(outcome.to_json()))))
    other = gathered.dataset()
    assert other.identical(one)
    low, high = (f"{end(o.notes[0][1] for o in shuffled):.4g}" for end in (min, max))
    assert one.attrs["notes"].splitlines() == [f"S1, S2: c taken as {low} to {high} N s/m", "S1, S2: left out"]
    assert gathered.n_failures == sum(o.kind != "ok" for o in shuffled)


def test_cases_are_made_when_they_are_asked_for(tmp_path: Path) -> None:
    study = study_of(tmp_path, 1_000_000)
    everything = cases(study)
    assert len(everything) == 4_000_000
    for number in (0, 1, 999_999, 1_000_000, 3_999_999):
        case = everything[number]
        assert everything.number(case) == number
        (swept,) = study.sweeps
        assert case.swept == (swept.values[case.point],)
    assert portable(study).sweeps == (replace(swept, values=()),)
    assert portable(study).design("S1", 12e3) == study.design("S1", 12e3)


def test_a_large_sweep_is_checked_at_its_ends_and_extremes() -> None:
    values = [float(i) for i in range(1000, 0, -1)] + [0.0] + [float(i) for i in range(1001, 100_000)]
    tried = [values[i] for i in checking._points_to_check(Cases((), (), (tuple(values),)))]
    assert len(tried) < 300
    assert {values[0], values[-1], 0.0, 99_999.0} <= {*tried}
    assert checking._points_to_check(Cases((), (), (tuple(values[:150]),))) == list(range(150))
    both = Cases((), (), (tuple(values), (2.0, 1.0, 3.0)))
    corners = {(value, end) for value in (0.0, 99_999.0) for end in (1.0, 3.0)}
    assert corners <= {both.sweep_values(point) for point in checking._points_to_check(both)}


@pytest.mark.parametrize("seed", sampled(range(4), [0], kept=1))
def test_a_sweep_cut_anywhere_goes_on_to_the_same_bytes(tmp_path: Path, swift: Callable, seed: int) -> None:
    """No line that is whole is computed again, whatever was cut; nor is a copy by another name touched."""
    study, draw = study_of(tmp_path, 25), random.Random(seed)
    run_study(study, tmp_path / "out")
    files = ("summary.csv", "results.nc", "study.resolved.toml", "journal.jsonl")
    whole = {name: (tmp_path / "out" / name).read_bytes() for name in files}
    journal = tmp_path / "out" / "journal.jsonl"
    cut = whole["journal.jsonl"][: draw.randrange(len(whole["journal.jsonl"]))]
    journal.write_bytes(cut)
    if seed % 2:
        os.link(journal, tmp_path / "copy")
    again: list[int] = []

    def work(study: Study, case: Case, threads: int = 1) -> Outcome:
        again.append(cases(load_study(tmp_path / "many25.toml")).number(case))
        return drawn(study, case)

    swift(work)
    result = run_study(study, tmp_path / "out", resume=True)
    assert again == list(range(max(cut.count(b"\n") - 1, 0), 100))
    assert result.computed == len(again)
    assert {name: (tmp_path / "out" / name).read_bytes() for name in files} == whole
    if seed % 2:
        assert (tmp_path / "copy").read_bytes() == cut


def test_lines_written_together_are_those_written_one_by_one(tmp_path: Path) -> None:
    entries = [{"number": i, "text": "x" * (i % 7)} for i in range(50)]
    for name, size in (("one", 1), ("other", 8)):
        with Journal(tmp_path / name, {}).appending() as append:
            for start in range(0, len(entries), size):
                append(*entries[start : start + size])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "other").read_bytes()
    reading = Journal(tmp_path / "one", {}).read()
    assert [next(reading) for _ in range(3)] == entries[:3]  # before the rest was looked at


def memory(work: Callable[[], object]) -> float:
    """The most bytes that are held meanwhile."""
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize("points", sampled([500, 5000], kept=0))
def test_a_case_takes_so_many_bytes_and_no_more(tmp_path: Path, swift: object, points: int) -> None:
    """In arrays it has 200 bytes; an outcome as it is has several thousand. Twice as many cases tell what one takes."""
    small, large = study_of(tmp_path, points), study_of(tmp_path, 2 * points)
    peaks = []
    for study in (small, large):
        run_study(study, tmp_path / f"out{len(peaks)}")
        journal = journal_of(study, tmp_path / f"out{len(peaks)}" / "journal.jsonl")

        def read(study: Study = study, journal: Journal = journal) -> None:
            gathered = DatasetBuilder(study)
            for outcome in results_of(journal):
                assert isinstance(outcome, Outcome)
                gathered.enter(outcome)

        peaks.append(memory(read))
    assert (peaks[1] - peaks[0]) / (4 * points) < 400.0


@pytest.mark.marathon
def test_a_page_of_many_cases_is_as_small_as_any(tmp_path: Path, swift: object) -> None:
    """Rows of tables hold the extremes, and say where all are; no list on the page grows with the sweep."""
    pages = []
    for points in (2000, 4000):
        study = study_of(tmp_path, points)
        data = run_study(study, tmp_path / f"out{points}").data
        pages.append(report(StudyContents(data, study, ()), tmp_path))
        for table, index in zip(sweep_tables(data), study.indices, strict=True):
            assert f"of {points} values, the extremes among them" in table.caption
            rows = one_method(data)["improvement"].sel(index=index, layout="S2")
            finite = rows[np.isfinite(rows)]
            best = f"{float(rows.k[int(np.nanargmax(rows.where(np.isfinite(rows))))]) / 1e3:.4g}"
            assert best in [row.cells[0].text for row in table.rows]
            assert any(f"{float(finite.max()):+.1f}" in cell.remark for row in table.rows for cell in row.cells)
            assert len(table.failures) == 21
            assert table.failures[-1].startswith("and ")
        assert "study.resolved.toml has all" in pages[-1]
        assert f"The designs at all {points} values of k are in summary.csv and results.nc." in pages[-1]
        assert max(map(len, terminal_text(data).splitlines())) <= 80
    assert abs(len(pages[1]) - len(pages[0])) < 0.1 * len(pages[0])


def test_json_of_many_designs_comes_in_pieces(tmp_path: Path, swift: object) -> None:
    study = study_of(tmp_path, 50)
    result = run_study(study, tmp_path / "out")
    pieces = list(as_text(result))
    assert len(pieces) > 200
    assert max(map(len, pieces)) < 2000
    text = "".join(pieces)
    found = json.loads(text)
    assert f"{json.dumps(found, indent=2)}\n" == text
    everything = [drawn(study, case) for case in cases(study)]
    for told, outcome in zip(found["designs"], everything, strict=True):
        assert (told["layout"], told["index"]) == (outcome.layout, outcome.index)
        value = outcome.values["norm"][outcome.index]
        assert told["value"] == (value if np.isfinite(value) else None if np.isnan(value) else "inf")
        assert told["parameters"] == (outcome.parameters if np.isfinite(value) else {})


def test_failures_are_told_one_by_one(tmp_path: Path, swift: object) -> None:
    study = study_of(tmp_path, 60)
    result = run_study(study, tmp_path / "out")
    bad = [(case, o) for case in cases(study) if (o := drawn(study, case)).kind != "ok"]
    expected = [f"{c.layout} {c.index} {c.swept[0]}: {o.kind}: {o.message}" for c, o in bad]
    assert result.failures == expected
    assert result.n_failures == len(bad)
    assert next(result.iterate_failures()) == expected[0]


def test_progress_tells_how_many_are_not_ok_and_how_long_it_takes(
    tmp_path: Path, swift: object, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = study_of(tmp_path, 10)
    told: list[tuple[int, int, int]] = []
    run_study(study, tmp_path / "out", progress=lambda done, total, last, bad: told.append((done, total, bad)))
    bad = sum(drawn(study, case).kind != "ok" for case in cases(study))
    assert told[0] == (0, 40, 0)
    assert told[-1] == (40, 40, bad)
    clock = [0.0]
    for module in ("progress", "pace", "pulse"):
        monkeypatch.setattr(f"inerter.cli.{module}.time", SimpleNamespace(monotonic=lambda: clock[0]))
    outcome = drawn(study, cases(study)[0])
    pace = Pace({"S1": 1, "S2": 1}, ("J1",), 500)
    with ThreadPoolExecutor(3) as threads, progress(executor=threads, pace=pace) as shown:
        shown.cases(500, 1000, None, 0)
        clock[0] = 50.0
        shown.cases(600, 1000, outcome, 2)
        until = time.monotonic() + 60.0
        lines: list[str] = []
        while len(lines) < 2 and time.monotonic() < until:
            time.sleep(0.05)
            lines += capsys.readouterr().err.splitlines()
    assert lines[0] == "designs to find: 1000, 500 of them done before"
    assert re.fullmatch(
        r"600 of 1000 designs found, 2 not ok, 2 a second, \S+ \w+ to \S+ \w+ left, 3 threads at work, 50 s so far",
        lines[1],
    )


def test_the_band_of_a_long_sweep_covers_what_all_points_cover() -> None:
    draw = np.random.default_rng(0)
    x = np.arange(50_000.0)
    low, high = -draw.uniform(1.0, 2.0, x.size), draw.uniform(1.0, 2.0, x.size)
    at, lower, upper = thinned_band(x, low, high)
    assert at.size <= 2000
    assert (lower.min(), upper.max()) == (low.min(), high.max())
    for part in range(0, at.size, 97):
        inside = (x >= at[part]) & (x < (at[part + 1] if part + 1 < at.size else np.inf))
        assert (lower[part], upper[part]) == (low[inside].min(), high[inside].max())
    assert thinned_band(x[:100], low[:100], high[:100])[0] is not None


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("count", sampled([500, 20_000], kept=0))
def test_thousands_of_cases_killed_and_resumed(tmp_path: Path, count: int) -> None:
    """With two processes, and every number computed."""
    path, whole, broken = (tmp_path / name for name in ("sweep.toml", "whole", "broken"))
    sweep = f'sweep = {{ k = {{ from = "10 kN/m", to = "90 kN/m", points = {count} }} }}'
    path.write_text(study_text(f'indices = ["J1"]\n{sweep}', layouts='S1 = "k | c - b"'), encoding="utf-8")
    assert call(["run", str(path), "-o", str(whole), "-j", "2"]) == 0
    main = "from inerter.cli.main import main; main()"
    process = subprocess.Popen([sys.executable, "-c", main, "run", str(path), "-o", str(broken), "-j", "2"])
    journal = broken / "journal.jsonl"
    while not journal.exists() or journal.read_bytes().count(b"\n") < 0.4 * count:
        assert process.poll() is None
        time.sleep(0.2)
    process.kill()
    process.wait()
    kept = journal.read_bytes()
    kept = kept[: kept.rindex(b"\n") + 1]
    assert call(["run", str(path), "-o", str(broken), "-j", "2", "--resume"]) == 0
    assert journal.read_bytes().startswith(kept)
    assert journal.read_bytes().count(b"\n") == 1 + count
    for name in ("summary.csv", "results.nc", "report.html", "study.resolved.toml"):
        assert (broken / name).read_bytes() == (whole / name).read_bytes()
