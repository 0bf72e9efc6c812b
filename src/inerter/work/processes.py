"""Worker processes as an executor, with forwarding of their messages."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.connection import wait as wait_for_end
from multiprocessing.process import BaseProcess
from multiprocessing.util import Finalize
from typing import Any

from inerter.atomic_io import defer_interrupts
from inerter.errors import WorkError
from inerter.work.forwarding import forward_to
from inerter.work.own_process import leave, look_for_garbage_seldom

_ASKED, _KILLED = 0.4, 10.0  # timeouts [s] of a process after terminate and after kill
_LAST = -1000  # priority of the last exit handler of a process
_LOOK = 0.1  # seconds between polls of messages


@dataclass(eq=False)
class _Single:
    """An executor of one process, and its pending calls."""

    executor: ProcessPoolExecutor
    under_way: set[Future[Any]] = field(default_factory=set)
    broken: bool = False

    def submit(self, call: Callable[..., Any], *args: object) -> Future[Any]:
        future = self.executor.submit(call, *args)
        self.under_way.add(future)
        future.add_done_callback(self._on_done)
        return future

    def _on_done(self, future: Future[Any]) -> None:
        self.under_way.discard(future)
        if not future.cancelled() and isinstance(future.exception(), BrokenExecutor):
            self.broken = True


class Processes(Executor):
    """Up to `jobs` worker processes, started as needed, and ended when this process ends for any reason.

    Each is a separate executor, so that the end of one loses only its own calls; another replaces it. They are spawned,
    because a fork of a threaded process may hang.
    """

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self._singles: list[_Single] = []
        self._processes: set[BaseProcess] = set()
        self._told: deque[Any] = deque()
        self._connections: list[Connection] = []
        self._reader: threading.Thread | None = None
        self._over = threading.Event()

    def messages(self) -> Iterator[Any]:
        """Messages of the processes since the last call."""
        while self._told:
            yield self._told.popleft()

    def submit(self, call: Callable[..., Any], /, *args: object, **keywords: object) -> Future[Any]:
        """Submit a call to the process with the fewest pending calls.

        Raises `WorkError` if no process can be started.
        """
        call = partial(call, **keywords) if keywords else call
        self._singles = [single for single in self._singles if not single.broken]
        least = min(self._singles, key=lambda single: len(single.under_way), default=None)
        if least is None or (least.under_way and len(self._singles) < self.jobs):
            least = self._start_process()
        try:
            return self._submit_watched(least, call, *args)
        except BrokenExecutor:
            least.broken = True
            return self.submit(call, *args)

    def start(self, call: Callable[..., Any], /, *args: object) -> list[Future[Any]]:
        """Start all remaining processes concurrently, each with a call; see `is_started`."""
        added = [self._add_process() for _ in range(self.jobs - len(self._singles))]
        return [self._submit_watched(single, call, *args) for single in added]

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes: after their calls, or at once, by force if necessary."""
        for single in self._singles:
            single.executor.shutdown(wait=wait, cancel_futures=cancel_futures)
        if not wait:
            _end(self._processes)
        self._over.set()
        self._singles = []

    def _start_process(self) -> _Single:
        first, single = not self._processes, self._add_process()
        if first:  # whether any can be started
            is_started([self._submit_watched(single, os.getpid)], wait=True)
        return single

    def _add_process(self) -> _Single:
        context = multiprocessing.get_context("spawn")
        here, there = context.Pipe(duplex=False)
        self._connections.append(here)
        if self._reader is None:
            self._reader = threading.Thread(target=self._read, daemon=True)
            self._reader.start()
        executor = ProcessPoolExecutor(1, context, initializer=_begin_worker, initargs=(there,))
        self._singles.append(_Single(executor))
        return self._singles[-1]

    def _read(self) -> None:
        """Read messages of processes, so that no process blocks."""
        while not self._over.is_set():
            ready = wait_for_end(list(self._connections), timeout=_LOOK)
            for connection in [one for one in self._connections if one in ready]:
                try:
                    self._told.append(connection.recv())
                except Exception:  # the process has ended, possibly during a message
                    self._connections.remove(connection)
        for connection in self._connections:
            connection.close()

    def _submit_watched(self, single: _Single, call: Callable[..., Any], *args: object) -> Future[Any]:
        others = set(multiprocessing.active_children()) - self._processes
        with _deaf_to_interrupts():
            future = single.submit(call, *args)
        self._processes |= set(multiprocessing.active_children()) - others
        return future


def is_started(first: Collection[Future[Any]], *, wait: bool = False) -> bool:
    """Whether a process has completed its first call, or failed in it.

    Raises `WorkError` if all have ended before that.
    """
    ready = [future for future in first if wait or future.done()]
    broken = [future for future in ready if isinstance(future.exception(), BrokenExecutor)]
    if broken and len(broken) == len(first):
        raise WorkError(
            "worker processes cannot be started. A script that uses several processes requires the line "
            '`if __name__ == "__main__":` before its first call, because each process imports the script. Add the '
            "line, or use one process (jobs=1)."
        )
    return len(ready) > len(broken)


def _end(processes: Iterable[BaseProcess]) -> None:
    """Terminate processes, by force if necessary, with a timeout."""
    for end, patience in ((BaseProcess.terminate, _ASKED), (BaseProcess.kill, _KILLED)):
        for process in processes:
            end(process)
        deadline = time.monotonic() + patience
        for process in processes:
            process.join(max(deadline - time.monotonic(), 0.0))


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Start processes in this block with SIGINT blocked; in this process Ctrl-C is deferred to its end."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    with defer_interrupts():
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin_worker(upwards: Connection) -> None:
    look_for_garbage_seldom()
    forward_to(upwards.send)
    Finalize(None, _leave, exitpriority=_LAST)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _leave() -> None:
    if sys.exc_info()[0] is None:  # errors are reported by multiprocessing
        leave()


def _end_with(sentinel: int) -> None:
    wait_for_end([sentinel])
    os._exit(1)
