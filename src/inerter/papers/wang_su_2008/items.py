"""Items of the reproduction, each of which any process can compute."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from inerter.papers.wang_su_2008 import agreement, between, beyond, curves, rig, rows
from inerter.work.blas_threads import one_blas_thread

Numbers = dict[str, Any]


@dataclass(frozen=True)
class PaperItem:
    """Task of the reproduction: a row of a table, a point of a curve, a crossing, an optimum, or a break-even value."""

    part: str
    name: str
    given: tuple[tuple[str, float], ...] = ()  # parameters that another part has found

    @property
    def key(self) -> tuple[str, str]:
        """Part and name, unique among all tasks."""
        return self.part, self.name


def work(task: PaperItem) -> tuple[tuple[str, str], Numbers]:
    """The numbers of one task, and how many `seconds` they took."""
    begin = time.perf_counter()
    with one_blas_thread():
        numbers = _numbers(task)
    return task.key, {**numbers, "seconds": round(time.perf_counter() - begin, 3)}


_COMPUTE: dict[str, Callable[[str], Numbers]] = {
    "rig": rig.compute,
    "between": between.compute,
    "methods": agreement.compute,
    "optima": beyond.compute_optimum,
    "budgets": beyond.compute_budget,
}


def _numbers(task: PaperItem) -> Numbers:
    if task.part == "curves":
        return curves.compute(task.name, dict(task.given))
    if task.part in _COMPUTE:
        return _COMPUTE[task.part](task.name)
    return rows.compute(int(task.part.removeprefix("table")), task.name)
