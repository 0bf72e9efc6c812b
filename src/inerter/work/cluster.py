"""Support for external executors, in particular those of dask.distributed."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from inerter.errors import WorkError
from inerter.formatting import format_quantity
from inerter.work.origin import VERSION, origin

if TYPE_CHECKING:
    from distributed import Client

INSTALL = "Install the same versions in all places, and import there what registers elements, vehicles or indices."
_LOST = "the scheduler has ended, or the connection to it was lost."
_FRESH = 2.0  # seconds for which a number of workers is cached
_FIRST = 60.0  # timeout of the first worker [s]
_counted: WeakKeyDictionary[Executor, tuple[float, int]] = WeakKeyDictionary()


@dataclass(frozen=True)
class Worker:
    """A worker of a cluster: its host and number of threads."""

    host: str
    threads: int


def is_one(executor: Executor) -> bool:
    """Whether an executor is that of a cluster."""
    return _client(executor) is not None


def slots(executor: Executor) -> int:
    """Number of concurrent calls of an executor, as far as known."""
    client = _client(executor)
    if client is None:
        workers = getattr(executor, "num_workers", None) or getattr(executor, "_max_workers", None)
        return int(workers or os.cpu_count() or 1)
    when, count = _counted.get(executor, (-_FRESH, 0))
    if time.monotonic() - when >= _FRESH:
        with _scheduler_errors():
            count = sum(client.nthreads().values())
        _counted[executor] = time.monotonic(), count
    return count


@contextmanager
def _scheduler_errors() -> Iterator[None]:
    """Reraise any error of the client in this block as loss of the scheduler.

    Raises `WorkError`.
    """
    try:
        yield
    except WorkError:
        raise
    except Exception as error:
        raise WorkError(_LOST) from error


def deaths(error: Exception) -> int:
    """Number of processes that ended during a call that failed with this error; 0 for an error of the call."""
    if isinstance(error, BrokenExecutor):
        return 1
    killed = getattr(sys.modules.get("distributed"), "KilledWorker", None)
    if killed and isinstance(error, killed):
        return int(error.allowed_failures) + 1
    return int(isinstance(error, TypeError) and _raised_in(error) == "distributed.cfexecutor")


def _raised_in(error: Exception) -> str:
    """Name of the module that raised an error.

    The executor of Dask treats the result of a process that ended just after it as an error, and fails to unpack it.
    """
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return "" if frame is None else str(frame.tb_frame.f_globals.get("__name__"))


def check(executor: Executor) -> None:
    """Raise `WorkError` if a cluster has no workers, or other versions than this process."""
    client = _client(executor)
    if client is None:
        return
    with _scheduler_errors():
        if not client.nthreads():
            _wait_for_workers(client)
    for place, answer in _answers(client):
        if isinstance(answer, BaseException):
            raise WorkError(f"{place} cannot load this package ({answer}). {INSTALL}")
        version, numerics = answer
        if version != VERSION:
            raise WorkError(f"{place} has inerter {version}, but this process has {VERSION}. {INSTALL}")
        if numerics != origin():
            raise WorkError(
                f"{place} has other sources of inerter {version}, or other numerical libraries (numpy, scipy, numba). "
                f"{INSTALL}"
            )


def _wait_for_workers(client: Client) -> None:
    """Wait for the first worker; raises `WorkError` after a timeout."""
    try:
        client.wait_for_workers(1, timeout=_FIRST)
    except TimeoutError:
        raise WorkError(
            f"the scheduler has no workers, and none connected within {format_quantity(_FIRST, 's')}. Start some, "
            f"such as: dask worker {client.scheduler_info()['address']} --nthreads 1"
        ) from None


def _answers(client: Client) -> Iterator[tuple[str, Any]]:
    """Versions or errors of the scheduler, which unpickles tasks too, and of the workers."""
    try:
        answer = client.run_on_scheduler(process_versions)
    except Exception as error:  # whatever kept it from loading this, if it is there
        with _scheduler_errors():
            client.nthreads()
        answer = error
    yield "the scheduler", answer
    with _scheduler_errors():
        answers = client.run(process_versions, on_error="return")
    for address, answer in answers.items():
        yield f"the worker {address}", answer


def process_versions() -> tuple[str, str]:
    """Version of this package, and hash of the sources and libraries of this process."""
    return VERSION, origin()


def on_each_node(executor: Executor, function: Callable[..., object], *args: object) -> bool:
    """Call a function once on each machine of a cluster, and wait; False for another executor.

    Raises `WorkError` if it cannot be called there.
    """
    client = _client(executor)
    if client is None:
        return False
    first = {info["host"]: address for address, info in reversed(_workers(client).items())}
    at = {"allow_other_workers": True, "pure": False}  # should that one end, another does it
    try:
        client.gather([client.submit(function, *args, workers=[worker], **at) for worker in first.values()])
    except Exception as error:  # workers that end, a scheduler that is gone, whatever they lack
        raise WorkError(f"worker initialisation failed ({error}).") from None
    return True


def places(executor: Executor) -> tuple[Worker, ...]:
    """Workers of a cluster; empty for another executor."""
    client = _client(executor)
    found = _workers(client).values() if client is not None else ()
    return tuple(Worker(info["host"], info["nthreads"]) for info in found)


def _workers(client: Client) -> dict[str, dict[str, Any]]:
    with _scheduler_errors():
        return dict(client.scheduler_info(n_workers=-1)["workers"])


def _client(executor: Executor) -> Client | None:
    """The client of an executor of dask; None for another. `get_executor` gives no public way back to it."""
    distributed = sys.modules.get("distributed")
    client = getattr(executor, "_client", None)
    return client if distributed is not None and isinstance(client, distributed.Client) else None
