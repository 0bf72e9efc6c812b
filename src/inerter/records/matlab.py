"""Records from MATLAB's MAT files, versions 5 to 7.3, by pymatreader: plain vectors, and exports of recorders."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.records.channel_units import is_unit_of_role
from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.headings import split_heading
from inerter.records.optional_readers import library, reraise_read_errors
from inerter.units import parse_quantity

_WHAT = "a MAT file"
_UNITS = ("unit", "units")
# Keys of a struct that is one channel, or of an array of such structs, in any case.
_VALUES = ("data", "values", "value", "y", "signals")
_NAMES = ("name", "label", "signalname", "channelname")
_CLOCKS = ("time", "t", "zeit", "temps")
_STEPS = ("dt", "wf_increment", "increment", "ts")  # [s], next to values
_PORTS = re.compile(r"(out|in|value)\d*", re.IGNORECASE)  # of blocks of a model, which the path names before
_CATMAN = re.compile(r"(.+)_Data")
_OBJECTS = ("opaque", "object")
_SIMULINK = "Simulink writes times in s"
_CONTROLDESK = "ControlDesk writes times in s"
_TIMESERIES = "a timeseries without a unit of its times has them in s"


@dataclass(frozen=True)
class _Key:
    """Values of a channel, and their times [s] where they have their own."""

    values: Any
    time: NDArray[np.float64] | None = None


@contextmanager
def open_channels(path: str, source: str) -> Iterator[Contents]:
    """The vectors of the file, those of structs by "run.position", the columns of a matrix by "data[0]".

    The unit of a vector is a text next to it: `unit` or `units` in its struct, or a struct `units` with a text of
    the vector's name. Structs and arrays of structs with values, names and units are channels by these names: those of
    dSPACE ControlDesk (`X`, `Y(i)`), of Simulink (`time`, `signals(i)`), of catman (`Channel_1_Data` and its header),
    waveforms of LabVIEW (`t0`, `dt`, `Y`) and timeseries as structs (`Time`, `Data`).

    Raises `RecordError` if the file is damaged, contains only MATLAB objects, or pymatreader is missing.
    """
    pymatreader = library("pymatreader", "mat", "MAT files")
    with reraise_read_errors(source, _WHAT), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of objects, which are looked for below
        objects = _objects(path)
        variables = pymatreader.read_mat(path)
    kept = {name: v for name, v in variables.items() if not name.startswith("__") and name not in objects}
    notes: dict[str, None] = {}
    channels = tuple(_channels(_with_headers(kept), "", {}, notes))
    if objects and not channels:
        raise RecordError(
            f"{source}: {', '.join(objects)}: MATLAB objects, such as a timetable or a timeseries, cannot be read. "
            f"Save their vectors as separate variables, such as time, displacement and force."
        )

    def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
        progress(1.0)
        return [Samples(channel.key.values, channel.key.time) for channel in chosen]

    yield Contents(channels, read, tuple(f"Times were taken in s, since {note}." for note in notes))


def _objects(path: str) -> list[str]:
    """Names of variables that are objects of classes, such as timetables."""
    from scipy.io import whosmat  # noqa: PLC0415 - heavy

    try:
        return [name for name, _, kind in whosmat(path) if kind in _OBJECTS and not name.startswith("__")]
    except NotImplementedError:  # of version 7.3
        pass
    h5py = library("h5py", "mat", "MAT files of version 7.3")
    with h5py.File(path, "r") as file:
        return [name for name, value in file.items() if value.attrs.get("MATLAB_object_decode", 0) == 3]


def _channels(
    variables: Mapping[str, Any], prefix: str, above: Mapping[str, Any], notes: dict[str, None]
) -> Iterator[Channel]:
    """The channels in a struct, of which `above` has the units by name where it has none itself."""
    units = next((variables[key] for key in _UNITS if isinstance(variables.get(key), dict)), above)
    if (known := _recorder(variables, prefix, notes)) is not None:
        yield from known
        return
    own = next((variables[key] for key in _UNITS if isinstance(variables.get(key), str)), "")
    for name, value in variables.items():
        if isinstance(value, dict):
            yield from _channels(value, f"{prefix}{name}.", {} if name in _UNITS else units, notes)
        elif _is_vector(value):
            unit = units.get(name, own)
            short = prefix.rstrip(".").split(".")[-1] if name in ("data", "values", "value", "Data") else name
            yield from _columns(prefix + name, short or name, str(unit) if isinstance(unit, str) else "", _Key(value))


def _recorder(variables: Mapping[str, Any], prefix: str, notes: dict[str, None]) -> list[Channel] | None:
    """The channels of a struct as recorders write them; None for another struct."""
    keys = {key.casefold(): key for key in variables}
    if {"x", "y"} <= keys.keys() and all(isinstance(variables[keys[key]], dict) for key in ("x", "y")):
        return _control_desk(variables[keys["x"]], variables[keys["y"]], prefix, notes)
    if "signals" in keys and isinstance(variables[keys["signals"]], dict) and _is_vector(variables.get("time")):
        notes[_SIMULINK] = None
        clock = Channel(f"{prefix}time", "s", "time", _Key(variables["time"]))
        return [clock, *_rows(variables[keys["signals"]], prefix, None)]
    step = next((variables[keys[key]] for key in _STEPS if key in keys and np.ndim(variables[keys[key]]) == 0), None)
    values = _row_values(variables)
    if step is not None and len(values) == 1 and isinstance(step, int | float) and step > 0.0:
        start = variables.get(keys.get("t0", ""), 0.0)
        first = float(start) if isinstance(start, int | float) else 0.0
        return _rows(variables, prefix, np.asarray(first + float(step) * np.arange(np.size(values[0])), dtype=float))
    clocks = [variables[keys[key]] for key in _CLOCKS if key in keys and _is_vector(variables[keys[key]])]
    if len(clocks) == 1 and len(values) == 1 and np.size(values[0]) == np.size(clocks[0]) and "data" in keys:
        second = _seconds_per_unit(variables, keys, notes)
        return None if second is None else _rows(variables, prefix, second * np.ravel(clocks[0]).astype(float))
    return _rows(variables, prefix, None) if len(values) > 1 or (values and _texts(variables, _NAMES)) else None


def _seconds_per_unit(variables: Mapping[str, Any], keys: Mapping[str, str], notes: dict[str, None]) -> float | None:
    """Unit of the times of a timeseries [s]; None if it is not a unit of time."""
    about = variables.get(keys.get("timeinfo", ""), {})
    unit = about.get("Units", "") if isinstance(about, dict) else ""
    if not isinstance(unit, str) or not unit:
        notes[_TIMESERIES] = None
        return 1.0
    return parse_quantity(f"1 {unit}", "s") if is_unit_of_role("time", unit) else None


def _control_desk(x: Mapping[str, Any], y: Mapping[str, Any], prefix: str, notes: dict[str, None]) -> list[Channel]:
    """Channels over one raster, whose times are a channel too, or over several, of which each has its own times."""
    clocks = [np.ravel(values) for values in _row_values(x)]
    units = _texts(x, _UNITS) or [""] * len(clocks)
    if not all(units):
        notes[_CONTROLDESK] = None
    if len(clocks) == 1:
        unit = units[0] or "s"
        return [Channel(f"{prefix}X", unit, "time", _Key(clocks[0])), *_rows(y, f"{prefix}Y.", None)]
    which = y.get("XIndex", y.get("Raster"))
    rows = _rows(y, f"{prefix}Y.", None)
    if not isinstance(which, list) or len(which) != len(rows):
        return rows
    times = [parse_quantity(f"1 {u or 's'}", "s") * t.astype(float) for t, u in zip(clocks, units, strict=True)]
    return [
        replace(row, key=replace(row.key, time=times[int(at) - 1])) if 1 <= int(at) <= len(times) else row
        for row, at in zip(rows, which, strict=True)
    ]


def _rows(table: Mapping[str, Any], prefix: str, time: NDArray[np.float64] | None) -> list[Channel]:
    """The channels of a struct, or of an array of structs, with values, and names and units where they are."""
    values, names, units = _row_values(table), _texts(table, _NAMES), _texts(table, _UNITS)
    about = {key.casefold(): value for key, value in table.items()}.get("datainfo")
    if not units and isinstance(about, dict):
        units = _texts(about, _UNITS)
    found: list[Channel] = []
    for at, value in enumerate(values):
        given = names[at] if at < len(names) else ""
        name, beside, short = split_heading(given)
        unit = (units[at] if at < len(units) else "") or beside
        path = prefix.rstrip(".") if len(values) == 1 else f"{prefix.rstrip('.')}({at + 1})"
        full = prefix + name if name else path
        found += _columns(full, _last_part(short) if name else path.split(".")[-1], unit, _Key(value, time))
    return found


def _row_values(table: Mapping[str, Any]) -> list[Any]:
    keys = {key.casefold(): key for key in table}
    given = next((table[keys[key]] for key in _VALUES if key in keys), None)
    rows = given if isinstance(given, list) else [given]
    return rows if all(map(_is_vector, rows)) else []


def _texts(table: Mapping[str, Any], wanted: Sequence[str]) -> list[str]:
    """The texts under one of these keys, one for each row; empty texts where there is another thing."""
    keys = {key.casefold(): key for key in table}
    given = next((table[keys[key]] for key in wanted if key in keys), None)
    rows = given if isinstance(given, list) else [given] if isinstance(given, str) else []
    return [row if isinstance(row, str) else "" for row in rows]


def _last_part(name: str) -> str:
    """The name without the path of its block in a model, and without the block's port."""
    parts = [part for part in re.split(r"[/\\]", name.replace('"', "").replace("'", "")) if part.strip()]
    while len(parts) > 1 and _PORTS.fullmatch(parts[-1].strip()):
        parts.pop()
    return parts[-1].strip() if parts else name


def _with_headers(variables: Mapping[str, Any]) -> dict[str, Any]:
    """The variables, of which those that catman writes as Channel_1_Data with a Channel_1_Header are named as there."""
    found: dict[str, Any] = {}
    for name, value in variables.items():
        match = _CATMAN.fullmatch(name)
        header = variables.get(f"{match[1]}_Header") if match else None
        if isinstance(header, dict) and _is_vector(value):
            found[name] = {
                "data": value,
                "name": "".join(_texts(header, _NAMES)),
                "unit": "".join(_texts(header, _UNITS)),
            }
        else:
            found[name] = value
    return found


def _is_vector(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.kind in "fiubc" and value.size > 1


def _columns(name: str, short: str, unit: str, key: _Key) -> Iterator[Channel]:
    values = key.values
    if values.ndim == 1 or max(values.shape) == values.size:
        yield Channel(name, unit, short, replace(key, values=values.ravel()))
    elif values.ndim == 2:
        for at, column in enumerate(values.T):
            yield Channel(f"{name}[{at}]", unit, f"{short}[{at}]", replace(key, values=column))
