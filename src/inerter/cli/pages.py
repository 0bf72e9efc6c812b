"""Figures and page of a study, made in a process of their own, which gets ready while designs are found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from inerter.files.common.folder import FIGURES, REPORT
from inerter.work.processes import Processes

if TYPE_CHECKING:
    import xarray as xr

    from inerter.files.study.budgets import BudgetOutcome
    from inerter.files.study.study import Study

    Write = Callable[[xr.Dataset, Study, Sequence[BudgetOutcome], Path], None]


@contextmanager
def pages(beside: bool) -> Iterator[Write]:
    """What writes figures and page, here or in a process `beside` this one, which by then has loaded what draws."""
    if not beside:
        yield write_pages
        return
    process = Processes(1)
    try:
        process.submit(_ready)

        def write(data: xr.Dataset, study: Study, budgets: Sequence[BudgetOutcome], folder: Path) -> None:
            try:
                process.submit(write_pages, data, study, budgets, folder).result()
            except BrokenExecutor:  # ended from outside
                write_pages(data, study, budgets, folder)

        yield write
    except BaseException:
        process.shutdown(wait=False, cancel_futures=True)
        raise
    process.shutdown()


def write_pages(data: xr.Dataset, study: Study, budgets: Sequence[BudgetOutcome], folder: Path) -> None:
    """Write the figures and the page of a study into `folder`."""
    from inerter.figures.study import draw_study
    from inerter.report.page import write_report

    draw_study(data, folder / FIGURES)
    write_report(data, study, folder / FIGURES, folder / REPORT, budgets)


def _ready() -> None:
    """Load what draws."""
    import inerter.figures.study
    import inerter.report.page  # noqa: F401
