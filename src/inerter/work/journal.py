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
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from mmap import ACCESS_READ, mmap
from pathlib import Path
from shutil import copyfileobj
from typing import Any

from inerter.errors import StudyError, WorkError
from inerter.work.origin import VERSION, origin
from inerter.writing import whole

FORMAT = 2
_LINE = re.compile(rb'(\{.*), "check": "([0-9a-f]{16})"\}')
_CHECK = re.compile(rb'"check": "([0-9a-f]{16})"\}\n\Z')
_LONGEST_END = 64  # bytes in which a check sum and the end of its line are
_decoded = json.JSONDecoder().decode
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

    def read(self) -> Iterator[Entry]:
        """All entries, one by one; none if there is no journal yet. A last line that was cut short is left out.

        Raises `StudyError` if a line is not as it was written, or the journal belongs to other work.
        """
        wanted = self._header()
        for number, entry in enumerate(entries_of(whole_lines(self.path)), 1):
            if entry is None:
                what = (
                    "this is no journal, or one of an older version"
                    if number == 1
                    else "this line is not the one that was written here"
                )
                raise StudyError(f"{self.path}, line {number}: {what}, so none of it is used. {_AWAY}")
            if number > 1:
                yield entry
            elif entry != wanted:
                raise StudyError(
                    f"{self.path.parent}: holds the results of another study or version "
                    f"({_differences(entry, wanted)}). Start again with --force, or choose another folder with -o."
                )

    @contextmanager
    def appending(self, again: bool = False) -> Iterator[Callable[..., None]]:
        """What appends entries, a line each, and waits until all are on disk.

        The journal begins afresh, or goes on behind its last whole line with `again`, which is for one that was read.
        """
        end, check = _end(self.path) if again else (0, "")
        if end:
            _cut(self.path, end)
        else:
            line, check = _written(self._header(), "")
            with whole(self.path) as draft:
                draft.write_bytes(line)
        with self.path.open("ab", buffering=0) as journal:

            def append(*entries: Entry) -> None:
                nonlocal check
                lines = bytearray()
                for entry in entries:
                    line, check = _written(entry, check)
                    lines += line
                while lines:  # a disk that is nearly full takes a part
                    del lines[: journal.write(lines)]
                os.fsync(journal.fileno())

            try:
                yield append
            except WorkError as error:
                raise WorkError(f"{error} What was computed is kept; continue with --resume.") from error.__cause__

    def _header(self) -> Entry:
        return {"format": FORMAT, "inerter": VERSION, **self.about, "numbers": origin()}


def is_intact(path: Path) -> bool:
    """Whether every whole line of the file is as a journal wrote it."""
    try:
        return None not in entries_of(whole_lines(path))
    except OSError:
        return False


def whole_lines(path: Path) -> Iterator[bytes]:
    """The lines that have an end."""
    with path.open("rb") if path.exists() else nullcontext(()) as lines:
        for line in lines:
            if line.endswith(b"\n"):
                yield line[:-1]


def entries_of(lines: Iterable[bytes]) -> Iterator[Entry | None]:
    """What the lines say; None for the first that is not as it was written, which is the last."""
    check = ""
    for line in lines:
        found = _LINE.fullmatch(line)
        body = found[1] + b"}" if found else b""
        check = _check(body, check)
        try:
            entry = _decoded(body.decode()) if found and found[2].decode() == check else None
        except (ValueError, RecursionError):
            entry = None
        yield entry
        if entry is None:
            return


def _end(path: Path) -> tuple[int, str]:
    """Where the last whole line of a journal that was read ends, and its check sum; (0, "") if there is none."""
    if not path.exists() or not path.stat().st_size:
        return 0, ""
    with path.open("rb") as stream, mmap(stream.fileno(), 0, access=ACCESS_READ) as content:
        end = content.rfind(b"\n") + 1
        found = _CHECK.search(content[max(end - _LONGEST_END, 0) : end])
    return (end, found[1].decode()) if found else (0, "")


def _cut(path: Path, end: int) -> None:
    """Leave out what is behind `end`. A file that has another name too stays as it is under that."""
    if path.stat().st_nlink == 1:
        os.truncate(path, end)
        return
    with whole(path) as draft, draft.open("wb") as stream, path.open("rb") as before:
        copyfileobj(before, stream)
        stream.truncate(end)


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
