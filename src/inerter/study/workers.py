"""Running cases, in this process or over several."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from multiprocessing.connection import wait as wait_for_end

from inerter.study.cases import Case, Outcome, run_case
from inerter.study.values import Study


def run_all(study: Study, pending: Sequence[Case], jobs: int) -> Iterator[Outcome]:
    """Outcomes of `pending` as they are ready.

    The first case runs here, so that compiled code is in the cache before others look for it. Processes are spawned
    afresh (a fork of a threaded process may hang) and end when this one is gone, however it went.
    """
    if not pending:
        return
    yield run_case(study, pending[0])
    rest = pending[1:]
    if jobs == 1 or len(rest) < 2:
        for case in rest:
            yield run_case(study, case)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(rest)), context, initializer=_begin_worker) as pool:
        waiting: set[Future[Outcome]] = {pool.submit(run_case, study, case) for case in rest}
        try:
            while waiting:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _begin_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which ends the pool
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for_end([sentinel])
    os._exit(1)
