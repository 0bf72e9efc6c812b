"""Reading a measured profile: tables in the formats of records, and OpenCRG."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import renamed_keywords
from inerter.errors import RecordError, SignalError, UnitError
from inerter.formatting import format_quantity, format_range
from inerter.records import tables
from inerter.records.channel_selection import fold_name
from inerter.records.channels import Channel, Contents, ignore_progress
from inerter.records.optional_readers import library, reraise_read_errors
from inerter.records.remedy import Action, Remedy
from inerter.roads.profile import Profile
from inerter.signals.signal import SampledSignal
from inerter.units import is_unit, is_unit_for, parse_quantity, quote_value
from inerter.validation import check_positive, checked, is_number

Matrix = NDArray[np.float64]
_TABLES = (".csv", ".tsv", ".txt", ".dat")
# Names that identify a column, in the order in which they are sought.
_WORDS = {
    "distance": r"distance|dist|chainage|station|stationing|stationierung|position|pos|weg|strecke|distanz|abscisse"
    r"|x|s|u",
    "right": r"right|rechts|droite|r|zr",
    "height": r"left|links|gauche|l|zl|height|elevation|profile|hohe|hoehe|profil|hauteur|altitude|z|y",
}


_EXAMPLES = {"distance": "m", "height": "mm"}


class Columns(TypedDict, total=False):
    """Column of each role, by its name in the file or its number from 0."""

    distance: str | int | None
    height: str | int | None
    right: str | int | None


@checked(RecordError)
def read_profile(
    path: str | os.PathLike[str],
    *,
    units: Mapping[str, str] | None = None,
    interval: float | None = None,
    lateral: Sequence[float] | None = None,
    **named: Unpack[Columns],
) -> Profile:
    r"""The profile of a table (.csv, .tsv, .txt, .dat) or of an OpenCRG file (.crg).

    A table has columns of distances and heights, in any order, with any separator, decimal point or comma, and with a
    header or without: `distance`, `height` (of the left track, where there are two) and `right` are named as in the
    file, numbered from 0, or found by an obvious name (distance, x, height, elevation, left, right, ...); without a
    header the increasing column is the distance. Units are read from the header, or given by `units`, such as
    {"distance": "m", "height": "mm"}, for both tracks. `interval` [m] gives the spacing where there are no distances.

    `lateral` are the positions [m] at which a .crg file is read, positive to the left of its reference line: one, or
    those of the left and the right track; default: (0,). Requires PyOpenCRG (`pip install "inerter[roads]"`).

    Raises `RecordError` for a file, column or unit that cannot be used, with a remedy.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder) / "road.csv"
    ...     _ = table.write_text("distance [m],height [mm]\n" + "".join(f"{x},{x % 2}\n" for x in range(9)))
    ...     road = it.read_profile(table)
    >>> float(road.height[1])  # m
    0.001
    """
    name = _check_path(path, named)
    source, suffix = Path(name).name, Path(name).suffix.lower()
    if suffix == ".crg":
        if units is not None or interval is not None or named:
            raise RecordError("An OpenCRG file requires no units, interval or columns. Give its path, and `lateral`.")
        return _read_crg(name, source, _checked_lateral(lateral))
    if lateral is not None:
        raise RecordError("`lateral` applies to OpenCRG files; for tables, name the columns `height` and `right`.")
    return _read_table(name, source, _checked_units(units), interval, named)


@renamed_keywords(track="side")
@checked(SignalError)
def profile(path: str | os.PathLike[str], speed: float, side: str = "") -> SampledSignal:
    r"""A measured road of one track as a signal at `speed` [m/s] from its first point at t = 0, by a cubic spline.

    `path` is a file that `read_profile` reads without further arguments; for two tracks, `side` is "left" or "right".

    Raises `SignalError` for a file that cannot be read in this way, or an unknown side.

    >>> import inerter as it
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder) / "road.csv"
    ...     _ = table.write_text("distance [m],height [mm]\n" + "".join(f"{x},{x % 2}\n" for x in range(9)))
    ...     signal = it.profile(table, speed=4.0)  # m/s
    >>> signal.duration  # s for 8 m
    2.0
    """
    try:
        return read_profile(path).to_signal(speed, side)
    except RecordError as problem:
        raise SignalError(str(problem)) from None


def _check_path(path: str | os.PathLike[str], named: Columns) -> str:
    for role in named:
        if role not in Columns.__annotations__:
            raise RecordError(
                f"read_profile(...) has no argument {role!r}; columns are {', '.join(Columns.__annotations__)}."
            )
    name = os.fsdecode(path)
    if "\0" in name or os.path.isdir(name):
        raise RecordError(f"{name!r} is not a file. Give the path of a CSV or CRG file.")
    if not os.path.exists(name):
        raise RecordError(f"{name}: file not found in {os.getcwd()!r}. Check the path.")
    suffix = Path(name).suffix.lower()
    if suffix not in (*_TABLES, ".crg"):
        raise RecordError(
            f"{Path(name).name}: unsupported file suffix {suffix!r}; supported: {', '.join((*_TABLES, '.crg'))}. "
            f"Export or rename the file."
        )
    return name


def _checked_units(units: object) -> dict[str, str]:
    if units is None:
        return {}
    if not isinstance(units, Mapping) or not {*units} <= {"distance", "height"}:
        raise RecordError(f'units must be a table such as {{"distance": "m", "height": "mm"}}, got {units!r}.')
    return dict(units)


def _read_table(
    name: str, source: str, units: dict[str, str], interval: float | None, named: Mapping[str, Any]
) -> Profile:
    if interval is not None:
        check_positive(RecordError, "The interval between points", interval, "m")
        if named.get("distance") is not None:
            raise RecordError(
                f"Give either the interval ({format_quantity(interval, 'm', 6)}) or the column of distances, not both."
            )
    asked = {role: named.get(role) for role in _WORDS}
    try:
        with tables.open_channels(name, source) as contents:
            chosen = _select_columns(source, contents, asked, spaced=interval is not None)
            worth = _unit_sizes(source, chosen, units, spaced=interval is not None)
            values = _read(contents, [chosen[role] for role in worth])
    except OSError as problem:
        raise RecordError(f"{source} cannot be opened: {problem.strerror}.") from None
    found = {role: np.asarray(v * worth[role], dtype=float) for role, v in zip(worth, values, strict=True)}
    if interval is not None:
        found["distance"] = interval * np.arange(found["height"].size, dtype=float)
    return Profile(found["distance"], found["height"], found.get("right"), source, contents.notes)


def _read(contents: Contents, channels: list[Channel]) -> list[Matrix]:
    return [np.asarray(samples.values, dtype=float) for samples in contents.read(channels, ignore_progress)]


def _select_columns(
    source: str, contents: Contents, named: Mapping[str, str | int | None], spaced: bool
) -> dict[str, Channel]:
    """The column of each role; with `spaced` no distances are required."""
    channels = contents.channels
    asked = {role: _column_by_name(source, channels, role, given) for role, given in named.items() if given is not None}
    chosen = dict(asked)
    for role, words in _WORDS.items():
        if role not in chosen and not (role == "distance" and spaced):
            left = [channel for channel in channels if channel not in chosen.values()]
            alike = [channel for channel in left if _has_name(channel.name, words)]
            if len(alike) > 1:
                names = " and ".join(channel.label for channel in alike[:3])
                raise RecordError(
                    f"{source}: ambiguous {role} column: {names}. Rename one of them in the file, or select one by "
                    f"name: ",
                    *(Remedy(Action.COLUMN, ((role, alike[0].name),)), "."),
                )
            chosen |= {role: alike[0]} if alike else {}
    if chosen == asked and not any(channel.unit for channel in channels):  # no header, or a remark taken for one
        chosen |= _columns_by_order(source, contents, chosen, spaced)
    for role in ("distance", "height"):
        if role not in chosen and not (role == "distance" and spaced):
            raise _missing_column(
                source, role, [channel for channel in channels if channel not in chosen.values()], channels
            )
    if len(set(chosen.values())) < len(chosen):
        raise RecordError(f"{source}: one column is named for two of {', '.join(chosen)}. Name different columns.")
    return chosen


def _missing_column(source: str, role: str, left: Sequence[Channel], channels: Sequence[Channel]) -> RecordError:
    there = ", ".join(channel.label for channel in channels[:12])
    found = f"{source}: {role} column not found by an obvious name; available: {there}"
    even = (", or give ", Remedy(Action.INTERVAL, 0.1)) if role == "distance" else ()
    lengths = [
        channel
        for channel in left or channels
        if not channel.unit or (is_unit(channel.unit) and is_unit_for(channel.unit, "m"))
    ]
    if not lengths:
        return RecordError(f'{found}, of which no other is a length. Add a column "{role} [m]" to the file', *even, ".")
    return RecordError(
        f'{found}. Name it "{role}" in the file, or select it, such as ',
        Remedy(Action.COLUMN, ((role, lengths[0].name),)),
        *even,
        ".",
    )


def _has_name(name: str, words: str) -> bool:
    plain = re.sub(r"[_.\-/]", " ", fold_name(name))
    return re.search(rf"(?<!\w)(?:{words})(?!\w)", plain) is not None


def _numbers(contents: Contents, channels: Iterable[Channel]) -> dict[Channel, Matrix]:
    """The columns that contain only numbers."""
    found = {}
    for channel in channels:
        with suppress(RecordError):  # remarks
            found[channel] = _read(contents, [channel])[0]
    return found


def _columns_by_order(
    source: str, contents: Contents, chosen: Mapping[str, Channel], spaced: bool
) -> dict[str, Channel]:
    """Columns of a table without a header: the increasing one is the distance; then heights, left before right."""
    values = _numbers(contents, [channel for channel in contents.channels if channel not in chosen.values()])
    left = list(values)
    found: dict[str, Channel] = {}
    if "distance" not in chosen and not spaced:
        rising = [channel for channel in left if np.all(np.diff(values[channel]) > 0.0)]
        if len(rising) != 1:
            which = "no column increases" if not rising else "several columns increase"
            raise RecordError(
                f"{source} has no header, and {which} throughout, so the distance is unknown. Write names above "
                f'the columns, such as "distance [m], height [mm]", or select both by number, counted from 0, ',
                *(Remedy(Action.COLUMN, (("distance", 0), ("height", 1))), ", with "),
                *(Remedy(Action.UNITS, tuple(_EXAMPLES.items())), ", or give ", Remedy(Action.INTERVAL, 0.1), "."),
            )
        found["distance"] = rising[0]
        left.remove(rising[0])
    if "height" not in chosen and len(left) + ("right" in chosen) in (1, 2):
        found["height"] = left.pop(0)
        found |= {"right": left[0]} if left else {}
    return found


def _column_by_name(source: str, channels: Sequence[Channel], role: str, given: object) -> Channel:
    if isinstance(given, int) and not isinstance(given, bool) and 0 <= given < len(channels):
        return channels[given]
    alike = [channel for channel in channels if channel.name == given]
    if len(alike) != 1:
        there = ", ".join(channel.label for channel in channels[:12])
        raise RecordError(f"{source}: unknown or repeated column {given!r} for the {role}; available: {there}.")
    return alike[0]


def _unit_sizes(source: str, chosen: Mapping[str, Channel], units: Mapping[str, str], spaced: bool) -> dict[str, float]:
    """Size of the unit of each column [m], by role; with `spaced` distances are not read."""
    read = {role: channel for role, channel in chosen.items() if not (role == "distance" and spaced)}
    given = {role: units.get(_kind(role), channel.unit) for role, channel in read.items()}
    bare = [role for role, unit in given.items() if not isinstance(unit, str) or not unit.strip()]
    if bare:
        kinds = {_kind(role): read[role].name for role in bare}
        names = " and ".join(repr(name) for name in kinds.values())
        over = ", ".join(f"{kind} [{_EXAMPLES[kind]}]" for kind in kinds)
        raise RecordError(
            f"{source}: {names} {'has' if len(kinds) == 1 else 'have'} no unit. Write it after the name, such as "
            f'"{over}", or specify it: ',
            *(Remedy(Action.UNITS, tuple((kind, _EXAMPLES[kind]) for kind in kinds)), "."),
        )
    return {role: _unit_size(source, role, read[role], unit) for role, unit in given.items()}


def _kind(role: str) -> str:
    return "distance" if role == "distance" else "height"


def _unit_size(source: str, role: str, channel: Channel, unit: str) -> float:
    """Size of the unit of the column [m]."""
    kind = _kind(role)
    try:
        worth = parse_quantity(f"1 {unit.strip()}", "m")
    except UnitError:
        raise RecordError(
            f"{source}: the unit {quote_value(unit)} of {channel.name!r} is not a unit of length. Write another after "
            f'the name, such as "{kind} [{_EXAMPLES[kind]}]", or specify it: ',
            *(Remedy(Action.UNITS, ((kind, _EXAMPLES[kind]),)), "."),
        ) from None
    return worth


def _checked_lateral(lateral: object) -> tuple[float, ...]:
    if lateral is None:
        return (0.0,)
    given = tuple(lateral) if isinstance(lateral, Sequence) and not isinstance(lateral, str) else ()
    if len(given) not in (1, 2) or not all(map(is_number, given)):
        raise RecordError(
            f"`lateral` must be one position [m], or two, left and right, such as (0.75, -0.75); got {lateral!r}."
        )
    return tuple(map(float, given))


def _read_crg(name: str, source: str, lateral: tuple[float, ...]) -> Profile:
    crg = library("pyopencrg", "roads", "OpenCRG files")
    with reraise_read_errors(source, "OpenCRG"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its warnings on headers without effect on heights
        road = crg.read(name)
        distance, low, high = np.array(road.u, dtype=float), float(road.v_min), float(road.v_max)
        heights = [np.asarray(road.uv_to_z(distance, np.full(distance.size, at)), dtype=float) for at in lateral]
    for at in lateral:
        if not low - 1e-6 <= at <= high + 1e-6:
            raise RecordError(
                f"{source}: lateral position {format_quantity(at, 'm', 6)} outside the road, which extends from "
                f"{format_range(low, high, 'm', 6)} from its reference line."
            )
    return Profile(distance, heights[0], heights[1] if len(heights) > 1 else None, source)
