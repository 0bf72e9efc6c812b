"""The error that reports the problems of a file, one a line."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from inerter.errors import StudyError
from inerter.files.common.problem import Problem

_MOST, _LONGEST = 20, 600  # problems, and characters of each


class FileError(StudyError):
    """A file that cannot be used, and its problems as data."""

    def __init__(self, text: str, problems: tuple[Problem, ...]) -> None:
        super().__init__(text, problems)
        self.problems = problems

    def __str__(self) -> str:
        return str(self.args[0])


def refusal(path: Path, problems: Iterable[Problem]) -> FileError:
    """The error that reports the `problems` of the file, one a line: so many as a reader may want to see."""
    every = list(problems)
    lines = [f"{path.name}: {shorten_line(str(problem))}" for problem in every[:_MOST]]
    if len(every) > _MOST:
        lines.append(f"{path.name}: and {len(every) - _MOST} problems more.")
    return FileError("\n".join(lines), tuple(every))


def shorten_line(line: str) -> str:
    """A line without its middle if it is long, as names in it may be."""
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 205]} ... {line[-200:]}"
