"""Files that are there as a whole or not at all: written beside their place, safe on disk, and only then renamed."""

from __future__ import annotations

import errno
import io
import os
import secrets
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from inerter.errors import InerterError, WorkError

if TYPE_CHECKING:
    import xarray

_UNFORESEEN = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}  # the request was right, but the disk is full or ill
_UNDER_WAY: set[Path] = set()


@contextmanager
def whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Where to write the file that is to be at `path`: it is there if the block ends well, else nothing has changed.

    The file to write has the same name, in a folder of its own. A link is followed. What is no file, such as a
    terminal, is written to as it is.
    """
    place = Path(os.path.realpath(os.fsdecode(path)))
    if place.exists() and not place.is_file():
        yield place
        return
    with scratch(place.parent) as folder:
        draft = folder / place.name
        yield draft
        if place.exists():
            shutil.copymode(place, draft)
        settle(draft)
        draft.replace(place)
        settle(place.parent)


@contextmanager
def scratch(parent: Path) -> Iterator[Path]:
    """A new folder in `parent` for what is not whole yet; gone afterwards, with all that is left in it."""
    folder = parent / f".inerter-{secrets.token_hex(4)}"
    _UNDER_WAY.add(folder)  # before it is there: an interrupt may come at any time
    try:
        folder.mkdir()
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        _UNDER_WAY.discard(folder)


def sweep() -> None:
    """Remove what `scratch` has left, before a process ends in the midst of it."""
    for folder in tuple(_UNDER_WAY):
        shutil.rmtree(folder, ignore_errors=True)


def settle(path: Path) -> None:
    """Wait until a file, or the names in a folder, are safe on disk."""
    if path.is_dir():
        if os.name == "posix":  # elsewhere a folder cannot be opened
            handle = os.open(path, os.O_RDONLY)
            with suppress(OSError):  # nor can every disk do it
                os.fsync(handle)
            os.close(handle)
        return
    with path.open("rb+") as file:
        os.fsync(file.fileno())


@contextmanager
def undisturbed() -> Iterator[None]:
    """Ctrl-C waits for the end of the block, which moves files from one place to another and does not take long."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if came:
            signal.raise_signal(signal.SIGINT)


def characters(text: str) -> str:
    """A text in which what is no character, as file names may have it, is escaped."""
    return text.encode(errors="backslashreplace").decode()


def write_text(path: Path, text: str) -> None:
    """Write a text as a whole, in `characters`."""
    with lines_of_text(path) as stream:
        stream.write(text)


@contextmanager
def lines_of_text(path: Path) -> Iterator[TextIO]:
    """Where to write a text, bit by bit, that is to be there as a whole; in `characters`."""
    with whole(path) as draft, draft.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as stream:
        yield stream


def write_netcdf(path: Path, data: xarray.Dataset) -> None:
    """Write a dataset as a whole. It is made in memory: the library that writes such files dies of a full disk."""
    import h5netcdf  # noqa: PLC0415 - heavy
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415 - heavy

    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        data.dump_to_store(H5NetCDFStore(file))
    with whole(path) as draft:
        draft.write_bytes(content.getbuffer())


@contextmanager
def export(path: str | os.PathLike[str], kind: type[InerterError], *, overwrite: bool = False) -> Iterator[Path]:
    """`whole` for a caller who asks for one file; one that is there is replaced with `overwrite` only.

    Raises `kind` if there is a file already or it cannot be written, or `WorkError` if the disk is full.
    """
    if not overwrite and os.path.isfile(path):
        raise kind(f"{os.fsdecode(path)!r} exists: name another file, or replace it with overwrite=True.")
    try:
        with whole(path) as draft:
            yield draft
    except OSError as error:
        chosen = WorkError if is_unforeseen(error) else kind
        raise chosen(f"Cannot write {os.fsdecode(path)!r}: {error.strerror or error}.") from error


def is_unforeseen(error: OSError) -> bool:
    """Whether nobody could have known before the work that a file cannot be written."""
    return error.errno in _UNFORESEEN
