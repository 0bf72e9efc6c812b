"""Rigs with faults that `troubled_rig` lacks, stepped by code of their own: laws of devices, faults of recorders.

The device is a shaft, a gap and an inertance with friction, stepped explicitly at 10 us (Moreau 1988 for friction). A
law adds one term: presliding after Dahl, a damping that grows with the square of the speed, a shaft that stiffens, a
second gap, behind which another spring takes part, or a friction that varies along the position. Faults of recorders
are made of the samples.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, butter, lfilter

import inerter as it

Matrix = NDArray[np.float64]
STEP = 1e-5  # [s]
RATE = 1000.0  # [Hz]
TONES = ((2e-3, 1.3), (8e-4, 3.1), (3e-4, 5.7))
LAWS = {"": 0, "presliding": 1, "quadratic": 2, "second gap": 3, "stiffening": 4, "ripple": 5}


@dataclass(frozen=True)
class Rig:
    """A device [kg, N, N/m, N s/m, m], a law with up to two numbers, and tones (amplitude [m], frequency [Hz])."""

    b: float = 80.0
    f: float = 12.0
    ks: float = 8e5
    cs: float = 2e3
    gap: float = 0.0
    law: str = ""
    numbers: tuple[float, float] = (0.0, 0.0)
    tones: tuple[tuple[float, float], ...] = TONES
    cell: float = 300.0  # [Hz]
    duration: float = 4.0
    slip: float = 0.0  # relative rate of a clock of the force that runs late


def model(rig: Rig) -> it.Network:
    """The layout of the device without its law."""
    shaft = it.Spring(it.free(1e4, 1e8, name="ks")) | it.Damper(it.free(10.0, 2e5, name="cs"))
    turning = it.Inerter(it.free(0.5, 5e3, name="b")) | it.Friction(it.free(0.0, 500.0, name="f"))
    return shaft - it.Gap(it.free(0.0, 2e-3, name="gap")) - turning if rig.gap else shaft - turning


@numba.njit(cache=True)
def _stepped(z, v, dt, ks, cs, gap, b, f, law, p, q):  # type: ignore[no-untyped-def]
    force = np.empty(z.size)
    y, w, shaft, side, bristle = 0.0, 0.0, 0.0, 0, 0.0
    for n in range(z.size):
        across = z[n] - y - shaft
        if gap == 0.0:
            side, shaft = 1, z[n] - y
        elif side == 0 and abs(across) >= gap:
            side = 1 if across > 0.0 else -1
        pull = 0.0
        if side != 0:
            if gap > 0.0:
                shaft = z[n] - y - side * gap
            pull = ks * shaft + cs * (v[n] - w)
            if law == 4:
                pull += p * shaft**3
            if law == 3 and abs(shaft) > p:
                pull += q * (abs(shaft) - p) * np.sign(shaft)
            if gap > 0.0 and side * pull < 0.0:
                side, pull = 0, 0.0
        if side == 0:
            shaft *= math.exp(-ks / cs * dt)
        force[n] = pull
        if law == 1:
            bristle += dt * w * (1.0 - p * bristle / f * np.sign(w))
            w += dt * (pull - p * bristle) / b
        else:
            w += dt * (pull - (p * w * abs(w) if law == 2 else 0.0)) / b
            level = f * (1.0 + p * math.cos(2.0 * math.pi * y / q)) if law == 5 else f
            w = max(w - dt * level / b, 0.0) if w > 0.0 else min(w + dt * level / b, 0.0)
        y += dt * w
    return force


def motion(rig: Rig, seed: int, shift: float = 0.0) -> tuple[Matrix, Matrix, Matrix]:
    """Displacement, velocity and acceleration on the fine steps, beginning from rest within 0.4 s."""
    time = STEP * np.arange(round(rig.duration / STEP) + 1)
    random = np.random.default_rng([seed, 1])
    x, v, a = np.zeros(time.size), np.zeros(time.size), np.zeros(time.size)
    for size, frequency in rig.tones:
        w, phase = 2.0 * math.pi * frequency, random.uniform(0.0, 6.28)
        x += size * (np.sin(w * (time + shift) + phase) - math.sin(phase))
        v += size * w * np.cos(w * (time + shift) + phase)
        a -= size * w**2 * np.sin(w * (time + shift) + phase)
    s = np.minimum(time / 0.4, 1.0)
    r, r1 = s**3 * (10.0 - 15.0 * s + 6.0 * s**2), 30.0 * s**2 * (1.0 - s) ** 2 / 0.4
    r2 = np.where(s < 1.0, 60.0 * s * (1.0 - 3.0 * s + 2.0 * s**2) / 0.16, 0.0)
    return r * x, r1 * x + r * v, r2 * x + 2.0 * r1 * v + r * a


def force_of(rig: Rig, z: Matrix, v: Matrix) -> Matrix:
    """The force of the device on the fine steps [N]."""
    return np.asarray(_stepped(z, v, STEP, rig.ks, rig.cs, rig.gap, rig.b, rig.f, LAWS[rig.law], *rig.numbers))


def _through(values: Matrix, corner: float) -> Matrix:
    b, a = bilinear(*butter(2, 2.0 * math.pi * corner, analog=True), 1.0 / STEP)
    return np.asarray(lfilter(b, a, values))


def sampled(rig: Rig, z: Matrix, force: Matrix, seed: int) -> tuple[Matrix, Matrix, Matrix]:
    """Times and both channels at `RATE`, through the load cell, with noise and rounding."""
    random, every = np.random.default_rng([seed, 2]), round(1.0 / RATE / STEP)
    time = np.arange(z.size)[::every] * STEP
    fine = np.arange(z.size) * STEP
    read = _through(force, rig.cell)
    force = np.interp(time * (1.0 - rig.slip), fine, read) if rig.slip else read[::every]
    z = np.rint((z[::every] + 3e-7 * random.standard_normal(time.size)) * 1e6) * 1e-6
    force = np.rint((force + 0.15 * random.standard_normal(time.size)) / 0.05) * 0.05
    return time, z, force


def record_of(rig: Rig, fault: str = "", seed: int = 0) -> it.Record:
    """A record of a rig, with a fault of the recorder or the sensors by its name."""
    random = np.random.default_rng([seed, 3])
    z, v, _ = motion(rig, seed)
    force = force_of(rig, z, v)
    time, fine = np.arange(z.size) * STEP, STEP
    top = float(np.abs(force).max())
    if fault == "cross-talk":
        force = force + 0.3 * top / float(np.abs(z).max()) * z
    elif fault == "frame":
        force = _resonant(force, 45.0, 0.03, fine)
    elif fault == "hum":
        force = force + 0.1 * top * np.sin(2.0 * math.pi * 862.7 * time)
    elif fault == "saturation":
        force = np.clip(force, -0.55 * top, 0.6 * top)
    elif fault == "swapped":
        other = force_of(replace(rig, b=0.8 * rig.b, f=1.5 * rig.f), z, v)
        force = np.where(time < 0.45 * rig.duration, force, other)
    if fault == "jitter":
        late = np.clip(time[::100] + 3e-4 * random.standard_normal(time[::100].size), 0.0, time[-1])
        read = _through(force, rig.cell)
        z, force = np.interp(late, time, z), np.interp(late, time, read)
        z = np.rint((z + 3e-7 * random.standard_normal(z.size)) * 1e6) * 1e-6
        return _record(rig, time[::100], z, np.rint((force + 0.15 * random.standard_normal(z.size)) / 0.05) * 0.05)
    if fault == "clock":
        rig = replace(rig, slip=6e-4)
    t, z, force = (values.copy() for values in sampled(rig, z, force, seed))
    if fault == "spikes":
        at = random.choice(t.size - 100, 40, replace=False) + 50
        force[at] += 150.0 * random.choice([-1.0, 1.0], 40)
    elif fault == "held":
        for at in random.choice(t.size - 200, 12, replace=False) + 100:
            length = int(random.integers(4, 14))
            force[at : at + length], z[at : at + length] = force[at], z[at]
    elif fault == "glued":
        cut, gap = t.size // 2, 230
        z, force = np.delete(z, slice(cut, cut + gap)), np.delete(force, slice(cut, cut + gap))
        t = t[: z.size]
    return _record(rig, t, z, force)


def _record(rig: Rig, time: Matrix, z: Matrix, force: Matrix) -> it.Record:
    return it.Record(time, z, force, force_bandwidth=rig.cell)


def _resonant(values: Matrix, frequency: float, ratio: float, step: float) -> Matrix:
    w = 2.0 * math.pi * frequency
    b, a = bilinear([w**2], [1.0, 2.0 * ratio * w, w**2], 1.0 / step)
    return np.asarray(lfilter(b, a, values))


def laws() -> dict[str, dict[str, Any]]:
    """Numbers of a rig under each law that the model lacks."""
    return {
        "presliding": {"law": "presliding", "numbers": (4e4, 0.0)},
        "quadratic": {"law": "quadratic", "numbers": (2e4, 0.0)},
        "second gap": {"law": "second gap", "numbers": (6e-5, 8e5), "ks": 4e5},
        "stiffening": {"law": "stiffening", "numbers": (1e13, 0.0), "ks": 4e5},
        "ripple": {"law": "ripple", "numbers": (0.5, 2.2e-3)},
    }


def random_rig(law: str, seed: int) -> Rig:
    """A rig with a law that is felt: a random device, and a number of the law over a range of about four."""
    random = np.random.default_rng([seed, sorted(LAWS).index(law), 4])
    b, f = math.exp(random.uniform(math.log(40.0), math.log(160.0))), random.uniform(8.0, 25.0)
    ks = math.exp(random.uniform(math.log(3e5), math.log(1.2e6)))
    tones = tuple((size * random.uniform(0.7, 1.3), frequency * random.uniform(0.8, 1.2)) for size, frequency in TONES)
    rig = Rig(b, f, ks, 2.5e-3 * ks, law=law, tones=tones, duration=4.0)
    z, v, _ = motion(replace(rig, law=""), seed)
    fastest, peak = float(np.abs(v).max()), float(np.abs(force_of(replace(rig, law=""), z, v)).max())
    share = random.uniform(0.25, 1.0)
    numbers = {
        "presliding": (f / (share * 0.1 * float(np.ptp(z))), 0.0),
        "quadratic": (0.4 * share * peak / fastest**2, 0.0),
        "second gap": (random.uniform(0.1, 0.4) * peak / ks, 2.0 * share * ks),
        "stiffening": (2.0 * share * ks**3 / peak**2, 0.0),
        "ripple": (0.7 * share, random.uniform(0.3, 0.6) * float(np.ptp(z))),
    }
    return replace(rig, numbers=numbers[law])


FAULTS = (
    "cross-talk", "frame", "hum", "saturation", "swapped", "jitter", "clock", "spikes", "held", "glued",
)  # fmt: skip
