"""A finding as data: a kind, what it is about, and numbers; its sentence is made where it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from inerter.records.remedy import Text, in_python

Severity = Literal["info", "warning", "error"]


class Kind(Protocol):
    """A kind of finding, which knows how one is said."""

    def text(self, finding: Finding) -> Text:
        """The parts of its sentence."""
        ...


@dataclass(frozen=True)
class Finding:
    """One thing found in a record or an identification.

    `error`: no model can be fitted to it as it is; `warning`: the work can go on, but look; `info`: good to know.
    """

    kind: Kind
    severity: Severity
    about: str = ""  # a channel, a parameter, a record or a model
    numbers: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> Text:
        """The parts of its sentence: words, and what can be done about it."""
        return self.kind.text(self)

    @property
    def sentence(self) -> str:
        """For a reader who works in Python."""
        return in_python(self.text)
