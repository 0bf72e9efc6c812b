"""Writing a record to a file, in SI units, for this package and others."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np
import scipy

from inerter.atomic_io import export
from inerter.errors import RecordError
from inerter.records.optional_readers import library
from inerter.records.record import CHANNELS, Record
from inerter.validation import checked

_NOT_GIVEN = "unknown source"


@checked(RecordError)
def write_record(record: Record, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Write the channels with their units; the format follows from the suffix: .csv, .tsv, .txt, .tdms, .mf4 or .mat.

    `read_record` returns the same numbers. The source and notes are written as text; the range of the load cell and the
    period are arguments of the call that reads the file.

    An existing file is replaced with `overwrite` only, and then as a whole: if that fails, it is unchanged.

    Raises `RecordError` for an existing file, an unsupported suffix, a missing folder, or a library that is not
    installed; `WorkError` if the disk is full.

    >>> import inerter as it
    >>> import numpy as np
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> time = 0.01 * np.arange(8)  # s
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "bench.csv"
    ...     it.write_record(it.Record(time, 1e-3 * time, 2.0 * time), path)
    ...     bool((it.read_record(path).force == 2.0 * time).all())
    True
    """
    name = os.fsdecode(path)
    suffix = Path(name).suffix.lower()
    if suffix not in WRITERS:
        raise RecordError(
            f"{name}: unsupported suffix; supported: {', '.join(WRITERS)}. Name a file with such a suffix."
        )
    with export(name, RecordError, overwrite=overwrite) as draft:
        WRITERS[suffix](record, str(draft))


def _write_csv(record: Record, name: str) -> None:
    with open(name, "w", encoding="utf-8", newline="") as file:
        write_record_table(record, file, ",")


def _write_tsv(record: Record, name: str) -> None:
    with open(name, "w", encoding="utf-8", newline="") as file:
        write_record_table(record, file, "\t")


def write_record_table(record: Record, file: TextIO, delimiter: str) -> None:
    """Write the channels with a heading `name [unit]`, below source and notes."""
    import pandas as pd  # noqa: PLC0415 - heavy

    headed = {f"{role} [{CHANNELS[role]}]": values for role, values in record.channels().items()}
    file.writelines(f"# {' '.join(line.split())}\n" for line in (record.source, *record.notes))
    pd.DataFrame(headed, copy=False).to_csv(file, sep=delimiter, index=False, lineterminator="\n")


def _write_tdms(record: Record, name: str) -> None:
    nptdms = library("nptdms", "tdms", "TDMS files")
    root = nptdms.RootObject({"source": record.source, "notes": "\n".join(record.notes)})
    channels = [
        nptdms.ChannelObject("record", role, values, {"unit_string": CHANNELS[role]})
        for role, values in record.channels().items()
    ]
    with nptdms.TdmsWriter(name) as writer:
        writer.write_segment([root, nptdms.GroupObject("record"), *channels])


def _write_mdf(record: Record, name: str) -> None:
    asammdf = library("asammdf", "mdf", "MDF files")
    signals = [
        asammdf.Signal(np.array(values), record.time, name=role, unit=CHANNELS[role])
        for role, values in record.channels().items()
        if role != "time"
    ]
    with asammdf.MDF(version="4.10") as file:
        file.append(signals, comment="\n".join((record.source, *record.notes)))
        file.save(name, overwrite=True, compression=1)


def write_record_matlab(record: Record, file: str | BinaryIO) -> None:
    """Write the channels, their units, source and notes as variables of a MAT-file of version 5."""
    channels = record.channels()
    units = {role: CHANNELS[role] for role in channels}
    text = {"source": record.source or _NOT_GIVEN, "notes": "\n".join(record.notes) or "none"}
    variables = {**channels, "units": units, **text}
    scipy.io.savemat(file, variables, do_compression=True, oned_as="column")  # type: ignore[arg-type]


WRITERS: dict[str, Callable[[Record, str], None]] = {
    ".csv": _write_csv,
    ".tsv": _write_tsv,
    ".txt": _write_tsv,
    ".tdms": _write_tdms,
    ".mf4": _write_mdf,
    ".mat": write_record_matlab,
}
