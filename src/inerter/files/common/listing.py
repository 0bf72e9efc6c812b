"""List of the files written in a folder, with a hash of each, which distinguishes them from the user's files."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from inerter.atomic_io import write_text
from inerter.errors import StudyError
from inerter.work.journal import is_intact

MARK = ".inerter"  # the folder of the list, of the lock, and of what is under way
_NAME = f"{MARK}/files.json"
_WHAT = ("journal", "single")  # what a file may be beside one of several results
_ABOUT = (
    "Files that inerter wrote in this folder, with the SHA-256 of each. --force replaces only these, and only if "
    "they are unchanged. A journal grows: the number of its lines shows whether it was edited."
)


@dataclass(frozen=True)
class Entry:
    """Listed file: the command that wrote it, and its possible hashes; none for a journal that grows.

    A `single` one was asked for by its name, and makes no folder of results.
    """

    by: str
    digests: tuple[str, ...] = ()
    journal: bool = False
    single: bool = False


@dataclass(frozen=True)
class Listing:
    """The files that were written in a folder, by their names below it."""

    files: Mapping[str, Entry] = field(default_factory=dict)

    def by(self, command: str) -> dict[str, Entry]:
        """Entries of the files written by `command`, by name."""
        return {name: entry for name, entry in self.files.items() if entry.by == command}

    def with_files(self, files: Mapping[str, Entry], without: Iterable[str] = ()) -> Listing:
        """Listing with `files` added or replaced, and the names in `without` removed."""
        gone = set(without)
        return Listing({name: entry for name, entry in {**self.files, **files}.items() if name not in gone})

    def write(self, folder: Path) -> None:
        """Write the list into its folder."""
        files: dict[str, dict[str, Any]] = {
            name: {"by": entry.by, "sha256": entry.digests, **{what: True for what in _WHAT if getattr(entry, what)}}
            for name, entry in sorted(self.files.items())
        }
        write_text(folder / _NAME, json.dumps({"about": _ABOUT, "files": files}, indent=1) + "\n")


def listing(folder: Path) -> Listing | None:
    """Listing of a folder; None if it has none that is readable."""
    try:
        files = json.loads((folder / _NAME).read_bytes())["files"]
        found = {
            name: Entry(
                str(entry["by"]), tuple(map(str, entry["sha256"])), **{what: bool(entry.get(what)) for what in _WHAT}
            )
            for name, entry in files.items()
        }
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
    return Listing(found) if all(map(_is_below, found)) else None


def digest(path: Path) -> str:
    """The SHA-256 of a file."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def is_own(folder: Path, name: str, known: Listing) -> bool:
    """Whether the file is the one that the list names: in no linked folder, no link itself, and unchanged."""
    path, entry = folder / name, known.files.get(name)
    if entry is None or is_linked(folder, name) or not path.is_file():
        return False
    return digest(path) in entry.digests or (entry.journal and not entry.digests and is_intact(path))


def check_unchanged(folder: Path, name: str) -> None:
    """Raises `StudyError` unless a folder of results has the file as it was written; one without a list is believed."""
    path, known = folder / name, listing(folder)
    if not path.is_file():
        raise StudyError(f"{folder}: has no {name}, so it is not a folder of results. Give that of a completed run.")
    if known is not None and (name not in known.files or digest(path) not in known.files[name].digests):
        raise StudyError(
            f"{path}: was not written by inerter, or was edited since, so the folder may mix results of different "
            "studies. Run the changed study into another folder with `inerter run`, or undo the change."
        )


def is_linked(folder: Path, name: str) -> bool:
    """Whether the file, or a folder that it is in, is a link; `folder` itself may be one."""
    parts = PurePosixPath(name).parts
    return any(folder.joinpath(*parts[: count + 1]).is_symlink() for count in range(len(parts)))


def names_below(folder: Path) -> list[str]:
    """All files of a folder and its folders, but those of our own mark."""
    found = []
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name != MARK)
        found += [(Path(place) / name).relative_to(folder).as_posix() for name in sorted(files)]
    return found


def _is_below(name: str) -> bool:
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and not {"..", MARK} & set(path.parts)
