"""What `inerter new` does, in calls of the library: only what it needs is loaded."""

from __future__ import annotations

import sys
from pathlib import Path

from inerter.errors import StudyError
from inerter.files.study.shape import judged_models
from inerter.files.study.starting import starting_text

_STDOUT = Path("-")


def new(vehicle: str | None, output: Path | None) -> int:
    """Write a study file to start from, of the first vehicle that there is if none is named; returns the exit code.

    Raises `StudyError` for an unknown vehicle, or where a file is there already.
    """
    vehicle = vehicle or judged_models()[0]
    path = output or Path(f"{vehicle}.toml")
    text = starting_text(vehicle, "STUDY.toml" if path == _STDOUT else path.name)
    if path == _STDOUT:
        print(text, end="")
        return 0
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise StudyError(f"{path}: there is such a file, which stays as it is. Give another by -o FILE.") from None
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        raise StudyError(f"{path}: there is no such folder to write a file into. Give another file by -o.") from None
    print(f"inerter: wrote {path}; run it: inerter run {path}", file=sys.stderr)
    return 0
