"""Tabulated signals: held random numbers, and measured time histories."""

from __future__ import annotations

import csv
import io
import math
import os
import re
from pathlib import Path

import numpy as np

from inerter.errors import SignalError, UnitError
from inerter.formatting import format_alike, format_number, format_quantity
from inerter.signals.arguments import Array, positive_number, random_generator, whole_number
from inerter.signals.signal import SampledSignal, Signal
from inerter.units import parse_quantity, quote_value

_DELIMITERS = (";", "\t")  # else a comma; with these a decimal comma may be
_HEADING = re.compile(r"\s*(\w+)\s*\[([^\]]+)\]\s*")


def held_noise(
    seed: int, power: float, interval: float = 1e-3, duration: float = 100.0, speed: float | None = None
) -> SampledSignal:
    """Band-limited white noise: independent normal samples, each held for `interval`, that repeat after `duration` [s].

    `power` is the two-sided density [unit^2/Hz] at low frequencies, so a sample has the standard deviation
    sqrt(power / interval): 3.162 mm for 1e-8 m^2/Hz and 1 ms. Source: Wang and Su (2008), the approximated linear
    model.

    Raises `SignalError` unless `power` is positive, `duration` is a whole number of intervals and `seed` is a
    non-negative integer.

    >>> import inerter as it
    >>> noise = it.held_noise(0, 3.162e-3, duration=1.0)  # seed, r.m.s. [m], s
    >>> noise.hold
    'zero'
    """
    power = positive_number("The power of a noise", power, "its unit squared per Hz")
    interval = positive_number("The interval of a noise", interval, "s")
    duration = positive_number("The duration of a noise", duration, "s")
    count = whole_number(duration, interval, "A duration")
    value = math.sqrt(power / interval) * random_generator(seed).standard_normal(count)
    label = f"noise of {format_number(power)} per Hz, held for {format_quantity(interval, 's', 6)}, seed {seed}"
    time = np.linspace(0.0, duration, count + 1)
    return Signal.sampled(time, np.resize(value, count + 1), "zero", periodic=True, speed=speed, label=label)


def read_signal(
    path: str | os.PathLike[str],
    unit: str = "m",
    hold: str = "cubic",
    *,
    periodic: bool = False,
    speed: float | None = None,
) -> SampledSignal:
    """Signal of a table of samples over time in a file, as by `Signal.sampled`.

    `path` is a CSV file with a column of times and one of values, with their units in the header, such as
    `time [s], value [mm]`, or with semicolons or tabs, and then decimal commas or points; `unit` is that of the signal,
    m, N or m/s^2.

    Raises `SignalError`, which names the line, for a file that cannot be read in this way, and as `Signal.sampled`
    does.
    """
    if not isinstance(path, str | os.PathLike):
        raise SignalError(f"The path of a record must be that of a CSV file; got {path!r}.")
    name = os.fspath(path)
    time, value = _columns(name, "record", {"time": "s", "value": unit})
    return Signal.sampled(time, value, hold, periodic=periodic, speed=speed, label=f"record {Path(name).name}")


def _columns(name: str, what: str, units: dict[str, str]) -> Array:
    """(2, points): the two columns of a CSV file whose header names them, in `units`; the first must increase."""
    first = next(iter(units))
    heading, *rows = _rows(name, what, units)
    order, scales = _header(name, units, *heading)
    points: list[list[float]] = []
    for line, cells in rows:
        numbers = [_number(name, line, cell) * scale for cell, scale in zip(cells, scales, strict=True)]
        points.append([numbers[column] for column in order])
        if len(points) > 1 and points[-1][0] <= points[-2][0]:
            before, after = format_alike([points[-2][0], points[-1][0]], units[first], 9)
            raise SignalError(
                f"{name}, line {line}: the {first}s of a {what} must increase, got {after} after {before}."
            )
    if len(points) < 2:
        raise SignalError(f"{name}: a {what} requires at least two points, got {len(points)}.")
    return np.array(points).T


def _example(units: dict[str, str]) -> str:
    return 'such as "{}"'.format(", ".join(f"{c} [{'mm' if c == 'height' else u}]" for c, u in units.items()))


def _rows(name: str, what: str, units: dict[str, str]) -> list[tuple[int, list[str]]]:
    """The non-empty lines with their numbers, each of two cells; at least one."""
    try:
        with open(name, encoding="utf-8-sig", newline="") as file:
            text = file.read()
            mark = next((mark for mark in _DELIMITERS if mark in text.lstrip().partition("\n")[0]), ",")
            reader = csv.reader(io.StringIO(text, newline=""), strict=True, delimiter=mark)
            rows = [(reader.line_num, cells) for cells in reader if any(cell.strip() for cell in cells)]
    except FileNotFoundError:
        raise SignalError(f"{name}: file not found in {os.getcwd()!r}. Check the path.") from None
    except (OSError, ValueError, csv.Error) as problem:
        raise SignalError(f"The {what} {name!r} cannot be read as a CSV file: {problem}.") from None
    if mark != ",":
        rows = [(line, [cell.replace(",", ".") for cell in cells]) for line, cells in rows]
    for line, cells in rows:
        if len(cells) != 2:
            raise SignalError(
                f"{name}, line {line}: expected two cells with a comma between them, "
                f"got {len(cells)} in {quote_value(','.join(cells))}."
            )
    if not rows:
        raise SignalError(
            f"The {what} {name!r} is empty; expected a header, {_example(units)}, and at least two points."
        )
    return rows


def _header(name: str, units: dict[str, str], line: int, cells: list[str]) -> tuple[list[int], list[float]]:
    """Positions of the columns, and the size of the unit of each cell in the required unit."""
    found = [_HEADING.fullmatch(cell) for cell in cells]
    names = [match[1].lower() if match else "" for match in found]
    if sorted(names) != sorted(units):
        raise SignalError(
            f"{name}, line {line}: expected a header with units, {_example(units)}, got {quote_value(','.join(cells))}."
        )
    try:
        scales = [parse_quantity(f"1 {match[2].strip()}", units[match[1].lower()]) for match in found if match]
    except UnitError as problem:
        raise SignalError(f"{name}, line {line}: {problem}") from None
    return [names.index(column) for column in units], scales


def _number(name: str, line: int, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise SignalError(
            f"{name}, line {line}: expected a finite number with a decimal point, got {quote_value(cell)}."
        )
    return value
