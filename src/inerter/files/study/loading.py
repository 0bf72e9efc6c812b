"""Reading a study file: TOML to a checked `Study`, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from inerter.files.common.layouts import StrutLayout, elements_of, layout_problems, struts_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.roads import MeasuredLine, coherence_of, coherence_values, line_through, track_problems
from inerter.files.common.suggest import nearest, some
from inerter.files.common.tables import Shape
from inerter.files.common.toml import read_tables, shape_of
from inerter.files.common.vehicles import tracks, values_of, vehicle_problems
from inerter.files.study.conditions import OVER
from inerter.files.study.limits import limits_of
from inerter.files.study.method_problems import method_problems
from inerter.files.study.named import name_problems
from inerter.files.study.own_indices import bare_index_problems, own_index, own_index_problems
from inerter.files.study.shape import ROAD_EXAMPLE, StudyFile, shapes
from inerter.files.study.study import POINTS, Study, elements_used
from inerter.files.study.sweeps import conditions_of, sweeps_of
from inerter.files.study.tolerances import tolerance_of
from inerter.files.study.written import texts_of
from inerter.indices.registry import index_settings
from inerter.methods.registry import methods_that, searches
from inerter.networks.elements import Free
from inerter.signals.road import Road
from inerter.units import shown
from inerter.writing import characters

_LEAST_OF_THREE = 6  # points of a front of three indices
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
    shape = shape_of(tables, path, *shapes())
    line, line_problems = line_through(shape.road, path)
    study = replace(_resolve(path, shape, line), texts=texts_of(tables))
    problems = [
        *elements_of(shape.elements)[1],
        *vehicle_problems(study.model, study.vehicle),
        *layout_problems(study.model, study.vehicle, study.elements, study.layouts),
        *line_problems,
        *_road_problems(study),
    ]
    unclear = [*_index_problems(study, shape), *(() if problems else name_problems(study))]
    if unclear:  # what is asked is not known yet, and so what may be wrong with the rest
        raise refusal(path, [*problems, *unclear])
    limits, limit_problems = limits_of(study, shape.study.subject_to or {})
    study = replace(study, limits=limits)
    swept, sweep_problems = ((), []) if shape.study.sweep is None else sweeps_of(study, shape.study.sweep)
    study = replace(study, sweeps=swept)
    conditions, condition_problems = conditions_of(study, shape.conditions)
    spread, spread_problems = tolerance_of(study, shape.study.tolerance or {})
    study = replace(study, conditions=conditions, tolerance=spread)
    problems += [
        *sweep_problems,
        *condition_problems,
        *limit_problems,
        *spread_problems,
        *_setting_problems(study, shape),
        *own_index_problems(study.indices, study.own_indices, [*study.trade_off, *(limit.of for limit in limits)]),
        *_front_problems(study, shape),
        *_scatter_problems(study),
        *method_problems(study),
    ]
    if not problems:
        problems = list(_free_value_problems(study))
    if problems:
        raise refusal(path, problems)
    return study


def _resolve(path: Path, shape: StudyFile, line: MeasuredLine | None) -> Study:
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
        road=_road(shape, line),
        coherence=coherence_values(shape.road),
        line=line,
        elements=elements_of(shape.elements)[0],
        layouts=layouts,
        indices=settings.indices,
        conventions=settings.conventions,
        optimise=settings.optimise,
        evaluate=settings.evaluate,
        baseline=baseline,
        seed=settings.seed,
        realisations=settings.realisations,
        relative_error=settings.relative_error,
        settings={key: value for key in index_settings() if (value := getattr(settings, key)) is not None},
        own_indices={name: own_index(entry) for name, entry in shape.indices.items()},
        over=settings.conditions or OVER[0],
        method_settings=_method_settings(shape),
        trade_off=settings.trade_off,
        points=settings.points or POINTS,
        quantile=settings.quantile,
        budgets=settings.budgets,
    )


def _road(shape: StudyFile, line: MeasuredLine | None) -> Road | None:
    if shape.road is None:
        return None
    roughness = shape.road.roughness if line is None else line.roughness
    measured = None if line is None else line.shape
    return Road(roughness, shape.road.speed, coherence_of(coherence_values(shape.road)), measured)


def _road_problems(study: Study) -> Iterator[Problem]:
    if study.coherence:
        yield from track_problems(("road", "coherence"), tracks(study.model, study.vehicle))


def _index_problems(study: Study, shape: StudyFile) -> Iterator[Problem]:
    """What indices lack that cannot be without it: settings, a road."""
    limited = [name for name in shape.study.subject_to or {} if study.knows(name)]
    asked = list(dict.fromkeys([*study.indices, *study.trade_off, *limited]))
    yield from bare_index_problems(asked)
    on_roads = [name for name in asked if study.needs_road(name)]
    if study.road is None and on_roads:
        need = "needs" if len(on_roads) == 1 else "need"
        yield at(("road",), fault=f"missing, but {some(on_roads)} {need} it", expected=ROAD_EXAMPLE)


def _method_settings(shape: StudyFile) -> dict[str, dict[str, float]]:
    """The section [methods], which is there if any method has settings of its own: by method, what is given."""
    section: Shape | None = getattr(shape, "methods", None)
    tables = {} if section is None else section.model_dump(by_alias=True)
    given = {n: {key: value for key, value in table.items() if value is not None} for n, table in tables.items()}
    return {name: table for name, table in given.items() if table}


def _setting_problems(study: Study, shape: StudyFile) -> Iterator[Problem]:
    if shape.study.conditions is not None and not study.conditions:
        place, wanted = ("study", "conditions"), "sections [[conditions]], or no conditions in [study]"
        yield at(place, got=shown(shape.study.conditions), fault="there are none", expected=wanted)
    if study.baseline is not None and study.baseline not in study.layouts:
        known = some(study.layouts)
        hint = nearest(study.baseline, study.layouts)
        wanted = f"a layout, one of {known}"
        yield at(("study", "baseline"), got=shown(study.baseline), expected=wanted, hint=hint)


def _scatter_problems(study: Study) -> Iterator[Problem]:
    if study.quantile is not None and not study.tolerance:
        yield at(("study", "quantile"), fault="nothing scatters", expected="a tolerance, or no quantile")
    if study.tolerance and study.sweeps:
        yield at(("study", "tolerance"), fault="given beside a sweep", expected="one of the two")


def _front_problems(study: Study, shape: StudyFile) -> Iterator[Problem]:
    place = ("study", "trade_off")
    if shape.study.points is not None and not study.trade_off:
        yield at(("study", "points"), fault="there is no front", expected="trade_off, or no points")
    if not study.trade_off:
        return
    several = len({study.index(name) for name in study.trade_off})  # which may be one by two names
    if several not in (2, 3) or several < len(study.trade_off):
        got = f"{len(study.trade_off)} indices" if several == len(study.trade_off) else "the same index twice"
        yield at(place, got=got, expected="two or three that differ")
    if several == 3 and study.points < _LEAST_OF_THREE:
        few = f"at least {_LEAST_OF_THREE} points for three indices"
        yield at(("study", "points"), got=str(study.points), expected=few)
    if study.sweeps:
        yield at(place, fault="given beside a sweep", expected="one of the two")
    if study.optimise is None:
        yield at(place, fault="nothing is optimised", expected="optimise, or no trade_off")


def _free_value_problems(study: Study) -> Iterator[Problem]:
    used = [name for name in elements_used(study) if isinstance(study.elements[name].value, Free)]
    used += [name for name, value in study.vehicle.items() if isinstance(value, Free)]
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
