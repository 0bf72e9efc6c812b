"""Tasks: analyses of the best designs of a study, in parts that are computed one by one.

All of a task is in one file: its parts, how one is answered, what is known of one that failed, the table of its answers
and its conclusions. The keys that ask for it are with its row, or with those of [study]. The
journal, processes, executors, progress, `--json` and exit codes are the same for all.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from inerter.errors import DesignError, StatusKind
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.parts import PartResult, StudyPart
from inerter.files.study.task_registry import TASKS
from inerter.registry import cache_until_registration

if TYPE_CHECKING:
    import xarray as xr

    from inerter.files.common.problem import Problem
    from inerter.files.study.study import Study
    from inerter.table import Table
    from inerter.vehicle.vehicle import Vehicle

Designs = Mapping[Case, Outcome]


def best_design(study: Study, designs: Designs, layout: str, index: str) -> Vehicle:
    """The best design of a layout for an index; raises `DesignError` if none is feasible."""
    outcome = designs[Case(layout, index)]
    if outcome.kind == StatusKind.INFEASIBLE.value:
        raise DesignError(f"{layout} has no feasible design for {index}.")
    return study.design(layout).with_values(outcome.parameters)


@dataclass(frozen=True, kw_only=True)
class Answer(PartResult):
    """The answer to a part of a task, in SI units; all of it survives JSON, with `answer_of`."""

    layout: str
    status: str
    message: str = ""

    @property
    def kind(self) -> str:
        """Kind of status."""
        return self.status

    @property
    def doubt(self) -> str:
        """Reason why the answer is uncertain; empty if it is not."""
        return "" if self.ok else self.status_text


AnswerT = TypeVar("AnswerT", bound=Answer)


class TaskPart(StudyPart[AnswerT]):
    """A part of a task: a frozen dataclass of its labels, which survives JSON."""


class Task(ABC, Generic[AnswerT]):
    """Kind of analysis of the best designs of a study."""

    key: ClassVar[str]  # of its answers in the journal and in --json, and of their file
    title: ClassVar[str]  # of its section in a report
    items: ClassVar[str] = ""  # its parts where they are counted, in the plural; the key if empty
    answer: type[AnswerT]

    @abstractmethod
    def parts(self, study: Study) -> Sequence[TaskPart[AnswerT]]:
        """Task parts in the order of the results; none if the study does not request the task."""

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of the keys of the task; `given` are the keys that the section [study] has."""
        yield from ()

    def warnings(self, study: Study) -> Iterator[str]:
        """Warnings of a check before the run: parts that take very long."""
        yield from ()

    @abstractmethod
    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Items of the report's problem statement, by heading."""

    def add_to_dataset(self, study: Study, data: xr.Dataset, answers: Sequence[AnswerT]) -> xr.Dataset:
        """Dataset of the study with the answers that belong in it; called with at least one answer."""
        return data

    @abstractmethod
    def table(self, results: TaskResults[AnswerT]) -> Table:
        """All answers, at least one, as terminals, pages and the CSV file of the task show them."""

    def introduction(self) -> str:
        """Paragraph above the tables of the task; empty by default."""
        return ""

    @abstractmethod
    def sentences(self, results: TaskResults[AnswerT]) -> Iterator[str]:
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
    return tuple(_task(entry.home) for entry in TASKS.values())


def _task(home: str) -> Task[Any]:
    module, _, name = home.partition(":")
    made: Task[Any] = getattr(import_module(module), name)()
    return made


def parts_of(study: Study) -> list[TaskPart[Any]]:
    """All parts of all tasks of a study."""
    return [part for task in tasks() for part in task.parts(study)]


def by_task(answers: Iterable[Answer]) -> dict[Task[Any], list[Any]]:
    """Answers by task; only tasks that have some."""
    every = list(answers)
    found = {task: [one for one in every if isinstance(one, task.answer)] for task in tasks()}
    return {task: own for task, own in found.items() if own}


def journal_entry(result: PartResult) -> dict[str, Any]:
    """Dictionary of a result for a journal; that of an answer has the key of its task, for `answer_of`."""
    key = next((task.key for task in tasks() if isinstance(result, task.answer)), None)
    return result.to_json() if key is None else {"task": key, **result.to_json()}


def answer_of(entry: Mapping[str, Any]) -> Answer:
    """Answer of an entry made by `journal_entry`.

    Raises `TypeError` for an entry that is none.
    """
    makers: dict[str, Callable[..., Answer]] = {one.key: one.answer for one in tasks()}
    maker = makers.get(entry["task"])
    if maker is None:
        raise TypeError(entry["task"])
    return maker(**{name: value for name, value in entry.items() if name != "task"})
