"""Progress of long work, on stderr: a bar on a terminal, some lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from inerter.files.study.cases import Outcome
from inerter.files.study.journal import Further
from inerter.files.study.running import Progress as Report
from inerter.kernels.prepare import Told
from inerter.work.cluster import slots

_SELDOM = 60.0  # seconds between two lines on a log


class Shown(NamedTuple):
    """What shows how far a study is."""

    cases: Report  # how many cases are done, and which one was last
    kernels: Told  # which kernel is compiled before that


@contextmanager
def progress(what: str, items: str = "designs", executor: Executor | None = None) -> Iterator[Shown]:
    """Callbacks that show how far the work is; `items` says what there is to find, `executor` who looks for it."""
    if not sys.stderr.isatty():
        yield Shown(
            _Lines(what, items, executor),
            lambda title, number, total: print(_kernel(what, title, number, total), file=sys.stderr, flush=True),
        )
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[pace]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None, pace="")
        pace = _Pace()

        def show(done: int, total: int, last: Outcome | Further | None, not_ok: int) -> None:
            pace.begin(done)
            name = f"{what}: {last.layout} {last.index}{_not_ok(not_ok)}" if last else what
            told = f"{pace.rate(done):.3g}/s{_hands(executor)}" if last else ""
            bar.update(task, completed=done, total=total, description=name, pace=told)

        def begun(title: str, number: int, total: int) -> None:
            bar.update(task, completed=number - 1, total=total, description=_kernel(what, title, number, total))

        yield Shown(show, begun)


@contextmanager
def steps(what: str) -> Iterator[Callable[[str, int, int], None]]:
    """A callback that shows how far each of several pieces of work is: its name, steps done, and all steps."""
    if not sys.stderr.isatty():
        yield _Pieces(what)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, TaskID] = {}

        def show(piece: str, done: int, total: int) -> None:
            if piece not in tasks:
                tasks[piece] = bar.add_task(f"{what}: {piece}", total=total)
            bar.update(tasks[piece], completed=done, total=total)

        yield show


@dataclass
class _Pieces:
    """A line when a piece begins, and one when it ends."""

    what: str
    begun: set[str] = field(default_factory=set)

    def __call__(self, piece: str, done: int, total: int) -> None:
        if piece not in self.begun:
            self.begun.add(piece)
            kept = f", {done} of them done before" if done else ""
            print(f"{self.what}: {piece}, {total} steps{kept}", file=sys.stderr, flush=True)
        elif done == total:
            print(f"{self.what}: {piece} done", file=sys.stderr, flush=True)


@contextmanager
def fraction(what: str) -> Iterator[Callable[[float], None]]:
    """A callback that shows what part of one long piece of work is done."""
    if not sys.stderr.isatty():
        yield _Every(what)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda done: bar.update(task, completed=done)


@dataclass
class _Every:
    """A line whenever ten seconds have gone by since the last."""

    what: str
    last: float = field(default_factory=time.monotonic)

    def __call__(self, done: float) -> None:
        if time.monotonic() - self.last > 10.0:
            self.last = time.monotonic()
            print(f"{self.what}: {100 * done:.0f} % done", file=sys.stderr, flush=True)


def _kernel(what: str, title: str, number: int, total: int) -> str:
    return f"{what}: compiling kernels {number} of {total}: {title}"


def _hands(executor: Executor | None) -> str:
    """How many pieces a cluster works on at the same time, which may change."""
    count = 0 if executor is None else slots(executor)
    return "" if executor is None else f", {count} thread{'' if count == 1 else 's'} at work"


def _not_ok(count: int) -> str:
    return f", {count} not ok" if count else ""


@dataclass
class _Pace:
    """How fast work goes on that may have begun in an earlier run."""

    at: float | None = None
    before: int = 0

    def begin(self, done: int) -> None:
        """Take the first time that this is called for the beginning."""
        if self.at is None:
            self.at, self.before = time.monotonic(), done

    def rate(self, done: int) -> float:
        """Items a second since the beginning."""
        assert self.at is not None
        return (done - self.before) / max(time.monotonic() - self.at, 1e-3)


@dataclass
class _Lines:
    """A line when designs are begun, one when all are found, and one whenever a minute has gone by."""

    what: str
    items: str
    executor: Executor | None = None
    pace: _Pace = field(default_factory=_Pace)
    last: float = field(default_factory=time.monotonic)

    def __call__(self, done: int, total: int, last: Outcome | Further | None, not_ok: int) -> None:
        self.pace.begin(done)
        if last is None and done < total:
            kept = f", {done} of them done before" if done else ""
            self._say(f"{total} {self.items} to find{kept}")
        elif last is not None and done == total:
            self._say(f"all {total} {self.items} found")
        elif last is not None and time.monotonic() - self.last > _SELDOM:
            rate = self.pace.rate(done)
            left = f"{rate:.3g} a second, about {_duration((total - done) / rate)} left"
            self._say(f"{done} of {total} {self.items} found{_not_ok(not_ok)}, {left}{_hands(self.executor)}")

    def _say(self, text: str) -> None:
        self.last = time.monotonic()
        print(f"{self.what}: {text}", file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    """A time for people, in the largest unit of which there are two."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.0f} s"
