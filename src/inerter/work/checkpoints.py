"""Intermediate results of one long task, kept so that it can be resumed.

The parts are numbered in their fixed order; each is identified by a hash of its input, so that rows of other work are
not used.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

Row = list[Any]  # hash of the input of the part, then numbers
_SELDOM = 1.0  # seconds between two writes: short tasks write nothing


@dataclass(frozen=True)
class Checkpoint:
    """Rows of the task of that name, of which the first has the number `first`."""

    name: str
    first: int
    rows: list[Row]

    def to_json(self) -> dict[str, Any]:
        """Dictionary for JSON, the inverse of `Checkpoint(**...)`."""
        return dict(vars(self))


@dataclass(eq=False)
class _Memory:
    name: str
    known: Sequence[Row]
    keep: Callable[[Checkpoint], object]
    number: int = 0  # of the next part
    first: int = 0  # number of the first of what is new
    fresh: list[Row] = field(default_factory=list)
    written: float = field(default_factory=time.monotonic)

    def row(self, begin: bytes, compute: Callable[[], Sequence[float]]) -> Sequence[float]:
        """Numbers of the next part, computed if unknown."""
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
        """Hand over new rows."""
        fresh, self.fresh, self.written = self.fresh, [], time.monotonic()
        if fresh:
            self.keep(Checkpoint(self.name, self.first, fresh))


_MEMORY: ContextVar[_Memory | None] = ContextVar("memory", default=None)
_KEEP: ContextVar[Callable[[Checkpoint], object] | None] = ContextVar("keep", default=None)


@contextmanager
def storing_checkpoints(keep: Callable[[Checkpoint], object] | None) -> Iterator[None]:
    """Hand rows kept by the work in this block to a function."""
    before = _KEEP.set(keep)
    try:
        yield
    finally:
        _KEEP.reset(before)


def forward_checkpoint(kept: Checkpoint) -> None:
    """Hand over rows kept by other processes."""
    here = _KEEP.get()
    if here is not None:
        here(kept)


@contextmanager
def resuming(name: str, known: Mapping[str, Sequence[Row]]) -> Iterator[None]:
    """Keep the parts of the work in this block under a name, and reuse known ones."""
    here = _KEEP.get()
    if here is None and name not in known:
        yield
        return
    before = _MEMORY.set(_Memory(name, known.get(name, ()), here or (lambda kept: None)))
    try:
        yield
    finally:
        _MEMORY.reset(before)


def resume_or_compute(begin: bytes, compute: Callable[[], Sequence[float]]) -> Sequence[float]:
    """Numbers of the part with input `begin`: kept ones, or computed and kept."""
    memory = _MEMORY.get()
    return compute() if memory is None else memory.row(begin, compute)


def join_checkpoints(several: Sequence[Checkpoint]) -> list[Row]:
    """All rows of one task, in order."""
    rows: list[Row] = []
    for kept in several:
        if kept.first <= len(rows):
            rows[kept.first :] = kept.rows
    return rows
