"""Implementation of `inerter serve`."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from inerter.app.serve import serve as served
from inerter.cli.pulse import display


def serve(study: Path | None, port: int | None, folder: Path | None, limits: tuple[int, int], *, browser: bool) -> None:
    """Serve the workbench until Ctrl-C."""
    with ExitStack() as silenced:

        def tell(link: str) -> None:
            silenced.enter_context(display())  # the command is ready: the page shows the progress of its work
            print(link, flush=True)

        served(study, port=port, browser=browser, limit=limits[0], record_limit=limits[1], folder=folder, tell=tell)
