"""Verdict of a study without a sweep for each index: the decision that the workbench shows, from a table of results."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import hypot, isfinite, isnan, nan
from typing import TYPE_CHECKING

from inerter.decision.caveats import CaveatKind
from inerter.decision.decide import Decision, decide
from inerter.decision.of_study import decisive_method, nonlinear_elements, remedy_of
from inerter.decision.results import AtBound, DesignResult, Improvement, IndexResult
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
    one_method,
)
from inerter.files.common.roads import EFFECT, OTHER_EFFECT, ROAD_ERROR
from inerter.files.study.study import Study
from inerter.formatting import format_list, format_quantity
from inerter.methods.averages import interval_of
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.registry import brief_words_of, with_decisive_method
from inerter.methods.ties import ACCURACY, percent_below
from inerter.report.conditions import condition_names, in_condition

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


def best_layouts(results: xr.Dataset, index: str) -> list[str]:
    """All layouts that may have the least value of `index` by the first method, the simplest first."""
    return [one.name for one in _winners(one_method(results), index)]


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
    designs = []
    for name in layouts(results):
        mechanism = study.design(name).mechanism() if study is not None and method else None
        modelled, neglected = nonlinear_elements(mechanism, method) if mechanism is not None else ((), ())
        designs.append(
            replace(
                _design(results, row, index, name, method),
                others=tuple(_others(results, row, index, name)),
                in_conditions=tuple(_in_conditions(each, name)),
                at_bounds=tuple(_at_bounds(row.sel(layout=name))),
                modelled=modelled,
                neglected=neglected,
            )
        )
    return decide(
        designs,
        partial(_over, row),
        method=brief_words_of(method) if method else "",
        remedy=remedy_of(method) if method else "",
    )


def _winners(results: xr.Dataset, index: str) -> Sequence[DesignResult]:
    """Best designs for an index, of results by one method."""
    row, names = _row(results, index), results["layout"].values.tolist()
    return decide([_design(results, row, index, name) for name in names], partial(_over, row)).winners


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


def _design(results: xr.Dataset, row: xr.Dataset, index: str, layout: str, method: str = "") -> DesignResult:
    """Best design of a layout for an index, with its value and its improvement over the baseline."""
    design, baseline = row.sel(layout=layout), row.attrs["baseline"]
    is_compared = baseline and layout != baseline
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
            improvement=_improvement(row, design, row.sel(layout=baseline)) if is_compared else None,
        ),
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
    return Improvement(
        percent,
        error_of(design, "improvement"),
        bound_of(design, "improvement"),
        abs(percent * reference) / 100.0 <= _margin(row, design, base) + 2.0 * ACCURACY * min(abs(own), abs(reference)),
    )


def _over(row: xr.Dataset, first: DesignResult, second: DesignResult) -> Improvement | None:
    """Improvement of one design over another."""
    own, other = first.goal.value, second.goal.value
    if second.is_baseline:
        return first.goal.improvement
    percent = percent_below(own, other)
    if isnan(percent):
        return None
    error = hypot(*(0.0 if isnan(one.goal.standard_error) else one.goal.standard_error for one in (first, second)))
    pair = [row.sel(layout=one.name) for one in (first, second)]
    effects = [_road_effects(one, EFFECT) for one in pair]
    return Improvement(
        percent,
        100.0 * error / abs(other) if isfinite(error) and error else nan,
        improvement_bound(own, other, first.goal.error_bound, second.goal.error_bound, *effects),
        is_tie=abs(own - other) <= _margin(row, *pair) + 2.0 * ACCURACY * min(abs(own), abs(other)),
    )


def _margin(row: xr.Dataset, first: xr.Dataset, second: xr.Dataset) -> float:
    """Difference of two values within their 95 % confidence interval; zero without uncertainties."""
    if "standard_error" not in row or "realisations" not in row:
        return 0.0
    count = max(min(int(one["realisations"]) for one in (first, second)), 2)
    _, margin = interval_of(0.0, hypot(*(_sampling_error(row, one) for one in (first, second))), count)
    return 0.0 if isnan(margin) else margin


def _sampling_error(row: xr.Dataset, design: xr.Dataset) -> float:
    """Standard error of the difference from the baseline on the same roads; without one, that of the value itself."""
    baseline = row.attrs["baseline"]
    if baseline and design["layout"].item() == baseline and "improvement_error" in row:
        return 0.0
    of_difference = error_of(design, "improvement")
    if baseline and isfinite(of_difference):
        return of_difference / 100.0 * float(row["value"].sel(layout=baseline))
    return error_of(design)


def _road_effects(value: xr.Dataset, name: str) -> dict[str, list[float]]:
    """Effects of the errors of a measured road on a value, by error; `name` is their variable."""
    found: dict[str, list[float]] = {}
    if name in value:
        for error, effect in zip(value[ROAD_ERROR].values.tolist(), value[name].values.tolist(), strict=True):
            found.setdefault(error, []).append(effect)
    return found


def _others(results: xr.Dataset, row: xr.Dataset, index: str, layout: str) -> Iterator[IndexResult]:
    """Other indices of the same design, compared with those of the baseline's design."""
    baseline = row.attrs["baseline"]
    if not baseline or "other_value" not in row:
        return
    pair = [row.sel(layout=name) for name in (layout, baseline)]
    for other in results["other"].values.tolist():
        both = [one.sel(other=other) for one in pair]
        own, reference = (float(one["other_value"]) for one in both)
        by, percent = None, percent_below(own, reference)
        if layout != baseline and isfinite(percent):
            errors = [error for one in both if isfinite(error := error_of(one, "other"))]
            spread = 100.0 * hypot(*errors) / abs(reference)
            bounds = [bound_of(one, "other") for one in both]
            effects = [_road_effects(one, OTHER_EFFECT) for one in both]
            bound = improvement_bound(own, reference, bounds[0], bounds[1], *effects)
            by = Improvement(percent, spread or nan, bound, is_tie=abs(percent) <= _TWO_SIDED * spread)
        if other != index and not (isnan(own) and isnan(reference)):
            yield IndexResult(other, index_title(results, other), index_unit(results, other), own, improvement=by)


def _at_bounds(design: xr.Dataset) -> Iterator[AtBound]:
    if "at_bound" not in design:
        return
    for name in design["parameter"].values.tolist():
        entry = design.sel(parameter=name)
        value, bound = float(entry["parameter_value"]), str(entry["at_bound"].item())
        if bound and isfinite(value):
            yield AtBound(name, bound, format_quantity(value, str(entry["parameter_unit"].item())))


def _with_other_methods(results: xr.Dataset, index: str, told: Decision) -> str:
    """Verdict, and the best layouts by the other methods of the study."""
    names, text = methods(results), told.verdict.sentence.removesuffix(".")
    for method in names:
        if method != decisive_method(names):
            winners = _winners(by_method(results, method), index)
            if told.winners or winners:
                text += f"; {method_label(results, method)} {_winners_clause(winners, told)}"
    return f"{text}."


def _winners_clause(winners: Sequence[DesignResult], told: Decision) -> str:
    """Clause on the best layouts by another method."""
    if not winners:
        return "there is none"
    names, goal = [one.name for one in winners], winners[0].goal
    same = {one.name for one in told.winners} == set(names)
    who = f"still {format_list(names)}" if same else f"{format_list(names)}, {goal.text}"
    return f"{who}, {goal.improvement.words}" if goal.improvement is not None and not goal.improvement.is_equal else who
