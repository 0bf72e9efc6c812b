"""Which channel of a file is which: by the names that the call gives, or by obvious ones."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

from inerter.errors import RecordError
from inerter.records.channels import Channel, Contents
from inerter.records.remedy import Action, Remedy
from inerter.records.scales import fits


class Roles(TypedDict, total=False):
    """Which channel is which, by name or number from 0."""

    time: str | int | None
    displacement: str | int | None
    force: str | int | None
    velocity: str | int | None
    acceleration: str | int | None


ROLES = tuple(Roles.__annotations__)
# Names that tell the channel by themselves, whatever their case; the last two are taken only if their unit fits.
OBVIOUS = {
    "time": ("time", "t"),
    "displacement": ("displacement", "disp", "position", "pos", "x", "stroke"),
    "force": ("force", "load", "f"),
    "velocity": ("velocity", "vel"),
    "acceleration": ("acceleration", "accel", "acc"),
}
_LISTED = 12


def checked_roles(given: Mapping[str, Any]) -> dict[str, str | int | None]:
    """The channel of each role; None where it is to be found by its name.

    Raises `RecordError` for what is no role.
    """
    for name in given:
        if name not in ROLES:
            close = difflib.get_close_matches(name, ROLES, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise RecordError(f"read_record(...) has no argument {name!r}; channels are {', '.join(ROLES)}.{hint}")
    return {role: given.get(role) for role in ROLES}


def choose(source: str, contents: Contents, asked: dict[str, str | int | None], timed: bool) -> dict[str, Channel]:
    """The channel of each role: the one that was asked for, else the one with an obvious name.

    `timed` says that the times are known without a channel.

    Raises `RecordError`, which lists what there is, where a needed channel is not found or not clear.
    """
    chosen: dict[str, Channel] = {}
    for role in ROLES:
        given = asked.get(role)
        if given is not None:
            chosen[role] = named(source, contents.channels, role, given)
        elif not (role == "time" and timed) and (found := _obvious(source, contents.channels, role)):
            chosen[role] = found
        elif role in ("displacement", "force"):
            raise RecordError(
                f"{source}: no channel has an obvious name for the {role} (such as {', '.join(OBVIOUS[role][:3])}); "
                f"there {listed(contents.channels)}. Name it: ",
                *(example(contents.channels, role), "."),
            )
    _distinct(source, chosen)
    return chosen


def named(source: str, channels: Sequence[Channel], role: str, given: str | int) -> Channel:
    """The channel of that name or number (from 0).

    Raises `RecordError` if there is none, or more than one.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        if 0 <= given < len(channels):
            return channels[given]
        raise RecordError(
            *(f"{source}: ", Remedy(Action.CHANNEL, (role, given))),
            f" is not among its {len(channels)} channels, which are counted from 0; there {listed(channels)}.",
        )
    if not isinstance(given, str):
        raise RecordError(f"{role} must be the name or the number of a channel, got {given!r}.")
    for key in (_full, _short, _folded, _folded_short):
        matches = [channel for channel in channels if key(channel) == key(Channel(given, short=given))]
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise _unclear(source, channels, role, matches)
    close = _nearest(given, channels)
    hint = f" Did you mean {close!r}?" if close else ""
    raise RecordError(f"{source}: there is no channel {given!r} for the {role}; there {listed(channels)}.{hint}")


def listed(channels: Sequence[Channel]) -> str:
    """The channels with their units, for messages: "is time [s], ..." or "are ..."."""
    if not channels:
        return "are no channels of numbers"
    shown = [channel.label for channel in channels[:_LISTED]]
    if len(channels) > _LISTED:
        shown.append(f"and {len(channels) - _LISTED} more")
    return ("is " if len(channels) == 1 else "are ") + ", ".join(shown)


def _obvious(source: str, channels: Sequence[Channel], role: str) -> Channel | None:
    matches = [channel for channel in channels if _folded_short(channel) in OBVIOUS[role]]
    if len(matches) > 1:
        raise _unclear(source, channels, role, matches)
    return matches[0] if matches else None


def _unclear(source: str, channels: Sequence[Channel], role: str, matches: Sequence[Channel]) -> RecordError:
    numbers = [channels.index(channel) for channel in matches]
    names = " and ".join(f"{channel.name!r} (number {at})" for channel, at in zip(matches, numbers, strict=True))
    alike = len({channel.name for channel in matches}) < len(matches)
    way, which = ("number", numbers[0]) if alike else ("name", matches[0].name)
    remedy = Remedy(Action.CHANNEL, (role, which))
    return RecordError(f"{source}: {names} may all be the {role}. Say which, by {way}: ", remedy, ".")


def _distinct(source: str, chosen: dict[str, Channel]) -> None:
    roles: dict[int, str] = {}
    for role, channel in chosen.items():
        if id(channel) in roles:
            raise RecordError(
                f"{source}: {channel.name!r} cannot be both the {roles[id(channel)]} and the {role}. "
                f"Name another channel for one of them."
            )
        roles[id(channel)] = role


def _nearest(given: str, channels: Sequence[Channel]) -> str | None:
    by_key = {key(channel): channel.name for channel in channels for key in (_folded, _folded_short)}
    close = difflib.get_close_matches(given.casefold(), by_key, n=1, cutoff=0.5)
    return by_key[close[0]] if close else None


def example(channels: Sequence[Channel], role: str) -> Remedy:
    """What to name for a role: the first channel whose unit is one of it."""
    likely = (channel.name for channel in channels if fits(role, channel.unit))
    return Remedy(Action.CHANNEL, (role, next(likely, "name")))


def _full(channel: Channel) -> str:
    return channel.name


def _short(channel: Channel) -> str:
    return channel.short or channel.name


def _folded(channel: Channel) -> str:
    return channel.name.strip().casefold()


def _folded_short(channel: Channel) -> str:
    return _short(channel).strip().casefold()
