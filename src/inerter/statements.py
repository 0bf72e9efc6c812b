"""Statements about inputs and results: their severity, their groups, and the exit codes that follow from them.

Problems of files, errors, findings, notes, verdicts and statuses are statements. Each is data; its sentence is
formatted where it is shown, and nothing reads a sentence to decide.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from typing import Any, Self, TypeVar


class WordedEnum(StrEnum):
    """Keys, each with its words: a text, the parts of one, or a function that formats what it is given."""

    words: Any

    def __new__(cls, key: str, words: Any) -> Self:
        member = str.__new__(cls, key)
        member._value_, member.words = key, words
        return member

    def format_words(self, of: object) -> Any:
        """The words, formatted for a statement, its numbers or a value."""
        return self.words(of) if callable(self.words) else self.words


class Severity(StrEnum):
    """Severity of a statement, in ascending order; comparisons follow it and not the alphabet."""

    INFO = "info"  # no action required
    WARNING = "warning"  # a result is, or may be, unreliable or missing
    ERROR = "error"  # the input cannot be used

    def __lt__(self, other: str) -> bool:
        return _EXIT_CODES[self] < _EXIT_CODES[Severity(other)]

    def __le__(self, other: str) -> bool:
        return _EXIT_CODES[self] <= _EXIT_CODES[Severity(other)]

    def __gt__(self, other: str) -> bool:
        return _EXIT_CODES[self] > _EXIT_CODES[Severity(other)]

    def __ge__(self, other: str) -> bool:
        return _EXIT_CODES[self] >= _EXIT_CODES[Severity(other)]


_EXIT_CODES = {Severity.INFO: 0, Severity.WARNING: 1, Severity.ERROR: 2}
INTERRUPTED = 130  # exit code that shells give a command ended by Ctrl-C


class Statement:
    """Interface of a statement about an input or a result."""

    @property
    def severity(self) -> Severity:
        """Severity."""
        return Severity.INFO

    @property
    def about(self) -> str:
        """Subject: key path, channel, parameter, record or model; empty for the whole."""
        return ""

    @property
    def sentence(self) -> str:
        """The statement in words, with its subject."""
        return str(self)

    @property
    def remedy(self) -> str:
        """Remedy in words; empty if there is none."""
        return ""


S = TypeVar("S", bound=Statement)


def by_severity(statements: Iterable[S]) -> dict[Severity, list[S]]:
    """Statements by severity, the most severe first; only severities that occur."""
    groups: dict[Severity, list[S]] = {}
    for statement in statements:
        groups.setdefault(statement.severity, []).append(statement)
    return {severity: groups[severity] for severity in sorted(groups, reverse=True)}


def exit_code(statements: Iterable[Statement]) -> int:
    """Exit code of a command with these statements on its input and its result: that of the most severe one.

    0 if the result is reliable, 1 if it is unreliable or missing, 2 if the input cannot be used.
    """
    return _EXIT_CODES[max((statement.severity for statement in statements), default=Severity.INFO)]
