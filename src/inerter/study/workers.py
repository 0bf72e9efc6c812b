"""Running cases, in this process or over several."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import wait as wait_for_end
from typing import TypeVar

from inerter.errors import WorkError
from inerter.study.cases import Case, Outcome, run_case
from inerter.study.values import Study

Item = TypeVar("Item")
Result = TypeVar("Result")
_SHORT = 3.0  # seconds: to start processes takes about as long


def run_all(study: Study, pending: Sequence[Case], jobs: int) -> Iterator[Outcome]:
    """Outcomes of `pending` as they are ready; see `spread`."""
    here = partial(run_case, study, threads=jobs)
    return spread(partial(run_case, study), pending, jobs, lambda case: case.index, here)


def spread(
    work: Callable[[Item], Result],
    pending: Sequence[Item],
    jobs: int,
    kind: Callable[[Item], object],
    here: Callable[[Item], Result] | None = None,
) -> Iterator[Result]:
    """Results of `work` on each of `pending` as they are ready.

    The first item of each kind is worked on in this process (by `here`, if that is another way to the same), so that
    compiled code is in the cache before others look for it, and so are the next ones for as long as it would take to
    start processes. Those are spawned afresh (a fork of a threaded process may hang) and end when this one is gone,
    however it went.

    Raises `WorkError` if a process is killed from outside.
    """
    firsts = list({kind(item): item for item in reversed(pending)}.values())
    at_home = here or work
    for item in firsts:
        yield at_home(item)
    rest = [item for item in pending if item not in firsts]
    start = time.monotonic()
    while rest and (jobs == 1 or time.monotonic() - start < _SHORT):
        yield at_home(rest.pop(0))
    if not rest:
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(rest)), context, initializer=_begin_worker) as pool:
        with _deaf_to_interrupts():
            waiting: set[Future[Result]] = {pool.submit(work, item) for item in rest}
        try:
            while waiting:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        except BrokenProcessPool:
            raise WorkError(
                "a process of this run was ended from outside, perhaps for want of memory. "
                "What was computed is kept; continue with --resume, and fewer processes (-j 1)."
            ) from None
        except BaseException:  # Ctrl-C: what is under way is not waited for
            pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                child.terminate()
            raise


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Processes started inside are born deaf to Ctrl-C, which is for the parent alone."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _begin_worker() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for_end([sentinel])
    os._exit(1)
