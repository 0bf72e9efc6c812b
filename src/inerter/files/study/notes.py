"""Notes of methods on the designs of a study, each once for all cases with the same wording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from inerter.files.study.cases import Case, Outcome
from inerter.files.study.study import Study
from inerter.methods.notes import text_of

Part = str | float
_Words = tuple[str | None, ...]  # of a note, with None for its numbers


def road_notes(study: Study) -> list[str]:
    """Note on the road fitted to a measured profile; empty without one."""
    return [] if study.line is None else [study.line.note]


@dataclass
class _Alike:
    """Notes that differ in their numbers only: first occurrence, range of each number, and the layouts."""

    first: tuple[int, int]
    low: list[Part]
    high: list[Part]
    layouts: set[str] = field(default_factory=set)

    def add(self, place: tuple[int, int], note: Sequence[Part]) -> None:
        self.first = min(self.first, place)
        for i, part in enumerate(note):
            if not isinstance(part, str):
                self.low[i], self.high[i] = min(self.low[i], part), max(self.high[i], part)


@dataclass
class Notes:
    """Notes of all outcomes added, in any order; memory grows with the number of distinct wordings only."""

    _alike: dict[_Words, _Alike] = field(default_factory=dict)

    def add(self, number: int, case: Case, outcome: Outcome) -> None:
        """Add the notes of the outcome of the case of that number."""
        for i, note in enumerate(outcome.notes):
            words = tuple(part if isinstance(part, str) else None for part in note)
            alike = self._alike.get(words)
            if alike is None:
                alike = self._alike[words] = _Alike((number, i), [*note], [*note])
            else:
                alike.add((number, i), note)
            alike.layouts.add(case.layout)

    def texts(self, layouts: Sequence[str]) -> list[str]:
        """Each note with the layouts that it concerns, in the order of the cases."""
        return [
            f"{', '.join(name for name in layouts if name in alike.layouts)}: {_note_with_ranges(alike)}"
            for alike in sorted(self._alike.values(), key=lambda alike: alike.first)
        ]


def _note_with_ranges(alike: _Alike) -> str:
    """Note with the range of each number that differs."""
    texts = []
    for ends in zip(alike.low, alike.high, strict=True):
        low, high = (text_of((end,)) for end in ends)
        texts.append(low if low == high else f"{low} to {high}")
    return "".join(texts)
