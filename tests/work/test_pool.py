"""A process pool: processes that work through one list after another."""

from __future__ import annotations

import os
import time
from multiprocessing import active_children

import pytest

from inerter.errors import WorkError
from inerter.work.pool import Pool, pooled

PROCESS = "__import__('os').getpid()"  # worked on by `eval`, which every process has
SLEEP = "__import__('time').sleep(600)"  # an end that is waited for
SOON = 150.0  # seconds in which the busiest machine ends what is not waited for
KILL = "__import__('os').kill(__import__('os').getpid(), 9)"


def evaluated(items: list[str]) -> list[object]:
    with Pool(2) as pool:
        pool.begin(os.getpid)
        return list(pool.spread(eval, items))


def none_left() -> bool:
    """No process of ours is left. A thread of the executor may be the one that learns of an end, a moment later."""
    deadline = time.monotonic() + SOON
    while active_children() and time.monotonic() < deadline:
        time.sleep(0.01)
    return not active_children()


def test_one_process_is_this_one() -> None:
    with Pool(1) as pool:
        pool.begin(os.getpid)
        assert set(pool.spread(eval, [PROCESS] * 3)) == {os.getpid()}
        assert not active_children()


def test_short_work_is_not_worth_a_process() -> None:
    with Pool(2) as pool:
        assert list(pool.spread(abs, range(-3, 0))) == [3, 2, 1]
        assert not active_children()


def test_processes_stay_for_the_next_list_and_end_with_the_crew() -> None:
    with Pool(2) as pool:
        pool.begin(os.getpid)
        assert len(active_children()) == 1  # as many as there is work for
        assert sorted(pool.spread(abs, range(-50, 0))) == list(range(1, 51))
        there = {child.pid for child in active_children()}
        assert len(there) == 2
        for _ in range(2):
            assert set(pool.spread(eval, [PROCESS] * 20)) <= there
        with pooled(pool) as same:
            assert same is pool
        assert active_children()
    assert none_left()


def test_the_first_of_each_kind_is_worked_on_here() -> None:
    with Pool(2) as pool:
        pool.begin(os.getpid)
        found = list(pool.spread(eval, [PROCESS, f" {PROCESS}", PROCESS, PROCESS], kind=len, here=lambda item: item))
    assert found[:2] == [PROCESS, f" {PROCESS}"]
    assert os.getpid() not in found[2:]
    assert len(found) == 4


def test_a_killed_process_is_told() -> None:
    with pytest.raises(WorkError, match="--resume"):
        evaluated([KILL, PROCESS])
    assert none_left()


def test_an_error_does_not_wait_for_what_is_under_way() -> None:
    start = time.monotonic()
    with pytest.raises(ZeroDivisionError):
        evaluated(["1 / 0", SLEEP, SLEEP])
    assert time.monotonic() - start < SOON


def test_a_process_that_does_not_heed_its_end_is_not_waited_for() -> None:
    """As one that Ctrl-C finds in a state in which it cannot end by itself."""
    deaf = f"__import__('signal').signal(15, __import__('signal').SIG_IGN), {SLEEP}"
    start = time.monotonic()
    with pytest.raises(ZeroDivisionError):
        evaluated([deaf, "__import__('time').sleep(1) or 1 / 0"])
    assert time.monotonic() - start < SOON
    assert none_left()


def test_what_is_not_asked_for_any_more_is_not_begun() -> None:
    with Pool(2) as pool:
        pool.begin(os.getpid)
        results = pool.spread(eval, ["1", *["__import__('time').sleep(0.5)"] * 2000])
        assert next(results) == 1
        results.close()  # type: ignore[attr-defined]
        start = time.monotonic()
    assert time.monotonic() - start < SOON  # all would take 500 s
