"""Quarter cars with friction on true white noise, by a time stepping that shares nothing with the package.

The road grows by independent normal increments at every step: it has no lines, no period and no band. Steps are
symplectic, so that they damp nothing by themselves, and the friction force is implicit in each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
from wang_su import ROAD

import inerter as it

ROADS, SETTLING, LENGTH, STEP = 32, 160.0, 320.0, 1e-4


@dataclass(frozen=True)
class Car:
    """Masses [kg], tyre [N/m], and what its strut is made of: `kind` 0 has b beside, 1 in series with the damper."""

    sprung: float
    unsprung: float
    tyre: float
    k: float
    c: float
    b: float
    f: float
    kind: int
    series: float = 0.0  # [N s/m] damper in series, of kind 1

    @property
    def vehicle(self) -> it.QuarterCar:
        strut = it.Spring(self.k) | it.Damper(self.c)
        if self.kind == 1:
            strut = strut | it.Damper(self.series) - (it.Inerter(self.b) | it.Friction(self.f))
        else:
            strut = strut | it.Friction(self.f)
            strut = strut | it.Inerter(self.b) if self.b > 0.0 else strut
        return it.QuarterCar(self.sprung, self.unsprung, self.tyre, strut)


@numba.njit(cache=False)
def mean_squares(sprung, unsprung, tyre, k, c, b, f, kind, series, intensity, steps, settling, h, seed):
    """Mean squares of body acceleration and tyre force on one road, in steps of `h`."""
    np.random.seed(seed)
    x = u = v = w = road = inner = 0.0  # heights of body and wheel, velocities, road, velocity across the inerter
    acceleration = load = 0.0
    kick = intensity * math.sqrt(h)
    for i in range(steps):
        road += kick * np.random.standard_normal()
        grip = tyre * (u - road)
        if kind == 1:
            across = v - w
            trial = b * inner + h * series * across
            stop = h * f
            held = trial - stop if trial > stop else trial + stop if trial < -stop else 0.0
            inner = held / (b + h * series)
            force = k * (x - u) + c * across + series * (across - inner)
            before = v
            v -= h * force / sprung
            w += h * (force - grip) / unsprung
            felt = (v - before) / h
        else:
            # velocities after the step with the friction force s: a linear system in (v, w), solved for s by cases
            m11, m12 = sprung + b + h * c, -b - h * c
            m22 = unsprung + b + h * c
            r1 = sprung * v + b * (v - w) - h * k * (x - u)
            r2 = unsprung * w - b * (v - w) + h * k * (x - u) - h * grip
            det = m11 * m22 - m12 * m12
            a = (m22 * r1 - m12 * r2) / det
            d = (m11 * r2 - m12 * r1) / det
            slide, answer = a - d, h * (m11 + m22 + 2.0 * m12) / det
            s = slide / answer
            s = f if s > f else -f if s < -f else s
            before = v
            v = a - h * s * (m22 + m12) / det
            w = d + h * s * (m11 + m12) / det
            felt = (v - before) / h
        x += h * v
        u += h * w
        if i >= settling:
            acceleration += felt * felt
            load += grip * grip
    return acceleration / (steps - settling), load / (steps - settling)


def stepped(car: Car, roads: int = ROADS) -> tuple[np.ndarray, np.ndarray]:
    """J1 and J3 with their standard errors, over so many roads of white velocity."""
    intensity = 2.0 * math.pi * math.sqrt(ROAD.speed * ROAD.roughness)
    values = (car.sprung, car.unsprung, car.tyre, car.k, car.c, car.b, car.f, car.kind, car.series)
    steps, settling = round((SETTLING + LENGTH) / STEP), round(SETTLING / STEP)
    power = np.array([mean_squares(*values, intensity, steps, settling, STEP, seed) for seed in range(roads)])
    mean, error = power.mean(axis=0), power.std(axis=0, ddof=1) / math.sqrt(roads)
    return np.sqrt(mean), 0.5 * error / np.sqrt(mean)


def drawn(number: int) -> Car:
    """A random car; the friction is of the size of the forces in the strut, give or take a decade."""
    rng = np.random.default_rng([2008, number])
    sprung = float(np.exp(rng.uniform(np.log(120.0), np.log(600.0))))
    unsprung = sprung * float(rng.uniform(0.08, 0.25))
    tyre = float(np.exp(rng.uniform(np.log(80e3), np.log(300e3))))
    k = tyre * float(np.exp(rng.uniform(np.log(0.08), np.log(0.8))))
    critical = 2.0 * math.sqrt(k * sprung)
    kind = int(rng.integers(0, 3))
    c = critical * float(np.exp(rng.uniform(np.log(0.005), np.log(0.3))))
    b = 0.0 if kind == 2 else sprung * float(np.exp(rng.uniform(np.log(0.05), np.log(2.0))))
    f = sprung * float(np.exp(rng.uniform(np.log(0.05), np.log(8.0))))
    series = critical * float(np.exp(rng.uniform(np.log(0.1), np.log(2.0))))
    return Car(sprung, unsprung, tyre, k, c, b, f, 1 if kind == 1 else 0, series)
