"""Progress of long work, on stderr: a bar on a terminal, lines elsewhere."""

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
    ProgressColumn,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from inerter.cli.pace import Kind, Pace
from inerter.cli.pulse import Pulse, display, pulse
from inerter.files.study.cases import Outcome
from inerter.files.study.parts import PartResult
from inerter.files.study.running import Progress as Report
from inerter.files.study.tasks import tasks
from inerter.formatting import format_count, format_duration, format_number
from inerter.kernels.prepare import ProgressCallback
from inerter.work.cluster import slots
from inerter.work.progress import Listener, ProgressStep, listening

_SLOW = 2.0  # seconds for one item, from which they are said


class ProgressCallbacks(NamedTuple):
    """Callbacks that display the progress of a study."""

    cases: Report  # how many cases are done, and which one was last
    kernels: ProgressCallback  # which kernel is compiled before that


@dataclass
class _Study:
    """State of progress of a study, and its description in words."""

    items: str
    executor: Executor | None
    pace: Pace
    done: int = 0
    total: int = 0
    kept: int = 0  # done in an earlier run
    n_failures: int = 0
    begun: float | None = None
    compiling: str = ""

    def count(self, done: int, total: int, last: PartResult | None, n_failures: int) -> None:
        """Take note of what is done."""
        if self.begun is None:
            self.begun, self.kept = time.monotonic(), done
            self.pace.begin(done, total)
        elif last is not None:
            self.pace.finish(*_kind_of(last), done - self.done)
        self.done, self.total, self.n_failures, self.compiling = done, total, n_failures, ""

    def begin_kernel(self, title: str, number: int, total: int) -> None:
        """Take note of a kernel that is begun."""
        self.compiling = f"compiling kernels {number} of {total}: {title}"

    def words(self, step: ProgressStep) -> str:
        """State of progress, in one line."""
        if self.begun is None or self.done == self.total:  # what comes then is not counted, such as the figures
            return self.compiling or str(step)
        part = self.part()
        rate = f", {self.rate()}" if self.done > self.kept + 9 else ""
        count = f"{self.done} of {self.total} {self.items} found{_failures_clause(self.n_failures)}{rate}"
        return f"{count}{f'; {part}' if part else ''}{self.pace.words()}{_hands(self.executor)}"

    def part(self) -> str:
        """The design under way of which most is done, in words."""
        parts = sorted((step for step, _ in self.pace.parts.values()), key=lambda step: step.share or 0.0)
        return str(parts[-1]) if parts else ""

    def rate(self) -> str:
        """Items a second since the beginning, or the time that one takes where it is seconds."""
        assert self.begun is not None
        each = max(time.monotonic() - self.begun, 1e-3) / (self.done - self.kept)
        return f"one in {format_duration(each)}" if each >= _SLOW else f"{format_number(1.0 / each, 3)} a second"


@contextmanager
def progress(
    items: str = "designs", executor: Executor | None = None, pace: Pace | None = None
) -> Iterator[ProgressCallbacks]:
    """Callbacks that show how far the work is.

    `items` names what is to be found, `executor` is where it is computed, and `pace` estimates the remaining time.
    """
    study = _Study(items, executor, Pace({}) if pace is None else pace)
    with _on_terminal(study) if sys.stderr.isatty() else _in_lines(study) as shown:
        yield shown


@contextmanager
def _in_lines(study: _Study) -> Iterator[ProgressCallbacks]:
    """A line when designs are begun, one when all are found, and one whenever it was silent for long."""
    with pulse(study.words, study.pace.take) as printer:

        def show(done: int, total: int, last: PartResult | None, n_failures: int) -> None:
            study.count(done, total, last, n_failures)
            if last is None and done < total:
                kept = f", {done} of them done before" if done else ""
                printer.say(f"{study.items} to find: {total}{kept}")
            elif last is not None and done == total:
                printer.say(f"{total} of {total} {study.items} found")

        def on_kernel_begin(title: str, number: int, total: int) -> None:
            study.begin_kernel(title, number, total)
            printer.say(study.compiling)

        yield ProgressCallbacks(show, on_kernel_begin)


