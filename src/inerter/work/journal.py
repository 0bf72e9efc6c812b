"""A journal: one line for each piece of work that is finished, safe against Ctrl-C, kill and power loss.

Every line ends in a check sum of itself and of all lines before it, so that a line that was altered, doubled, left out
or brought from elsewhere is told from one that was written here. The first line says what the others rest on.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inerter.errors import StudyError
from inerter.work.origin import VERSION, origin
from inerter.writing import whole

FORMAT = 2
_LINE = re.compile(rb'(\{.*), "check": "([0-9a-f]{16})"\}')
_AWAY = "Move it away, or choose another folder with -o."
_WORDS = {
    "format": "another format",
    "inerter": "another version of inerter",
    "numbers": "other sources or libraries that make the numbers",
}
Entry = dict[str, Any]


@dataclass(frozen=True)
class Journal:
    """Where finished work is written down, and `about`: what must be the same for it to count."""

    path: Path
    about: Mapping[str, str]

    def read(self) -> list[Entry]:
        """All entries; none if there is no journal yet. A last line that was cut short is left out.

        Raises `StudyError` if a line is not as it was written, or the journal belongs to other work.
        """
        lines = whole_lines(self.path)
        if not lines:
            return []
        header, *entries = [entry for _, entry in self._checked(lines)]
        wanted = self._header()
        if header != wanted:
            raise StudyError(
                f"{self.path.parent}: holds the results of another study or version "
                f"({_differences(header, wanted)}). Start again with --force, or choose another folder with -o."
            )
        return entries

    @contextmanager
    def appending(self, entries: Iterable[Entry]) -> Iterator[Callable[[Entry], None]]:
        """What appends an entry and waits until it is on disk; the journal holds `entries` to begin with."""
        check = ""
        with whole(self.path) as draft, draft.open("wb") as stream:
            for entry in (self._header(), *entries):
                line, check = _written(entry, check)
                stream.write(line)
        with self.path.open("ab", buffering=0) as journal:

            def append(entry: Entry) -> None:
                nonlocal check
                line, check = _written(entry, check)
                while line:  # a disk that is nearly full takes a part
                    line = line[journal.write(line) :]
                os.fsync(journal.fileno())

            yield append

    def _header(self) -> Entry:
        return {"format": FORMAT, "inerter": VERSION, **self.about, "numbers": origin()}

    def _checked(self, lines: list[bytes]) -> Iterator[tuple[int, Entry]]:
        for number, entry in enumerate(entries_of(lines), 1):
            if entry is None:
                what = (
                    "this is no journal, or one of an older version"
                    if number == 1
                    else "this line is not the one that was written here"
                )
                raise StudyError(f"{self.path}, line {number}: {what}, so none of it is used. {_AWAY}")
            yield number, entry


def is_intact(path: Path) -> bool:
    """Whether every whole line of the file is as a journal wrote it."""
    try:
        return None not in entries_of(whole_lines(path))
    except OSError:
        return False


def whole_lines(path: Path) -> list[bytes]:
    """The lines that have an end."""
    return path.read_bytes().split(b"\n")[:-1] if path.exists() else []


def entries_of(lines: Iterable[bytes]) -> Iterator[Entry | None]:
    """What the lines say; None for the first that is not as it was written, which is the last."""
    check = ""
    for line in lines:
        found = _LINE.fullmatch(line)
        body = found[1] + b"}" if found else b""
        check = _check(body, check)
        try:
            entry = json.loads(body) if found and found[2].decode() == check else None
        except (ValueError, RecursionError):
            entry = None
        yield entry
        if entry is None:
            return


def _written(entry: Entry, before: str) -> tuple[bytes, str]:
    body = json.dumps(entry).encode()
    check = _check(body, before)
    return body[:-1] + f', "check": "{check}"}}\n'.encode(), check


def _check(body: bytes, before: str) -> str:
    return hashlib.sha256(before.encode() + body).hexdigest()[:16]


def _differences(found: Entry, wanted: Entry) -> str:
    return ", ".join(
        _WORDS.get(key) or f"{key}: {str(found.get(key))[:12]!r} there, {str(value)[:12]!r} here"
        for key, value in wanted.items()
        if found.get(key) != value
    )
