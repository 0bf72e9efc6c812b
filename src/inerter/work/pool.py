"""One way to run: pieces of work in this process, in processes of our own, or on any executor.

An executor is what `concurrent.futures` says it is. What it is called to do can be pickled: a function that can be
named, and plain data.
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
from inerter.work.forwarding import receive
from inerter.work.pieces import Cutter, Item, Piece, Result, loaded, worked
from inerter.work.processes import Processes, is_started
from inerter.work.returns import Returned, check_executor, returned, submitted

KILLS = 3  # processes that an item may end
_FAULTS = 3  # times that an executor may give something else back than the results of a piece
_SHORT = 3.0  # seconds: to start processes takes about as long
_TOLD = 0.5  # seconds after which the pace of the first items tells how long all will take
_LOOK = 0.25  # seconds between two looks at what own processes tell
_AT_ONCE = 0.1  # seconds for which results of this process are kept back, to come together
_AHEAD = 2  # pieces for each process of ours: the one that it works on, and the next
_AFAR = 8  # for each of another executor, where pieces and results may be on their way for as long as a piece takes


class Pool:
    """Where work is done, for one list of items after another: here, in up to `jobs` processes, or by `executor`.

    Processes are started when work takes long enough, and end with this. An `executor` that is given goes on
    afterwards.
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
        if self._own is not None:  # Ctrl-C: what is under way is not waited for
            self._own.shutdown(wait=kind is None, cancel_futures=kind is not None)

    @property
    def is_cluster(self) -> bool:
        """Whether the work is done by the workers of a cluster."""
        return self._given is not None and cluster.is_one(self._given)

    @property
    def slots(self) -> int:
        """How many pieces can be worked on at the same time, as far as the executor tells."""
        return self.jobs if self._given is None else cluster.slots(self._given)

    @contextmanager
    def of_this_machine(self) -> Iterator[Pool]:
        """Itself if its processes are our own, else one of own processes: for work that reads or writes files."""
        with nullcontext(self) if self._given is None else Pool(os.cpu_count() or 1) as near:
            yield near

    def begin(self, work: Callable[[], object]) -> None:
        """Have one of our own processes do this first, whatever comes of it."""
        if self._given is None and self.jobs > 1:
            self._processes().submit(work)

    def on_each_node(self, function: Callable[..., object], *args: object) -> bool:
        """Call a function once on each machine of a cluster, and wait; False if there is none."""
        return self._given is not None and cluster.on_each_node(self._given, function, *args)

    def spread(
        self,
        work: Callable[[Item], Result],
        items: Iterable[Item],
        here: Callable[[Item], Result] | None = None,
        lost: Callable[[Item], Result] | None = None,
    ) -> Iterator[Result]:
        """Results of `work` on each of `items` as they are ready; see `batches`."""
        for found in self.batches(work, items, here, lost):
            yield from found

    def batches(
        self,
        work: Callable[[Item], Result],
        items: Iterable[Item],
        here: Callable[[Item], Result] | None = None,
        lost: Callable[[Item], Result] | None = None,
    ) -> Iterator[list[Result]]:
        """Results of `work` on each of `items` as they are ready, those that come together in one list.

        Items are taken as they are needed. Until processes are worth their start and ready, they are worked on in this
        one, by `here` if that is another way to the same.

        A piece of work whose process ends is handed out again. If `KILLS` processes have ended on an item, its result
        is what `lost` says. Where calls of this are abandoned, what is not begun is not begun any more.

        Raises `WorkError` if an item ends its processes and `lost` is not given, if the executor itself has ended, or
        if its processes have other sources or libraries than this one.
        """
        left = len(items) if isinstance(items, Sized) else None
        waiting = iter(items)
        if self._given is None and (self.jobs == 1 or self._own is None):
            start = _Start(partial(self._begun, work) if self.jobs > 1 else None, left)
            for found in _at_home(partial(_persistent, here or work, lost), waiting, start):
                left = None if left is None else left - len(found)
                yield found
        for first in waiting:  # there is more
            yield from self._handed_out(work, Cutter(chain([first], waiting), left), lost)

    def _begun(self, work: Callable[[Any], object]) -> list[Future[Any]]:
        """Processes that start and load what `work` needs."""
        return self._processes().start(loaded, work)

    def _handed_out(
        self, work: Callable[[Item], Result], cutter: Cutter[Item], lost: Callable[[Item], Result] | None
    ) -> Iterator[list[Result]]:
        under_way: dict[Future[Any], Piece[Item]] = {}
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
                        found = returned(future, work, under_way[future])
                    except WorkError as none:
                        found = Returned([], error=none)
                    piece = under_way.pop(future)
                    if found.results:
                        yield found.results
                    error = error or found.error or _taken(cutter, piece, found)
                    if piece.alone and piece.deaths + found.deaths >= KILLS:
                        yield [_lost(piece.items[0], lost)]
                if error is not None:  # when all that came with it is yielded
                    raise error
        finally:
            for future in under_way:
                future.cancel()

    def _receive(self) -> None:
        """Pass on what own processes have told."""
        for message in self._own.told() if self._own is not None else ():
            receive(message)

    def _submit(
        self, work: Callable[[Item], Result], cutter: Cutter[Item], under_way: dict[Future[Any], Piece[Item]]
    ) -> None:
        executor = self._given or self._processes()
        slots, ahead = max(self.slots, 1), _AHEAD if self._given is None else _AFAR
        while len(under_way) < ahead * slots and (piece := cutter.take(slots)):
            under_way[submitted(executor, worked, work, piece)] = piece
        if not under_way and (piece := cutter.take_alone()):
            under_way[submitted(executor, worked, work, piece)] = piece

    def _processes(self) -> Processes:
        if self._own is None:
            self._own = Processes(self.jobs)
        return self._own


