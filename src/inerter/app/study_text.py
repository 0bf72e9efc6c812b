"""Text of the study file of the command line, read before anything heavy is loaded."""

from __future__ import annotations

from pathlib import Path

from inerter.errors import StudyError


def read_file(path: Path) -> str:
    """Text of a study file; raises `StudyError` for one that cannot be read."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}). Check the path.") from None
    except UnicodeDecodeError:
        raise StudyError(f"{path}: not UTF-8 text; expected a study file.") from None
