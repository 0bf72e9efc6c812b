"""Comparison of designs: indices of each, differences, and those that may be the best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from inerter.app.designs import Design, baseline_of, describe_index, designs_of, given_design
from inerter.app.documents import study_from
from inerter.app.index_values import estimate_index, limits_at
from inerter.app.kinds import Tell, report_nothing
from inerter.decision.results import Improvement, improvement_of, is_doubtful, possibly_least
from inerter.errors import DesignError
from inerter.files.common.layouts import LayoutCodec
from inerter.files.study.parts import FAILURES
from inerter.files.study.place import element_at, place_of
from inerter.files.study.study import Study, elements_used
from inerter.formatting import format_quantity, shown_decimals
from inerter.methods.compare import Comparison, compare
from inerter.methods.method import Estimate
from inerter.validation import number_or_none

Body = Mapping[str, Any]
Answer = dict[str, Any]

_FEWEST, _MOST = 2, 4  # designs that stand side by side
_VEHICLE, _DIGITS = "vehicle", 5


@dataclass(frozen=True)
class DesignEstimate:
    """Design with its estimate of one index by one method."""

    design: Design
    index: str
    method: str
    estimate: Estimate

    def beside(self, other: DesignEstimate) -> Comparison | None:
        """Comparison with another design on the same roads.

        None where one of them has no number, or values that nobody has chosen: the middle of their bounds is no design.
        """
        known, found = self._comparisons.get(id(other), (None, None))
        if known is not other:
            found = self._compare(other)
            self._comparisons[id(other)] = other, found
        return found

    @cached_property
    def _comparisons(self) -> dict[int, tuple[DesignEstimate, Comparison | None]]:
        """Comparisons with other estimates, by their identity: an answer needs each of them several times."""
        return {}

    def _compare(self, other: DesignEstimate) -> Comparison | None:
        if self.design.unchosen or other.design.unchosen:
            return None
        if not np.isfinite([self.estimate.value, other.estimate.value]).all():
            return None
        first, second = self.design.vehicle, other.design.vehicle
        asked, method = self.design.resolve_index(self.index), self.design.study.method(self.method)
        try:
            return compare(first, second, asked, method, known=(self.estimate, other.estimate))
        except FAILURES:
            return None


def indices(study: Study, body: Body) -> Answer:
    """Indices of all designs, compared with the baseline, and the state of their limits."""
    designs = designs_of(study, body)
    baseline = baseline_of(study, body, designs)
    asked = _index_method_pairs(study, body)
    base = [None if baseline is None else evaluate_design(baseline, *each) for each in asked]
    return {
        "designs": [
            {
                **design.describe_values(),
                "results": [
                    describe_result(evaluate_design(design, *each), one) for each, one in zip(asked, base, strict=True)
                ],
                "limits": [one.to_json() for one in limits_at(study, design, asked[0][1])],
            }
            for design in designs
        ],
        "baseline": None if baseline is None else baseline.describe_values(),
    }


def compare_designs(study: Study, body: Body, tell: Tell = report_nothing) -> Answer:
    """Comparison of two to four designs with the first of them, with a progress report before each.

    Each may belong to another study. What is asked of all, on which road and by which methods, is what `study` says.
    """
    designs = _of_studies(study, body)
    if not _FEWEST <= len(designs) <= _MOST:
        raise DesignError(f"A comparison requires two to four designs, got {len(designs)}.")
    asked = _index_method_pairs(study, body)
    found: list[list[DesignEstimate]] = []
    for i, design in enumerate(designs):
        tell(i, len(designs), design.name)
        found.append([evaluate_design(design, *each) for each in asked])
    tell(len(designs), len(designs), "")
    best = [_best(column) for column in zip(*found, strict=True)]
    return {
        "designs": [
            {
                **one[0].design.describe_values(),
                "network": LayoutCodec().dump(one[0].design.study.layouts[one[0].design.layout]),
                "numbers": _numbers(one[0].design),
                "results": [
                    {**describe_result(each, base), "best": i in least}
                    for each, base, least in zip(one, found[0], best, strict=True)
                ],
            }
            for i, one in enumerate(found)
        ]
    }


def _of_studies(study: Study, body: Body) -> list[Design]:
    """Designs of a request; one with a study of its own is evaluated with the indices of `study`."""
    given = body.get("designs") or []
    if not any(one.get("study") for one in given):
        return designs_of(study, body)
    return [given_design(_put(study, one.get("study")), one) for one in given]


def _put(study: Study, document: object) -> Study:
    """Study with the vehicle, elements and layouts of another document, and the indices and methods of `study`."""
    if not document:
        return study
    own = study_from(document)
    return replace(study, vehicle=own.vehicle, elements=own.elements, layouts=own.layouts)


def _numbers(design: Design) -> dict[str, str]:
    """Numbers of a design's elements and vehicle as texts with units, by their description."""
    used = {name for name, layouts in elements_used(design.fixed_study).items() if design.layout in layouts}
    found = {}
    for label, number in design.fixed_study.numbers.items():
        place = place_of(label)
        if isinstance(number.value, int | float) and (place.section == _VEHICLE or element_at(place) in used):
            found[number.words] = format_quantity(number.value, number.unit, digits=_DIGITS)
    return found


def _index_method_pairs(study: Study, body: Body) -> list[tuple[str, str]]:
    """Pairs of each requested index and each requested method."""
    indices, methods = body.get("indices") or study.indices, body.get("methods") or study.evaluate
    return [(index, method) for index in indices for method in methods]


def evaluate_design(design: Design, index: str, method: str) -> DesignEstimate:
    return DesignEstimate(
        design, index, method, estimate_index(design.vehicle, design.resolve_index(index), design.study.method(method))
    )


def _best(found: Sequence[DesignEstimate]) -> list[int]:
    """Numbers of the designs that do not differ significantly from the best one.

    None of them, where a value is doubtful or nobody has chosen a design: then the best is not known.
    """
    if any(one.design.unchosen or is_doubtful(one.estimate.value, one.estimate.status) for one in found):
        return []
    return possibly_least([one.estimate.value for one in found], lambda i, j: improvement_of(found[i].beside(found[j])))


def describe_result(one: DesignEstimate, baseline: DesignEstimate | None) -> Answer:
    """Value and status of an index for an answer, with its improvement over the baseline; null if not comparable."""
    estimate = one.estimate
    return {
        **describe_index(one.design.study, one.index),
        "method": one.method,
        "notes": list(estimate.notes),
        "realisations": estimate.realisations,
        **describe_estimate(estimate, None if baseline is None else improvement_of(one.beside(baseline))),
    }


def describe_estimate(estimate: Estimate, by: Improvement | None) -> Answer:
    """Value and status for an answer, with an improvement; null without one."""
    return {
        "value": estimate.value,
        "standard_error": estimate.standard_error,
        "error_bound": estimate.error_bound,
        "decimals": shown_decimals(estimate.value, estimate.standard_error or np.nan, estimate.error_bound, _DIGITS),
        **estimate.status.to_json(),
        "improvement_percent": None if by is None else by.percent,
        "improvement_error_percent": None if by is None else number_or_none(by.error),
        "improvement_status": None if by is None else by.status.kind.value,
        "tie": None if by is None else by.is_equal,
    }
