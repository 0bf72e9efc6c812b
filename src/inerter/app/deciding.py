"""Decision of a study for the page: designs ranked by one index, the verdict, and its caveats."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from math import isfinite, nan
from typing import Any

from inerter.app.comparing import DesignEstimate, describe_estimate, describe_result, evaluate_design, improvement_of
from inerter.app.designs import Design, baseline_of, describe_index, designs_of, one_design, problem_digest
from inerter.app.index_values import DesignLimit, limits_at
from inerter.app.kinds import Tell, report_nothing
from inerter.app.wire import typeset_sentences
from inerter.decision.decide import decide
from inerter.decision.of_study import at_bounds, decisive_method, goal_sentence, nonlinear_elements, remedy_of
from inerter.decision.results import DesignResult, Improvement, IndexResult
from inerter.files.study.conditions import condition_labels
from inerter.files.study.sections import OVER
from inerter.files.study.study import Study
from inerter.formatting import format_list, printed_text
from inerter.methods.compare import compare_estimates
from inerter.methods.method import Estimate
from inerter.methods.registry import brief_words_of, with_decisive_method
from inerter.report.plausibility import value_warnings
from inerter.tasks.margins import MarginCaveat, MarginRequest, Margins
from inerter.tasks.margins import margins as find_margins
from inerter.validation import number_or_none

Body = Mapping[str, Any]
Answer = dict[str, Any]
_OTHER = ("index", "title", "unit", "value", "standard_error", "decimals", "status", "message")
_COMPARED = ("improvement_percent", "improvement_error_percent", "improvement_status", "tie")


def decision(study: Study, body: Body) -> Answer:
    """Designs ranked by the index `index` (default: the first), and the verdict with its caveats."""
    designs = designs_of(study, body)
    baseline = baseline_of(study, body, designs)
    if baseline is not None:
        same = [one for one in designs if one == baseline and one.layout == baseline.layout]
        designs += [] if same else [baseline]
        baseline = next(iter(same), baseline)
    method = decisive_method(body.get("methods") or study.evaluate)
    indices = list(body.get("indices") or study.indices)
    goal = body.get("index") or indices[0]
    compared = _DesignComparison(study, method, baseline, (goal, *(index for index in indices if index != goal)))
    results = [compared.result(design) for design in designs]
    left_out = body.get("left_out") or ()
    told = decide(
        results,
        compared.over,
        method=brief_words_of(method),
        remedy=remedy_of(method),
        left_out=[one["layout"] for one in left_out],
        left_out_baseline=next((one["layout"] for one in left_out if one["is_baseline"]), ""),
    )
    verdict = told.verdict.to_json()
    verdict["caveats"] = [*_warnings(study, results), *verdict["caveats"]]
    return {
        "goal": {
            **describe_index(study, goal),
            "sentence": printed_text(goal_sentence(study, goal, method)),
        },
        "method": method,
        "rows": [compared.row(rank, result) for rank, result in zip(told.ranks, told.designs, strict=True)],
        "verdict": typeset_sentences(verdict),
    }


def _warnings(study: Study, results: Sequence[DesignResult]) -> Iterator[Answer]:
    """Caveats on values that no vehicle has, of designs whose values are chosen."""
    values: dict[str, list[float]] = {}
    for result in results:
        for one in () if result.unchosen else (result.goal, *result.others):
            values.setdefault(one.index, []).append(one.value)
    for text in value_warnings(study, values):
        yield {"kind": "implausible", "sentence": text, "severity": "warning"}


def margins(study: Study, body: Body, tell: Tell = report_nothing) -> Answer:
    """Break-even values, improvements at other speeds, and tolerances of one design against the baseline.

    There is a progress report before each.
    """
    design = one_design(study, body)
    baseline = baseline_of(study, body, [])
    index = body.get("index") or study.indices[0]
    nothing = Margins(design.name, index)
    if baseline is None or design == baseline:
        text = f"{design.name} has no margins: it is the baseline." if baseline else "Margins need a baseline."
        return asdict(replace(nothing, caveats=[MarginCaveat(text)]))
    for one in (design, baseline):
        if one.unchosen:
            text = f"No value of {format_list(one.unchosen)} of {one.name} has been chosen yet."
            return asdict(replace(nothing, caveats=[MarginCaveat(text)]))
    asked = MarginRequest(
        study=study,
        layout=design.layout,
        design=design.vehicle,
        baseline_layout=baseline.layout,
        baseline=baseline.vehicle,
        index=index,
        method=decisive_method(body.get("methods") or study.evaluate),
        threads=os.cpu_count() or 1,
    )
    told: Answer = typeset_sentences(asdict(find_margins(asked, tell)))
    return told


class _DesignComparison:
    """Estimates of designs by one method, and their comparison with the baseline."""

    def __init__(self, study: Study, method: str, baseline: Design | None, indices: Sequence[str]) -> None:
        self.study, self.method, self.baseline, self.indices = study, method, baseline, indices
        self._base = [] if baseline is None else [evaluate_design(baseline, index, method) for index in indices]
        self._known: dict[int, tuple[Design, list[DesignEstimate], list[DesignLimit]]] = {}

    def result(self, design: Design) -> DesignResult:
        """Results of a design; the same object identifies it in `over` and `row`."""
        found = [evaluate_design(design, index, self.method) for index in self.indices]
        limits = limits_at(self.study, design, self.method)
        goal, *others = [self._index_result(one, i) for i, one in enumerate(found)]
        modelled, neglected = nonlinear_elements(design.mechanism, self.method)
        made = DesignResult(
            name=design.name,
            goal=goal,
            others=tuple(others),
            in_conditions=tuple(
                (name, by)
                for name, _, _, by in self._in_conditions(found[0])
                if by is not None and isfinite(by.percent)
            ),
            limits=tuple(one.result() for one in limits),
            unchosen=design.unchosen,
            at_bounds=tuple(at_bounds(design.free, design.values, self.study.free_units)),
            modelled=modelled,
            neglected=neglected,
            is_baseline=design is self.baseline,
            n_elements=len(design.mechanism.strut_elements()),
        )
        self._known[id(made)] = design, found, limits
        return made

    def _in_conditions(self, one: DesignEstimate) -> Iterator[tuple[str, float, Estimate, Improvement | None]]:
        """Name, share (nan if none counts), goal and improvement over the baseline in each of several conditions."""
        base = self._base[0] if self._base else None
        is_compared = base is not None and one.design is not self.baseline and one.beside(base) is not None
        conditions, own = self.study.conditions, one.estimate.in_conditions
        if len(conditions) < 2 or not own:
            return
        whole = sum(condition.share for condition in conditions) if self.study.over == OVER[0] else nan
        others = base.estimate.in_conditions if base is not None and is_compared else [None] * len(own)
        each = zip(condition_labels(conditions), conditions, own, others, strict=True)
        for name, condition, estimate, other in each:
            by = None if other is None else improvement_of(compare_estimates(estimate, other))
            yield name, condition.share / whole, estimate, by

    def over(self, one: DesignResult, other: DesignResult) -> Improvement | None:
        """Improvement of a design over another in the goal, on the same roads."""
        first, second = (self._known[id(each)][1][0] for each in (one, other))
        return improvement_of(first.beside(second))

    def row(self, rank: int | None, result: DesignResult) -> Answer:
        """Row of the ranking, for an answer."""
        design, found, limits = self._known[id(result)]
        base: Sequence[DesignEstimate | None] = self._base or [None] * len(found)
        told = [describe_result(one, other) for one, other in zip(found, base, strict=True)]
        keys = (*_OTHER, *_COMPARED)
        return {
            "layout": design.layout,
            "name": design.name,
            "rank": rank,
            **{key: told[0][key] for key in keys if key not in ("index", "title", "unit")},
            "unchosen": list(design.unchosen),
            "problem_digest": problem_digest(self.study, design.layout, self.indices[0]),
            "is_baseline": result.is_baseline,
            "others": [{key: one[key] for key in keys} for one in told[1:]],
            "limits": [one.to_json() for one in limits],
            "in_conditions": [
                {"name": name, "share": number_or_none(share), **describe_estimate(estimate, by)}
                for name, share, estimate, by in self._in_conditions(found[0])
            ],
        }

    def _index_result(self, one: DesignEstimate, i: int) -> IndexResult:
        estimate, study = one.estimate, self.study
        base = self._base[i] if self._base else None
        two = None if base is None or one.design is self.baseline else one.beside(base)
        return IndexResult(
            index=one.index,
            title=study.index(one.index).title,
            unit=study.unit(one.index),
            value=estimate.value,
            status=with_decisive_method(estimate.status, self.method),
            standard_error=estimate.quantity.error,
            error_bound=estimate.error_bound,
            improvement=improvement_of(two),
        )
