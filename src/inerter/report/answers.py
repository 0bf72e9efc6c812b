"""What a study answers, in sentences for who decides: the first of a page, the last on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import nan

import numpy as np
import xarray as xr

from inerter.figures.labels import capital, index_title, infeasible, layouts, listed, one_method, swept_words, with_unit
from inerter.files.study.budgets import BudgetOutcome
from inerter.files.study.plausibility import input_warnings
from inerter.files.study.static import at_static_limit
from inerter.files.study.study import Study
from inerter.files.study.tolerances import ToleranceOutcome
from inerter.report.budgets import end_of_range
from inerter.report.findings import Wording, Writer, best_layouts, headlines
from inerter.report.fronts import front_sentences
from inerter.report.plausibility import result_warnings
from inerter.report.question import limit_words, of_each
from inerter.report.speeds import speed_sentences
from inerter.report.tolerances import tolerance_sentences

_SIDES = {"at_most": 1.0, "at_least": -1.0, "equal": 0.0}  # of a limit, on which a value misses it


def answers(
    results: xr.Dataset,
    study: Study,
    budgets: Sequence[BudgetOutcome] = (),
    write: Writer = with_unit,
    tolerances: Sequence[ToleranceOutcome] = (),
) -> list[str]:
    """Warnings, a sentence for each index, with and without scatter, and for each budget of a layout that is best."""
    static = frozenset() if study.sweeps else at_static_limit(study, results)
    at_speeds = speed_sentences(results, write)
    return [
        *at_speeds.doubts,
        *result_warnings(one_method(results), study),
        *input_warnings(study),
        *(() if study.line is None else study.line.warnings),
        *headlines(results, Wording(write, static)),
        *at_speeds.others,
        *tolerance_sentences(results, tolerances, write),
        *front_sentences(results, write),
        *_of_budgets(results, study, budgets, write),
        *_of_limits(results, study, write),
    ]


def _of_limits(results: xr.Dataset, study: Study, write: Writer) -> Iterator[str]:
    """What the limits are, and which layouts have no design that keeps them."""
    swept = {sweep.words for sweep in study.sweeps}
    limits = [
        f"{limit_words(study, one)} {'what is swept' if one.words in swept else _number(one.value, one.unit, write)}"
        for one in study.limits
    ]
    missed = infeasible(results)
    if limits and bool(missed.all()):
        yield f"No design has {listed(limits)}{_nearest(results, study, write)}."
    elif limits:
        none = [
            f" Of {name} there is none{at}."
            for name in layouts(results)
            if (at := _missed_at(results, name)) is not None
        ]
        yield f"These are the best of all designs with {listed(limits)}.{''.join(none)}"


def _missed_at(results: xr.Dataset, layout: str) -> str | None:
    """At how many swept values no design of the layout keeps the limits; None if there is one everywhere."""
    missed = infeasible(results).sel(layout=layout).all("index").values
    if not missed.any():
        return None
    words = " and ".join(swept_words(results))
    return "" if missed.all() else f" at {int(missed.sum())} of {missed.size} values of {words}"


def _nearest(results: xr.Dataset, study: Study, write: Writer) -> str:
    """The design that misses the limits least, and what it has instead; nothing over a sweep."""
    if study.sweeps:
        return ""
    values = results["limit_value"].stack(design=("layout", "index")).transpose("design", "limit")
    with np.errstate(divide="ignore"):
        beyond = np.log(values.values / [limit.value for limit in study.limits])
    sides = np.array([_SIDES[limit.sense] for limit in study.limits])
    missed = np.where(sides == 0.0, np.abs(beyond), sides * beyond).max(axis=1)
    if np.isnan(missed).all():
        return ""
    best = int(np.nanargmin(missed))
    of = str(values["design"].values[best][0])
    parts = results["limit.part"].stack(design=("layout", "index")).transpose("design", "limit").values[best].tolist()
    told = [
        f"{of_each(limit.of, part)} {_number(float(value), limit.unit, write)}"
        for limit, value, part in zip(study.limits, values.values[best], parts, strict=True)
    ]
    return f"; the nearest, one of {of}, has {listed(told)}"


def _number(value: float, unit: str, write: Writer) -> str:
    return write(value, unit, nan).strip()


def _of_budgets(results: xr.Dataset, study: Study, budgets: Sequence[BudgetOutcome], write: Writer) -> Iterator[str]:
    """For which values of an element each of the best layouts is better; what is not certain says so first."""
    best = {name for index in study.indices for name in best_layouts(results, index)} if budgets else set()
    for element, layout in dict.fromkeys((found.parameter, found.layout) for found in budgets):
        own = [found for found in budgets if (found.parameter, found.layout) == (element, layout)]
        if layout in best:
            what = capital(f"{study.elements[element].key} {element}")
            sound = [found for found in own if not found.doubt]
            ends = [f"{end} in {index_title(results, o.index)}" for o in sound if (end := end_of_range(o, write))]
            told = [f"{what}: {layout} is better than {study.baseline} {listed(ends)}."] if ends else []
            others = [found for found in sound if not end_of_range(found, write)]
            for message, of in _alike(results, others, lambda found: found.message):
                told.append(f"{what}, {layout}, {of}: {message}.")
            for message, of in _alike(results, own, lambda found: found.doubt):
                told.append(f"Not certain for {what[0].lower()}{what[1:]}, {layout}, {of}: {message}.")
            yield " ".join(told)


def _alike(
    results: xr.Dataset, found: Sequence[BudgetOutcome], said: Callable[[BudgetOutcome], str]
) -> Iterator[tuple[str, str]]:
    """Each sentence once, with the indices of which it is said."""
    for message in dict.fromkeys(said(one).rstrip(".") for one in found):
        if message:
            yield message, listed([index_title(results, o.index) for o in found if said(o).rstrip(".") == message])
