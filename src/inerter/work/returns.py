"""Results that an executor gives back, checked: it is somebody else's, and so may be what it gives."""

from __future__ import annotations

import pickle
from concurrent.futures import CancelledError, Executor, Future
from dataclasses import dataclass
from typing import Any, Generic

from inerter.errors import InerterError, WorkError
from inerter.work import cluster
from inerter.work.origin import origin
from inerter.work.pieces import Item, Piece, Result, Worked

GONE = "the executor that the work was handed to has ended, or lost its connection."
_EXPECTED = (
    "Expected one of concurrent.futures, such as ProcessPoolExecutor(4), or the get_executor() of a dask client."
)
_LONGEST = 200  # characters of an error of others


@dataclass(frozen=True)
class Returned(Generic[Result]):
    """Results of a piece; else how many processes have ended on it, or the fault for which it is to be done again.

    `error` is what the work itself raised, after the results that there are.
    """

    results: list[Result]
    seconds: float = 0.0
    deaths: int = 0
    fault: str = ""
    error: Exception | None = None


def check_executor(executor: object) -> None:
    """Raises `InerterError` for what is no executor."""
    if not isinstance(executor, Executor):
        raise InerterError(f"`executor`: {_brief(repr(executor))} cannot run calls. {_EXPECTED}")


def submitted(executor: Executor, *call: Any) -> Future[Any]:
    """The future of a call.

    Raises `WorkError` if the executor does not take it.
    """
    try:
        future = executor.submit(*call)
    except WorkError:
        raise
    except RuntimeError:  # of one that is broken, or was shut down
        raise WorkError(GONE) from None
    except Exception as error:
        raise WorkError(f"the executor does not take work ({_words(error)}).") from error
    if not isinstance(future, Future):
        raise WorkError(f"the executor returned {_brief(repr(future))} for a call, expected a Future. {_EXPECTED}")
    return future


def returned(future: Future[Any], work: object, piece: Piece[Item]) -> Returned[Any]:
    """Results of a piece, or why there are none.

    Raises `WorkError` if the executor has ended, if its processes have other sources or libraries, or if the piece
    cannot be sent to them.
    """
    try:
        found = future.result()
    except CancelledError:
        raise WorkError(GONE) from None
    except ModuleNotFoundError as error:
        raise WorkError(
            f"a process of the executor cannot load what it is to call ({error}). {cluster.INSTALL}"
        ) from None
    except Exception as error:
        deaths = cluster.deaths(error)
        if not deaths:
            _check_sent((work, piece))
        return Returned([], deaths=deaths, fault="" if deaths else _words(error))
    if not isinstance(found, Worked):
        return Returned([], fault=f"{_brief(repr(found))} came back in place of results")
    if found.origin != origin():
        raise WorkError(
            "a process of the executor has another version of inerter, or of the libraries that make its numbers. "
            f"{cluster.INSTALL}"
        )
    if found.piece != piece.number:
        return Returned([], fault="the results of another piece came back")
    results = list(found.results)
    if isinstance(found.error, MemoryError):
        return Returned(results, deaths=1)
    if found.error is None and len(results) != len(piece.items):
        return Returned([], fault=f"{len(results)} results came back of {len(piece.items)}")
    return Returned(results, found.seconds, error=found.error)


def _check_sent(call: object) -> None:
    """Raises `WorkError` if a call cannot be sent to another process."""
    try:
        pickle.dumps(call)
    except Exception as error:
        raise WorkError(
            f"this work cannot be handed to other processes ({error}). What is your own must be a class or function of "
            "a module, and not made inside a function; or leave the executor out."
        ) from None


def _words(error: Exception) -> str:
    """The error of another library, in one line."""
    text = _brief(str(error))
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _brief(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST else f"{line[:_LONGEST]}..."
