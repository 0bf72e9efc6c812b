"""The command line is never silent for more than two seconds, and says what is true of the time left."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from campaigns import sampled

from inerter.cli import pace as paces
from inerter.cli import pulse as pulses
from inerter.cli.pace import Pace
from inerter.cli.progress import fraction, progress, steps
from inerter.files.study.cases import Outcome
from inerter.work.progress import ProgressStep, report, within

SILENCE = 2.0  # seconds
FASTER = 5.0  # the pulse that is waited for here; `test_lines_of_a_long_log_become_seldom` has the usual one
SLOW = f"""
import sys, time
from inerter.work import progress
from inerter.cli import main, pulse
pulse._SILENCE /= {FASTER}
pulse._LOOK /= {FASTER}
inner = main.app
def slow(*arguments, **settings):
    time.sleep(1.3)
    return 0
main.app = slow
sys.exit(main.main())
"""


@pytest.fixture
def faster(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("_SILENCE", "_LOOK"):
        monkeypatch.setattr(pulses, name, getattr(pulses, name) / FASTER)


def gaps(command: list[str]) -> tuple[list[float], list[str]]:
    """Seconds between the lines of a process on stderr, from its first line to its end, and the lines."""
    times, lines = [], []
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stderr is not None
        for line in process.stderr:
            times.append(time.monotonic())
            lines.append(line)
    times.append(time.monotonic())
    return np.diff(times).tolist(), lines


def test_a_command_that_says_nothing_has_a_pulse() -> None:
    between, lines = gaps([sys.executable, "-c", SLOW, "check"])
    assert len(lines) >= 2
    assert all(line.startswith("inerter: preparing") for line in lines)
    assert max(between) < SILENCE  # of a busy machine, whose process also takes its time to end


def wait(seconds: float) -> None:
    until = time.monotonic() + seconds
    with within("S1 J1"):
        while time.monotonic() < until:
            report("starts", 3, 64, best=1.25, share=0.05)
            time.sleep(0.05)


def in_progress() -> None:
    with progress() as shown:
        shown.kernels("a kernel", 1, 9)
        wait(0.7)
        shown.cases(0, 9, None, 0)
        wait(0.7)


def in_steps() -> None:
    with steps() as show:
        show("table", 0, 3)
        wait(0.7)


def in_fraction() -> None:
    with fraction("record") as show:
        show(0.25)
        time.sleep(0.7)


@pytest.mark.usefixtures("faster")
@pytest.mark.parametrize("terminal", [False, True], ids=["log", "terminal"])
def test_what_shows_the_progress_of_a_part_silences_what_is_around_it(
    terminal: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    with pulses.alive():
        in_fraction()
    assert not [line for line in capsys.readouterr().err.splitlines() if line.startswith("inerter:")]


@pytest.mark.usefixtures("faster")
@pytest.mark.parametrize("work", [in_progress, in_steps, in_fraction], ids=lambda work: work.__name__)
def test_each_way_to_show_progress_has_a_line_in_time(
    work: Callable[[], None], capsys: pytest.CaptureFixture[str]
) -> None:
    work()
    lines = capsys.readouterr().err.splitlines()
    assert len([line for line in lines if " s" in line]) >= (2 if work is in_progress else 1), lines
    if work is not in_fraction:
        assert any("starts 3 of 64, lowest 1.25" in line for line in lines), lines


@pytest.mark.usefixtures("faster")
def test_what_comes_after_the_designs_is_told_in_place_of_their_count(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as shown:
        shown.cases(0, 1, None, 0)
        shown.cases(1, 1, Outcome("S1", "J1", 0, {}, {}, {}, 0, 0, 0, {}, {}, {"norm": "ok"}), 0)
        report("drawing the figures")
        time.sleep(0.7)
    lines = capsys.readouterr().err.splitlines()
    after = lines[lines.index("1 of 1 designs found") + 1 :]
    assert after, lines
    assert all(line.startswith("drawing the figures, ") for line in after), lines


def fail_within(name: str) -> None:
    with within(name):
        report("starts", 1, 4, share=0.25)
        raise ZeroDivisionError


def test_designs_that_have_ended_are_not_told_to_be_under_way() -> None:
    own = Pace({"S1": 1, "S2": 1}, ("J1",), 1)
    with progress(pace=own) as shown:
        shown.cases(0, 2, None, 0)
        for name in ("S1 J1", "S2 J1"):
            with within(name):
                report("starts", 1, 4, share=0.25)
                assert list(own.parts) == [name]
        with pytest.raises(ZeroDivisionError):
            fail_within("S2 J3")
        assert own.parts == {}


def test_lines_of_a_long_log_become_seldom(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    clock = [0.0]
    monkeypatch.setattr(pulses, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    printer, printed = pulses.Pulse(str), list[float]()
    while clock[0] < 3.0 * 3600.0:
        clock[0] += pulses._LOOK
        printer(ProgressStep("starts"))
        if capsys.readouterr().err:
            printed.append(clock[0])
    between, ends = np.diff(printed), np.array(printed[1:])
    assert between[ends < 600.0].max() <= SILENCE + 0.01
    assert between[ends < 3600.0].max() <= 10.0
    assert between.max() <= 60.0
    assert len(printed) < 1000


def test_nothing_is_preparing_once_another_printer_has_ended(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A pulse that another one silenced for long has nothing to catch up on."""
    clock = [0.0]
    monkeypatch.setattr(pulses, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    outer = pulses.Pulse(str)
    with pulses.display():
        clock[0] = 100.0
        outer(ProgressStep("preparing"))
    clock[0] += pulses._LOOK
    outer(ProgressStep("preparing"))
    assert not capsys.readouterr().err
    clock[0] += SILENCE * 10.0
    outer(ProgressStep("preparing"))
    assert capsys.readouterr().err


@pytest.mark.parametrize("seed", sampled(range(30), range(6)))
def test_the_time_left_is_in_the_range_that_is_told(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of studies whose designs take as long as is supposed, times something that nobody can know."""
    random, clock = np.random.default_rng(seed), [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    free = {f"S{i}": int(random.integers(1, 9)) for i in range(4)}
    indices = {f"J{i}": float(random.uniform(0.5, 3.0)) for i in range(3)}
    rate = {layout: float(random.uniform(0.7, 1.4)) for layout in free}
    cases = [(layout, index) for layout in free for index in indices]
    each = {c: free[c[0]] ** 2.5 * rate[c[0]] * indices[c[1]] * random.uniform(0.85, 1.18) for c in cases}
    total, pace, told = sum(each.values()), Pace(free, tuple(indices)), list[tuple[float, Any]]()
    pace.begin(0)
    for case in cases:
        begun = clock[0]
        for share in np.linspace(0.0, 1.0, 40)[:-1]:
            clock[0] = begun + each[case] * share
            pace.take(ProgressStep("starts", within=(" ".join(case),), share=float(share)))
            told.append((clock[0], pace.range()))
        clock[0] = begun + each[case]
        pace.take(ProgressStep("done", within=(" ".join(case),), share=1.0, over=True))
        pace.finish(*case, 1)
    assert pace.range() in (None, (0.0, 0.0))
    late = [(total - at, span) for at, span in told if span is not None and at > 0.25 * total]
    inside = [low <= left <= high for left, (low, high) in late]
    assert np.mean(inside) > 0.9
    assert all(math.isfinite(low + high) and low <= high for _, (low, high) in late)


def test_designs_of_an_earlier_run_are_not_taken_for_quick_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    pace = Pace({"S1": 3}, ("J1",), 100)
    pace.begin(90)
    clock[0] = 10.0
    pace.finish("S1", "J1", 1)
    span = pace.range()
    assert span is not None
    assert span[0] < 90.0 < span[1]


def test_parts_of_tasks_count_by_their_own_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Quick designs before slow simulations: no remaining time until a simulation is done, then one that holds."""
    clock = [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    pace = Pace({"S1": 1, "S2": 1}, ("J1",), 5, {f"break-even value {i}": "budgets" for i in range(5)})
    pace.begin(0)
    for done in range(10):
        clock[0] += 4.0
        pace.finish("S1" if done < 5 else "S2", "J1", 1)
        assert pace.range() is None, "five simulations of unknown duration remain"
    for done in range(5):
        clock[0] += 60.0
        pace.finish("", "budgets", 1)
        low, high = pace.range() or (math.nan, math.nan)
        left = 60.0 * (4 - done)
        assert low <= left <= high
    assert pace.range() == (0.0, 0.0)


def test_parts_of_tasks_that_were_done_before_are_not_counted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    pace = Pace({"S1": 1}, ("J1",), 2, {f"front {i}": "fronts" for i in range(4)})
    pace.begin(4)  # two designs and two fronts
    clock[0] = 20.0
    pace.finish("", "fronts", 1)
    low, high = pace.range() or (math.nan, math.nan)
    assert low <= 20.0 <= high


@pytest.mark.parametrize("seconds", [1.0, 5.0, 9.0])
def test_no_remaining_time_is_given_without_a_basis(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    pace = Pace({"S1": 1, "S2": 6}, ("J1",), 1)
    pace.begin(0)
    clock[0] = seconds
    pace.finish("S1", "J1", 1)
    for at in (seconds, 29.0):
        clock[0] = at
        assert pace.words() == ""
    clock[0] = 31.0
    assert pace.words() != ""


@pytest.mark.marathon
def test_a_run_tells_where_it_is_within_a_design(tmp_path: Path) -> None:
    from study_text import study_text  # noqa: PLC0415

    path = tmp_path / "study.toml"
    elements = 'k = "20 kN/m"\nc = { from = "300 N s/m", to = "8 kN s/m" }\nb = { from = "1 kg", to = "400 kg" }'
    path.write_text(
        study_text('indices = ["J1"]\noptimise = "norm"', elements=elements, layouts='S = "k | c - b"'), "utf-8"
    )
    slow = (
        "import sys, time\nfrom inerter.work import progress\nbefore = progress.count_evaluation\n"
        "import inerter.optimisation.local as local\n"
        "local.count_evaluation = lambda: (time.sleep(0.02), before())\n"
        "import importlib\n"
        "importlib.import_module('inerter.optimisation.optimise')._compiled_searches = lambda *_: None\n"
        "from inerter.cli.main import main\nsys.exit(main())"
    )
    between, lines = gaps([sys.executable, "-c", slow, "run", str(path), "-o", str(tmp_path / "out"), "-j", "1"])
    assert sum("S J1: search: starts" in line and "lowest" in line for line in lines) >= 2, lines
    assert max(between) < 3.0 * SILENCE


@pytest.mark.campaign
def test_a_workbench_that_waits_for_the_page_says_nothing(tmp_path: Path) -> None:
    """It is ready once it has said its link, however long nobody asks for anything."""
    code = f"from inerter.cli import main, pulse; pulse._SILENCE /= {FASTER}; pulse._LOOK /= {FASTER}; main.main()"
    with (tmp_path / "said.txt").open("w+", encoding="utf-8") as said:
        command = [sys.executable, "-c", code, "serve", "--no-browser"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said, text=True, cwd=tmp_path)
        try:
            assert process.stdout is not None
            assert "#token=" in process.stdout.readline()
            before = len((tmp_path / "said.txt").read_text(encoding="utf-8"))
            time.sleep(3.0 * SILENCE / FASTER)
            assert "preparing" not in (tmp_path / "said.txt").read_text(encoding="utf-8")[before:]
        finally:
            process.terminate()
            process.communicate(timeout=30)


@pytest.mark.parametrize("further", ["", "the Pareto front"])
def test_a_search_over_networks_has_the_time_left(further: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of networks that come by the group, the larger first, until what follows them has begun."""
    clock = [0.0]
    monkeypatch.setattr(paces, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    pace, groups = Pace.of_networks(further), 40
    took = np.linspace(3.0, 2.0, groups)
    pace.begin(0, groups * 24 + bool(further))
    for done, seconds in enumerate(took):
        assert (pace.words() != "") == (clock[0] > 10.0)
        if clock[0] > 10.0:
            low, high = pace.range() or (math.nan, math.nan)
            assert low < took[done:].sum() < high
            assert pace.words().endswith(f" left, then {further}" if further else " left")
        clock[0] += seconds
        pace.finish("any", "J1", 24)
    assert pace.words() == ""
