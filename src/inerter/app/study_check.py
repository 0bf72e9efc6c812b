"""Check of a study document before the computation, with the notes of `inerter check`."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from inerter.app.documents import problems_of, searched_study_from, study_from, study_without
from inerter.errors import InerterError
from inerter.files.common.problem import EntryError
from inerter.files.common.problems import FileError
from inerter.files.study.checking import check_study, study_notes
from inerter.files.study.place import place_of
from inerter.files.study.study import Study, elements_used
from inerter.files.study.sweeps import number_of
from inerter.formatting import format_quantity


def check_document(document: object) -> dict[str, Any]:
    """Problems and notes of a document, the networks of its layouts, and its numbers that can be swept.

    A layout that is invalid leaves out itself only.
    """
    study: Study | None = None
    problems: list[dict[str, Any]] = []
    notes: list[str] = []
    try:
        study, problems = _valid_part(document)
        if study is not None:
            check_study(study)
            notes = study_notes(study)
    except InerterError as error:
        problems = [*problems, *problems_of(error)]
    if study is None:
        return {"problems": problems, "notes": [], "layouts": {}, "places": []}
    return {"problems": problems, "notes": notes, "layouts": _layouts(study), "places": _places(study)}


def _valid_part(document: object) -> tuple[Study | None, list[dict[str, Any]]]:
    """Study of a document without its invalid layouts, and the problems of these.

    Layouts with free networks are for a search, and no problems. None where no valid layout is left.
    """
    problems: list[dict[str, Any]] = []
    try:
        searched_study_from(document)
    except FileError as error:
        problems = problems_of(error)
    try:
        return study_from(document), problems
    except FileError as error:
        assert isinstance(document, dict)
        with suppress(FileError):
            return study_without(document, error)[0], problems
        return None, problems


def _places(study: Study) -> list[dict[str, Any]]:
    """Numbers of the study that can be swept."""
    found = []
    for label, number in study.numbers.items():
        try:
            value = number_of(study, place_of(label)).value
        except EntryError:  # it is free, or makes no difference
            continue
        if isinstance(value, int | float):
            text = format_quantity(value, number.unit)
            found.append({"place": label, "words": number.words, "unit": number.unit, "value": value, "text": text})
    return found


def _layouts(study: Study) -> dict[str, Any]:
    used, units = elements_used(study), study.free_units
    return {
        name: {
            "mounts": layout.struts,
            "elements": [element for element, layouts in used.items() if name in layouts],
            "free": {
                element: {"lower": value.lower, "upper": value.upper, "unit": units[element]}
                for element, value in study.design(name).free_values().items()
            },
        }
        for name, layout in study.layouts.items()
    }
