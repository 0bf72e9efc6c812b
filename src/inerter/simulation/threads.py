"""Threads for simulations: what ends one of them, or Ctrl-C, ends them all."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import contextmanager

from inerter.work.running import threads_here


class _Local(threading.local):
    ending: threading.Event | None = None


_LOCAL = _Local()


@contextmanager
def threads(jobs: int | None = None) -> Iterator[ThreadPoolExecutor]:
    """A pool of so many threads (by default one for each core), whose simulations are given up if the block fails."""
    ending = threading.Event()
    pool = ThreadPoolExecutor(jobs or threads_here(), initializer=_join, initargs=(ending,))
    try:
        yield pool
    except BaseException:
        ending.set()
        raise
    finally:
        pool.shutdown(cancel_futures=ending.is_set())


def _join(ending: threading.Event) -> None:
    _LOCAL.ending = ending


def check_wanted() -> None:
    """Raises `CancelledError` in a thread of a pool whose block has failed; long work calls it at intervals."""
    if _LOCAL.ending is not None and _LOCAL.ending.is_set():
        raise CancelledError
