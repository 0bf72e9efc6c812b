"""TOML files, read with an error that tells what is wrong with one, and written."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from shlex import quote
from typing import Any

from inerter.errors import StudyError
from inerter.files.common.codec import TableCodec, load_tables
from inerter.files.common.kinds import FileKind, kind_of, kind_with, mistaken_kinds
from inerter.files.common.problem import Problem
from inerter.files.common.problems import refusal

_LARGEST = 1_000_000  # bytes
_POSITION = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)$")
_DECLARED_TWICE, _QUOTED = re.compile(r"Cannot declare \((.*)\) twice"), re.compile(r"'([^']*)'")
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def value_of(codec: TableCodec, tables: Mapping[str, Any], path: Path) -> Any:
    """Value of the tables of a file; `path` is used in messages only.

    Raises `StudyError` with a sentence for a file of another kind, or with a line for every entry that does not fit.
    """
    value, problems = load_tables(codec, tables)
    if not problems:
        return value
    if (mistaken := mistaken_kinds(tables, codec.names)) is not None:
        found, wanted = mistaken
        raise _mistaken(path, found, f"a {wanted.singular} for inerter {wanted.command}")
    raise refusal(path, problems)


def read_tables(path: Path, what: str) -> dict[str, Any]:
    """The tables of a TOML file; `what` it should be is for messages.

    Raises `StudyError` for a file that cannot be read, or is no TOML.
    """
    if path.is_dir():
        raise StudyError(f"{path}: this is a folder; expected {what}. Give the path of a .toml file in it.")
    try:
        with path.open("rb") as stream:
            data = stream.read(_LARGEST + 1)
    except FileNotFoundError:
        raise StudyError(f"{path}: file not found; expected {what}. Check the path.") from None
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}); expected {what}.") from None
    return tables_of(data, path, what)


def tables_of(data: bytes, path: Path, what: str) -> dict[str, Any]:
    """Tables of the bytes of a TOML file; raises `StudyError` where they are no TOML."""
    if len(data) > _LARGEST:
        fault, expected = f"larger than {_LARGEST} bytes", f"{what}, which is a page of TOML"
        raise refusal(path, [_record_problem(path, what) or Problem(fault=fault, expected=expected)])
    try:
        return tomllib.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise refusal(path, [_unreadable(error, data, path, what)]) from None


def _unreadable(error: Exception, data: bytes, path: Path, what: str) -> Problem:
    """The problem of bytes that are no TOML."""
    if (record := _record_problem(path, what)) is not None:
        return record
    if isinstance(error, UnicodeDecodeError):
        line = data.count(b"\n", 0, error.start) + 1
        return Problem(said=f"line {line}: not UTF-8 text; save the file with the encoding UTF-8.")
    if isinstance(error, tomllib.TOMLDecodeError):
        return _syntax_problem(str(error), data)
    # thousands of brackets, or of digits in a whole number
    return Problem(said=f"not {what}: brackets nested too deeply, or a number too long.")


def _record_problem(path: Path, what: str) -> Problem | None:
    """Problem of a path whose suffix is that of a measurement file; None for another."""
    from inerter.records.readers import FORMATS  # noqa: PLC0415 - heavy

    if path.suffix.lower() not in FORMATS or path.suffix.lower() == ".txt":
        return None
    hint = f"Try: inerter identify {quote(str(path))} --model choose"
    return Problem(fault="this is a file of measurements", expected=what, hint=hint)


def check_measurements(path: Path) -> None:
    """Raises `StudyError` for a TOML file where measurements are expected, with the command that takes it."""
    if path.suffix.lower() == ".toml" and path.is_file():
        tables = read_tables(path, "measurements")
        if any(kind_with(section) for section in tables):
            raise _mistaken(path, kind_of(tables), "measurements")


def _mistaken(path: Path, kind: FileKind, expected: str) -> StudyError:
    """The error that reports a sound file of another kind than was expected."""
    hint = f"Try: {kind.call(path)}"
    return refusal(path, [Problem(fault=f"this is a {kind.singular}", expected=expected, hint=hint)])


def _syntax_problem(message: str, data: bytes) -> Problem:
    """Problem of a TOML syntax error: position first, then its message and the two most frequent causes."""
    position = _POSITION.search(message)
    lines = data.decode("utf-8-sig").split("\n")
    line, column = position.groups() if position else (None, None)
    where = f"line {line or len(lines)}, column {column or len(lines[-1]) + 1}"
    what = _POSITION.sub("", message)
    if what == "Cannot overwrite a value":
        return Problem(said=f"{where}: this key is given twice. Remove one of the two lines.")
    if twice := _DECLARED_TWICE.match(what):
        section = ".".join(_QUOTED.findall(twice[1]))
        return Problem(said=f"{where}: section [{section}] is given twice. Put all its lines under one heading.")
    return Problem(
        said=f'{where}: not valid TOML ({what}); quantities, names and networks are quoted, such as k = "120 kN/m", '
        f"and no key or section is given twice."
    )


def as_toml(tables: Mapping[str, Any]) -> str:
    """TOML text: keys that hold a value, then a section for each dictionary."""
    lines = [as_line(key, value) for key, value in tables.items() if not isinstance(value, dict)]
    for section, table in tables.items():
        if isinstance(table, dict):
            lines += ["", f"[{section}]", *(as_line(key, value) for key, value in table.items())]
    return "\n".join(lines) + "\n"


def as_line(key: str, value: object) -> str:
    """A key and its value as TOML."""
    return f"{key if _BARE_KEY.fullmatch(key) else _toml(key)} = {_toml(value)}"


def _toml(value: object) -> str:
    match value:
        case dict():
            return "{ " + ", ".join(as_line(key, item) for key, item in value.items()) + " }"
        case list() | tuple():
            return "[" + ", ".join(_toml(item) for item in value) + "]"
        case bool():
            return str(value).lower()
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")  # JSON leaves DEL, TOML may not
        case _:
            return str(value)
