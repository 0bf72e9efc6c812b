"""A measured elevation profile along one or two tracks of a road."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.deprecation import RenamedAttribute, renamed_keywords
from inerter.errors import RecordError, SignalError
from inerter.formatting import format_alike, format_quantity
from inerter.signals.arguments import positive_number
from inerter.signals.signal import SampledSignal, Signal
from inerter.validation import is_number, real_numbers

Matrix = NDArray[np.float64]
LEFT, RIGHT = "left", "right"
_EVEN = 1e-3  # of an interval: distances that stray less from an even spacing count as even


@dataclass(frozen=True, eq=False)
class Profile:
    """Heights [m] over the distance [m] along a road; with `right` for two tracks, of which `height` is the left.

    Raises `RecordError` unless all are finite vectors of one length of at least two, and the distances increase.

    >>> import inerter as it
    >>> road = it.Profile([0.0, 0.5, 1.0], [0.0, 0.01, 0.0])  # distance and height [m]
    >>> road.length, road.interval
    (1.0, 0.5)
    """

    distance: Matrix  # (n,) [m]
    height: Matrix  # (n,) [m]
    right: Matrix | None = None  # (n,) [m]
    source: str = "profile"
    notes: tuple[str, ...] = ()  # sentences about its reading

    def __post_init__(self) -> None:
        for name in ("distance", "height", "right"):
            given = getattr(self, name)
            if given is None and name == "right":
                continue
            values = real_numbers(given)
            if values is None or values.ndim != 1 or values.size < 2:
                raise RecordError(f"The {name} of a profile must be a vector of two or more real numbers [m].")
            if values.size != np.size(self.distance):
                raise RecordError(
                    f"The {name} of a profile must be as long as its distance, got {values.size} and "
                    f"{np.size(self.distance)} points."
                )
            array = np.array(values, dtype=float)
            bad = np.flatnonzero(~np.isfinite(array))
            if bad.size:
                several = f"{bad.size} points, the first is " if bad.size > 1 else ""
                raise RecordError(
                    f"The {name} of {self.source!r} is missing or not finite at {several}point {bad[0]}. Fill such "
                    "gaps, or cut the profile there."
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        back = np.flatnonzero(np.diff(self.distance) <= 0.0)
        if back.size:
            i = int(back[0])
            before, after = format_alike(self.distance[i : i + 2], "m", 9)
            raise RecordError(
                f"The distances of {self.source!r} must increase, but point {i + 1} is at {after} after {before}. "
                f"Sort the points, and drop repeated ones."
            )

    @property
    def tracks(self) -> dict[str, Matrix]:
        """Heights [m] by track name: "left" and "right", or "" for a single track."""
        return {"": self.height} if self.right is None else {LEFT: self.height, RIGHT: self.right}

    @property
    def length(self) -> float:
        """Distance from the first point to the last [m]."""
        return float(self.distance[-1] - self.distance[0])

    @property
    def interval(self) -> float:
        """Mean distance between points [m]."""
        return self.length / (self.distance.size - 1)

    def even(self, interval: float | None = None) -> Profile:
        """The same profile at evenly spaced points, by linear interpolation.

        `interval` [m] is by default the mean one; a profile that is even already is then returned unchanged.

        Raises `RecordError` unless the interval is positive and at most the length.
        """
        if interval is None:
            grid = self.distance[0] + self.interval * np.arange(self.distance.size)
            if np.max(np.abs(self.distance - grid)) <= _EVEN * self.interval:
                return self
            interval = self.interval
        if not is_number(interval) or not 0.0 < interval <= self.length:
            raise RecordError(
                f"The interval of a profile of {format_quantity(self.length, 'm', 6)} must be positive and at most its "
                f"length, got {interval!r} m."
            )
        points = int(np.floor(self.length / interval * (1.0 + 1e-12))) + 1
        grid = self.distance[0] + interval * np.arange(points)
        along = [np.interp(grid, self.distance, heights) for heights in self.tracks.values()]
        return replace(self, distance=grid, height=along[0], right=along[1] if len(along) > 1 else None)

    @renamed_keywords(track="side")
    def to_signal(self, speed: float, side: str = "") -> SampledSignal:
        """One track as a signal at `speed` [m/s] from its first point at t = 0, by a cubic spline.

        Raises `SignalError` unless `speed` is positive, and `side` one of its tracks.
        """
        velocity = positive_number("The speed over a profile", speed, "m/s")
        if side not in self.tracks:
            which = f"no {side!r} track" if side else "two tracks"
            single = "it has a single track without a name"
            known = single if "" in self.tracks else 'select one with track = "left" or "right"'
            raise SignalError(f"{self.source!r} has {which}: {known}.")
        label = " ".join(filter(None, ("profile", self.source, side)))
        return Signal.sampled(
            (self.distance - self.distance[0]) / velocity, self.tracks[side], speed=velocity, label=label
        )

    driven = RenamedAttribute("to_signal")

    def signals(self, speed: float) -> SampledSignal | dict[str, SampledSignal]:
        """Signals for `simulate(..., road=...)`: one signal, or one for the left and one for the right track.

        Raises `SignalError` unless `speed` [m/s] is positive.
        """
        found = {side: self.to_signal(speed, side) for side in self.tracks}
        return found.get("", found)
