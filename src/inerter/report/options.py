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
    return "".join(_as_option(part) if isinstance(part, Remedy) else str(part) for part in text)


def _as_option(remedy: Remedy) -> str:
    option = _OPTIONS[remedy.action]
    return option(remedy.value) if callable(option) else option


def _channel(value: tuple[str, str | int]) -> str:
    role, name = value
    return f"{_CHANNELS[role]} {name!r}" if role in _CHANNELS else f"{role} = {name!r} in [record] {_CONFIG}"


def _interval(value: float | None) -> str:
    return "--interval" if value is None else f'--interval "{format_quantity(value, "s")}"'


def _gaps(value: str | float) -> str:
    return f"--gaps {value}" if isinstance(value, str) else f'--gaps "{format_quantity(value, "s")}"'


_OPTIONS: Mapping[Action, str | Callable[[Any], str]] = {
    Action.CHANNEL: _channel,
    Action.UNIT: lambda value: f'--unit "{value[0]}={value[1]}"',
    Action.COLUMN: lambda value: str(Remedy(Action.COLUMN, value)),
    Action.UNITS: lambda value: " ".join(f'--unit "{role}={unit}"' for role, unit in value),
    Action.INTERVAL: _interval,
    Action.GAPS: _gaps,
    Action.TRIM: "--trim",
    Action.RESAMPLE: '--resample, such as --resample "1 ms"',
    Action.FILL_GAPS: "--gaps fill",
    Action.REPAIR: f"repair = true in [record] {_CONFIG}",
    Action.DETREND: f"detrend = true in [record] {_CONFIG}",
    Action.REMOVE_OFFSET: f"detrend = true in [record] {_CONFIG}",
    Action.REVERSE_FORCE: "",
    Action.SHIFT_FORCE: f"delay = true in [fit] {_CONFIG}",
    Action.FORCE_BANDWIDTH: "--force-bandwidth",
    Action.FIXTURE_MASS: "--fixture-mass",
    Action.FORCE_SCALE: lambda value: f'--force-scale "{value}"',
    Action.DISPLACEMENT_SCALE: lambda value: f'--displacement-scale "{value}"',
    Action.FIT_DELAY: f"delay = true in [fit] {_CONFIG}",
    Action.FIT_OFFSET: f"offset = true in [fit] {_CONFIG}",
    Action.FIT_QUADRATIC: f"quadratic_damping = true in [fit] {_CONFIG}",
}
