"""Implementation of `inerter new`, separate so that only the modules it needs are imported."""

from __future__ import annotations

import shlex
from pathlib import Path

from inerter.atomic_io import write_text
from inerter.cli.streams import say
from inerter.errors import StudyError
from inerter.files.study.sections import study_models
from inerter.files.study.starting import starting_text

_STDOUT = Path("-")


def new(vehicle: str | None, output: Path | None, force: bool = False) -> None:
    """Write a template study file, of the first available vehicle by default.

    Raises `StudyError` for an unknown vehicle, or where a file is there already that `force` may not replace: it
    replaces what this command has written, as it was written.
    """
    vehicle = vehicle or study_models()[0]
    path = output or Path(f"{vehicle}.toml")
    text = starting_text(vehicle, "STUDY.toml" if path == _STDOUT else path.name)
    if path == _STDOUT:
        print(text, end="")
        return
    if path.is_dir():
        raise StudyError(f"{path}: this is a folder. Choose a file with -o, such as {path / f'{vehicle}.toml'}.")
    try:
        if force and path.exists():
            _check_own(path)
            write_text(path, text)
        else:
            with path.open("x", encoding="utf-8") as stream:
                stream.write(text)
    except FileExistsError:
        raise StudyError(
            f"{path}: file exists and was not replaced. Choose another with -o FILE, or use --force for one that "
            "inerter new wrote."
        ) from None
    except (FileNotFoundError, NotADirectoryError):
        raise StudyError(f"{path}: folder not found. Choose another file with -o.") from None
    except OSError as error:
        raise StudyError(f"{path}: cannot be written ({error.strerror}). Choose another file with -o.") from None
    say(f"wrote {path}; run it: {shlex.join(['inerter', 'run', str(path)])}")


def _check_own(path: Path) -> None:
    """Raises `StudyError` unless the file is one that this command writes, unchanged."""
    present = path.read_bytes() if path.is_file() else b""
    if all(present != starting_text(model, path.name).encode("utf-8") for model in study_models()):
        raise StudyError(
            f"{path}: edited since inerter new wrote it, and not replaced. Choose another with -o FILE, or remove it "
            "first."
        )
