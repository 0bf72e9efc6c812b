"""Values of indices and of limited quantities of a design, with a cache."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf, isnan, nan
from typing import Any

from inerter.app.designs import Design
from inerter.decision.results import LimitResult
from inerter.errors import Status, StatusKind
from inerter.files.study.limits import (
    StudyLimit,
    cases_clause,
    each_like,
    limited_quantity_words,
    limits_in,
    part_words,
)
from inerter.files.study.parts import FAILURES
from inerter.files.study.study import Study
from inerter.formatting import format_quantity, in_words
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


@dataclass(frozen=True)
class DesignLimit:
    """Limit of a study at a design: in words, without its value; its side; the quantity closest to it, its estimate.

    `kept` is None where that is not known; `excess` is the logarithm of value over limit, towards the forbidden side.
    """

    limit: StudyLimit
    words: str
    side: str
    quantity: str
    part: str
    estimate: Estimate
    kept: bool | None
    excess: float

    @property
    def text(self) -> str:
        """Value with its unit; empty where it is not known."""
        return "" if self.kept is None else format_quantity(self.estimate.value, self.limit.unit)

    @property
    def sentence(self) -> str:
        """Whether the limit is kept, and the value; first a doubt about it."""
        status = self.estimate.status
        doubt = "" if status.ok else f"{status.kind.value}: "
        kept = {True: "kept", False: "broken", None: "not known"}[self.kept]
        value = f"; it is {self.text}" if self.text else ""
        reason = f" ({status.message})" if status.message else ""
        return f"{doubt}{kept}: {self.quantity} {self.side}{value}{reason}"

    def to_json(self) -> dict[str, Any]:
        """The limit for an answer."""
        return {
            "of": self.limit.of,
            "sense": self.limit.sense,
            "limit": self.limit.value,
            "words": self.words,
            "quantity": self.quantity,
            "title": f"{self.quantity} {self.side}",
            "part": self.part,
            "unit": self.limit.unit,
            "value": self.estimate.value,
            "text": self.text,
            "kept": self.kept,
            "sentence": self.sentence,
            **self.estimate.status.to_json(),
        }

    def result(self) -> LimitResult:
        """The limit as a decision compares it."""
        message = self.estimate.status.message
        return LimitResult(self.quantity, self.side, self.text, self.kept, self.excess, message)


def limits_at(study: Study, design: Design, name: str) -> list[DesignLimit]:
    """Limits of a study at a design, each with the value closest to it, by the method of that name."""
    pairs = zip(study.limits, limits_in(study, design.layout), strict=True)
    return [_limit(study, one, several, design.vehicle, study.method(name)) for one, several in pairs]


def _limit(study: Study, said: StudyLimit, several: list[Limit], vehicle: Vehicle, method: Method) -> DesignLimit:
    try:
        single = [replace(limit, of=one) for limit in several for one in for_each(limit.of, vehicle)]
        held = [ConstraintResult(limit, estimate_index(vehicle, limit.of, method), False, 0.0) for limit in single]
        closest = max(held, key=lambda one: inf if isnan(one.value) else one.excess)
        estimate, part = closest.estimate, part_words(vehicle, output_of(closest.limit.of))
        kept = None if isnan(estimate.value) else all(one.excess <= KEPT_COSTLY for one in held)
        excess = inf if kept is None else closest.excess
    except FAILURES as error:
        estimate = Estimate(nan, said.unit, Status(StatusKind.FAILED, str(error)))
        part, kept, excess = "", None, inf
    each, closest_words = (limited_quantity_words(study, said.of, one) for one in (each_like(part), part))
    side = f"{said.side}{cases_clause(study, said)}"
    return DesignLimit(said, f"{each} {in_words(said.sense)}", side, closest_words, part, estimate, kept, excess)
