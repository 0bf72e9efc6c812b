"""Conclusions of a study in sentences, printed first on a page and last on a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import xarray as xr

from inerter.figures.labels import infeasible, layouts, one_method, swept_words
from inerter.files.study.limits import SENSES, StudyLimit, each_of, is_swept, limit_text, limited_quantity_words
from inerter.files.study.method_labels import neglect_clause
from inerter.files.study.plausibility import input_warnings
from inerter.files.study.speeds import AT_SPEEDS
from inerter.files.study.static import at_static_limit
from inerter.files.study.study import Study
from inerter.files.study.tasks import Answer, TaskResults, by_task
from inerter.formatting import format_list, format_quantity
from inerter.methods.averages import NORMAL_QUANTILE
from inerter.methods.registry import brief_words_of
from inerter.optimisation.constrained_search import KEPT_COSTLY
from inerter.report.index_summary import sweep_headlines
from inerter.report.plausibility import result_warnings
from inerter.report.speeds import speed_sentences
from inerter.report.verdicts import verdict_sentences
from inerter.table import Quantity


def conclusion_sentences(
    results: xr.Dataset,
    study: Study,
    found: Sequence[Answer] = (),
) -> list[str]:
    """Warnings, the verdict with its caveats for each index, the conclusions of the tasks, and the limits."""
    static = frozenset() if study.sweeps else at_static_limit(study, results)
    at_speeds = speed_sentences(results)
    return [
        *at_speeds.doubts,
        *result_warnings(one_method(results), study),
        *input_warnings(study),
        *(() if study.line is None else study.line.warnings),
        *(sweep_headlines(results) if study.sweeps else verdict_sentences(results, study, static)),
        *at_speeds.others,
        *(
            sentence
            for task, own in by_task(found).items()
            for sentence in task.sentences(TaskResults(study, results, own))
        ),
        *_constraint_sentence(results, study),
    ]


def _constraint_sentence(results: xr.Dataset, study: Study) -> Iterator[str]:
    """Sentence on the constraints, and on layouts without a feasible design."""
    limits = [
        limit_text(study, one, "the swept value" if is_swept(study, one) else format_quantity(one.value, one.unit))
        for one in study.limits
    ]
    missed = infeasible(results)
    if limits and bool(missed.all()):
        yield f"No feasible design with {format_list(limits)}{_closest_design_clause(results, study)}."
    elif limits:
        none = [
            f" {name} has no feasible design{at}."
            for name in layouts(results)
            if (at := _infeasible_places_clause(results, name)) is not None
        ]
        neglect = neglect_clause(study, study.optimise) if study.optimise is not None else ""
        nominal = " with nominal values" if study.tolerance and study.limit_quantile is None else ""
        elsewhere = [
            *(["at the other speeds"] if _has_limits_at_speeds(results, study) else []),
            *(["at the break-even values"] if study.budgets else []),
        ]
        computed = f", computed {neglect}" if neglect else ""
        yield f"All designs found satisfy {format_list(limits)}{nominal}{computed}.{''.join(none)}"
        if elsewhere:
            yield f"Not checked are the limits {format_list(elsewhere)}: designs may break them there."
        yield from _limits_by_other_methods(results, study)


def _has_limits_at_speeds(results: xr.Dataset, study: Study) -> bool:
    """Whether the results have values at other speeds, and a limited quantity depends on the road."""
    on_road = any(not limit.is_static and study.needs_road(limit.of) for limit in study.limits)
    return on_road and f"{AT_SPEEDS}value" in results and bool(np.isfinite(results[f"{AT_SPEEDS}value"]).any())


def _limits_by_other_methods(results: xr.Dataset, study: Study) -> Iterator[str]:
    """Sentences on limits that designs break by other methods than that of the search, by more than their errors.

    Known without a sweep, conditions, a quantile or a sum of parts, of limits of an index of the study itself.
    """
    if study.sweeps or study.conditions or study.limit_quantile is not None or "method" not in results.dims:
        return
    others = [method for method in results["method"].values.tolist() if method != study.optimise]
    limits = [limit for limit in study.limits if limit.of in study.indices and not each_of(study, limit)]
    designs = list(product(layouts(results), study.indices))
    for method, limit in product(others, limits):
        given = results.sel({"method": method, "other": limit.of})
        broken = [
            f"{layout} (best for {index}) has {quantity}"
            for layout, index in designs
            if (quantity := _beyond_limit(given.sel(layout=layout, index=index), limit)) is not None
        ]
        if broken:
            text = limit_text(study, limit)
            yield f"By {brief_words_of(method)} the limit {text} is broken: {format_list(broken)}."


def _beyond_limit(design: xr.Dataset, limit: StudyLimit) -> Quantity | None:
    """The limited index of a design, where it breaks the limit by more than its errors."""
    value, error, bound = (float(design[name]) for name in ("other_value", "other.standard_error", "other_error_bound"))
    if not (np.isfinite(value) and value > 0.0):
        return None
    errors = np.nan_to_num(bound) + NORMAL_QUANTILE * np.nan_to_num(error) / value
    excess = float(SENSES[limit.sense].excess(np.log(value / limit.value)))
    return Quantity(value, limit.unit, error, bound) if excess > max(errors, KEPT_COSTLY) else None


def _infeasible_places_clause(results: xr.Dataset, layout: str) -> str | None:
    """Clause on the swept values at which a layout has no feasible design; empty if at all, None if at none."""
    missed = infeasible(results).sel(layout=layout).all("index").values
    if not missed.any():
        return None
    words = " and ".join(swept_words(results))
    return "" if missed.all() else f" at {int(missed.sum())} of {missed.size} values of {words}"


def _closest_design_clause(results: xr.Dataset, study: Study) -> str:
    """Clause on the design closest to feasibility and its values; empty over a sweep."""
    if study.sweeps:
        return ""
    values = results["limit_value"].stack(design=("layout", "index")).transpose("design", "limit")
    with np.errstate(divide="ignore"):
        beyond = np.log(values.values / [limit.value for limit in study.limits])
    each = [SENSES[limit.sense].excess(off) for limit, off in zip(study.limits, beyond.T, strict=True)]
    missed = np.max(each, axis=0)
    if np.isnan(missed).all():
        return ""
    best = int(np.nanargmin(missed))
    of = str(values["design"].values[best][0])
    parts = results["limit.part"].stack(design=("layout", "index")).transpose("design", "limit").values[best].tolist()
    told = [
        f"{limited_quantity_words(study, limit.of, part)} {format_quantity(float(value), limit.unit)}"
        for limit, value, part in zip(study.limits, values.values[best], parts, strict=True)
    ]
    return f"; closest: {of} with {format_list(told)}"
