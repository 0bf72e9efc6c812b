"""Study documents: the tables of a study file as JSON holds them, read, checked and written."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.problem import Problem
from inerter.files.common.problems import FileError, refusal
from inerter.files.common.toml import tables_of
from inerter.files.study.loading import WHAT, study_of
from inerter.files.study.study import Study
from inerter.report.json_data import json_data

Document = Mapping[str, Any]
PATH = Path("study.toml")  # what a document is called that is no file
_KEPT = 256  # documents whose studies are kept


def read(text: str, name: str = "") -> dict[str, Any]:
    """The document that a text of TOML says, and its problems; null where it is no TOML."""
    path = Path(Path(name).name or PATH)
    try:
        document = _plain(tables_of(text.encode("utf-8", "surrogatepass"), path, WHAT))
    except InerterError as error:
        return {"study": None, "problems": problems_of(error)}
    return {"study": document, "problems": problems(document)}


def problems(document: object) -> list[dict[str, Any]]:
    """What keeps a document from being a study: each problem with its place."""
    try:
        study_from(document)
    except InerterError as error:
        return problems_of(error)
    return []


def study_from(document: object) -> Study:
    """The study that a document is; raises `StudyError` with a problem for every entry that does not fit."""
    if not isinstance(document, dict):
        raise refusal(PATH, [Problem(fault="not a study document", expected="the tables of a study file")])
    try:
        return _study(json.dumps(document))
    except RecursionError:
        raise refusal(PATH, [Problem(said="Tables or lists are nested too deeply.")]) from None


@lru_cache(_KEPT)
def _study(document: str) -> Study:
    return study_of(json.loads(document), PATH)


def problems_of(error: InerterError) -> list[dict[str, Any]]:
    """An error as problems: those that it holds, or itself."""
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
