"""Implementation of `inerter check`, separate so that only the modules it needs are imported."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import wrap

from inerter.cli.streams import say
from inerter.errors import InerterError
from inerter.files.common.kinds import kind_of
from inerter.files.common.problems import FileError
from inerter.files.common.toml import read_tables

_WIDTH = 80


def check(files: Sequence[Path]) -> tuple[InerterError, ...]:
    """Check files of any kind; the errors of those that cannot be used, which are reported as they are found."""
    errors: list[InerterError] = []
    for file in files:
        try:
            _check(file)
        except InerterError as error:
            is_ambiguous = len(files) > 1 and isinstance(error, FileError) and str(file) != file.name
            say(f"{file}:\n{error.sentence}" if is_ambiguous else error.sentence)
            errors.append(error)
    return tuple(errors)


def _check(file: Path) -> None:
    tables = read_tables(file, "a study, simulation, rig or identification file")
    for line in kind_of(tables).check_lines(tables, file):
        print("\n".join(wrap(line, _WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)))
