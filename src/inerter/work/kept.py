"""Results of parts of one long piece of work, kept while it goes on, so that it can go on from them.

The parts are numbered in the order in which the work comes to them, which is always the same; each is told by what it
begins with, so that rows of other work are not taken for its own.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

Row = list[Any]  # of what the part begins with a hash, then numbers
_SELDOM = 1.0  # seconds between two writings: short work writes nothing


@dataclass(frozen=True)
class Kept:
    """Rows of the work of that name, the first of which has the number `first`."""

    name: str
    first: int
    rows: list[Row]

    def to_json(self) -> dict[str, Any]:
        """A plain dictionary; `Kept(**...)` undoes it."""
        return dict(vars(self))


@dataclass(eq=False)
class _Memory:
    name: str
    known: Sequence[Row]
    keep: Callable[[Kept], object]
    number: int = 0  # of the next part
    first: int = 0  # number of the first of what is new
    fresh: list[Row] = field(default_factory=list)
    written: float = field(default_factory=time.monotonic)

    def row(self, begin: bytes, compute: Callable[[], Sequence[float]]) -> Sequence[float]:
        """The numbers of the next part, computed if they are not known."""
        mark, number = hashlib.sha256(begin).hexdigest()[:16], self.number
        self.number += 1
        if number < len(self.known) and self.known[number][0] == mark:
            return list(self.known[number][1:])
        self.known = self.known[:number]
        try:
            found = [float(value) for value in compute()]
        except KeyboardInterrupt:
            self.write()
            raise
        self.first = self.first if self.fresh else number
        self.fresh.append([mark, *found])
        if time.monotonic() - self.written >= _SELDOM:
            self.write()
        return found

    def write(self) -> None:
        """Hand over what is new."""
        fresh, self.fresh, self.written = self.fresh, [], time.monotonic()
        if fresh:
            self.keep(Kept(self.name, self.first, fresh))


_MEMORY: ContextVar[_Memory | None] = ContextVar("memory", default=None)
_KEEP: ContextVar[Callable[[Kept], object] | None] = ContextVar("keep", default=None)


@contextmanager
def kept_by(keep: Callable[[Kept], object] | None) -> Iterator[None]:
    """What work in this block keeps is handed to a function."""
    before = _KEEP.set(keep)
    try:
        yield
    finally:
        _KEEP.reset(before)


def keep(kept: Kept) -> None:
    """Hand over what other processes have kept."""
    here = _KEEP.get()
    if here is not None:
        here(kept)


@contextmanager
def resuming(name: str, known: Mapping[str, Sequence[Row]]) -> Iterator[None]:
    """The parts of the work in this block are kept under a name, and those that are known are not computed again."""
    here = _KEEP.get()
    if here is None and name not in known:
        yield
        return
    before = _MEMORY.set(_Memory(name, known.get(name, ()), here or (lambda kept: None)))
    try:
        yield
    finally:
        _MEMORY.reset(before)


def resumed(begin: bytes, compute: Callable[[], Sequence[float]]) -> Sequence[float]:
    """Numbers of a part that begins with `begin`: those that were kept, or computed and kept."""
    memory = _MEMORY.get()
    return compute() if memory is None else memory.row(begin, compute)


def joined(several: Sequence[Kept]) -> list[Row]:
    """All rows of one piece of work, as they were kept one after the other."""
    rows: list[Row] = []
    for kept in several:
        if kept.first <= len(rows):
            rows[kept.first :] = kept.rows
    return rows
