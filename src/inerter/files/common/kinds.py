"""Kinds of files: each subpackage of `files` that states a `KIND` is found here without being named."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from shlex import quote
from typing import Any

from inerter import files
from inerter.files.common.schema import DIALECT

DEFAULT = "run"  # the command of the kind that a file without any known section is taken for


@dataclass(frozen=True)
class FileKind:
    """Name of a kind of file, the command that reads it, and the sections that identify it.

    The module `checking` of its `folder` has `check_lines(tables, path)`: sentences about a file that the command
    accepts, from its tables. It raises the `StudyError` with which the command would refuse it. The module `sections`
    has the function of the name `codec`.
    """

    plural: str
    command: str
    sections: tuple[str, ...]
    folder: str  # the package
    codec: str  # name of the function in its module `sections` that returns the codec of the whole file
    about: str  # a sentence
    usage: str = "{file}"  # what follows the command, where {file} is the path of a file

    @property
    def name(self) -> str:
        """Name of the kind in one word, that of its folder."""
        return self.folder.rpartition(".")[2]

    @property
    def singular(self) -> str:
        """Name of one file of the kind."""
        return self.plural.removesuffix("s")

    def call(self, path: Path) -> str:
        """The command line that takes the file at `path`."""
        return f"inerter {self.command} {self.usage.format(file=quote(str(path)))}"

    def check_lines(self, tables: Mapping[str, Any], path: Path) -> Iterable[str]:
        """Sentences about a sound file of this kind; raises `StudyError` for another."""
        lines: Iterable[str] = import_module(f"{self.folder}.checking").check_lines(tables, path)
        return lines

    def schema(self) -> dict[str, Any]:
        """JSON Schema (2020-12) of a file of this kind, with what other distributions add."""
        table = getattr(import_module(f"{self.folder}.sections"), self.codec)().schema()
        title = f"A {self.singular} of inerter"
        return {"$schema": DIALECT, "title": title, **table, "description": self.about}


@cache
def kinds() -> tuple[FileKind, ...]:
    """All kinds of files, study files first."""
    folders = (import_module(f"{files.__name__}.{module.name}") for module in iter_modules(files.__path__))
    found = (folder.KIND for folder in folders if hasattr(folder, "KIND"))
    return tuple(sorted(found, key=lambda kind: kind.command != DEFAULT))


def kind_with(section: str) -> FileKind | None:
    """Kind of file that a section identifies; None for an unknown section."""
    return next((kind for kind in kinds() if section in kind.sections), None)


def kind_of(tables: Mapping[str, Any]) -> FileKind:
    """Kind of file with the largest share of its sections in `tables`; a study file if none is present."""
    return max(kinds(), key=lambda kind: _share(kind, tables))


def mistaken_kinds(tables: Mapping[str, Any], keys: Iterable[str]) -> tuple[FileKind, FileKind] | None:
    """The kind of file that `tables` are and the one whose keys are given, where they plainly differ; else None."""
    found, known = kind_of(tables), set(keys)
    wanted = next((kind for kind in kinds() if known.issuperset(kind.sections)), found)
    is_plain = _share(found, tables) == 1.0 or known.isdisjoint(tables)
    return (found, wanted) if is_plain and _share(found, tables) > _share(wanted, tables) else None


def _share(kind: FileKind, tables: Mapping[str, Any]) -> float:
    """The part of the sections of a kind that are in `tables`."""
    return sum(section in tables for section in kind.sections) / len(kind.sections)
