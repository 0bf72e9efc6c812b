"""The problems of a file: those that its shape has, and the error that reports them, one a line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from inerter.errors import StudyError
from inerter.files.common.kinds import kind_with
from inerter.files.common.problem import EntryError, Problem
from inerter.files.common.suggest import nearest
from inerter.files.common.tables import Shape, Shapes
from inerter.units import shown

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

_MOST, _LONGEST = 20, 600  # problems, and characters of each
_TELLING = {"vehicle": "model", "signal": "kind"}  # the key that decides which others a section has


class FileError(StudyError):
    """A file that cannot be used, and its problems as data."""

    def __init__(self, text: str, problems: tuple[Problem, ...]) -> None:
        super().__init__(text, problems)
        self.problems = problems

    def __str__(self) -> str:
        return str(self.args[0])


def refusal(path: Path, problems: Iterable[Problem]) -> FileError:
    """The error that reports the `problems` of the file, one a line: so many as a reader may want to see."""
    every = list(problems)
    lines = [f"{path.name}: {shortened(str(problem))}" for problem in every[:_MOST]]
    if len(every) > _MOST:
        lines.append(f"{path.name}: and {len(every) - _MOST} problems more.")
    return FileError("\n".join(lines), tuple(every))


def shortened(line: str) -> str:
    """A line without its middle if it is long, as names in it may be."""
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 205]} ... {line[-200:]}"


def explain(error: ValidationError, shapes: Shapes) -> Iterator[Problem]:
    """The problems that the shape of the file has; `shapes` are all its tables, by their place."""
    for detail in error.errors(include_url=False):
        place = tuple(str(part) for part in detail["loc"])
        yield replace(_found(detail, place, shapes), place=tuple(key for key in place if not _is_tag(key)))


def _found(detail: ErrorDetails, place: tuple[str, ...], shapes: Shapes) -> Problem:
    match detail["type"]:
        case "value_error":
            error = detail["ctx"]["error"]
            return error.problem if isinstance(error, EntryError) else Problem(said=str(error))
        case "missing":
            return Problem(fault="missing", expected=_example(place, shapes))
        case "extra_forbidden":
            key, known = place[-1], _keys(_shape(place[:-1], shapes))
            return Problem(fault="unknown key", expected=f"one of {', '.join(known)}", hint=_where(place, key, shapes))
        case "too_short":
            return Problem(fault="none given", expected=_example(place, shapes))
        case _:  # model_type, dict_type: everything else is checked by validators of our own
            return Problem(got=shown(detail["input"]), fault="not a table", expected=_example(place, shapes))


def _where(place: tuple[str, ...], key: str, shapes: Shapes) -> str:
    """Where an unknown key may belong, or the known one that it may be."""
    other = kind_with(key) if len(place) == 1 else None
    if other is not None:
        return f"It is a section of {other.plural}, for: inerter {other.command}."
    elsewhere = [path for path, shape in shapes.items() if path != () and "*" not in path and key in _keys(shape)]
    for path in elsewhere:
        if len(path) == 2 and path[0] == place[0] in _TELLING:
            return f'It is a key of {_TELLING[path[0]]} = "{path[1].strip("<>").split()[0]}".'
    elsewhere = [path for path in elsewhere if path[0] != place[0]]
    if elsewhere:
        return f"It belongs in [{'.'.join(part for part in elsewhere[0] if not _is_tag(part))}]."
    return nearest(key, _keys(_shape(place[:-1], shapes)))


def _example(place: tuple[str, ...], shapes: Shapes) -> str:
    """The example of the key at `place`; tags at its end are not keys."""
    while _is_tag(place[-1]):
        place = place[:-1]
    if not _has_shape(place[:-1], shapes):  # an entry of a table of names: what the table's example shows
        return _example(place[:-1], shapes)
    for name, field in _shape(place[:-1], shapes).model_fields.items():
        if place[-1] in (name, field.alias) and field.examples:
            return str(field.examples[0])
    return f"a section [{'.'.join(place)}]"


def _has_shape(place: tuple[str, ...], shapes: Shapes) -> bool:
    return any(_leads_to(path, place) for path in shapes)


def _shape(place: tuple[str, ...], shapes: Shapes) -> type[Shape]:
    return next(shape for path, shape in shapes.items() if _leads_to(path, place))


def _leads_to(path: tuple[str, ...], place: tuple[str, ...]) -> bool:
    return len(path) == len(place) and all(a in ("*", b) for a, b in zip(path, place, strict=True))


def _keys(shape: type[Shape]) -> list[str]:
    return [field.alias or name for name, field in shape.model_fields.items()]


def _is_tag(key: str) -> bool:
    """Which alternative pydantic took, or that a key and not its value is meant: no part of the path in the file."""
    return key == "[key]" or (key.startswith("<") and key.endswith(">"))
