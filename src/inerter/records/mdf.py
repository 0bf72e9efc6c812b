"""Records from MDF files of version 3 and 4, by asammdf."""

from __future__ import annotations

import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, BinaryIO

from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.optional_readers import library, reraise_read_errors

_WHAT = "an MDF file"


@contextmanager
def open_channels(path: str, source: str) -> Iterator[Contents]:
    """The channels of all groups but their clocks; each with the times of its raster.

    Raises `RecordError` if the file is damaged, or asammdf is missing.
    """
    asammdf = library("asammdf", "mdf", "MDF files")
    with open(path, "rb") as stream:
        with reraise_read_errors(source, _WHAT, "asammdf"):
            file = _open(asammdf, stream)
        with file:
            with reraise_read_errors(source, _WHAT, "asammdf"):
                channels = tuple(_channels(file))

            def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
                with reraise_read_errors(source, _WHAT, "asammdf"):
                    return [_samples(file, c, (at + 1) / len(chosen), progress) for at, c in enumerate(chosen)]

            yield Contents(channels, read, meta={"version": str(file.version)})


def _open(asammdf: Any, stream: BinaryIO) -> Any:
    """The open file. One that cannot be opened is left closed: asammdf's own closing fails on it, and says so."""
    try:
        return asammdf.MDF(stream)
    except Exception as problem:
        for frame, _ in traceback.walk_tb(problem.__traceback__):
            half_open: Any = frame.f_locals.get("self")
            if getattr(half_open, "_tempfile", None) is not None:
                half_open._tempfile.close()
            if hasattr(half_open, "_closed"):
                half_open._closed = True
        raise


def _channels(file: Any) -> Iterator[Channel]:
    for group, contents in enumerate(file.groups):
        name = str(getattr(contents.channel_group, "acq_name", "") or f"group {group}")
        for index, channel in enumerate(contents.channels):
            if index != file.masters_db.get(group):
                unit = str(file.get_channel_unit(group=group, index=index) or "")
                yield Channel(f"{name}/{channel.name}", unit, channel.name, (group, index))


def _samples(file: Any, channel: Channel, done: float, progress: Progress) -> Samples:
    group, index = channel.key
    signal = file.get(group=group, index=index)
    invalid = getattr(signal, "invalidation_bits", None)
    values = signal.samples
    if invalid is not None and values.dtype.kind in "fiu":
        values = values.astype(float)
        values[invalid.astype(bool)] = float("nan")
    progress(done)
    return Samples(values, signal.timestamps)
