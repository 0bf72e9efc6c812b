"""Kinds of files: each is a folder beside this one that states its `KIND`, and so is found here without being named."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from inerter import files


@dataclass(frozen=True)
class FileKind:
    """What files of a kind are called, the command that reads them, and sections by which they are known."""

    plural: str
    command: str
    sections: tuple[str, ...]


@cache
def kinds() -> tuple[FileKind, ...]:
    """All kinds of files."""
    folders = (import_module(f"{files.__name__}.{module.name}") for module in iter_modules(files.__path__))
    return tuple(folder.KIND for folder in folders if hasattr(folder, "KIND"))


def kind_with(section: str) -> FileKind | None:
    """The kind of file that is known by a section, if there is one."""
    return next((kind for kind in kinds() if section in kind.sections), None)