@contextmanager
def _bar(*columns: ProgressColumn) -> Iterator[Progress]:
    """A bar with its description and these columns, removed at the end."""
    first = TextColumn("{task.description}"), BarColumn()
    with display(), Progress(*first, *columns, console=Console(stderr=True), transient=True) as bar:
        yield bar


@contextmanager
def _on_terminal(study: _Study) -> Iterator[ProgressCallbacks]:
    """A bar, which moves."""
    with _bar(MofNCompleteColumn(), TimeElapsedColumn()) as bar:
        task = bar.add_task("preparing", total=None)

        def update(step: ProgressStep) -> None:
            study.pace.take(step)
            words = study.words(step)
            if study.begun is None or study.done == study.total:
                bar.update(task, completed=study.done, description=words)
                return
            parts = sum(one.share or 0.0 for one, _ in study.pace.parts.values())
            text = f"{study.part() or study.items}{_failures_clause(study.n_failures)}{study.pace.words()}"
            bar.update(task, completed=study.done + parts, total=study.total, description=text)

        with listening(Listener(update, every=0.5)):
            yield ProgressCallbacks(study.count, study.begin_kernel)


@contextmanager
def steps() -> Iterator[Callable[[str, int, int], None]]:
    """A callback that shows how far each of several parts of the work is: its name, steps done, and all steps."""
    if not sys.stderr.isatty():
        parts = _PartCounts()
        with pulse(parts.words) as printer:
            parts.printer = printer
            yield parts
        return
    with _bar(MofNCompleteColumn(), TimeElapsedColumn()) as bar:
        rows: dict[str, TaskID] = {}

        def show(part: str, done: int, total: int) -> None:
            if part not in rows:
                rows[part] = bar.add_task(part, total=total)
            bar.update(rows[part], completed=done, total=total)

        yield show


@dataclass
class _PartCounts:
    """A line when a part begins, one when it ends, and one whenever it was silent for long."""

    counts: dict[str, tuple[int, int]] = field(default_factory=dict)
    printer: Pulse | None = None

    def __call__(self, part: str, done: int, total: int) -> None:
        is_new = part not in self.counts
        self.counts[part] = done, total
        if self.printer is None:
            return
        if is_new:
            kept = f", {done} of them done before" if done else ""
            self.printer.say(f"{part}: {total} steps{kept}")
        elif done == total:
            self.printer.say(f"{part}: done")

    def words(self, step: ProgressStep) -> str:
        """State of the running task: name, progress, and step."""
        under_way = [f"{part}: {done} of {total} steps" for part, (done, total) in self.counts.items() if done < total]
        return "; ".join((*under_way[-1:], str(step)))


@contextmanager
def fraction(what: str) -> Iterator[Callable[[float], None]]:
    """A callback that shows what part of one long computation is done."""
    if not sys.stderr.isatty():
        part = [0.0]

        def words(step: ProgressStep) -> str:
            return f"{what}: {round(100 * part[0])} % done{f'; {step}' if step.total else ''}"

        with pulse(words):
            yield lambda done: part.__setitem__(0, done)
        return
    with _bar(TaskProgressColumn(), TimeRemainingColumn()) as bar:
        task = bar.add_task(what, total=1.0)

        def show(step: ProgressStep) -> None:
            bar.update(task, description=f"{what}: {step}" if step.total else what)

        with listening(Listener(show, every=0.5)):
            yield lambda done: bar.update(task, completed=done)


def _hands(executor: Executor | None) -> str:
    """Clause on the number of threads of a cluster, which may change; empty without one."""
    return "" if executor is None else f", {format_count(slots(executor), 'threads')} at work"


def _kind_of(last: PartResult) -> Kind:
    """Kind of a design or of an answer for the estimate of the remaining time."""
    if isinstance(last, Outcome):
        return last.layout, last.index
    return "", next((task.key for task in tasks() if isinstance(last, task.answer)), "")


def _failures_clause(count: int) -> str:
    return f", {count} not ok" if count else ""
