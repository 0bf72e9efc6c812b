"""Errors like those of the sensors of a record, and what a device makes of them in the force.

Both channels err: the load cell at once, the encoder through the device, which answers what it reads with a force of
its own. That is small most of the time, and as large as the friction where the table turns. So errors are drawn and
the device is moved as the encoder would have read: what is left are the residuals of a model without any fault.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment, disturbed
from inerter.identification.problem import FitProblem
from inerter.records.periods import period_of
from inerter.records.smoothing import resolution

Matrix = NDArray[np.float64]
_DRAWS = 12
_BLOCKS = 40
_HARMONICS = 60  # of a motion that repeats, at most
_ALIKE = 5.0  # r.m.s. errors of the smoothed displacement within which a motion repeats


@dataclass(frozen=True, eq=False)
class Source:
    """What records are drawn from: the motions of the table, and the forces [N] of one device on them."""

    experiments: Sequence[Experiment]
    motions: Sequence[Matrix]
    forces: Sequence[Matrix]

    def drawn(self, random: np.random.Generator) -> list[Experiment]:
        """The experiments of sensors with other errors of the same kind."""
        parts = zip(self.experiments, self.motions, self.forces, strict=True)
        return [shaken(e, motion, force, random) for e, motion, force in parts]


def source_of(problem: FitProblem, point: Matrix) -> Source | None:
    """The device at `point` on the motions of the records; None if it cannot be moved so."""
    motions = [repeated(e) for e in problem.experiments]
    calm = [disturbed(e, m - e.record.displacement) for e, m in zip(problem.experiments, motions, strict=True)]
    forces = [force for force in replace(problem, experiments=calm).forces(point) if force is not None]
    return Source(problem.experiments, motions, forces) if len(forces) == len(calm) else None


def sound(problem: FitProblem, point: Matrix, seed: Sequence[int], draws: int = _DRAWS) -> list[Matrix] | None:
    """Residuals that sound sensors leave of each record (draws, samples) [N], were the device that at `point`."""
    source = source_of(problem, point)
    if source is None:
        return None
    random = np.random.default_rng(seed)
    found: list[list[Matrix]] = [[] for _ in problem.experiments]
    for _ in range(draws):
        drawn = source.drawn(random)
        for residuals, e, force in zip(found, drawn, replace(problem, experiments=drawn).forces(point), strict=True):
            residuals.append(np.zeros(e.size) if force is None else e.record.force - force)
    return [np.array(residuals) for residuals in found]


def unavoidable(problem: FitProblem, point: Matrix, seed: int) -> float:
    """The whitened residual (its last tenth) that the errors of the sensors leave even at the right values."""
    random = np.random.default_rng([seed, 4])
    experiments = [shaken(e, repeated(e), e.record.force, random) for e in problem.experiments]
    drawn = replace(problem, experiments=experiments)
    kept = np.concatenate([e.kept for e in problem.experiments])
    return float(np.quantile(np.abs((drawn.residual(point) - problem.residual(point))[kept]), 0.9))


def shaken(experiment: Experiment, moved: Matrix, force: Matrix, random: np.random.Generator) -> Experiment:
    """The experiment of sensors with errors, had the table `moved` so and this been the force."""
    measured = force + experiment.noise * random.standard_normal(force.size)
    record = replace(experiment.record, displacement=moved, force=measured)
    return disturbed(replace(experiment, record=record), _errors(experiment, moved, random))


def _errors(experiment: Experiment, moved: Matrix, random: np.random.Generator) -> Matrix:
    """Errors of the encoder [m] like those of the record: noise, then rounding to a step."""
    step, noise = resolution(experiment.record.displacement), encoder_noise(experiment)
    read = moved + math.sqrt(max(noise**2 - step**2 / 12.0, 0.0)) * random.standard_normal(moved.size)
    if step > 0.0:
        between = _between_steps(experiment, moved, step, random)
        read = step * np.rint((read + between) / step) - between
    return np.asarray(read - moved)


def encoder_noise(experiment: Experiment) -> float:
    """R.m.s. error of a reading of the displacement [m], with that of its steps: as it is known, or as it shows."""
    motion, record = experiment.motion, experiment.record
    if record.displacement_noise is not None:
        return record.displacement_noise
    taken = _usual_rms((record.displacement - motion.displacement)[experiment.kept])
    return taken / math.sqrt(1.0 - min(2.0 * motion.bandwidth * record.interval, 0.8))


def _between_steps(experiment: Experiment, moved: Matrix, step: float, random: np.random.Generator) -> Matrix:
    """How far off each sample [m] the table may truly have been when it was read.

    Where it starts, a smoothed motion is what was read: it lies on a step of the encoder, and would be read once more
    without an error. Later it goes through many steps, and the filter has found where between them it is.
    """
    gone = np.abs(moved - moved[0]) > step
    left = int(np.argmax(gone)) if gone.any() else moved.size
    memory = math.ceil(1.0 / (experiment.motion.bandwidth * experiment.record.interval))
    start = np.arange(moved.size) < max(left, memory)
    return np.where(start, step * random.spawn(1)[0].uniform(-0.5, 0.5), 0.0)


def _usual_rms(values: Matrix) -> float:
    """The r.m.s. of most blocks of time: what a few sudden ones do is no noise."""
    return float(np.sqrt(np.median([np.var(block) for block in np.array_split(values, _BLOCKS)])))


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
