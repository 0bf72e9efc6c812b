"""How long a study will still take, from what was done of each of its designs."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field

from inerter.cli.pulse import duration
from inerter.work.progress import Step

_POWER = 2.5  # of the number of free values, with which the work on a design rises
_KNOWN = 0.2  # share of a design that must be done for its kind to be known
_SURE, _UNSURE = 1.35, 3.0  # factors within which the time left lies, where all kinds are known and where not
_EARLY = 2.0  # seconds before which nothing is told


@dataclass
class Pace:
    """Work that is done and left, where a design counts by its free values.

    `free` has the number of free values of each layout, in the order of the results; `each` is how many designs of each
    there are. Of the time left a range is told: the pace is that of the designs and parts of designs that are done, and
    those that are left may be others.
    """

    free: Mapping[str, int]
    each: int = 1
    done: dict[str, float] = field(default_factory=dict)  # designs by layout
    here: dict[str, float] = field(default_factory=dict)  # of these, those of this run
    parts: dict[str, Step] = field(default_factory=dict)  # designs under way
    since: dict[str, float] = field(default_factory=dict)  # when they were begun
    begun: float | None = None

    def begin(self, kept: int) -> None:
        """So many designs, the first ones, were done before."""
        self.begun = time.monotonic() if self.begun is None else self.begun
        for layout in self.free:
            self.done[layout] = float(min(kept, self.each))
            kept -= int(self.done[layout])

    def finish(self, layout: str, count: int) -> None:
        """So many more designs are done, the last of which is one of a layout."""
        if layout in self.free:
            self.done[layout] = min(self.done.get(layout, 0.0) + count, float(self.each))
            self.here[layout] = self.here.get(layout, 0.0) + count

    def take(self, step: Step) -> None:
        """A step of a design that is under way."""
        if not step.within:
            return
        name = step.within[0]
        if step.over:
            self.parts.pop(name, None)
            self.since.pop(name, None)
        elif name not in self.parts or step.share is not None:
            self.parts[name] = step
            self.since.setdefault(name, time.monotonic())

    def left(self) -> str:
        """The time left in words; empty where there is nothing to tell it by."""
        span = self.range()
        if span is None:
            return ""
        low, high = map(duration, span)
        return f", about {low} left" if low == high else f", {low} to {high} left"

    def range(self) -> tuple[float, float] | None:
        """The least and the most time left [s]; None where there is nothing to tell it by."""
        elapsed = 0.0 if self.begun is None else time.monotonic() - self.begun
        shares = {name: step.share or 0.0 for name, step in self.parts.items()}
        under_way = sum(self._weight(self._layout(name)) * share for name, share in shares.items())
        worked = under_way + sum(self._weight(layout) * count for layout, count in self.here.items())
        if elapsed < _EARLY or worked <= 0.0:
            return None
        whole = sum(self._weight(layout) * (self.each - self.done.get(layout, 0.0)) for layout in self.free)
        last = max((self._rest(name, share) for name, share in shares.items()), default=0.0)
        left = max((whole - under_way) * elapsed / worked, last, 0.0)
        seen = {layout for layout, count in self.here.items() if count}
        seen |= {self._layout(name) for name, share in shares.items() if share >= _KNOWN}
        wanted = {layout for layout in self.free if self.done.get(layout, 0.0) < self.each}
        factor = _SURE if wanted <= seen else _UNSURE
        return left / factor, left * factor

    def _rest(self, name: str, share: float) -> float:
        return (time.monotonic() - self.since[name]) * (1.0 - share) / share if share >= _KNOWN else 0.0

    def _layout(self, name: str) -> str:
        """The layout of a design by its name, which begins with it."""
        return next((layout for layout in self.free if name.startswith(f"{layout} ")), "")

    def _weight(self, layout: str) -> float:
        return float(max(self.free.get(layout, 1), 1)) ** _POWER
