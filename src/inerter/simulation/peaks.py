"""The extremes of a motion: peaks with their times, and tyres that are pulled where real ones would lift off."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.formatting import format_list, format_quantity, in_words

Matrix = NDArray[np.float64]
_COARSE = 1.0 - np.cos(2.0 * np.pi / 10.0)  # of ten samples for each oscillation


@dataclass(frozen=True)
class Peak:
    """The sample of an output that is farthest from zero, with its sign, and when it was.

    >>> import inerter as it
    >>> run = it.simulate(it.Rig(it.Spring(1e5)), displacement=it.sine(0.01, 1.0), duration=0.5)
    >>> peak = run.peak("device_force")
    >>> round(peak.value, 3), round(peak.time, 3)  # N, s
    (1000.0, 0.25)
    """

    value: float
    time: float  # [s]


@dataclass(frozen=True)
class LiftOff:
    """A span in which a tyre pulls by more than its static load, as no real one does: it would have lifted off.

    `beyond` is the largest force beyond the static load.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(20e3) | it.Damper(1500.0))
    >>> first = it.simulate(car, road=it.bump(0.15, 1.0, speed=10.0), duration=1.0).lift_offs[0]
    >>> first.tyre, first.begin < first.end  # s
    ('tyre', True)
    """

    tyre: str
    begin: float  # [s]
    end: float  # [s]
    beyond: float  # [N]


def peak_of(time: Matrix, values: Matrix) -> Peak:
    """The peak of samples; nan where one of them is."""
    at = int(np.argmax(np.abs(values)))
    return Peak(float(values[at]), float(time[at]))


def is_coarse(values: Matrix) -> bool:
    """Whether even samples are fewer than about ten for each oscillation, so that they miss peaks.

    Lines between every other sample miss those between them by 1 - cos(2 pi/n) of a sine with n samples in a period.

    >>> [is_coarse(np.sin(2.0 * np.pi / n * np.arange(200.0))) for n in (8, 12)]
    [True, False]
    """
    missed = values[1:-1:2] - 0.5 * (values[:-2:2] + values[2::2])
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(missed.size) and bool(np.sqrt(np.mean(missed**2)) > _COARSE * np.std(values))


def lift_offs_of(tyre: str, time: Matrix, load: Matrix, static: float) -> Iterator[LiftOff]:
    """The spans in which a dynamic load [N], pulling positive, exceeds a static one, by lines between samples."""
    over = load - static
    above = np.concatenate([[False], over > 0.0, [False]])
    edges = np.flatnonzero(above[1:] != above[:-1])
    for first, last in zip(edges[::2], edges[1::2] - 1, strict=True):
        begin = time[first] if first == 0 else _crossing(time, over, first - 1)
        end = time[last] if last == time.size - 1 else _crossing(time, over, last)
        yield LiftOff(tyre, float(begin), float(end), float(over[first : last + 1].max()))


def lift_off_sentence(found: Sequence[LiftOff]) -> str:
    """Which tyres lift off for how long, and since when the motion is not valid; `found` by time."""
    lifted = []
    for tyre in dict.fromkeys(one.tyre for one in found):
        spans = [one for one in found if one.tyre == tyre]
        total = format_quantity(sum(one.end - one.begin for one in spans), "s", 3)
        lifted.append(f"{in_words(tyre)} for {total}{f' in {len(spans)} intervals' if len(spans) > 1 else ''}")
    since = format_quantity(found[0].begin, "s")
    return f"lift-off of {format_list(lifted)}: the motion after {since} is not valid"


def _crossing(time: Matrix, over: Matrix, i: int) -> float:
    """Time [s] at which linear interpolation between the samples i and i + 1 is zero."""
    return float(time[i] + (time[i + 1] - time[i]) * over[i] / (over[i] - over[i + 1]))
