"""A finding as data: a kind, its subject, and numbers; its sentence is formatted where it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from inerter.records.remedy import Remedy, Text, in_python
from inerter.statements import Severity, Statement, WordedEnum


class FindingKind(WordedEnum):
    """Kinds of findings, each with its sentence: a text, or a function of the finding."""

    def text(self, finding: Finding) -> Text:
        """The parts of the sentence of such a finding."""
        sentence: str | Text = self.format_words(finding)
        return (sentence,) if isinstance(sentence, str) else sentence


@dataclass(frozen=True)
class Finding(Statement):
    """One finding of a record or an identification.

    `error`: no model can be fitted to the record; `warning`: results may be affected; `info`: no action required.
    """

    kind: FindingKind
    severity: Severity = Severity.INFO
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

    @property
    def remedy(self) -> str:
        """The remedies of the sentence, in Python."""
        return "; ".join(str(part).strip() for part in self.text if isinstance(part, Remedy))
