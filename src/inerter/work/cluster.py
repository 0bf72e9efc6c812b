"""What is particular to executors that others have made, above all those of dask.distributed."""

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
from inerter.work.origin import VERSION, origin

if TYPE_CHECKING:
    from distributed import Client

INSTALL = "Install the same versions in all places."
_LOST = "the scheduler has ended, or the connection to it was lost."
_FRESH = 2.0  # seconds for which a number of workers is taken as it was
_FIRST = 60.0  # seconds within which the first worker must be there
_counted: WeakKeyDictionary[Executor, tuple[float, int]] = WeakKeyDictionary()


@dataclass(frozen=True)
class Worker:
    """What a worker of a cluster is."""

    host: str
    threads: int


def is_one(executor: Executor) -> bool:
    """Whether an executor is that of a cluster."""
    return _client(executor) is not None


def slots(executor: Executor) -> int:
    """How many calls an executor makes at the same time, as far as it tells."""
    client = _client(executor)
    if client is None:
        told = getattr(executor, "num_workers", None) or getattr(executor, "_max_workers", None)
        return int(told or os.cpu_count() or 1)
    when, count = _counted.get(executor, (-_FRESH, 0))
    if time.monotonic() - when >= _FRESH:
        with _reached():
            count = sum(client.nthreads().values())
        _counted[executor] = time.monotonic(), count
    return count


@contextmanager
def _reached() -> Iterator[None]:
    """A scheduler that cannot be reached in this block has ended: what its client raises then are errors of any kind.

    Raises `WorkError`.
    """
    try:
        yield
    except WorkError:
        raise
    except Exception as error:
        raise WorkError(_LOST) from error


def deaths(error: Exception) -> int:
    """How many processes have ended on a call that failed with this; 0 if it failed by itself."""
    if isinstance(error, BrokenExecutor):
        return 1
    killed = getattr(sys.modules.get("distributed"), "KilledWorker", None)
    if killed and isinstance(error, killed):
        return int(error.allowed_failures) + 1
    return int(isinstance(error, TypeError) and _raised_in(error) == "distributed.cfexecutor")


def _raised_in(error: Exception) -> str:
    """The module that raised an error.

    Dask's executor takes the result of a process that ended just after it for an error, and fails to take it apart.
    """
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return "" if frame is None else str(frame.tb_frame.f_globals.get("__name__"))


def check(executor: Executor) -> None:
    """Raises `WorkError` if a cluster has no workers, or its processes would not give the numbers of this one."""
    client = _client(executor)
    if client is None:
        return
    with _reached():
        if not client.nthreads():
            _wait_for_workers(client)
    for place, answer in _answers(client):
        if isinstance(answer, BaseException):
            raise WorkError(f"{place} cannot load this package ({answer}). {INSTALL}")
        version, numerics = answer
        if version != VERSION:
            raise WorkError(f"{place} has inerter {version}, and this is {VERSION}. {INSTALL}")
        if numerics != origin():
            raise WorkError(
                f"{place} has other sources of inerter {version}, or other libraries that make the numbers (numpy, "
                f"scipy, numba). {INSTALL}"
            )


def _wait_for_workers(client: Client) -> None:
    """Raises `WorkError` if none comes."""
    try:
        client.wait_for_workers(1, timeout=_FIRST)
    except TimeoutError:
        raise WorkError(
            f"the scheduler has no workers, and none came within {_FIRST:.0f} s. Start some, such as: "
            f"dask worker {client.scheduler_info()['address']} --nthreads 1"
        ) from None


def _answers(client: Client) -> Iterator[tuple[str, Any]]:
    """What the scheduler, which unpacks work before it passes it on, and the workers say of themselves, or an error."""
    try:
        answer = client.run_on_scheduler(told)
    except Exception as error:  # whatever kept it from loading this, if it is there
        with _reached():
            client.nthreads()
        answer = error
    yield "the scheduler", answer
    with _reached():
        answers = client.run(told, on_error="return")
    for address, answer in answers.items():
        yield f"the worker {address}", answer


def told() -> tuple[str, str]:
    """What a process says of itself: its version of this package, and what makes its numbers."""
    return VERSION, origin()


def on_each_node(executor: Executor, function: Callable[..., object], *args: object) -> bool:
    """Call a function once on each machine of a cluster, and wait; False for an executor that is none.

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
        raise WorkError(f"the machines of the cluster could not be made ready ({error}).") from None
    return True


def places(executor: Executor) -> tuple[Worker, ...]:
    """The workers of a cluster; none for another executor."""
    client = _client(executor)
    found = _workers(client).values() if client is not None else ()
    return tuple(Worker(info["host"], info["nthreads"]) for info in found)


def _workers(client: Client) -> dict[str, dict[str, Any]]:
    with _reached():
        return dict(client.scheduler_info(n_workers=-1)["workers"])


def _client(executor: Executor) -> Client | None:
    """The client of an executor of dask; None for another. `get_executor` gives no public way back to it."""
    distributed = sys.modules.get("distributed")
    client = getattr(executor, "_client", None)
    return client if distributed is not None and isinstance(client, distributed.Client) else None
