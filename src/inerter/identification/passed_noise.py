"""Noise of the displacement that passes through a linear device: values of a fit that it decides.

The smoothed displacement still has noise, and the device passes it into the force of the model. With weights that do
not depend on the values, those that let less of it pass fit better, even if they fit the motion worse: where the motion
determines a value badly, the noise decides it. With weights by the noise that passes at each value, noise alone has the
same mean square at all values, and only the motion counts (errors in variables, as in Pintelon and Schoukens 2012,
chapter 9). Such a fit scatters more and takes longer, so it does not replace the first one; but an interval that does
not contain its value is one of the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment
from inerter.identification.intervals import BestFit, CostProfile, best_fit_of, constrained_optimum, steps_of
from inerter.identification.noise import lines_of, steady_whitening, whitening_of
from inerter.identification.problem import FitProblem
from inerter.identification.sensors import encoder_noise, noise_residuals
from inerter.networks.elements import Network
from inerter.records.filtering import gain

Matrix = NDArray[np.float64]
_ROUNDS = 2
_FACTORS = np.exp([-3.6, -2.4, -1.2, 1.2, 2.4, 3.6])  # of a value, at which other best fits are looked for
_SLIGHT = 1.1  # noise density over that of the load cell, up to which the displacement's decides nothing


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
    """Mask of the values whose intervals do not contain those of the best fit with weights by the passed noise.

    None for a device with friction or gaps, which passes more at some instants than at others.
    """
    point = optimum.point
    none = np.zeros(point.size, dtype=bool)
    if not all(element.plain and element.switch is None for element in problem.rig.device.elements()):
        return none
    by_noise = replace(problem, spectra=tuple(passed_noise(e) for e in problem.experiments))
    if max(float(lines.max()) for lines in by_noise.spectra_at(point)) < _SLIGHT:
        return none
    for _ in range(_ROUNDS):
        forces, left = problem.forces(point), noise_residuals(problem, point, (seed, 1))
        if left is None or any(force is None for force in forces):
            return none
        by_noise.whitenings = [
            whitening_of(e.record.force - force, steady_whitening(draws, e.noise, e.kept, lines))
            for e, force, draws, lines in zip(
                problem.experiments, forces, left, by_noise.spectra_at(point), strict=True
            )
            if force is not None
        ]
        point = _best_of_valleys(by_noise, best_fit_of(by_noise, point, steps_of(optimum)))
    return np.array([not p.lower.end <= value <= p.upper.end for p, value in zip(profiles, point, strict=True)])


def _best_of_valleys(problem: FitProblem, optimum: BestFit) -> Matrix:
    """The best fit, also from where one value is a few times as large or small and all others are fitted to that."""
    space = problem.space
    values = space.to_values(optimum.point)
    cost, start = optimum.cost, optimum.point
    for i in np.flatnonzero(space.logarithmic):
        for factor in _FACTORS:
            found = constrained_optimum(problem, optimum, int(i), space.coordinate_of(int(i), values[i] * factor))
            cost, start = min((cost, start), found, key=lambda pair: pair[0])
    return start if cost == optimum.cost else best_fit_of(problem, start, steps_of(optimum)).point
