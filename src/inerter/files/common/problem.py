"""A problem of a file as data: its place, what arrived, what is wrong with it, what was expected, what to try.

Here, and nowhere else, it becomes a sentence.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from inerter.errors import InerterError
from inerter.formatting import capital
from inerter.statements import Severity, Statement
from inerter.units import quote_value

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+(\[[0-9]+\])?")  # with its number in a list of tables


@dataclass(frozen=True)
class Problem(Statement):
    """Problem of an entry of a file; `said` is a complete sentence, such as that of an error, in place of the parts."""

    place: tuple[str, ...] = ()  # the path of keys
    said: str = ""
    got: str = ""  # what arrived, as it can be shown
    fault: str = ""  # what is wrong with it
    expected: str = ""
    hint: str = ""  # what to try, a whole sentence

    severity = Severity.ERROR

    @property
    def about(self) -> str:
        """The path of keys as in a TOML file."""
        return ".".join(key if _BARE_KEY.fullmatch(key) else quote_value(key) for key in self.place)

    @property
    def remedy(self) -> str:
        """The hint."""
        return self.hint

    def __str__(self) -> str:
        sentence = self.said or _sentence(self)
        return f"{self.about}: {sentence[0].lower()}{sentence[1:]}" if self.place else sentence


class EntryError(ValueError):
    """Invalid entry, regardless of its place in the file."""

    def __init__(self, *, got: str = "", fault: str = "", expected: str = "", hint: str = "") -> None:
        self.problem = Problem(got=got, fault=fault, expected=expected, hint=hint)
        super().__init__(self.problem)

    def __str__(self) -> str:
        return capital(str(self.problem))


def invalid_entry(entry: object, *, fault: str = "", expected: str = "", hint: str = "") -> EntryError:
    """The error of an entry, which its message shows as it arrived."""
    return EntryError(got=quote_value(entry), fault=fault, expected=expected, hint=hint)


def at(
    place: Iterable[str], said: str = "", *, got: str = "", fault: str = "", expected: str = "", hint: str = ""
) -> Problem:
    """The problem of the entry at this path of keys."""
    return Problem(tuple(place), said, got, fault, expected, hint)


@contextmanager
def collect_problem(problems: list[Problem], place: Iterable[str]) -> Iterator[None]:
    """Add the error that this block raises to the problems, as one of the entry at this path of keys."""
    try:
        yield
    except EntryError as error:
        problems.append(replace(error.problem, place=tuple(place)))
    except InerterError as error:
        problems.append(at(place, str(error)))


def _sentence(problem: Problem) -> str:
    arrived = f"got {problem.got}" if problem.got else ""
    what = ": ".join(part for part in (arrived, problem.fault) if part)
    wanted = f"expected {problem.expected}" if problem.expected else ""
    return " ".join(part for part in ("; ".join(filter(None, (what, wanted))) + ".", problem.hint.strip()) if part)
