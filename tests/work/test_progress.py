"""Long work is never silent: whoever listens is called at least every two seconds, here and from other processes."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from wang_su import J1, ROAD

import inerter as it
from inerter.kernels.decorators import kernel
from inerter.work import checkpoints, progress
from inerter.work.forwarding import receive
from inerter.work.pool import Pool

SILENCE = 2.0  # seconds
MODULE = "__import__('inerter.work.progress', fromlist=['x'])"
CHECKPOINTS = "__import__('inerter.work.checkpoints', fromlist=['x'])"
REPORT = f"{MODULE}.report('rows', 3, 8, best=1.5)"
KEEP = f"{CHECKPOINTS}.forward_checkpoint({CHECKPOINTS}.Checkpoint('a case', 2, [['mark', 1.0]]))"


@contextmanager
def receiving_steps(clock: Callable[[], float] = time.monotonic) -> Iterator[list[tuple[float, it.ProgressStep]]]:
    """When each step came, by the clock or by the CPU, with the beginning and the end of the block."""
    steps: list[tuple[float, it.ProgressStep]] = [(clock(), it.ProgressStep("begin"))]
    with it.progress(lambda step: steps.append((clock(), step))):
        yield steps
    steps.append((clock(), it.ProgressStep("end")))


def largest_gap(steps: list[tuple[float, it.ProgressStep]]) -> float:
    times = np.array([at for at, _ in steps])
    return float(np.diff(times).max())


def car(*free: str) -> it.QuarterCar:
    """A quarter car with friction in the branch of its inerter, if it is asked for, and values that are free."""
    branch = it.Inerter(it.free(1.0, 400.0)) if "b" in free else it.Inerter(100.0)
    damper = it.Damper(it.free(300.0, 8e3))
    return it.QuarterCar(250, 25, 150e3, strut=it.Spring(20e3) | damper - branch)


def lighter_car() -> it.QuarterCar:
    """The same with a free wheel mass, so that not all free values are in one strut."""
    return replace(car("b"), unsprung_mass=it.free(20.0, 30.0))


COMFORT = J1
LOAD = it.at_most(it.TyreLoad(ROAD), 420.0)  # which the best design without it, of 429 N, does not keep
WORK: dict[str, Callable[[], object]] = {
    "search": lambda: it.optimise(lighter_car(), COMFORT, it.Norm()),
    "limits": lambda: it.optimise(car("b"), COMFORT, it.Norm(), subject_to=[LOAD]),
    "minimax": lambda: it.optimise(lighter_car(), it.LoadCarrying(), it.Norm()),
    "front": lambda: it.pareto_front(car("b"), [COMFORT, LOAD.of], it.Norm(), points=3),
}


@pytest.mark.parametrize("work", WORK.values(), ids=WORK)
def test_no_kind_of_work_is_silent(work: Callable[[], object]) -> None:
    """By the time that the process works: on a machine with much else to do seconds go by without it."""
    with receiving_steps(time.process_time) as steps:
        work()
    assert len(steps) > 3
    assert largest_gap(steps) < SILENCE


def test_nor_is_work_that_waits() -> None:
    with receiving_steps() as steps:
        time.sleep(1.5)
    assert len(steps) >= 3
    assert largest_gap(steps) < 1.5


def test_work_that_waits_is_told_of_again_and_again() -> None:
    """With a listener that is called five times as often as usual."""
    steps: list[it.ProgressStep] = []
    with progress.listening(progress.Listener(steps.append, every=0.2)):
        time.sleep(0.7)
    assert len(steps) >= 2


def slowly(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    """Searches whose every evaluation takes some time."""
    before = progress.count_evaluation

    def slow() -> None:
        time.sleep(seconds)
        before()

    monkeypatch.setattr("inerter.optimisation.minimax_level.count_evaluation", slow)


def test_progress_moves_within_a_search(monkeypatch: pytest.MonkeyPatch) -> None:
    slowly(monkeypatch, 0.02)
    with receiving_steps() as steps:
        found = it.optimise(car("b"), COMFORT, it.Norm(), subject_to=[LOAD], starts=4)
    inside = [step for _, step in steps if step.what == "starts"]
    assert {step.done for step in inside} >= {0, 1, 2, 3}
    assert {step.total for step in inside} == {4}
    assert any(step.evaluations > 3 for step in inside)
    lowest = [step.best for step in inside if step.best is not None]
    assert lowest == sorted(lowest, reverse=True)
    assert lowest[-1] == pytest.approx(found.value, rel=0.05)
    shares = [step.share for _, step in steps if step.share is not None]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] < 0.1
    assert shares[-1] <= 1.0


def test_a_listener_that_raises_ends_the_work(monkeypatch: pytest.MonkeyPatch) -> None:
    class Enough(Exception):  # noqa: N818
        pass

    def stop(step: it.ProgressStep) -> None:
        raise Enough

    slowly(monkeypatch, 0.02)
    with it.progress(stop), pytest.raises(Enough):
        it.optimise(car("b"), COMFORT, it.Norm(), subject_to=[LOAD])


def test_the_logger_tells_it_too(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    slowly(monkeypatch, 0.02)
    with caplog.at_level(logging.INFO, "inerter"):
        it.optimise(car("b"), COMFORT, it.Norm(), subject_to=[LOAD], starts=8)
    said = [record.getMessage() for record in caplog.records]
    assert any("starts" in line and "of 8" in line and "lowest" in line for line in said), said


def test_nothing_is_logged_that_nobody_wants(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "inerter"):
        it.optimise(car("b"), COMFORT, it.Norm())
    assert not caplog.records


def test_compiling_is_told_with_a_warning_where_nobody_listens(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a kernel alone, which nothing has prepared: the cache of its module may hold others."""

    def compiled(*args: object, **options: object) -> Callable[[float], float]:
        time.sleep(0.5)
        return lambda x: 2.0 * x

    monkeypatch.setattr(progress, "_LONG", 0.1)
    monkeypatch.setattr("inerter.kernels.compiler.compile_function", compiled)

    @kernel("twice", "float64(float64)")
    def doubled(x: float) -> float:
        return 2.0 * x

    with caplog.at_level(logging.WARNING, "inerter"):
        assert doubled(2.0) == 4.0
    said = [record.getMessage() for record in caplog.records]
    assert len(said) >= 2
    assert all("compiling a numerical kernel (twice)" in line for line in said)


