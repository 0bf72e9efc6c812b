"""Tasks: analyses of the best designs of a study, in parts that are computed one by one.

All of a task is in one file: its parts, how one is answered, what is known of one that failed, and how answers are
written as CSV, on a terminal, on a page. The keys that ask for it are with its row, or with those of [study]. The
journal, processes, executors, progress, `--json` and exit codes are the same for all.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np

from inerter.errors import StatusKind
from inerter.files.study.cases import ENDED, FAILURES, Case, Outcome
from inerter.files.study.task_rows import TASKS
from inerter.optimisation.threads import one_blas_thread
from inerter.registry import cache_until_registration

if TYPE_CHECKING:
    import xarray as xr

    from inerter.files.common.problem import Problem
    from inerter.files.study.study import Study
    from inerter.table import Table, Writer

Designs = Mapping[Case, Outcome]


@dataclass(frozen=True, kw_only=True)
class Answer(ABC):
    """The answer to a part of a task, in SI units; all of it survives JSON, with `answer_of`."""

    sure: ClassVar[tuple[str, ...]] = (StatusKind.OK.value,)  # statuses that answer the question

    layout: str
    status: str
    message: str = ""

    @property
    @abstractmethod
    def part(self) -> TaskPart[Any]:
        """Task part to which the answer belongs."""

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return self.part.name

    @property
    def ok(self) -> bool:
        """Whether the status is one that answers the question."""
        return self.status in self.sure

    @property
    def status_text(self) -> str:
        """The status with its reason."""
        return f"{self.status}: {self.message}" if self.message else self.status

    @property
    def doubt(self) -> str:
        """Reason why the answer is uncertain; empty if it is not."""
        return "" if self.ok else self.status_text


AnswerT = TypeVar("AnswerT", bound=Answer)


class TaskPart(ABC, Generic[AnswerT]):
    """A part of a task: a frozen dataclass of its labels, which survives JSON."""

    layout: str

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the task part in messages."""

    @abstractmethod
    def answer(self, study: Study, designs: Designs, threads: int) -> AnswerT:
        """Answer for the best designs. What it raises of `FAILURES` becomes that of `failed`."""

    @abstractmethod
    def failure_answer(self, study: Study, message: str) -> AnswerT:
        """Answer without numbers, with `message` as the reason."""


class Task(ABC, Generic[AnswerT]):
    """Kind of analysis of the best designs of a study."""

    key: ClassVar[str]  # of its answers in the journal and in --json, and of their file
    title: ClassVar[str]  # of its section in a report
    answer: type[AnswerT]

    @abstractmethod
    def parts(self, study: Study) -> Sequence[TaskPart[AnswerT]]:
        """Task parts in the order of the results; none if the study does not request the task."""

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of the keys of the task; `given` are the keys that the section [study] has."""
        yield from ()

    @abstractmethod
    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Items of the report's problem statement, by heading."""

    @abstractmethod
    def csv(self, study: Study, answers: Sequence[AnswerT]) -> Iterator[Sequence[object]]:
        """Rows of the CSV file of the task, the header first."""

    def add_to_dataset(self, study: Study, data: xr.Dataset, answers: Sequence[AnswerT]) -> xr.Dataset:
        """Dataset of the study with the answers that belong in it; called with at least one answer."""
        return data

    @abstractmethod
    def lines(self, results: TaskResults[AnswerT], width: int) -> Iterator[str]:
        """All answers for a terminal."""

    @abstractmethod
    def tables(self, results: TaskResults[AnswerT]) -> list[Table]:
        """All answers for a page."""

    def introduction(self) -> str:
        """Paragraph above the tables of the task; empty by default."""
        return ""

    @abstractmethod
    def sentences(self, results: TaskResults[AnswerT], write: Writer) -> Iterator[str]:
        """Conclusions as sentences; an uncertain one states the uncertainty first."""


@dataclass(frozen=True, eq=False)
class TaskResults(Generic[AnswerT]):
    """Answers to one task, with the study and the dataset of its designs."""

    study: Study
    data: xr.Dataset
    answers: Sequence[AnswerT]


@cache_until_registration
def tasks() -> tuple[Task[Any], ...]:
    """All tasks, in the order in which they are computed and reported."""
    return tuple(_task(row.home) for row in TASKS.values())


def _task(home: str) -> Task[Any]:
    module, _, name = home.partition(":")
    made: Task[Any] = getattr(import_module(module), name)()
    return made


def parts_of(study: Study) -> list[TaskPart[Any]]:
    """All parts of all tasks of a study."""
    return [part for task in tasks() for part in task.parts(study)]


def answer_part(study: Study, designs: Designs, part: TaskPart[AnswerT], threads: int = 1) -> AnswerT:
    """The answer to a part. A failure is an answer with a status and a sentence."""
    try:
        with one_blas_thread(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return part.answer(study, designs, threads)
    except FAILURES as error:
        return part.failure_answer(study, str(error))


def lost_part(study: Study, part: TaskPart[AnswerT]) -> AnswerT:
    """Answer of a task part whose worker processes ended at every attempt."""
    return part.failure_answer(study, ENDED)


def by_task(answers: Iterable[Answer]) -> dict[Task[Any], list[Any]]:
    """Answers by task; only tasks that have some."""
    every = list(answers)
    found = {task: [one for one in every if isinstance(one, task.answer)] for task in tasks()}
    return {task: own for task, own in found.items() if own}


def to_json(answer: Answer) -> dict[str, Any]:
    """A plain dictionary of what an answer holds."""
    return {field.name: getattr(answer, field.name) for field in fields(answer)}


def journal_entry(answer: Answer) -> dict[str, Any]:
    """Dictionary of an answer with the key of its task, for a journal; `answer_of` is the inverse."""
    (task,) = (one for one in tasks() if isinstance(answer, one.answer))
    return {"task": task.key, **to_json(answer)}


def answer_of(entry: Mapping[str, Any]) -> Answer:
    """Answer of an entry made by `journal_entry`.

    Raises `TypeError` for an entry that is none.
    """
    makers: dict[str, Callable[..., Answer]] = {one.key: one.answer for one in tasks()}
    maker = makers.get(entry["task"])
    if maker is None:
        raise TypeError(entry["task"])
    return maker(**{name: value for name, value in entry.items() if name != "task"})
