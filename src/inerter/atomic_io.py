"""Atomic writing of files: to a temporary folder, synchronised to disk, then renamed."""

from __future__ import annotations

import csv
import errno
import io
import os
import secrets
import shutil
import signal
import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from inerter.errors import InerterError, WorkError

if TYPE_CHECKING:
    import xarray

_DISK_FAILURES = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}  # valid request, but a full or faulty disk
_OPEN_FOLDERS: set[Path] = set()


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Path of a temporary file that replaces `path` at the end of the block, unless the block raises.

    The temporary file has the same name, in a separate folder. Symbolic links are followed. A path that is not a
    regular file, such as a terminal, is written to directly.
    """
    place = Path(os.path.realpath(os.fsdecode(path)))
    if place.exists() and not place.is_file():
        yield place
        return
    with temporary_folder(place.parent) as folder:
        draft = folder / place.name
        yield draft
        if place.exists():
            shutil.copymode(place, draft)
        sync_to_disk(draft)
        draft.replace(place)
        sync_to_disk(place.parent)


@contextmanager
def temporary_folder(parent: Path) -> Iterator[Path]:
    """New folder in `parent` for incomplete files, which is removed at the end of the block."""
    folder = parent / f".inerter-{secrets.token_hex(4)}"
    _OPEN_FOLDERS.add(folder)  # before it exists: an interrupt may occur at any time
    try:
        folder.mkdir()
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        _OPEN_FOLDERS.discard(folder)


def remove_temporary_folders() -> None:
    """Remove the folders of `temporary_folder` that still exist, before the process ends."""
    for folder in tuple(_OPEN_FOLDERS):
        shutil.rmtree(folder, ignore_errors=True)


def sync_to_disk(path: Path) -> None:
    """Synchronise a file, or the entries of a folder, to disk."""
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
def defer_interrupts() -> Iterator[None]:
    """Defer Ctrl-C to the end of the block, which should be short."""
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


def escape_surrogates(text: str) -> str:
    """Text with lone surrogates, which file names may contain, escaped."""
    return text.encode(errors="backslashreplace").decode()


def write_text(path: Path, text: str) -> None:
    """Write a text atomically, with `escape_surrogates`."""
    with open_text(path) as stream:
        stream.write(text)


@contextmanager
def open_text(path: Path) -> Iterator[TextIO]:
    """Text stream to a file that is replaced atomically, with `escape_surrogates`."""
    with (
        atomic_write(path) as draft,
        draft.open("w", encoding="utf-8", errors="backslashreplace", newline="\n") as stream,
    ):
        yield stream


def write_netcdf(path: Path, data: xarray.Dataset) -> None:
    """Write a dataset atomically. It is built in memory, as the HDF5 library crashes on a full disk."""
    content = netcdf_content(data)
    with atomic_write(path) as draft:
        draft.write_bytes(content)


def netcdf_content(data: xarray.Dataset) -> bytes:
    """Content of the netCDF file of a dataset."""
    import h5netcdf  # noqa: PLC0415 - heavy
    from xarray.backends import H5NetCDFStore  # noqa: PLC0415 - heavy

    content = io.BytesIO()
    with h5netcdf.File(content, "w") as file:
        data.dump_to_store(H5NetCDFStore(file))
    return content.getvalue()


@contextmanager
def export(path: str | os.PathLike[str], kind: type[InerterError], *, overwrite: bool = False) -> Iterator[Path]:
    """`atomic_write` for a file that a caller names; an existing file is replaced only with `overwrite`.

    Raises `kind` if the file exists or cannot be written, or `WorkError` if the disk is full.
    """
    if not overwrite and os.path.isfile(path):
        raise kind(f"{os.fsdecode(path)!r} exists. Name another file, or replace it with overwrite=True.")
    try:
        with atomic_write(path) as draft:
            yield draft
    except OSError as error:
        chosen = WorkError if is_disk_failure(error) else kind
        raise chosen(f"Cannot write {os.fsdecode(path)!r}: {error.strerror or error}.") from error


def export_csv(
    path: str | os.PathLike[str],
    kind: type[InerterError],
    header: Sequence[str],
    rows: Iterable[Sequence[float | str]],
    *,
    overwrite: bool,
) -> None:
    """Write a table whose numbers read back to the last bit; see `export`."""
    with export(path, kind, overwrite=overwrite) as draft, draft.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def is_disk_failure(error: OSError) -> bool:
    """Whether an error is due to a full or faulty disk, not to the request."""
    return error.errno in _DISK_FAILURES
