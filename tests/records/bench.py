"""One measurement on a bench, and files of it as other programs write them."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from asammdf import MDF, Signal
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy.io import savemat

from inerter.records.record import Record

OMEGA = 2.0 * np.pi * 3.0
KGF = 9.80665  # N, exactly


def bench(samples: int = 500, rate: float = 500.0, seed: int = 0) -> Record:
    """A 3 Hz motion of 1 mm, read to 1 um, of an inerter of 100 kg with 10 N of friction, read to 0.02 kgf."""
    time = np.arange(samples) / rate
    phase = OMEGA * time + 0.4
    displacement = np.round(1e3 * np.cos(phase)) * 1e-6
    force = -100.0 * OMEGA**2 * 1e-3 * np.cos(phase) - 10.0 * np.sign(np.sin(phase))
    force = np.round((force + np.random.default_rng(seed).normal(0.0, 0.1, samples)) / (0.02 * KGF)) * 0.02 * KGF
    return Record(time, displacement, force, source="bench")


def write_csv(
    path: Path, header: list[list[str]], columns: list[Any], delimiter: str = ",", decimal: str = "."
) -> Path:
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, delimiter=delimiter)
        writer.writerows(header)
        for row in zip(*columns, strict=True):
            writer.writerow([repr(float(value)).replace(".", decimal) for value in row])
    return path


def write_tdms(path: Path, channels: dict[str, Any], group: str = "Measurement", **properties: dict[str, Any]) -> Path:
    """`properties` are those of each channel, by name."""
    objects = [ChannelObject(group, name, values, properties.get(name, {})) for name, values in channels.items()]
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([RootObject({"Operator": "nobody"}), GroupObject(group), *objects])
    return path


def write_mdf(path: Path, *groups: list[tuple[str, Any, Any, str]], version: str = "4.10") -> Path:
    """Each group is a list of name, times, values and unit."""
    with MDF(version=version) as file:
        for group in groups:
            file.append(
                [Signal(np.array(values), np.array(t), name=name, unit=unit) for name, t, values, unit in group]
            )
        file.save(path, overwrite=True)
    return path


def write_mat(path: Path, **variables: Any) -> Path:
    """A list of dictionaries with the same keys is an array of structs."""
    savemat(path, {name: _with_struct_arrays(value) for name, value in variables.items()})
    return path


def _with_struct_arrays(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _with_struct_arrays(inner) for name, inner in value.items()}
    if not isinstance(value, list):
        return value
    array = np.empty((1, len(value)), dtype=[(field, "O") for field in value[0]])
    for at, row in enumerate(value):
        array[0, at] = tuple(_with_struct_arrays(inner) for inner in row.values())
    return array


def write_mat73(path: Path, **variables: Any) -> Path:
    """As MATLAB does with -v7.3: HDF5 behind a header of 512 bytes, matrices transposed, texts as 16-bit codes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        _fill(file, variables)
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan 1 00:00:00 2024 HDF5 schema 1.00 ."
    with open(path, "r+b") as stream:
        stream.write(text.ljust(116) + b" " * 8 + b"\x00\x02IM")
    return path


def _fill(group: Any, variables: dict[str, Any]) -> None:
    for name, value in variables.items():
        if isinstance(value, dict):
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_("struct")
            _fill(inner, value)
        elif isinstance(value, list):  # an array of structs: a group with an array of references for each field
            inner = group.create_group(name)
            inner.attrs["MATLAB_class"] = np.bytes_("struct")
            for field in value[0]:
                parts = group.file.require_group("#refs#").create_group(f"{name}-{field}")
                _fill(parts, {str(at): row[field] for at, row in enumerate(value)})
                refs = inner.create_dataset(field, (len(value), 1), dtype=h5py.ref_dtype)
                for at in range(len(value)):
                    refs[at, 0] = parts[str(at)].ref
        elif isinstance(value, str):
            data = group.create_dataset(name, data=np.array([[ord(c)] for c in value], dtype=np.uint16))
            data.attrs["MATLAB_class"] = np.bytes_("char")
            data.attrs["MATLAB_int_decode"] = 2
        else:
            data = group.create_dataset(
                name, data=np.atleast_2d(value).T if np.ndim(value) > 1 else np.atleast_2d(value)
            )
            data.attrs["MATLAB_class"] = np.bytes_("double")
