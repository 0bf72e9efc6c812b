"""The budgets of a study: how much of an element the best designs bear before they lose to the baseline."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from inerter.errors import StatusKind
from inerter.files.study.cases import ENDED, FAILURES, Case, Outcome
from inerter.files.study.method_problems import budget_method
from inerter.files.study.study import Study, elements_used
from inerter.methods.registry import deciding
from inerter.networks.elements import Free, Tied
from inerter.optimisation.budget import Budget, budget
from inerter.optimisation.threads import one_blas_thread

_ANSWERS = (StatusKind.OK.value, StatusKind.UNBOUNDED.value)
_DOWN, _UP = 1e3, 1e2  # a stiffness, damping or inertance is tried so many times below and above its value


@dataclass(frozen=True)
class BudgetCase:
    """For which values of an element is a layout better than the baseline, each with its best design for the index?"""

    layout: str
    index: str
    parameter: str

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return f"budget of {self.parameter}, {self.layout} {self.index}"

    def run(self, study: Study, outcomes: Mapping[Case, Outcome], threads: int = 1) -> BudgetOutcome:
        """The budget of the design that was found. A failure is an outcome with a status and a sentence."""
        return _run(study, outcomes, self, threads)

    def lost(self, study: Study) -> BudgetOutcome:
        """What is known of a budget whose processes have ended, each time that it was tried."""
        return _outcome(study, self, None, StatusKind.FAILED.value, ENDED)


@dataclass(frozen=True)
class BudgetOutcome:
    """The end of that range, in SI units; all of it survives JSON. None where there is no such number."""

    layout: str
    index: str
    parameter: str
    unit: str
    method: str
    at_most: bool  # whether the layout is better below the value; above it otherwise
    value: float | None
    standard_error: float | None
    interval: tuple[float, float] | None  # of 95 % confidence
    crossings: list[float]  # all values at which both are equally good
    status: str
    message: str

    @property
    def case(self) -> BudgetCase:
        """The case that it answers."""
        return BudgetCase(self.layout, self.index, self.parameter)

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return self.case.name

    @property
    def ok(self) -> bool:
        """Whether there is an answer: that it is better at every value is one too."""
        return self.status in _ANSWERS

    @property
    def doubt(self) -> str:
        """Why the answer is not certain; empty if it is."""
        return "" if self.ok else f"{self.status}: {self.message}"

    def to_json(self) -> dict[str, Any]:
        """A plain dictionary; `BudgetOutcome(**...)` undoes it."""
        return asdict(self)


def budget_cases(study: Study) -> list[BudgetCase]:
    """All cases in the order of the results: elements, indices, layouts."""
    used = elements_used(study)
    return [
        BudgetCase(layout, index, name)
        for name in study.budgets
        for index in study.indices
        for layout in study.layouts
        if layout != study.baseline and layout in used.get(name, ())
    ]


def _run(study: Study, outcomes: Mapping[Case, Outcome], case: BudgetCase, threads: int) -> BudgetOutcome:
    element, method = study.elements[case.parameter], budget_method(study)
    at_most = element.may_vanish
    try:
        with one_blas_thread(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            design, baseline = (
                study.design(layout).with_values(outcomes[Case(layout, case.index)].parameters)
                for layout in (case.layout, str(study.baseline))
            )
            index, how = study.over_conditions(case.index), study.method(method, threads)
            present = design_value(study, outcomes[Case(case.layout, case.index)], case.parameter)
            bounds = None if at_most else (present / _DOWN, present * _UP)
            found = budget(design, baseline, index, parameter=case.parameter, method=how, bounds=bounds)
    except FAILURES as error:
        return _outcome(study, case, None, StatusKind.FAILED.value, str(error))
    said = found.status.message
    doubt = "" if found.status.kind in _ANSWERS else deciding(budget_method(study), said)
    return _outcome(study, case, found, found.status.kind.value, said + doubt)


def _outcome(study: Study, case: BudgetCase, found: Budget | None, status: str, message: str) -> BudgetOutcome:
    element, known = study.elements[case.parameter], found is not None and bool(np.isfinite(found.value))
    return BudgetOutcome(
        *(case.layout, case.index, case.parameter, element.unit, budget_method(study), element.may_vanish),
        value=found.value if found and known else None,
        standard_error=found.standard_error if found and np.isfinite(found.standard_error) else None,
        interval=found.interval if found and np.isfinite(found.interval).all() else None,
        crossings=[crossing.value for crossing in found.crossings] if found else [],
        status=status,
        message=message,
    )


def design_value(study: Study, outcome: Outcome, element: str) -> float:
    """The value of an element in the design that was found."""
    value = study.elements[element].value
    assert not isinstance(value, Tied)
    return outcome.parameters[element] if isinstance(value, Free) else value


def budgets_csv(outcomes: Sequence[BudgetOutcome]) -> str:
    """One row a budget."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow("parameter index layout method better value unit standard_error low high crossings status".split())
    for found in outcomes:
        numbers = [found.value, found.standard_error, *(found.interval or (None, None))]
        value, error, low, high = ("" if number is None else repr(number) for number in numbers)
        better = "" if found.value is None else "below" if found.at_most else "above"
        writer.writerow(
            [
                *(found.parameter, found.index, found.layout, found.method, better),
                *(value, found.unit, error, low, high, ";".join(map(repr, found.crossings))),
                f"{found.status}: {found.message}" if found.message else found.status,
            ]
        )
    return text.getvalue()
