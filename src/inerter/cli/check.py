"""Implementation of `inerter check`, separate so that only the modules it needs are imported."""

from __future__ import annotations

from pathlib import Path
from textwrap import wrap

from inerter.files.common.kinds import kind_of
from inerter.files.common.toml import read_tables

_WIDTH = 80


def check(file: Path) -> None:
    """Check a file of any kind."""
    kind = kind_of(read_tables(file, "a study, simulation, rig or identification file"))
    for line in kind.check_lines(file):
        print("\n".join(wrap(line, _WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)))
