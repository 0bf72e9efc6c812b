"""The cases of a study: one layout, one index, one point of the sweeps each, and what running one gives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from math import prod
from typing import Any

import numpy as np

from inerter.errors import Status, StatusKind, worst_of
from inerter.files.study.design_numbers import DESIGN_NUMBERS
from inerter.files.study.limits import all_limits, limit_results
from inerter.files.study.parts import FAILURES, PartResult, StudyPart, run_part
from inerter.files.study.speeds import at_other_speeds, is_at_one_speed
from inerter.files.study.study import Study
from inerter.methods.compare import controls_of
from inerter.methods.method import AveragingMethod, Estimate, evaluate
from inerter.methods.notes import parts_of, with_prefix
from inerter.methods.registry import brief_words_of, is_blind
from inerter.optimisation.active_constraints import broken, constraints_at
from inerter.optimisation.optimise import Optimum, optimise
from inerter.systems.descriptor import is_held_by_springs, linear_notes
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle
from inerter.work.progress import report, within

NO_EQUILIBRIUM = "no static equilibrium: no spring supports the body"
_OK = StatusKind.OK.value
_SEARCHED = 0.97  # share of the work on a case that the search takes
_MOST_SAMPLES = 64  # that are kept, for differences on the same roads


@dataclass(frozen=True)
class Case(StudyPart["Outcome"]):
    """Design to optimise and evaluate. `point` numbers the swept values, zero without a sweep."""

    layout: str
    index: str
    point: int = 0
    swept: tuple[float, ...] = field(default=(), compare=False)  # the value of each sweep at that point

    @property
    def name(self) -> str:
        """Name of the case in messages: layout, index, and point of the sweeps."""
        return f"{self.layout} {self.index}{f' at point {self.point + 1}' if self.point else ''}"

    def compute(self, study: Study, designs: Mapping[Case, Outcome], threads: int) -> Outcome:
        """The best design, evaluated by every method and index of the study."""
        return _run(study, self, threads)

    def failed_result(self, study: Study, message: str) -> Outcome:
        """Outcome without a design."""
        failed = dict.fromkeys(study.evaluate, StatusKind.FAILED.value)
        return Outcome(self.layout, self.index, self.point, {}, {}, {}, 0, 0, 0, {}, {}, failed, message)


@dataclass(frozen=True)
class Cases:
    """All cases of a study in the order of the results, each constructed on access.

    The order is that of layouts, of indices, of the values of the first sweep, of the second.
    """

    layouts: tuple[str, ...]
    indices: tuple[str, ...]
    axes: tuple[tuple[float, ...], ...]  # the values of each sweep

    @cached_property
    def points(self) -> int:
        """Number of points of the sweeps."""
        return prod(map(len, self.axes))

    def __len__(self) -> int:
        return len(self.layouts) * len(self.indices) * self.points

    def __getitem__(self, number: int) -> Case:
        design, point = divmod(number, self.points)
        layout, index = divmod(design, len(self.indices))
        return Case(self.layouts[layout], self.indices[index], point, self.sweep_values(point))

    def sweep_values(self, point: int) -> tuple[float, ...]:
        """Value of each sweep at the point of that number."""
        values = []
        for axis in reversed(self.axes):
            point, place = divmod(point, len(axis))
            values.append(axis[place])
        return tuple(reversed(values))

    def __iter__(self) -> Iterator[Case]:
        return map(self.__getitem__, range(len(self)))

    def number(self, case: Case) -> int:
        """Number of a case in the order of the results, from 0."""
        return self._firsts[case.layout, case.index] + case.point

    @cached_property
    def _firsts(self) -> dict[tuple[str, str], int]:
        designs = product(self.layouts, self.indices)
        return {design: i * self.points for i, design in enumerate(designs)}


@dataclass(frozen=True)
class Outcome(PartResult):
    """The design of a case and its values; all of it survives JSON."""

    of = Case
    layout: str
    index: str
    point: int
    parameters: dict[str, float]
    active_bounds: dict[str, str]
    ranges: dict[str, tuple[float, float]]
    starts: int
    agreed: int
    evaluations: int
    values: dict[str, dict[str, float]]  # method -> index -> value, at this design
    standard_errors: dict[str, dict[str, float | None]]
    status: dict[str, str]  # method -> kind of status of the case's own index
    message: str = ""
    notes: list[list[str | float]] = field(default_factory=list)  # the parts of each: words, and numbers between them
    realisations: dict[str, int] = field(default_factory=dict)  # method -> roads of the case's own index
    samples: dict[str, list[float]] = field(default_factory=dict)  # method -> the first of its values on them
    controls: dict[str, list[float]] = field(default_factory=dict)  # method -> their control variates, and many more
    limits: list[list[Any]] = field(default_factory=list)  # of each: value, whether it holds back, its cost, its part
    over_linear: tuple[float, float] | None = None  # per cent below the best linear design, and the standard error
    error_bounds: dict[str, dict[str, float]] = field(default_factory=dict)  # relative, as `values`
    shared_errors: dict[str, dict[str, dict[str, tuple[float, ...]]]] = field(default_factory=dict)  # those of the road
    speeds: dict[str, list[dict[str, Any]]] = field(default_factory=dict)  # method -> as `at_other_speeds` has them
    speed_message: str = ""  # what makes those doubtful
    in_conditions: dict[str, list[dict[str, Any]]] = field(default_factory=dict)  # method -> own index in each
    numbers: dict[str, dict[str, Any]] = field(default_factory=dict)  # name -> value, error bound and status

    def feasible_values(self, method: str) -> dict[str, float]:
        """The indices of this design by a method; empty where no design satisfies the limits."""
        return {} if self.status.get(method) == StatusKind.INFEASIBLE.value else self.values.get(method, {})

    @property
    def kind(self) -> str:
        """The kind of its status: the first of all methods that is not ok."""
        return next((kind for kind in self.status.values() if kind != _OK), _OK)


def cases(study: Study) -> Cases:
    """All cases of a study."""
    return Cases(tuple(study.layouts), study.indices, tuple(sweep.values for sweep in study.sweeps))


def portable(study: Study) -> Study:
    """The study without its swept values, of which each case has its own: as small for a process as any."""
    return replace(study, sweeps=tuple(replace(sweep, values=()) for sweep in study.sweeps))


def run_case(study: Study, case: Case, threads: int = 1) -> Outcome:
    """Best design of one of the `cases`, evaluated by every method and index of the study; or its failure."""
    return run_part(study, {}, case, threads)


def design_notes(study: Study, mechanism: Mechanism) -> list[str]:
    """Notes on elements that the linear methods neglect in a design, and on a missing static equilibrium."""
    blind = [method for method in study.methods if is_blind(method)]
    left_out = linear_notes(mechanism) if blind else ()
    notes = [f"{_prefix(study, method)}{note}" for method in blind for note in left_out]
    if lacks_equilibrium(mechanism):
        notes.append(NO_EQUILIBRIUM)
    return notes


def lacks_equilibrium(mechanism: Mechanism) -> bool:
    """Whether springs leave a coordinate of a mechanism that carries a load without a position."""
    measures = mechanism.measures
    return bool(measures.load_input and measures.load_output) and not is_held_by_springs(mechanism)


def _prefix(study: Study, method: str) -> str:
    """Method in words with a colon, in front of its note; empty if the study has one method."""
    return f"{brief_words_of(method)}: " if len(study.methods) > 1 else ""


@dataclass(frozen=True)
class _BestDesign:
    """Vehicle of a case with its best values, the search that found them, and the limits that it was subject to."""

    vehicle: Vehicle
    search: Optimum | None = None  # None where no value is free, or none is to be optimised
    limits: list[list[Any]] = field(default_factory=list)
    statuses: tuple[Status, ...] = ()  # of the search, or of the limits where there is none


def _run(whole: Study, case: Case, threads: int) -> Outcome:
    study = whole.at(case.swept)
    best = _best_design(study, case, threads)
    estimates = _estimates(study, case, best, threads)
    own = {method: by_index[case.index] for method, by_index in estimates.items()}
    has_controls = study.baseline is not None and not whole.sweeps
    asks_speeds = is_at_one_speed(whole) and np.isfinite(own[study.evaluate[0]].value)
    notes = _notes(study, best.vehicle, own)
    speeds, speed_message = at_other_speeds(study, best.vehicle, case.layout, case.index) if asks_speeds else ({}, "")
    return Outcome(
        case.layout,
        case.index,
        case.point,
        **_search_fields(best.search),
        **_status_fields(own, best.statuses),
        values=_of_each(estimates, "value"),
        standard_errors=_of_each(estimates, "standard_error"),
        error_bounds=_of_each(estimates, "error_bound"),
        shared_errors=_of_each(estimates, "shared_errors"),
        notes=notes,
        realisations={m: e.realisations for m, e in own.items() if e.realisations},
        samples={m: list(e.samples[:_MOST_SAMPLES]) for m, e in own.items() if e.samples},
        controls={m: _controls(study, case, best, m, e, threads) for m, e in own.items()} if has_controls else {},
        limits=best.limits,
        speeds=speeds,
        speed_message=speed_message,
        in_conditions={m: list(map(_in_condition, e.in_conditions)) for m, e in own.items() if e.in_conditions},
        numbers={name: one.entry(study, best.vehicle) for name, one in DESIGN_NUMBERS.items()},
    )


def _best_design(study: Study, case: Case, threads: int) -> _BestDesign:
    """The design of a case with the lowest index within the limits; as it stands where nothing is to be optimised."""
    design = study.design(case.layout)
    vehicle = design if study.conditions else design.mechanism()  # whose numbers conditions change
    if study.optimise is None:
        return _BestDesign(vehicle)
    method, limits = study.method(study.optimise, threads), all_limits(study, case.layout)
    if vehicle.free_values():
        index = study.resolve_index(case.index, case.layout)
        with within("search", 0.0, _SEARCHED):
            found = optimise(vehicle, index, method, subject_to=limits, seed=study.seed)
        results = list(map(list, limit_results(study, case.layout, vehicle, found.limits)))
        return _BestDesign(found.design, found, results, (found.status,))
    if not limits:
        return _BestDesign(vehicle)
    held = constraints_at(vehicle, limits, method)
    results = list(map(list, limit_results(study, case.layout, vehicle, held)))
    return _BestDesign(vehicle, None, results, (broken(held), *(one.estimate.status for one in held)))


def _estimates(study: Study, case: Case, best: _BestDesign, threads: int) -> dict[str, dict[str, Estimate]]:
    """Value of each index of the study for a design, by each method that evaluates it.

    A method that fails leaves other methods their values, and an index those of the index of the case.
    """

    def estimate(method: str, index: str) -> Estimate:
        report(f"values by {method}", share=None if best.search is None else _SEARCHED)
        if best.search is not None and (method, index) == (study.optimise, case.index):
            return best.search.estimate
        try:
            return evaluate(best.vehicle, study.resolve_index(index, case.layout), study.method(method, threads))
        except FAILURES as error:
            if len(study.evaluate) == 1 and index == case.index:
                raise
            return Estimate(np.nan, "", Status(StatusKind.FAILED, str(error)))

    return {method: {index: estimate(method, index) for index in study.indices} for method in study.evaluate}


def _search_fields(found: Optimum | None) -> dict[str, Any]:
    """Fields of an outcome that tell of its search."""
    if found is None:
        return {"parameters": {}, "active_bounds": {}, "ranges": {}, "starts": 0, "agreed": 0, "evaluations": 0}
    over = found.gain_over_linear
    return {
        "parameters": found.parameters,
        "active_bounds": found.active_bounds,
        "ranges": found.ranges,
        "starts": found.n_starts,
        "agreed": found.n_converged,
        "evaluations": found.evaluations,
        "over_linear": (-over.percent, over.percent_error) if over is not None and over.second.status.ok else None,
    }


def _status_fields(own: Mapping[str, Estimate], searched: Sequence[Status]) -> dict[str, Any]:
    """Status by method, and the message of the worst one, with its method where there are several."""
    worst = worst_of((*(e.status for e in own.values()), *searched))
    by = "" if worst.ok or len(own) == 1 else next((m for m, e in own.items() if e.status == worst), "")
    kinds = {m: (worst if e.status.ok else worst_of((e.status, *searched))).kind.value for m, e in own.items()}
    message = f"{brief_words_of(by)}: {worst.message}" if by and worst.message else worst.message
    return {"status": kinds, "message": message}


def _notes(study: Study, vehicle: Vehicle, own: Mapping[str, Estimate]) -> list[list[str | float]]:
    """Notes of the estimates, then those on the design, each once and as its parts."""
    notes = [with_prefix(_prefix(study, method), note) for method, e in own.items() for note in e.notes]
    notes += map(parts_of, design_notes(study, vehicle.mechanism()))
    return list(map(list, dict.fromkeys(notes)))


def _controls(
    study: Study, case: Case, best: _BestDesign, method: str, estimate: Estimate, threads: int
) -> list[float]:
    """Control variates of an estimate of the case's own index; empty if there are none."""
    simulated, count = study.method(method, threads), estimate.realisations
    if not isinstance(simulated, AveragingMethod) or not 0 < count <= _MOST_SAMPLES:
        return []
    simulated = simulated.with_realisations(count, estimate.period)
    known = controls_of(best.vehicle, study.resolve_index(case.index, case.layout), simulated, count)
    return [] if known is None else np.concatenate(known).tolist()


def _of_each(estimates: Mapping[str, Mapping[str, Estimate]], name: str) -> dict[str, dict[str, Any]]:
    return {method: {index: getattr(e, name) for index, e in own.items()} for method, own in estimates.items()}


def _in_condition(estimate: Estimate) -> dict[str, Any]:
    """Value of an index in one condition with its errors, and the first of its values on random roads."""
    return {
        "value": estimate.value,
        "standard_error": estimate.standard_error,
        "error_bound": estimate.error_bound,
        "shared_errors": estimate.shared_errors,
        "samples": list(estimate.samples[:_MOST_SAMPLES]),
    }
