"""Units of measured channels: their size in SI units, never guessed."""

from __future__ import annotations

import re
from collections.abc import Mapping

from inerter.errors import RecordError, UnitError
from inerter.formatting import format_list, format_quantity
from inerter.records.channels import Channel
from inerter.records.record import CHANNELS
from inerter.records.remedy import Action, Remedy, Text
from inerter.units import STANDARD_GRAVITY, parse_quantity

_EXAMPLES = {
    "time": "s or ms",
    "displacement": "mm or um",
    "force": "N, kN, kgf or lbf",
    "velocity": "mm/s",
    "acceleration": "m/s^2 or g",
}
# Mass units that a load cell may show for the weight; taken as forces only if named in the call.
_WEIGHTS = {"kg": "kgf", "lb": "lbf"}
EXAMPLES = {role: re.split(r",| or ", units)[0] for role, units in _EXAMPLES.items()}
_VOLTS = {"kV": 1e3, "mV": 1e-3, "uV": 1e-6, "\u00b5V": 1e-6, "\u03bcV": 1e-6}  # a quantity is the value of one volt
_ANGLES = ("\u00b0", "deg", "degree", "degrees", "grad", "rad", "rev", "turn")
_QUANTITY = re.compile(r"\s*[+-]?[\d.]")
_POWER = re.compile(r"(?<=[A-Za-z])([23])(?!\w)")


def scale(source: str, role: str, channel: Channel, given: str | None) -> tuple[float, str, str | None]:
    """Size of one unit of the channel in the SI unit of its role, the unit, and a note where one is due.

    `given` is the unit named in the call, and takes precedence over that of the file. It may be a quantity, "250 N",
    for a file with counts or volts, which may be millivolts.

    Raises `RecordError` for a missing or unknown unit, or one of another quantity.
    """
    unit = channel.unit if given is None else given
    if not isinstance(unit, str):
        raise RecordError(f"The unit of the {role} must be a text such as {EXAMPLES[role]!r}, got {unit!r}.")
    if not unit.strip():
        raise RecordError(
            f"{source}: {channel.name!r} has no unit. Name the unit of the {role}, such as ",
            *(Remedy(Action.UNIT, (role, EXAMPLES[role])), "."),
        )
    plain = unit.strip()
    if role == "force" and given is not None:
        plain = _WEIGHTS.get(plain, plain)
    value = _value(role, plain)
    if value is None:
        raise RecordError(f"{source}: ", *_problem(role, channel, unit, given))
    if given is not None and _QUANTITY.match(given):
        value *= _VOLTS.get(channel.unit.strip(), 1.0)
    return value, unit, _note(role, channel, unit, given, value)


def check_present(source: str, chosen: Mapping[str, Channel], given: Mapping[str, str]) -> None:
    """Raise `RecordError`, which names all of them, if several channels have a unit neither in the file nor given."""
    bare = {role: c for role, c in chosen.items() if role not in given and not c.unit.strip()}
    if len(bare) < 2:
        return
    channels = format_list([repr(channel.name) for channel in bare.values()])
    raise RecordError(
        f"{source}: {channels} have no unit. Name their units, such as ",
        *(Remedy(Action.UNITS, tuple((role, EXAMPLES[role]) for role in bare)), "."),
    )


def is_unit_of_role(role: str, unit: str) -> bool:
    """Whether a unit, spelled as in a file, is a unit of that role."""
    return _value(role, unit.strip()) is not None


def is_unit_of_any_role(unit: str) -> bool:
    """Whether a unit, spelled as in a file, is a unit of any channel of a record."""
    return any(is_unit_of_role(role, unit) for role in CHANNELS)


def check_units(units: dict[str, str] | None) -> dict[str, str]:
    """The units named in a call, by role.

    Raises `RecordError` for an unknown role.
    """
    if units is None:
        return {}
    if not isinstance(units, dict):
        raise RecordError(f"units must be a table such as {{'force': 'kN'}}, got {units!r}.")
    for role in units:
        if role not in CHANNELS:
            raise RecordError(
                f"units: unknown channel {role!r}; available: {', '.join(CHANNELS)}. Name units by the role of the "
                f"channel, not by its name in the file."
            )
    return units


def _value(role: str, unit: str) -> float | None:
    """Size of a unit or quantity in SI units; None if it is not a unit of that role."""
    if role == "acceleration" and unit in ("g", "G", "g_n", "gn"):
        return STANDARD_GRAVITY
    text = _POWER.sub(r"^\1", unit)
    if not _QUANTITY.match(text):
        text = f"1 {text}"
    for spelling in (text, text.lower()) if len(unit) > 3 else (text,):
        try:
            value = parse_quantity(spelling, CHANNELS[role])
        except UnitError:
            continue
        return value or None
    return None


def _problem(role: str, channel: Channel, unit: str, given: str | None) -> Text:
    whose = f"unit {unit!r} of {channel.name!r}" if given is None else f"specified unit {unit!r}"
    if role == "force" and unit.strip().lower() in _WEIGHTS:
        force = _WEIGHTS[unit.strip().lower()]
        return (
            f"{whose} is a unit of mass, not of force. If the load cell shows the weight of that mass, use ",
            Remedy(Action.UNIT, (role, force)),
            f" (1 {force} = {format_quantity(parse_quantity('1 ' + force, 'N'), 'N', 6)}).",
        )
    if role == "displacement" and unit.strip().lower() in _ANGLES:
        return (
            f"{whose} is a unit of angle, not of displacement. Name the displacement for one {unit}, for a screw the "
            "lead divided by one turn in this unit; with a lead of 16 mm and degrees ",
            Remedy(Action.UNIT, (role, "0.04444 mm")),
            ".",
        )
    return (
        f"{whose} is not a unit of {role}, such as {_EXAMPLES[role]}. Name the unit, ",
        Remedy(Action.UNIT, (role, EXAMPLES[role])),
        ", or the value of one count or volt of the file, ",
        Remedy(Action.UNIT, (role, f"0.25 {EXAMPLES[role]}")),
        ".",
    )


def _note(role: str, channel: Channel, unit: str, given: str | None, value: float) -> str | None:
    if given is None or (given == channel.unit and given.strip() not in _WEIGHTS):
        return None
    said = f"instead of {channel.unit} in the file" if channel.unit else "as specified in the call"
    if _QUANTITY.match(unit):
        one = "One volt" if channel.unit.strip() in _VOLTS else "One unit"
        return f"{one} of the {role} {channel.name!r} was read as {unit}, {said}."
    size = format_quantity(value, CHANNELS[role], 6)
    worth = "" if value == 1.0 or size == f"1 {unit}" else f" (1 {unit} = {size})"
    if role == "displacement" and channel.unit.strip().lower() in _ANGLES:
        said += f", a unit of angle: 1 {channel.unit} counts as {size}"
    return f"The {role} {channel.name!r} was read in {unit}{worth}, {said}."
