"""The study of the command line, read again when another program has changed its file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.app import documents
from inerter.app.study_text import read_file
from inerter.errors import StudyError

_NOTHING: dict[str, Any] = {"name": "", "text": "", "study": {}, "problems": []}


def to_document(name: str, text: str) -> dict[str, Any]:
    """A study file as a page opens it."""
    return {"name": name, "text": text, **documents.read(text, name)}


@dataclass
class InitialStudy:
    """Study of the command line: as a document, and the file that it is from, if any."""

    document: dict[str, Any] = field(default_factory=lambda: _NOTHING)
    path: Path | None = None
    _read: str = ""  # stamp of the file whose document is kept

    @classmethod
    def of(cls, name: str, text: str, path: Path | None) -> InitialStudy:
        """The study of a text; of the file at `path`, if it is from one."""
        return cls(to_document(name, text), path, "" if path is None else _stamp(path))

    def to_dict(self) -> dict[str, Any]:
        """The document as the file is now, and its stamp; as it was where it cannot be read, with the reason."""
        if self.path is not None and (stamp := _stamp(self.path)) != self._read:
            try:
                self.document = to_document(self.path.name, read_file(self.path))
            except StudyError as error:
                return {**self.document, "problems": documents.problems_of(error), "stamp": stamp}
            self._read = stamp
        return {**self.document, "stamp": self._read}

    def stamp(self) -> dict[str, str]:
        """Name of the file, and a text that changes with it; both empty without a file."""
        return {"name": self.document["name"], "stamp": "" if self.path is None else _stamp(self.path)}


def _stamp(path: Path) -> str:
    """Modification time [ns] and size [byte] of a file as text; empty if there is none."""
    try:
        there = path.stat()
    except OSError:
        return ""
    return f"{there.st_mtime_ns} {there.st_size}"
