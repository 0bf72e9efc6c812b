"""Execution context: the pool of a long computation, set once at its start and used where it divides.

A long-running function of the library has an argument `executor`; nested calls need not pass it on.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic

from inerter.work.chunks import THREADS, Item, Result
from inerter.work.pool import Pool, worker_pool
from inerter.work.progress import logging_steps
from inerter.work.returns import check_all_results

_POOL: ContextVar[Pool | None] = ContextVar("pool", default=None)


@contextmanager
def running_on(executor: Executor | Pool | None) -> Iterator[Pool | None]:
    """Run divisible work in this block on this executor; by default on the current one, or on threads."""
    if executor is None:
        with logging_steps():
            yield pool_here()
        return
    with logging_steps(), worker_pool(executor=executor) as pool:
        before = _POOL.set(pool)
        try:
            yield pool
        finally:
            _POOL.reset(before)


def pool_here() -> Pool | None:
    """Current pool, if any."""
    return _POOL.get()


def threads_here() -> int:
    """Number of allowed threads: one in a worker process, else the number of cores."""
    return THREADS.get() or os.cpu_count() or 1


def map_items(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    otherwise: Callable[[Callable[[Item], Result], Sequence[Item]], Iterable[Result]] = map,
    progress: Callable[[float], None] | None = None,
) -> list[Result]:
    """Results of `work` on each of `items`, in their order, on what was said to work on; else by `otherwise`.

    Where something was said, `work` and `items` can be pickled. `progress` is told the part that is done.
    """
    pool = pool_here()
    found: dict[int, Result] = {}
    if pool is None or len(items) < 2:
        for number, result in enumerate(otherwise(work, items)):
            found[number] = result
            if progress is not None:
                progress(len(found) / len(items))
        return list(found.values())
    for number, result in pool.spread(_NumberedWork(work), list(enumerate(items))):
        found[number] = result
        if progress is not None:
            progress(len(found) / len(items))
    check_all_results(len(found), len(items))
    return [found[number] for number in range(len(items))]


@dataclass(frozen=True)
class _NumberedWork(Generic[Item, Result]):
    """Work on an item that has a number, which its result keeps."""

    work: Callable[[Item], Result]

    def __call__(self, numbered: tuple[int, Item]) -> tuple[int, Result]:
        number, item = numbered
        return number, self.work(item)


def over_threads(work: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
    """Results of `work` on each of `items`, in their order, over the threads of this process.

    What comes apart within such work once more is done by its thread alone.
    """
    count = threads_here()
    return map(work, items) if count == 1 else _threads(count).map(work, items)


@lru_cache(maxsize=4)
def _threads(count: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(count, initializer=THREADS.set, initargs=(1,))
