"""Of many requests the newest wins, whatever order they come in and on whichever lane they are."""

from __future__ import annotations

import asyncio
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import Any

import pytest
from app.conftest import DOCUMENT, ask
from hypothesis import given
from hypothesis import strategies as st
from starlette.testclient import TestClient

from inerter.app import lanes
from inerter.app.lanes import Lane, Newest
from inerter.app.wire import Refusal


def told(number: float, seconds: float = 0.0) -> tuple[int, Any]:
    time.sleep(seconds)
    return 200, str(number).encode()


async def several(steps: list[tuple[str, float, int]], pauses: float, seconds: float = 1e-4) -> tuple[list[Any], int]:
    """What each request of (page, sequence, lane) is answered, and how many calls were made."""
    calls: list[float] = []

    def call(sequence: float) -> tuple[int, Any]:
        calls.append(sequence)
        return told(sequence, seconds)

    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(1) as other:
        several_lanes, newest = [Lane((), one), Lane((), other)], Newest()
        tasks = [asyncio.create_task(lane.work()) for lane in several_lanes]
        asked = []
        for page, sequence, lane in steps:
            asked.append(
                asyncio.create_task(newest.ask(several_lanes[lane], (page, "panel"), sequence, (call, sequence)))
            )
            await asyncio.sleep(pauses)
        answers = await asyncio.gather(*asked, return_exceptions=True)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
    return answers, len(calls)


@given(
    st.lists(
        st.tuples(st.sampled_from("ab"), st.integers(0, 9).map(float), st.integers(0, 1)), min_size=1, max_size=20
    ),
    st.sampled_from([0.0, 2e-4]),
)
def test_whatever_the_order(steps: list[tuple[str, float, int]], pauses: float) -> None:
    """The last answer that a page gets is that of its newest request; every other is its own or a refusal."""
    answers, calls = asyncio.run(several(steps, pauses))
    assert calls <= len(steps)
    for (_, sequence, _), answer in zip(steps, answers, strict=True):
        if isinstance(answer, Refusal):
            assert answer.status == 409
            assert answer.body["outdated"]
        else:
            assert answer == str(sequence).encode()
    for page in {page for page, _, _ in steps}:
        mine = [(sequence, answer) for (p, sequence, _), answer in zip(steps, answers, strict=True) if p == page]
        newest = max(sequence for sequence, _ in mine)
        last = [answer for sequence, answer in mine if sequence == newest][-1]
        assert last == str(newest).encode()


def test_sixty_steps_cost_few_calls() -> None:
    steps = [("a", float(i), 0) for i in range(60)]
    answers, calls = asyncio.run(several(steps, 0.0, 0.05))
    assert answers[-1] == b"59.0"
    assert calls <= 3
    assert all(isinstance(answer, Refusal) for answer in answers[:-1])


class Recorded(Executor):
    """Threads that tell when they are ended, and begin afresh."""

    def __init__(self) -> None:
        self.ended = 0
        self._threads = ThreadPoolExecutor(1)

    def submit(self, call: Any, /, *args: Any, **keywords: Any) -> Future[Any]:
        return self._threads.submit(call, *args, **keywords)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self.ended += 1
        self._threads.shutdown(wait=False, cancel_futures=cancel_futures)
        self._threads = ThreadPoolExecutor(1)


def test_a_call_that_nobody_waits_for_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """It does not hold up the newer one for longer than it may."""
    monkeypatch.setattr(lanes, "_PATIENCE", 0.05)
    worker = Recorded()

    async def two() -> tuple[Any, float]:
        lane, newest = Lane((), worker), Newest()
        task = asyncio.create_task(lane.work())
        old = asyncio.create_task(newest.ask(lane, ("a", "budget"), 1.0, (told, 1.0, 1.0)))
        await asyncio.sleep(0.02)
        begun = time.monotonic()
        new = await newest.ask(lane, ("a", "budget"), 2.0, (told, 2.0))
        with pytest.raises(Refusal):
            await old
        task.cancel()
        return new, time.monotonic() - begun

    new, seconds = asyncio.run(two())
    assert new == b"2.0"
    assert worker.ended == 1
    assert seconds < 0.8


def test_others_are_not_disturbed() -> None:
    """Other pages and panels keep their requests."""

    async def both() -> list[Any]:
        with ThreadPoolExecutor(1) as worker:
            lane, newest = Lane((), worker), Newest()
            task = asyncio.create_task(lane.work())
            who = [("a", "indices"), ("b", "indices"), ("a", "response")]
            found = await asyncio.gather(*(newest.ask(lane, w, float(i), (told, float(i))) for i, w in enumerate(who)))
            task.cancel()
        return found

    assert asyncio.run(both()) == [b"0.0", b"1.0", b"2.0"]


def test_a_panel_tells_its_sequence(client: TestClient) -> None:
    for sequence in (3, 7):
        body = {"study": DOCUMENT, "client": "p", "sequence": sequence, "layouts": ["S1"]}
        assert ask(client, "panel/indices", **body)["sequence"] == sequence
    late = client.post("/api/panel/indices", json={"study": DOCUMENT, "client": "p", "sequence": 5})
    assert late.status_code == 409
    assert late.json()["outdated"]
