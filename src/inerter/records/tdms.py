"""Records from LabVIEW's TDMS files, by nptdms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.optional import library, translated

_WHAT = "a TDMS file"
_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "Unit", "unit")
_BLOCK = 1 << 20  # samples


@contextmanager
def opened(path: str, source: str) -> Iterator[Contents]:
    """The channels of all groups. A waveform's increment gives its times.

    Raises `RecordError` if the file is damaged, or nptdms is missing.
    """
    nptdms = library("nptdms", "tdms", "TDMS files")
    with translated(source, _WHAT, "nptdms"):
        file = nptdms.TdmsFile.open(path)
    with file:
        found = [channel for group in file.groups() for channel in group.channels() if _holds_numbers(channel)]
        channels = tuple(
            Channel(f"{channel.group_name}/{channel.name}", _unit(channel), channel.name, channel) for channel in found
        )

        def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
            with translated(source, _WHAT, "nptdms"):
                return [_samples(c.key, at, len(chosen), progress) for at, c in enumerate(chosen)]

        cut = getattr(getattr(file, "file_status", None), "incomplete_final_segment", False)
        meta = {"properties": {key: str(value) for key, value in file.properties.items()}, "cut": bool(cut)}
        yield Contents(channels, read, meta=meta)


def _holds_numbers(channel: Any) -> bool:
    kind = getattr(channel, "dtype", None)
    return kind is not None and np.dtype(kind).kind in "fiubcM"


def _unit(channel: Any) -> str:
    if np.dtype(channel.dtype).kind == "M":
        return "s"  # instants, which are read as the time since the first
    return str(next((channel.properties[key] for key in _UNIT_KEYS if channel.properties.get(key)), ""))


def _samples(channel: Any, at: int, count: int, progress: Progress) -> Samples:
    size = len(channel)
    first = channel[:1]
    if first.dtype.kind == "M":
        instants = channel[:]
        progress((at + 1) / count)
        return Samples((instants - first).astype("timedelta64[ns]").astype(float) * 1e-9)
    values = np.empty(size, dtype=first.dtype if first.dtype.kind == "c" else float)
    for start in range(0, size, _BLOCK):
        values[start : start + _BLOCK] = channel[start : start + _BLOCK]
        progress((at + min((start + _BLOCK) / size, 1.0)) / count)
    return Samples(values, _times(channel, size))


def _times(channel: Any, size: int) -> Any:
    interval = channel.properties.get("wf_increment")
    if not interval:
        return None
    offset = float(channel.properties.get("wf_start_offset") or 0.0)
    return offset + float(interval) * np.arange(size)
