"""Study documents: the tables of a study file as JSON holds them, read, checked and written."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import FileError, refusal
from inerter.files.common.toml import tables_of
from inerter.files.study.loading import WHAT, study_of, unchosen_problems
from inerter.files.study.study import Study
from inerter.report.json_data import json_data
from inerter.units import quote_value

Document = Mapping[str, Any]
_Stamp = tuple[int, int] | None
PATH = Path("study.toml")  # what a document is called that is no file
_LAYOUTS = "layouts"
_REQUIRED = {"run": {"vehicle", _LAYOUTS, "study"}, "simulate": {"vehicle", "elements", _LAYOUTS, "signal"}}
_NUMBER = re.compile(r"[0-9]+")
_KEPT = 256  # documents whose studies are kept


def read(text: str, name: str = "") -> dict[str, Any]:
    """The document that a text of TOML says, with its kind and its problems; null where it is no TOML."""
    path = Path(Path(name).name or PATH)
    try:
        document = _with_baseline(_plain(tables_of(text.encode("utf-8", "surrogatepass"), path, WHAT)))
    except InerterError as error:
        return {"study": None, "kind": "", "problems": problems_of(error)}
    return {"study": document, "kind": command_of(document), "problems": problems(document)}


def command_of(document: Document) -> str:
    """Command for a document that has what its kind of file requires; empty for any other."""
    return next((command for command, sections in _REQUIRED.items() if sections <= set(document)), "")


def _with_baseline(document: dict[str, Any]) -> dict[str, Any]:
    """The document with its baseline by name where a layout is called like a number.

    Objects of JavaScript have such keys first, in the order of the numbers: the first layout, which is the baseline of
    a file that names none, would become another one.
    """
    layouts, settings = document.get(_LAYOUTS), document.get("study", {})
    if not isinstance(layouts, dict) or not isinstance(settings, dict) or "baseline" in settings:
        return document
    if not any(_NUMBER.fullmatch(name) for name in layouts):
        return document
    return {**document, "study": {**settings, "baseline": next(iter(layouts))}}


def problems(document: object) -> list[dict[str, Any]]:
    """Problems of a document that prevent its use as a study, or its search, each with its place."""
    try:
        searched_study_from(document)
    except InerterError as error:
        return problems_of(error)
    return []


def study_from(document: object) -> Study:
    """Study of a document; raises `StudyError` with a problem for every entry that does not fit.

    A layout with a free network is a problem too.
    """
    study = searched_study_from(document)
    here = "In the workbench: Jobs, Search for the best network."
    if unchosen := [replace(problem, hint=f"{problem.hint} {here}") for problem in unchosen_problems(study)]:
        raise refusal(PATH, unchosen)
    return study


def study_for(body: Mapping[str, Any]) -> tuple[Study, dict[str, Any]]:
    """Study of a request, and the request, both without the layouts that are invalid.

    Raises `StudyError` as `study_from` if anything else is invalid, or if no valid design of the request is left. The
    designs left out are listed as `left_out`, each with a sentence, also the baseline if it is one.
    """
    document, asked = body["study"], dict(body)
    try:
        return study_from(document), asked
    except FileError as error:
        study, faults = study_without(document, error)
        several = [one for one in body.get("designs") or () if one.get("study") or one["layout"] not in faults]
        names = [name for name in body.get("layouts") or () if name not in faults]
        single = [body["design"]["layout"] if body.get("design") else body.get("layout")]
        left = several or names or [name for name in single if name is not None and name not in faults]
        if not left:  # of what is asked, or all layouts are
            raise
        given = {"designs": several, "layouts": names}
        asked |= {key: kept for key, kept in given.items() if body.get(key)}
        if (body.get("baseline") or {}).get("layout") in faults:
            del asked["baseline"]
        own_base = document["study"].get("baseline", next(iter(document[_LAYOUTS])))
        base = body["baseline"]["layout"] if body.get("baseline") else own_base
        named = [*(one["layout"] for one in body.get("designs") or ()), *(body.get("layouts") or ()), base]
        left_out = [
            {"layout": name, "sentence": faults[name], "is_baseline": name == base}
            for name in dict.fromkeys(named)
            if name in faults
        ]
        return study, {**asked, "left_out": left_out}


def study_without(document: Document, error: FileError) -> tuple[Study, dict[str, str]]:
    """Study of a document without the layouts in which `error` found its problems, and the sentence on each of them.

    Raises `error` if it has other problems, and `StudyError` if the other layouts are no study.
    """
    faults: dict[str, str] = {}
    while True:  # free networks are found once all else is valid
        for problem in error.problems:
            if len(problem.place) < 2 or problem.place[0] != _LAYOUTS:
                raise error
            faults.setdefault(problem.place[1], str(problem))
        layouts = {name: entry for name, entry in document[_LAYOUTS].items() if name not in faults}
        if not layouts:
            raise error
        settings = document["study"]
        baseline = settings.get("baseline", next(iter(document[_LAYOUTS])))
        if baseline in faults:
            settings = {key: value for key, value in settings.items() if key != "baseline"}
        try:
            study = study_from({**document, _LAYOUTS: layouts, "study": settings})
        except FileError as further:
            error = further
        else:
            return replace(study, baseline=None) if baseline in faults else study, faults


def searched_study_from(document: object) -> Study:
    """Study of a document, which may have free networks; raises `StudyError` as `study_from`."""
    if not isinstance(document, dict):
        raise refusal(PATH, [Problem(fault="not a study document", expected="the tables of a study file")])
    try:
        return _study(json.dumps(document), _stamp(document))
    except RecursionError:
        raise refusal(PATH, [Problem(said="Tables or lists are nested too deeply.")]) from None


@lru_cache(_KEPT)
def _study(document: str, stamp: _Stamp) -> Study:
    return study_of(json.loads(document), PATH)


def _stamp(document: Document) -> _Stamp:
    """Modification time [ns] and size [byte] of the measured road profile of a document; None without one.

    A page may read what stands beside the place where its server was started, and nothing else of the machine.
    """
    road = document.get("road")
    name = road.get("profile") if isinstance(road, dict) else None
    if not isinstance(name, str):
        return None
    if Path(name).name != name or not Path(name).is_file():
        fault = "the page reads only profiles that lie in the folder in which inerter serve was started"
        hint = "Start it there, or replace the profile by the roughness that inerter check reports."
        raise refusal(
            PATH, [at(("road", "profile"), got=quote_value(name), fault=fault, expected="one of them", hint=hint)]
        )
    there = Path(name).stat()
    return there.st_mtime_ns, there.st_size


def problems_of(error: InerterError) -> list[dict[str, Any]]:
    """Problems of an error: those of a file error, or the error itself as one."""
    found: Iterable[Problem] = error.problems if isinstance(error, FileError) else [Problem(said=str(error))]
    return [
        {
            "place": list(problem.place),
            **{key: getattr(problem, key) for key in ("got", "fault", "expected", "hint")},
            "sentence": str(problem),
        }
        for problem in found
    ]


def _plain(tables: Any) -> Any:
    """Tables as JSON holds them: dates, which no key takes, are text."""
    match tables:
        case dict():
            return {key: _plain(value) for key, value in tables.items()}
        case list():
            return [_plain(value) for value in tables]
        case str() | int() | None:
            return tables
        case float():
            return json_data(tables)
    return str(tables)
