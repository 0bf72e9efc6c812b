"""The steady state under a sine of force: its size over all frequencies, for mechanisms that are not linear."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from inerter.errors import Status
from inerter.norms.hinf import Peak
from inerter.signals.harmonics import sine
from inerter.simulation.inputs import tabulate
from inerter.simulation.start import initial_state
from inerter.simulation.steady import mean_squares
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]
_POINTS = 128  # a period at least: the error of its cubics is 1e-8
_LONGEST = 1e-3  # [s] of a step
_MOST_PERIODS = 300  # until a motion must repeat
_GRID = 48  # frequencies between which peaks are looked for
_NEAR = 1e-4  # relative distance up to which a peak's frequency is found: its height is then right to 1e-8


@dataclass(frozen=True, eq=False)
class Forced:
    """R.m.s. of an output over that of a force A sin(omega t), once the motion repeats."""

    system: PiecewiseSystem
    force: str
    output: str
    amplitude: float  # [N]

    def __call__(self, omega: float) -> tuple[float, Status]:
        """The ratio at `omega` [rad/s]."""
        period = 2.0 * pi / omega
        step = period / max(_POINTS, round(period / _LONGEST))
        mechanism = self.system.mechanism
        signal = sine(self.amplitude, 1.0 / period)
        signals = [None] * len(mechanism.roads) + [signal if f.name == self.force else None for f in mechanism.forces]
        table = tabulate(signals, [0.0] * len(signals), period, step)
        state = initial_state(self.system, np.zeros(len(signals)), "rest")
        found, integration = mean_squares(self.system, table, [self.output], state, _MOST_PERIODS)
        status = integration.status if not integration.status.ok else integration.warning
        return sqrt(2.0 * float(found[0])) / self.amplitude, status


def local_maxima(forced: Forced, poles: Array, start: Array, pool: Executor) -> tuple[list[Peak], list[Status]]:
    """Every local maximum of the ratio over all frequencies, the highest first; one at omega = 0 is the static ratio.

    Looked for on a grid around the `poles` [rad/s] of the linear motion that holds the frequencies `start` too, and
    refined. What lies beyond the grid falls off with the mass, or is static.
    """
    grid = np.unique(np.concatenate([frequency_grid(poles), start[start > 0.0]]))
    found = list(pool.map(forced, grid.tolist()))
    ratios, status = np.array([ratio for ratio, _ in found]), [status for _, status in found]
    inner = [i for i in range(1, grid.size - 1) if ratios[i] >= ratios[i - 1] and ratios[i] > ratios[i + 1]]

    def refine(i: int) -> Peak:
        def depth(logarithm: float) -> float:
            return -forced(float(np.exp(logarithm)))[0]

        best = _least(depth, np.log(grid[i - 1 : i + 2]), -ratios[i])
        return Peak(float(np.exp(best[0])), -best[1])

    peaks = list(pool.map(refine, inner))
    if grid.size and (not grid.size > 1 or ratios[0] > ratios[1]):
        peaks.append(Peak(0.0, float(ratios[0])))
    return sorted(peaks, key=lambda peak: -peak.gain), status


def _least(depth: Callable[[float], float], bracket: Array, middle: float) -> tuple[float, float]:
    low, at, high = bracket
    found = scipy.optimize.minimize_scalar(depth, bounds=(low, high), method="bounded", options={"xatol": _NEAR})
    return (float(found.x), float(found.fun)) if found.fun < middle else (float(at), float(middle))


def frequency_grid(poles: Array) -> Array:
    """Frequencies [rad/s] from far below the slowest pole to above the fastest that swings."""
    size = np.abs(poles)
    swinging = size[np.abs(poles.imag) > 0.05 * size]
    if not size.size or not size.max() > 0.0:
        return np.geomspace(0.06, 600.0, _GRID)
    fastest = swinging.max() if swinging.size else np.median(size)
    slowest = max(float(size[size > 1e-9 * size.max()].min()), 1e-3 * float(fastest))
    return np.geomspace(0.02 * slowest, 2.0 * float(fastest), _GRID)
