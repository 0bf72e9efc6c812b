"""Implementation of the command `reproduce`: papers, and what is recomputed of one."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import wrap

from inerter.cli.cluster import workers
from inerter.cli.commands import report_failures
from inerter.cli.interrupts import interruptible
from inerter.cli.options import WorkOptions
from inerter.cli.progress import steps
from inerter.cli.streams import say
from inerter.files.common.folder import REPORT
from inerter.papers.paper import Paper
from inerter.papers.registry import PAPERS
from inerter.report.text import WIDTH
from inerter.statements import Statement


def papers() -> None:
    """Print the available papers with their parts."""
    print("\n\n".join(_describe_paper(paper) for paper in PAPERS.values()))


def _describe_paper(paper: Paper) -> str:
    lines = (f"Parts: {', '.join(paper.parts)}.", f"Claims: {len(paper.claims)}. Figures: {len(paper.figures)}.")
    told = [*wrap(paper.title, WIDTH - 2), *(line for text in lines for line in wrap(text, WIDTH - 2))]
    return "\n".join([paper.name, *(f"  {line}" for line in told)])


def reproduce(name: str, only: tuple[str, ...], options: WorkOptions) -> tuple[Statement, ...]:
    """Reproduce the paper of that name, or some parts of it; returns the statuses of its studies."""
    paper = PAPERS[name]
    folder = options.output or Path(f"{name}-results")
    own = options.processes
    parts = (word for part in only for word in ("--only", part))
    kept = options.continuation_clause(("reproduce", name, *parts), folder)
    settings = {"jobs": own, "resume": options.resume, "force": options.force}
    with interruptible(lambda: kept), workers(options.cluster, options.jobs) as executor, steps() as callback:
        found = paper.reproduce(folder, only=only, executor=executor, progress=callback, **settings)
    say(f"report: {folder / REPORT}")
    print(json.dumps(paper.as_data(found), indent=2) if options.json else paper.as_text(found))
    for result in found.studies.values():
        report_failures(result)
    return tuple(result.status for result in found.studies.values())
