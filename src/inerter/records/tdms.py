"""Records from LabVIEW's TDMS files, by nptdms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from inerter.errors import RecordError
from inerter.records.channel_units import is_unit_of_role
from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.headings import split_heading
from inerter.records.optional_readers import library, reraise_read_errors
from inerter.units import parse_quantity

_WHAT = "a TDMS file"
_UNIT_KEYS = ("unit_string", "NI_UnitDescription", "Unit", "unit")
_BLOCK = 1 << 20  # samples


@contextmanager
def open_channels(path: str, source: str) -> Iterator[Contents]:
    """The channels of all groups. The increment of a waveform gives its times.

    Raises `RecordError` if the file is damaged, or nptdms is missing.
    """
    nptdms = library("nptdms", "tdms", "TDMS files")
    with reraise_read_errors(source, _WHAT, "nptdms"):
        file = nptdms.TdmsFile.open(path)
    with file:
        found = [channel for group in file.groups() for channel in group.channels() if _holds_numbers(channel)]
        channels = tuple(map(_channel_of, found))

        def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
            with reraise_read_errors(source, _WHAT, "nptdms"):
                samples = [_samples(source, c.key, at, len(chosen), progress) for at, c in enumerate(chosen)]
            return _on_one_clock(samples, [c.key.properties.get("wf_start_time") for c in chosen])

        cut = getattr(getattr(file, "file_status", None), "incomplete_final_segment", False)
        meta = {"properties": {key: str(value) for key, value in file.properties.items()}, "cut": bool(cut)}
        yield Contents(channels, read, meta=meta)


def _channel_of(channel: Any) -> Channel:
    """The channel by its name; a unit in brackets counts where no property has one."""
    unit, (name, beside, short) = _unit(channel), split_heading(channel.name)
    name = channel.name if unit else name
    return Channel(f"{channel.group_name}/{name}", unit or beside, short, channel)


def _on_one_clock(samples: list[Samples], starts: list[Any]) -> list[Samples]:
    """The samples with the times of waveforms that began at different instants counted from the first of these."""
    if any(start is None for start, found in zip(starts, samples, strict=True) if found.time is not None):
        return samples
    first = min((start for start, found in zip(starts, samples, strict=True) if found.time is not None), default=None)
    return [
        found if found.time is None else Samples(found.values, found.time + _seconds(start - first))
        for start, found in zip(starts, samples, strict=True)
    ]


def _seconds(duration: Any) -> float:
    if isinstance(duration, np.timedelta64):
        return float(duration.astype("timedelta64[ns]").astype(float) * 1e-9)
    return float(duration.total_seconds())


def _holds_numbers(channel: Any) -> bool:
    kind = getattr(channel, "dtype", None)
    return kind is not None and np.dtype(kind).kind in "fiubcM"


def _unit(channel: Any) -> str:
    if np.dtype(channel.dtype).kind == "M":
        return "s"  # instants, which are read as the time since the first
    return str(next((channel.properties[key] for key in _UNIT_KEYS if channel.properties.get(key)), ""))


def _samples(source: str, channel: Any, at: int, count: int, progress: Progress) -> Samples:
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
    return Samples(values, _times(source, channel, size))


def _times(source: str, channel: Any, size: int) -> Any:
    interval = channel.properties.get("wf_increment")
    if not interval:
        return None
    unit = str(channel.properties.get("wf_xunit_string") or "s")
    second = is_unit_of_role("time", unit) and parse_quantity(f"1 {unit}", "s")
    if not second:
        raise RecordError(
            f"{source}: the abscissa of {channel.name!r} has the unit {unit!r}, which is not a unit of time. Select "
            f"another channel."
        )
    offset = float(channel.properties.get("wf_start_offset") or 0.0)
    times = offset + float(interval) * np.arange(size)
    return times if second == 1.0 else second * times
