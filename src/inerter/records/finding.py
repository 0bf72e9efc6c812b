"""A finding as data: a kind, its subject, and numbers; its sentence is formatted where it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from inerter.records.remedy import Text, in_python

Severity = Literal["info", "warning", "error"]


class Kind(Protocol):
    """A kind of finding, which formats its sentence."""

    def text(self, finding: Finding) -> Text:
        """The parts of its sentence."""
        ...


@dataclass(frozen=True)
class Finding:
    """One finding of a record or an identification.

    `error`: no model can be fitted to the record; `warning`: results may be affected; `info`: no action required.
    """

    kind: Kind
    severity: Severity
    about: str = ""  # a channel, a parameter, a record or a model
    numbers: Mapping[str, Any] = field(default_factory=dict)

    @property
    def text(self) -> Text:
        """The parts of its sentence: words and remedies."""
        return self.kind.text(self)

    @property
    def sentence(self) -> str:
        """The sentence with remedies in Python."""
        return in_python(self.text)
