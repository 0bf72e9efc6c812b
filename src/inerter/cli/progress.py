"""Progress of long work, on stderr: a bar on a terminal, two lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
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

from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.cases import Outcome
from inerter.files.study.running import Progress as Report
from inerter.kernels.prepare import Told


class Shown(NamedTuple):
    """What shows how far a study is."""

    cases: Report  # how many cases are done, and which one was last
    kernels: Told  # which kernel is compiled before that


@contextmanager
def progress(what: str, items: str = "designs") -> Iterator[Shown]:
    """Callbacks that show how far the work is; `items` says what there is to find."""
    if not sys.stderr.isatty():
        yield Shown(
            lambda done, total, outcome: _line(what, items, done, total, outcome),
            lambda title, number, total: print(_kernel(what, title, number, total), file=sys.stderr, flush=True),
        )
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)

        def show(done: int, total: int, outcome: Outcome | BudgetOutcome | None) -> None:
            name = f"{what}: {outcome.layout} {outcome.index}" if outcome else what
            bar.update(task, completed=done, total=total, description=name)

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


def _line(what: str, items: str, done: int, total: int, outcome: Outcome | BudgetOutcome | None) -> None:
    if outcome is None and done < total:
        kept = f", {done} of them done before" if done else ""
        print(f"{what}: {total} {items} to find{kept}", file=sys.stderr, flush=True)
    elif outcome is not None and done == total:
        print(f"{what}: all {total} {items} found", file=sys.stderr, flush=True)
