"""How a process that is ours begins and ends, so that it is quick."""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress
from typing import NoReturn

_NEW = 1_000_000  # objects until garbage is looked for; loading makes half as many, which stay


def look_for_garbage_seldom() -> None:
    """To look through all that is loaded, again and again, took a tenth of a short command."""
    gc.set_threshold(_NEW, 20, 100)


def leave(code: int = 0) -> NoReturn:
    """End at once, when all that was to be done at the end is done.

    To take the interpreter apart, with all that it has loaded, takes 0.8 s after an optimisation with figures.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # none, nobody who reads it, or closed
            stream.flush()
    os._exit(code)
