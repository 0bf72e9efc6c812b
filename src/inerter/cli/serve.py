"""Implementation of `inerter serve`."""

from __future__ import annotations

from pathlib import Path

from inerter.app.serve import serve as served


def serve(study: Path | None, port: int | None, folder: Path | None, limits: tuple[int, int], *, browser: bool) -> None:
    """Serve the workbench until Ctrl-C."""

    def tell(link: str) -> None:
        print(link, flush=True)

    served(study, port=port, browser=browser, limit=limits[0], record_limit=limits[1], folder=folder, tell=tell)
