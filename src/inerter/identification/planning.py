"""Recommended experiment to halve an interval: a larger, faster or longer motion, with the expected width.

Intervals follow from the information on each parameter in the force (Fisher's information), which can be computed for
any motion: the identified device is simulated, and its force is differentiated by every unknown and weighted by
simulated sensor noise. The expected width is the present one times the ratio of the standard errors for the other
motion and for the present one; twice the length counts as twice the information.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError
from inerter.identification.experiment import MOST_SAMPLES, Experiment, experiment_of
from inerter.identification.fit import Parameter
from inerter.identification.intervals import steps_of
from inerter.identification.noise import noise_whitening
from inerter.identification.sensors import encoder_noise, noise_residuals
from inerter.identification.solving import SolvedFit
from inerter.identification.statements.findings import FitFinding
from inerter.records.finding import Finding
from inerter.records.smoothing import resolution
from inerter.signals.signal import Signal
from inerter.statements import Severity
from inerter.work.progress import report

Matrix = NDArray[np.float64]
_TARGET = 0.4  # of the present width, so that nearly all records reach half of it
_AMPLITUDES, _SPEEDS = (1.0, 2.0, 4.0), (1.0, 2.0, 4.0, 0.5)
_LONGEST = 16  # times as long
_ROOM, _WITHOUT = 0.8, 4.0  # of the load cell's range; times the present force where no range is known
_SAMPLES = 10.0  # in a period of the fastest part of a motion
_BELOW_CELL = 0.5  # of the bandwidth of the load cell, up to which it is moved
_UNPREDICTABLE = 0.015  # of the force's variance: more, and errors of the encoder decide how the device moves
_DRAWS = 6


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """The present motions, scaled by `larger` and `faster`, and the standard errors [coordinates] to expect."""

    larger: float
    faster: float
    errors: Matrix


def recommended_experiments(solution: SolvedFit, parameters: Mapping[str, Parameter]) -> Iterator[Finding]:
    """For each identified parameter, the mildest change of the motion that halves its interval."""
    motions = list(_possible_motions(solution))
    present = next((m for m in motions if m.larger == m.faster == 1.0), None)
    if present is None:
        return
    for i, (name, kind) in enumerate(zip(solution.problem.space.names, solution.problem.space.kinds, strict=True)):
        p = parameters[name]
        if kind is None or math.isnan(p.value) or not present.errors[i] > 0.0:
            continue
        width = p.interval[1] - p.interval[0]
        fixed = 0.0 if solution.scales is None else solution.scales.width(i)
        if fixed > _TARGET * width:
            yield Finding(FitFinding.CALIBRATE, Severity.INFO, name, {"width": width, "fixed": fixed, "unit": p.unit})
            continue
        moving = math.sqrt(width**2 - fixed**2)
        wanted = math.sqrt((_TARGET * width) ** 2 - fixed**2) / moving
        ratios = [(m, float(m.errors[i] / present.errors[i])) for m in motions]
        found = [(m, r, n) for m, r in ratios if (n := math.ceil((r / wanted) ** 2 * (1.0 - 1e-9))) <= _LONGEST]
        if found:
            best, ratio, times = min(found, key=lambda f: (_motion_effort(f[0], f[2]), f[1]))
            expected = math.hypot(moving * ratio / math.sqrt(max(times, 1)), fixed)
            yield Finding(
                FitFinding.NARROWER, Severity.INFO, name, _motion_numbers(solution, best, max(times, 1), p, expected)
            )


def _motion_effort(motion: PlannedMotion, times: int) -> float:
    """Effort of a motion: doublings of the amplitude, the speed and the length."""
    return abs(math.log2(motion.larger)) + abs(math.log2(motion.faster)) + math.log2(max(times, 1))


def _motion_numbers(
    solution: SolvedFit, motion: PlannedMotion, times: int, p: Parameter, expected: float
) -> dict[str, object]:
    experiments = solution.problem.experiments
    return {
        "larger": motion.larger,
        "faster": motion.faster,
        "longer": times,
        "amplitude": motion.larger * max(0.5 * float(np.ptp(e.motion.displacement)) for e in experiments),  # [m]
        "highest": motion.faster * max(e.motion.highest for e in experiments),  # [Hz]
        "duration": times * max(e.record.duration for e in experiments),  # [s]
        "width": p.interval[1] - p.interval[0],
        "expected": expected,
        "value": p.value,
        "unit": p.unit,
    }


def _possible_motions(solution: SolvedFit) -> Iterator[PlannedMotion]:
    """The motions within the range of rig and sensors for which the response of the device is predictable."""
    problem, optimum = solution.problem, solution.optimum
    steps = steps_of(optimum)
    largest = max(float(np.abs(e.record.force).max()) for e in problem.experiments)
    for row, faster in enumerate(_SPEEDS):
        for column, larger in enumerate(_AMPLITUDES):
            report("next experiment", row * len(_AMPLITUDES) + column, len(_SPEEDS) * len(_AMPLITUDES))
            experiments = [_planned_experiment(e, larger, faster) for e in problem.experiments]
            present = larger == faster == 1.0
            if any(e is None for e in experiments):
                continue
            other = replace(problem, experiments=[e for e in experiments if e is not None])
            simulated = [other.simulate(e, optimum.point) for e in other.experiments]
            known = [s.force for s in simulated if s is not None]
            if len(known) < len(simulated) or not (present or _within_force_range(solution, known, largest)):
                break  # a larger amplitude is no easier
            other.experiments = [
                replace(e, record=replace(e.record, force=f)) for e, f in zip(other.experiments, known, strict=True)
            ]
            left = noise_residuals(other, optimum.point, (solution.options.seed, 7), _DRAWS)
            if left is None or not (present or _is_predictable(left, other.experiments)):
                continue
            other.whitenings = [
                noise_whitening(draws, e.noise, e.kept) for draws, e in zip(left, other.experiments, strict=True)
            ]
            jacobian = other.jacobian(optimum.point, steps)
            covariance = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True)
            share = sum(e.record.duration for e in other.experiments) / sum(
                e.record.duration for e in problem.experiments
            )
            yield PlannedMotion(larger, faster, np.sqrt(np.maximum(np.diag(covariance), 0.0) * share))


def _within_force_range(solution: SolvedFit, forces: Sequence[Matrix], largest: float) -> bool:
    """Whether each force is within the range of its load cell."""
    return all(
        float(np.abs(f).max()) <= (_WITHOUT * largest if e.record.force_range is None else _ROOM * e.record.force_range)
        for f, e in zip(forces, solution.problem.experiments, strict=True)
    )


def _is_predictable(left: list[Matrix], experiments: Sequence[Experiment]) -> bool:
    """Whether encoder noise hardly changes the forces."""
    return all(
        float(np.mean(draws**2)) - e.noise**2 <= _UNPREDICTABLE * float(np.var(e.record.force))
        for draws, e in zip(left, experiments, strict=True)
    )


def _planned_experiment(e: Experiment, larger: float, faster: float) -> Experiment | None:
    """An experiment with the same sensors on a larger and faster motion; None where they cannot follow.

    A faster motion is shorter.
    """
    record, motion = e.record, e.motion
    interval, highest = record.interval, faster * motion.highest
    if faster > 1.0 and highest > 1.0 / (_SAMPLES * interval):
        return None
    if faster > 1.0 and record.force_bandwidth is not None and highest > _BELOW_CELL * record.force_bandwidth:
        return None
    count = min(e.size, math.floor((e.size - 1) / faster) + 1, MOST_SAMPLES)
    time = np.asarray(interval * np.arange(count, dtype=np.float64))
    heights = Signal.sampled(motion.time - motion.time[0], motion.displacement, derivative=motion.velocity)
    step, noise = resolution(record.displacement), encoder_noise(e)
    errors = np.random.default_rng(0).standard_normal(count) * math.sqrt(max(noise**2 - step**2 / 12.0, 0.0))
    read = larger * heights.sample(np.minimum(faster * time, motion.time[-1] - motion.time[0]))[0] + errors
    made = replace(
        record, time=time, displacement=step * np.rint(read / step) if step > 0.0 else read,
        force=np.where(np.arange(count) % 2, 1.0, -1.0), velocity=None, acceleration=None, force_noise=e.noise,
        force_range=None, displacement_noise=max(noise, 1e-12),
        period=None if record.period is None else record.period / faster,
    )  # fmt: skip
    try:
        return replace(experiment_of(made, min(motion.bandwidth * max(faster, 1.0), 0.4 / interval)), tally=e.tally)
    except InerterError:
        return None
