"""Remedies for faults of a record, as data: Python and the command line each format them in their syntax."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from inerter.formatting import format_number


class Action(StrEnum):
    """Kind of remedy: an argument of `read_record`, a field of a record, a processing step, or a setting of a fit."""

    CHANNEL = "channel"  # (role, name or number)
    UNIT = "unit"  # (role, unit)
    UNITS = "units"  # several such pairs
    COLUMN = "column"  # several (role, name or number) of a profile
    INTERVAL = "interval"  # [s], or [m] of a profile, or None for any
    GAPS = "gaps"  # "fill", "longest" or [s]
    TRIM = "trim"
    RESAMPLE = "resample"
    FILL_GAPS = "fill-gaps"
    REPAIR = "repair"
    DETREND = "detrend"
    REMOVE_OFFSET = "remove-offset"
    REVERSE_FORCE = "reverse-force"  # a whole sentence with a space before it: a fit does it automatically
    SHIFT_FORCE = "shift-force"  # [s]
    FORCE_BANDWIDTH = "force-bandwidth"
    FIXTURE_MASS = "fixture-mass"
    FORCE_SCALE = "force-scale"  # such as "1 +- 1 %"
    DISPLACEMENT_SCALE = "displacement-scale"
    FIT_DELAY = "fit-delay"
    FIT_OFFSET = "fit-offset"
    FIT_QUADRATIC = "fit-quadratic"


@dataclass(frozen=True)
class Remedy:
    """One remedy, with its value where it has one. As text it is written in Python."""

    action: Action
    value: Any = None

    def __str__(self) -> str:
        return _IN_PYTHON[self.action](self.value)


Text = tuple[str | Remedy, ...]  # the parts of a sentence


def in_python(text: Text) -> str:
    """The sentence, with calls and arguments of Python.

    >>> in_python(("Read the file with ", Remedy(Action.GAPS, "fill"), "."))
    "Read the file with gaps='fill'."
    """
    return "".join(map(str, text))


_IN_PYTHON: Mapping[Action, Callable[[Any], str]] = {
    Action.CHANNEL: lambda value: f"{value[0]}={value[1]!r}",
    Action.UNIT: lambda value: f"units={{{value[0]!r}: {value[1]!r}}}",
    Action.COLUMN: lambda value: ", ".join(f"{role}={name!r}" for role, name in value),
    Action.UNITS: lambda value: f"units={dict(value)!r}",
    Action.INTERVAL: lambda value: "interval=" if value is None else f"interval={format_number(value)}",
    Action.GAPS: lambda value: f"gaps={value!r}",
    Action.TRIM: lambda value: "trim",
    Action.RESAMPLE: lambda value: "resample(record)",
    Action.FILL_GAPS: lambda value: "fill_gaps(record, longest)",
    Action.REPAIR: lambda value: "repair(record)",
    Action.DETREND: lambda value: "detrend(record)",
    Action.REMOVE_OFFSET: lambda value: "remove_offset(record)",
    Action.REVERSE_FORCE: lambda value: " Use reverse_force(record).",
    Action.SHIFT_FORCE: lambda value: f"shift_force(record, {format_number(value, 3)})",
    Action.FORCE_BANDWIDTH: lambda value: "force_bandwidth=",
    Action.FIXTURE_MASS: lambda value: "fixture_mass=",
    Action.FORCE_SCALE: lambda value: f"force_scale={value!r}",
    Action.DISPLACEMENT_SCALE: lambda value: f"displacement_scale={value!r}",
    Action.FIT_DELAY: lambda value: "delay=True",
    Action.FIT_OFFSET: lambda value: "offset=True",
    Action.FIT_QUADRATIC: lambda value: "quadratic_damping=True",
}
