"""One way to run: pieces of work here, in processes of our own, or on any executor."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from itertools import count
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inerter.errors import WorkError
from inerter.work import cluster
from inerter.work.chunks import WORTH, ChunkResult, Cutter
from inerter.work.pool import KILLS, Pool, _Start, worker_pool
from inerter.work.processes import Processes, is_started
from inerter.work.running import map_items, running_on

PROCESS = "__import__('os').getpid()"  # worked on by `eval`, which every process has
SLEEP = "__import__('time').sleep(600)"  # an end that is waited for
SOON = 150.0  # seconds in which the busiest machine ends what is not waited for
KILL = "__import__('os').kill(__import__('os').getpid(), 9)"


def handed_out(items: list[str], **told: Any) -> list[Any]:
    """What two processes make of the items, from the first on."""
    with Pool(2) as pool:
        pool.begin(os.getpid)
        return list(pool.spread(eval, items, **told))


def none_left() -> bool:
    """No process of ours is left. A thread of the executor may be the one that learns of an end, a moment later."""
    deadline = time.monotonic() + SOON
    while active_children() and time.monotonic() < deadline:
        time.sleep(0.01)
    return not active_children()


def test_a_result_whose_process_ended_just_after_it_is_asked_for_again() -> None:
    """Dask's executor takes it for an error that it cannot take apart; an error of the work's own is none of that."""
    cfexecutor = pytest.importorskip("distributed.cfexecutor")

    class Lost:
        status = "lost"

        async def _result(self, raiseit: bool) -> ChunkResult[int]:
            return ChunkResult((1,), 0.0, "")

    async def cascade() -> None:
        await cfexecutor._cascade_future(Lost(), future)

    future: Future[ChunkResult[int]] = Future()
    asyncio.run(cascade())
    error = future.exception()
    assert isinstance(error, TypeError)
    assert cluster.deaths(error) == 1
    with pytest.raises(TypeError) as raised:
        int([])  # type: ignore[call-overload]
    assert cluster.deaths(raised.value) == 0


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
        assert len(active_children()) == 2  # they start at once, for the work that follows
        assert sorted(pool.spread(abs, range(-50, 0))) == list(range(1, 51))
        there = {child.pid for child in active_children()}
        assert len(there) == 2
        for _ in range(2):
            assert set(pool.spread(eval, [PROCESS] * 20)) <= there
        with worker_pool(executor=pool) as same:
            assert same is pool
        assert active_children()
    assert none_left()


@pytest.mark.marathon
def test_the_first_are_worked_on_here_until_processes_would_be_there() -> None:
    slow = f"__import__('time').sleep(0.9) or {PROCESS}"
    with Pool(2) as pool:
        found = list(pool.spread(eval, [slow] * 6, here=lambda item: 0))
        assert found == [0] * 6  # they were quick
        found = list(pool.spread(eval, [slow] * 6))
    assert 1 <= found.count(os.getpid()) <= 5
    assert none_left()


def test_results_keep_the_order_of_their_items_if_that_is_asked_for() -> None:
    with Processes(2) as processes, running_on(processes):
        assert map_items(abs, range(-300, 0)) == list(range(300, 0, -1))


def test_a_killed_process_costs_its_pieces_only(tmp_path: Path) -> None:
    once = f"__import__('pathlib').Path({str(tmp_path / 'there')!r})"
    kill_once = f"7 if {once}.exists() else {once}.write_text('') or {KILL}"
    assert sorted(handed_out(["1", kill_once, *["5"] * 20])) == [1, *[5] * 20, 7]
    assert none_left()


def test_what_kills_every_process_is_named_and_the_rest_complete(tmp_path: Path) -> None:
    mark = f"__import__('tempfile').mkstemp(dir={str(tmp_path)!r}) and "
    items = [f"{mark}{KILL}", *[f"abs({-i})" for i in range(40)]]
    found = handed_out(items, lost=lambda item: f"lost: {item[-4:]}")
    assert sorted(map(str, found)) == sorted([*map(str, range(40)), f"lost: {items[0][-4:]}"])
    assert len(list(tmp_path.iterdir())) == KILLS
    assert none_left()


def test_what_kills_every_process_ends_work_that_cannot_do_without() -> None:
    with pytest.raises(WorkError, match=f"{KILLS} processes have ended"):
        handed_out([KILL, PROCESS])
    assert none_left()


def test_processes_that_cannot_start_are_told(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("from inerter.work.processes import Processes\nProcesses(2).submit(abs, -1)\n")
    ended = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert "WorkError" in ended.stderr
    assert '`if __name__ == "__main__":`' in ended.stderr


def test_any_executor_works_and_goes_on_afterwards() -> None:
    with ThreadPoolExecutor(3) as threads:
        with Pool(executor=threads) as pool:
            assert pool.slots == 3
            assert sorted(pool.spread(abs, range(-100, 0))) == list(range(1, 101))
            assert not pool.on_each_node(os.getpid)
        assert threads.submit(abs, -1).result() == 1


def test_an_executor_that_has_ended_is_told() -> None:
    threads = ThreadPoolExecutor(1)
    threads.shutdown()
    with Pool(executor=threads) as pool, pytest.raises(WorkError, match=r"executor has ended"):
        list(pool.spread(abs, [1]))


class Elsewhere(Executor):
    """Where results are altered on the way."""

    def __init__(self, alter: Callable[[ChunkResult[object]], ChunkResult[object]]) -> None:
        self.alter = alter

    def submit(self, call: Callable[..., object], /, *args: object, **keywords: object) -> Future[object]:
        future: Future[object] = Future()
        try:
            future.set_result(self.alter(call(*args)))  # type: ignore[arg-type]
        except Exception as error:
            future.set_exception(error)
        return future


def test_numbers_of_another_version_are_not_taken() -> None:
    with (
        Pool(executor=Elsewhere(lambda found: replace(found, origin="another"))) as pool,
        pytest.raises(WorkError, match=r"another version of inerter, .* registered\. Install the same versions"),
    ):
        list(pool.spread(abs, [1]))


def test_a_process_without_the_package_is_told() -> None:
    def fail(found: object) -> ChunkResult[object]:
        raise ModuleNotFoundError("No module named 'inerter'", name="inerter")

    with Pool(executor=Elsewhere(fail)) as pool, pytest.raises(WorkError, match=r"cannot import .*No module named"):
        list(pool.spread(abs, [1]))


@given(
    st.integers(0, 300),
    st.integers(1, 9),
    st.lists(st.sampled_from([1e-6, 1e-3, 0.1, 5.0]), min_size=1),
    st.integers(0, 2**30),
)
def test_every_item_is_in_one_piece_whatever_comes_back(
    items: int, slots: int, paces: list[float], deaths: int
) -> None:
    cutter, found, numbers = Cutter(iter(range(items)), items), list[int](), set[int]()
    for step in count():
        chunk = cutter.take(slots) or cutter.take_alone()
        if chunk is None:
            break
        assert chunk.number not in numbers
        numbers.add(chunk.number)
        if deaths >> (step % 31) & 1 and chunk.deaths < KILLS:
            cutter.back(chunk, 1)
        else:
            assert chunk.alone == (chunk.deaths >= 2)
            cutter.learn(chunk, paces[step % len(paces)] * len(chunk.items))
            found += chunk.items
    assert sorted(found) == list(range(items))


def test_pieces_become_as_large_as_they_are_worth() -> None:
    cutter, sizes = Cutter(iter(range(10**6)), 10**6), list[int]()
    while chunk := cutter.take(2):
        cutter.learn(chunk, 1e-3 * len(chunk.items))
        sizes.append(len(chunk.items))
    assert 0.9 * WORTH < 1e-3 * max(sizes) <= WORTH
    assert len(sizes) < 1.1 * 10**6 * 1e-3 / WORTH
    assert sizes[-1] == 1  # towards the end


def test_an_error_does_not_wait_for_what_is_under_way() -> None:
    start = time.monotonic()
    with pytest.raises(ZeroDivisionError):
        handed_out(["1 / 0", SLEEP, SLEEP])
    assert time.monotonic() - start < SOON


def test_a_process_that_does_not_heed_its_end_is_not_waited_for() -> None:
    """As one that Ctrl-C finds in a state in which it cannot end by itself."""
    deaf = f"__import__('signal').signal(15, __import__('signal').SIG_IGN), {SLEEP}"
    start = time.monotonic()
    with pytest.raises(ZeroDivisionError):
        handed_out([deaf, "__import__('time').sleep(1) or 1 / 0"])
    assert time.monotonic() - start < SOON
    assert none_left()


def test_what_is_not_asked_for_any_more_is_not_begun() -> None:
    with Pool(2) as pool:
        pool.begin(os.getpid)
        results = pool.spread(eval, ["1", *["__import__('time').sleep(0.5)"] * 2000])
        next(results)
        results.close()  # type: ignore[attr-defined]
        start = time.monotonic()
    assert time.monotonic() - start < SOON  # all would take 500 s


@pytest.mark.parametrize(
    ("left", "first", "done", "seconds", "begins"),
    [
        (100, 0.6, 2, 1.2, True),  # a minute at this pace
        (100, 0.6, 2, 1.0, False),  # too early to tell
        (15, 0.9, 14, 1.45, False),  # only the first took long: it loads what all need
        (5, 0.6, 2, 1.2, False),  # over before processes are ready
        (630, 0.1, 600, 3.1, False),  # nearly over
        (630, 0.1, 300, 3.1, False),
        (630, 0.1, 150, 3.1, True),
        (None, 0.6, 3, 2.9, False),  # nobody knows how many there are
        (None, 0.6, 3, 3.1, True),
        (None, 3.1, 1, 3.1, True),
    ],
)
def test_processes_start_when_the_pace_tells_that_they_are_worth_it(
    left: int | None, first: float, done: int, seconds: float, begins: bool
) -> None:
    ready: Future[None] = Future()
    start = _Start(lambda: [ready, Future()], left)
    assert not start.is_over(1, first)
    assert not start.is_over(done, seconds)
    assert bool(start.starting) is begins
    ready.set_result(None)
    assert start.is_over(done + 1, seconds + 0.01) is begins  # work goes on here until the first of them is ready


def test_processes_have_started_when_one_has_unless_all_have_ended():
    done, broken, waiting = Future(), Future(), Future()
    done.set_result(None)
    broken.set_exception(BrokenProcessPool())
    assert is_started([broken, done])
    assert not is_started([broken, waiting])
    assert not is_started([waiting])
    with pytest.raises(WorkError, match="worker processes cannot be started"):
        is_started([broken, broken])


def test_a_process_that_ends_has_said_what_it_had_to_say(tmp_path: Path) -> None:
    said = 'if __name__ == "__main__":\n    with Pool(2) as pool:\n        pool.begin(help_me)\n'
    script = f"from inerter.work.pool import Pool\ndef help_me():\n    print('a word')\n{said}"
    (tmp_path / "script.py").write_text(script, encoding="utf-8")
    done = subprocess.run([sys.executable, tmp_path / "script.py"], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("a word\n", "")
