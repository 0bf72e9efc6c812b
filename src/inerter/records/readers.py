"""Reading a record from a file: channels selected, converted to SI units and interpolated to common times."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from inerter.errors import RecordError
from inerter.formatting import format_quantity
from inerter.records import matlab, mdf, tables, tdms
from inerter.records.channel_selection import Roles, channel_example, checked_roles, select_channels
from inerter.records.channel_units import check_present, check_units, is_unit_of_role, scale
from inerter.records.channels import Channel, Contents, Progress, Samples, ignore_progress
from inerter.records.dropouts import fill_dropouts
from inerter.records.gaps import fill_missing, have_same_times, resample_onto_force
from inerter.records.prepare import with_missing_times
from inerter.records.record import Record, scale_readings
from inerter.records.remedy import Action, Remedy
from inerter.validation import check_positive, checked

Opener = Callable[[str, str], AbstractContextManager[Contents]]
FORMATS: dict[str, tuple[str, Opener]] = {
    ".csv": ("text", tables.open_channels),
    ".tsv": ("text", tables.open_channels),
    ".txt": ("text", tables.open_channels),
    ".tdms": ("TDMS", tdms.open_channels),
    ".mf4": ("MDF", mdf.open_channels),
    ".mdf": ("MDF", mdf.open_channels),
    ".mat": ("MAT", matlab.open_channels),
}
_OPTIONAL = ("velocity", "acceleration")
# First bytes of files of each kind, and a remedy for those that are not read.
_MAGIC = (
    (b"TDSm", "TDMS", "Rename it to end in .tdms."),
    (b"MDF ", "MDF", "Rename it to end in .mf4."),
    (b"UnFinMF", "MDF", "Rename it to end in .mf4."),
    (b"MATLAB ", "MAT", "Rename it to end in .mat."),
    (b"\x89HDF", "HDF5", "Export it as CSV, or as a MAT file of version 7.3."),
    (b"PK\x03\x04", "Excel or zip", "Export the sheet as CSV, or unpack it."),
    (b"\x1f\x8b", "gzip", "Unpack it first."),
    (b"%PDF", "PDF", "Export the measurement as CSV."),
)


@checked(RecordError)
def read_record(
    path: str | os.PathLike[str],
    *,
    units: dict[str, str] | None = None,
    interval: float | None = None,
    gaps: str | float = "refuse",
    force_range: float | None = None,
    period: float | None = None,
    progress: Progress | None = None,
    **named: Unpack[Roles],
) -> Record:
    r"""The record in a file of measurements: .csv, .tsv, .txt, .tdms, .mf4, .mdf or .mat.

    The channels are the keywords `displacement`, `force`, `time`, `velocity` and `acceleration`. One is named as in the
    file ("Load", "group/Load", "run.load"), numbered from 0, or found by an obvious name in English, German or French
    (time, displacement, position, x, force, load, Zeit, Weg, Kraft, temps, ...), which a note reports where there was a
    choice. Units come from the file; `units`, such as {"force": "kgf"}, adds or overrides them, and may state the value
    of one volt or count, {"force": "250 N"}, also where the file has millivolts.
    `interval` [s] gives the sampling interval where the file has no times, or overrides them.

    Missing samples and values that are not finite are refused; `gaps="fill"` interpolates up to 10 in a row, a number
    those up to so many seconds, and `gaps="longest"` keeps the longest part without any. The same applies to rows
    missing in an even clock, and to samples dropped without a gap in the time channel, as detected from the
    displacement; `gaps="refuse"` leaves those unchanged.
    `progress` is called with the fraction read so far.

    Raises `RecordError` for a file, channel or unit that cannot be used, with a remedy.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder) / "bench.csv"
    ...     _ = table.write_text("time [s],Weg [mm],Kraft [kN]\n" + "".join(f"{i / 100},{i},{i}\n" for i in range(9)))
    ...     record = it.read_record(table)
    >>> float(record.displacement[1]), float(record.force[1])  # m, N
    (0.001, 1000.0)
    """
    asked, units = checked_roles(named), check_units(units)
    name = _checked_path(path)
    source = Path(name).name
    opener = _opener(name, source)
    _check_interval(interval, asked["time"])
    with opener(name, source) as contents:
        chosen, said = select_channels(source, contents, asked, timed=interval is not None)
        scales, notes = _scales(source, chosen, units, asked)
        samples = dict(zip(chosen, contents.read(list(chosen.values()), progress or ignore_progress), strict=True))
    channels = {role: _to_si_units(source, chosen[role], samples[role], scales[role]) for role in chosen}
    channels, more = _with_times(contents, source, chosen, channels, interval)
    channels, filled_in, filled = fill_missing(source, channels, gaps)
    meta = {
        **contents.meta,
        "channels": {role: channel.name for role, channel in chosen.items()},
        "units": {role: units.get(role, channel.unit) for role, channel in chosen.items()},
        **({"filled": filled} if filled else {}),
    }
    values: dict[str, Any] = {role: samples.values for role, samples in channels.items()}
    record = Record(
        **values,
        source=source,
        notes=(*contents.notes, *said, *notes, *more, *filled_in),
        force_range=force_range,
        period=period,
        meta=meta,
    )
    return fill_dropouts(with_missing_times(record, gaps), gaps)


def _checked_path(path: str | os.PathLike[str]) -> str:
    name = os.fsdecode(path)
    if os.path.isdir(name):
        raise RecordError(f"{name!r} is a folder. Give the path of a file in it.")
    if not os.path.exists(name):
        raise RecordError(f"{name}: file not found in {os.getcwd()!r}. Check the path.")
    return name


def _opener(name: str, source: str) -> Opener:
    """Reader for a file of that suffix, if its first bytes agree with it."""
    suffix = Path(name).suffix.lower()
    if suffix not in FORMATS:
        raise RecordError(
            f"{source}: unsupported file suffix {suffix!r}; supported: {', '.join(FORMATS)}. Export or rename the file."
        )
    expected, opener = FORMATS[suffix]
    try:
        with open(name, "rb") as file:
            head = file.read(128)
    except OSError as problem:
        raise RecordError(f"{source} cannot be opened: {problem.strerror}.") from None
    found, advice = next(((what, to) for magic, what, to in _MAGIC if head.startswith(magic)), ("text", ""))
    if found == "text" and expected != "text":
        blank = "an empty file" if not head else "a blank file"
        found = blank if not head.strip(b" \0\r\n\t") else "another format"
        advice = "Check that the file is complete and its suffix correct."
    if found != expected and not (expected == "MAT" and found == "HDF5"):
        raise RecordError(f"{source}: the suffix indicates {expected}, but the first bytes indicate {found}. {advice}")
    return opener


def _check_interval(interval: float | None, time: str | int | None) -> None:
    if interval is None:
        return
    check_positive(RecordError, "The interval between samples", interval, "s")
    if time is not None:
        raise RecordError(
            f"Give either the interval ({format_quantity(interval, 's', 6)}) or the time channel ({time!r}), not both."
        )


def _scales(
    source: str, chosen: dict[str, Channel], units: dict[str, str], asked: dict[str, str | int | None]
) -> tuple[dict[str, float], list[str]]:
    """Size of the unit of each channel in SI units, and notes.

    Velocities and accelerations whose unit does not fit are left out unless named in the call.
    """
    scales, notes = {}, []
    needed = {role: c for role, c in chosen.items() if role not in _OPTIONAL or asked[role] is not None}
    check_present(source, needed, units)
    for role, channel in list(chosen.items()):
        wanted = asked[role] is not None or role in units or role not in _OPTIONAL
        if not wanted and not is_unit_of_role(role, channel.unit):
            del chosen[role]
            notes.append(f"The channel {channel.label} was left out: its unit is not a unit of {role}.")
            continue
        scales[role], _, note = scale(source, role, channel, units.get(role))
        notes += [note] if note else []
    return scales, notes


def _to_si_units(source: str, channel: Channel, samples: Samples, factor: float) -> Samples:
    values = np.asarray(samples.values)
    if values.dtype.kind == "c":
        raise RecordError(f"{source}: {channel.name!r} contains complex numbers; a record requires real numbers.")
    if values.dtype.kind not in "fiub" or values.ndim != 1:
        raise RecordError(
            f"{source}: {channel.name!r} contains {values.dtype} of shape {values.shape}; a record requires a vector "
            f"of real numbers."
        )
    own = values.dtype == np.float64 and values.flags.owndata and values.flags.writeable
    values = values if own else values.astype(float)
    inverse = 1.0 / factor
    if abs(inverse) > 1.0 and abs(inverse - round(inverse)) < 1e-9 * abs(inverse):
        return Samples(np.divide(values, round(inverse), out=values), samples.time)  # exact, as multiplying is not
    return Samples(scale_readings(f"{source}: {channel.name!r}", values, factor, out=values), samples.time)


def _with_times(
    contents: Contents, source: str, chosen: dict[str, Channel], channels: dict[str, Samples], interval: float | None
) -> tuple[dict[str, Samples], list[str]]:
    """All channels on common times, with a time channel, and notes."""
    notes = []
    if contents.meta.get("cut"):
        shortest = min(samples.values.size for samples in channels.values())
        notes.append(f"The file is truncated: the first {shortest} samples are complete and were kept.")
        channels = {
            role: Samples(samples.values[:shortest], None if samples.time is None else samples.time[:shortest])
            for role, samples in channels.items()
        }
    rasters = {role: samples.time for role, samples in channels.items()}
    timed = "time" not in channels and interval is None
    if timed and any(time is None for time in rasters.values()):
        raise RecordError(
            f"{source}: time channel not found by an obvious name, and the sampling interval is unknown. Name the "
            f"time, ",
            *("such as ", channel_example(contents.channels, "time"), ", or give ", Remedy(Action.INTERVAL, 1e-3), "."),
        )
    if timed and not have_same_times([time for time in rasters.values() if time is not None]):
        return resample_onto_force(source, channels)
    sizes = {role: samples.values.size for role, samples in channels.items()}
    if len(set(sizes.values())) > 1:
        counts = ", ".join(f"{chosen[role].name!r} {size}" for role, size in sizes.items())
        raise RecordError(
            f"{source}: the channels have different numbers of samples ({counts}), so they have no common times. "
            f"Select channels that were sampled together."
        )
    size = channels["force"].values.size
    if interval is not None:
        channels = {"time": Samples(interval * np.arange(size)), **channels}
        notes.append(f"Sampling interval {format_quantity(interval, 's', 6)} as specified in the call.")
    elif timed:
        time = rasters["force"]
        channels = {"time": Samples(np.array(time)), **channels} if time is not None else channels
    return channels, notes
