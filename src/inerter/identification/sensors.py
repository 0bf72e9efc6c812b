"""Simulated sensor noise of a record, and its effect on the force of a device.

Both channels are noisy: the load cell directly, the encoder through the force of the device on the motion as read. That
force is small most of the time, and as large as the friction at reversals. So noise is drawn and the device is moved as
the encoder would have read: the differences are the residuals of a correct model.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment, add_encoder_noise
from inerter.identification.problem import FitProblem
from inerter.records.filtering import gain
from inerter.records.periods import period_of
from inerter.records.smoothing import resolution

Matrix = NDArray[np.float64]
_DRAWS = 12
_BLOCKS, _LONG = 40, 64  # of time, at most; samples of each, at least
_LINES = 1000  # of a spectrum over which a gain is averaged
_HARMONICS = 60  # of a periodic motion, at most
_ALIKE = 5.0  # r.m.s. errors of the smoothed displacement within which a motion is periodic


@dataclass(frozen=True, eq=False)
class Source:
    """Source of drawn records: the motions of the table, and the forces [N] of one device on them."""

    experiments: Sequence[Experiment]
    motions: Sequence[Matrix]
    forces: Sequence[Matrix]

    def draw(self, random: np.random.Generator) -> list[Experiment]:
        """The experiments with newly drawn sensor noise."""
        parts = zip(self.experiments, self.motions, self.forces, strict=True)
        return [simulate_measurement(e, motion, force, random) for e, motion, force in parts]


def source_of(problem: FitProblem, point: Matrix) -> Source | None:
    """The device at `point` on the motions of the records; None if it cannot be simulated."""
    motions = [periodic_displacement(e) for e in problem.experiments]
    calm = [add_encoder_noise(e, m - e.record.displacement) for e, m in zip(problem.experiments, motions, strict=True)]
    forces = [force for force in replace(problem, experiments=calm).forces(point) if force is not None]
    return Source(problem.experiments, motions, forces) if len(forces) == len(calm) else None


def noise_residuals(
    problem: FitProblem, point: Matrix, seed: Sequence[int], draws: int = _DRAWS
) -> list[Matrix] | None:
    """Residuals of each record by sensor noise alone (draws, samples) [N], for the device at `point`."""
    source = source_of(problem, point)
    if source is None:
        return None
    random = np.random.default_rng(seed)
    found: list[list[Matrix]] = [[] for _ in problem.experiments]
    for _ in range(draws):
        drawn = source.draw(random)
        for residuals, e, force in zip(found, drawn, replace(problem, experiments=drawn).forces(point), strict=True):
            residuals.append(np.zeros(e.size) if force is None else e.record.force - force)
    return [np.array(residuals) for residuals in found]


def unavoidable_residual(problem: FitProblem, point: Matrix, seed: int) -> float:
    """90th percentile of the whitened residual that sensor noise causes even at the right values."""
    random = np.random.default_rng([seed, 4])
    experiments = [
        simulate_measurement(e, periodic_displacement(e), e.record.force, random) for e in problem.experiments
    ]
    drawn = replace(problem, experiments=experiments)
    kept = np.concatenate([e.kept for e in problem.experiments])
    return float(np.quantile(np.abs((drawn.residual(point) - problem.residual(point))[kept]), 0.9))


def simulate_measurement(
    experiment: Experiment, moved: Matrix, force: Matrix, random: np.random.Generator
) -> Experiment:
    """The experiment with drawn sensor noise, for this motion `moved` [m] of the table and this force [N]."""
    measured = force + experiment.noise * random.standard_normal(force.size)
    record = replace(experiment.record, displacement=moved, force=measured)
    return add_encoder_noise(replace(experiment, record=record), _errors(experiment, moved, random))


def _errors(experiment: Experiment, moved: Matrix, random: np.random.Generator) -> Matrix:
    """Simulated errors of the encoder [m]: noise, then rounding to its resolution."""
    step, noise = resolution(experiment.record.displacement), encoder_noise(experiment)
    read = moved + math.sqrt(max(noise**2 - step**2 / 12.0, 0.0)) * random.standard_normal(moved.size)
    if step > 0.0:
        between = _between_steps(experiment, moved, step, random)
        read = step * np.rint((read + between) / step) - between
    return np.asarray(read - moved)


def encoder_noise(experiment: Experiment) -> float:
    """R.m.s. error of a displacement sample [m], with quantisation: as stated, or as estimated."""
    motion, record = experiment.motion, experiment.record
    if record.displacement_noise is not None:
        return record.displacement_noise
    removed = (1.0 - _gains_of(experiment)) ** 2
    independent = float(np.mean(removed) ** 2 / np.mean(removed**2))
    taken = _usual_rms((record.displacement - motion.displacement)[experiment.kept], independent)
    return taken / math.sqrt(float(np.mean(removed)))


def passed_share(experiment: Experiment) -> float:
    """Share of the variance of white errors of the displacement that the smoothed motion has."""
    return float(np.mean(_gains_of(experiment) ** 2))


def _gains_of(experiment: Experiment) -> Matrix:
    """The gain of the filter of the displacement over the frequencies of white errors."""
    return _gains(experiment.record.interval, experiment.motion.bandwidth)


@lru_cache(16)  # each draw of noise needs it twice
def _gains(interval: float, bandwidth: float) -> Matrix:
    frequency = np.linspace(0.0, 0.5 / interval, _LINES, endpoint=False, dtype=np.float64)
    return gain(frequency, interval, bandwidth)


def _between_steps(experiment: Experiment, moved: Matrix, step: float, random: np.random.Generator) -> Matrix:
    """Possible distance [m] of the table from each sample when it was read.

    At the start, a smoothed motion equals the sample: it lies on a step of the encoder, and would be read again without
    an error. Later it crosses many steps, and the filter resolves the position between them, but for the share of their
    errors that it passes: with few samples in a period it lies near the steps again.
    """
    gone = np.abs(moved - moved[0]) > step
    left = int(np.argmax(gone)) if gone.any() else moved.size
    memory = math.ceil(1.0 / (experiment.motion.bandwidth * experiment.record.interval))
    start = np.arange(moved.size) < max(left, memory)
    smoothed = moved == experiment.motion.displacement  # a periodic motion has no such errors
    common, own = random.spawn(2)
    passed = step * math.sqrt(passed_share(experiment)) * own.uniform(-0.5, 0.5, moved.size)
    return np.where(start, step * common.uniform(-0.5, 0.5), np.where(smoothed, passed, 0.0))


def _usual_rms(values: Matrix, independent: float) -> float:
    """R.m.s. of most blocks of time, without a few exceptional ones; a share `independent` of the values counts.

    The median of few samples' variances is below their mean, by that of the distribution of chi square.
    """
    blocks = np.array_split(values, max(min(_BLOCKS, values.size // _LONG), 1))
    below = (1.0 - 2.0 / (9.0 * max(independent * blocks[0].size, 1.0))) ** 3 if len(blocks) > 2 else 1.0
    return float(np.sqrt(np.median([np.var(block) for block in blocks]) / below))


def periodic_displacement(experiment: Experiment) -> Matrix:
    """The displacement, made exactly periodic if it is periodic: its noise would hide the periodicity of rounding.

    Where it is not periodic, as while the table starts, it is unchanged.
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
    deviating = np.flatnonzero(np.abs(motion.displacement - fitted)[: int(np.flatnonzero(use)[-1])] > _ALIKE * noise)
    begun = int(deviating[-1]) + 1 if deviating.size else 0
    if begun > record.time.size // 2:
        return motion.displacement
    return np.concatenate([motion.displacement[:begun], fitted[begun:]])
