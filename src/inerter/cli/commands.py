"""Implementation of the command `run`."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from textwrap import wrap

from inerter.cli.options import WorkOptions
from inerter.cli.pace import Pace
from inerter.cli.streams import say
from inerter.cli.study_work import study_work
from inerter.files.common.folder import REPORT
from inerter.files.study.cases import cases
from inerter.files.study.loading import load_study
from inerter.files.study.plausibility import roads_sentences
from inerter.files.study.running import SUMMARY, StudyResult, run_study
from inerter.files.study.study import Study
from inerter.files.study.tasks import tasks
from inerter.formatting import format_list, merge_alike
from inerter.report.problem_statement import index_rows
from inerter.report.study_contents import StudyContents
from inerter.report.study_data import as_text
from inerter.report.text import WIDTH, section_text, wrap_text
from inerter.report.writing import write_figures_and_report
from inerter.statements import Statement

_MOST = 20  # designs that are told one by one


def run(study: Path, options: WorkOptions) -> tuple[Statement, ...]:
    """Run a study file into a folder; returns its status."""
    loaded = load_study(study)
    folder = options.output or Path(f"{study.stem}-results")
    items = format_list(["designs", *(task.items or task.key for task in tasks() if task.parts(loaded))])
    reported: list[StudyContents] = []
    with study_work(("run", str(study)), folder, options, items, _pace(loaded)) as settings:
        result = run_study(
            loaded, folder, finish=lambda *results: reported.append(write_figures_and_report(*results)), **settings
        )
    say(f"report: {folder / REPORT}")
    if options.json:
        for text in as_text(result):
            print(text, end="")
    else:
        sums = [f"{title}: {what}." for title, what in index_rows(loaded, combined=True)]
        head = [line for text in (loaded.title, *roads_sentences(loaded), *sums) for line in _hanging(text)]
        (contents,) = reported
        print("\n".join([*head, "", section_text([*contents.design_sections, *contents.task_sections])]))
        for note in result.data.attrs["notes"].splitlines():
            print("\n".join(wrap(f"Note: {note}.", WIDTH, subsequent_indent="      ")))
        print("\n".join(["", *(line for text in contents.conclusions for line in _hanging(text))]))
    report_failures(result)
    return (result.status,)


def _hanging(text: str) -> list[str]:
    return wrap_text(text, subsequent_indent="  ")


def _pace(study: Study) -> Pace:
    """Estimator of the remaining time of a study, initially weighted by the design variables of each layout."""
    free = {name: len(study.design(name).free_values()) if study.optimise else 1 for name in study.layouts}
    parts = {part.name: task.key for task in tasks() for part in task.parts(study)}
    return Pace(free, study.indices, cases(study).points, parts)


def report_failures(result: StudyResult) -> None:
    """Report designs whose status is not ok on stderr, those with the same status in one line."""
    failing = list(islice(result.statuses_not_ok(), _MOST))
    for status, places in merge_alike([status for _, status in failing]):
        say(f"{'; '.join(failing[place][0] for place in places)}: {status}")
    if result.n_failures > _MOST:
        say(f"and {result.n_failures - _MOST} more like these; {result.folder / SUMMARY} lists all")
