"""Break-even values of elements: the range in which each best design outperforms the baseline."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import starmap
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

from inerter.decision.of_study import decisive_method
from inerter.errors import Status, StatusKind
from inerter.figures.labels import index_title
from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.study.conditions import MOST_LISTED
from inerter.files.study.method_problems import unseen_problem
from inerter.files.study.study import Study, elements_used
from inerter.files.study.tasks import Answer, Designs, Task, TaskPart, TaskResults, best_design
from inerter.formatting import capital, format_list, format_quantity, merge_alike
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import Method
from inerter.methods.registry import brief_words_of, decisive_method_clause, with_decisive_method
from inerter.networks.elements import Tied
from inerter.optimisation.budget import BreakEven, break_even
from inerter.statements import Severity
from inerter.table import MISSING, Column, Row, Table, cells
from inerter.units import quote_value
from inerter.validation import number_or_none
from inerter.vehicle.replace_values import elements_by_label
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    import xarray as xr

_KEYS = (
    *("index", "layout", "condition", "method", "better"),
    *("value", "unit", "standard_error", "low", "high", "error_bound", "crossings", "status"),
)
_DOWN, _UP = 1e3, 1e2  # a stiffness, damping or inertance is tried so many times below and above its value


@dataclass(frozen=True)
class BudgetPart(TaskPart["BudgetAnswer"]):
    """Task part: break-even value of one element for the best design of a layout and index, against the baseline.

    Over all conditions, or in that of the label `condition` alone.
    """

    layout: str
    index: str
    parameter: str
    condition: str = ""

    @property
    def name(self) -> str:
        """Name of the task part in messages."""
        return f"break-even value of {self.parameter}, {self.layout} {self.index}{_in_condition(self.condition)}"

    def compute(self, study: Study, designs: Designs, threads: int) -> BudgetAnswer:
        """Break-even value of the element in the best design found."""
        design, baseline = (
            best_design(study, designs, layout, self.index) for layout in (self.layout, str(study.baseline))
        )
        method, index = decisive_method(study.evaluate), study.over_conditions(self.index)
        if self.condition:
            index = study.in_each(study.index(self.index))[study.condition_labels.index(self.condition)]
        found = element_break_even(design, baseline, index, self.parameter, study.method(method, threads))
        status = with_decisive_method(found.status, method)
        crossings = [crossing.value for crossing in found.crossings]
        return self._answer(study, status, crossings=crossings, **known_numbers(found))

    def failed_result(self, study: Study, message: str) -> BudgetAnswer:
        """Answer without numbers, with status `failed`."""
        return self._answer(study, Status(StatusKind.FAILED, message))

    def _answer(self, study: Study, status: Status, **numbers: Any) -> BudgetAnswer:
        element = study.elements[self.parameter]
        return BudgetAnswer(
            **vars(self),
            unit=element.unit,
            method=decisive_method(study.evaluate),
            at_most=element.may_vanish,
            status=status.kind.value,
            message=status.message,
            **numbers,
        )


@dataclass(frozen=True, kw_only=True)
class BudgetAnswer(Answer):
    """Break-even value of an element [SI], with its uncertainty and all crossings; None for values not found."""

    of = BudgetPart
    sure = tuple(kind.value for kind in StatusKind if kind.severity is Severity.INFO)
    index: str
    parameter: str
    condition: str = ""  # label of the one condition of the index; empty for all of them
    unit: str
    method: str
    at_most: bool  # whether the layout is better below the value; above it otherwise
    value: float | None = None
    standard_error: float | None = None
    interval: tuple[float, float] | None = None  # 95 % confidence interval
    error_bound: float | None = None  # largest relative error, sampling apart
    crossings: list[float] = field(default_factory=list)  # all values at which both are equally good


class Budgets(Task[BudgetAnswer]):
    """Task: break-even values of elements, for each layout but the baseline."""

    key = "budgets"
    title = "Break-even values"
    items = "break-even values"
    answer = BudgetAnswer

    def parts(self, study: Study) -> list[BudgetPart]:
        """Task parts in the order of elements, indices, layouts, all conditions and each; the baseline is left out."""
        used = elements_used(study)
        each = study.condition_labels if len(study.conditions) > 1 else []
        return [
            BudgetPart(layout, index, name, condition)
            for name in study.budgets
            for index in study.indices
            for layout in study.layouts
            if layout != study.baseline and layout in used.get(name, ())
            for condition in ("", *each)
        ]

    def problems(self, study: Study, given: Collection[str]) -> Iterator[Problem]:
        """Problems of `break_even`: given together with a sweep, no baseline, elements without a break-even value."""
        place = ("study", "budgets" if "budgets" in given else "break_even")
        if study.budgets and study.sweeps:
            yield at(place, fault="given together with a sweep", expected="one of the two")
        if study.budgets and study.baseline is None:
            yield at(
                place, fault="only one layout is given", expected="another to compare it with, or no break-even values"
            )
            return
        used = elements_used(study)
        for name in study.budgets:
            if name not in study.elements:
                missing = f"{quote_value(name)} is not in [elements]; available: {some(study.elements)}"
                yield at(place, fault=missing, hint=nearest(name, study.elements))
            elif isinstance(study.elements[name].value, Tied):
                yield at(place, fault=f"{name} is tied to others", expected="an element that is not tied")
            elif any(name in condition.numbers for condition in study.conditions):
                yield at(place, fault=f"a condition changes {name}", expected="an element that no condition changes")
            elif not set(used.get(name, ())) - {study.baseline}:
                only = f"no layout but the baseline has {name}"
                yield at(place, fault=only, expected="an element of a layout that is compared")
            else:
                yield from unseen_problem(study, place, name)

    def description(self, study: Study) -> Mapping[str, list[str]]:
        """Names of the elements, by the heading of the report."""
        return {"Break-even values of": list(study.budgets)}

    def table(self, results: TaskResults[BudgetAnswer]) -> Table:
        """One row per break-even value."""
        heads = [
            *(Column("Design"), Column("Element", "parameter", words=True), Column("Better", prose=True)),
            *(Column(key=key) for key in _KEYS),
        ]
        rows = []
        for one in results.answers:
            low, high = one.interval or (None, None)
            better = "" if one.value is None else "below" if one.at_most else "above"
            contents = [
                *(f"{one.layout}, {one.index}{_in_condition(one.condition)}", one.parameter, _verdict(one)),
                *(one.index, one.layout, one.condition, one.method, better),
                *(one.value, one.unit, one.standard_error, low, high, one.error_bound),
                *(";".join(map(repr, one.crossings)), one.status_text),
            ]
            is_shown = not one.condition or len(results.study.conditions) <= MOST_LISTED
            rows.append(Row(cells(*contents), status=one.doubt, remark=_remark(one), shown=is_shown))
        by = brief_words_of(results.answers[0].method)
        return Table(
            f"Break-even values: where each layout is better than {results.study.baseline}, by {by}", heads, rows
        )

    def sentences(self, results: TaskResults[BudgetAnswer]) -> Iterator[str]:
        """Ranges of each element in which the best layouts outperform the baseline, as sentences."""
        from inerter.report.verdicts import best_layouts  # noqa: PLC0415 - heavy

        study, data = results.study, results.data
        budgets = [found for found in results.answers if not found.condition]
        best = {name for index in study.indices for name in best_layouts(data, index)} if budgets else set()
        by_element: dict[str, dict[str, list[BudgetAnswer]]] = {}  # those of the best layouts
        for found in budgets:
            if found.layout in best:
                by_element.setdefault(found.parameter, {}).setdefault(found.layout, []).append(found)
        for element, by_layout in by_element.items():
            what = f"{study.elements[element].key} {element}"
            for layout, own in by_layout.items():
                sound = [found for found in own if not found.doubt]
                ends = _ends_of_ranges(data, sound)
                told = (
                    [f"{capital(what)}: {layout} is better than {study.baseline} {format_list(ends)}."] if ends else []
                )
                others = [found for found in sound if not _end_of_range(found)]
                for message, of in _alike(data, others):
                    told.append(f"{capital(what)}, {layout}, {of}: {message}.")
                if told:
                    yield " ".join(told)
            uncertain = {layout: [found for found in own if found.doubt] for layout, own in by_layout.items()}
            doubts = [f"for {layout}, {_uncertain_clause(data, own)}" for layout, own in uncertain.items() if own]
            if doubts:
                values = f"the break-even values of {what} {'; '.join(doubts)}"
                kinds = [(one.method, Status(StatusKind(one.status))) for own in uncertain.values() for one in own]
                decides = next(filter(None, starmap(decisive_method_clause, kinds)), "")
                yield f"Not certain (their table says why): {values}{decides}."


def element_break_even(design: Vehicle, baseline: Vehicle, index: IndexLike, element: str, method: Method) -> BreakEven:
    """Break-even value of an element in a design with numbers only.

    Raises what `break_even` raises.
    """
    bounds = None
    for present in elements_by_label(design, element):  # else it is none of the design, which `break_even` tells
        if not present.may_vanish and isinstance(present.value, float):
            bounds = present.value / _DOWN, present.value * _UP
    return break_even(design, baseline, index, parameter=element, method=method, bounds=bounds)


def known_numbers(found: BreakEven) -> dict[str, Any]:
    """Break-even value with its errors for JSON; None for each that is not known."""
    return {
        **{name: number_or_none(getattr(found, name)) for name in ("value", "standard_error", "error_bound")},
        "interval": found.interval if all(map(isfinite, found.interval)) else None,
    }


def _in_condition(label: str) -> str:
    return f" in condition {label}" if label else ""


def _verdict(found: BudgetAnswer) -> str:
    end = _end_of_range(found) or MISSING
    return f"not certain: {end}" if found.doubt and end != MISSING else end


def _end_of_range(found: BudgetAnswer) -> str:
    """Break-even value as text, or the range if the design is worse again beyond another crossing; empty if none."""
    if found.value is None:
        return ""
    error, bound = (nan if known is None else known for known in (found.standard_error, found.error_bound))
    return range_text(found.value, found.unit, error, bound, found.crossings, at_most=found.at_most)


def range_text(
    value: float, unit: str, error: float, bound: float, crossings: Sequence[float], *, at_most: bool
) -> str:
    """Range of values on the better side of a break-even value (below it if `at_most`), up to the next crossing.

    The value has the digits that its standard error and its relative error bound allow.
    """
    end = format_quantity(value, unit, error=error, bound=bound)
    beyond = [c for c in crossings if (c < value if at_most else c > value)]
    if beyond:
        other = format_quantity(max(beyond) if at_most else min(beyond), unit)
        return f"from {other} to {end}" if at_most else f"from {end} to {other}"
    return f"up to {end}" if at_most else f"above {end}"


def _ends_of_ranges(data: xr.Dataset, found: Sequence[BudgetAnswer]) -> list[str]:
    """Ranges of those that have one, each with the title of its index."""
    return [f"{end} in {index_title(data, one.index)}" for one in found if (end := _end_of_range(one))]


def _uncertain_clause(data: xr.Dataset, found: Sequence[BudgetAnswer]) -> str:
    """Clause on uncertain break-even values of one layout: the ranges, and the indices for which there is none."""
    without = [index_title(data, one.index) for one in found if not _end_of_range(one)]
    none = [f"none in {format_list(without)}"] if without else []
    return format_list([*_ends_of_ranges(data, found), *none])


def _remark(found: BudgetAnswer) -> str:
    """Remark on a break-even value: further crossings, or why there is none."""
    if len(found.crossings) > 1:
        return f"equally good at {format_list([format_quantity(value, found.unit) for value in found.crossings])}"
    return found.message if found.status == StatusKind.UNBOUNDED else ""


def _alike(data: xr.Dataset, found: Sequence[BudgetAnswer]) -> Iterator[tuple[str, str]]:
    """Messages that differ in more than their numbers, each with the titles of the indices to which it applies."""
    told = [one for one in found if one.message]
    for message, places in merge_alike([one.message.rstrip(".") for one in told]):
        yield message, format_list([index_title(data, told[place].index) for place in places])
