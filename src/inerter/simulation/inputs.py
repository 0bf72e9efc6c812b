"""Signals along the knots of an integration: one cubic for every input between two knots."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, TypedDict

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError
from inerter.formatting import format_alike, format_number, format_quantity
from inerter.kernels.arrays import Knots
from inerter.signals.arguments import time_tolerance
from inerter.signals.signal import Signal, SignalSum
from inerter.systems.piecewise import PiecewiseSystem
from inerter.validation import check_positive
from inerter.vehicle.mechanism import Mechanism

if TYPE_CHECKING:
    from inerter.simulation.initial_state import Initial

Matrix = NDArray[np.float64]
_SAME = 1e-9  # of a step: knots that differ by less are one
MEMORY_LIMIT = 4 * 2**30
_LARGEST = 1e100
_KEPT = 400_000  # largest number of steps times inputs of a table that is kept: 7 MB


@dataclass(frozen=True, eq=False)
class InputTable:
    """Values and slopes of all inputs (columns: roads, then forces) at the knots, from both sides.

    Knots are the multiples of `step` and the breaks of the signals between them. Where a signal does not break, both
    sides are the same array.
    """

    step: float  # [s]
    time: Matrix  # (knots,)
    value: Matrix  # (knots, inputs) from the right
    slope: Matrix
    value_before: Matrix  # from the left
    slope_before: Matrix
    special: NDArray[np.int64]  # segments of another length; then one past the end
    slot: NDArray[np.int64]  # (knots,) number of the sample, or -1
    sampled: Matrix  # times of the samples [s]
    moving: tuple[bool, ...]  # whether each input has a signal
    jumps: bool  # whether one jumps at a knot

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.sampled.size)

    @cached_property
    def knots(self) -> Knots:
        """The inputs as kernels take them."""
        return Knots(*(getattr(self, name) for name in Knots._fields))

    @cached_property
    def sample_knots(self) -> NDArray[np.intp]:
        """Numbers of the knots at the samples."""
        return np.flatnonzero(self.slot >= 0)

    def knot_of(self, sample: int) -> int:
        """Number of the knot at a sample."""
        return 0 if self.slot[0] == sample else int(np.flatnonzero(self.slot == sample)[0])

    @cached_property
    def repeating(self) -> InputTable:
        """Table of one period preceded by its own end, so that inputs may jump where the period starts again."""
        before, slope = _ending_first(self.value_before), _ending_first(self.slope_before)
        special = self.special
        if not self.jumps and special[0] != 0 and not np.array_equal(before[0], self.value[0]):
            special = np.concatenate([[0], special])
        return replace(self, value_before=before, slope_before=slope, special=special)

    def refine(self, parts: int) -> InputTable:
        """The same motion with `parts` segments in place of each one, whose inputs go along the same cubics."""
        if parts == 1:
            return self
        time = np.append((self.time[:-1, None] + np.diff(self.time)[:, None] * np.arange(parts) / parts), self.time[-1])
        value, slope = _within_segments(self, parts)
        slot = np.full(time.size, -1, np.int64)
        slot[::parts] = self.slot
        return replace(
            self,
            step=self.step / parts,
            time=time,
            value=value,
            slope=slope,
            value_before=_from_the_left_too(self.value_before, self.value, value, parts),
            slope_before=_from_the_left_too(self.slope_before, self.slope, slope, parts),
            special=np.append((self.special[:-1, None] * parts + np.arange(parts)).ravel(), time.size + 1),
            slot=slot,
        )


def _within_segments(table: InputTable, parts: int) -> tuple[Matrix, Matrix]:
    """Values and slopes of all inputs from the right at the ends of `parts` equal pieces of every segment."""
    length = np.diff(table.time)[:, None]
    first, rise = table.value[:-1], table.value_before[1:] - table.value[:-1]
    begin, end = length * table.slope[:-1], length * table.slope_before[1:]
    bent, turned = 3.0 * rise - 2.0 * begin - end, begin + end - 2.0 * rise
    value, slope = (np.empty((length.size * parts + 1, first.shape[1])) for _ in range(2))
    value[-1], slope[-1] = table.value[-1], table.slope[-1]
    for number in range(parts):  # of long columns, whose pieces are few
        s = number / parts
        value[number:-1:parts] = first + s * (begin + s * (bent + s * turned))
        slope[number:-1:parts] = (begin + s * (2.0 * bent + s * 3.0 * turned)) / length
    return value, slope


def _from_the_left_too(before: Matrix, after: Matrix, found: Matrix, parts: int) -> Matrix:
    """Values from the left at the knots of a refined table; those from the right, `found`, where no input breaks."""
    if before is after:
        return found
    left = found.copy()
    left[::parts] = before
    return left


def _ending_first(rows: Matrix) -> Matrix:
    """The rows with the last one as the first, too; the same array if it is."""
    return rows if np.array_equal(rows[0], rows[-1]) else np.concatenate([rows[-1:], rows[1:]])


class RunInputs(TypedDict, total=False):
    """Keywords of `simulate` for the excitation and the initial state."""

    road: Signal | Mapping[str, Signal] | None
    forces: Signal | Mapping[str, Signal] | None
    displacement: Signal | None
    speed: float | None
    initial: Initial


class BatchInputs(TypedDict, total=False):
    """Keywords of `simulate_many` for the excitation: the j-th entry of each sequence excites the j-th run.

    All have one speed and one initial state.
    """

    road: Sequence[Signal] | None
    forces: Sequence[Mapping[str, Signal]] | None
    displacement: Sequence[Signal] | None
    speed: float | None
    initial: Initial


def check_keywords(caller: str, driven: Mapping[str, object]) -> None:
    """Raises TypeError for an unknown keyword of the excitation and the initial state."""
    unknown = [name for name in driven if name not in RunInputs.__annotations__]
    if unknown:
        known = ", ".join(RunInputs.__annotations__)
        raise TypeError(f"{caller}() got an unexpected keyword argument {unknown[0]!r} (available: {known}).")


def initial_of(driven: RunInputs | BatchInputs) -> Initial:
    """Initial state among the keywords; default: at rest."""
    return driven.get("initial", "rest")


def assign(
    mechanism: Mechanism,
    road: object = None,
    forces: object = None,
    displacement: object = None,
    speed: float | None = None,
) -> tuple[list[Signal | None], list[float]]:
    """The signal (None: nothing moves) and the delay [s] of every road and force, from the keywords of `RunInputs`.

    Raises `SimulationError` for a signal that is missing, that nothing takes, or whose delay is not known.
    """
    roads, names = [r.name for r in mechanism.roads], [f.name for f in mechanism.forces]
    moved = road if displacement is None else displacement
    if road is not None and displacement is not None:
        raise SimulationError("Give either road or displacement: both move the same ends of the mechanism.")
    by_track = _by_track(mechanism, moved)
    moved = by_track or moved
    by_road = _by_name("road" if displacement is None else "displacement", moved, roads)
    if len(by_road) < len(roads) and (by_road or not forces):
        missing = ", ".join(name for name in roads if name not in by_road)
        raise SimulationError(
            f"The motion of {missing} is missing. Give a signal for all, such as road=multisine(...), one for each by "
            f"name, or forces alone with the roads at rest."
        )
    by_force = _by_name("forces", forces, names) if isinstance(forces, Mapping) or len(names) == 1 else {}
    if forces is not None and not by_force:
        raise SimulationError(
            f"Forces must be given by name, forces={{name: signal}}; available: {_format_names(names)}."
        )
    signals: list[Signal | None] = [by_road.get(name) for name in roads]
    late = [0.0 if isinstance(moved, Mapping) and not by_track else r.distance for r in mechanism.roads]
    delays = [_delay(d, s, speed, name) for d, s, name in zip(late, signals, roads, strict=True)]
    return [*signals, *(by_force.get(name) for name in names)], delays + [0.0] * len(names)


def _by_track(mechanism: Mechanism, moved: object) -> dict[str, object]:
    """Signal of each road if one is given for each track; else empty."""
    tracks = {road.side for road in mechanism.roads}
    if not isinstance(moved, Mapping) or not {*moved} or not {*moved} <= {"left", "right"} or tracks != {*moved}:
        return {}
    return {road.name: moved[road.side] for road in mechanism.roads}


def _by_name(what: str, given: object, names: Sequence[str]) -> dict[str, Signal]:
    if given is None:
        return {}
    found = given if isinstance(given, Mapping) else dict.fromkeys(names, given)
    if given is not None and not names:
        raise SimulationError(f"The mechanism has no input for {what}=.")
    for name, signal in found.items():
        if name not in names:
            raise SimulationError(f"Unknown input {name!r} for {what}=; available: {_format_names(names)}.")
        if not isinstance(signal, Signal):
            raise SimulationError(
                f"The input {name!r} needs a signal, such as sine(...) or Signal.sampled(time, value), got "
                f"{type(signal).__name__}."
            )
    return dict(found)


def _format_names(names: Sequence[str]) -> str:
    return ", ".join(names) or "none"


def _delay(distance: float, signal: Signal | None, speed: float | None, name: str) -> float:
    if distance == 0.0 or signal is None:
        return 0.0
    known = signal.speed if speed is None else speed
    if known is None:
        raise SimulationError(
            f"The road reaches {name!r} {format_quantity(distance, 'm', 6)} later, but neither the signal nor "
            f"simulate(..., speed=...) states the speed of the vehicle."
        )
    check_positive(SimulationError, "The speed", known, "m/s")
    return distance / float(known)


def tabulate(
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    duration: float,
    step: float,
    every: int = 1,
    start: float = 0.0,
    joined: bool = False,
) -> InputTable:
    """All inputs along the knots from `start` to `start` + `duration` [s], with a sample at every `every`-th step.

    Where the run is `joined` to one that ended at `start`, what breaks just there is felt.

    Raises `SimulationError` if a step is longer than a signal's table or than half its shortest period, or if a
    signal ends too early.
    """
    count = whole_steps(duration, step)
    check_steps(signals, step, start + duration)
    grid: Matrix = start + step * np.arange(count + 1, dtype=np.float64)
    broken = [
        np.zeros(0) if s is None else _breaks(s, d, grid[0], grid[-1], step, joined)
        for s, d in zip(signals, delays, strict=True)
    ]
    broken = _on_common_knots(broken, signals, delays)
    time, slot, odd = _knots(grid, _between(np.concatenate([np.zeros(0), *broken]), start, step), step, every)
    shape = (time.size, len(signals))
    value, slope = np.zeros(shape), np.zeros(shape)
    jumped, before = np.zeros(time.size, dtype=bool), []
    for i, (signal, delay) in enumerate(zip(signals, delays, strict=True)):
        if signal is None:
            continue
        uniform = time.size == grid.size
        found = signal.grid(start - delay, step, count + 1) if uniform else signal.sample(time - delay)
        value[:, i], slope[:, i] = found
        if not all(-_LARGEST < x < _LARGEST for of in found for x in (of.min(), of.max())):
            raise SimulationError(f"The signal {signal.label!r} is too large to compute with: beyond 1e100.")
        if broken[i].size:
            before.append((i, *_from_the_left(signal, delay, broken[i], time, step)))
    value_before, slope_before = value, slope
    for i, at, left, left_slope in before:
        kinks = np.abs(left_slope - slope[at, i]) > 1e-9 * float(np.abs(slope[:, i]).max())
        slope_before = _replace_column(slope_before, at[kinks], i, left_slope[kinks])
        leaps = np.abs(left - value[at, i]) > 1e-12 * max(float(np.abs(value[:, i]).max()), 1e-300)
        value_before = _replace_column(value_before, at[leaps], i, left[leaps])
        jumped[at[leaps]] = True
    return InputTable(
        step=step,
        time=time,
        value=value,
        slope=slope,
        value_before=value_before,
        slope_before=slope_before,
        special=np.append(odd, time.size + 1),
        slot=slot,
        sampled=grid[::every],
        moving=tuple(signal is not None for signal in signals),
        jumps=bool(jumped.any()),
    )


def _replace_column(rows: Matrix, at: NDArray[np.intp], column: int, values: Matrix) -> Matrix:
    """A copy of the rows with these values in one column; the rows themselves if there are none."""
    if at.size:
        rows = rows.copy()
        rows[at, column] = values
    return rows


def _on_common_knots(
    broken: Sequence[Matrix], signals: Sequence[Signal | None], delays: Sequence[float]
) -> list[Matrix]:
    """The breaks of each signal, at that of another one where they differ by what a signal takes for rounding."""
    moved, known = list(broken), np.zeros(0)
    for i in sorted(range(len(broken)), key=lambda i: _widest(signals[i]) or 0.0):
        signal, times = signals[i], broken[i]
        if signal is None or not times.size:
            continue
        for shift in (-1, 0) if known.size else ():
            other = known[np.clip(np.searchsorted(known, times) + shift, 0, known.size - 1)]
            times = _onto(other, times, signal, delays[i])
        moved[i], known = times, np.union1d(known, times)
    return moved


def _onto(knots: Matrix, times: Matrix, signal: Signal, delay: float) -> Matrix:
    """Breaks of a delayed signal, at the knots beside them where the signal counts them as reached there.

    It would otherwise have its value after a break at a knot before that, as if it had changed over the step to there.
    """
    return np.where(np.abs(times - knots) <= time_tolerance(times - delay, _widest(signal)), knots, times)


def _between(broken: Matrix, start: float, step: float) -> Matrix:
    """The breaks, each once, that lie between the multiples of a step."""
    if not broken.size:
        return broken
    between: Matrix = np.unique(broken)
    between = between[np.abs((between - start) / step - np.rint((between - start) / step)) > _SAME]
    between = between[np.concatenate([[True], np.diff(between) > _SAME * step])[: between.size]]
    return between


def _knots(
    grid: Matrix, between: Matrix, step: float, every: int
) -> tuple[Matrix, NDArray[np.int64], NDArray[np.int64]]:
    """The times of all knots, the number of the sample at each, or -1, and the segments of another length."""
    slot = np.full(grid.size, -1, np.int64)
    slot[::every] = np.arange(slot[::every].size)
    if not between.size:
        return grid, slot, np.zeros(0, np.int64)
    order = np.argsort(np.concatenate([grid, between]), kind="stable")
    time = np.concatenate([grid, between])[order]
    slot = np.concatenate([slot, np.full(between.size, -1)])[order]
    return time, slot, np.flatnonzero(np.abs(np.diff(time) - step) > _SAME * step)


def tabulate_once(
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    duration: float,
    step: float,
    every: int = 1,
    start: float = 0.0,
    joined: bool = False,
) -> InputTable:
    """The table of `tabulate`, which is kept for further runs over the same signals; not to be written to."""
    small = duration / step * max(1, len(signals)) <= _KEPT
    frozen = all(signal is None or type(signal).__hash__ is object.__hash__ for signal in signals)
    given = (tuple(signals), tuple(delays), float(duration), float(step), every, float(start), joined)
    return (_tabulate_and_keep if small and frozen else tabulate)(*given)


_tabulate_and_keep = lru_cache(maxsize=8)(tabulate)  # a frozen signal is equal to itself alone


def parts_of(interval: float, delays: Sequence[float]) -> int:
    """Number of steps per interval for which all delays are whole numbers of steps; 1 if none up to 20 suffices.

    Signals that are held for `interval` then jump where steps join, which is much faster than between.
    """
    for parts in range(1, 21):
        steps = np.asarray(delays) * parts / interval
        if np.all(np.abs(steps - np.rint(steps)) <= _SAME * np.maximum(steps, 1.0)):
            return parts
    return 1


def just_before(signals: Sequence[Signal | None], delays: Sequence[float], time: float, step: float) -> Matrix:
    """(2, inputs): values and slopes of all inputs from the left at a time [s]; zero without a signal."""
    at, found = np.array([time]), np.zeros((2, len(signals)))
    for i, (signal, delay) in enumerate(zip(signals, delays, strict=True)):
        if signal is not None:
            breaks = _breaks(signal, delay, time, time, step, joined=True)
            left = _from_the_left(signal, delay, breaks, at, step)[1:] if breaks.size else signal.sample(at - delay)
            found[:, i] = np.ravel(left)
    return found


def _breaks(signal: Signal, delay: float, first: float, last: float, step: float, joined: bool) -> Matrix:
    """Times [s] at which a delayed signal breaks: after `first` (from `first` if `joined`), up to `last`, included."""
    begin = first - 0.5 * step if joined else first
    times = signal.breaks(begin - delay, last - delay + 0.5 * step) + delay
    times = _onto(first + step * np.rint((times - first) / step), times, signal, delay)
    return times[(times >= first - _SAME * step) & (times <= last + _SAME * step)]


def _from_the_left(
    signal: Signal, delay: float, breaks: Matrix, time: Matrix, step: float
) -> tuple[NDArray[np.intp], Matrix, Matrix]:
    """Knots at which a signal breaks, with its value and slope just before them."""
    at = np.searchsorted(time, breaks - 0.5 * _SAME * step)
    at = at[np.abs(time[np.minimum(at, time.size - 1)] - breaks) <= 2.0 * _SAME * step]
    aside = 1e-5 * min(step, signal.interval or step) + 3.0 * time_tolerance(time[at] - delay, _widest(signal))
    (left, slope), (_, further) = (signal.sample(time[at] - delay - i * aside) for i in (1, 2))
    return at, left + aside * (1.5 * slope - 0.5 * further), 2.0 * slope - further


def _widest(signal: Signal | None) -> float | None:
    """The largest interval of the tables in a signal: how far a knot reaches follows from it."""
    if signal is None:
        return None
    terms = [term for _, term in signal.terms] if isinstance(signal, SignalSum) else []
    return max((_widest(term) or 0.0 for term in terms), default=signal.interval or 0.0) or None


def whole_steps(duration: float, step: float) -> int:
    """The number of steps in a duration.

    Raises `SimulationError` unless it is a whole number, at least one.
    """
    check_positive(SimulationError, "The duration of a simulation", duration, "s")
    check_positive(SimulationError, "The step of a simulation", step, "s")
    count = duration / step
    if count > 1e9:
        raise SimulationError(
            f"{format_quantity(duration, 's', 6)} in steps of {format_quantity(step, 's', 6)} are "
            f"{format_number(count, 3)} steps; at most 1e9 are possible."
        )
    if round(count) < 1 or abs(count - round(count)) > 1e-6:
        given, steps, better = format_alike([duration, step, duration / max(1, math.ceil(count))], "s", 9)
        raise SimulationError(
            f"The duration must be a whole number of steps, got {given} in steps of {steps}. Try a step of {better}."
        )
    return round(count)


def check_steps(signals: Sequence[Signal | None], step: float, end: float) -> None:
    """Raises `SimulationError` if a step is too long for a signal, or a signal ends before `end` [s]."""
    for signal in signals:
        if signal is not None:
            _check_step(signal, step, end)


def _check_step(signal: Signal, step: float, end: float) -> None:
    highest = signal.highest_frequency
    if highest is not None and step > 0.5 / highest * (1.0 + _SAME):
        given, most = format_alike([step, 0.5 / highest], "s")
        raise SimulationError(
            f"A step of {given} is too long for {signal.label!r}, which goes up to "
            f"{format_quantity(highest, 'Hz', 6)}. Take {most} or less."
        )
    if signal.interval is not None and step > signal.interval * (1.0 + _SAME):
        given, most = format_alike([step, signal.interval], "s")
        raise SimulationError(
            f"A step of {given} is too long for {signal.label!r}, whose samples are {most} apart. Take {most} or less."
        )
    if signal.duration is not None and end > signal.duration * (1.0 + _SAME):
        known, asked = format_alike([signal.duration, end], "s")
        raise SimulationError(f"The signal {signal.label!r} lasts {known}, but the simulation lasts until {asked}.")


def check_holds(system: PiecewiseSystem, signals: Sequence[Signal | None]) -> None:
    """Raises `SimulationError` for a motion without velocity or acceleration where an element needs it."""
    for i, (road, signal) in enumerate(zip(system.mechanism.roads, signals, strict=False)):
        if signal is None or signal.hold == "cubic":
            continue
        if system.needs_acceleration[i]:
            raise SimulationError(
                f"An inerter or a lock follows the acceleration of {road.name!r}, which {signal.label!r} does not "
                f'have between its samples. Use hold="cubic".'
            )
        if signal.hold == "zero" and system.needs_velocity[i]:
            raise SimulationError(
                f"A damper follows the velocity of {road.name!r}, which {signal.label!r} does not have where it "
                f'jumps. Use hold="cubic" or "linear".'
            )
        if signal.hold == "zero" and system.moves_elements[i]:
            raise SimulationError(
                f"A friction element or a gap moves with {road.name!r} without a mass between; {signal.label!r} jumps, "
                f'and what slips or touches on the way of a jump is not determined. Use hold="cubic" or "linear".'
            )