@dataclass(eq=False)
class _Start:
    """When processes are started, while work goes on here until the first of them is ready."""

    begin: Callable[[], list[Future[Any]]] | None  # None: there are to be none
    left: int | None  # items, if it is known
    loading: float = 0.0  # seconds that the first item took, with all that it loads
    starting: list[Future[Any]] = field(default_factory=list)

    def is_over(self, done: int, seconds: float) -> bool:
        """Whether processes are ready, which are started if work takes as long."""
        if self.starting or self.begin is None:
            return is_started(self.starting)
        if done == 1:
            self.loading = seconds
        worked = seconds - self.loading
        rest = worked / (done - 1) * (self.left - done) if self.left is not None and worked > _TOLD else 0.0
        if seconds > _SHORT or rest > 2.0 * _SHORT:
            self.starting = self.begin()
        return False


def _at_home(work: Callable[[Item], Result], items: Iterator[Item], start: _Start) -> Iterator[list[Result]]:
    """Results in this process, those that come within a moment together, until others are ready."""
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


def _taken(cutter: Cutter[Item], piece: Piece[Item], found: Returned[Any]) -> WorkError | None:
    """Take note of what came back of a piece; returns the error of an executor that fails again and again."""
    rest = replace(piece, items=piece.items[len(found.results) :])
    if found.fault and piece.faults + 1 >= _FAULTS:
        return WorkError(f"the executor has failed {_FAULTS} times on one piece of work: {found.fault}.")
    if found.fault:
        cutter.repeat(piece)
    elif not found.deaths:
        cutter.learn(piece, found.seconds)
    elif not (piece.alone and piece.deaths + found.deaths >= KILLS):
        cutter.back(rest, found.deaths)
    return None


def _lost(item: Item, lost: Callable[[Item], Result] | None) -> Result:
    if lost is not None:
        return lost(item)
    raise WorkError(
        f"{KILLS} processes have ended, or had no memory left, while they worked on the same piece, {str(item)[:80]}. "
        "Fewer processes need less memory."
    )


def _persistent(work: Callable[[Item], Result], lost: Callable[[Item], Result] | None, item: Item) -> Result:
    """The result of work in this process, which is done again as often as elsewhere where there is no memory left."""
    for _ in range(KILLS):
        with suppress(MemoryError):
            return work(item)
    return _lost(item, lost)


@contextmanager
def pooled(jobs: int = 1, executor: Executor | Pool | None = None) -> Iterator[Pool]:
    """The pool that is given, or one of so many processes, or with that executor, that ends with this."""
    if isinstance(executor, Pool):
        yield executor
    else:
        with Pool(jobs, executor) as pool:
            yield pool
