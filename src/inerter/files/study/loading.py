"""Reading a study file: TOML to a checked `Study`, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from inerter.errors import StudyError
from inerter.files.common.elements import free_networks_in, with_tied_values
from inerter.files.common.free_networks import EXAMPLE_LINE
from inerter.files.common.layouts import layout_problems
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.roads import MeasuredLine, line_through, road_of, track_problems, without_source
from inerter.files.common.suggest import nearest, some
from inerter.files.common.titles import title_of
from inerter.files.common.toml import read_tables, value_of
from inerter.files.common.vehicles import tracks, vehicle_problems
from inerter.files.study.limits import limits_of
from inerter.files.study.method_problems import method_problems
from inerter.files.study.own_indices import bare_index_problems, own_index_problems
from inerter.files.study.places import free_in_vehicle
from inerter.files.study.quantity_texts import texts_of
from inerter.files.study.reference_checks import name_problems
from inerter.files.study.scatter import tolerance_of
from inerter.files.study.sections import ROAD_EXAMPLE, study_codec
from inerter.files.study.study import Study, elements_used, searched_layouts
from inerter.files.study.sweeps import conditions_of, sweeps_of
from inerter.files.study.tasks import tasks
from inerter.methods.registry import methods_that, searches
from inerter.networks.elements import Element, Free
from inerter.units import quote_value
from inerter.validation import checked

WHAT = "a study file"


@checked(StudyError)
def load_study(path: str | Path) -> Study:
    """The study in the TOML file at `path`.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.

    >>> import inerter as it
    >>> from inerter.files.study.starting import starting_text
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "car.toml"
    ...     _ = path.write_text(starting_text("quarter-car"))  # as `inerter new` writes it
    ...     study = it.load_study(path)
    >>> study.model, list(study.layouts)
    ('quarter-car', ['S1', 'S2', 'S3'])
    """
    path = Path(path)
    return study_of(read_tables(path, WHAT), path)


def study_of(tables: Mapping[str, Any], path: Path) -> Study:
    """Study from the tables of a file; `path` is used in messages and for the title.

    Raises `StudyError` as `load_study` does.
    """
    found = value_of(study_codec(), tables, path)
    elements, element_problems = with_tied_values(found["elements"])
    line, line_problems = line_through(found["road"], path)
    study = replace(_resolve(path, found, elements, line), texts=texts_of(tables))
    asked = found["study"]
    problems = [
        *element_problems,
        *vehicle_problems(study.vehicle),
        *layout_problems({**study.elements, **study.free_networks}, study.layouts),
        *line_problems,
        *_road_problems(study),
    ]
    unclear = [*_index_problems(study, asked["limits"]), *(() if problems else name_problems(study))]
    if unclear:  # what is asked is not known yet, and so what may be wrong with the rest
        raise refusal(path, [*problems, *unclear])
    limits, limit_problems = limits_of(study, asked["limits"] or {})
    study = replace(study, limits=limits)
    swept, sweep_problems = ((), []) if asked["sweeps"] == () else sweeps_of(study, asked["sweeps"])
    study = replace(study, sweeps=swept)
    conditions, condition_problems = conditions_of(study, found["conditions"])
    spread, spread_problems = tolerance_of(study, asked["tolerance"])
    study = replace(study, conditions=conditions, tolerance=spread)
    problems += [
        *sweep_problems,
        *condition_problems,
        *limit_problems,
        *spread_problems,
        *_setting_problems(study, tables["study"]),
        *own_index_problems(study.indices, study.own_indices, [*study.trade_off, *(limit.of for limit in limits)]),
        *(problem for task in tasks() for problem in task.problems(study, tables["study"])),
        *method_problems(study),
    ]
    if not problems:
        problems = list(_free_value_problems(study))
    if problems:
        raise refusal(path, problems)
    return study


def unchosen_problems(study: Study) -> Iterator[Problem]:
    """Problems of layouts with free networks, which are not designs and only for a search."""
    for layout, names in searched_layouts(study).items():
        what = f"{some(names)} is a free network" if len(names) == 1 else f"{some(names)} are free networks"
        hint = f"Find the best network with: inerter search {study.path.name}."
        yield at(("layouts", layout), fault=f"{what}, not a design yet", expected="elements", hint=hint)


def _resolve(path: Path, found: Mapping[str, Any], elements: dict[str, Element], line: MeasuredLine | None) -> Study:
    """The study, but for what is said by places of it."""
    settings = {**found["study"], "sweeps": (), "limits": (), "tolerance": {}}
    if settings["baseline"] is None and len(found["layouts"]) > 1:
        settings["baseline"] = next(iter(found["layouts"]))
    road = found["road"] and without_source(found["road"], line)
    return Study(
        title=title_of(found, path),
        path=path,
        vehicle=found["vehicle"],
        road=None if road is None else road_of(road, None if line is None else line.road.shape),
        coherence=(road and road["coherence"]) or {},
        line=line,
        elements=elements,
        free_networks=free_networks_in(found["elements"]),
        layouts=found["layouts"],
        own_indices=dict(found["indices"]),
        method_settings={name: table for name, table in found.get("methods", {}).items() if table},
        **settings,
    )


def _road_problems(study: Study) -> Iterator[Problem]:
    if study.coherence:
        yield from track_problems(("road", "coherence"), tracks(study.vehicle))


def _index_problems(study: Study, limits: Iterable[str]) -> Iterator[Problem]:
    """Problems of indices without a required setting or road."""
    limited = [name for name in limits if study.knows(name)]
    asked = list(dict.fromkeys([*study.indices, *study.trade_off, *limited]))
    yield from bare_index_problems(asked)
    on_roads = [name for name in asked if study.needs_road(name)]
    if study.road is None and on_roads:
        need = "needs" if len(on_roads) == 1 else "need"
        yield at(("road",), fault=f"missing, but {some(on_roads)} {need} it", expected=ROAD_EXAMPLE)


def _setting_problems(study: Study, given: Collection[str]) -> Iterator[Problem]:
    if "conditions" in given and not study.conditions:
        place, wanted = ("study", "conditions"), "sections [[conditions]], or no conditions in [study]"
        yield at(place, got=quote_value(study.over), fault="there are none", expected=wanted)
    if study.real_inerters is not None and not study.free_networks:
        wanted = f"{EXAMPLE_LINE}, or no real_inerters"
        yield at(("study", "real_inerters"), fault="no element is a free network", expected=wanted)
    if study.baseline is not None and study.baseline not in study.layouts:
        known = some(study.layouts)
        hint = nearest(study.baseline, study.layouts)
        wanted = f"a layout, one of {known}"
        yield at(("study", "baseline"), got=quote_value(study.baseline), expected=wanted, hint=hint)


def _free_value_problems(study: Study) -> Iterator[Problem]:
    named = elements_used(study)
    used = [name for name in named if name in study.free_networks or isinstance(study.elements[name].value, Free)]
    in_vehicle = free_in_vehicle(study)
    for name in (name for name in in_vehicle if name in study.elements):
        keys = ("vehicle", *in_vehicle[name][0].key.split("."))
        yield at(keys, fault=f"free, and there is an element {name} too", expected="another name of the element")
    used += in_vehicle
    if used and study.optimise is None:
        method = quote_value(methods_that(searches)[0])
        yield at(
            ("study", "optimise"),
            fault=f"missing, but there are free values, {some(used)}",
            expected=f"optimise = {method}, or fixed values",
        )
    if not used and study.optimise is not None:
        yield at(
            ("study", "optimise"),
            got=quote_value(study.optimise),
            fault="no layout has a free value",
            expected='one such as c = { from = "100 N s/m", to = "100 kN s/m" } in [elements], or no optimise',
        )
