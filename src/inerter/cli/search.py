"""Implementation of `inerter search`."""

from __future__ import annotations

import json
from pathlib import Path

from inerter.cli.cluster import workers
from inerter.cli.interrupts import interruptible
from inerter.cli.options import WorkOptions
from inerter.cli.progress import progress
from inerter.cli.streams import say
from inerter.files.common.folder import REPORT
from inerter.files.study.loading import load_study
from inerter.files.study.searching import StudySearch, search_study
from inerter.report.search import search_data, search_notes, search_sections, search_sentences, write_search_report
from inerter.report.text import section_text, wrap_text
from inerter.statements import Statement


def search(study: Path, options: WorkOptions) -> tuple[Statement, ...]:
    """Search the networks of a study file into a folder; returns its status."""
    loaded = load_study(study)
    folder = options.output or Path(f"{study.stem}-search")
    own = options.processes

    kept = options.continuation_clause(("search", str(study)), folder)
    with (
        interruptible(lambda: kept),
        workers(options.cluster, options.jobs) as executor,
        progress("networks", executor) as shown,
    ):
        found = search_study(
            loaded,
            folder,
            jobs=own,
            executor=executor,
            resume=options.resume,
            force=options.force,
            progress=shown.cases,
            compiling=shown.kernels,
            finish=write_search_report,
        )
    say(f"report: {folder / REPORT}")
    print(json.dumps(search_data(found), indent=2) if options.json else _text(found))
    return (found.status,)


def _text(found: StudySearch) -> str:
    """Tables, notes and conclusions for a terminal."""
    notes = [line for note in search_notes(found) for line in wrap_text(f"Note: {note}.", subsequent_indent="      ")]
    told = [line for text in search_sentences(found) for line in wrap_text(text, subsequent_indent="  ")]
    sections = section_text(search_sections(found))
    return "\n".join([*wrap_text(found.study.title), "", sections, *([""] if notes else []), *notes, "", *told])
