"""Pieces of work: as many items as are worth handing out at once, and what comes back of them.

An item is plain data, and so is its result, which depends on nothing else: a piece may be worked on anywhere and in any
order, by a function that can be named.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass, replace
from itertools import count, islice
from typing import Generic, TypeVar

from inerter.work.origin import origin

Item = TypeVar("Item")
Result = TypeVar("Result")
THREADS: ContextVar[int | None] = ContextVar("threads", default=None)  # that work here may use; None: as many as cores
WORTH = 0.5  # seconds that a piece takes: handing it out takes a few milliseconds at most
_MOST = 2000  # items of a piece
_GROWTH = 8  # times as many items as in pieces that are known already


@dataclass(frozen=True)
class Piece(Generic[Item]):
    """Some items, and how many processes have ended while they held them."""

    number: int  # which tells it from all others: some executors take equal calls for one
    items: tuple[Item, ...]
    origin: str  # what is to make its numbers
    deaths: int = 0
    alone: bool = False  # whether nothing else is under way with it


@dataclass(frozen=True)
class Worked(Generic[Result]):
    """What a process made of a piece, how long it took [s], and what makes its numbers."""

    results: tuple[Result, ...]
    seconds: float
    origin: str


def worked(work: Callable[[Item], Result], piece: Piece[Item]) -> Worked[Result]:
    """Work on all items of a piece, in the process that is to do it; on none if that would make other numbers."""
    if piece.origin != origin():
        return Worked((), 0.0, origin())
    begin = time.perf_counter()
    before = THREADS.set(1)  # the other cores work on other pieces
    try:
        results = tuple(work(item) for item in piece.items)
    finally:
        THREADS.reset(before)
    return Worked(results, time.perf_counter() - begin, origin())


def loaded(work: Callable[..., object]) -> None:
    """What a process is called with before it has a piece: to take `work` it loads all that it needs."""


class Cutter(Generic[Item]):
    """Cuts items into pieces that are worth handing out, taking as many items as the last ones let expect.

    Towards the end, if it is known how many items are `left`, pieces become smaller: all processes end together.
    """

    def __init__(self, items: Iterator[Item], left: int | None) -> None:
        self._items = items
        self._left = left
        self._numbers = count()
        self._again: deque[Piece[Item]] = deque()
        self._pace: float | None = None  # seconds an item takes
        self._largest = 1

    def learn(self, piece: Piece[Item], seconds: float) -> None:
        """Take note of how long a piece took."""
        pace = max(seconds / len(piece.items), 1e-9)
        self._pace = pace if self._pace is None else 0.5 * (self._pace + pace)
        self._largest = max(self._largest, _GROWTH * len(piece.items))

    def take(self, slots: int) -> Piece[Item] | None:
        """The next piece for one of so many processes; None if there is none to hand out beside others."""
        if self._again and self._again[0].deaths < 2:
            return replace(self._again.popleft(), number=next(self._numbers))
        size = 1 if self._pace is None else min(int(WORTH / self._pace), self._largest, _MOST)
        if self._left is not None:
            size = min(size, self._left // (4 * slots))
        items = tuple(islice(self._items, max(size, 1)))
        if self._left is not None:
            self._left -= len(items)
        return Piece(next(self._numbers), items, origin()) if items else None

    def take_alone(self) -> Piece[Item] | None:
        """A piece that came back twice, to be worked on while nothing else is: who is to blame is certain then."""
        if not self._again:
            return None
        return replace(self._again.popleft(), number=next(self._numbers), alone=True)

    def back(self, piece: Piece[Item], deaths: int) -> None:
        """Have the items of a piece handed out again, each by itself, after so many processes have ended on it."""
        pieces = [Piece(0, (item,), piece.origin, piece.deaths + deaths) for item in piece.items]
        self._again = deque(sorted([*self._again, *pieces], key=lambda piece: piece.deaths))
