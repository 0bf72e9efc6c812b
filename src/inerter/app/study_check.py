"""Check of a study document before the computation, with the notes of `inerter check`."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from inerter.app.documents import problems_of, searched_study_from, study_from, study_without
from inerter.errors import InerterError
from inerter.files.common.problem import EntryError
from inerter.files.common.problems import FileError
from inerter.files.study.checking import check_study, study_notes
from inerter.files.study.limits import limitable, limited_quantity_words
from inerter.files.study.place import place_of
from inerter.files.study.study import Study, elements_used
from inerter.files.study.sweeps import number_of
from inerter.formatting import format_quantity

_WRITTEN = {"m": "mm", "N/m": "kN/m", "m/N": "um/N"}  # units in which engineers state limits of a suspension
_NOTES = {"m": "R.m.s.: with 20 mm, a random motion is within ±60 mm for 99.7 % of the time."}  # lengths are of motions


def check_document(document: object) -> dict[str, Any]:
    """Problems and notes of a document, the networks of its layouts, and what can be swept and limited in it.

    A layout that is invalid leaves out itself only.
    """
    study: Study | None = None
    searched: Study | None = None
    problems: list[dict[str, Any]] = []
    notes: list[str] = []
    try:
        study, searched, problems = _valid_parts(document)
        if study is not None:
            check_study(study)
            notes = study_notes(study)
    except InerterError as error:
        problems = [*problems, *problems_of(error)]
    known = study or searched
    return {
        "problems": problems,
        "notes": notes,
        "layouts": {} if study is None else _layouts(study),
        "places": [] if study is None else _places(study),
        "limitable": [] if known is None else _limitable(known),
    }


def _valid_parts(document: object) -> tuple[Study | None, Study | None, list[dict[str, Any]]]:
    """Study of a document without its invalid layouts, that with its free networks, and the problems.

    Layouts with free networks are for a search, and no problems. The first is None where no valid layout is left, the
    second where anything is invalid.
    """
    searched: Study | None = None
    problems: list[dict[str, Any]] = []
    try:
        searched = searched_study_from(document)
    except FileError as error:
        problems = problems_of(error)
    try:
        return study_from(document), searched, problems
    except FileError as error:
        assert isinstance(document, dict)
        with suppress(FileError):
            return study_without(document, error)[0], searched, problems
        return None, searched, problems


def _limitable(study: Study) -> list[dict[str, Any]]:
    """Quantities that a limit may be on, with the unit in which a number without one is meant, and what to note."""
    return [
        {
            **{"of": name, "words": limited_quantity_words(study, name), "unit": unit},
            **{"written": _WRITTEN.get(unit, unit), "note": _NOTES.get(unit, "")},
        }
        for name, unit in limitable(study).items()
    ]


def _places(study: Study) -> list[dict[str, Any]]:
    """Numbers of the study that can be swept, those of elements first, and from where to where they may be at first."""
    found = []
    for label, number in study.numbers.items():
        try:
            value = number_of(study, place_of(label)).value
        except EntryError:  # it is free, or makes no difference
            continue
        if isinstance(value, int | float):
            text, *ends = (format_quantity(each, number.unit) for each in (value, *sorted((0.5 * value, 2.0 * value))))
            row = {"place": label, "words": number.words, "unit": number.unit, "value": value, "text": text}
            found.append({**row, "from": ends[0], "to": ends[1]})
    return sorted(found, key=lambda one: "." in one["place"])


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
