"""Papers as registry entries, whose code is imported only when it is used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Protocol

from inerter.errors import StudyError

if TYPE_CHECKING:
    from inerter.files.study.running import StudyResult


class PaperResults(Protocol):
    """Recomputed results of a paper, of which other modules use only the studies."""

    @property
    def studies(self) -> Mapping[str, StudyResult]:
        """Results of the studies that are a part of it, by their names; a failure of one is one of the paper."""


@dataclass(frozen=True)
class Paper:
    """Paper whose results can be recomputed.

    `recompute`, `write`, `data` and `text` name functions, as "package.module:function", of the module concerned, so
    that the registry entry itself imports nothing.

    >>> import inerter as it
    >>> paper = it.PAPERS["wang-su-2008"]
    >>> isinstance(paper, it.Paper), "linear" in paper.parts, len(paper.claims)
    (True, True, 13)
    """

    name: str
    title: str
    parts: tuple[str, ...]  # each of which can be recomputed alone
    claims: Mapping[int, str]  # what the paper says, by number
    figures: Mapping[str, str]  # the caption of each, by the name of its file
    examples: tuple[str, ...]  # options after its name, and what they do
    recompute: str
    write: str
    data: str
    text: str

    def reproduce(self, folder: Path, *, only: Sequence[str] = (), **settings: Any) -> PaperResults:
        """Recompute the paper, or some of its parts, into `folder`, with tables, figures and a page.

        `settings` are `jobs`, `resume`, `force` and `progress`, as in `run_study`, except that `progress` receives the
        name of the task, the number of completed steps, and the number of all steps.

        Raises `StudyError` as `run_study` does, or for an unknown part; `WorkError` as `run_study` does.
        """
        unknown = [part for part in only if part not in self.parts]
        if unknown:
            known = ", ".join(self.parts)
            raise StudyError(f"Unknown part {unknown[0]!r} of {self.name}; available: {known}.")
        found: PaperResults = resolve_name(self.recompute)(
            folder, only=only, finish=resolve_name(self.write), **settings
        )
        return found

    def as_data(self, found: PaperResults) -> dict[str, Any]:
        """Recomputed results as rows for JSON, by table."""
        tables: dict[str, Any] = resolve_name(self.data)(found)
        return tables

    def as_text(self, found: PaperResults) -> str:
        """Recomputed results as text of 80 columns."""
        return str(resolve_name(self.text)(found))
