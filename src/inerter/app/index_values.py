"""Values of indices and of limited quantities of a design, with a cache."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import inf, isnan, nan
from typing import Any

from inerter.app.designs import Design
from inerter.errors import Status, StatusKind
from inerter.files.study.limits import StudyLimit, limited_quantity_words, limits_in, part_words
from inerter.files.study.parts import FAILURES
from inerter.files.study.study import Study
from inerter.formatting import format_quantity
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import Estimate, Method, evaluate
from inerter.optimisation.active_constraints import ConstraintResult
from inerter.optimisation.constrained_search import KEPT_COSTLY
from inerter.optimisation.limits import Limit, for_each, output_of
from inerter.vehicle.vehicle import Vehicle

_REMEMBERED = 2000  # values of designs


def estimate_index(vehicle: Vehicle, index: IndexLike, method: Method) -> Estimate:
    """Estimate of an index; nan with a status if it cannot be computed."""
    asked: tuple[Any, ...] = vehicle, index, method
    try:
        hash(asked)
    except TypeError:  # a mechanism, or an index with matrices
        return _estimate_index(*asked)
    return _remembered(*asked)


def _estimate_index(vehicle: Vehicle, index: IndexLike, method: Method) -> Estimate:
    try:
        return evaluate(vehicle, index, method)
    except FAILURES as error:
        return Estimate(nan, index.unit, Status(StatusKind.FAILED, str(error)))


_remembered = lru_cache(_REMEMBERED)(_estimate_index)  # a step of a slider leaves most designs as they were


def limits_at(study: Study, design: Design, name: str) -> list[dict[str, Any]]:
    """Limits of a study at a design, each with the value closest to it, by the method of that name."""
    pairs = zip(study.limits, limits_in(study), strict=True)
    return [_limit(study, one, several, design.vehicle, study.method(name)) for one, several in pairs]


def _limit(study: Study, said: StudyLimit, several: list[Limit], vehicle: Vehicle, method: Method) -> dict[str, Any]:
    try:
        single = [replace(limit, of=one) for limit in several for one in for_each(limit.of, vehicle)]
        held = [ConstraintResult(limit, estimate_index(vehicle, limit.of, method), False, 0.0) for limit in single]
        closest = max(held, key=lambda one: inf if isnan(one.value) else one.excess)
        worst, part = closest.estimate, part_words(vehicle, output_of(closest.limit.of))
        kept = None if isnan(worst.value) else all(one.excess <= KEPT_COSTLY for one in held)
    except FAILURES as error:
        part, worst, kept = "", Estimate(nan, said.unit, Status(StatusKind.FAILED, str(error))), None
    words = limited_quantity_words(study, said.of, part)
    return {
        "of": said.of,
        "sense": said.sense,
        "limit": said.value,
        "quantity": words,
        "title": f"{words} {said.sense.replace('_', ' ')} {format_quantity(said.value, said.unit, digits=12)}",
        "part": part,
        "unit": said.unit,
        "value": worst.value,
        "text": "" if kept is None else format_quantity(worst.value, said.unit),
        "kept": kept,
        "status": worst.status.kind.value,
        "message": worst.status.message,
    }
