"""Verdict of a study without a sweep for each index: the decision that the workbench shows, from a table of results."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from math import hypot, isfinite, isnan, nan
from typing import TYPE_CHECKING

import numpy as np

from inerter.decision.caveats import CaveatKind
from inerter.decision.decide import Decision, decide
from inerter.decision.of_study import bound_clause, decisive_method, nonlinear_elements, remedy_of
from inerter.decision.results import DesignResult, Improvement, IndexResult, percent_below
from inerter.errors import Status, StatusKind
from inerter.figures.labels import (
    bound_of,
    by_method,
    error_of,
    index_title,
    index_unit,
    indices,
    layouts,
    method_label,
    methods,
)
from inerter.files.common.roads import OTHER_EFFECT, ROAD_ERROR
from inerter.files.study.study import Study
from inerter.formatting import format_list
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.registry import brief_words_of, with_decisive_method
from inerter.methods.ties import ACCURACY
from inerter.report.conditions import condition_names, in_condition
from inerter.report.index_summary import largest_error, margins_of, road_effects

if TYPE_CHECKING:
    import xarray as xr

_STATIC = "the static limit, which no damper or inerter lowers"
_TWO_SIDED = 2.0  # standard errors of a difference that is not significant
_DIMS = ("layout", "parameter", "other", ROAD_ERROR)  # of what a decision compares
_ELSEWHERE = (CaveatKind.LIMIT, CaveatKind.NEGLECTED)  # said once for all indices, in the sentence on limits and notes


def verdict_sentences(
    results: xr.Dataset, study: Study | None = None, static: Collection[tuple[str, str]] = ()
) -> list[str]:
    """Verdict and caveats of each index, in one paragraph.

    `static` are indices and layouts whose largest gain is that under a steady force. With the study, the friction that
    its methods model or neglect is named.
    """
    return [" ".join(_sentences(results, study, index, static)) for index in indices(results)]


def _sentences(
    results: xr.Dataset, study: Study | None, index: str, static: Collection[tuple[str, str]]
) -> Iterator[str]:
    told = study_decision(results, index, study)
    yield _with_other_methods(results, index, told)
    for caveat in told.verdict.caveats:
        if caveat.kind not in _ELSEWHERE:
            yield caveat.sentence
    held = [one for one in told.winners if (index, one.name) in static]
    if held:
        names = format_list([one.name for one in held])
        yield f"{held[0].goal.text} of {names} is {_STATIC}."


def study_decision(results: xr.Dataset, index: str, study: Study | None = None) -> Decision:
    """Decision on the best designs for an index, by the first method that models friction."""
    method = decisive_method(methods(results)) if methods(results) else ""
    one = by_method(results, method) if method else results
    row = _row(one, index)
    each = {name: _row(in_condition(one, i), index) for i, name in enumerate(condition_names(one))}
    designs = [
        replace(_design(results, row, index, name, method, study), in_conditions=tuple(_in_conditions(each, name)))
        for name in layouts(results)
    ]

    def over(first: DesignResult, second: DesignResult) -> Improvement | None:
        return _over(row, first, second)

    return decide(
        designs,
        over,
        method=brief_words_of(method) if method else "",
        remedy=remedy_of(method) if method else "",
    )


def _row(results: xr.Dataset, index: str) -> xr.Dataset:
    """Results for one index with the dimensions that a decision compares."""
    row = results.sel(index=index)
    row = row.squeeze([name for name, size in row.sizes.items() if size == 1 and name not in _DIMS])
    return row.drop_dims([name for name in row.dims if name not in _DIMS])


def _in_conditions(each: Mapping[str, xr.Dataset], layout: str) -> Iterator[tuple[str, Improvement]]:
    """Improvement over the baseline in each condition where both have a value."""
    for name, row in each.items():
        baseline = row.attrs["baseline"]
        if baseline and layout != baseline:
            by = _improvement(row, row.sel(layout=layout), row.sel(layout=baseline))
            if by is not None:
                yield name, by


def _design(
    results: xr.Dataset, row: xr.Dataset, index: str, layout: str, method: str, study: Study | None
) -> DesignResult:
    """Best design of a layout for an index, as a decision compares it."""
    design, baseline = row.sel(layout=layout), row.attrs["baseline"]
    base = row.sel(layout=baseline) if baseline else None
    modelled, neglected = (
        nonlinear_elements(study.design(layout).mechanism(), method) if study is not None and method else ((), ())
    )
    return DesignResult(
        name=layout,
        goal=IndexResult(
            index=index,
            title=index_title(results, index),
            unit=index_unit(results, index),
            value=float(design["value"]),
            status=_status(results, design, method),
            standard_error=error_of(design),
            error_bound=bound_of(design),
            improvement=None if base is None or layout == baseline else _improvement(row, design, base),
        ),
        others=() if base is None else tuple(_others(results, index, design, base)),
        at_bounds=tuple(_at_bounds(design)),
        modelled=modelled,
        neglected=neglected,
        is_baseline=layout == baseline,
        n_elements=int(design["elements"]) if "elements" in design.coords else 0,
    )


def _status(results: xr.Dataset, design: xr.Dataset, method: str) -> Status:
    """Status of a design; its message names the method that can decide, where the study has no other."""
    kind, message = Status.parts(str(design["status"].item()))
    status = Status(StatusKind(kind) if kind in list(StatusKind) else StatusKind.FAILED, message)
    return with_decisive_method(status, method) if method and len(methods(results)) == 1 else status


def _improvement(row: xr.Dataset, design: xr.Dataset, base: xr.Dataset) -> Improvement | None:
    """Improvement over the baseline; None if one of them has no finite value."""
    percent, own, reference = float(design["improvement"]), float(design["value"]), float(base["value"])
    if not isfinite(percent):
        return None
    margin = _margin(row, str(design["layout"].item()), str(base["layout"].item()))
    return Improvement(
        percent,
        error_of(design, "improvement"),
        bound_of(design, "improvement"),
        abs(percent * reference) / 100.0 <= margin + 2.0 * ACCURACY * min(abs(own), abs(reference)),
    )


def _over(row: xr.Dataset, first: DesignResult, second: DesignResult) -> Improvement | None:
    """Improvement of one design over another."""
    own, other = first.goal.value, second.goal.value
    if second.is_baseline:
        return first.goal.improvement
    percent = percent_below(own, other)
    if isnan(percent):
        return None
    errors = [_relative_error(row.sel(layout=one.name)) * one.goal.value for one in (first, second)]
    margin, names = _margin(row, first.name, second.name), np.atleast_1d(row["layout"].values).tolist()
    return Improvement(
        percent,
        100.0 * hypot(*errors) / abs(other) if all(map(isfinite, errors)) and any(errors) else nan,
        largest_error(row, names.index(first.name), names.index(second.name)),
        is_tie=abs(own - other) <= margin + 2.0 * ACCURACY * min(abs(own), abs(other)),
    )


def _margin(row: xr.Dataset, first: str, second: str) -> float:
    """Difference of two values within their 95 % confidence interval; zero without uncertainties."""
    names = np.atleast_1d(row["layout"].values).tolist()
    margins = margins_of(row, names.index(second))
    return float(margins[names.index(first)])


def _relative_error(design: xr.Dataset) -> float:
    error, value = error_of(design), float(design["value"])
    return error / abs(value) if isfinite(error) and value else 0.0


def _others(results: xr.Dataset, index: str, design: xr.Dataset, base: xr.Dataset) -> Iterator[IndexResult]:
    """Other indices of the same design, compared with those of the baseline's design.

    Their standard errors are not among the results; those of the index itself, relative to it, take their place.
    """
    if "other_value" not in design:
        return
    spread = 100.0 * hypot(_relative_error(design), _relative_error(base))
    for i, other in enumerate(results["other"].values.tolist()):
        own, reference = (float(one["other_value"].values[i]) for one in (design, base))
        by, percent = None, percent_below(own, reference)
        if design["layout"].item() != base["layout"].item() and isfinite(percent):
            pair = [one.isel(other=i) for one in (design, base)]
            widest, of_base = (float(one["other_error_bound"]) if "other_error_bound" in one else nan for one in pair)
            bound = improvement_bound(
                own, reference, widest, of_base, *(road_effects(one, OTHER_EFFECT) for one in pair)
            )
            by = Improvement(percent, bound=bound, is_tie=abs(percent) <= _TWO_SIDED * spread)
        if other != index and not (isnan(own) and isnan(reference)):
            yield IndexResult(other, index_title(results, other), index_unit(results, other), own, improvement=by)


def _at_bounds(design: xr.Dataset) -> Iterator[str]:
    if "at_bound" not in design:
        return
    for name in design["parameter"].values.tolist():
        entry = design.sel(parameter=name)
        value, bound = float(entry["parameter_value"]), str(entry["at_bound"].item())
        if bound and isfinite(value):
            yield bound_clause(name, bound, value, str(entry["parameter_unit"].item()))


def _with_other_methods(results: xr.Dataset, index: str, told: Decision) -> str:
    """Verdict, and the best layouts by the other methods of the study."""
    names, sentence = methods(results), told.verdict.sentence
    decisive = decisive_method(names) if names else ""
    clauses = [
        f"; {method_label(results, method)} {_clause(by_method(results, method), index, told)}"
        for method in names
        if method != decisive and (told.winners or study_decision(by_method(results, method), index).winners)
    ]
    return f"{sentence.removesuffix('.')}{''.join(clauses)}."


def _clause(results: xr.Dataset, index: str, told: Decision) -> str:
    """Clause on the best layouts by another method."""
    winners = study_decision(results, index).winners
    if not winners:
        return "there is none"
    names, goal = [one.name for one in winners], winners[0].goal
    same = {one.name for one in told.winners} == set(names)
    who = f"still {format_list(names)}" if same else f"{format_list(names)}, {goal.text}"
    return f"{who}, {goal.improvement.words}" if goal.improvement is not None and not goal.improvement.is_equal else who
