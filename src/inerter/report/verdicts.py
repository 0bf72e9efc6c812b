"""Verdict of a study without a sweep for each index: the decision that the workbench shows, from a table of results."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from math import hypot, isfinite, isnan
from typing import TYPE_CHECKING

from inerter.decision.caveats import CaveatKind
from inerter.decision.decide import Decision, decide_by_comparison
from inerter.decision.of_study import decisive_method, has_inerter, nonlinear_elements
from inerter.decision.results import AtBound, DesignResult, IndexResult
from inerter.errors import OK, ErrorSource, Status, StatusKind
from inerter.figures.labels import (
    bound_of,
    by_method,
    error_of,
    index_title,
    index_unit,
    indices,
    method_label,
    methods,
    one_method,
)
from inerter.files.common.roads import EFFECT, OTHER_EFFECT, ROAD_ERROR
from inerter.files.study.study import Study
from inerter.formatting import format_list, format_quantity
from inerter.methods.averages import interval_of
from inerter.methods.compare import Comparison, Difference, compare_estimates
from inerter.methods.error_bounds import ROUNDING
from inerter.methods.method import Estimate
from inerter.methods.registry import with_decisive_method
from inerter.report.conditions import condition_names, in_condition

if TYPE_CHECKING:
    import xarray as xr

_STATIC = "the static limit, which no damper or inerter lowers"
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
    return [one.name for one in study_decision(one_method(results), index).winners]


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
    conditions = condition_names(one)
    each = [_row(in_condition(one, i), index) for i in range(len(conditions))]
    others = [other for other in _others(row) if other != index]
    estimates, designs = [], []
    for name in results["layout"].values.tolist():  # as in the file, where `layouts` has the baseline first
        design = row.sel(layout=name)
        own = {index: _estimate(design, index_unit(results, index), status=_status(results, design, method))}
        for other in others:
            own[other] = _estimate(design.sel(other=other), index_unit(results, other), "other")
        estimates.append(own)
        goal, *rest = (IndexResult.of(of, index_title(results, of), estimate) for of, estimate in own.items())
        mechanism = study.design(name).mechanism() if study is not None and method else None
        modelled, neglected = ((), ()) if mechanism is None else nonlinear_elements(mechanism, method)
        designs.append(
            DesignResult(
                name=name,
                goal=goal,
                others=tuple(rest),
                at_bounds=tuple(_at_bounds(design)),
                modelled=modelled,
                neglected=neglected,
                is_baseline=name == row.attrs["baseline"],
                n_elements=int(design["elements"]) if "elements" in design.coords else 0,
                has_inerter=mechanism is not None and has_inerter(mechanism),
            )
        )

    def compare(first: int, second: int, of: str, condition: int | None) -> Comparison | None:
        if of != index:
            return compare_estimates(estimates[first][of], estimates[second][of])
        here = row if condition is None else each[condition]
        return _comparison(here, index_unit(results, index), designs[first].name, designs[second].name)

    return decide_by_comparison(designs, compare, method, conditions)


def _row(results: xr.Dataset, index: str) -> xr.Dataset:
    """Results for one index with the dimensions that a decision compares."""
    row = results.sel(index=index)
    row = row.squeeze([name for name, size in row.sizes.items() if size == 1 and name not in _DIMS])
    return row.drop_dims([name for name in row.dims if name not in _DIMS])


def _others(row: xr.Dataset) -> list[str]:
    """Indices of which the values at the best designs are compared with those of the baseline's design."""
    if not row.attrs["baseline"] or "other_value" not in row:
        return []
    known = row["other_value"].notnull().any("layout")
    return [name for name in row["other"].values.tolist() if bool(known.sel(other=name))]


def _status(results: xr.Dataset, design: xr.Dataset, method: str) -> Status:
    """Status of a design; its message names the method that can decide, where the study has no other."""
    kind, message = Status.parts(str(design["status"].item()))
    status = Status(StatusKind(kind) if kind in list(StatusKind) else StatusKind.FAILED, message)
    return with_decisive_method(status, method) if method and len(methods(results)) == 1 else status


def _estimate(design: xr.Dataset, unit: str, of: str = "value", status: Status = OK) -> Estimate:
    """Estimate of the index of one design, or of another index at it."""
    error, bound = error_of(design, of), bound_of(design, of)
    shared = _road_effects(design, EFFECT if of == "value" else OTHER_EFFECT)
    sources = [ErrorSource(name, hypot(*effects), tuple(effects)) for name, effects in shared.items()]
    alone = bound - sum(source.bound for source in sources)
    return Estimate(
        float(design["value" if of == "value" else "other_value"]),
        unit,
        status,
        standard_error=None if isnan(error) else error,
        realisations=int(design["realisations"]) if "realisations" in design else 0,
        error_sources=() if isnan(bound) else (ErrorSource(ROUNDING, alone), *sources),
    )


def _comparison(row: xr.Dataset, unit: str, first: str, second: str) -> Comparison | None:
    """Comparison of two layouts, on the same roads where one is the baseline; None if one has no finite value.

    Of two others, each has the error of its difference from the baseline on the same roads, if there is a baseline.
    """
    one, other = row.sel(layout=first), row.sel(layout=second)
    two = compare_estimates(_estimate(one, unit), _estimate(other, unit))
    if not isfinite(two.percent):
        return None
    if second == row.attrs["baseline"]:
        percent, error = -float(one["improvement"]), error_of(one, "improvement")
        two = replace(two, relative=replace(two.relative, value=percent, standard_error=error))
    value, error = two.percent * two.second.value / 100.0, hypot(_sampling_error(row, one), _sampling_error(row, other))
    count = max(min(two.first.realisations, two.second.realisations), 2)
    interval = interval_of(value, 0.0 if isnan(error) else error, count)
    return replace(two, difference=Difference(value, unit, error, interval))


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
            winners = study_decision(by_method(results, method), index).winners
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
