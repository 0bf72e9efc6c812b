"""Chunks of tasks that are submitted together, and their results.

An item is plain data, and so is its result, which depends on nothing else: a chunk can be run anywhere and in any
order, by an importable function.
"""

from __future__ import annotations

import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass, replace
from itertools import count, islice
from secrets import token_hex
from typing import Generic, TypeVar

from inerter.errors import InerterError
from inerter.work.forwarding import forwarding
from inerter.work.origin import origin

Item = TypeVar("Item")
Result = TypeVar("Result")
THREADS: ContextVar[int | None] = ContextVar("threads", default=None)  # allowed threads; None: the number of cores
WORTH = 0.5  # target duration of a chunk [s]: its submission takes a few milliseconds at most
_MOST = 2000  # items of a chunk
_GROWTH = 8  # largest ratio of items to those of completed chunks
_PROCESS, _NUMBERS = token_hex(8), count()


@dataclass(frozen=True)
class Chunk(Generic[Item]):
    """A chunk of items, with the number of processes that ended while running it."""

    number: str  # unique identifier over all runs, also for equal calls
    items: tuple[Item, ...]
    origin: str  # required fingerprint of the numerical code
    deaths: int = 0
    alone: bool = False  # whether it runs without any other chunk
    faults: int = 0  # number of invalid results


@dataclass(frozen=True)
class ChunkResult(Generic[Result]):
    """Results of a chunk, duration [s], fingerprint of the numerical code, and the error that ended it early."""

    results: tuple[Result, ...]
    seconds: float
    origin: str
    chunk: str = ""  # identifier of the chunk
    error: Exception | None = None


def run_chunk(work: Callable[[Item], Result], chunk: Chunk[Item]) -> ChunkResult[Result]:
    """Run all items of a chunk in this process; none if the numerical code differs."""
    if chunk.origin != origin():
        return ChunkResult((), 0.0, origin())
    begin = time.perf_counter()
    before = THREADS.set(1)  # the other cores run other chunks
    results: list[Result] = []
    failed: Exception | None = None
    try:
        with forwarding():
            for item in chunk.items:
                results.append(work(item))
    except Exception as error:  # distinguished from errors of the executor
        if not isinstance(error, InerterError):
            error.add_note(traceback.format_exc())
        failed = error
    finally:
        THREADS.reset(before)
    return ChunkResult(tuple(results), time.perf_counter() - begin, origin(), chunk.number, failed)


def import_work(work: Callable[..., object]) -> None:
    """No-op called in a new process: unpickling `work` imports all its modules."""


class Cutter(Generic[Item]):
    """Divide items into chunks of suitable duration, estimated from completed ones.

    Towards the end, if the number `left` is known, chunks become smaller, so that all processes end together.
    """

    def __init__(self, items: Iterator[Item], left: int | None) -> None:
        self._items = items
        self._left = left
        self._again: deque[Chunk[Item]] = deque()
        self._pace: float | None = None  # seconds an item takes
        self._largest = 1

    def learn(self, chunk: Chunk[Item], seconds: float) -> None:
        """Record the duration of a chunk."""
        pace = max(seconds / len(chunk.items), 1e-9)
        self._pace = pace if self._pace is None else 0.5 * (self._pace + pace)
        self._largest = max(self._largest, _GROWTH * len(chunk.items))

    def take(self, slots: int) -> Chunk[Item] | None:
        """The next chunk for one of `slots` processes; None if there is none that may run with others."""
        if self._again and self._again[0].deaths < 2:
            return replace(self._again.popleft(), number=_number())
        size = 1 if self._pace is None else min(int(WORTH / self._pace), self._largest, _MOST)
        if self._left is not None:
            size = min(size, self._left // (4 * slots))
        items = tuple(islice(self._items, max(size, 1)))
        if self._left is not None:
            self._left -= len(items)
        return Chunk(_number(), items, origin()) if items else None

    def take_alone(self) -> Chunk[Item] | None:
        """A chunk on which two processes ended, to be run without others, so that the cause is certain."""
        if not self._again:
            return None
        return replace(self._again.popleft(), number=_number(), alone=True)

    def back(self, chunk: Chunk[Item], deaths: int) -> None:
        """Resubmit the items of a chunk separately after `deaths` processes have ended on it."""
        chunks = [Chunk("", (item,), chunk.origin, chunk.deaths + deaths) for item in chunk.items]
        self._again = deque(sorted([*self._again, *chunks], key=lambda chunk: chunk.deaths))

    def repeat(self, chunk: Chunk[Item]) -> None:
        """Resubmit a chunk after an invalid result."""
        self._again.appendleft(replace(chunk, faults=chunk.faults + 1))


def _number() -> str:
    return f"{_PROCESS}-{next(_NUMBERS)}"
