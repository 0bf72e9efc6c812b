"""Sections and conclusions on the results of a study, which its page and the terminal share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from inerter.files.study.study import Study
from inerter.files.study.tasks import Answer
from inerter.report.conclusions import conclusion_sentences
from inerter.report.sections import Section, design_sections, task_sections

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, eq=False)
class StudyContents:
    """Contents of a report on a study, each made when it is first used."""

    results: xr.Dataset
    study: Study
    answers: Sequence[Answer] = ()

    @cached_property
    def design_sections(self) -> list[Section]:
        """Sections on the designs."""
        return list(design_sections(self.results))

    @cached_property
    def task_sections(self) -> list[Section]:
        """Sections on the tasks that have answers."""
        return list(task_sections(self.study, self.results, self.answers))

    @cached_property
    def conclusions(self) -> list[str]:
        """Conclusions in sentences."""
        return conclusion_sentences(self.results, self.study, self.answers)
