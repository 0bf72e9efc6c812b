"""Validation of results of external executors."""

from __future__ import annotations

import pickle
from concurrent.futures import CancelledError, Executor, Future
from dataclasses import dataclass
from typing import Any, Generic

from inerter.errors import InerterError, WorkError
from inerter.work import cluster
from inerter.work.chunks import Chunk, ChunkResult, Item, Result
from inerter.work.origin import origin

GONE = "the executor has ended, or lost its connection."
_EXPECTED = (
    "Expected one of concurrent.futures, such as ProcessPoolExecutor(4), or the get_executor() of a dask client."
)
_LONGEST = 200  # characters of an error of another library


@dataclass(frozen=True)
class ExecutorResult(Generic[Result]):
    """Results of a chunk, or the number of processes that ended on it, or the fault for which it is repeated.

    `error` is an exception of the work itself, after the present results.
    """

    results: list[Result]
    seconds: float = 0.0
    deaths: int = 0
    fault: str = ""
    error: Exception | None = None


def check_all_results(found: int, total: int) -> None:
    """Raise `WorkError` unless an executor has returned results for as many items as it was given."""
    if found != total:
        raise WorkError(f"The executor returned results for only {found} of {total} parts of the work.")


def check_executor(executor: object) -> None:
    """Raise `InerterError` for an object that is not an executor."""
    if not isinstance(executor, Executor):
        raise InerterError(f"`executor`: {_brief(repr(executor))} cannot run calls. {_EXPECTED}")


def submit_call(executor: Executor, *call: Any) -> Future[Any]:
    """Future of a submitted call.

    Raises `WorkError` if the executor does not take it.
    """
    try:
        future = executor.submit(*call)
    except WorkError:
        raise
    except RuntimeError:  # of one that is broken, or was shut down
        raise WorkError(GONE) from None
    except Exception as error:
        raise WorkError(f"the executor does not accept work ({_words(error)}).") from error
    if not isinstance(future, Future):
        raise WorkError(f"the executor returned {_brief(repr(future))} for a call, expected a Future. {_EXPECTED}")
    return future


def check_result(future: Future[Any], work: object, chunk: Chunk[Item]) -> ExecutorResult[Any]:
    """Results of a chunk, or the reason for their absence.

    Raises `WorkError` if the executor has ended, if its processes have other sources or libraries, or if the chunk
    cannot be sent to them.
    """
    try:
        found = future.result()
    except CancelledError:
        raise WorkError(GONE) from None
    except ModuleNotFoundError as error:
        raise WorkError(
            f"a process of the executor cannot import the function to call ({error}). {cluster.INSTALL}"
        ) from None
    except Exception as error:
        deaths = cluster.deaths(error)
        if not deaths:
            _check_sent((work, chunk))
        return ExecutorResult([], deaths=deaths, fault="" if deaths else _words(error))
    if not isinstance(found, ChunkResult):
        return ExecutorResult([], fault=f"{_brief(repr(found))} returned instead of results")
    if found.origin != origin():
        raise WorkError(
            "a process of the executor has another version of inerter, other numerical libraries, or lacks what this "
            "process registered. "
            f"{cluster.INSTALL}"
        )
    if found.chunk != chunk.number:
        return ExecutorResult([], fault="results of another chunk returned")
    results = list(found.results)
    if isinstance(found.error, MemoryError):
        return ExecutorResult(results, deaths=1)
    if found.error is None and len(results) != len(chunk.items):
        return ExecutorResult([], fault=f"{len(results)} results of {len(chunk.items)} returned")
    return ExecutorResult(results, found.seconds, error=found.error)


def _check_sent(call: object) -> None:
    """Raise `WorkError` if a call cannot be sent to another process."""
    try:
        pickle.dumps(call)
    except Exception as error:
        raise WorkError(
            f"this work cannot be sent to other processes ({error}). Define user classes and functions at module "
            f"level, not inside a function; or leave the executor out."
        ) from None


def _words(error: Exception) -> str:
    """The error of another library, in one line."""
    text = _brief(str(error))
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _brief(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}..."
