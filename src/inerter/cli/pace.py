"""Remaining time of a study, estimated from finished designs and parts of tasks, and from steps of running ones."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from inerter.formatting import format_duration
from inerter.work.progress import ProgressStep

_POWER = 2.5  # of the number of free values, with which the work on a design rises
_KNOWN = 0.2  # share of a design that must be done for the time of all of it to be known
_SURE = 0.5, 1.6  # times what is expected, between which the time left lies: the first starts of a design take longest
_UNSURE = 1.0 / 3.0, 3.0  # the same where designs of a kind are left that is not known
_EARLY, _EARLY_UNSURE = 10.0, 30.0  # seconds before which no estimate is given, in the two cases
NETWORKS = ("networks", "")  # kind of all networks of a search, of which many are searched at once
Kind = tuple[str, str]  # of designs that are alike: layout and index; of parts of a task: "" and its key


@dataclass
class Pace:
    """Model of the time that designs take: a product of one factor by layout and one by index.

    `free` is the number of free values of each layout, on which the time of a design is assumed to depend before one of
    its kind has been done; `each` is the number of designs for each layout and index. `tasks` has the key of the task
    for each part of a task, by name: their time is that of finished parts of the same task, and before there is one, no
    remaining time is given. The remaining time is a range, since what remains may differ from what has been done.
    """

    free: Mapping[str, int]
    indices: Sequence[str] = ("",)
    each: int = 1
    tasks: Mapping[str, str] = field(default_factory=dict)
    further: str = ""
    left_of: dict[Kind, int] = field(default_factory=dict)  # designs or parts
    took: dict[Kind, list[float]] = field(default_factory=dict)  # seconds, and of how many designs or parts
    parts: dict[str, tuple[ProgressStep, float]] = field(default_factory=dict)  # under way, and since when
    begun: float | None = None
    last: float = 0.0

    @classmethod
    def of_networks(cls, further: str) -> Pace:
        """Estimator of the remaining time of a search over networks, after which `further` work follows."""
        layout, index = NETWORKS
        return cls({layout: 1}, (index,), 0, further=further)

    def begin(self, kept: int, total: int = 0) -> None:
        """Start the clock, with the first `kept` of all `total` designs and parts done in an earlier run."""
        self.begun = self.last = time.monotonic()
        each = self.each or total - bool(self.further)  # which is one more until it is known
        counts = {(layout, index): each for layout in self.free for index in self.indices}
        for kind, count in (counts | Counter(("", key) for key in self.tasks.values())).items():
            self.left_of[kind] = count - min(kept, count)
            kept = max(kept - count, 0)

    def finish(self, layout: str, index: str, count: int) -> None:
        """Record `count` further designs, or parts of a task, as done; the last of them is of that `Kind`."""
        now, kind = time.monotonic(), (layout, index) if self.each else NETWORKS
        if kind in self.left_of:
            took = self.took.setdefault(kind, [0.0, 0.0])
            took[0] += (now - self.last) * max(len(self.parts), 1)
            took[1] += count
            self.left_of[kind] = max(self.left_of[kind] - count, 0)
        self.last = now

    def take(self, step: ProgressStep) -> None:
        """A step of a design that is under way."""
        if not step.within:
            return
        name = step.within[0]
        if step.over:
            self.parts.pop(name, None)
            return
        before, since = self.parts.get(name, (step, time.monotonic()))
        self.parts[name] = replace(step, share=before.share if step.share is None else step.share), since

    def words(self) -> str:
        """Remaining time in words; empty if it cannot be estimated."""
        span = self.range() if any(self.left_of.values()) else None
        if span is None:
            return ""
        low, high = map(format_duration, span)
        then = self.further and f", then {self.further}"
        return f", about {low} left{then}" if low == high else f", {low} to {high} left{then}"

    def range(self) -> tuple[float, float] | None:
        """Least and largest remaining time [s]; None if it cannot be estimated."""
        now = time.monotonic()
        known = {kind: seconds / count for kind, (seconds, count) in self.took.items()}
        shares = {name: step.share or 0.0 for name, (step, _) in self.parts.items()}
        ends = {n: (now - self.parts[n][1]) * (1.0 - s) / s for n, s in shares.items() if s >= _KNOWN}
        for name in ends:
            kind = self._kind(name)
            if kind in self.left_of:
                known.setdefault(kind, (now - self.parts[name][1]) / shares[name])
        unknown = [kind for kind, count in self.left_of.items() if count and kind not in known]
        of_designs = {kind: seconds for kind, seconds in known.items() if kind[0]}
        if self.begun is None or now - self.begun < (_EARLY_UNSURE if unknown else _EARLY) or not known:
            return None
        if any(not layout for layout, _ in unknown) or (unknown and not of_designs):
            return None  # without a basis
        each = known | (self._times(of_designs) if of_designs else {})
        whole = sum(each[kind] * count for kind, count in self.left_of.items() if count)
        whole -= sum(each.get(self._kind(name), 0.0) * share for name, share in shares.items())
        left = max(whole / max(len(self.parts), 1), *ends.values(), 0.0)
        low, high = _UNSURE if unknown else _SURE
        return left * low, left * high

    def _times(self, known: Mapping[Kind, float]) -> dict[Kind, float]:
        """Seconds that a design of each kind takes: a product of one factor by layout and one by index."""
        rest = {kind: math.log(max(seconds, 1e-9)) - self._expected_log_time(kind) for kind, seconds in known.items()}
        mean = sum(rest.values()) / len(rest)
        by_layout, by_index = dict.fromkeys(self.free, mean), dict.fromkeys(self.indices, 0.0)
        for _ in range(3):
            for index in by_index:
                off = [r - by_layout[kind[0]] for kind, r in rest.items() if kind[1] == index]
                by_index[index] = sum(off) / len(off) if off else 0.0
            for layout in by_layout:
                off = [r - by_index[kind[1]] for kind, r in rest.items() if kind[0] == layout]
                by_layout[layout] = sum(off) / len(off) if off else mean
        designs = [kind for kind in self.left_of if kind[0]]
        fitted = {k: math.exp(self._expected_log_time(k) + by_layout[k[0]] + by_index[k[1]]) for k in designs}
        return fitted | {kind: seconds for kind, seconds in known.items() if kind in fitted}

    def _expected_log_time(self, kind: Kind) -> float:
        return _POWER * math.log(max(self.free[kind[0]], 1))

    def _kind(self, name: str) -> Kind:
        """The kind of a design, or of a part of a task, by its name."""
        if name in self.tasks:
            return ("", self.tasks[name])
        names = ((kind, " ".join(kind).strip()) for kind in self.left_of)
        return next((kind for kind, own in names if name == own or name.startswith(f"{own} at ")), ("", ""))
