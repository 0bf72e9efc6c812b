"""Pieces of work in this process or over several.

A piece of work is a function and an item. Both can be pickled, and so can the result, which depends on nothing else: a
piece may be run anywhere and in any order.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import wait as wait_for_end
from multiprocessing.process import BaseProcess
from typing import TypeVar

from inerter.errors import WorkError
from inerter.writing import undisturbed

Item = TypeVar("Item")
Result = TypeVar("Result")
_SHORT = 3.0  # seconds: to start processes takes about as long
_ASKED, _KILLED = 0.4, 10.0  # seconds that a process has to end, and to be gone where it must


class Pool:
    """Up to `jobs` processes that work through one list after another, from when they are needed until the end.

    They are spawned afresh (a fork of a threaded process may hang) and end when this one is gone, however it went. An
    `executor` that is given works in their place, and goes on afterwards.
    """

    def __init__(self, jobs: int, executor: Executor | None = None) -> None:
        self.jobs = jobs
        self._own = executor is None
        self._executor = executor
        self._processes: set[BaseProcess] = set()

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        if self._executor is None or not self._own:
            return
        self._executor.shutdown(wait=kind is None, cancel_futures=kind is not None)
        if kind is not None:  # Ctrl-C: what is under way is not waited for
            _end(self._processes)

    def begin(self, work: Callable[[], object]) -> None:
        """Have one of the processes do this first, whatever comes of it."""
        if not self._alone:
            self._submit([work])

    @property
    def _alone(self) -> bool:
        return self._own and self.jobs == 1

    def spread(
        self,
        work: Callable[[Item], Result],
        pending: Sequence[Item],
        kind: Callable[[Item], object] | None = None,
        here: Callable[[Item], Result] | None = None,
    ) -> Iterator[Result]:
        """Results of `work` on each of `pending` as they are ready.

        The first item of each kind is worked on in this process (by `here`, if that is another way to the same), so
        that compiled code is in the cache before others look for it, and so are the next ones for as long as it would
        take to start processes.

        Raises `WorkError` if a process is killed from outside.
        """
        firsts = {kind(pending[i]): i for i in reversed(range(len(pending)))}.values() if kind else ()
        at_home = here or work
        for i in firsts:
            yield at_home(pending[i])
        rest = [item for i, item in enumerate(pending) if i not in firsts]
        start = time.monotonic()
        while rest and (self._alone or (self._executor is None and time.monotonic() - start < _SHORT)):
            yield at_home(rest.pop(0))
        if not rest:
            return
        waiting = self._submit(partial(work, item) for item in rest)
        try:
            while waiting:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        except BrokenExecutor:
            raise WorkError(
                "a process of this run was ended from outside, perhaps for want of memory. "
                "What was computed is kept; continue with --resume, and fewer processes (-j 1)."
            ) from None
        finally:
            for future in waiting:
                future.cancel()

    def _submit(self, calls: Iterable[Callable[[], Result]]) -> set[Future[Result]]:
        """Have the calls made; one that finds no process idle starts another, up to as many as there may be."""
        if self._executor is None:
            context = multiprocessing.get_context("spawn")
            self._executor = ProcessPoolExecutor(self.jobs, context, initializer=_begin_worker)
        others = set(multiprocessing.active_children()) - self._processes
        with _deaf_to_interrupts():
            submitted = {self._executor.submit(call) for call in calls}
        self._processes |= set(multiprocessing.active_children()) - others
        return submitted


def _end(processes: Iterable[BaseProcess]) -> None:
    """End processes, those that do not heed it by force, and wait for none of them for long."""
    for end, patience in ((BaseProcess.terminate, _ASKED), (BaseProcess.kill, _KILLED)):
        for process in processes:
            end(process)
        deadline = time.monotonic() + patience
        for process in processes:
            process.join(max(deadline - time.monotonic(), 0.0))


@contextmanager
def pooled(jobs: int | Executor | Pool) -> Iterator[Pool]:
    """The process pool that is given, or one of so many processes, or with that executor, that ends with this."""
    if isinstance(jobs, Pool):
        yield jobs
    else:
        with Pool(os.cpu_count() or 1, jobs) if isinstance(jobs, Executor) else Pool(jobs) as pool:
            yield pool


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Processes started inside are born deaf to Ctrl-C, which is for the parent alone; there it waits for the end."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    with undisturbed():
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin_worker() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for_end([sentinel])
    os._exit(1)
