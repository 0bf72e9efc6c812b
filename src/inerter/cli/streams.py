"""Standard output and error that accept any text and never stop the work, even if closed or if the reader is gone."""

from __future__ import annotations

import io
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_raw: dict[str, _TolerantStream] = {}


class _TolerantStream(io.FileIO):
    """Stream that accepts all data; `problem` is the first error of writing."""

    problem: OSError | None = None

    def write(self, data: ReadableBuffer, /) -> int:
        try:
            return super().write(data) or 0
        except OSError as error:
            self.problem = self.problem or error
            return memoryview(data).nbytes


def replace_standard_streams() -> None:
    """Replace the standard streams of the process, once.

    A closed one is opened to the null device: a file that is opened later would otherwise receive what is printed.
    """
    if _raw:
        return
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    for number, name in ((1, "stdout"), (2, "stderr")):
        before = getattr(sys, name)
        raw = _raw[name] = _TolerantStream(number, "wb", closefd=False)
        stream = io.TextIOWrapper(
            io.BufferedWriter(raw),
            encoding=getattr(before, "encoding", "utf-8"),
            errors="backslashreplace",
            line_buffering=number == 2 or raw.isatty(),
        )
        setattr(sys, name, stream)


def output_error() -> OSError | None:
    """Reason why standard output could not be written, although a reader was connected."""
    found = _raw["stdout"].problem if "stdout" in _raw else None
    return None if isinstance(found, BrokenPipeError) else found


def say(message: str) -> None:
    """Print a message to standard error, at once."""
    print(f"inerter: {message}", file=sys.stderr, flush=True)
