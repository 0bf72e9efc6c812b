"""Implementation of `inerter schema` and `inerter explain`, separate so that only needed modules are imported."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from inspect import getdoc
from textwrap import wrap
from typing import Any

from inerter.errors import StudyError
from inerter.files.common.entries import LOWER, UPPER
from inerter.files.common.keys import ANY_NAME, Key, below, find_keys, keys_of_files
from inerter.files.common.kinds import kinds
from inerter.files.common.suggest import nearest, some
from inerter.files.common.toml import as_line
from inerter.files.study import KIND
from inerter.formatting import format_list
from inerter.indices.names import index_names
from inerter.indices.registry import INDICES
from inerter.methods.registry import METHODS
from inerter.networks.elements.registry import ELEMENTS
from inerter.units import quote_value
from inerter.vehicle.registry import VEHICLES

_WIDTH = 80
_ROWS: dict[str, Any] = {"vehicle": VEHICLES, "index": INDICES, "method": METHODS, "element": ELEMENTS}
_PLACE, _UNIT = 32, 11  # columns of the table of keys
_FREE = " *"  # at the unit of a value that may be free
_NAMES = {"layouts": "S3"}  # of an example, by its section; elsewhere that of an element


def schema(name: str) -> None:
    """Print the JSON Schema of a kind of files.

    Raises `StudyError` for an unknown kind.
    """
    known = {kind.name: kind for kind in kinds()}
    if name not in known:
        available = ", ".join(known)
        raise StudyError(f"Unknown kind of file {quote_value(name)}; available: {available}.{nearest(name, known)}")
    print(json.dumps(known[name].schema(), indent=2, ensure_ascii=False))


def explain(wanted: str | None) -> None:
    """Print the description of a key of files of any kind, or of all keys of study files.

    Raises `StudyError` for an unknown key.
    """
    keys = keys_of_files()
    if wanted is None:
        others = dict.fromkeys(key.section_name for key in keys if KIND.plural not in key.files)
        print("\n".join(_table([key for key in keys if KIND.plural in key.files])))
        print(
            "\n".join(
                ["", *_wrap_text(f"Sections of other files, as in inerter explain signal: {', '.join(others)}", "")]
            )
        )
        return
    told = [list(_describe_key(key, keys)) for key in find_keys(keys, wanted)]
    told += [list(_row(what, wanted, rows[wanted])) for what, rows in _words().items() if wanted in rows]
    if not told:
        raise StudyError(_unknown(wanted, keys))
    print("\n\n".join("\n".join(lines) for lines in told))


def _words() -> dict[str, Mapping[str, Any]]:
    """Registry entries by name for each kind of word that a key may have, indices also by their other names."""
    return {**_ROWS, "index": {name: INDICES[symbol] for name, symbol in index_names().items()}}


def _unknown(wanted: str, keys: Sequence[Key]) -> str:
    known = (
        [key.place for key in keys] + [key.name for key in keys] + [word for rows in _words().values() for word in rows]
    )
    words = _words_of(wanted.replace("tire", "tyre"))
    about = [
        key.place
        for key in keys
        if words <= _words_of(f"{key.place} {key.sentence}") and key.name not in (ANY_NAME, LOWER, UPPER)
    ]
    hint = f" Keys that mention it: {some(dict.fromkeys(about))}." if words and about else nearest(wanted, known)
    return f"Unknown key {quote_value(wanted)}.{hint} All keys: inerter explain"


def _words_of(text: str) -> set[str]:
    return set(re.findall("[a-z0-9]+", text.lower()))


def _describe_key(key: Key, keys: Sequence[Key]) -> Iterator[str]:
    """Lines on a key, and on the keys that it holds if it is a section."""
    where = f"{key.place} ({key.of})" if key.of else key.place
    yield from _wrap_text(f"{where}: {key.sentence}", "")
    if KIND.plural not in key.files:
        yield from _wrap_text(f"in       {format_list(key.files)}")
    if key.unit:
        others = f", or another of its kind such as {' or '.join(key.other_units[:2])}" if key.other_units else ""
        yield from _wrap_text(f"unit     {key.unit}{others}")
    if key.words:
        yield from _wrap_text(f"one of   {', '.join(key.words)}")
    if key.default not in (None, []):
        yield from _wrap_text(f"default  {as_line(key.name, key.default)}")
    elif ANY_NAME not in key.place:
        instead = f", or {key.instead}" if key.instead else ""
        yield from _wrap_text(f"default  none: required{instead}" if key.needed else "default  not set")
    if key.example is not None:
        section = key.place.rpartition(".")[0]
        name = _NAMES.get(section, "k") if key.name == ANY_NAME else key.name
        header = f"[[{section}]]" if any(one.repeated and one.place == section for one in keys) else f"[{section}]"
        place = f"    in {header}" if section and ANY_NAME not in section else ""
        yield from _wrap_text(f"example  {as_line(name, key.example)}{place}")
    if key.section and (held := below(keys, key)):
        yield ""
        yield from _table(held)


def _row(what: str, name: str, row: Any) -> Iterator[str]:
    """Lines on a registry entry that is a possible value of a key."""
    sentence = " ".join((getdoc(row) or "").partition("\n\n")[0].split())
    yield from _wrap_text(f"{name} ({what}): {sentence.removeprefix(f'{name}: ')}", "")


def _table(keys: Sequence[Key]) -> Iterator[str]:
    """A row for each key; bounds of a value that may be free are a mark at its unit."""
    yield f"{'key':<{_PLACE}}  {'unit':<{_UNIT}}meaning"
    indent = " " * (_PLACE + 2 + _UNIT)
    quantities = {key.place for key in keys if key.unit}
    bounds = {key.place for key in keys if key.name in (LOWER, UPPER) and _parent(key.place) in quantities}
    free = {_parent(place) for place in bounds}
    for place in dict.fromkeys(key.place for key in keys if key.place not in bounds):
        alike = [key for key in keys if key.place == place]
        sentences = dict.fromkeys(key.sentence for key in alike)
        text = " ".join(sentences) if len(sentences) == 1 else _by_model(alike)
        units = " or ".join(dict.fromkeys(key.unit for key in alike if key.unit)) + _FREE * (place in free)
        head = f"{place:<{_PLACE}}  {units:<{_UNIT - 1}}"
        first, *lines = wrap(text, _WIDTH - len(indent), break_on_hyphens=False)
        yield from [f"{head} {first}"] if len(head) < len(indent) else [head.rstrip(), indent + first]
        yield from (indent + line for line in lines)
    if free:
        yield from ("", f"{_FREE.strip()} or a table of bounds, {LOWER} and {UPPER}: a design variable")


def _parent(place: str) -> str:
    return place.rpartition(".")[0]


def _by_model(keys: Sequence[Key]) -> str:
    """Sentences of a key that several models have, each with its model."""
    return " ".join(dict.fromkeys(f"{key.of}: {key.sentence}" for key in keys))


def _wrap_text(text: str, indent: str = "  ") -> list[str]:
    further = " " * 11 if indent else "  "
    return wrap(
        text,
        _WIDTH,
        initial_indent=indent,
        subsequent_indent=further,
        drop_whitespace=True,
        break_long_words=False,
        break_on_hyphens=False,
    )
