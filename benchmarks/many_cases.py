"""A sweep of very many cases: how long it takes, how much memory it holds, and how it goes on after kill -9.

python benchmarks/many_cases.py [CASES] [--jobs 2] [--made-up] [--once]

A quarter car whose spring is swept, one layout, one index, nothing optimised. With `--made-up` each case has a number
at once that nothing computes, which shows what is spent beside the cases. The study is run once without a break, and
once killed in the middle and resumed (not with `--once`); the results must be the same bytes. Where others use the
machine too, cases per second of processor time tell whether it slows down.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil

from inerter.cli.main import call
from inerter.files.study import running
from inerter.files.study.cases import Outcome

STUDY = """title = "Very many springs"
[vehicle]
model = "quarter-car"
sprung_mass = "250 kg"
unsprung_mass = "35 kg"
tyre_stiffness = "150 kN/m"
[road]
speed = "25 m/s"
roughness = "5e-7 m^3/cycle"
[elements]
k = "20 kN/m"
c = "2 kN s/m"
b = "30 kg"
[layouts]
serial = "k | c - b"
[study]
indices = ["J1"]
sweep = {{ k = {{ from = "10 kN/m", to = "90 kN/m", points = {cases} }} }}
"""
RESULTS = ("summary.csv", "results.nc", "report.html", "study.resolved.toml")


def made_up(study: Any, case: Any, threads: int = 1) -> Any:
    """A stand-in for the work on a case."""
    value = {"norm": {case.index: 1.0 + (case.point * 7919 % 1000) / 10_000}}
    return Outcome(case.layout, case.index, case.point, {}, {}, {}, 0, 0, 0, value, {"norm": {}}, {"norm": "ok"})


@dataclass
class Run:
    """A run of the command line in a process of its own, and what was seen of it."""

    arguments: list[str]
    journal: Path
    begun: float = field(default_factory=time.perf_counter)
    lines: list[tuple[float, float, int]] = field(default_factory=list)  # seconds, those of processors, lines by then
    memory: float = 0.0  # MiB that the coordinator held at most
    _seen: int = 0
    _count: int = 0

    def __post_init__(self) -> None:
        self._seen = 0 if "--resume" not in self.arguments else self.journal.stat().st_size
        self.process = subprocess.Popen(self.arguments, stdout=subprocess.DEVNULL)

    def watch(self) -> Iterator[int]:
        """How many lines it has written, again and again until it ends."""
        while self.process.poll() is None:
            time.sleep(0.2)
            self._look()
            yield self._count

    def _look(self) -> None:
        for row in _read(Path(f"/proc/{self.process.pid}/status")).splitlines():
            if row.startswith("VmHWM"):
                self.memory = max(self.memory, int(row.split()[1]) / 1024)
        size = self.journal.stat().st_size if self.journal.exists() else 0
        if size > self._seen:
            with self.journal.open("rb") as stream:
                stream.seek(self._seen)
                self._count += stream.read(size - self._seen).count(b"\n")
            self._seen = size
            self.lines.append((time.perf_counter() - self.begun, _processor_time(self.process.pid), self._count))

    def pace(self, first: float, last: float) -> str:
        """Cases a second between two parts of the whole, and those of a second of processor time."""
        total = self.lines[-1][2]
        (a, p, m), (b, q, n) = (next(at for at in self.lines if at[2] >= part * total) for part in (first, last))
        return f"{(n - m) / (b - a):.0f} ({(n - m) / (q - p):.0f})" if b > a and q > p else "all at once"


def _processor_time(process: int) -> float:
    """Processor time of a process and of those that it has started [s]."""
    total = 0.0
    with suppress(psutil.NoSuchProcess):
        for one in (parent := psutil.Process(process), *parent.children(recursive=True)):
            total += sum(one.cpu_times()[:2])
    return total


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:  # it has ended
        return ""


def measure(cases: int, jobs: int, invented: bool, once: bool, folder: Path) -> None:
    study = folder / "many.toml"
    study.write_text(STUDY.format(cases=cases))
    command = ["-c", "from inerter.cli.start import main; main()"]
    how = [sys.executable, *([__file__, "--run"] if invented else command)]

    def run(out: Path, *more: str) -> Run:
        return Run([*how, "run", str(study), "-o", str(out), "-j", str(jobs), *more], out / "journal.jsonl")

    whole, broken = folder / "whole", folder / "broken"
    one = run(whole)
    for _ in one.watch():
        pass
    seconds, used = time.perf_counter() - one.begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    assert one.process.returncode == 0
    print(f"{cases} cases, -j {jobs}: {seconds:.0f} s, {used.ru_utime + used.ru_stime:.0f} s of CPU")
    print(f"  coordinator at most {one.memory:.0f} MiB")
    tenths = [one.pace(max(i / 10, 0.01), (i + 1) / 10) for i in range(10)]
    print(f"  cases a second (of processor time), tenth by tenth: {', '.join(tenths)}")
    size, after = one.journal.stat().st_size / 1e6, seconds - one.lines[-1][0]
    print(f"  journal {size:.0f} MB, {after:.1f} s from the last case on", flush=True)
    if not once:
        _broken_off(run, cases, whole, broken)


def _broken_off(run: Callable[..., Run], cases: int, whole: Path, broken: Path) -> None:
    two = run(broken)
    for count in two.watch():
        if count > cases // 2:
            two.process.kill()
            break
    two.process.wait()
    time.sleep(1.0)  # its processes end with it
    three = run(broken, "--resume")
    before = two._count - 1
    for _ in three.watch():
        pass
    assert three.process.returncode == 0
    print(f"killed with {before} done, resumed: the next case after {three.lines[0][0]:.1f} s, {three.memory:.0f} MiB")
    with (broken / "journal.jsonl").open("rb") as stream:
        print(f"  lines of the journal: {sum(1 for _ in stream)}")
    for name in RESULTS:
        print(f"  {name}: {'same bytes' if _same(whole / name, broken / name) else 'NOT the same'}")
    four = run(broken, "--resume")
    for _ in four.watch():
        pass
    print(f"all done, resumed: {time.perf_counter() - four.begun:.1f} s with all results, {four.memory:.0f} MiB")


def _same(one: Path, other: Path) -> bool:
    return one.read_bytes() == other.read_bytes()


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if sys.argv[1:2] == ["--run"]:
        running.run_case = made_up
        sys.exit(call(sys.argv[2:]))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", type=int, nargs="?", default=100_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--made-up", action="store_true")
    parser.add_argument("--once", action="store_true")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        measure(given.cases, given.jobs, given.made_up, given.once, Path(place))
