"""Periodic steady state under a sinusoidal input: gain over frequency, for nonlinear mechanisms."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import ErrorSource, Status
from inerter.methods.steady_squares import Squares, steady_squares, steady_state_error
from inerter.norms.hinf import GainPeak
from inerter.signals.harmonics import sine
from inerter.simulation.initial_state import initial_state
from inerter.simulation.inputs import tabulate
from inerter.systems.filters import Filter
from inerter.systems.input_paths import InputPath
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
_POINTS = 64  # a period at least: the error of its cubics is 2e-7
_LONGEST = 1e-3  # [s] of a step
_MOST_PERIODS, _REPEATS = 300, 1e-5  # until a motion must repeat, and how well
_GRID = 32  # frequencies between which peaks are looked for where nothing is known of them
_WITHIN = 1.25  # ratio to a frequency near which a peak is expected
_MOST_BEYOND = 40  # steps of that ratio beyond the frequencies that were visited
_NEAR = 1e-3  # relative distance up to which a peak's frequency is found
_STEPPED = 1e-5  # relative error of a ratio by the time step
_SWEPT, _FINELY, _RISES = 1.02, 1.001, 1e-4  # ratios of frequencies in a sweep, and what counts as higher in it
_MOST_SWEPT = 100  # frequencies of a sweep


@dataclass(frozen=True, eq=False)
class ForcedResponse:
    """Ratio of the r.m.s. of an output about its mean to that of an input A sin(omega t), in the periodic steady state.

    The mean is zero but for forces that differ by direction, such as a preload, which moves the mean without any input.
    """

    system: PiecewiseSystem
    path: InputPath  # a force, or a road's displacement or velocity
    output: str
    amplitude: float  # [N], [m] or [m/s]
    filter: Filter | None = None  # that the output passes through

    def __call__(self, omega: float, start: Array | None = None) -> tuple[float, Squares]:
        """Ratio at `omega` [rad/s], and the mean squares of the steady state that begins at `start`, or at rest."""
        period = 2.0 * pi / omega
        step = period / max(_POINTS, round(period / _LONGEST))
        mechanism, path = self.system.mechanism, self.path
        roads = [road.name for road in mechanism.roads]
        by_velocity = path.input in roads and not path.displacement
        signal = sine(self.amplitude / omega if by_velocity else self.amplitude, 1.0 / period)
        names = [*roads, *(force.name for force in mechanism.forces)]
        signals = [signal if name == path.input else None for name in names]
        table = tabulate(signals, [0.0] * len(signals), period, step)
        state = initial_state(self.system, table.value[0], "rest") if start is None else start
        lower, upper = self.system.limits.T
        uneven = bool(np.any(lower != -upper))
        found = steady_squares(
            self.system, table, [self.output], [self.filter], state, _MOST_PERIODS, about_mean=uneven, repeats=_REPEATS
        )
        return sqrt(2.0 * float(found.power[0])) / self.amplitude, found


Visited = dict[float, tuple[float, Squares]]  # ratio and mean squares by frequency [rad/s]


@dataclass(frozen=True)
class Summit:
    """A local maximum of the ratio; `missed` is what the search may have left of its height, relative to it."""

    peak: GainPeak
    found: Squares
    missed: float

    @property
    def status(self) -> Status:
        """Status of the steady state at the peak."""
        return self.found.status

    @property
    def errors(self) -> tuple[ErrorSource, ...]:
        """Error sources of the height of the peak."""
        missed = ErrorSource("search for the peak", self.missed)
        stepped = ErrorSource("time step", _STEPPED + float(self.found.jumps[0]))
        return stepped, steady_state_error([self.found.steady], sqrt(2.0)), missed


def local_maxima(
    forced: ForcedResponse, expected: Array, lowest: float, pool: Executor, visited: Visited | None = None
) -> list[Summit]:
    """Local maxima of the ratio near the expected frequencies [rad/s], the highest first.

    One that is expected at zero is the ratio at `lowest`. None of the frequencies `visited` before, or on the way, has
    a higher ratio: around the highest of them is a maximum too, which the ranges of the search may have cut. Where
    there are several steady states, as with stops, the highest goes on to that to which a slow sweep carries it.
    """
    near = np.unique(expected[expected > 0.0])
    middles = np.sqrt(near[1:] * near[:-1])
    lower = np.maximum(near / _WITHIN, np.concatenate([[0.0], middles]))
    upper = np.minimum(near * _WITHIN, np.concatenate([middles, [np.inf]]))
    ranges = list(zip(lower.tolist(), upper.tolist(), strict=True))
    searched = list(pool.map(lambda ends: _search(forced, *ends), ranges))
    summits = [_summit(points) for points in searched]
    peaks = [one for one, (low, high) in zip(summits, ranges, strict=True) if _is_inside(one.peak.omega, low, high)]
    if near.size < expected.size or not peaks:
        ratio, squares = forced(lowest)
        beside = forced(2.0 * lowest)[0]
        peaks.append(Summit(GainPeak(0.0, ratio), squares, abs(beside / ratio - 1.0) if ratio else 0.0))
    best = max(peaks, key=lambda summit: summit.peak.gain)
    points = {omega: found for several in (visited or {}, *searched) for omega, found in several.items()}
    if points and max(ratio for ratio, _ in points.values()) > (1.0 + best.missed) * best.peak.gain:
        peaks.append(_summit(points | _search(forced, *_enclose(forced, points, lowest))))
    peaks.sort(key=lambda summit: -summit.peak.gain)
    return [*_sweep(forced, peaks[0]), *peaks]


def _sweep(forced: ForcedResponse, summit: Summit) -> list[Summit]:
    """The highest ratio to which slow sweeps up and down from a summit carry its motion; none if it is no higher.

    Each frequency begins with the state at which the one before ended, and a sweep ends where the ratio falls.
    """
    omega, gain, squares, count, slope = summit.peak.omega, summit.peak.gain, summit.found, 0, 0.0
    if not omega or not squares.ending.size:
        return []
    for step in (_SWEPT, 1.0 / _SWEPT, _FINELY, 1.0 / _FINELY):
        if step == _FINELY and not slope:
            break
        while count < _MOST_SWEPT:
            count += 1
            ratio, found = forced(omega * step, squares.ending)
            if not ratio > (1.0 + _RISES) * gain:
                break
            slope = (ratio / gain - 1.0) / abs(np.log(step))
            omega, gain, squares = omega * step, ratio, found
    missed = _RISES + slope * float(np.log(_FINELY))
    return [Summit(GainPeak(omega, gain), squares, missed)] if slope else []


def _enclose(forced: ForcedResponse, points: Visited, lowest: float) -> tuple[float, float]:
    """Neighbours of the frequency with the highest ratio, in `points`, to which those are added that it takes."""
    for _ in range(_MOST_BEYOND):
        places = sorted(points)
        omega = _highest(points)
        if omega == places[-1]:
            beyond = omega * _WITHIN
        elif omega == places[0] and omega > lowest:
            beyond = max(omega / _WITHIN, lowest)
        else:
            break
        points[beyond] = forced(beyond)
    i = places.index(omega)
    return places[max(i - 1, 0)], places[min(i + 1, len(places) - 1)]


def _search(forced: ForcedResponse, lower: float, upper: float) -> Visited:
    """Ratios on the way to a maximum between two frequencies, which may be at one of them."""
    visited: Visited = {}

    def depth(logarithm: float) -> float:
        omega = float(np.exp(logarithm))
        visited[omega] = forced(omega)
        return -visited[omega][0]

    ends = np.log(lower), np.log(upper)
    scipy.optimize.minimize_scalar(depth, bounds=ends, method="bounded", options={"xatol": _NEAR})
    return visited


def _is_inside(omega: float, lower: float, upper: float) -> bool:
    """Whether a search has not ended at one of the ends of its range."""
    return bool(np.log(min(omega / lower, upper / omega)) >= 3.0 * _NEAR)


def _highest(points: Visited) -> float:
    return max(points, key=lambda omega: points[omega][0])


def _summit(points: Visited) -> Summit:
    """The highest of the frequencies that were visited."""
    omega = _highest(points)
    height, squares = points[omega]
    return Summit(GainPeak(omega, height), squares, _above(points, omega) / max(height, 1e-300))


def _above(points: Visited, omega: float) -> float:
    """Twice the rise of a parabola through the highest point and its neighbours over that point."""
    places = sorted(points)
    i = places.index(omega)
    if not 0 < i < len(places) - 1:
        return 0.0
    x = np.log(np.array(places[i - 1 : i + 2]) / omega)
    (before, here, after) = (points[place][0] for place in places[i - 1 : i + 2])
    rises = (before - here) / x[0], (after - here) / x[2]
    curvature = (rises[1] - rises[0]) / (x[2] - x[0])
    slope = rises[0] - curvature * x[0]
    return float(-0.5 * slope**2 / curvature) if curvature < 0.0 else 0.0


def coarse_maxima(forced: ForcedResponse, poles: Array, pool: Executor) -> tuple[Array, Visited]:
    """Approximate frequencies of the local maxima [rad/s], on a grid around the `poles` [rad/s] of the linear motion.

    Zero stands for one below the grid. Also the ratios on the grid.
    """
    grid = frequency_grid(poles)
    points = dict(zip(grid.tolist(), pool.map(forced, grid.tolist()), strict=True))
    ratios = np.array([ratio for ratio, _ in points.values()])
    inner = 1 + np.flatnonzero((ratios[1:-1] >= ratios[:-2]) & (ratios[1:-1] > ratios[2:]))
    return np.concatenate([grid[inner], np.zeros(1 if ratios[0] > ratios[1] else 0)]), points


def frequency_grid(poles: Array) -> Array:
    """Frequencies [rad/s] from far below the slowest pole to above the fastest that swings."""
    size = np.abs(poles)
    swinging = size[np.abs(poles.imag) > 0.05 * size]
    if not size.size or not size.max() > 0.0:
        return np.geomspace(0.06, 600.0, _GRID)
    fastest = swinging.max() if swinging.size else np.median(size)
    slowest = max(float(size[size > 1e-9 * size.max()].min()), 1e-3 * float(fastest))
    return np.geomspace(0.02 * slowest, 2.0 * float(fastest), _GRID)
