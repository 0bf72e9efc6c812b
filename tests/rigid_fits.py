"""Fits of a rigid inertance with friction by linear least squares, to look at residuals without a search."""

from __future__ import annotations

import numpy as np

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.fit import RecordFit
from inerter.records.record import Record


def rigid_fit(record: Record, noise: float = 0.15, check: float = 0.2) -> RecordFit:
    """The best fit of b, f and an offset to the first part of a record, as `identify` gives it for one record."""
    e = experiment_of(record)
    motion = e.motion
    columns = np.column_stack([motion.acceleration, np.sign(motion.velocity), np.ones(e.size)])
    fitted, checked = e.kept.copy(), e.kept.copy()
    cut = e.size - round(check * e.size)
    fitted[cut:], checked[:cut] = False, False
    weights = np.ones(e.size)
    for _ in range(8):  # soft l1, as a fit weights
        solution = np.linalg.lstsq(columns[fitted] * weights[fitted, None], (weights * record.force)[fitted])[0]
        left = (record.force - columns @ solution) / (3.0 * noise)
        weights = (1.0 + left**2) ** -0.25
    random = np.random.default_rng(0)
    flip = 2.0 * solution[1] * np.maximum(1.0 - np.abs(motion.velocity) / (3.0 * motion.velocity_noise + 1e-12), 0.0)
    draws = noise * random.standard_normal((12, e.size)) + flip * (random.random((12, e.size)) < 0.5)
    return RecordFit(
        experiment=e, model=columns @ solution, offset=float(solution[2]), fitted=fitted, checked=checked, draws=draws,
        whitened=(record.force - columns @ solution)[fitted], lead=0.0, whiteness=0.5, openings={},
    )  # fmt: skip


def rigid_record(
    seed: int = 0,
    duration: float = 4.0,
    tones: tuple[tuple[float, float], ...] = ((2e-3, 1.3), (8e-4, 3.1), (3e-4, 5.7)),
) -> tuple[Record, dict[str, np.ndarray]]:
    """A sound record of 80 kg with 12 N of friction, and the true motion at its samples."""
    random = np.random.default_rng([seed, 9])
    time = np.arange(round(duration * 1000.0)) * 1e-3
    x, v, a = np.zeros(time.size), np.zeros(time.size), np.zeros(time.size)
    for size, frequency in tones:
        w, phase = 2.0 * np.pi * frequency, random.uniform(0.0, 6.28)
        x += size * np.sin(w * time + phase)
        v += size * w * np.cos(w * time + phase)
        a -= size * w**2 * np.sin(w * time + phase)
    force = 80.0 * a + 12.0 * np.sign(v)
    motion = {"time": time, "x": x, "v": v, "a": a, "force": force}
    return read(motion, force, seed), motion


def read(motion: dict[str, np.ndarray], force: np.ndarray, seed: int = 0, **further: np.ndarray) -> Record:
    """As sensors with noise and steps read it."""
    random = np.random.default_rng([seed, 10])
    size = force.size
    z = np.rint((motion["x"] + 3e-7 * random.standard_normal(size)) * 1e6) * 1e-6
    values = np.rint((force + 0.15 * random.standard_normal(size)) / 0.05) * 0.05
    return it.Record(motion["time"], z, values, further=further)
