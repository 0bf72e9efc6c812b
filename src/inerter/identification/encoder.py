"""What the errors of the encoder do to the estimates: how far they scatter them, and how far they move them.

**Scatter.** An encoder reads in steps. Near the turning points of a motion that repeats, its rounding is the same
each time and does not average out, so the residuals do not tell what it did to the estimates. Its errors are
therefore drawn anew along the motion as it was measured and followed to the estimates,
linearised: their mean is taken away, and their variance added to that which the residuals tell. What is random in
them is then counted twice, so intervals are rather too wide than too narrow.

**Lean.** The noise that the smoothed displacement still has passes through the model into its force, so values that
let less of it through seem to fit better. How far this leads is found by adding as much noise again and seeing how
far the best fit leans further (simulation and extrapolation, Cook and Stefanski 1994, in its linear form). Each noise
is also added with the opposite sign, which cancels all that is not of second order.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment, disturbed
from inerter.identification.intervals import ROBUST, Optimum, steps_of
from inerter.identification.problem import Problem
from inerter.records.periods import period_of
from inerter.records.smoothing import resolution

Matrix = NDArray[np.float64]
DRAWS, PAIRS = 40, 4
_HARMONICS = 60  # of a motion that repeats, at most


def scattered(problem: Problem, optimum: Optimum, seed: int, draws: int = DRAWS) -> tuple[Optimum, Matrix]:
    """The same optimum with intervals that know of the errors of the encoders, and what those do on the average.

    That is how far, in coordinates, the rounding of the encoder moves the best fit each time, at most two standard
    errors. Half of it counts as scatter, because it is known no better.
    """
    random = np.random.default_rng([seed, 2])
    gain = optimum.covariance / optimum.variance @ optimum.jacobian.T
    before = problem.residual(optimum.point)

    def moved(errors: list[Matrix]) -> Matrix:
        disturbances = [disturbed(e, z) for e, z in zip(problem.experiments, errors, strict=True)]
        residual = replace(problem, experiments=disturbances).residual(optimum.point)
        return np.asarray(-gain @ np.clip(residual - before, -ROBUST, ROBUST))

    errors = [[_errors(e, random) for e in problem.experiments] for _ in range(draws)]
    steps = np.array(list(problem.pool.map(moved, errors)))
    problem.simulations += draws * len(problem.experiments)
    mean = np.mean(steps, axis=0)
    square = np.var(steps, axis=0, ddof=1) + (0.5 * mean) ** 2
    ratio = square / np.maximum(np.diag(optimum.covariance), 1e-300)
    wider = replace(optimum, widening=optimum.widening + np.clip(ratio, 0.0, 1e4))
    return wider, np.asarray(np.clip(mean, -2.0 * wider.errors, 2.0 * wider.errors))


def lean(problem: Problem, optimum: Optimum, seed: int, pairs: int = PAIRS) -> Matrix:
    """How far the noise of the encoders has moved the best fit, in coordinates; at most two standard errors."""
    random = np.random.default_rng([seed, 1])
    steps = steps_of(optimum)

    def gradient(there: Problem) -> Matrix:
        residual, jacobian = there.residual(optimum.point), there.jacobian(optimum.point, steps)
        problem.simulations += 1 + 2 * steps.size
        return np.asarray(jacobian.T @ ((1.0 + (residual / ROBUST) ** 2) ** -0.5 * residual))

    disturbances = []
    for _ in range(pairs):
        noises = [_errors(e, random) for e in problem.experiments]
        for sign in (-1.0, 1.0):
            disturbances.append([disturbed(e, sign * n) for e, n in zip(problem.experiments, noises, strict=True)])
    gradients = [gradient(replace(problem, experiments=moved)) for moved in disturbances]
    extra = np.mean(gradients, axis=0) - gradient(problem)
    moved_by = -(optimum.covariance / optimum.variance) @ extra
    limit = 2.0 * optimum.errors
    return np.asarray(np.clip(moved_by, -limit, limit))


def _errors(experiment: Experiment, random: np.random.Generator) -> Matrix:
    """Errors of the encoder [m] like those of the record: noise, then rounding to a step."""
    motion, record = experiment.motion, experiment.record
    step = resolution(record.displacement)
    taken = float(np.std((record.displacement - motion.displacement)[experiment.kept]))
    noise = taken / math.sqrt(1.0 - min(2.0 * motion.bandwidth * record.interval, 0.8))
    moved = _repeated(experiment)
    read = moved + math.sqrt(max(noise**2 - step**2 / 12.0, 0.0)) * random.standard_normal(moved.size)
    rounded = step * np.rint(read / step) if step > 0.0 else read
    return np.asarray(rounded - moved)


def _repeated(experiment: Experiment) -> Matrix:
    """The displacement, the same in every period if it repeats: its noise would hide how rounding repeats too."""
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
    use = experiment.kept
    return np.asarray(columns @ np.linalg.lstsq(columns[use], motion.displacement[use])[0])
