"""Sentences about arguments that the command line cannot take."""

from __future__ import annotations

from pathlib import Path

from cyclopts import CycloptsError, MissingArgumentError, UnknownCommandError, UnusedCliTokensError

from inerter.errors import InerterError
from inerter.files.common.kinds import kind_of
from inerter.files.common.toml import read_tables
from inerter.units import quote_value


def argument_sentence(error: CycloptsError, command: str) -> str:
    """Sentence on the wrong arguments of `command`, such as "inerter run", and in a second line a command to try."""
    remedy = f"{command} --help"
    match error:
        case UnusedCliTokensError(unused_tokens=[_, *_] as tokens):
            said = f"Unexpected argument: {' '.join(map(quote_value, tokens))}."
        case MissingArgumentError(argument=argument, keyword=None) if argument is not None:
            said = f"{argument.name} is missing."
        case MissingArgumentError(keyword=str() as option):
            said = f"{option} is given without its value."
        case UnknownCommandError(unused_tokens=[token, *_]) if (call := _call_of(Path(token))) is not None:
            said, remedy = f"{quote_value(token)} is a file, not a command.", call
        case _:
            said = str(error)
    return f"{said}\nTry: {remedy}"


def _call_of(path: Path) -> str | None:
    """The command that takes a TOML file; None for any other path."""
    if path.suffix.lower() != ".toml" or not path.is_file():
        return None
    try:
        return kind_of(read_tables(path, "a file")).call(path)
    except InerterError:
        return None
