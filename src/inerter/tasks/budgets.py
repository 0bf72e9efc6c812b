"""Break-even values of elements: the range in which each best design outperforms the baseline."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from inerter.errors import StatusKind
from inerter.figures.labels import capital, format_list, index_title, typeset_quantity, with_unit
from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.study.cases import Case, Outcome
from inerter.files.study.method_problems import unseen_problem
from inerter.files.study.study import Study, elements_used
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults
from inerter.methods.registry import brief_words_of, decisive_method_clause, is_blind
from inerter.networks.elements import Free, Tied
from inerter.optimisation.budget import BreakEven, break_even
from inerter.report.index_summary import best_layouts
from inerter.table import Cell, Row, Table, Writer
from inerter.units import quote_value

if TYPE_CHECKING:
    import xarray as xr

_DOWN, _UP = 1e3, 1e2  # a stiffness, damping or inertance is tried so many times below and above its value


@dataclass(frozen=True)
class BudgetPart(TaskPart["BudgetAnswer"]):
    """Task part: break-even value of one element for the best design of a layout and index, against the baseline."""

    layout: str
    index: str
    parameter: str

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return f"budget of {self.parameter}, {self.layout} {self.index}"

    def answer(self, study: Study, designs: Designs, threads: int) -> BudgetAnswer:
        """Break-even value of the element in the best design found."""
        present = design_value(study, designs[Case(self.layout, self.index)], self.parameter)
        may_vanish = study.elements[self.parameter].may_vanish
        design, baseline = (
            study.design(layout).with_values(designs[Case(layout, self.index)].parameters)
            for layout in (self.layout, str(study.baseline))
        )
        found = break_even(
            design,
            baseline,
            study.over_conditions(self.index),
            parameter=self.parameter,
            method=study.method(budget_method(study), threads),
            bounds=None if may_vanish else (present / _DOWN, present * _UP),
        )
        message = found.status.message + decisive_method_clause(budget_method(study), found.status)
        return self._answer(study, found, found.status.kind.value, message)

    def failure_answer(self, study: Study, message: str) -> BudgetAnswer:
        """Answer without numbers, with status `failed`."""
        return self._answer(study, None, StatusKind.FAILED.value, message)

    def _answer(self, study: Study, found: BreakEven | None, status: str, message: str) -> BudgetAnswer:
        element, known = study.elements[self.parameter], found is not None and bool(np.isfinite(found.value))
        return BudgetAnswer(
            layout=self.layout,
            index=self.index,
            parameter=self.parameter,
            unit=element.unit,
            method=budget_method(study),
            at_most=element.may_vanish,
            value=found.value if found and known else None,
            standard_error=found.standard_error if found and np.isfinite(found.standard_error) else None,
            interval=found.interval if found and np.isfinite(found.interval).all() else None,
            crossings=[crossing.value for crossing in found.crossings] if found else [],
            status=status,
            message=message,
        )


@dataclass(frozen=True, kw_only=True)
class BudgetAnswer(Answer):
    """Break-even value of an element [SI], with its uncertainty and all crossings; None for values not found."""

    sure = (StatusKind.OK.value, StatusKind.UNBOUNDED.value)  # that a layout is better at every value is an answer
    index: str
    parameter: str
    unit: str
    method: str
    at_most: bool  # whether the layout is better below the value; above it otherwise
    value: float | None
    standard_error: float | None
    interval: tuple[float, float] | None  # 95 % confidence interval
    crossings: list[float]  # all values at which both are equally good

    @property
    def part(self) -> BudgetPart:
        """Task part to which the answer belongs."""
        return BudgetPart(self.layout, self.index, self.parameter)


class Budgets(Task[BudgetAnswer]):
    """Task: break-even values of elements, for each layout but the baseline."""

    key = "budgets"
    title = "Budgets"
    answer = BudgetAnswer

    def parts(self, study: Study) -> list[BudgetPart]:
        """Task parts in the order of elements, indices, layouts; the baseline is left out."""
        used = elements_used(study)
        return [
            BudgetPart(layout, index, name)
            for name in study.budgets
            for index in study.indices
            for layout in study.layouts
            if layout != study.baseline and layout in used.get(name, ())
        ]

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of `budgets`: given together with a sweep, no baseline, elements without a break-even value."""
        place = ("study", "budgets")
        if study.budgets and study.sweeps:
            yield at(place, fault="given together with a sweep", expected="one of the two")
        if study.budgets and study.baseline is None:
            yield at(place, fault="only one layout is given", expected="another to compare it with, or no budgets")
            return
        used = elements_used(study)
        for name in study.budgets:
            if name not in study.elements:
                missing = f"{quote_value(name)} is not in [elements], where there are {some(study.elements)}"
                yield at(place, fault=missing, hint=nearest(name, study.elements))
            elif isinstance(study.elements[name].value, Tied):
                yield at(place, fault=f"{name} is tied to others", expected="an element that is not tied")
            elif not set(used.get(name, ())) - {study.baseline}:
                only = f"no layout but the baseline has {name}"
                yield at(place, fault=only, expected="an element of a layout that is compared")
            else:
                yield from unseen_problem(study, place, name)

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Names of the elements, by the heading of the report."""
        return {"Budgets of": list(study.budgets)}

    def csv(self, study: Study, answers: Sequence[BudgetAnswer]) -> Iterator[Sequence[object]]:
        """Header and one row per break-even value."""
        yield "parameter index layout method better value unit standard_error low high crossings status".split()
        for found in answers:
            low, high = found.interval or (None, None)
            better = "" if found.value is None else "below" if found.at_most else "above"
            yield [
                *(found.parameter, found.index, found.layout, found.method, better),
                *(found.value, found.unit, found.standard_error, low, high),
                *(";".join(map(repr, found.crossings)), found.status_text),
            ]

    def lines(self, results: TaskResults[BudgetAnswer], width: int) -> Iterator[str]:
        """A block for each element."""
        for name, found in _by_element(results.answers).items():
            yield from ("", *wrap(_caption(name, found[0], results.study), width, subsequent_indent="  "))
            longest = max(len(one.layout) for one in found)
            for one in found:
                begin = f"  {one.index}  {one.layout:<{longest}}  "
                yield from wrap(begin + _sentence(one, with_unit), width, subsequent_indent=" " * min(len(begin), 20))

    def tables(self, results: TaskResults[BudgetAnswer]) -> list[Table]:
        """A table for each element, layouts in rows and indices in columns."""
        tables = []
        for name, found in _by_element(results.answers).items():
            rows = []
            for layout in dict.fromkeys(one.layout for one in found):
                own = [one for one in found if one.layout == layout]
                remarks = [f"{one.index}: {text}" for one in own if (text := _remark(one, typeset_quantity))]
                rows.append(Row(layout, [Cell(_cell(one)) for one in own], status="; ".join(remarks)))
            header = ["Layout", *results.study.indices]
            tables.append(Table(_caption(name, found[0], results.study), header, rows))
        return tables

    def sentences(self, results: TaskResults[BudgetAnswer], write: Writer) -> Iterator[str]:
        """Ranges of each element in which the best layouts outperform the baseline, as sentences."""
        study, data, budgets = results.study, results.data, results.answers
        best = {name for index in study.indices for name in best_layouts(data, index)} if budgets else set()
        for element, layout in dict.fromkeys((found.parameter, found.layout) for found in budgets):
            own = [found for found in budgets if (found.parameter, found.layout) == (element, layout)]
            if layout in best:
                what = capital(f"{study.elements[element].key} {element}")
                sound = [found for found in own if not found.doubt]
                ends = [f"{end} in {index_title(data, o.index)}" for o in sound if (end := _end_of_range(o, write))]
                told = [f"{what}: {layout} is better than {study.baseline} {format_list(ends)}."] if ends else []
                others = [found for found in sound if not _end_of_range(found, write)]
                for message, of in _alike(data, others, lambda found: found.message):
                    told.append(f"{what}, {layout}, {of}: {message}.")
                for message, of in _alike(data, own, lambda found: found.doubt):
                    told.append(f"Not certain for {what[0].lower()}{what[1:]}, {layout}, {of}: {message}.")
                yield " ".join(told)


def budget_method(study: Study) -> str:
    """First method of `evaluate` that models friction, else the first method."""
    return next((method for method in study.evaluate if not is_blind(method)), study.evaluate[0])


def design_value(study: Study, outcome: Outcome, element: str) -> float:
    """Value of an element in the design found [SI]."""
    value = study.elements[element].value
    assert not isinstance(value, Tied)
    return outcome.parameters[element] if isinstance(value, Free) else value


def _cell(found: BudgetAnswer) -> str:
    end = _end_of_range(found, typeset_quantity) or "–"
    return f"not certain: {end}" if found.doubt else end


def _by_element(budgets: Sequence[BudgetAnswer]) -> dict[str, list[BudgetAnswer]]:
    names = dict.fromkeys(one.parameter for one in budgets)
    return {name: [one for one in budgets if one.parameter == name] for name in names}


def _caption(name: str, found: BudgetAnswer, study: Study) -> str:
    by = f"by {brief_words_of(found.method)}"
    return f"Break-even value of {name}: for which {name} each layout is better than {study.baseline}, {by}"


def _sentence(found: BudgetAnswer, write: Writer) -> str:
    end, remark = _end_of_range(found, write), _remark(found, write)
    if found.doubt:
        return f"not certain ({remark})" + (f"; if accepted, {end}" if end else "")
    return f"{end} ({remark})" if end and remark else end or remark


def _end_of_range(found: BudgetAnswer, write: Writer) -> str:
    """Break-even value as text, or the range if the design is worse again beyond another crossing; empty if none."""
    if found.value is None:
        return ""
    end = write(found.value, found.unit, found.standard_error or 0.0)
    beyond = [c for c in found.crossings if (c < found.value if found.at_most else c > found.value)]
    if beyond:
        other = write(max(beyond) if found.at_most else min(beyond), found.unit, float("nan"))
        return f"from {other} to {end}" if found.at_most else f"from {end} to {other}"
    return f"up to {end}" if found.at_most else f"from {end} on"


def _remark(found: BudgetAnswer, write: Writer) -> str:
    """Remark on a break-even value: further crossings, doubt, or reason why there is none."""
    remarks = []
    if len(found.crossings) > 1:
        places = [write(value, found.unit, float("nan")) for value in found.crossings]
        remarks.append(f"equally good at {', '.join(places[:-1])} and {places[-1]}")
    if found.doubt:
        remarks.insert(0, found.doubt)
    elif found.status == StatusKind.UNBOUNDED:
        remarks.append(found.message)
    return "; ".join(remarks)


def _alike(
    data: xr.Dataset, found: Sequence[BudgetAnswer], said: Callable[[BudgetAnswer], str]
) -> Iterator[tuple[str, str]]:
    """Distinct sentences, each with the titles of the indices to which it applies."""
    for message in dict.fromkeys(said(one).rstrip(".") for one in found):
        if message:
            yield message, format_list([index_title(data, o.index) for o in found if said(o).rstrip(".") == message])
