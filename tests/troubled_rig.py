"""A test rig that shares no code with the package, with the troubles that real devices and sensors have.

The device is a shaft (spring beside damper), a gap, and an inertance with friction; or the inertance alone, moved by
the table itself. Explicit time stepping at 2 us; friction is set-valued: each step takes away as much momentum as the
friction can and no more than there is (Moreau 1988), so that nothing is regularised. Its level may depend on speed,
direction and place. Filters of sensors run on the fine steps; then the samples are taken, disturbed and rounded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, butter, lfilter

Matrix = NDArray[np.float64]
STEP = 2e-6  # [s]


@dataclass(frozen=True)
class Device:
    """Shaft `ks` [N/m] and `cs` [N s/m] (both zero: rigid), half-gap [m], inertance [kg], friction [N], damper."""

    b: float
    f: float
    ks: float = 0.0
    cs: float = 0.0
    gap: float = 0.0
    c: float = 0.0
    static: float = 1.0  # friction at rest over that when it slides fast, which is f
    stribeck_speed: float = 1.0  # [m/s]
    bias: float = 0.0  # friction is f (1 + bias) upwards, f (1 - bias) downwards
    slope: float = 0.0  # relative change of the friction over one metre
    ripple: float = 0.0  # relative size of a change that repeats over `pitch`
    pitch: float = 5e-3  # [m]

    @property
    def rigid(self) -> bool:
        return self.ks == 0.0


@dataclass(frozen=True)
class Sensors:
    """What encoder and load cell make of the motion and the force; the defaults are those of a sound rig."""

    rate: float = 1000.0  # [Hz]
    encoder_step: float = 1e-6  # [m]
    encoder_noise: float = 0.3e-6  # [m]
    force_step: float = 0.05  # [N]
    force_noise: float = 0.15  # [N]
    cell: float = 300.0  # [Hz] Butterworth of second order
    amplifier: float = 0.0  # [Hz] a second filter of the force, of second order; 0: none
    force_late: float = 0.0  # [s]
    displacement_late: float = 0.0  # [s]
    displacement_filter: float = 0.0  # [Hz]; 0: none
    filter_order: int = 2
    fixture: float = 0.0  # [kg] between device and cell, on the moving side
    offset: float = 0.0  # [N]
    drift: float = 0.0  # [N] over the record
    drift_shape: str = "line"
    lost: tuple[tuple[float, int], ...] = ()  # (part of the record, samples that are lost there)


@dataclass(frozen=True)
class Tones:
    """A motion of cosines that grows from rest within `ramp` [s]: amplitudes [m], frequencies [Hz], phases."""

    amplitudes: tuple[float, ...]
    frequencies: tuple[float, ...]
    phases: tuple[float, ...] = field(default=())
    ramp: float = 0.5

    def at(self, time: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """Displacement, velocity and acceleration."""
        x, v, a = np.zeros(time.size), np.zeros(time.size), np.zeros(time.size)
        phases = self.phases or (0.0,) * len(self.frequencies)
        for size, f, phase in zip(self.amplitudes, self.frequencies, phases, strict=True):
            w = 2.0 * math.pi * f
            cos, sin = size * np.cos(w * time + phase), size * np.sin(w * time + phase)
            x, v, a = x + cos - size * math.cos(phase), v - w * sin, a - w * w * cos
        s = np.minimum(time / self.ramp, 1.0)
        r, r1 = s**3 * (10.0 - 15.0 * s + 6.0 * s**2), 30.0 * s**2 * (1.0 - s) ** 2 / self.ramp
        r2 = np.where(s < 1.0, 60.0 * s * (1.0 - 3.0 * s + 2.0 * s**2) / self.ramp**2, 0.0)
        return r * x, r1 * x + r * v, r2 * x + 2.0 * r1 * v + r * a


@numba.njit(cache=True)
def _friction(v, y, f, static, speed, bias, slope, ripple, pitch):  # type: ignore[no-untyped-def]
    level = f * (1.0 + (static - 1.0) * math.exp(-((v / speed) ** 2)))
    place = max(1.0 + slope * y + ripple * math.cos(2.0 * math.pi * y / pitch), 0.0)
    return level * place * (1.0 + bias), level * place * (1.0 - bias)


@numba.njit(cache=True)
def _stepped(z, v, a, dt, ks, cs, gap, b, c, law):  # type: ignore[no-untyped-def]
    force = np.empty(z.size)
    if ks == 0.0:
        for n in range(z.size):
            up, down = _friction(v[n], z[n], *law)
            force[n] = b * a[n] + c * v[n] + (up if v[n] > 0.0 else -down if v[n] < 0.0 else 0.0)
        return force
    y, w, shaft, side = 0.0, 0.0, 0.0, 0
    for n in range(z.size):
        if gap == 0.0:
            pull = ks * (z[n] - y) + cs * (v[n] - w)
        else:
            across = z[n] - y - shaft
            if side == 0 and abs(across) >= gap:
                side = 1 if across > 0.0 else -1
            pull = 0.0
            if side != 0:
                shaft = z[n] - y - side * gap
                pull = ks * shaft + cs * (v[n] - w)
                if side * pull < 0.0:
                    side, pull = 0, 0.0
            if side == 0:
                shaft *= math.exp(-ks / cs * dt)
        force[n] = pull
        w += dt * (pull - c * w) / b
        up, down = _friction(w, y, *law)
        w = max(w - dt * up / b, 0.0) if w > 0.0 else min(w + dt * down / b, 0.0)
        y += dt * w
    return force


def device_force(device: Device, z: Matrix, v: Matrix, a: Matrix, dt: float = STEP) -> Matrix:
    """The force of the device at its moved end [N], for a motion in steps of `dt` from rest."""
    d = device
    law = (d.f, d.static, d.stribeck_speed, d.bias, d.slope, d.ripple, d.pitch)
    return np.asarray(_stepped(z, v, a, dt, d.ks, d.cs, d.gap, d.b, d.c, law))


def measured(
    device: Device, motion: Tones, sensors: Sensors, duration: float, seed: int
) -> tuple[Matrix, Matrix, Matrix]:
    """Times, displacement [m] and force [N] as the sensors read them."""
    random = np.random.default_rng(seed)
    s, every = sensors, round(1.0 / sensors.rate / STEP)
    fine = STEP * np.arange(round(duration * s.rate) * every + 1)
    z, v, a = motion.at(fine)
    force = device_force(device, z, v, a) + s.fixture * a
    force = _late(_low_pass(_low_pass(force, s.cell, 2), s.amplifier, 2), s.force_late)[::every]
    z = _late(_low_pass(z, s.displacement_filter, s.filter_order), s.displacement_late)[::every]
    time = fine[::every]
    force = force + s.offset + s.drift * _drifting(time / duration, s.drift_shape)
    z = _rounded(z + s.encoder_noise * random.standard_normal(z.size), s.encoder_step)
    force = _rounded(force + s.force_noise * random.standard_normal(z.size), s.force_step)
    kept = np.ones(z.size, dtype=bool)
    for place, count in s.lost:
        at = int(place * z.size)
        kept[at : at + count] = False
    return time[: int(kept.sum())], z[kept], force[kept]


def _low_pass(values: Matrix, corner: float, order: int) -> Matrix:
    if corner == 0.0:
        return values
    b, a = bilinear(*butter(order, 2.0 * math.pi * corner, analog=True), 1.0 / STEP)
    return np.asarray(lfilter(b, a, values))


def _late(values: Matrix, delay: float) -> Matrix:
    steps = round(delay / STEP)
    return values if steps == 0 else np.concatenate([np.full(steps, values[0]), values[:-steps]])


def _drifting(s: Matrix, shape: str) -> Matrix:
    shapes = {"line": s, "warming": (1.0 - np.exp(-3.0 * s)) / (1.0 - math.exp(-3.0)), "slow": np.sin(math.pi * s)}
    return np.asarray(shapes[shape])


def _rounded(values: Matrix, step: float) -> Matrix:
    return np.asarray(step * np.rint(values / step))
