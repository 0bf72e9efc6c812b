"""A kind of export: a row of the registry, with what makes its contents."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from inerter.exports.request import ExportSpec


@dataclass(frozen=True)
class ExportKind:
    """A kind of export.

    `make(request, suffix)` gives the contents of a file with one of the `suffixes`, text or bytes; of a kind without
    suffixes, an object of Python. `requires` is what the machine must have for it.

    >>> import inerter as it
    >>> kind = it.EXPORTS["modelica"]
    >>> kind.suffixes, kind.is_file
    (('.mo',), True)
    """

    key: str
    description: str
    suffixes: tuple[str, ...]
    make: Callable[[ExportSpec, str], Any]
    requires: str = ""

    @property
    def is_file(self) -> bool:
        """Whether it is written to a file."""
        return bool(self.suffixes)
