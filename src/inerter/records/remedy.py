"""Remedies for faults of a record, as data: Python and the command line each format them in their syntax."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from inerter.formatting import format_number
from inerter.statements import WordedEnum


class Action(WordedEnum):
    """Kind of remedy: an argument of `read_record`, a field of a record, a processing step, or a setting of a fit."""

    CHANNEL = "channel", lambda value: f"{value[0]}={value[1]!r}"  # (role, name or number)
    UNIT = "unit", lambda value: f"units={{{value[0]!r}: {value[1]!r}}}"  # (role, unit)
    UNITS = "units", lambda value: f"units={dict(value)!r}"  # several such pairs
    COLUMN = (
        "column",
        lambda value: ", ".join(f"{role}={name!r}" for role, name in value),
    )  # several (role, name or number) of a profile
    INTERVAL = (
        "interval",
        lambda value: "interval=" if value is None else f"interval={format_number(value)}",
    )  # [s], or [m] of a profile, or None for any
    GAPS = "gaps", lambda value: f"gaps={value!r}"  # "fill", "longest" or [s]
    TRIM = "trim", "trim"
    RESAMPLE = "resample", "resample(record)"
    FILL_GAPS = "fill-gaps", "fill_gaps(record, longest)"
    REPAIR = "repair", "repair(record)"
    DETREND = "detrend", "detrend(record)"
    REMOVE_OFFSET = "remove-offset", "remove_offset(record)"
    REVERSE_FORCE = (
        "reverse-force",
        " Use reverse_force(record).",
    )  # a whole sentence with a space before it: a fit does it automatically
    SHIFT_FORCE = "shift-force", lambda value: f"shift_force(record, {format_number(value, 3)})"  # [s]
    FORCE_BANDWIDTH = "force-bandwidth", "force_bandwidth="
    FIXTURE_MASS = "fixture-mass", "fixture_mass="
    FORCE_SCALE = "force-scale", lambda value: f"force_scale={value!r}"  # such as "1 +- 1 %"
    DISPLACEMENT_SCALE = "displacement-scale", lambda value: f"displacement_scale={value!r}"
    FIT_DELAY = "fit-delay", "delay=True"
    FIT_OFFSET = "fit-offset", "offset=True"
    FIT_QUADRATIC = "fit-quadratic", "quadratic_damping=True"


@dataclass(frozen=True)
class Remedy:
    """One remedy, with its value where it has one. As text it is written in Python."""

    action: Action
    value: Any = None

    def __str__(self) -> str:
        return str(self.action.format_words(self.value))


Text = tuple[str | Remedy, ...]  # the parts of a sentence


def in_python(text: Text) -> str:
    """The sentence, with calls and arguments of Python.

    >>> in_python(("Read the file with ", Remedy(Action.GAPS, "fill"), "."))
    "Read the file with gaps='fill'."
    """
    return "".join(map(str, text))
