"""The journal of a study: one line a finished case or budget."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

from inerter.errors import StudyError
from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.cases import Outcome
from inerter.files.study.study import Study
from inerter.work.journal import Journal

NAME = "journal.jsonl"


def journal_of(study: Study, path: Path) -> Journal:
    """The journal at `path`, which counts for this study alone."""
    text = json.dumps(study.resolved(), sort_keys=True)
    return Journal(path, {"title": study.title, "study": hashlib.sha256(text.encode()).hexdigest()})


def outcomes(journal: Journal) -> Iterator[Outcome | BudgetOutcome]:
    """The finished cases and budgets, one by one; raises `StudyError` for an entry that is none of a study."""
    for entry in journal.read():
        try:
            yield BudgetOutcome(**entry) if "parameter" in entry else Outcome(**entry)
        except TypeError:
            raise StudyError(f"{journal.path}: not the journal of a study. Choose another folder with -o.") from None
