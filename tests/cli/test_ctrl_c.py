"""Ctrl-C at any time: one sentence, exit code 130, soon, and nothing left behind."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from math import sin
from pathlib import Path

import pytest
from campaigns import sampled
from folders import EXAMPLES
from processes import processor_time

LATE = 60.0  # seconds after which a process is taken to hang, however busy the machine is
TABLE = "time [s],displacement [mm],force [N]\n" + "".join(
    f"{i / 200},{sin(0.1 * i):.3f},{-20.0 * sin(0.1 * i):.3f}\n" for i in range(300)
)
# The signal is heeded even where the tests run in the background, in which processes are born deaf to it. The word on
# stderr tells that the command has begun: what comes before is Python's own.
HEEDING = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
PROGRAM = (
    f"{HEEDING}; import sys; from inerter.cli.start import main; print('begun', file=sys.stderr, flush=True); main()"
)
SECONDS = {  # after the beginning, until which an interrupt may come: about as long as the command takes
    "run": 5.0,
    "sweep": 12.0,
    "force": 5.0,
    "simulate": 3.0,
    "again": 3.0,
    "identify": 15.0,
    "rig": 3.0,
    "check": 1.5,
    "reproduce": 12.0,
    "help": 0.2,
}
COMMANDS = {
    "run": ["run", "study.toml", "-o", "out", "-j", "1"],
    "sweep": ["run", "sweep.toml", "-o", "out", "-j", "2"],
    "force": ["run", "study.toml", "-o", "old", "-j", "2", "--force"],
    "simulate": ["simulate", "rattle.toml", "-o", "out"],
    "again": ["simulate", "rattle.toml", "-o", "motion", "--force"],
    "identify": ["identify", "fit.csv", "--model", "ideal", "-o", "out"],
    "rig": ["rig", "rig.toml", "-o", "new.csv"],
    "check": ["check", "study.toml"],
    "reproduce": ["reproduce", "wang-su-2008", "--only", "table1", "-o", "out", "-j", "2"],
    "help": ["--help"],
}


def started(arguments: list[str], home: Path, mark: str = "") -> subprocess.Popen[str]:
    environment = {**os.environ, "INERTER_TEST": mark}
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *arguments],
        cwd=home, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A folder with the files of all commands."""
    files = {"study": "quarter-car", "sweep": "stiffness-sweep", "rattle": "backlash_rattle", "rig": "rig_fit"}
    for name, example in files.items():
        shutil.copy(EXAMPLES / f"{example}.toml", tmp_path / f"{name}.toml")
    (tmp_path / "fit.csv").write_text(TABLE, encoding="utf-8")
    return tmp_path


def with_results(home: Path) -> None:
    """Old results, a long record, and compiled kernels."""
    (home / "fit.csv").unlink()
    for arguments in (
        ["rig", "rig.toml", "-o", "fit.csv"],
        ["run", "study.toml", "-o", "old", "-j", "1"],
        ["simulate", "rattle.toml", "-o", "motion"],
    ):
        process = started(arguments, home)
        problems = process.communicate(timeout=250)[1]
        assert process.returncode == 0, problems


def alive(mark: str) -> list[int]:
    """Processes that have a mark in their environment."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            content = Path(f"/proc/{pid}/environ").read_bytes()
        except OSError:
            continue
        if f"INERTER_TEST={mark}\0".encode() in content:
            found.append(int(pid))
    return found


def children_time() -> float:
    """Seconds of the processor that all processes have taken that were started here and are over."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def trouble(name: str, after: float, home: Path, patience: float) -> Iterator[str]:
    """What is wrong when a command is interrupted so many seconds after it has begun.

    Its processes may take `patience` seconds of the processor to end.
    """
    mark, before, taken = f"{os.getpid()}-{after}", contents(home), children_time()
    process = started(COMMANDS[name], home, mark)
    assert process.stderr is not None
    assert process.stderr.readline() == "begun\n"
    time.sleep(after)
    over = process.poll() is not None
    taken = children_time() if over else taken + sum(map(processor_time, alive(mark)))
    process.send_signal(signal.SIGINT)
    try:
        err = process.communicate(timeout=LATE)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        yield f"{name}, {after} s: goes on for ever"
        err = process.communicate()[1]
    took = children_time() - taken
    said = [line for line in err.splitlines() if line.startswith("inerter: interrupted")]
    where = f"{name}, interrupted after {after:.3f} s"
    if took > patience:
        yield f"{where}: took {took:.2f} s of the processor"
    if not over and (process.returncode, len(said)) not in ((130, 1), (0, 0)):
        yield f"{where}: exit code {process.returncode}, {err}"
    if "Traceback" in err or "Exception ignored" in err or "Error:" in err:
        yield f"{where}: {err}"
    deadline = time.monotonic() + LATE
    while alive(mark) and time.monotonic() < deadline:
        time.sleep(0.05)
    if alive(mark):
        yield f"{where}: processes are left"
    if left := [str(path) for path in home.rglob(".inerter-*")]:
        yield f"{where}: {left} are left"
    found = contents(home)
    changed = [name for name in before if found.get(name) != before[name] and "/.inerter/" not in name]
    if process.returncode == 130 and changed:
        yield f"{where}: {changed} changed"
    shutil.rmtree(home / "out", ignore_errors=True)
    (home / "new.csv").unlink(missing_ok=True)


@pytest.mark.parametrize(
    "name", sampled(["run", "sweep", "simulate", "identify", "rig", "check", "reproduce"], ["sweep"], kept=2)
)
def test_an_interrupt_is_one_sentence_and_leaves_nothing(name: str, home: Path) -> None:
    after = random.Random(name).uniform(0.3, 2.0)
    assert list(trouble(name, after, home, 6.0)) == []


@pytest.mark.marathon
@pytest.mark.timeout(7200)
def test_many_interrupts(home: Path) -> None:
    """Each command is interrupted forty times."""
    with_results(home)
    draw = random.Random(1)
    found = []
    for _ in range(40):
        for name in COMMANDS:
            found += trouble(name, draw.uniform(0.0, SECONDS[name]), home, 2.0)
    assert found == []
