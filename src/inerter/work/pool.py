"""Execution of chunks of work in this process, in worker processes, or on any executor.

An executor is one of `concurrent.futures`. Its calls can be pickled: an importable function, and plain data.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Sized
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Any

from inerter.errors import WorkError
from inerter.work import cluster
from inerter.work.chunks import Chunk, Cutter, Item, Result, import_work, run_chunk
from inerter.work.forwarding import receive
from inerter.work.processes import Processes, is_started
from inerter.work.returns import ExecutorResult, check_executor, check_result, submit_call

KILLS = 3  # processes that an item may end
_FAULTS = 3  # invalid results of an executor per chunk
_SHORT = 3.0  # seconds: typical start time of processes
_TOLD = 0.5  # seconds after which the total duration is estimated from the first items
_LOOK = 0.25  # seconds between polls of messages from worker processes
_AT_ONCE = 0.1  # seconds for which results of this process are collected
_AHEAD = 2  # chunks for each worker process: the running one, and the next
_AFAR = 8  # for each of another executor, where the latency may be as long as a chunk


class Pool:
    """Executor of lists of items: in this process, in up to `jobs` worker processes, or on `executor`.

    Processes are started when the work takes long enough, and end with the pool. A given `executor` is not shut down.
    """

    def __init__(self, jobs: int = 1, executor: Executor | None = None) -> None:
        self.jobs = jobs
        self._given = executor
        self._own: Processes | None = None
        if executor is not None:
            check_executor(executor)
            cluster.check(executor)

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if self._own is not None:  # Ctrl-C: do not wait for running chunks
            self._own.shutdown(wait=kind is None, cancel_futures=kind is not None)

    @property
    def is_cluster(self) -> bool:
        """Whether the work is executed by the workers of a cluster."""
        return self._given is not None and cluster.is_one(self._given)

    @property
    def slots(self) -> int:
        """Number of concurrent chunks, as far as known of the executor."""
        return self.jobs if self._given is None else cluster.slots(self._given)

    @contextmanager
    def of_this_machine(self) -> Iterator[Pool]:
        """The pool itself if local, else a local one, for work that reads or writes files."""
        with nullcontext(self) if self._given is None else Pool(os.cpu_count() or 1) as near:
            yield near

    def begin(self, work: Callable[[], object]) -> None:
        """Start all worker processes at once, and run a call first in one of them, ignoring its result."""
        if self._given is None and self.jobs > 1:
            is_started(self._processes().start(os.getpid), wait=True)
            self._processes().submit(work)

    def on_each_node(self, function: Callable[..., object], *args: object) -> bool:
        """Call a function once on each machine of a cluster, and wait; False without a cluster."""
        return self._given is not None and cluster.on_each_node(self._given, function, *args)

    def spread(
        self,
        work: Callable[[Item], Result],
        items: Iterable[Item],
        here: Callable[[Item], Result] | None = None,
        lost: Callable[[Item], Result] | None = None,
    ) -> Iterator[Result]:
        """Results of `work` on each of `items` as completed; see `batches`."""
        for found in self.batches(work, items, here, lost):
            yield from found

    def batches(
        self,
        work: Callable[[Item], Result],
        items: Iterable[Item],
        here: Callable[[Item], Result] | None = None,
        lost: Callable[[Item], Result] | None = None,
    ) -> Iterator[list[Result]]:
        """Lists of results of `work` on each of `items` as completed.

        Items are consumed as needed. Until worker processes are worthwhile and ready, items are run in this process, by
        `here` if given, an equivalent function.

        A chunk whose process ends is resubmitted. If `KILLS` processes have ended on an item, its result is
        `lost(item)`. If the iterator is abandoned, pending chunks are cancelled.

        Raises `WorkError` if an item ends its processes and `lost` is not given, if the executor itself has ended, or
        if its processes have other sources or libraries than this one.
        """
        left = len(items) if isinstance(items, Sized) else None
        waiting = iter(items)
        if self._given is None and (self.jobs == 1 or self._own is None):
            start = _Start(partial(self._start_processes, work) if self.jobs > 1 else None, left)
            for found in _at_home(partial(_persistent, here or work, lost), waiting, start):
                left = None if left is None else left - len(found)
                yield found
        for first in waiting:  # there is more
            yield from self._submit_all(work, Cutter(chain([first], waiting), left), lost)

    def _start_processes(self, work: Callable[[Any], object]) -> list[Future[Any]]:
        """Start processes that import the modules of `work`."""
        return self._processes().start(import_work, work)

    def _submit_all(
        self, work: Callable[[Item], Result], cutter: Cutter[Item], lost: Callable[[Item], Result] | None
    ) -> Iterator[list[Result]]:
        under_way: dict[Future[Any], Chunk[Item]] = {}
        try:
            while True:
                self._submit(work, cutter, under_way)
                if not under_way:
                    return
                done, _ = wait(under_way, _LOOK if self._given is None else None, FIRST_COMPLETED)
                self._receive()
                error: Exception | None = None
                for future in done:
                    try:
                        found = check_result(future, work, under_way[future])
                    except WorkError as none:
                        found = ExecutorResult([], error=none)
                    chunk = under_way.pop(future)
                    if found.results:
                        yield found.results
                    error = error or found.error or _record_result(cutter, chunk, found)
                    if chunk.alone and chunk.deaths + found.deaths >= KILLS:
                        yield [_result_of_lost_item(chunk.items[0], lost)]
                if error is not None:  # when all that came with it is yielded
                    raise error
        finally:
            for future in under_way:
                future.cancel()

    def _receive(self) -> None:
        """Pass on the messages of worker processes."""
        for message in self._own.messages() if self._own is not None else ():
            receive(message)

    def _submit(
        self, work: Callable[[Item], Result], cutter: Cutter[Item], under_way: dict[Future[Any], Chunk[Item]]
    ) -> None:
        executor = self._processes() if self._given is None else self._given
        slots, ahead = max(self.slots, 1), _AHEAD if self._given is None else _AFAR
        while len(under_way) < ahead * slots and (chunk := cutter.take(slots)):
            under_way[submit_call(executor, run_chunk, work, chunk)] = chunk
        if not under_way and (chunk := cutter.take_alone()):
            under_way[submit_call(executor, run_chunk, work, chunk)] = chunk

    def _processes(self) -> Processes:
        if self._own is None:
            self._own = Processes(self.jobs)
        return self._own


@dataclass(eq=False)
class _Start:
    """Start of worker processes, while items are run here until the first of them is ready."""

    begin: Callable[[], list[Future[Any]]] | None  # None: no worker processes
    left: int | None  # items, if it is known
    loading: float = 0.0  # seconds of the first item, with its imports
    starting: list[Future[Any]] = field(default_factory=list)

    def is_over(self, done: int, seconds: float) -> bool:
        """Whether worker processes are ready, which are started if the work takes long enough."""
        if self.starting or self.begin is None:
            return is_started(self.starting)
        if done == 1:
            self.loading = seconds
        spent = seconds - self.loading
        if self.left is None or spent <= _TOLD:
            is_long = seconds > _SHORT
        else:
            is_long = spent / (done - 1) * (self.left - done) > 2.0 * _SHORT
        if is_long:
            self.starting = self.begin()
        return False


def _at_home(work: Callable[[Item], Result], items: Iterator[Item], start: _Start) -> Iterator[list[Result]]:
    """Lists of results computed in this process, until worker processes are ready."""
    first = begun = time.monotonic()
    found: list[Result] = []
    for done, item in enumerate(items, start=1):
        found.append(work(item))
        now = time.monotonic()
        if now - begun > _AT_ONCE:
            yield found
            found, begun = [], now
        if start.is_over(done, now - first):
            break
    if found:
        yield found


def _record_result(cutter: Cutter[Item], chunk: Chunk[Item], found: ExecutorResult[Any]) -> WorkError | None:
    """Record the result of a chunk; returns the error of an executor that fails repeatedly."""
    rest = replace(chunk, items=chunk.items[len(found.results) :])
    if found.fault and chunk.faults + 1 >= _FAULTS:
        return WorkError(f"the executor has failed {_FAULTS} times on one chunk: {found.fault}.")
    if found.fault:
        cutter.repeat(chunk)
    elif not found.deaths:
        cutter.learn(chunk, found.seconds)
    elif not (chunk.alone and chunk.deaths + found.deaths >= KILLS):
        cutter.back(rest, found.deaths)
    return None


def _result_of_lost_item(item: Item, lost: Callable[[Item], Result] | None) -> Result:
    if lost is not None:
        return lost(item)
    raise WorkError(
        f"{KILLS} processes have ended, possibly out of memory, while running the same item, {str(item)[:80]}. Use "
        f"fewer processes."
    )


def _persistent(work: Callable[[Item], Result], lost: Callable[[Item], Result] | None, item: Item) -> Result:
    """The result of work in this process, repeated up to `KILLS` times if out of memory."""
    for _ in range(KILLS):
        with suppress(MemoryError):
            return work(item)
    if lost is not None:
        return lost(item)
    raise WorkError(f"Out of memory, {KILLS} times, while running the same item, {str(item)[:80]}.")


@contextmanager
def worker_pool(jobs: int = 1, executor: Executor | Pool | None = None) -> Iterator[Pool]:
    """The given pool, or a new one of `jobs` processes or of the executor, which ends with this context.

    >>> import inerter as it
    >>> with it.worker_pool(jobs=1) as pool:
    ...     pool is not None
    True
    """
    if isinstance(executor, Pool):
        yield executor
    else:
        with Pool(jobs, executor) as pool:
            yield pool
