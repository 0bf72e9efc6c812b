"""Implementation of `inerter search`."""

from __future__ import annotations

import json
from pathlib import Path

from inerter.cli.options import WorkOptions
from inerter.cli.pace import Pace
from inerter.cli.streams import say
from inerter.cli.study_work import study_work
from inerter.files.common.folder import REPORT
from inerter.files.study.loading import load_study
from inerter.files.study.searching import StudySearch, search_study
from inerter.formatting import format_list
from inerter.report.search import search_data, search_notes, search_sections, search_sentences, write_search_report
from inerter.report.text import section_text, wrap_text
from inerter.statements import Statement


def search(study: Path, options: WorkOptions) -> tuple[Statement, ...]:
    """Search the networks of a study file into a folder; returns its status."""
    loaded = load_study(study)
    folder = options.output or Path(f"{study.stem}-search")
    further = [*["the Pareto front"] * bool(loaded.trade_off), *["real inerters"] * (loaded.real_inerters is not None)]
    pace = Pace.of_networks(format_list(further) if further else "")
    with study_work(("search", str(study)), folder, options, "networks", pace) as settings:
        found = search_study(loaded, folder, finish=write_search_report, **settings)
    say(f"report: {folder / REPORT}")
    print(json.dumps(search_data(found), indent=2) if options.json else _text(found))
    return (found.status,)


def _text(found: StudySearch) -> str:
    """Tables, notes and conclusions for a terminal."""
    notes = [line for note in search_notes(found) for line in wrap_text(f"Note: {note}.", subsequent_indent="      ")]
    told = [line for text in search_sentences(found) for line in wrap_text(text, subsequent_indent="  ")]
    sections = section_text(search_sections(found))
    return "\n".join([*wrap_text(found.study.title), "", sections, *([""] if notes else []), *notes, "", *told])
