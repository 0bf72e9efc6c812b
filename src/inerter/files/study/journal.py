"""The journal of a study: a line for each finished case and part of a task, and lines of searches under way."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.errors import StudyError
from inerter.files.study.cases import Outcome
from inerter.files.study.parts import PartResult
from inerter.files.study.study import Study
from inerter.files.study.tasks import answer_of
from inerter.work.checkpoints import Checkpoint
from inerter.work.journal import Journal

NAME = "journal.jsonl"
ResultOfEntry = Callable[[Mapping[str, Any]], PartResult]


def journal_of(study: Study, path: Path) -> Journal:
    """Journal at `path`, valid for this study only."""
    return Journal(path, json.loads(json.dumps(study.to_tables(), sort_keys=True)))


def result_of(entry: Mapping[str, Any]) -> PartResult:
    """Result that an entry has: of a part of a task, or of a design."""
    return answer_of(entry) if "task" in entry else Outcome(**entry)


def results_of(journal: Journal, make: ResultOfEntry = result_of) -> Iterator[PartResult | Checkpoint]:
    """Results of finished parts, and the state of unfinished searches, one at a time.

    Raises `StudyError` for an entry that is none of a study.
    """
    for entry in journal.read():
        try:
            yield Checkpoint(**entry) if "rows" in entry else make(entry)
        except TypeError:
            raise StudyError(f"{journal.path}: not the journal of a study. Choose another folder with -o.") from None
