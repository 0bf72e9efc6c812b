"""Ctrl-C: KeyboardInterrupt wherever it arrives, and the end of the process soon after it in any case."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from inerter.cli.streams import say
from inerter.statements import INTERRUPTED

_PATIENCE = 1.2  # [s] for the work to clean up
_kept: list[Callable[[], str]] = []
_came, _told = threading.Event(), threading.Event()


@contextmanager
def interruptible(kept: Callable[[], str] = lambda: "") -> Iterator[None]:
    """Ctrl-C leaves the block as KeyboardInterrupt with the words of `kept`, which say what is kept of the work.

    They end the sentence that begins with "interrupted", such as " before there was a fit." or "; all is kept.".

    The call of a compiled function may go on after the signal's exception is set and return its result: Python then
    raises SystemError ("returned a result with an exception set") whose cause is the KeyboardInterrupt, or another
    such error from a call inside, and so on down to it.
    """
    if not _kept:
        _told.clear()
    _kept.append(kept)
    try:
        yield
    except (KeyboardInterrupt, SystemError) as error:
        cause: BaseException | None = error
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise KeyboardInterrupt(*(cause.args or (kept(),))) from None
        raise
    finally:
        _kept.pop()


def install_interrupt_handler() -> None:
    """Install the handler by which Ctrl-C raises KeyboardInterrupt, and soon ends the process if it still runs."""
    if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:  # as it is for work in the background
        signal.signal(signal.SIGINT, _interrupt)
        sys.unraisablehook = _unraisable


def say_interrupted(kept: object = "") -> None:
    """Say once that the work was interrupted, and what is kept of it, in words as of `interruptible`."""
    if not _told.is_set():
        _told.set()
        say(f"interrupted{str(kept) or '.'}")


def was_interrupted() -> bool:
    """Whether Ctrl-C was pressed."""
    return _came.is_set()


def _interrupt(number: int, frame: FrameType | None) -> None:
    if not was_interrupted():
        _came.set()
        threading.Thread(target=_end_soon, daemon=True).start()
    raise KeyboardInterrupt


def _end_soon() -> None:
    """End the process after a delay, from a separate thread: a library may swallow the exception or wait forever."""
    time.sleep(_PATIENCE)
    from multiprocessing import active_children

    from inerter.atomic_io import remove_temporary_folders

    for process in active_children():
        process.kill()
    remove_temporary_folders()
    say_interrupted(_kept[-1]() if _kept else "")
    os._exit(INTERRUPTED)


def _unraisable(problem: Any) -> None:
    """Report an exception that cannot be raised, unless it is an interrupt: the process ends soon anyway."""
    if not issubclass(problem.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(problem)
