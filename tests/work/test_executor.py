"""Another way to run pieces of work comes in where the process pool is, and gives the same."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from pickle import dumps, loads
from typing import Any

import numpy as np
import pytest
from study_text import load_text, study_text

import inerter as it
from inerter.errors import WorkError
from inerter.work.pool import KILLS, worker_pool

STUDY = study_text(
    'indices = ["J1", "J3"]\noptimise = "norm"\nbudgets = ["b"]',
    elements='k = "20 kN/m"\nc = { from = "100 N s/m", to = "10 kN s/m" }\nb = "30 kg"',
    layouts='S1 = "k | c"\nS2 = "k | c | b"',
)


class Elsewhere(Executor):
    """Runs copies of the pieces, each of them twice, as a cluster may that lost a result."""

    def __init__(self) -> None:
        self.run = 0

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **settings: Any) -> Future[Any]:
        self.run += 1
        first, again = (loads(dumps(loads(dumps(function))(*arguments, **settings))) for _ in range(2))
        assert dumps(first.results) == dumps(again.results)
        future: Future[Any] = Future()
        future.set_result(first)
        return future


def test_an_executor_of_ones_own_gives_the_same_results(tmp_path: Path) -> None:
    study, executor = load_text(tmp_path, STUDY), Elsewhere()
    one = it.run_study(study, tmp_path / "one")
    other = it.run_study(study, tmp_path / "other", executor=executor)
    assert one.computed == other.computed == 4
    assert executor.run == 4 + 2  # cases and budgets
    assert one.data.identical(other.data)
    written = {path.name for path in (tmp_path / "one").iterdir()} - {".inerter", "journal.jsonl"}
    assert {"summary.csv", "results.nc", "budgets.csv"} <= written
    for name in written:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "other" / name).read_bytes(), name


class Deadly(Elsewhere):
    """Where the process ends of whoever works on one of the cases."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **settings: Any) -> Future[Any]:
        if "layout='S2', index='J3'" not in repr(arguments[1].items):
            return super().submit(function, *arguments, **settings)
        self.run += 1
        future: Future[Any] = Future()
        future.set_exception(BrokenProcessPool("a process ended"))
        return future


def test_a_case_that_ends_its_processes_has_a_status_and_the_rest_completes(tmp_path: Path) -> None:
    study, executor = load_text(tmp_path, STUDY), Deadly()
    whole = it.run_study(study, tmp_path / "whole").data
    found = it.run_study(study, tmp_path / "out", executor=executor)
    assert found.failed
    assert executor.run == (3 + KILLS) + (1 + KILLS)  # cases and budgets
    lost = found.data.sel(layout="S2", index="J3")
    assert str(lost.status.item()).startswith(
        f"failed: {KILLS} processes ended, or had no memory left, while they worked on it"
    )
    assert np.isnan(lost.value).all()
    others = [("S1", "J1"), ("S1", "J3"), ("S2", "J1")]
    for layout, index in others:
        one, same = (data.sel(layout=layout, index=index).value.values for data in (found.data, whole))
        assert np.isfinite(one).all()
        assert np.array_equal(one, same)


def test_what_a_study_keeps_is_told_when_its_executor_has_ended(tmp_path: Path) -> None:
    study, threads = load_text(tmp_path, STUDY), ThreadPoolExecutor(1)
    threads.shutdown()
    with pytest.raises(WorkError, match=r"executor has ended, .* are kept; continue with --resume\.$"):
        it.run_study(study, tmp_path / "out", executor=threads)
    assert it.run_study(study, tmp_path / "out", resume=True).computed == 4


def test_what_the_journal_has_is_not_run_again(tmp_path: Path) -> None:
    study, executor = load_text(tmp_path, STUDY), Elsewhere()
    it.run_study(study, tmp_path / "out")
    assert it.run_study(study, tmp_path / "out", executor=executor, resume=True).computed == 0
    assert executor.run == 0


def test_a_folder_of_others_is_refused(tmp_path: Path) -> None:
    with pytest.raises(it.InerterError, match="not results of inerter"):
        it.run_study(load_text(tmp_path, STUDY), tmp_path)


def test_an_executor_that_is_given_does_all_and_goes_on() -> None:
    executor = Elsewhere()
    with worker_pool(executor=executor) as pool:
        pool.begin(int)
        assert sorted(pool.spread(abs, range(-5, 0))) == [1, 2, 3, 4, 5]
        with worker_pool(executor=pool) as same:
            assert same is pool
    assert executor.run == 5
    with ThreadPoolExecutor(1) as threads:
        for _ in range(2):
            with worker_pool(executor=threads) as pool:
                assert list(pool.spread(abs, [-1])) == [1]
        assert threads.submit(abs, -2).result() == 2
