"""Records from MATLAB's MAT files, of versions 5 to 7.3, by pymatreader."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from inerter.records.channels import Channel, Contents, Progress, Samples
from inerter.records.optional import library, translated

_WHAT = "a MAT file"
_UNITS = ("unit", "units")


@contextmanager
def opened(path: str, source: str) -> Iterator[Contents]:
    """The vectors of the file, those of structs by "run.position", the columns of a matrix by "data[0]".

    The unit of a vector is a text beside it: `unit` or `units` in its own struct, or a struct `units` with a text of
    the vector's name.

    Raises `RecordError` if the file is damaged, or pymatreader is missing.
    """
    pymatreader = library("pymatreader", "mat", "MAT files")
    with translated(source, _WHAT):
        variables = pymatreader.read_mat(path)
    channels = tuple(_channels({name: v for name, v in variables.items() if not name.startswith("__")}, "", {}))

    def read(chosen: Sequence[Channel], progress: Progress) -> list[Samples]:
        progress(1.0)
        return [Samples(channel.key) for channel in chosen]

    yield Contents(channels, read)


def _channels(variables: dict[str, Any], prefix: str, above: dict[str, Any]) -> Iterator[Channel]:
    units = next((variables[key] for key in _UNITS if isinstance(variables.get(key), dict)), above)
    own = next((variables[key] for key in _UNITS if isinstance(variables.get(key), str)), "")
    for name, value in variables.items():
        if isinstance(value, dict):
            yield from _channels(value, f"{prefix}{name}.", {} if name in _UNITS else units)
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiubc" and value.size > 1:
            unit = units.get(name, own)
            short = prefix.rstrip(".").split(".")[-1] if name in ("data", "values", "value", "Data") else name
            yield from _columns(prefix + name, short or name, str(unit) if isinstance(unit, str) else "", value)


def _columns(name: str, short: str, unit: str, values: Any) -> Iterator[Channel]:
    if values.ndim == 1 or max(values.shape) == values.size:
        yield Channel(name, unit, short, values.ravel())
    elif values.ndim == 2:
        for at, column in enumerate(values.T):
            yield Channel(f"{name}[{at}]", unit, f"{short}[{at}]", column)
