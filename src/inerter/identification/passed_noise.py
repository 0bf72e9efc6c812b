"""Noise of the displacement that passes through a linear device: values of a fit that it decides.

The smoothed displacement still has noise, and the device passes it into the force of the model. With weights that do
not depend on the values, those that let less of it pass fit better, even if they fit the motion worse: where the motion
determines a value badly, the noise decides it. With weights by the noise that passes at each value, noise alone has the
same mean square at all values, and only the motion counts (errors in variables, as in Pintelon and Schoukens 2012,
chapter 9). Such a fit scatters more and takes longer, so it does not replace the first one. But where the motion does
not determine the values, as one tone cannot determine three of them, fits far from each other are equally good: an
interval that does not contain the values of all of them is one of the noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.optimize import minimize_scalar

from inerter.identification.experiment import Experiment
from inerter.identification.intervals import BestFit, CostProfile, best_fit_of, constrained_optimum, steps_of
from inerter.identification.noise import lines_of, steady_whitening, whitening_of
from inerter.identification.problem import FitProblem
from inerter.identification.search import distinct
from inerter.identification.sensors import encoder_noise, noise_residuals
from inerter.networks.elements import Network
from inerter.records.filtering import gain

Matrix = NDArray[np.float64]
_FACTORS = np.exp([-3.6, -2.4, -1.2, 1.2, 2.4, 3.6])  # of a value, from where other fits are sought
_ELSEWHERE, _EVALUATIONS, _ACCURACY = 3, 12, 1e-5  # other fits: number, evaluations, relative change that ends them
_MOST_TONES, _BESIDE = 2, 0.05  # tones that are counted; share of other motion beside them
_AS_GOOD = 2.0  # rise of the cost up to which another fit is as good, as at the ends of an interval of 95 %


@dataclass(frozen=True, eq=False)
class PassedNoise:
    """Spectrum of the noise in the force of a record, over that of its load cell, by what the device passes."""

    omega: Matrix  # [rad/s] of the `lines_of` the record; the first is not zero
    ratio: Matrix  # [N^2/m^2] spectrum of the smoothed displacement's noise, as the load cell reads it, over its own

    def __call__(self, device: Network) -> Matrix:
        """The spectrum with this linear device."""
        s = 1j * self.omega
        return np.asarray(1.0 + self.ratio * np.abs(s * device.admittance(s)) ** 2)


def passed_noise(e: Experiment) -> PassedNoise:
    """The noise that devices pass in an experiment."""
    interval, lines = e.record.interval, lines_of(e.size)
    frequency = np.clip(lines, 0.5 * lines[1], 0.5 * (1.0 - 1e-9)) / interval
    smoothed = gain(frequency, interval, e.motion.bandwidth)
    cell = 1.0 if e.record.force_bandwidth is None else 1.0 / (1.0 + (frequency / e.record.force_bandwidth) ** 4)
    return PassedNoise(2.0 * np.pi * frequency, cell * (smoothed * encoder_noise(e) / e.noise) ** 2)


def decided_by_noise(
    problem: FitProblem, optimum: BestFit, profiles: Sequence[CostProfile], seed: int
) -> NDArray[np.bool_]:
    """Mask of the values whose intervals do not contain those of every fit with weights by the passed noise.

    A tone is two values, and a start from rest gives hardly more than one: more unknowns than these all depend on
    noise.

    None for a device with friction or gaps, which passes more at some instants than at others.
    """
    point = optimum.point
    none = np.zeros(point.size, dtype=bool)
    if not all(element.plain and element.switch is None for element in problem.rig.device.elements()):
        return none
    if len(problem.experiments) == 1 and point.size > _equations(problem.experiments[0]):
        return ~none
    by_noise = replace(problem, spectra=tuple(passed_noise(e) for e in problem.experiments))
    forces, left = problem.forces(point), noise_residuals(problem, point, (seed, 1))
    if left is None or any(force is None for force in forces):
        return none
    by_noise.whitenings = [
        whitening_of(e.record.force - force, steady_whitening(draws, e.noise, e.kept, lines))
        for e, force, draws, lines in zip(problem.experiments, forces, left, by_noise.spectra_at(point), strict=True)
        if force is not None
    ]
    points = _fits_as_good(by_noise, best_fit_of(by_noise, point, steps_of(optimum)))
    ends = np.array([(p.lower.end, p.upper.end) for p in profiles])
    return np.asarray(np.any((points < ends[:, 0]) | (points > ends[:, 1]), axis=0))


def _equations(e: Experiment) -> float:
    """Number of values that a record gives at most: two of each tone, and hardly more than one of a start from rest."""
    tones = tones_of(e)
    return math.inf if tones is None else 2 * tones + int(e.kept[0])


def tones_of(e: Experiment) -> int | None:
    """Number of sines that the compared motion is, but for a small share of its r.m.s. value; None of more than two."""
    moved, time = e.motion.displacement[e.kept], e.record.time[e.kept]
    padded = next_fast_len(8 * moved.size, real=True)
    line = 1.0 / (padded * e.record.interval)
    columns = np.ones((time.size, 1))
    for number in range(1, _MOST_TONES + 1):
        left = _remainder(moved, columns)
        highest = float(np.argmax(np.abs(np.fft.rfft(left * np.hanning(left.size), padded)))) * line
        ends = max(highest - 8.0 * line, 0.1 * line), highest + 8.0 * line
        least = minimize_scalar(
            lambda frequency, known=columns: float(np.std(_remainder(moved, _with_tone(known, time, frequency)))),
            bounds=ends,
            method="bounded",
            options={"xatol": 1e-3 * line},
        )
        if float(least.fun) < _BESIDE * float(np.std(moved)):
            return number
        columns = _with_tone(columns, time, float(least.x))
    return None


def _with_tone(columns: Matrix, time: Matrix, frequency: float) -> Matrix:
    phase = 2.0 * np.pi * frequency * time
    return np.column_stack([columns, np.cos(phase), np.sin(phase)])


def _remainder(values: Matrix, columns: Matrix) -> Matrix:
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values)[0])


def _fits_as_good(problem: FitProblem, optimum: BestFit) -> Matrix:
    """The best fit, and fits as good from where one value is many times as large or small (fits, coordinates)."""
    space = problem.space
    values = space.to_values(optimum.point)
    found = [
        constrained_optimum(problem, optimum, int(i), space.coordinate_of(int(i), values[i] * factor))
        for i in np.flatnonzero(space.logarithmic)
        for factor in _FACTORS
    ]
    starts = distinct([point for _, point in found], [cost for cost, _ in found])[:_ELSEWHERE]
    fits = [best_fit_of(problem, start, evaluations=_EVALUATIONS, accuracy=_ACCURACY) for start in starts]
    return np.array([optimum.point, *(fit.point for fit in fits if fit.cost < optimum.cost + _AS_GOOD)])
