"""Roads of cubics for FMUs and for simulations, and how far both are apart."""

from __future__ import annotations

import shutil
import sys

import numpy as np
import pytest
from fmu_master import Master

import inerter as it

needs_compiler = pytest.mark.skipif(
    shutil.which("cc") is None or not sys.platform.startswith("linux"), reason="There is no C compiler called cc."
)


def road(duration: float, step: float, seed: int = 0) -> tuple[it.Signal, np.ndarray, np.ndarray]:
    """A road of cubics between the communication points, with its heights and slopes there; it begins at zero."""
    rng = np.random.default_rng(seed)
    time = step * np.arange(round(duration / step) + 1)
    lines = [(rng.uniform(0.5, 30.0), 10.0 ** rng.uniform(-4, -2.3), rng.uniform(0, 2 * np.pi)) for _ in range(12)]
    height = sum(a * (np.sin(2 * np.pi * f * time + p) - np.sin(p)) for f, a, p in lines)
    slope = sum(2 * np.pi * f * a * np.cos(2 * np.pi * f * time + p) for f, a, p in lines)
    return it.Signal.sampled(time, height, "cubic", derivative=slope), height, slope


def rates(height: np.ndarray, slope: np.ndarray, step: float, at: int) -> tuple[float, float, float]:
    """Velocity of a cubic over the step that begins at a knot, and its first two derivatives there."""
    rise, ends = (height[at + 1] - height[at]) / step, slope[at] + slope[at + 1]
    return slope[at], (6.0 * rise - 4.0 * slope[at] - 2.0 * slope[at + 1]) / step, 6.0 * (ends - 2.0 * rise) / step**2


def driven(master: Master, height: np.ndarray, slope: np.ndarray, step: float, shown: tuple[str, ...]) -> np.ndarray:
    """Outputs after every step, with the road at every input of a road."""
    given = {v.name for v in master.description.modelVariables if v.causality == "input"}
    inputs = [name for name in master.references if name in given and name.endswith("_velocity")]
    found = []
    for at in range(height.size - 1):
        for name in inputs:
            master.set(name, *rates(height, slope, step, at))
        master.step(step)
        found.append(master.get(*shown))
    return np.array(found)


def error(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest r.m.s. of the error over the r.m.s. of the signal."""
    return float(np.max(np.sqrt(np.mean((found - expected) ** 2, axis=0) / np.mean(expected**2, axis=0))))
