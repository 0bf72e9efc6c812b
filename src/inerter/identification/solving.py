"""From records and a model to the best fit: searched, refined, with profiles, and judged."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError
from inerter.identification.bootstrap import bootstrap
from inerter.identification.experiment import Experiment, experiment_of, forgotten
from inerter.identification.fit import Misfit
from inerter.identification.guess import chain_of, guess_of, sign_of
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.intervals import BestFit, CostProfile, best_fit_of, profiles, robust_cost, steps_of
from inerter.identification.judging import Judge, check_parts, judge_of
from inerter.identification.noise import plain, whitening_of, yardstick
from inerter.identification.options import FitOptions
from inerter.identification.problem import FitProblem
from inerter.identification.scales import ScaleEffects, scale_effects
from inerter.identification.search import QUICK, THOROUGH, basin_hopping, search, soft
from inerter.identification.sensors import sound, unavoidable
from inerter.identification.space import space_of
from inerter.identification.sticking import Adhesion, adhering, profiles_at_rest
from inerter.records.finding import Finding
from inerter.records.record import Record
from inerter.vehicle.rig import Rig
from inerter.work.progress import report

Matrix = NDArray[np.float64]
Progress = Callable[[float], None]
_ROUGH = 0.003  # of the r.m.s. force: what a residual counts as until the errors are known
_ROUNDS = 3
_FINE, _POOR = 2.0, 20.0  # whitened residual (its last tenth) that needs no further search, and that which always does
_FAIR = 1.5  # between them: over what the errors of the sensors leave
_SAME = 1e-3  # relative difference of what two searches leave that have come to the same


@dataclass(frozen=True, eq=False)
class SolvedFit:
    """The best fit of a model, what is known about it, and the judge of what it leaves."""

    problem: FitProblem
    optimum: BestFit
    profiles: tuple[CostProfile, ...]
    checked: tuple[NDArray[np.bool_], ...]  # samples of each record that were kept for the check
    leads: tuple[float, ...]
    costs: tuple[float, ...]
    findings: tuple[Finding, ...]
    predicted: float
    judge: Judge
    misfit: Misfit
    options: FitOptions
    adhesion: Adhesion
    scales: ScaleEffects | None


def solve(
    records: Sequence[Record], rig: Rig, assumed: tuple[Hypothesis, ...], asked: FitOptions, progress: Progress | None
) -> SolvedFit:
    """The best fit of a rig's free values to records.

    Raises `IdentificationError` and `RecordError` for records that cannot be used, or that no best fit can follow.
    """
    chain = chain_of(rig.device)
    whole, findings = [], []
    for number, record in enumerate(records):
        report("smoothing of records", number, len(records))
        turned, found_of_sign = sign_of(chain, experiment_of(record, asked.bandwidth, asked.lead))
        whole.append(turned)
        findings += found_of_sign
    problem = FitProblem(rig, space_of(rig, assumed), _for_fit(whole, asked.check), [], asked.offset, assumed)
    problem.whitenings = [
        plain(e.kept, max(e.noise, _ROUGH * float(np.std(e.record.force)))) for e in problem.experiments
    ]
    report("first guess", 0, 1)
    guess = {} if chain is None else guess_of(chain, list(problem.experiments))
    point, costs = _searched(problem, guess, asked.seed, asked.starts, part(progress, 0.0, 0.6))
    report("start of records", 0, len(records))
    problem.experiments, leads = _leads(problem, point, asked.lead)
    optimum, adhesion = adhering(problem, _refined(problem, point, asked.seed))
    drawn = bootstrap(problem, optimum, asked.seed)
    if progress is not None:
        progress(0.7)
    optimum, found = _profiled(problem, drawn.optimum, adhesion)
    report("errors of the sensors", 0, 1)
    optimum, found = _unbiased(problem, optimum, found, drawn.bias)
    checked = tuple(check_parts(problem.experiments, whole, leads))
    judge = judge_of(problem, optimum.point, checked, asked.seed)
    if judge is None:
        raise _lost(problem)
    if progress is not None:
        progress(1.0)
    return SolvedFit(
        problem, optimum, tuple(found), checked, tuple(leads), tuple(costs), tuple(findings),
        drawn.predicted, judge, judge.misfit(problem, optimum.point),
        asked, adhesion, scale_effects(problem, optimum, asked),
    )  # fmt: skip


def _lost(problem: FitProblem) -> IdentificationError:
    sources = ", ".join(repr(e.record.source) for e in problem.experiments)
    return IdentificationError(f"The best fit to {sources} cannot be simulated.")


def _for_fit(experiments: Sequence[Experiment], check: float) -> list[Experiment]:
    """The experiments with the last part of each left out."""
    result = []
    for e in experiments:
        kept = e.kept.copy()
        kept[e.size - round(check * e.size) :] = False
        result.append(replace(e, kept=kept))
    return result


def _searched(
    problem: FitProblem,
    guess: Mapping[str, tuple[float, float]],
    seed: int,
    starts: int,
    progress: Callable[[float], None] | None,
) -> tuple[Matrix, list[float]]:
    """The best of a search; while it leaves more than the sensors' errors, of more thorough ones.

    Two that come to the same need no third: it is the model that leaves so much.
    """
    kept = np.concatenate([e.kept for e in problem.experiments])
    found: list[tuple[float, Matrix, list[float]]] = []
    for attempt, (stages, points) in enumerate(((QUICK, starts), (THOROUGH, starts), (THOROUGH, 2 * starts))):
        begun, ended = attempt / 3.0, (attempt + 1) / 3.0
        point, costs = search(problem, guess, seed + attempt, points, stages, part(progress, begun, ended))
        if stages is THOROUGH:
            point = basin_hopping(problem, point, seed)
        residual = problem.residual(point)
        cost, left = soft(residual), float(np.quantile(np.abs(residual[kept]), 0.9))
        again = any(math.isclose(cost, earlier, rel_tol=_SAME) for earlier, _, _ in found)
        found.append((cost, point, costs))
        if again or left < _FINE or left < min(_FAIR * unavoidable(problem, point, seed), _POOR):
            break
    _, point, costs = min(found, key=lambda f: f[0])
    return point, costs


def _leads(problem: FitProblem, point: Matrix, lead: float | None) -> tuple[list[Experiment], list[float]]:
    """Leave out as much of the start of records that begin in motion as the unknown start of the device matters."""
    result, leads = [], []
    for e in problem.experiments:
        system = problem.system(point, e.record)
        first = int(np.argmax(e.kept))
        if lead is None and first > 0 and system is not None:
            kept = e.kept.copy()
            first = min(max(first, forgotten(e, system, e.noise)), e.size // 2)
            kept[:first] = False
            e = replace(e, kept=kept)
        result.append(e)
        leads.append(first * e.record.interval)
    return result, leads


def _refined(problem: FitProblem, start: Matrix, seed: int) -> BestFit:
    """The best fit with the weights that the errors of the sensors ask for, and the steps that it asks for itself."""
    point, steps, optimum = start, None, None
    for number in range(_ROUNDS):
        report("refinement", number, _ROUNDS)
        forces, left = problem.forces(point), sound(problem, point, (seed, 1))
        if left is None or any(force is None for force in forces):
            raise _lost(problem)
        problem.whitenings = [
            whitening_of(e.record.force - force, yardstick(draws, e.noise, e.kept))
            for e, force, draws in zip(problem.experiments, forces, left, strict=True)
            if force is not None
        ]
        optimum = best_fit_of(problem, point, steps)
        point, steps = optimum.point, steps_of(optimum)
    assert optimum is not None
    return optimum


def _profiled(problem: FitProblem, optimum: BestFit, adhesion: Adhesion) -> tuple[BestFit, list[CostProfile]]:
    """Profiles of all parameters; a better fit met on the way becomes the optimum, and all are walked once more."""
    if adhesion:
        return optimum, profiles_at_rest(problem, optimum, adhesion)
    found = profiles(problem, optimum)
    for _ in range(2):
        better = min((p.better for p in found if p.better is not None), key=lambda b: b[0], default=None)
        if better is None:
            break
        nearer = best_fit_of(problem, better[1], steps_of(optimum))
        optimum = replace(nearer, widening=np.maximum(nearer.widening, optimum.widening))
        found = profiles(problem, optimum)
    return optimum, found


def _unbiased(
    problem: FitProblem, optimum: BestFit, found: Sequence[CostProfile], bias: Matrix
) -> tuple[BestFit, list[CostProfile]]:
    """The best fit and its profiles without what the sensors' errors did to them.

    Where a record bounds a value on one side only, or not at all, the curvature says nothing of how far that is.
    """
    lower, upper = problem.space.bounds
    on_both_sides = np.array([p.lower.known and p.upper.known for p in found])
    point = np.clip(optimum.point - np.where(on_both_sides, bias, 0.0), lower, upper)
    if robust_cost(problem.residual(point)) > optimum.cost + 2.0 * float(np.max(optimum.threshold)):
        return optimum, list(found)
    by = point - optimum.point
    return replace(optimum, point=point), [p.moved(float(d)) for p, d in zip(found, by, strict=True)]


def part(progress: Callable[[float], None] | None, first: float, last: float) -> Callable[[float], None] | None:
    return None if progress is None else lambda done: progress(first + (last - first) * done)
