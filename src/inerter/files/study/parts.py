"""Parts of the work on a study, designs and parts of tasks: one call computes each, and its result survives JSON.

Processes, executors, the journal, progress and exit codes know parts and results only.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np

from inerter.errors import InerterError, StatusKind
from inerter.work.blas_threads import one_blas_thread
from inerter.work.checkpoints import Row, resuming
from inerter.work.pool import KILLS
from inerter.work.progress import report, within

if TYPE_CHECKING:
    from inerter.files.study.cases import Case, Outcome
    from inerter.files.study.study import Study

FAILURES = (InerterError, np.linalg.LinAlgError, ArithmeticError, ValueError)  # the last: scipy's, of inf and nan
KnownSearches = Mapping[str, Sequence[Row]]  # of parts that have not ended, by the names of those
ENDED = f"{KILLS} processes ended, or had no memory left, while they worked on it"


class PartResult(ABC):
    """The result of a part; a frozen dataclass whose fields survive JSON."""

    of: ClassVar[type[StudyPart[Any]]]  # whose labels are fields here too
    sure: ClassVar[tuple[str, ...]] = (StatusKind.OK.value,)  # kinds of status with a result

    layout: str
    message: str

    @property
    def part(self) -> Any:
        """Part to which the result belongs."""
        labels: Any = self.of
        return labels(*(getattr(self, field.name) for field in fields(labels) if field.compare))

    @property
    def kind(self) -> str:
        """Kind of status: `failed` if the part as a whole has no result, with `message` as the reason."""
        return (StatusKind.FAILED if self.message else StatusKind.OK).value

    @property
    def name(self) -> str:
        """Name of the part in messages."""
        return str(self.part.name)

    @property
    def ok(self) -> bool:
        """Whether the status is one with a result."""
        return self.kind in self.sure

    @property
    def status_text(self) -> str:
        """The status with its reason."""
        return f"{self.kind}: {self.message}" if self.message else self.kind

    def to_json(self) -> dict[str, Any]:
        """A plain dictionary of the fields."""
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]


ResultT = TypeVar("ResultT", bound=PartResult)


class StudyPart(ABC, Generic[ResultT]):
    """A part of the work on a study: a frozen dataclass of its labels, which survives JSON."""

    layout: str

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the part in messages."""

    @abstractmethod
    def compute(self, study: Study, designs: Mapping[Case, Outcome], threads: int) -> ResultT:
        """The result, by at most `threads` threads; what it raises of `FAILURES` becomes `failed_result`.

        `designs` are the best designs of the study, empty while they are computed.
        """

    @abstractmethod
    def failed_result(self, study: Study, message: str) -> ResultT:
        """Result without numbers, with `message` as the reason."""


def run_part(study: Study, designs: Mapping[Case, Outcome], part: StudyPart[ResultT], threads: int = 1) -> ResultT:
    """The result of a part; of one that raises an error of `FAILURES`, its `failed_result`, and the study goes on."""
    try:
        with (
            one_blas_thread(),
            np.errstate(over="ignore", invalid="ignore", divide="ignore"),
            within(part.name),
        ):
            report("", share=0.0)
            return part.compute(study, designs, threads)
    except FAILURES as error:
        return part.failed_result(study, str(error))


def resume_part(
    study: Study,
    designs: Mapping[Case, Outcome],
    known: KnownSearches,
    part: StudyPart[ResultT],
    threads: int = 1,
) -> ResultT:
    """The result of a part, whose searches go on from what is known of them."""
    with resuming(part.name, known):
        return run_part(study, designs, part, threads)


def lost_part(study: Study, part: StudyPart[ResultT]) -> ResultT:
    """Result of a part whose worker processes ended at every attempt."""
    return part.failed_result(study, ENDED)
