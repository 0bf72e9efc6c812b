"""Channels of a measurement file by name, before they become a record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Progress = Callable[[float], None]  # called with the fraction that was read


def ignore_progress(fraction: float) -> None:
    """A `Progress` that does nothing."""


@dataclass(frozen=True)
class Channel:
    """One channel of a file: its name, with the group before a slash or dot, and its unit as the file writes it."""

    name: str
    unit: str = ""
    short: str = ""  # the name without its group
    key: Any = None  # how its reader finds it

    @property
    def label(self) -> str:
        """The name and unit, for messages."""
        return f"{self.name} [{self.unit}]" if self.unit else f"{self.name} (no unit)"


@dataclass(frozen=True)
class Samples:
    """Raw values of one channel, and their times [s] where the channel has its own."""

    values: NDArray[Any]
    time: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Contents:
    """An open file: its channels, a function that reads some of them, and notes."""

    channels: tuple[Channel, ...]
    read: Callable[[Sequence[Channel], Progress], list[Samples]]
    notes: tuple[str, ...] = ()
    meta: dict[str, Any] = field(default_factory=dict)
    nameless: bool = False  # the file has no channel names
