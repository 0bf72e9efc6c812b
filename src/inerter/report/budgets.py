"""How much of an element the layouts of a study bear, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from inerter.errors import StatusKind
from inerter.figures.labels import printed, with_unit
from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.study import Study
from inerter.methods.registry import brief_words_of
from inerter.report.findings import Writer
from inerter.report.tables import Cell, Row, Table


def budget_lines(budgets: Sequence[BudgetOutcome], study: Study, width: int) -> Iterator[str]:
    """The budgets for a terminal, a block for each element; none if there are none."""
    for name, found in _by_element(budgets).items():
        yield from ("", *wrap(_caption(name, found[0], study), width, subsequent_indent="  "))
        longest = max(len(outcome.layout) for outcome in found)
        for outcome in found:
            begin = f"  {outcome.index}  {outcome.layout:<{longest}}  "
            yield from wrap(begin + _answer(outcome, with_unit), width, subsequent_indent=" " * min(len(begin), 20))


def budget_tables(budgets: Sequence[BudgetOutcome], study: Study) -> list[Table]:
    """The budgets for a page: a table for each element, layouts in rows and indices in columns."""
    tables = []
    for name, found in _by_element(budgets).items():
        rows = []
        for layout in dict.fromkeys(outcome.layout for outcome in found):
            own = [outcome for outcome in found if outcome.layout == layout]
            remarks = [f"{outcome.index}: {text}" for outcome in own if (text := _remark(outcome, printed))]
            rows.append(Row(layout, [Cell(_cell(outcome)) for outcome in own], status="; ".join(remarks)))
        tables.append(Table(_caption(name, found[0], study), ["Layout", *study.indices], rows))
    return tables


def _cell(found: BudgetOutcome) -> str:
    end = end_of_range(found, printed) or "–"
    return f"not certain: {end}" if found.doubt else end


def _by_element(budgets: Sequence[BudgetOutcome]) -> dict[str, list[BudgetOutcome]]:
    names = dict.fromkeys(outcome.parameter for outcome in budgets)
    return {name: [outcome for outcome in budgets if outcome.parameter == name] for name in names}


def _caption(name: str, found: BudgetOutcome, study: Study) -> str:
    by = f"by {brief_words_of(found.method)}"
    return f"Budget of {name}: for which {name} each layout is better than {study.baseline}, {by}"


def _answer(found: BudgetOutcome, write: Writer) -> str:
    end, remark = end_of_range(found, write), _remark(found, write)
    if found.doubt:
        return f"not certain ({remark})" + (f"; taken as it is, {end}" if end else "")
    return f"{end} ({remark})" if end and remark else end or remark


def end_of_range(found: BudgetOutcome, write: Writer) -> str:
    """The end of the range, and its other end where the design is not better all the way; empty if there is none."""
    if found.value is None:
        return ""
    end = write(found.value, found.unit, found.standard_error or 0.0)
    beyond = [c for c in found.crossings if (c < found.value if found.at_most else c > found.value)]
    if beyond:
        other = write(max(beyond) if found.at_most else min(beyond), found.unit, float("nan"))
        return f"from {other} to {end}" if found.at_most else f"from {end} to {other}"
    return f"up to {end}" if found.at_most else f"from {end} on"


def _remark(found: BudgetOutcome, write: Writer) -> str:
    """Why there is no end, what is wrong with it, and whether there are further crossings."""
    remarks = []
    if len(found.crossings) > 1:
        places = [write(value, found.unit, float("nan")) for value in found.crossings]
        remarks.append(f"equally good at {', '.join(places[:-1])} and {places[-1]}")
    if found.doubt:
        remarks.insert(0, found.doubt)
    elif found.status == StatusKind.UNBOUNDED:
        remarks.append(found.message)
    return "; ".join(remarks)
