"""Ctrl-C as one exception, wherever it arrives."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interruptible() -> Iterator[None]:
    """Ctrl-C leaves the block as KeyboardInterrupt.

    The call of a compiled function may go on after the signal's exception is set and return its result: Python then
    raises SystemError ("returned a result with an exception set") whose cause is the KeyboardInterrupt, or another
    such error from a call inside, and so on down to it.
    """
    try:
        yield
    except SystemError as error:
        cause: BaseException | None = error
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise KeyboardInterrupt from None
        raise
