"""The journal of a running study: one line a finished case, safe against Ctrl-C, kill and power loss."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import inerter
from inerter.errors import StudyError
from inerter.study.budgets import BudgetCase, BudgetOutcome
from inerter.study.cases import Case, Outcome
from inerter.study.values import Study

NAME = "journal.jsonl"


@dataclass(frozen=True)
class Journal:
    """Where finished cases are written down."""

    path: Path
    study: Study

    def start(self) -> None:
        """Begin anew, with a line that says which study this is."""
        self.path.write_text(json.dumps(self._header()) + "\n", encoding="utf-8")

    def read(self) -> dict[Case, Outcome]:
        """The finished cases; none if there is no journal yet. A last line that a kill cut short is dropped.

        Raises what `read_all` raises.
        """
        return self.read_all()[0]

    def read_all(self) -> tuple[dict[Case, Outcome], dict[BudgetCase, BudgetOutcome]]:
        """The finished cases and budgets.

        Raises `StudyError` if the journal belongs to another study or to another version of this software.
        """
        raw = self.path.read_bytes() if self.path.exists() else b""
        whole = raw[: raw.rfind(b"\n") + 1]
        if not whole:
            return {}, {}
        if len(whole) < len(raw):
            with self.path.open("r+b") as stream:
                stream.truncate(len(whole))
        try:
            header, *lines = [json.loads(line) for line in whole.decode("utf-8").splitlines()]
            outcomes = [Outcome(**line) for line in lines if "parameter" not in line]
            budgets = [BudgetOutcome(**line) for line in lines if "parameter" in line]
        except (ValueError, TypeError):
            raise StudyError(
                f"{self.path}: not a journal of a study, or damaged. Start anew with --force, or in another folder."
            ) from None
        if header != self._header():
            raise StudyError(
                f"{self.path.parent}: holds the results of another study or version "
                f"({_differences(header, self._header())}). Start anew with --force, or choose another folder with -o."
            )
        return {outcome.case: outcome for outcome in outcomes}, {budget.case: budget for budget in budgets}

    @contextmanager
    def appending(self) -> Iterator[Appender]:
        """Open for writing down outcomes, each safely on disk before the next."""
        with self.path.open("a", encoding="utf-8") as stream:
            yield Appender(stream)

    def _header(self) -> dict[str, Any]:
        text = json.dumps(self.study.resolved(), sort_keys=True)
        return {
            "format": 1,
            "inerter": inerter.__version__,
            "title": self.study.title,
            "study": hashlib.sha256(text.encode()).hexdigest(),
        }


@dataclass(frozen=True)
class Appender:
    """Writes outcomes to an open journal."""

    stream: Any

    def write(self, outcome: Outcome | BudgetOutcome) -> None:
        """Append one line and wait until it is on disk."""
        self.stream.write(json.dumps(outcome.to_json()) + "\n")
        self.stream.flush()
        os.fsync(self.stream.fileno())


def _differences(found: Any, wanted: dict[str, Any]) -> str:
    if not isinstance(found, dict):
        return "its first line is not a header"
    return ", ".join(
        f"{key}: {str(found.get(key))[:12]!r} there, {str(value)[:12]!r} here"
        for key, value in wanted.items()
        if found.get(key) != value
    )
