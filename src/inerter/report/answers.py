"""What a study answers, in sentences for who decides: the first of a page, the last on a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import nan

import xarray as xr

from inerter.figures.labels import capital, index_title, with_unit
from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.static import at_static_limit
from inerter.files.study.study import Study
from inerter.report.budgets import end_of_range
from inerter.report.findings import Telling, Writer, best_layouts, headlines, listed
from inerter.report.fronts import front_sentences
from inerter.report.question import spoken


def answers(
    results: xr.Dataset, study: Study, budgets: Sequence[BudgetOutcome] = (), write: Writer = with_unit
) -> list[str]:
    """A sentence for each index, and one for each budget of a layout that is the best for some index."""
    static = frozenset() if study.sweeps else at_static_limit(study, results)
    return [
        *(() if study.line is None else study.line.warnings),
        *headlines(results, Telling(write, static)),
        *front_sentences(results, write),
        *_of_budgets(results, study, budgets, write),
        *_of_limits(study, write),
    ]


def _of_limits(study: Study, write: Writer) -> Iterator[str]:
    told = [f"{spoken(one.words)} {write(one.value, one.unit, nan).strip()}" for one in study.limits]
    if told:
        yield f"These are the best of all designs with {listed(told)}."


def _of_budgets(results: xr.Dataset, study: Study, budgets: Sequence[BudgetOutcome], write: Writer) -> Iterator[str]:
    """How much of an element each of the best layouts bears."""
    best = {name for index in study.indices for name in best_layouts(results, index)} if budgets else set()
    for element, layout in dict.fromkeys((found.parameter, found.layout) for found in budgets):
        own = [found for found in budgets if (found.parameter, found.layout) == (element, layout)]
        if layout in best:
            what = capital(f"{study.elements[element].key} {element}")
            ends = [f"{end} in {index_title(results, o.index)}" for o in own if (end := end_of_range(o, write))]
            told = [f"{what}: {layout} is better than {study.baseline} {listed(ends)}."] if ends else []
            others = [found for found in own if not end_of_range(found, write)]
            told += [f"{what}, {layout}, {index_title(results, o.index)}: {o.message}." for o in others]
            yield " ".join(told)
