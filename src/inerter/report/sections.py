"""Sections of results: tables with what introduces and what concludes them, for pages and terminals alike."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from inerter.figures.labels import methods, swept_places
from inerter.files.study.tasks import Answer, TaskResults, by_task
from inerter.report.conditions import (
    OTHERS_AT,
    brief_condition_tables,
    condition_names,
    condition_tables,
    swept_condition_sentences,
)
from inerter.report.index_summary import over_the_sweep
from inerter.report.limits import limit_tables
from inerter.report.method_comparison import method_tables
from inerter.report.tables import extreme_tables, is_searched, is_short, tables_of, trade_off_tables, where_all_are
from inerter.table import Table

if TYPE_CHECKING:
    import xarray as xr

    from inerter.files.study.study import Study


@dataclass(frozen=True)
class Section:
    """Section of results: its tables, a paragraph before and sentences after them.

    A terminal shows the tables `brief` in their place, if there are any. `columns`: tables side by side on a page.
    """

    title: str
    tables: Sequence[Table]
    introduction: str = ""
    remarks: Sequence[str] = ()
    brief: Sequence[Table] | None = None
    columns: bool = False


def design_sections(results: xr.Dataset) -> Iterator[Section]:
    """Sections on the designs of a study: values, methods side by side, and constraints."""
    swept = bool(swept_places(results))
    yield Section(
        "Best designs" if is_searched(results) else "Results",
        tables_of(results),
        remarks=_sweep_remarks(results) if swept else (),
        brief=extreme_tables(results) if swept and not is_short(results) else None,
    )
    if len(methods(results)) > 1:
        yield Section("The methods side by side", method_tables(results), columns=True)
    if condition_names(results) and not swept:
        brief = brief_condition_tables(results)
        yield Section("Operating conditions", condition_tables(results), brief=brief, remarks=[OTHERS_AT] * bool(brief))
    if "limit" in results.dims:
        yield Section("Constraints", limit_tables(results), _ABOUT_SWEPT_LIMITS if swept else _ABOUT_LIMITS)


def task_sections(study: Study, results: xr.Dataset, answers: Iterable[Answer]) -> Iterator[Section]:
    """Section on each task that has answers."""
    for task, own in by_task(answers).items():
        yield Section(task.title, [task.table(TaskResults(study, results, own))], task.introduction())


def trade_off_section(results: xr.Dataset) -> Iterator[Section]:
    """Section on all indices of each optimal design; none over a sweep, for one index or given designs."""
    tables = trade_off_tables(results) if is_searched(results) and not swept_places(results) else []
    if tables:
        yield Section("All indices of each optimal design", tables, columns=True)


def _sweep_remarks(results: xr.Dataset) -> list[str]:
    """Sentences on where layouts outperform the baseline, and on designs that the tables omit."""
    told = over_the_sweep(results) if results.attrs["baseline"] else []
    return [
        *(f"{index}: {sentence}." for index, sentence in told),
        *swept_condition_sentences(results),
        *where_all_are(results),
        *([OTHERS_AT] if condition_names(results) else []),
    ]


_ABOUT_LIMITS = (
    "Constrained quantity of each design closest to its limit, and sensitivity to the limit where the constraint is "
    "active."
)
_ABOUT_SWEPT_LIMITS = (
    "Values at which each constraint is active, and values without a feasible design. summary.csv has the constrained "
    "quantities of each design."
)
