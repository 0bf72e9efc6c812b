"""One design of a study with numbers only: the best one for an index, from a result folder or by a search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import xarray as xr

from inerter.errors import StudyError, WorkError
from inerter.files.common.listing import check_unchanged
from inerter.files.common.problems import refusal
from inerter.files.common.suggest import nearest, some
from inerter.files.study.cases import Case, cases, run_case
from inerter.files.study.loading import load_study, unchosen_problems
from inerter.files.study.running import DATASET, RESOLVED
from inerter.files.study.study import Study
from inerter.indices.definition import Index
from inerter.units import quote_value
from inerter.vehicle.vehicle import Vehicle

WITHOUT_CONDITIONS = "the vehicle and road are those of the file itself, not of one of its conditions"
CHOOSE_ONE = "--condition chooses one"


@dataclass(frozen=True, eq=False)
class ChosenDesign:
    """A design of a study: the case whose optimum it is, and where its numbers are from.

    `condition` is the number of the operating condition, from 0, whose numbers it has.
    """

    study: Study
    case: Case
    source: Path
    inputs: tuple[Path, ...]  # files that were read
    condition: int | None = None

    @property
    def name(self) -> str:
        """Layout, and index, point and condition where they tell designs apart."""
        is_free = bool(self.study.design(self.case.layout).free_values())
        parts = [self.case.layout, *([self.case.index] if is_free else [])]
        parts += [f"point-{self.case.point + 1}"] if self.study.sweeps else []
        return "-".join([*parts, *([] if self.condition is None else [f"condition-{self.condition + 1}"])])

    @property
    def conditions_text(self) -> str:
        """The operating condition whose numbers the vehicle and the road have, in words; empty without conditions."""
        if not self.study.conditions:
            return ""
        if self.condition is None:
            return "with the numbers outside the conditions"
        return f"in condition {self.study.condition_labels[self.condition]}"

    @cached_property
    def study_there(self) -> Study:
        """The study with the numbers of the swept point and of the condition."""
        there = self.study.at(self.case.swept)
        return there if self.condition is None else there.in_condition(self.condition)

    @property
    def index(self) -> Index:
        """The index of the case on the road of the swept point and of the condition."""
        return self.study_there.index(self.case.index)

    def vehicle(self) -> Vehicle:
        """The vehicle with numbers only; of a study file with free values they are found by its search.

        Raises `StudyError` for results without them, `WorkError` where the search finds none.
        """
        vehicle = self.study_there.design(self.case.layout)
        if not vehicle.free_values():
            return vehicle
        values = (
            _read(self.source, self.study, self.case) if self.source.is_dir() else _search_values(self.study, self.case)
        )
        return vehicle.with_values({name: values[name] for name in vehicle.free_values()})


def chosen_design(
    source: Path, layout: str | None, index: str | None, point: int | None, condition: str | None
) -> ChosenDesign:
    """The design of a layout of a study file, or of a folder of results; the best one for an index if values are free.

    `point` numbers the swept values from 1; `condition` is the name or number of an operating condition.

    Raises `StudyError` for a source that is neither, and for an unknown or missing layout, index, point or condition.
    """
    return _chosen_design(_load(source), source, layout, index, point, condition)


def chosen_designs(
    source: Path, layouts: Sequence[str], index: str | None, point: int | None, condition: str | None
) -> dict[str, ChosenDesign]:
    """The designs of some layouts by their names, all without `layouts`, as `chosen_design` has one."""
    study = _load(source)
    return {name: _chosen_design(study, source, name, index, point, condition) for name in layouts or study.layouts}


def load_results(source: Path, variables: Sequence[str] | None = None) -> xr.Dataset:
    """Dataset of a folder of results, or some of its variables.

    Raises `StudyError` if there is none, or it cannot be read, or was edited.
    """
    check_unchanged(source, DATASET)
    try:
        with xr.open_dataset(source / DATASET, engine="h5netcdf") as data:
            return (data if variables is None else data[list(variables)]).load()
    except (OSError, KeyError, ValueError) as error:
        raise StudyError(f"{source / DATASET}: cannot be read as results ({error}).") from None


def _load(source: Path) -> Study:
    if source.is_dir():
        check_unchanged(source, RESOLVED)
    study = load_study(source / RESOLVED if source.is_dir() else source)
    if problems := list(unchosen_problems(study)):
        raise refusal(study.path, problems)
    return study


def _chosen_design(
    study: Study, source: Path, layout: str | None, index: str | None, point: int | None, condition: str | None
) -> ChosenDesign:
    chosen = _choose("layout", layout, list(study.layouts), source)
    is_free = bool(study.design(chosen).free_values())
    asked = _choose("index", index, list(study.indices), source) if is_free or index else study.indices[0]
    every = cases(study)
    number = _point(point, every.points, study, source)
    case = Case(chosen, asked, number, every.sweep_values(number))
    inputs = (*study.inputs, source / DATASET) if source.is_dir() else study.inputs
    return ChosenDesign(study, case, source, inputs, _condition(condition, study, source))


def _choose(what: str, given: str | None, known: list[str], source: Path) -> str:
    if given is None:
        if len(known) == 1:
            return known[0]
        plural = {"layout": "layouts", "index": "indices"}[what]
        raise StudyError(f"{source}: has several {plural}, {some(known)}. Choose one with --{what}.")
    if given not in known:
        raise StudyError(f"{source}: has no {what} {quote_value(given)}, but {some(known)}.{nearest(given, known)}")
    return given


def _point(point: int | None, count: int, study: Study, source: Path) -> int:
    if not study.sweeps:
        if point is not None:
            raise StudyError(f"{source}: has no sweep, and so no points. Leave --point out.")
        return 0
    if point is None or not 1 <= point <= count:
        given = "" if point is None else f", got {point}"
        swept = some([sweep.label for sweep in study.sweeps])
        raise StudyError(f"{source}: sweeps {swept}. Choose a point with --point, 1 to {count}{given}.")
    return point - 1


def _condition(given: str | None, study: Study, source: Path) -> int | None:
    labels = study.condition_labels
    if given is None:
        return None
    if not labels:
        raise StudyError(f"{source}: has no conditions. Leave --condition out.")
    if given not in labels:
        raise StudyError(
            f"{source}: has no condition {quote_value(given)}, but {some(labels)}.{nearest(given, labels)}"
        )
    return labels.index(given)


def _search_values(study: Study, case: Case) -> dict[str, float]:
    """Values found by the search of the study."""
    assert study.optimise is not None
    outcome = run_case(replace(study, evaluate=(study.optimise,)), case)
    if not outcome.parameters:
        raise WorkError(f"{study.path}: no values found for {case.name} ({outcome.message}).")
    return outcome.parameters


def _read(folder: Path, study: Study, case: Case) -> dict[str, float]:
    """Values of the results in a folder."""
    found = load_results(folder, ["parameter_value"])["parameter_value"]
    at = np.unravel_index(case.point, tuple(len(sweep.values) for sweep in study.sweeps)) if study.sweeps else ()
    place = {sweep.label: int(i) for sweep, i in zip(study.sweeps, at, strict=True)}
    try:
        row = found.sel(layout=case.layout, index=case.index).isel(place)
        values = {str(name): float(value) for name, value in zip(row["parameter"].values, row.values, strict=True)}
    except (KeyError, IndexError, ValueError):
        raise StudyError(f"{folder}: the results do not belong to the study in it. Run the study again.") from None
    known = study.free_units
    if any(np.isnan(values.get(name, np.nan)) for name in known if name in study.design(case.layout).free_values()):
        raise StudyError(f"{folder}: has no values for {case.name}; its status there has the reason.")
    return values
