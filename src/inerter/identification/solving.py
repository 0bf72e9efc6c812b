"""Solution of an identification: search, refinement, profiles, and tests of the residual."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import IdentificationError
from inerter.formatting import format_quantity
from inerter.identification.bootstrap import bootstrap
from inerter.identification.experiment import Experiment, experiment_of, transient_samples
from inerter.identification.fit import NormalisedResidual
from inerter.identification.friction_models import quadratic_damping
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.initial_estimate import Chain, chain_of, guess_of, sign_of
from inerter.identification.intervals import BestFit, CostProfile, best_fit_of, profiles, robust_cost, steps_of
from inerter.identification.models import is_rigid
from inerter.identification.noise import noise_whitening, uniform_whitening, whitening_of
from inerter.identification.options import FitOptions
from inerter.identification.parameter_space import WIDER, space_of
from inerter.identification.passed_noise import decided_by_noise
from inerter.identification.problem import FitProblem
from inerter.identification.residual_tests import NoiseReference, check_parts, noise_reference
from inerter.identification.scales import ScaleEffects, scale_effects
from inerter.identification.search import QUICK, THOROUGH, basin_hopping, robust_sum, search
from inerter.identification.sensors import noise_residuals, unavoidable_residual
from inerter.identification.statements.causes import Suspect
from inerter.identification.sticking import Adhesion, profiles_at_rest, with_adhesion
from inerter.identification.unstated_bandwidth import with_filter
from inerter.identification.wrong_units import likely_units, wrong_unit_error
from inerter.networks.elements.roles import LinearRole
from inerter.networks.transform import with_values
from inerter.records.finding import Finding
from inerter.records.record import Record
from inerter.vehicle.rig import Rig
from inerter.work.progress import part, report

Matrix = NDArray[np.float64]
Progress = Callable[[float], None]
_ROUGH = 0.003  # of the r.m.s. force: assumed error until it is known
_ROUNDS = 3
_PARTS = ((0.0, 0.6), (0.6, 0.8), (0.8, 1.0))  # of a search that is repeated at most twice, mostly not at all
_FINE, _POOR = 2.0, 20.0  # whitened residual (90th percentile) that requires no further search, and always does
_FAIR = 1.5  # between them: limit over that of sensor noise
_UNITS, _FAILURES = 3, 2  # wrong units that are named, and those that explain nothing after which none is sought
_SAME = 1e-3  # relative difference of the costs of two searches with the same result


@dataclass(frozen=True, eq=False)
class SolvedFit:
    """The best fit of a model, with profiles, validation data and tests of the residual."""

    problem: FitProblem
    optimum: BestFit
    profiles: tuple[CostProfile, ...]
    checked: tuple[NDArray[np.bool_], ...]  # validation samples of each record
    leads: tuple[float, ...]
    costs: tuple[float, ...]
    findings: tuple[Finding, ...]
    predicted: float
    judge: NoiseReference
    misfit: NormalisedResidual
    options: FitOptions
    adhesion: Adhesion
    scales: ScaleEffects | None
    noisy: NDArray[np.bool_]  # values that the noise of the displacement decides


def solve(
    records: Sequence[Record], rig: Rig, assumed: tuple[Hypothesis, ...], asked: FitOptions, progress: Progress | None
) -> SolvedFit:
    """The best fit of the free values of a rig to records.

    Raises `IdentificationError` and `RecordError` for records that cannot be used, or a best fit that cannot be
    simulated.
    """
    chain = chain_of(rig.device)
    _check_law(asked, chain)
    problem, whole, findings = _problem_of(records, rig, chain, assumed, asked)
    _check_reach(problem)
    point, costs = _search_thoroughly(problem, chain, records, asked, part(progress, 0.0, 0.6))
    report("start of records", 0, len(records))
    problem.experiments, leads = _without_transients(problem, point, asked.lead)
    optimum, adhesion = with_adhesion(problem, _refine(problem, point, asked.seed))
    drawn = bootstrap(problem, optimum, asked.seed)
    if progress is not None:
        progress(0.7)
    optimum, found = _profile_all(problem, drawn.optimum, adhesion)
    report("errors of the sensors", 0, 1)
    optimum, found = _remove_bias(problem, optimum, found, drawn.bias)
    if asked.delay is None and not adhesion:
        optimum, found = with_filter(problem, optimum, found)
    checked = tuple(check_parts(problem.experiments, whole, leads))
    judge = noise_reference(problem, optimum.point, checked, asked.seed)
    if judge is None:
        raise _simulation_error(problem)
    if progress is not None:
        progress(1.0)
    return SolvedFit(
        problem=problem, optimum=optimum, profiles=tuple(found), checked=checked, leads=tuple(leads),
        costs=tuple(costs), findings=tuple(findings), predicted=drawn.predicted, judge=judge,
        misfit=judge.misfit(problem, optimum.point), options=asked, adhesion=adhesion,
        scales=scale_effects(problem, optimum, asked),
        noisy=decided_by_noise(problem, optimum, found, asked.seed),
    )  # fmt: skip


def _problem_of(
    records: Sequence[Record], rig: Rig, chain: Chain | None, assumed: tuple[Hypothesis, ...], asked: FitOptions
) -> tuple[FitProblem, list[Experiment], list[Finding]]:
    """The problem of the first search, the experiments with their validation parts, and findings of reversed forces."""
    whole, findings = [], []
    for number, record in enumerate(records):
        report("smoothing of records", number, len(records))
        turned, found_of_sign = sign_of(chain, experiment_of(record, asked.bandwidth, asked.lead, is_rigid(rig.device)))
        whole.append(turned)
        findings += found_of_sign
    if chain is not None and asked.quadratic_damping:
        fastest = max(float(np.abs(e.motion.velocity).max()) for e in whole)
        peak = max(float(np.abs(e.record.force).max()) for e in whole)
        assumed = (*assumed, quadratic_damping(chain, fastest, peak))
    fitted = _without_validation_part(whole, asked.check)
    whitenings = [uniform_whitening(e.kept, max(e.noise, _ROUGH * float(np.std(e.record.force)))) for e in fitted]
    problem = FitProblem(rig, space_of(rig, assumed), fitted, whitenings, asked.offset, assumed)
    return problem, whole, findings


def _check_law(asked: FitOptions, chain: Chain | None) -> None:
    """Raise `IdentificationError` for a quadratic damping of a device that is not a chain."""
    if asked.quadratic_damping and chain is None:
        raise IdentificationError(
            "quadratic_damping: the model must be an inerter, alone or with friction or a damper in parallel, in "
            "series with at most a shaft and a gap, such as (ks | cs) - gap - (b | f | c)."
        )


def _check_reach(problem: FitProblem) -> None:
    """Raise `IdentificationError` for records that no values near the bounds of their search can explain in time.

    The device with all of the smallest values, or the largest, must come as near to the size of the force as wider
    bounds could bring it, and a device in the middle must not be too fast for the samples: else every search ends far
    from the record, or every simulation takes seconds. Gaps are closed.
    """
    lower, upper = problem.space.bounds
    gaps = np.array([kind is not None and kind.linear is LinearRole.CLOSED for kind in problem.space.kinds])
    first = replace(problem, horizon=QUICK[0][0])
    for e in problem.experiments:
        source, middle = e.record.source, problem.system(0.5 * (lower + upper), e.record)
        if middle is not None and e.is_too_coarse(middle):
            raise IdentificationError(
                f"The samples of {source!r} are {format_quantity(e.record.interval, 's')} apart, at which the device "
                "is too fast to be computed. Check the unit of its times, or resample the record."
            )
        for point, word in ((lower, "least"), (np.where(gaps, lower, upper), "most")):
            simulated = first.simulate(e, point)
            if simulated is None:
                continue
            size, measured = float(np.std(simulated.force)), float(np.std(e.record.force[: simulated.force.size]))
            if (size > WIDER * measured) if word == "least" else (measured > WIDER * size):
                raise IdentificationError(
                    f"The force of {source!r} is {format_quantity(measured, 'N')} r.m.s., but that of the model with "
                    f"this motion, within the bounds of its values, is at {word} {format_quantity(size, 'N')} r.m.s. "
                    "Check the units of the record, or change the bounds."
                )


def _simulation_error(problem: FitProblem) -> IdentificationError:
    sources = ", ".join(repr(e.record.source) for e in problem.experiments)
    return IdentificationError(f"The best fit to {sources} cannot be simulated.")


def _without_validation_part(experiments: Sequence[Experiment], check: float) -> list[Experiment]:
    """The experiments with the last part of each left out."""
    result = []
    for e in experiments:
        kept = e.kept.copy()
        kept[e.size - round(check * e.size) :] = False
        result.append(replace(e, kept=kept))
    return result


def _search_thoroughly(
    problem: FitProblem,
    chain: Chain | None,
    records: Sequence[Record],
    asked: FitOptions,
    progress: Callable[[float], None] | None,
) -> tuple[Matrix, list[float]]:
    """The best of a search, repeated more thoroughly while the residual exceeds sensor noise.

    If two searches agree there is no third: the residual is that of the model.

    Raises `WrongUnitError` if no values explain the records as they were read, but some explain them in other units.
    """
    report("first guess", 0, 1)
    guess = _guess(chain, problem)
    found: list[tuple[float, Matrix, list[float]]] = []
    for attempt, (stages, points) in enumerate(((QUICK, 1), (THOROUGH, 1), (THOROUGH, 2))):
        within = part(progress, *_PARTS[attempt])
        point, costs = search(problem, guess, asked.seed + attempt, points * asked.starts, stages, within)
        if stages is THOROUGH:
            point = basin_hopping(problem, point, asked.seed)
        cost, fine = _assess(problem, point, asked.seed)
        again = any(math.isclose(cost, earlier, rel_tol=_SAME) for earlier, _, _ in found)
        found.append((cost, point, costs))
        if again or fine:
            break
        if stages is QUICK:
            _check_units(problem, chain, records, asked)
    _, point, costs = min(found, key=lambda f: f[0])
    return point, costs


def _guess(chain: Chain | None, problem: FitProblem) -> Mapping[str, tuple[float, float]]:
    return {} if chain is None else guess_of(chain, list(problem.experiments))


def _assess(problem: FitProblem, point: Matrix, seed: int) -> tuple[float, bool]:
    """The cost of a best fit, and whether its residual is that of sensor noise."""
    residual = problem.residual(point)
    left = float(np.quantile(np.abs(residual[np.concatenate([e.kept for e in problem.experiments])]), 0.9))
    fine = left < _FINE or left < min(_FAIR * unavoidable_residual(problem, point, seed), _POOR)
    return robust_sum(residual), fine


def _check_units(problem: FitProblem, chain: Chain | None, records: Sequence[Record], asked: FitOptions) -> None:
    """Raise `WrongUnitError` where searches with other usual units explain the records."""
    assumed = tuple(h for h in problem.assumed if h.name is not Suspect.QUADRATIC)
    found, wrong, failures = [], [], 0
    for unit, read in likely_units(chain, records, problem.experiments):
        other, _, _ = _problem_of(read, problem.rig, chain, assumed, asked)
        point, _ = search(other, _guess(chain, other), asked.seed, asked.starts, QUICK)
        if _assess(other, point, asked.seed)[1]:
            found.append((unit, with_values(other.rig.device, other.space.values_by_name(point))))
            wrong = [old.source for old, new in zip(records, read, strict=True) if new is not old]
        else:
            failures += 1
        if len(found) == _UNITS or failures == _FAILURES:
            break
    if found:
        raise wrong_unit_error(wrong, found)


def _without_transients(problem: FitProblem, point: Matrix, lead: float | None) -> tuple[list[Experiment], list[float]]:
    """Discard the start of records that begin in motion, as long as the unknown initial state of the device matters.

    Of a linear device, free motions from any state are fitted instead.
    """
    result, leads = [], []
    for e in problem.experiments:
        system = problem.system(point, e.record)
        first = int(np.argmax(e.kept))
        if lead is None and first > 0 and system is not None and system.nonlinear:
            kept = e.kept.copy()
            first = min(max(first, transient_samples(e, system, e.noise)), e.size // 2)
            kept[:first] = False
            e = replace(e, kept=kept)
        result.append(e)
        leads.append(first * e.record.interval)
    return result, leads


def _refine(problem: FitProblem, start: Matrix, seed: int) -> BestFit:
    """The best fit with weights from simulated sensor noise, and steps from its standard errors."""
    point, steps, optimum = start, None, None
    for number in range(_ROUNDS):
        report("refinement", number, _ROUNDS)
        forces, left = problem.forces(point), noise_residuals(problem, point, (seed, 1))
        if left is None or any(force is None for force in forces):
            raise _simulation_error(problem)
        problem.whitenings = [
            whitening_of(e.record.force - force, noise_whitening(draws, e.noise, e.kept))
            for e, force, draws in zip(problem.experiments, forces, left, strict=True)
            if force is not None
        ]
        optimum = best_fit_of(problem, point, steps)
        point, steps = optimum.point, steps_of(optimum)
    assert optimum is not None
    return optimum


def _profile_all(problem: FitProblem, optimum: BestFit, adhesion: Adhesion) -> tuple[BestFit, list[CostProfile]]:
    """Profiles of all parameters; a better fit found on the way becomes the optimum, and all are repeated."""
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


def _remove_bias(
    problem: FitProblem, optimum: BestFit, found: Sequence[CostProfile], bias: Matrix
) -> tuple[BestFit, list[CostProfile]]:
    """The best fit and its profiles, corrected for the bias by sensor noise.

    Values that a record bounds on one side only, or not at all, are not corrected.
    """
    lower, upper = problem.space.bounds
    on_both_sides = np.array([p.lower.known and p.upper.known for p in found])
    point = np.clip(optimum.point - np.where(on_both_sides, bias, 0.0), lower, upper)
    if robust_cost(problem.residual(point)) > optimum.cost + 2.0 * float(np.max(optimum.threshold)):
        return optimum, list(found)
    by = point - optimum.point
    return replace(optimum, point=point), [p.shift(float(d)) for p, d in zip(found, by, strict=True)]
