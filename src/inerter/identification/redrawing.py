"""What the errors of the sensors do to the estimates, by a parametric bootstrap (Efron and Tibshirani 1993).

Records are drawn anew from the best fit: the device as it was found is moved as the motion was measured, and the
errors of the encoder and of the load cell are added. Each of them is fitted anew. How far these fits scatter, and how
far they lie from the device that made them, is what intervals have to know beyond residuals:

- An encoder reads in steps. Near the turning points of a motion that repeats, its rounding is the same each time and
  does not average out.
- The noise that the smoothed displacement still has passes through the model into its force, so values that let less
  of it through seem to fit better (errors in variables).
- Where a device strikes and sticks the residuals have corners, and the best fit lies in one of many small valleys.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from inerter.identification.experiment import Experiment, disturbed
from inerter.identification.intervals import ROBUST, Optimum, steps_of
from inerter.identification.problem import Problem
from inerter.identification.search import improve
from inerter.records.periods import period_of
from inerter.records.smoothing import resolution

Matrix = NDArray[np.float64]
DRAWS = 12
_EVALUATIONS = 5
_HARMONICS = 60  # of a motion that repeats, at most
_ALIKE = 5.0  # r.m.s. errors of the smoothed displacement within which a motion repeats


@dataclass(frozen=True, eq=False)
class Redrawn:
    """What fits to records drawn anew tell of a fit."""

    optimum: Optimum  # the same, with intervals at least as wide as they scatter
    lean: Matrix  # how far they lie from the device that made them, in coordinates; at most two standard errors
    predicted: float  # part of the variance of the force that the errors of the encoder leave as it is


def redrawn(problem: Problem, optimum: Optimum, seed: int, draws: int = DRAWS) -> Redrawn:
    """Draw records anew from the best fit, and fit them.

    Their scatter comes in place of what the curvature tells of independent errors; what residuals hang together counts
    on top. Where residuals are larger than the sensors explain, the scatter is taken to be larger by as much.
    """
    random = np.random.default_rng([seed, 2])
    lower, upper = problem.space.bounds
    steps = steps_of(optimum)
    motions = [repeated(e) for e in problem.experiments]
    calm = [disturbed(e, m - e.record.displacement) for e, m in zip(problem.experiments, motions, strict=True)]
    forces = replace(problem, experiments=calm).forces(optimum.point)
    if any(force is None for force in forces):
        return Redrawn(optimum, np.zeros(optimum.point.size), 0.0)
    points, costs, shares = [], [], []
    for _ in range(draws):
        pairs = zip(problem.experiments, motions, forces, strict=True)
        experiments = [_shaken(e, m, f, random) for e, m, f in pairs if f is not None]
        anew = replace(problem, experiments=experiments, simulations=0)
        start = optimum.point + optimum.errors * random.standard_normal(optimum.point.size)
        point, cost, _, _ = improve(anew, np.clip(start, lower, upper), _EVALUATIONS, steps, ROBUST)
        points.append(point)
        costs.append(cost)
        shares.append(_shared(forces, anew.forces(optimum.point), problem.experiments))
        problem.simulations += anew.simulations
    moved = np.array(points) - optimum.point
    unexplained = max(optimum.cost / max(float(np.median(costs)), 1e-300), 1.0)
    few = student.ppf(0.975, draws - 1) / norm.ppf(0.975)
    square = np.var(moved, axis=0, ddof=1) * (1.0 + 1.0 / draws) * unexplained * few**2
    ratio = np.clip(square / np.maximum(np.diag(optimum.covariance), 1e-300), 1.0, 1e4)
    wider = replace(optimum, widening=optimum.widening + ratio - 1.0)
    lean = np.clip(np.mean(moved, axis=0), -2.0 * wider.errors, 2.0 * wider.errors)
    return Redrawn(wider, np.asarray(lean), float(np.median(shares)))


def _shared(
    forces: Sequence[Matrix | None], others: Sequence[Matrix | None], experiments: Sequence[Experiment]
) -> float:
    """Part of the variance of some forces that others share."""
    change, total = 0.0, 0.0
    for force, other, e in zip(forces, others, experiments, strict=True):
        if force is None or other is None:
            return 0.0
        change += float(np.sum((other - force)[e.kept] ** 2))
        total += float(np.var(force[e.kept]) * e.kept.sum())
    return 1.0 - change / max(total, 1e-300)


def unavoidable(problem: Problem, point: Matrix, seed: int) -> float:
    """The whitened residual (its last tenth) that the errors of the sensors leave even at the right values."""
    random = np.random.default_rng([seed, 4])
    experiments = [_shaken(e, repeated(e), e.record.force, random) for e in problem.experiments]
    shaken = replace(problem, experiments=experiments)
    kept = np.concatenate([e.kept for e in problem.experiments])
    return float(np.quantile(np.abs((shaken.residual(point) - problem.residual(point))[kept]), 0.9))


def _shaken(experiment: Experiment, moved: Matrix, force: Matrix, random: np.random.Generator) -> Experiment:
    """The experiment of sensors with errors, had the table `moved` so and this been the force."""
    measured = force + experiment.noise * random.standard_normal(force.size)
    record = replace(experiment.record, displacement=moved, force=measured)
    return disturbed(replace(experiment, record=record), _errors(experiment, moved, random))


def _errors(experiment: Experiment, moved: Matrix, random: np.random.Generator) -> Matrix:
    """Errors of the encoder [m] like those of the record: noise, then rounding to a step."""
    motion, record = experiment.motion, experiment.record
    step = resolution(record.displacement)
    taken = float(np.std((record.displacement - motion.displacement)[experiment.kept]))
    noise = taken / math.sqrt(1.0 - min(2.0 * motion.bandwidth * record.interval, 0.8))
    read = moved + math.sqrt(max(noise**2 - step**2 / 12.0, 0.0)) * random.standard_normal(moved.size)
    rounded = step * np.rint(read / step) if step > 0.0 else read
    return np.asarray(rounded - moved)


def repeated(experiment: Experiment) -> Matrix:
    """The displacement, the same in every period if it repeats: its noise would hide how rounding repeats too.

    Where it does not repeat, as while the table starts, it is as it was measured.
    """
    motion, record = experiment.motion, experiment.record
    period = record.period or period_of(record.displacement)
    if period is None:
        return motion.displacement
    if record.period is None:
        period *= record.interval
    harmonics = math.floor(min(motion.highest * 1.5, motion.bandwidth) * period)
    if not 1 <= harmonics <= _HARMONICS or record.duration < 2.0 * period:
        return motion.displacement
    phase = 2.0 * np.pi / period * np.outer(record.time - record.time[0], np.arange(1, harmonics + 1))
    columns = np.hstack([np.ones((phase.shape[0], 1)), np.cos(phase), np.sin(phase)])
    use = experiment.kept & (record.time - record.time[0] > period)
    fitted = columns @ np.linalg.lstsq(columns[use], motion.displacement[use])[0]
    noise = motion.noise * math.sqrt(min(2.0 * motion.bandwidth * record.interval, 1.0))
    apart = np.flatnonzero(np.abs(motion.displacement - fitted)[: int(np.flatnonzero(use)[-1])] > _ALIKE * noise)
    begun = int(apart[-1]) + 1 if apart.size else 0
    if begun > record.time.size // 2:
        return motion.displacement
    return np.concatenate([motion.displacement[:begun], fitted[begun:]])
