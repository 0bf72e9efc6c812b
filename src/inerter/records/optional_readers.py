"""Optional reader libraries, and their errors for damaged files."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from inerter.errors import InerterError, RecordError


def library(module: str, extra: str, what: str) -> Any:
    """The imported module of that name.

    Raises `RecordError`, which names the extra, if it is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise RecordError(
            f'{what} require a library that is not installed. Install it with pip install "inerter[{extra}]".'
        ) from None


@contextmanager
def reraise_read_errors(source: str, what: str, *loggers: str) -> Iterator[None]:
    """Reraise any error of a library as a `RecordError` of one sentence, with the log of the library silenced."""
    known = [name for name in logging.root.manager.loggerDict if name.split(".")[0] in loggers]
    quiet = [logging.getLogger(name) for name in known]
    levels = [logger.level for logger in quiet]
    for logger in quiet:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    except (InerterError, MemoryError):
        raise
    except Exception as problem:  # the libraries' errors share no base: struct.error, KeyError, OSError, ...
        said = " ".join(str(problem).split())[:200].rstrip(". ") or type(problem).__name__
        raise RecordError(
            f"{source} cannot be read as {what}: the file is damaged or truncated ({said}). Copy or export it again."
        ) from None
    finally:
        for logger, level in zip(quiet, levels, strict=True):
            logger.setLevel(level)
