"""A kind of export: a row of the registry, with what makes its contents."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from inerter.errors import ExportError
from inerter.exports.request import ExportSpec

OPTIONS = {
    "part": "a strut alone",
    "speed": "one road for all axles",
    "platforms": "other platforms",
}  # that not every kind can say


@dataclass(frozen=True)
class ExportKind:
    """A kind of export.

    `make(request, suffix)` gives the contents of a file with one of the `suffixes`, text or bytes; of a kind without
    suffixes, an object of Python. `requires` is what the machine must have for it; it `takes` those of `OPTIONS` that
    its format has.

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
    takes: tuple[str, ...] = ()

    @property
    def is_file(self) -> bool:
        """Whether it is written to a file."""
        return bool(self.suffixes)

    def contents(self, request: ExportSpec, suffix: str) -> Any:
        """Contents by `make`; raises `ExportError` for an option that this kind does not take."""
        for option, text in OPTIONS.items():
            if getattr(request, option) and option not in self.takes:
                raise ExportError(f"An export to {self.key} does not accept {option}: it does not support {text}.")
        return self.make(request, suffix)
