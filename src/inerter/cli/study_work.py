"""A study that is worked on in a folder: on which processes, with progress, and what Ctrl-C says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from inerter.cli.cluster import workers
from inerter.cli.interrupts import interruptible
from inerter.cli.options import WorkOptions
from inerter.cli.pace import Pace
from inerter.cli.progress import progress


@contextmanager
def study_work(
    command: Sequence[str], folder: Path, options: WorkOptions, items: str, pace: Pace | None
) -> Iterator[dict[str, Any]]:
    """Arguments of the function that works on a study: processes, what becomes of results, and callbacks."""
    own, kept = options.processes, options.continuation_clause(command, folder)
    with (
        interruptible(lambda: kept),
        workers(options.cluster, options.jobs) as executor,
        progress(items, executor, pace) as shown,
    ):
        yield {
            "jobs": own,
            "executor": executor,
            "resume": options.resume,
            "force": options.force,
            "progress": shown.cases,
            "compiling": shown.kernels,
        }
