"""The journal of a study: one line a finished case or budget."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

from inerter.errors import StudyError
from inerter.files.study.budgets import BudgetCase, BudgetOutcome
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.study import Study
from inerter.work.journal import Entry, Journal

NAME = "journal.jsonl"
Done = dict[Case, Outcome]
Budgets = dict[BudgetCase, BudgetOutcome]


def journal_of(study: Study, path: Path) -> Journal:
    """The journal at `path`, which counts for this study alone."""
    text = json.dumps(study.resolved(), sort_keys=True)
    return Journal(path, {"title": study.title, "study": hashlib.sha256(text.encode()).hexdigest()})


def finished(path: Path, entries: Sequence[Entry]) -> tuple[Done, Budgets]:
    """The finished cases and budgets; raises `StudyError` for entries that are none of a study."""
    try:
        outcomes = [Outcome(**entry) for entry in entries if "parameter" not in entry]
        budgets = [BudgetOutcome(**entry) for entry in entries if "parameter" in entry]
    except TypeError:
        raise StudyError(f"{path}: not the journal of a study. Choose another folder with -o.") from None
    return {outcome.case: outcome for outcome in outcomes}, {budget.case: budget for budget in budgets}
