"""The journal of a study: one line a finished case, budget or front, and lines of searches that they came to before."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

from inerter.errors import StudyError
from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.cases import Outcome
from inerter.files.study.fronts import FrontOutcome
from inerter.files.study.study import Study
from inerter.files.study.tolerances import ToleranceOutcome
from inerter.work.journal import Journal
from inerter.work.kept import Kept

NAME = "journal.jsonl"
Further = BudgetOutcome | FrontOutcome | ToleranceOutcome
_FURTHER: dict[str, type[Further]] = {  # by a key that others lack
    "parameter": BudgetOutcome,
    "jumps": FrontOutcome,
    "effects": ToleranceOutcome,
}
_KINDS: dict[str, type[Further | Kept]] = {**_FURTHER, "rows": Kept}


def journal_of(study: Study, path: Path) -> Journal:
    """The journal at `path`, which counts for this study alone."""
    text = json.dumps(study.resolved(), sort_keys=True)
    return Journal(path, {"title": study.title, "study": hashlib.sha256(text.encode()).hexdigest()})


def outcomes(journal: Journal) -> Iterator[Outcome | Further | Kept]:
    """What is finished, and searches of what is not, one by one.

    Raises `StudyError` for an entry that is none of a study.
    """
    for entry in journal.read():
        kind = next((kind for key, kind in _KINDS.items() if key in entry), Outcome)
        try:
            yield kind(**entry)
        except TypeError:
            raise StudyError(f"{journal.path}: not the journal of a study. Choose another folder with -o.") from None
