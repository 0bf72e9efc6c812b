"""Decision of a study for the page: designs ranked by one index, the verdict, and its caveats."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from math import nan
from typing import Any

from inerter.app.comparing import DesignEstimate, describe_estimate, describe_result, evaluate_design
from inerter.app.designs import Design, baseline_of, describe_index, designs_of, one_design, problem_digest
from inerter.app.index_values import DesignLimit, limits_at
from inerter.app.kinds import Tell, report_nothing
from inerter.app.wire import typeset_sentences
from inerter.decision.decide import decide_by_comparison
from inerter.decision.of_study import at_bounds, decisive_method, goal_sentence, has_inerter, nonlinear_elements
from inerter.decision.results import DesignResult, Improvement, IndexResult
from inerter.files.study.sections import OVER
from inerter.files.study.study import Study
from inerter.formatting import format_list, printed_text
from inerter.methods.compare import Comparison, compare_estimates
from inerter.methods.method import Estimate
from inerter.methods.registry import with_decisive_method
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
    results = [compared.add(design) for design in designs]
    left_out = body.get("left_out") or ()
    told = decide_by_comparison(
        results,
        compared.compare,
        method,
        _condition_names(study),
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
        "rows": [compared.row(*ranked) for ranked in zip(told.ranks, told.order, told.designs, strict=True)],
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
        self._base = {} if baseline is None else self._estimates(baseline)
        self._known: list[tuple[Design, dict[str, DesignEstimate], list[DesignLimit]]] = []

    def _estimates(self, design: Design) -> dict[str, DesignEstimate]:
        return {index: evaluate_design(design, index, self.method) for index in self.indices}

    def add(self, design: Design) -> DesignResult:
        """Results of a design, whose number in `compare` and `row` is that of the designs before it."""
        found = self._base if design is self.baseline else self._estimates(design)
        limits = limits_at(self.study, design, self.method)
        self._known.append((design, found, limits))
        goal, *others = map(self._index_result, found.values())
        modelled, neglected = nonlinear_elements(design.mechanism, self.method)
        return DesignResult(
            name=design.name,
            goal=goal,
            others=tuple(others),
            limits=tuple(one.result() for one in limits),
            unchosen=design.unchosen,
            at_bounds=tuple(at_bounds(design.free, design.values, self.study.free_units)),
            modelled=modelled,
            neglected=neglected,
            is_baseline=design is self.baseline,
            n_elements=len(design.mechanism.strut_elements()),
            has_inerter=has_inerter(design.mechanism),
        )

    def _index_result(self, one: DesignEstimate) -> IndexResult:
        result = IndexResult.of(one.index, self.study.index(one.index).title, one.estimate)
        return replace(result, status=with_decisive_method(result.status, self.method))

    def compare(self, first: int, second: int, index: str, condition: int | None) -> Comparison | None:
        """Comparison of two designs in an index, on the same roads."""
        one, other = (self._known[i][1][index] for i in (first, second))
        two = one.beside(other)
        if condition is None or two is None:
            return two
        own, others = one.estimate.in_conditions, other.estimate.in_conditions
        return compare_estimates(own[condition], others[condition]) if own and others else None

    def row(self, rank: int | None, number: int, result: DesignResult) -> Answer:
        """Row of the ranking, for an answer."""
        design, found, limits = self._known[number]
        told = [describe_result(one, self._base.get(index)) for index, one in found.items()]
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
            "in_conditions": list(self._in_conditions(found[self.indices[0]].estimate, dict(result.in_conditions))),
        }

    def _in_conditions(self, goal: Estimate, improvements: Mapping[str, Improvement]) -> Iterator[Answer]:
        """Name, share (null if none counts), goal and improvement over the baseline in each of several conditions."""
        conditions = self.study.conditions
        whole = sum(condition.share for condition in conditions) if self.study.over == OVER[0] else nan
        names = _condition_names(self.study)
        for name, condition, estimate in zip(names, conditions, goal.in_conditions, strict=False):
            share = number_or_none(condition.share / whole)
            yield {"name": name, "share": share, **describe_estimate(estimate, improvements.get(name))}


def _condition_names(study: Study) -> list[str]:
    """Names of the conditions; none unless there are several."""
    return study.condition_labels if len(study.conditions) > 1 else []
