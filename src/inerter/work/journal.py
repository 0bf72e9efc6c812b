"""A journal: one line for each completed task, safe against Ctrl-C, kill and power loss.

Every line ends in a checksum of itself and of all lines before it, so that altered, duplicated, missing or foreign
lines are detected. The first line identifies the work, the version and the sources.
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

from inerter.atomic_io import atomic_write
from inerter.errors import StudyError, WorkError
from inerter.formatting import format_some
from inerter.units import quote_value
from inerter.work.origin import VERSION, origin

FORMAT = 2
_LINE = re.compile(rb'(\{.*), "check": "([0-9a-f]{16})"\}')
_CHECK = re.compile(rb'"check": "([0-9a-f]{16})"\}\n\Z')
_MOST = 4  # differences in a message
_LONGEST_END = 64  # bytes in which a check sum and the end of its line are
_decoded = json.JSONDecoder().decode
_AWAY = "Move it away, or choose another folder with -o."
_WORDS = {
    "format": "another format",
    "inerter": "another version of inerter",
    "numbers": "other sources or numerical libraries",
}
Entry = dict[str, Any]


@dataclass(frozen=True)
class Journal:
    """A file of completed work, and `about`: the properties that must agree for reuse, as JSON has them."""

    path: Path
    about: Mapping[str, Any]

    def read(self) -> Iterator[Entry]:
        """Entries, one by one; empty without a journal. A truncated last line is ignored.

        Raises `StudyError` for a modified line, or a journal of other work.
        """
        wanted = self._header()
        for number, entry in enumerate(entries_of(whole_lines(self.path)), 1):
            if entry is None:
                what = "not a journal, or one of an older version" if number == 1 else "modified line"
                raise StudyError(f"{self.path}, line {number}: {what}; the journal cannot be used. {_AWAY}")
            if number > 1:
                yield entry
            elif entry != wanted:
                raise StudyError(
                    f"{self.path.parent}: contains results of another study or version "
                    f"({_differences(entry, wanted)}). Start again with --force, or choose another folder with -o."
                )

    @contextmanager
    def appending(self, again: bool = False) -> Iterator[Callable[..., None]]:
        """Open the journal and yield a function that appends entries, a line each, and waits until they are on disk.

        The journal is started new, or continued after its last complete line with `again`, after it was read.
        """
        end, check = _end(self.path) if again else (0, "")
        if end:
            _cut(self.path, end)
        else:
            line, check = _format_line(self._header(), "")
            with atomic_write(self.path) as draft:
                draft.write_bytes(line)
        with self.path.open("ab", buffering=0) as journal:

            def append(*entries: Entry) -> None:
                nonlocal check
                lines = bytearray()
                for entry in entries:
                    line, check = _format_line(entry, check)
                    lines += line
                while lines:  # a nearly full disk may write only part
                    del lines[: journal.write(lines)]
                os.fsync(journal.fileno())

            try:
                yield append
            except WorkError as error:
                raise WorkError(f"{error} Completed results are kept; continue with --resume.") from error.__cause__

    def _header(self) -> Entry:
        return {"format": FORMAT, "inerter": VERSION, **self.about, "numbers": origin()}


def is_intact(path: Path) -> bool:
    """Whether every complete line of the file is unmodified."""
    try:
        return None not in entries_of(whole_lines(path))
    except OSError:
        return False


def whole_lines(path: Path) -> Iterator[bytes]:
    """Complete lines of the file, without line ends."""
    with path.open("rb") if path.exists() else nullcontext(()) as lines:
        for line in lines:
            if line.endswith(b"\n"):
                yield line[:-1]


def entries_of(lines: Iterable[bytes]) -> Iterator[Entry | None]:
    """Entries of the lines; None for the first modified one, after which reading ends."""
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
    """End position of the last complete line of a journal, and its checksum; (0, "") if there is none."""
    if not path.exists() or not path.stat().st_size:
        return 0, ""
    with path.open("rb") as stream, mmap(stream.fileno(), 0, access=ACCESS_READ) as content:
        end = content.rfind(b"\n") + 1
        found = _CHECK.search(content[max(end - _LONGEST_END, 0) : end])
    return (end, found[1].decode()) if found else (0, "")


def _cut(path: Path, end: int) -> None:
    """Truncate the file at `end`. Other hard links to it keep their content."""
    if path.stat().st_nlink == 1:
        os.truncate(path, end)
        return
    with atomic_write(path) as draft, draft.open("wb") as stream, path.open("rb") as before:
        copyfileobj(before, stream)
        stream.truncate(end)


def _format_line(entry: Entry, before: str) -> tuple[bytes, str]:
    body = json.dumps(entry).encode()
    check = _check(body, before)
    return body[:-1] + f', "check": "{check}"}}\n'.encode(), check


def _check(body: bytes, before: str) -> str:
    return hashlib.sha256(before.encode() + body).hexdigest()[:16]


def _differences(found: Entry, wanted: Entry) -> str:
    there, here = (dict(leaves(entry)) for entry in (found, wanted))
    told = [
        _WORDS.get(key) or f"{key} {_entry(there.get(key))} there, {_entry(here.get(key))} here"
        for key in {**here, **there}
        if there.get(key) != here.get(key)
    ]
    return format_some(told, _MOST)


def _entry(value: object) -> str:
    return "not set" if value is None else quote_value(value)


def leaves(tables: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, Any]]:
    """Entries of nested tables by their key paths.

    >>> dict(leaves({"road": {"speed": "25 m/s"}, "seed": 0}))
    {'road.speed': '25 m/s', 'seed': 0}
    """
    for key, entry in tables.items():
        if isinstance(entry, Mapping):
            yield from leaves(entry, f"{place}{key}.")
        else:
            yield f"{place}{key}", entry
