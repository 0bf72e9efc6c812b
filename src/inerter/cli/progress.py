"""Progress of long work, on stderr: a bar on a terminal, two lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from inerter.study.cases import Outcome
from inerter.study.run import Progress as Callback


@contextmanager
def progress(what: str) -> Iterator[Callback]:
    """A callback that shows how many cases are done, and which one was last."""
    if not sys.stderr.isatty():
        yield lambda done, total, outcome: _line(what, done, total, outcome)
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

        def show(done: int, total: int, outcome: Outcome | None) -> None:
            name = f"{what}: {outcome.layout} {outcome.index}" if outcome else what
            bar.update(task, completed=done, total=total, description=name)

        yield show


def _line(what: str, done: int, total: int, outcome: Outcome | None) -> None:
    if outcome is None and done < total:
        kept = f", {done} of them done before" if done else ""
        print(f"{what}: {total} designs to find{kept}", file=sys.stderr, flush=True)
    elif outcome is not None and done == total:
        print(f"{what}: all {total} designs found", file=sys.stderr, flush=True)
