"""`serve`: the workbench on this machine. What it needs is an extra, and is loaded when it is called."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from inerter.errors import StudyError
from inerter.validation import checked

if TYPE_CHECKING:
    from inerter.files.study.study import Study

LIMIT, RECORD_LIMIT = 10_000_000, 2_000_000_000  # bytes
_EXTRA = ("starlette", "uvicorn", "pydantic")


@checked(StudyError)
def serve(
    study: str | Path | Study | None = None,
    *,
    port: int | None = None,
    browser: bool = True,
    limit: int = LIMIT,
    record_limit: int = RECORD_LIMIT,
    folder: str | Path | None = None,
    tell: Callable[[str], object] = print,
) -> None:
    """Serve the workbench on this machine, and open it in the browser; returns when it is interrupted.

    `study` is the path of a study file, or a study. `port` is chosen if it is left out. Bodies of requests have `limit`
    bytes at most, measured records `record_limit`. Long work and records are kept in `folder`, or until the end if none
    is given. `tell` is given the link. A script that calls this needs the line `if __name__ == "__main__":`, because
    processes are started afresh and import it.

    Raises `StudyError` for a study file that cannot be read, for a port that is not free, and where the extra `web` is
    not installed.

    >>> import inerter as it
    >>> try:
    ...     it.serve("no-such-study.toml", port=8000, browser=False)
    ... except it.InerterError as error:
    ...     print(error)
    no-such-study.toml: cannot be read (No such file or directory). Check the path.
    """
    if any(find_spec(name) is None for name in _EXTRA):
        raise StudyError(
            'The workbench needs libraries that are not installed: pip install "inerter[web]", then try again.'
        )
    running = import_module("inerter.app.running")
    running.run(study, port=port, browser=browser, limits=(limit, record_limit), folder=folder, tell=tell)
