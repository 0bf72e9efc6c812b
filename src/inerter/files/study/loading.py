"""Reading a study file: TOML to a checked `Study`, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from inerter.files.common.entries import Amount
from inerter.files.common.layouts import StrutLayout, element_of, layout_problems, struts_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.suggest import nearest, some
from inerter.files.common.tables import Shape
from inerter.files.common.toml import read_tables, shape_of
from inerter.files.common.vehicles import values_of, vehicle_problems
from inerter.files.study.method_problems import method_problems
from inerter.files.study.shape import ROAD_EXAMPLE, StudyFile, SweepRange, shapes
from inerter.files.study.study import Study, Sweep, elements_used
from inerter.indices.registry import index_settings, is_on_road
from inerter.methods.registry import methods_that, searches
from inerter.networks.elements import Free
from inerter.signals.road import Road
from inerter.units import shown
from inerter.writing import characters

WHAT = "a study file"


def load_study(path: str | Path) -> Study:
    """The study in the TOML file at `path`.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    return study_of(read_tables(path, WHAT), path)


def study_of(tables: Mapping[str, Any], path: Path) -> Study:
    """The study that the tables of a file say; `path`, where they are from or may go to, is for messages and the title.

    Raises `StudyError` as `load_study` does.
    """
    study = _resolve(path, shape_of(tables, path, *shapes()))
    problems = [
        *vehicle_problems(study.model, study.vehicle),
        *layout_problems(study.model, study.vehicle, study.elements, study.layouts),
        *_road_problems(study),
        *_sweep_problems(study),
        *_setting_problems(study),
        *method_problems(study),
    ]
    if not problems:
        problems = list(_free_value_problems(study))
    if problems:
        raise refusal(path, problems)
    return study


def _resolve(path: Path, shape: StudyFile) -> Study:
    model, vehicle = values_of(shape.vehicle)
    layouts = {name: StrutLayout(struts_of(model, vehicle, entry)) for name, entry in shape.layouts.items()}
    settings = shape.study
    baseline = settings.baseline
    if baseline is None and len(layouts) > 1:
        baseline = next(iter(layouts))
    return Study(
        title=characters(path.stem) if shape.title is None else shape.title,
        path=path,
        model=model,
        vehicle=vehicle,
        road=None if shape.road is None else Road(**shape.road.model_dump(exclude={"letter"})),
        elements={name: element_of(name, entry) for name, entry in shape.elements.items()},
        layouts=layouts,
        indices=settings.indices,
        conventions=settings.conventions,
        optimise=settings.optimise,
        evaluate=settings.evaluate,
        baseline=baseline,
        sweep=None if settings.sweep is None else _sweep(*next(iter(settings.sweep.items()))),
        seed=settings.seed,
        realisations=settings.realisations,
        relative_error=settings.relative_error,
        settings={key: value for key in index_settings() if (value := getattr(settings, key)) is not None},
        method_settings=_method_settings(shape),
        budgets=settings.budgets,
    )


def _road_problems(study: Study) -> Iterator[Problem]:
    on_roads = [symbol for symbol in study.indices if is_on_road(symbol)]
    if study.road is None and on_roads:
        yield at(("road",), fault=f"missing, but {some(on_roads)} needs it", expected=ROAD_EXAMPLE)


def _method_settings(shape: StudyFile) -> dict[str, dict[str, float]]:
    """The section [methods], which is there if any method has settings of its own: by method, what is given."""
    section: Shape | None = getattr(shape, "methods", None)
    tables = {} if section is None else section.model_dump(by_alias=True)
    given = {n: {key: value for key, value in table.items() if value is not None} for n, table in tables.items()}
    return {name: table for name, table in given.items() if table}


def _sweep(name: str, entry: SweepRange | tuple[Amount, ...]) -> Sweep:
    if not isinstance(entry, SweepRange):
        return Sweep(name, tuple(amount.value for amount in entry), entry[0].unit)
    space = np.geomspace if entry.spacing == "log" else np.linspace
    values = space(entry.lower.value, entry.upper.value, entry.points)
    return Sweep(name, tuple(float(value) for value in values), entry.lower.unit)


def _sweep_problems(study: Study) -> Iterator[Problem]:
    sweep = study.sweep
    if sweep is None:
        return
    place, name = ("study", "sweep", sweep.element), sweep.element
    if name not in study.elements:
        missing = f"{shown(name)} is not in [elements], where there are {some(study.elements)}"
        yield at(place, fault=missing, hint=nearest(name, study.elements))
        return
    element = study.elements[name]
    if isinstance(element.value, Free):
        fixed = "an element with a fixed value"
        yield at(place, fault=f"{name} is free", expected=fixed, hint="Fix it, or leave the sweep out.")
    if element.unit != sweep.unit:
        other = f"{name} is in {element.unit}"
        yield at(place, got=f"values in {sweep.unit}", fault=other, expected=f"the unit of {name}")
    if name not in elements_used(study):
        unused = f"{name} is in no layout, so a sweep changes nothing"
        yield at(place, fault=unused, expected="an element that a layout uses")


def _setting_problems(study: Study) -> Iterator[Problem]:
    if study.baseline is not None and study.baseline not in study.layouts:
        known = some(study.layouts)
        hint = nearest(study.baseline, study.layouts)
        wanted = f"a layout, one of {known}"
        yield at(("study", "baseline"), got=shown(study.baseline), expected=wanted, hint=hint)


def _free_value_problems(study: Study) -> Iterator[Problem]:
    used = [name for name in elements_used(study) if isinstance(study.elements[name].value, Free)]
    if used and study.optimise is None:
        method = shown(methods_that(searches)[0])
        yield at(
            ("study", "optimise"),
            fault=f"missing, but there are free values, {some(used)}",
            expected=f"optimise = {method}, or fixed values",
        )
    if not used and study.optimise is not None:
        yield at(
            ("study", "optimise"),
            got=shown(study.optimise),
            fault="no layout has a free value",
            expected='one such as c = { from = "100 N s/m", to = "100 kN s/m" } in [elements], or no optimise',
        )
