"""Pieces of work: as many items as are worth handing out at once, and what comes back of them.

An item is plain data, and so is its result, which depends on nothing else: a piece may be worked on anywhere and in any
order, by a function that can be named.
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
THREADS: ContextVar[int | None] = ContextVar("threads", default=None)  # that work here may use; None: as many as cores
WORTH = 0.5  # seconds that a piece takes: handing it out takes a few milliseconds at most
_MOST = 2000  # items of a piece
_GROWTH = 8  # times as many items as in pieces that are known already
_PROCESS, _NUMBERS = token_hex(8), count()


@dataclass(frozen=True)
class Piece(Generic[Item]):
    """Some items, and how many processes have ended while they held them."""

    number: str  # of no other piece of any run: results are of this one, and equal calls are not taken for one
    items: tuple[Item, ...]
    origin: str  # what is to make its numbers
    deaths: int = 0
    alone: bool = False  # whether nothing else is under way with it
    faults: int = 0  # how often something else came back than its results


@dataclass(frozen=True)
class Worked(Generic[Result]):
    """Results of a piece, how long they took [s], what makes the numbers, and the error that ended the work early."""

    results: tuple[Result, ...]
    seconds: float
    origin: str
    piece: str = ""  # the number of the piece
    error: Exception | None = None


def worked(work: Callable[[Item], Result], piece: Piece[Item]) -> Worked[Result]:
    """Work on all items of a piece, in the process that is to do it; on none if that would make other numbers."""
    if piece.origin != origin():
        return Worked((), 0.0, origin())
    begin = time.perf_counter()
    before = THREADS.set(1)  # the other cores work on other pieces
    results: list[Result] = []
    failed: Exception | None = None
    try:
        with forwarding():
            for item in piece.items:
                results.append(work(item))
    except Exception as error:  # told from errors of whoever sends it
        if not isinstance(error, InerterError):
            error.add_note(traceback.format_exc())
        failed = error
    finally:
        THREADS.reset(before)
    return Worked(tuple(results), time.perf_counter() - begin, origin(), piece.number, failed)


def loaded(work: Callable[..., object]) -> None:
    """What a process is called with before it has a piece: to take `work` it loads all that it needs."""


class Cutter(Generic[Item]):
    """Cuts items into pieces that are worth handing out, taking as many items as the last ones let expect.

    Towards the end, if it is known how many items are `left`, pieces become smaller: all processes end together.
    """

    def __init__(self, items: Iterator[Item], left: int | None) -> None:
        self._items = items
        self._left = left
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
            return replace(self._again.popleft(), number=_number())
        size = 1 if self._pace is None else min(int(WORTH / self._pace), self._largest, _MOST)
        if self._left is not None:
            size = min(size, self._left // (4 * slots))
        items = tuple(islice(self._items, max(size, 1)))
        if self._left is not None:
            self._left -= len(items)
        return Piece(_number(), items, origin()) if items else None

    def take_alone(self) -> Piece[Item] | None:
        """A piece that came back twice, to be worked on while nothing else is: who is to blame is certain then."""
        if not self._again:
            return None
        return replace(self._again.popleft(), number=_number(), alone=True)

    def back(self, piece: Piece[Item], deaths: int) -> None:
        """Have the items of a piece handed out again, each by itself, after so many processes have ended on it."""
        pieces = [Piece("", (item,), piece.origin, piece.deaths + deaths) for item in piece.items]
        self._again = deque(sorted([*self._again, *pieces], key=lambda piece: piece.deaths))

    def repeat(self, piece: Piece[Item]) -> None:
        """Have a piece handed out again of which something else came back than its results."""
        self._again.appendleft(replace(piece, faults=piece.faults + 1))


def _number() -> str:
    return f"{_PROCESS}-{next(_NUMBERS)}"