@pytest.mark.campaign
def test_own_processes_pass_on_what_they_tell_and_keep() -> None:
    rows: list[checkpoints.Checkpoint] = []
    items = [REPORT, KEEP, "__import__('time').sleep(1.0)"] * 2
    with receiving_steps() as steps, checkpoints.storing_checkpoints(rows.append), Pool(2) as pool:
        pool.begin(int)
        list(pool.spread(eval, items))
    assert next(step for _, step in steps if step.what == "rows").best == 1.5
    assert rows == [checkpoints.Checkpoint("a case", 2, [["mark", 1.0]])] * 2


def test_an_abandoned_pool_ends_whatever_its_processes_tell() -> None:
    many = f"[{MODULE}.report(str(i), i, 10**6) for i in range(10**5)]"
    pool = Pool(2)
    pool.begin(int)
    results = pool.spread(eval, [many, "1 / 0", many])
    with pytest.raises(ZeroDivisionError), pool:
        list(results)


def test_what_another_process_tells_is_taken_by_nobody_if_nobody_listens() -> None:
    receive(it.ProgressStep("rows"))
    receive(checkpoints.Checkpoint("a case", 0, []))


def test_threads_that_tick_end() -> None:
    before = threading.active_count()
    for _ in range(20):
        with it.progress(lambda step: None):
            pass
    time.sleep(0.6)
    assert threading.active_count() <= before + 1


@pytest.mark.parametrize("seed", range(20))
def test_parts_are_resumed_from_any_prefix_and_only_for_the_same_beginning(seed: int) -> None:
    random = np.random.default_rng(seed)
    begins = [random.bytes(8) for _ in range(12)]
    computed: list[bytes] = []

    def work(begins: list[bytes]) -> list[Any]:
        def part(begin: bytes) -> list[float]:
            computed.append(begin)
            return [float(begin[0]), -np.inf, 0.1 + begin[1]]

        return [list(checkpoints.resume_or_compute(begin, lambda begin=begin: part(begin))) for begin in begins]

    whole, written = work(begins), list[checkpoints.Checkpoint]()
    stop = int(random.integers(1, 12))
    with (
        checkpoints.storing_checkpoints(written.append),
        checkpoints.resuming("work", {}),
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setattr(checkpoints, "_SELDOM", -1.0)
        work(begins[:stop])
    rows = checkpoints.join_checkpoints(written)
    assert len(rows) == stop
    computed.clear()
    with checkpoints.resuming("work", {"work": rows}):
        assert work(begins) == whole
    assert computed == begins[stop:]
    computed.clear()
    other = [*begins[: stop - 1], b"another!", *begins[stop:]]
    with checkpoints.resuming("work", {"work": rows}):
        work(other)
    assert computed == other[stop - 1 :]
