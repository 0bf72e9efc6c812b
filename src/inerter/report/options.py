"""Remedies for faults of a record, as options of the command line."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from inerter.formatting import format_quantity
from inerter.records.remedy import Action, Remedy

_CHANNELS = {"time": "--time", "displacement": "--displacement", "force": "--force-channel"}
_CONFIG = "of a --config"


def as_options(text: Iterable[object]) -> str:
    """Text of the parts of a sentence, such as the `args` of a `RecordError`, with remedies as command-line options.

    >>> as_options(("Name the unit, ", Remedy(Action.UNIT, ("force", "N")), "."))
    'Name the unit, --unit "force=N".'
    """
    return "".join(_OPTIONS[part.action](part.value) if isinstance(part, Remedy) else str(part) for part in text)


def _channel(value: tuple[str, str | int]) -> str:
    role, name = value
    return f"{_CHANNELS[role]} {name!r}" if role in _CHANNELS else f"{role} = {name!r} in [record] {_CONFIG}"


def _interval(value: float | None) -> str:
    return "--interval" if value is None else f'--interval "{format_quantity(value, "s")}"'


def _gaps(value: str | float) -> str:
    return f"--gaps {value}" if isinstance(value, str) else f'--gaps "{format_quantity(value, "s")}"'


_OPTIONS: Mapping[Action, Callable[[Any], str]] = {
    Action.CHANNEL: _channel,
    Action.UNIT: lambda value: f'--unit "{value[0]}={value[1]}"',
    Action.COLUMN: lambda value: str(Remedy(Action.COLUMN, value)),
    Action.UNITS: lambda value: " ".join(f'--unit "{role}={unit}"' for role, unit in value),
    Action.INTERVAL: _interval,
    Action.GAPS: _gaps,
    Action.TRIM: lambda value: "--trim",
    Action.RESAMPLE: lambda value: '--resample, such as --resample "1 ms"',
    Action.FILL_GAPS: lambda value: "--gaps fill",
    Action.REPAIR: lambda value: f"repair = true in [record] {_CONFIG}",
    Action.DETREND: lambda value: f"detrend = true in [record] {_CONFIG}",
    Action.REMOVE_OFFSET: lambda value: f"detrend = true in [record] {_CONFIG}",
    Action.REVERSE_FORCE: lambda value: "",
    Action.SHIFT_FORCE: lambda value: f"delay = true in [fit] {_CONFIG}",
    Action.FORCE_BANDWIDTH: lambda value: "--force-bandwidth",
    Action.FIXTURE_MASS: lambda value: "--fixture-mass",
    Action.FORCE_SCALE: lambda value: f'--force-scale "{value}"',
    Action.DISPLACEMENT_SCALE: lambda value: f'--displacement-scale "{value}"',
    Action.FIT_DELAY: lambda value: f"delay = true in [fit] {_CONFIG}",
    Action.FIT_OFFSET: lambda value: f"offset = true in [fit] {_CONFIG}",
    Action.FIT_QUADRATIC: lambda value: f"quadratic_damping = true in [fit] {_CONFIG}",
}
