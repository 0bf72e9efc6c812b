"""Checks of a study before the run: whether every design can be analysed, and notes on the designs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from inerter.errors import InerterError, StudyError
from inerter.files.common.free_networks import EXAMPLE_LINE
from inerter.files.common.problem import at
from inerter.files.common.problems import refusal
from inerter.files.common.suggest import some
from inerter.files.study.cases import Cases, cases, design_notes
from inerter.files.study.limits import all_limits, limited_definitions
from inerter.files.study.loading import study_of, unchosen_problems
from inerter.files.study.notes import road_notes
from inerter.files.study.plausibility import input_warnings, roads_sentences
from inerter.files.study.study import Study, elements_used, searched_layouts
from inerter.files.study.tasks import tasks
from inerter.formatting import format_count, format_list, format_number
from inerter.methods.composite_index import objective_of, without_tied_values
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.methods.method import AveragingMethod, MethodWithChecks, MethodWithKernels, constituents_of
from inerter.methods.registry import is_blind
from inerter.network_search.plan import SearchPlan, plan_search
from inerter.networks.elements import middle
from inerter.optimisation.limits import bounds_of
from inerter.optimisation.optimise import check_free, most_simulated
from inerter.systems.descriptor import linear_notes
from inerter.systems.piecewise import piecewise
from inerter.uncertainty.distributions import DISTRIBUTIONS, nominal, scatter_of
from inerter.vehicle.vehicle import Vehicle

_MOST_TRIED = 200  # swept values
_NOT_SEARCHED = {"sweeps": "sweep", "budgets": "break_even", "tolerance": "tolerance"}


_sound: Study | None = None  # the last one without problems: who checks before a run may tell how far that is


def check_lines(tables: Mapping[str, Any], path: Path) -> Iterator[str]:
    """Sentences about a valid study file: its size, its roads, warnings and notes.

    Raises `StudyError` as `load_study` and `check_study` do.
    """
    study = study_of(tables, path)
    if searched_layouts(study):
        size, notes = _search_size(study), road_notes(study)
    else:
        check_study(study)
        size, notes = _study_size(study), study_notes(study)
    yield f"{path}: ok. {study.model}; layouts {some(study.layouts)}; indices {', '.join(study.indices)}{size}."
    yield from roads_sentences(study)
    yield from input_warnings(study)
    yield from () if searched_layouts(study) else _search_warning(study)
    for task in () if searched_layouts(study) else tasks():
        yield from task.warnings(study)
    yield from (f"Note: {note}." for note in notes)


def _search_warning(study: Study) -> Iterator[str]:
    """Warning on a search that simulates every design that it tries, as one with friction or gaps."""
    if study.optimise is None or not isinstance(study.method(study.optimise), AveragingMethod):
        return
    designs = {name: study.design(name) for name in study.layouts}
    simulated = {
        name: most_simulated(len(design.free_values()), bool(study.limits))
        for name, design in designs.items()
        if linear_notes(design.mechanism()) and design.free_values()
    }
    if simulated:
        several = math.prod(len(sweep.values) for sweep in study.sweeps) * max(len(study.conditions), 1)
        most = sum(simulated.values()) * len(study.indices) * several
        yield (
            f"Warning: to optimise {format_list(list(simulated))}, {study.optimise} simulates up to "
            f"{format_number(most)} designs, each on all of its roads. One takes some 50 ms for a quarter car with "
            f"friction, and up to seconds for several axles with gaps."
        )


def _study_size(study: Study) -> str:
    """Clause on the numbers of designs and of parts of tasks."""
    counts = {task.items or task.key: len(task.parts(study)) for task in tasks()}
    further = "".join(f", and {format_count(number, kind)}" for kind, number in counts.items() if number)
    swept = "".join(f", {sweep.label} at {format_count(len(sweep.values), 'values')}" for sweep in study.sweeps)
    designs = format_count(len(cases(study)), "designs")
    return f"{swept}: {designs} to {'find' if study.optimise else 'judge'}{further}"


def _search_size(study: Study) -> str:
    """Clause on the number of networks that a search of a study with free networks compares."""
    plans = search_plans(study)
    counts = {layout: len(plan.topologies) for (layout, _), plan in plans.items()}
    networks = ", ".join(f"{format_count(count, 'networks')} of {layout}" for layout, count in counts.items())
    return (
        f": {networks} to search for each index{', and for their Pareto front' if study.trade_off else ''}"
        f"{', and the best with real inerters' if study.real_inerters is not None else ''}"
    )


def check_study(study: Study, tell: Callable[[int, int], object] = lambda done, total: None) -> None:
    """Assemble every layout for every index over the swept values, so that what is ill-posed shows before any work.

    Of many swept values some are tried, with the least and the largest: whether a design can be analysed rests on the
    way it is joined rather than on its numbers, and one that cannot has a status that says so. `tell` is called before
    each, with how many are assembled and how many there are. A study that was checked just before is not again.

    Raises `StudyError` with a line for every layout that cannot be analysed, or has a free network.
    """
    global _sound  # noqa: PLW0603
    if study is _sound:
        return
    if not isinstance(study, Study):
        raise StudyError(f'Expected a study, such as load_study("my-car.toml"), got {study!r}.')
    problems = list(unchosen_problems(study))
    every = cases(study)
    tried = () if problems else _points_to_check(every)
    for number, layout in enumerate(study.layouts):
        for done, point in enumerate(tried, start=number * len(tried)):
            tell(done, len(tried) * len(study.layouts))
            try:
                _check_design(study.at(every.sweep_values(point)), layout)
            except InerterError as error:
                problems.append(at(("layouts", layout), str(error)))
                break
    if problems:
        raise refusal(study.path, problems)
    _sound = study


def search_plans(study: Study) -> dict[tuple[str, str], SearchPlan]:
    """Plan of the search by layout and index, once every layout was checked.

    Raises `StudyError` with a line for every problem.
    """
    searched, problems = searched_layouts(study), []
    if not searched:
        problems.append(at(("layouts",), fault="no layout has a free network to search", expected=EXAMPLE_LINE))
    for attribute, key in _NOT_SEARCHED.items():
        if getattr(study, attribute):
            problems.append(at(("study", key), fault="a search over networks does not use it", expected=f"no {key}"))
    plans: dict[tuple[str, str], SearchPlan] = {}
    if not problems:
        check_study(fixed_part(study))
        for layout in searched:
            try:
                asked = dict.fromkeys([*study.indices, *study.trade_off])
                plans |= {(layout, index): _plan(study, layout, index) for index in asked}
            except InerterError as error:
                problems.append(at(("layouts", layout), str(error)))
    if problems:
        raise refusal(study.path, problems)
    return plans


def fixed_part(study: Study) -> Study:
    """The study with the layouts alone that have no free network."""
    searched = searched_layouts(study)
    return replace(study, layouts={name: one for name, one in study.layouts.items() if name not in searched})


def _plan(study: Study, layout: str, index: str) -> SearchPlan:
    assert study.optimise is not None
    limits = all_limits(study, layout)
    vehicle, method = study.design(layout), study.method(study.optimise)
    return plan_search(vehicle, study.resolve_index(index, layout), method, limits, study.seed)


def _points_to_check(every: Cases) -> list[int]:
    """All of some points; of many the ends, those of the extremes of each sweep, and others evenly between."""
    tried = {*np.linspace(0, every.points - 1, min(every.points, _MOST_TRIED), dtype=int).tolist()}
    if len(tried) < every.points:
        corners = product(*((int(np.argmin(axis)), int(np.argmax(axis))) for axis in every.axes))
        tried |= {int(np.ravel_multi_index(corner, [len(axis) for axis in every.axes])) for corner in corners}
    return sorted(tried)


def _check_design(study: Study, layout: str) -> None:
    vehicle = study.design(layout)
    loose = without_tied_values(vehicle)
    over = [study.over_conditions(name) for name in study.indices]
    each = [one for index in over for one in constituents_of(loose.vehicle if loose else vehicle, index)]
    definitions = [(case.mechanism(), index.definition(case.mechanism())) for case, index in each]
    if any(map(is_blind, study.methods)):
        for mechanism, definition in definitions:
            linear_problem(mechanism, definition, CONVENTIONS[study.conventions])
    if spread := study.spread(layout):
        nominal(vehicle, scatter_of(spread, DISTRIBUTIONS[0]))
    halfway = {name: middle(value) for name, value in vehicle.free_values().items()}
    if not all(map(is_blind, study.methods)):
        piecewise(vehicle.with_values(halfway))
    for method in map(study.method, study.evaluate):
        if isinstance(method, MethodWithChecks):
            for index in over:
                for case, one in constituents_of(vehicle.with_values(halfway), index):
                    method.check(case, one)
    if study.optimise is not None and vehicle.free_values():
        check_free(vehicle)
        method = replace(study, relative_error=None).method(study.optimise)  # which would take simulations
        for name in study.indices:
            objective_of(vehicle, study.resolve_index(name, layout), method)
        bounds_of(vehicle, all_limits(study, layout), method)


def study_notes(study: Study) -> list[str]:
    """Notes before the run: measured road, elements that linear methods neglect, and elements not in use."""
    notes: dict[str, list[str]] = {}
    for layout in study.layouts:
        for note in design_notes(study, study.design(layout).mechanism()):
            notes.setdefault(note, []).append(layout)
    used = elements_used(study)
    unused = [name for name in study.elements if name not in used]
    return [
        *road_notes(study),
        *(f"{some(layouts)}: {note}" for note, layouts in notes.items()),
        *([f"no layout uses {some(unused)}"] if unused else []),
    ]


def kernels(study: Study, design: Vehicle | None = None) -> list[Any]:
    """The compiled code that the work calls, what takes longest to compile first.

    `design` is any of its designs; default: that of the first layout.
    """
    found: list[Any] = []
    limited = bool(study.limits or study.trade_off)
    design = study.design(next(iter(study.layouts))) if design is None else design
    for name in study.methods:
        method = study.method(name)
        if isinstance(method, MethodWithKernels):
            definitions = [study.index(index).definition(design.mechanism()) for index in study.indices]
            for definition in [*definitions, *limited_definitions(study, design)]:
                found += method.kernels(definition, search=design if name == study.optimise else None, limited=limited)
    return list(dict.fromkeys(found))
