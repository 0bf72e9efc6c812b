"""The tolerances of a study: what the index of each best design becomes when values scatter."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from inerter.errors import InerterError, StatusKind
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.suggest import some
from inerter.files.study.cases import ENDED, FAILURES, Case, Outcome
from inerter.files.study.conditions import what_of
from inerter.files.study.place import element_at, place_of
from inerter.files.study.places import number_at
from inerter.files.study.study import Study, scattering
from inerter.files.study.sweeps import unknown_place
from inerter.methods.registry import deciding
from inerter.networks.elements import Tied
from inerter.optimisation.threads import one_blas_thread
from inerter.scatter.tolerance import tolerance
from inerter.units import shown

SHARE = 0.95  # of cases, of the quantile that is told
_PLACE = ("study", "tolerance")


@dataclass(frozen=True)
class ToleranceCase:
    """What becomes of the index of the design that is best for it?"""

    layout: str
    index: str

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return f"tolerance of {self.layout} {self.index}"

    def run(self, study: Study, outcomes: Mapping[Case, Outcome], threads: int = 1) -> ToleranceOutcome:
        """The tolerance of the design that was found. A failure is an outcome with a status and a sentence."""
        method = study.evaluate[0]
        try:
            with one_blas_thread(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                found = tolerance(
                    study.design(self.layout).with_values(outcomes[Case(self.layout, self.index)].parameters),
                    study.over_conditions(self.index),
                    study.method(method, threads),
                    spread=study.spread(self.layout),
                    seed=study.seed,
                )
        except FAILURES as error:
            return self._without(study, str(error))
        return ToleranceOutcome(
            *(self.layout, self.index, method, study.unit(self.index)),
            numbers={
                "nominal": found.nominal.value,
                "mean": found.mean,
                "standard_deviation": found.standard_deviation,
                "quantile": found.quantile(SHARE),
                "worst": found.worst,
            },
            effects={name: [found.main[name], found.total[name]] for name in found.main},
            status=found.status.kind.value,
            message=found.status.message + ("" if found.status.ok else deciding(method, found.status.message)),
        )

    def lost(self, study: Study) -> ToleranceOutcome:
        """What is known of a tolerance whose processes have ended, each time that it was tried."""
        return self._without(study, ENDED)

    def _without(self, study: Study, message: str) -> ToleranceOutcome:
        unit = study.unit(self.index)
        failed = StatusKind.FAILED.value
        return ToleranceOutcome(self.layout, self.index, study.evaluate[0], unit, {}, {}, failed, message)


@dataclass(frozen=True)
class ToleranceOutcome:
    """The distribution of an index, in SI units, and which values it is due to; all of it survives JSON."""

    layout: str
    index: str
    method: str
    unit: str
    numbers: dict[str, float]  # nominal, mean, standard_deviation, quantile, worst
    effects: dict[str, list[float]]  # by what scatters: its part of the variance by itself, and in all
    status: str
    message: str = ""

    @property
    def case(self) -> ToleranceCase:
        """The case that it answers."""
        return ToleranceCase(self.layout, self.index)

    @property
    def name(self) -> str:
        """What it is, in messages."""
        return self.case.name

    @property
    def ok(self) -> bool:
        """Whether there is an answer."""
        return self.status == StatusKind.OK.value

    def to_json(self) -> dict[str, Any]:
        """A plain dictionary; `ToleranceOutcome(**...)` undoes it."""
        return dict(vars(self))


def tolerance_cases(study: Study) -> list[ToleranceCase]:
    """All cases in the order of the results: indices, layouts. A layout has those that something of it scatters."""
    return [ToleranceCase(layout, index) for index in study.indices for layout in study.layouts if study.spread(layout)]


def tolerance_of(study: Study, entries: Mapping[str, float]) -> tuple[dict[str, float], list[Problem]]:
    """By what part of itself each number scatters, by its label, and what is wrong with that."""
    spread, problems = {}, []
    for label, part in entries.items():
        try:
            place = place_of(label)
            if number_at(study, place) is None or what_of(study, place) is None or place.section == "road":
                raise unknown_place(study, place)
            _check_is_part(study, element_at(place))
            spread[place.label] = part
        except EntryError as error:
            problems.append(replace(error.problem, place=(*_PLACE, label)))
        except InerterError as error:
            problems.append(at((*_PLACE, label), str(error)))
    return spread, problems


def _check_is_part(study: Study, name: str) -> None:
    """Raises `EntryError` for an element that no layout has, of which nothing is made that could scatter."""
    if name and not any(name in scattering(study, layout) for layout in study.layouts):
        tied = [other for other, e in study.elements.items() if isinstance(e.value, Tied) and name in e.value.names]
        hint = f"; {some(tied)} follows from it, and scatters by its own name" if tied else ""
        raise EntryError(got=shown(name), fault=f"no layout has it as a part{hint}", expected="a part of a layout")


def tolerances_csv(found: Sequence[ToleranceOutcome]) -> str:
    """One row a design; the effects are parts of the variance."""
    numbers = ["nominal", "mean", "standard_deviation", "quantile", "worst"]
    names = list(dict.fromkeys(name for one in found for name in one.effects))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    effects = [f"{kind} effect of {name}" for name in names for kind in ("main", "total")]
    told = [f"quantile_{SHARE:g}" if name == "quantile" else name for name in numbers]
    writer.writerow(["layout", "index", "method", *told, "unit", *effects, "status"])
    for one in found:
        values = [repr(one.numbers[name]) if name in one.numbers else "" for name in numbers]
        parts = [repr(one.effects[name][i]) if name in one.effects else "" for name in names for i in (0, 1)]
        status = f"{one.status}: {one.message}" if one.message else one.status
        writer.writerow([one.layout, one.index, one.method, *values, one.unit, *parts, status])
    return text.getvalue()
