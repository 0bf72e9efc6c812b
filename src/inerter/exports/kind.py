"""A kind of export: a row of the registry, with what makes its contents."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from inerter.errors import ExportError
from inerter.exports.request import ExportSpec
from inerter.networks.elements import Network
from inerter.records.record import Record
from inerter.simulation.trajectory import Trajectory

OPTIONS = {
    "inputs": "a choice of inputs",
    "outputs": "a choice of outputs",
    "linear": "a model without friction and gaps",
    "form": "another form",
    "frequencies": "a choice of frequencies",
    "indices": "curves of indices",
    "part": "a strut alone",
    "speed": "one road for all axles",
    "platforms": "other platforms",
}  # that not every kind has
LINEAR_MODEL = ("inputs", "outputs", "linear", "form")
_OF_OBJECTS: dict[type, tuple[tuple[str, ...], str]] = {
    Record: ((), "it holds all channels"),
    Trajectory: (("outputs",), "it holds outputs over time"),
    Network: (("linear", "platforms"), "it holds one network"),
}  # the options that one of these has, whatever the kind, and why it has no others


@dataclass(frozen=True)
class ExportKind:
    """A kind of export.

    `make(request, suffix)` gives the contents of a file with one of the `suffixes`, text or bytes; of a kind without
    suffixes, an object of Python. `requires` is what the machine must have for it; it `takes` those of `OPTIONS` that
    `make` reads, and the others are refused. `synonyms` are other programs that open it, or names for it, in small
    letters.

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
    synonyms: tuple[str, ...] = ()

    @property
    def is_file(self) -> bool:
        """Whether it is written to a file."""
        return bool(self.suffixes)

    def check_options(self, options: Iterable[str]) -> None:
        """Raise `ExportError` for one of `OPTIONS` that this kind does not take."""
        for option in options:
            if option not in self.takes:
                text = OPTIONS[option]
                raise ExportError(f"An export to {self.key} does not accept {option}: it does not support {text}.")

    def contents(self, request: ExportSpec, suffix: str) -> Any:
        """Contents by `make`; raises `ExportError` for an option that this kind, or the object, does not have."""
        given = [name for name in OPTIONS if request.has(name)]
        self.check_options(given)
        for option in given:
            for kind, (options, reason) in _OF_OBJECTS.items():
                if isinstance(request.of, kind) and option not in options:
                    raise ExportError(f"An export of a {kind.__name__.lower()} does not accept {option}: {reason}.")
        return self.make(request, suffix)
