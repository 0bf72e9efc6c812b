"""What is wrong with a file, one line a problem: the place, what arrived, what was expected."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from inerter.errors import StudyError
from inerter.files.common.shape import Shape, Shapes
from inerter.files.common.suggest import nearest
from inerter.units import shown

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

_MOST, _LONGEST = 20, 600  # problems, and characters of each
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_TELLING = {"vehicle": "model", "signal": "kind"}  # the key that decides which others a section has
_OTHERS = {
    "study": "It is a section of study files, for: inerter run.",
    "rig": "It is a section of rig files, for: inerter rig.",
    "record": "It is a section of configurations, for: inerter identify.",
    "model": "It is a section of configurations, for: inerter identify.",
    "fit": "It is a section of configurations, for: inerter identify.",
    "signal": "It is a section of simulation files, for: inerter simulate.",
    "simulation": "It is a section of simulation files, for: inerter simulate.",
}


def refusal(path: Path, problems: Iterable[str]) -> StudyError:
    """The error that reports the `problems` of the file, one a line: so many as a reader may want to see."""
    every = list(problems)
    lines = [f"{path.name}: {shortened(problem)}" for problem in every[:_MOST]]
    if len(every) > _MOST:
        lines.append(f"{path.name}: and {len(every) - _MOST} problems more.")
    return StudyError("\n".join(lines))


def shortened(line: str) -> str:
    """A line without its middle if it is long, as names in it may be."""
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 205]} ... {line[-200:]}"


def at(place: Iterable[str], sentence: str) -> str:
    """A problem: its dotted path in the file and a sentence, which may be another exception's."""
    keys = ".".join(key if _BARE_KEY.fullmatch(key) else shown(key) for key in place)
    return f"{keys}: {sentence[0].lower()}{sentence[1:]}"


def explain(error: ValidationError, shapes: Shapes) -> Iterator[str]:
    """The problems that the shape of the file has; `shapes` are all its tables, by their place."""
    for detail in error.errors(include_url=False):
        place = tuple(str(part) for part in detail["loc"])
        yield at([key for key in place if not _is_tag(key)], _sentence(detail, place, shapes))


def _sentence(detail: ErrorDetails, place: tuple[str, ...], shapes: Shapes) -> str:
    match detail["type"]:
        case "value_error":
            return str(detail["ctx"]["error"])
        case "missing":
            return f"missing; expected {_example(place, shapes)}."
        case "extra_forbidden":
            return _unknown_key(place, shapes)
        case "too_short":
            return f"none given; expected {_example(place, shapes)}."
        case _:  # model_type, dict_type: everything else is checked by validators of our own
            return f"got {shown(detail['input'])}: not a table; expected {_example(place, shapes)}."


def _unknown_key(place: tuple[str, ...], shapes: Shapes) -> str:
    key, known = place[-1], _keys(_shape(place[:-1], shapes))
    sentence = f"unknown key; expected one of {', '.join(known)}."
    if len(place) == 1 and key in _OTHERS:
        return f"{sentence} {_OTHERS[key]}"
    elsewhere = [path for path, shape in shapes.items() if path != () and "*" not in path and key in _keys(shape)]
    for path in elsewhere:
        if path[0] == place[0] in _TELLING:
            return f'{sentence} It is a key of {_TELLING[path[0]]} = "{path[1].strip("<>").split()[0]}".'
    elsewhere = [path for path in elsewhere if path[0] != place[0]]
    return sentence + (f" It belongs in [{elsewhere[0][0]}]." if elsewhere else nearest(key, known))


def _example(place: tuple[str, ...], shapes: Shapes) -> str:
    """The example of the key at `place`; tags at its end are not keys."""
    while _is_tag(place[-1]):
        place = place[:-1]
    for name, field in _shape(place[:-1], shapes).model_fields.items():
        if place[-1] in (name, field.alias) and field.examples:
            return str(field.examples[0])
    raise KeyError(place)


def _shape(place: tuple[str, ...], shapes: Shapes) -> type[Shape]:
    for path, shape in shapes.items():
        if len(path) == len(place) and all(a in ("*", b) for a, b in zip(path, place, strict=True)):
            return shape
    raise KeyError(place)


def _keys(shape: type[Shape]) -> list[str]:
    return [field.alias or name for name, field in shape.model_fields.items()]


def _is_tag(key: str) -> bool:
    """Which alternative pydantic took, or that a key and not its value is meant: no part of the path in the file."""
    return key == "[key]" or (key.startswith("<") and key.endswith(">"))
