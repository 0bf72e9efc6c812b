"""Selection of the channel for each role: by the names in the call, or by obvious names in the file."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from operator import attrgetter
from typing import Any, TypedDict

from inerter.errors import RecordError
from inerter.records.channel_units import EXAMPLES, is_unit_of_role
from inerter.records.channels import Channel, Contents
from inerter.records.remedy import Action, Remedy


class Roles(TypedDict, total=False):
    """Channel of each role, by name or number from 0."""

    time: str | int | None
    displacement: str | int | None
    force: str | int | None
    velocity: str | int | None
    acceleration: str | int | None


ROLES = tuple(Roles.__annotations__)
# Names that identify the channel, whatever their case and accents: in English, German and French. The last two roles
# are taken only if their unit fits.
OBVIOUS = {
    "time": ("time", "t", "zeit", "messzeit", "temps"),
    "displacement": ("displacement", "disp", "position", "pos", "x", "stroke", "weg", "hub", "deplacement", "course"),
    "force": ("force", "load", "f", "kraft", "last", "effort", "charge"),
    "velocity": ("velocity", "vel", "geschwindigkeit", "vitesse"),
    "acceleration": ("acceleration", "accel", "acc", "beschleunigung"),
}
_ENGLISH = {"time": 2, "displacement": 6, "force": 3, "velocity": 2, "acceleration": 3}  # so many of them need no note
_NEEDED = ("time", "displacement", "force")
_WORD = re.compile(r"[^\W\d_]+")
_LISTED = 12


def checked_roles(given: Mapping[str, Any]) -> dict[str, str | int | None]:
    """The channel of each role; None where it is to be found by its name.

    Raises `RecordError` for an unknown role.
    """
    for name in given:
        if name not in ROLES:
            close = difflib.get_close_matches(name, ROLES, n=1)
            hint = f" Did you mean {close[0]!r}?" if close else ""
            raise RecordError(f"read_record(...) has no argument {name!r}; channels are {', '.join(ROLES)}.{hint}")
    return {role: given.get(role) for role in ROLES}


def select_channels(
    source: str, contents: Contents, asked: dict[str, str | int | None], timed: bool
) -> tuple[dict[str, Channel], list[str]]:
    """The channel of each role: the one named in the call, else the one with an obvious name; and a note of choices.

    A channel whose name begins with such a word is taken where no other channel of the file has a unit of its role.
    `timed` means that the times are known without a channel.

    Raises `RecordError`, which lists the channels, where a required channel is not found or ambiguous.
    """
    channels = contents.channels
    chosen = {
        role: channel_by_name(source, channels, role, given) for role, given in asked.items() if given is not None
    }
    for role in ("displacement", "force", "time", "velocity", "acceleration"):  # times are those of the group of both
        if role in chosen or (role == "time" and timed):
            continue
        if found := _obvious_channel(source, channels, role, {_group(channel) for channel in chosen.values()}):
            chosen[role] = found
        elif role in ("displacement", "force"):
            if contents.nameless:
                raise _without_header(source, channels, asked, timed)
            raise RecordError(
                f"{source}: {role} channel not found by an obvious name (such as {', '.join(OBVIOUS[role][:3])}); "
                f"available: {format_channels(channels)}. Name it: ",
                *(channel_example(channels, role), "."),
            )
    chosen = {role: chosen[role] for role in ROLES if role in chosen}
    _check_distinct(source, chosen)
    words = {role: OBVIOUS[role][: _ENGLISH[role]] for role in ROLES}
    by_name = [
        f"{role} from {channel.label}"
        for role, channel in chosen.items()
        if asked.get(role) is None
        and (_folded_short(channel) not in words[role] or sum(_folded_short(c) in OBVIOUS[role] for c in channels) > 1)
    ]
    return chosen, [f"Channels selected by name: {', '.join(by_name)}."] if by_name else []


def _without_header(
    source: str, channels: Sequence[Channel], asked: Mapping[str, str | int | None], timed: bool
) -> RecordError:
    needed = [role for role in _NEEDED if asked.get(role) is None and not (role == "time" and timed)]
    first = sum(asked.get(role) is not None for role in _NEEDED)
    said = [part for at, role in enumerate(needed, first) for part in (Remedy(Action.CHANNEL, (role, at)), ", ")][:-1]
    units: Any = Remedy(Action.UNITS, tuple((role, EXAMPLES[role]) for role in needed))
    return RecordError(
        f"{source}: no column has a header ({len(channels)} found). Name the column of each channel, counted from 0, "
        f"and their units, such as ",
        *said,
        *(" and ", units, "."),
    )


def channel_by_name(source: str, channels: Sequence[Channel], role: str, given: str | int) -> Channel:
    """The channel of that name or number (from 0).

    Raises `RecordError` if there is none, or more than one.
    """
    if isinstance(given, int) and not isinstance(given, bool):
        if 0 <= given < len(channels):
            return channels[given]
        raise RecordError(
            *(f"{source}: ", Remedy(Action.CHANNEL, (role, given))),
            f" is out of range; the file has {len(channels)} channels, counted from 0: {format_channels(channels)}.",
        )
    if not isinstance(given, str):
        raise RecordError(f"{role} must be the name or the number of a channel, got {given!r}.")
    for key in (attrgetter("name"), _short_name, _folded_name, _folded_short):
        matches = [channel for channel in channels if key(channel) == key(Channel(given, short=given))]
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise _ambiguous_name(source, channels, role, matches)
    close = _nearest_name(given, channels)
    hint = f" Did you mean {close!r}?" if close else ""
    raise RecordError(
        f"{source}: unknown channel {given!r} for the {role}; available: {format_channels(channels)}.{hint}"
    )


def format_channels(channels: Sequence[Channel]) -> str:
    """The channels with their units, for messages: "time [s], force [N]"."""
    if not channels:
        return "no channels of numbers"
    shown = [channel.label for channel in channels[:_LISTED]]
    if len(channels) > _LISTED:
        shown.append(f"and {len(channels) - _LISTED} more")
    return ", ".join(shown)


def _obvious_channel(source: str, channels: Sequence[Channel], role: str, groups: Collection[str]) -> Channel | None:
    """The one channel with an obvious name; of several the one in these groups; None if there is none."""
    matches = [channel for channel in channels if _folded_short(channel) in OBVIOUS[role]]
    near = [channel for channel in matches if _group(channel) in groups]
    if len(near) == 1 < len(matches):
        return near[0]
    if len(matches) > 1:
        raise _ambiguous_name(source, channels, role, matches)
    fitting = (
        [channel for channel in channels if is_unit_of_role(role, channel.unit)]
        if not matches and role in _NEEDED
        else []
    )
    if len(fitting) == 1 and _first_word(fitting[0]) in OBVIOUS[role]:
        return fitting[0]
    return matches[0] if matches else None


def _group(channel: Channel) -> str:
    """Group prefix of the channel name; empty where there are no groups."""
    return re.split(r"[/.][^/.]*$", channel.name)[0] if re.search(r"[/.]", channel.name) else ""


def _first_word(channel: Channel) -> str | None:
    found = _WORD.match(_folded_short(channel))
    return found[0] if found else None


def _ambiguous_name(source: str, channels: Sequence[Channel], role: str, matches: Sequence[Channel]) -> RecordError:
    numbers = [channels.index(channel) for channel in matches]
    names = " and ".join(f"{channel.name!r} (number {at})" for channel, at in zip(matches, numbers, strict=True))
    repeated = len({channel.name for channel in matches}) < len(matches)
    way, which = ("number", numbers[0]) if repeated else ("name", matches[0].name)
    remedy = Remedy(Action.CHANNEL, (role, which))
    return RecordError(f"{source}: ambiguous {role} channel: {names}. Select one by {way}: ", remedy, ".")


def _check_distinct(source: str, chosen: dict[str, Channel]) -> None:
    roles: dict[int, str] = {}
    for role, channel in chosen.items():
        if id(channel) in roles:
            raise RecordError(
                f"{source}: {channel.name!r} cannot be both the {roles[id(channel)]} and the {role}. "
                f"Name another channel for one of them."
            )
        roles[id(channel)] = role


def _nearest_name(given: str, channels: Sequence[Channel]) -> str | None:
    by_key = {key(channel): channel.name for channel in channels for key in (_folded_name, _folded_short)}
    close = difflib.get_close_matches(given.casefold(), by_key, n=1, cutoff=0.5)
    return by_key[close[0]] if close else None


def channel_example(channels: Sequence[Channel], role: str) -> Remedy:
    """Example of naming the channel of a role: the first one with a unit of that role."""
    likely = (channel.name for channel in channels if is_unit_of_role(role, channel.unit))
    return Remedy(Action.CHANNEL, (role, next(likely, "name")))


def _short_name(channel: Channel) -> str:
    return channel.short or channel.name


def _folded_name(channel: Channel) -> str:
    return fold_name(channel.name)


def _folded_short(channel: Channel) -> str:
    return fold_name(_short_name(channel))


def fold_name(name: str) -> str:
    """The name without case and accents.

    >>> fold_name(" Déplacement ")
    'deplacement'
    """
    parts = unicodedata.normalize("NFKD", name.strip().casefold())
    return "".join(character for character in parts if not unicodedata.combining(character))
