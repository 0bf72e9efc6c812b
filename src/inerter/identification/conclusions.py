"""Conclusions from the best fit: whether it explains the records, possible causes of a misfit, and intervals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import coherence as coherence_of

from inerter.errors import OK, Status, StatusKind
from inerter.identification.diagnosis import explanations
from inerter.identification.fit import Explanation, Fit, Parameter, RecordFit
from inerter.identification.hypotheses import DELAY
from inerter.identification.intervals import BestFit
from inerter.identification.localising import localisation_of
from inerter.identification.models import without_mount
from inerter.identification.options import FitOptions
from inerter.identification.planning import recommended_experiments
from inerter.identification.problem import FitProblem
from inerter.identification.solving import SolvedFit
from inerter.identification.statements.findings import FitFinding
from inerter.identification.statements.identifiability import Identifiability, Verdict
from inerter.identification.sticking import is_unobservable
from inerter.identification.verdicts import identifiability, suggestions
from inerter.networks.elements import Element, Free
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.networks.transform import with_values
from inerter.records.finding import Finding
from inerter.records.inspection import inconsistent_scales
from inerter.records.saturation import saturated_samples
from inerter.statements import Severity
from inerter.work.progress import report

Matrix = NDArray[np.float64]
ENOUGH = 0.985  # of the variance of the force: a model that explains less is not the device
_RELATED = 0.5  # of the variance of the force: only where less is explained may the force be that of something else
_PIECES, _CHANCE = 16, 1e-3  # of a record whose coherence is estimated, and probability of a larger one by chance
_SATURATED = 0.2  # of the samples, above which a record is unreliable
_ERRORS = 2.5  # standard errors to either side of an estimate under another hypothesis
_FAIRLY = 1.15  # excess of a hypothesis that explains a misfit
_NOTICED = 0.05  # of the friction: an offset that may be one of the friction
_OTHERS = 2  # explanations after the most likely that are named
_MOST = 0.5  # of the misfit: a hypothesis that explains less is not likely


def fit_of(solution: SolvedFit, explain: bool = True) -> Fit:
    """The fit that follows from a solution. Where the residual exceeds sensor noise, causes are sought if `explain`."""
    problem, optimum, found = solution.problem, solution.optimum, solution.profiles
    space = problem.space
    comparisons = _comparisons(solution)
    values = space.values_by_name(optimum.point)
    slopes = space.slopes(optimum.point)
    covariance = _covariance(solution)
    report("where the misfit is", 0, len(comparisons))
    where = (
        ()
        if solution.misfit.is_noise_limited
        else tuple(localisation_of(c, solution.options.seed) for c in comparisons)
    )
    likely = explanations(problem, optimum, solution.judge, solution.misfit, where) if explain else []
    findings = (*solution.findings, *_offset_findings(problem, values, comparisons), *_mass_findings(problem))
    findings = (*findings, _scale_finding(solution))
    draft = Fit(
        parameters={}, identifiable={}, correlation=_correlation(covariance),
        covariance=covariance * np.outer(slopes, slopes),
        device=without_mount(with_values(problem.rig.device, values)), comparisons=comparisons,
        criterion=_criterion(problem, optimum), costs=solution.costs, simulations=0, predicted=solution.predicted,
        misfit=solution.misfit, explanations=tuple(likely), localisations=where, findings=findings,
        settings=_settings(solution.options),
    )  # fmt: skip
    doubt = find_doubt(draft)
    stuck = is_unobservable(optimum) if solution.adhesion else np.zeros(len(space.names), dtype=bool)
    parameters, identifiable = {}, {}
    for i, name in enumerate(space.names):
        p = _parameter(solution, i, values[name])
        held = solution.adhesion.of(i) if stuck[i] else None
        verdict = replace(identifiability(p, found[i], space, i, comparisons), held=held)
        if solution.noisy[i] and not stuck[i]:
            p = replace(p, interval=(math.nan, math.nan), standard_error=math.nan, profile=())
            verdict = replace(verdict, verdict=Verdict.NOISY)
        p, verdict = (p, verdict) if doubt is None else _withhold(p, verdict, draft)
        parameters[name], identifiable[name] = (p if verdict else replace(p, value=math.nan)), verdict
    planned = [] if doubt is not None else list(suggestions(space, parameters, identifiable, comparisons))
    if doubt is None and explain:
        planned += recommended_experiments(solution, parameters)
    return replace(
        draft,
        parameters=parameters,
        identifiable=identifiable,
        findings=(*findings, *_late_finding(parameters)),
        reliability_warning=doubt,
        status=OK if doubt is None else Status(StatusKind.INACCURATE, doubt.sentence),
        suggestions=tuple(planned),
        simulations=sum(e.tally.total for e in problem.experiments),
    )


def find_doubt(fit: Fit) -> Finding | None:
    """Reason why the estimates are unreliable, with the most likely cause; None if they are reliable."""
    for c in fit.comparisons:
        for wrong in inconsistent_scales(c.record, c.experiment.motion):
            return Finding(FitFinding.SCALES, Severity.WARNING, wrong.about, wrong.numbers)
    lost = sum(float(saturated_samples(c.record).mean()) for c in fit.comparisons) / len(fit.comparisons)
    best = _main_cause(fit)
    if fit.variance_explained < _RELATED and all(map(_is_unrelated, fit.comparisons)):
        return Finding(FitFinding.UNRELATED, Severity.WARNING)
    if fit.predicted < ENOUGH and best is None:
        numbers = {
            "changed": 100.0 * min(1.0 - fit.predicted, 1.0),
            "rattles": any(any(c.openings.values()) for c in fit.comparisons),
        }
        return Finding(FitFinding.UNPREDICTABLE, Severity.WARNING, numbers=numbers)
    if fit.misfit.is_noise_limited and best is not None:
        return Finding(FitFinding.SUSPECTED, Severity.WARNING, numbers={"likeliest": best})
    if not fit.misfit.is_noise_limited or fit.variance_explained < ENOUGH:
        return _misfit_finding(fit, best)
    if lost > _SATURATED:
        return Finding(FitFinding.SATURATED, Severity.WARNING, numbers={"share": lost})
    return None


def _is_unrelated(c: RecordFit) -> bool:
    """Whether the force is neither coherent with the displacement at any frequency, nor a sum of what the motion does.

    Coherence has a known distribution by chance (Carter 1987), but needs many periods.
    """
    motion, force, length = c.experiment.motion, c.record.force, c.record.time.size // _PIECES
    if length < _PIECES:
        return False
    coherence = coherence_of(c.record.displacement, force, nperseg=length, noverlap=0)[1][1:]
    by_chance = 1.0 - (_CHANCE / coherence.size) ** (1.0 / (_PIECES - 1))
    velocity = motion.velocity
    columns = np.column_stack([motion.displacement, velocity, motion.acceleration, np.sign(velocity)])
    columns = np.column_stack([columns / np.abs(columns).max(axis=0), np.ones(force.size)])
    left = force - columns @ np.linalg.lstsq(columns, force)[0]
    return bool(np.nanmax(coherence) < by_chance and np.var(left) > _RELATED * np.var(force))


def _main_cause(fit: Fit) -> Explanation | None:
    """The best explanation, if it explains most of the misfit; without a misfit, any that is left."""
    best = fit.explanations[0] if fit.explanations else None
    return best if best is not None and (best.explained >= _MOST or fit.misfit.is_noise_limited) else None


def _misfit_finding(fit: Fit, best: Explanation | None) -> Finding:
    """Finding of a wrong model or sensor: the likeliest cause, or what to try where no tested one is likely."""
    explained = 100.0 * max(fit.variance_explained, 0.0) if fit.variance_explained < ENOUGH else None
    as_good = [e for e in fit.explanations[1:] if e.misfit.is_noise_limited][:_OTHERS]
    patterns = [pattern for place in fit.localisations for pattern in place.patterns[:1]]
    where = max(patterns, key=lambda pattern: float(pattern.numbers["share"]), default=None)
    sampled = min(map(_samples_in_a_period, fit.comparisons))
    numbers = {
        "times": fit.misfit.worst, "explained": explained, "likeliest": best, "as_good": as_good, "where": where,
        "sampled": sampled,
    }  # fmt: skip
    return Finding(FitFinding.MISFIT, Severity.WARNING, numbers=numbers)


def _samples_in_a_period(c: RecordFit) -> float:
    """Samples in a period of the motion, of which the mean squares of velocity and acceleration say how fast it is."""
    velocity, acceleration = c.experiment.motion.velocity[c.fitted], c.experiment.motion.acceleration[c.fitted]
    return 2.0 * math.pi * float(np.std(velocity)) / max(float(np.std(acceleration)), 1e-300) / c.record.interval


def _offset_findings(
    problem: FitProblem, values: Mapping[str, float], comparisons: Sequence[RecordFit]
) -> Iterator[Finding]:
    """Findings of offsets that may be asymmetric friction instead."""
    kinds = dict(zip(problem.space.names, problem.space.kinds, strict=True))
    friction = sum(
        v for name, v in values.items() if (kind := kinds[name]) is not None and kind.linear is LinearRole.OPEN
    )
    for c in comparisons:
        if abs(c.offset) > _NOTICED * friction > 0.0:
            yield Finding(FitFinding.OFFSET, Severity.INFO, c.record.source, {"offset": c.offset})


def _late_finding(parameters: Mapping[str, Parameter]) -> Iterator[Finding]:
    """Finding of the channel that lags the other, where the sign of the delay is known."""
    late = parameters.get(DELAY)
    if late is not None and math.isfinite(late.value) and late.interval[0] * late.interval[1] > 0.0:
        yield Finding(FitFinding.LATE, Severity.INFO, DELAY, {"delay": late.value})


def _mass_findings(problem: FitProblem) -> Iterator[Finding]:
    """Findings of inertances that include an unknown fixture mass."""
    names = zip(problem.space.names, problem.space.kinds, strict=True)
    free = [name for name, kind in names if kind is not None and kind.linear is LinearRole.MASS]
    if free and any(e.record.fixture_mass is None for e in problem.experiments):
        yield Finding(FitFinding.MOVING_MASS, Severity.INFO, ", ".join(free))


def _withhold(p: Parameter, verdict: Identifiability, fit: Fit) -> tuple[Parameter, Identifiability]:
    """A parameter of an unreliable fit: no value, and at most a range under explanations.

    Confidence intervals require a correct model. Where hypotheses explain all of a misfit, the range includes the
    values under each of them, and that of the profile; it is not a confidence interval.
    """
    right = [e for e in fit.explanations if e.misfit.excess <= _FAIRLY]
    none = replace(p, standard_error=math.nan, profile=())
    if fit.predicted < ENOUGH or not right or any(p.name not in e.estimates for e in right):
        kind = Verdict.UNPREDICTABLE if fit.predicted < ENOUGH else Verdict.WITHHELD
        return replace(none, interval=(math.nan, math.nan)), replace(verdict, verdict=kind)
    ends = [end for e in right for end in _interval_ends(*e.estimates[p.name])]
    interval = min(p.interval[0], *ends), max(p.interval[1], *ends)
    return replace(none, interval=interval), replace(verdict, verdict=Verdict.CONDITIONAL, interval=interval)


def _interval_ends(value: float, error: float) -> tuple[float, float]:
    return value - _ERRORS * error, value + _ERRORS * error


def _parameter(solution: SolvedFit, i: int, best: float) -> Parameter:
    """A parameter with its interval and its standard error, both with the stated uncertainties of scale."""
    optimum, space, profile = solution.optimum, solution.problem.space, solution.profiles[i]

    def value(coordinate: float) -> float:
        point = optimum.point.copy()
        point[i] = coordinate
        return float(space.to_values(point)[i])

    interval = value(profile.lower.end), value(profile.upper.end)
    error = float(optimum.errors[i] * space.slopes(optimum.point)[i])
    if solution.scales is not None:
        known = profile.lower.known, profile.upper.known
        interval = solution.scales.widen(i, interval, best, known)
        error = math.hypot(error, float(solution.scales.errors[i]))
    return Parameter(
        name=space.names[i],
        unit=space.units[i],
        value=best,
        interval=interval,
        best=best,
        standard_error=math.nan if solution.adhesion and is_unobservable(optimum)[i] else error,
        profile=tuple((value(x), rise) for x, rise in profile.points),
    )


def _settings(options: FitOptions) -> dict[str, object]:
    """The seed, and the scales where they are given."""
    scales = {name: getattr(options, name) for name in ("force_scale", "displacement_scale")}
    return {"seed": options.seed, **{name: str(scale) for name, scale in scales.items() if scale is not None}}


def _covariance(solution: SolvedFit) -> Matrix:
    """The covariance of the coordinates, with that of the scales; nan where the records do not depend on one."""
    optimum, space = solution.optimum, solution.problem.space
    covariance = optimum.covariance
    if solution.scales is not None:
        slopes = space.slopes(optimum.point)
        covariance = covariance + solution.scales.covariance / np.outer(slopes, slopes)
    if solution.adhesion:
        unseen = is_unobservable(optimum)
        covariance = np.where(unseen[:, None] | unseen[None, :], np.nan, covariance)
    return np.asarray(covariance)


def _scale_finding(solution: SolvedFit) -> Finding:
    """Finding of the uncertainties that the values include but no record shows."""
    options = solution.options
    scales = {n: getattr(options, n) for n in ("force_scale", "displacement_scale")}
    masses = [m for e in solution.problem.experiments if (m := e.record.fixture_mass_error) is not None]
    return Finding(FitFinding.INCLUDED, Severity.INFO, "", {**scales, "fixture_mass_error": max(masses, default=None)})


def _comparisons(solution: SolvedFit) -> tuple[RecordFit, ...]:
    problem, optimum = solution.problem, solution.optimum
    result, first = [], 0
    residuals, offsets = problem.residual(optimum.point), problem.offsets(optimum.point)
    for n, (e, checked) in enumerate(zip(problem.experiments, solution.checked, strict=True)):
        simulated = problem.simulate(e, optimum.point)
        assert simulated is not None
        force = problem.read_force(n, simulated)
        white = residuals[first : first + e.size][problem.whitenings[n].weight > 0.0]
        first += e.size
        gaps = {
            _label_of(b): b.switch.middle
            for b in problem.rig.device.elements()
            if b.switch is not None and b.switches_by(GuardRole.ELONGATION)
        }
        openings = {
            g: sum(event.element == g and event.after == loose for event in simulated.run.events)
            for g, loose in gaps.items()
        }
        result.append(
            RecordFit(
                experiment=e,
                model=force + offsets[n],
                offset=offsets[n],
                fitted=e.kept,
                checked=checked,
                draws=solution.judge.draws[n],
                whitened=white,
                lead=solution.leads[n],
                whiteness=solution.judge.pattern(n, e.record.force - force),
                openings=openings,
            )
        )
    return tuple(result)


def _label_of(element: Element) -> str:
    """Label of an element in simulations of the problem."""
    return str(element.value.name) if isinstance(element.value, Free) else element.label


def _criterion(problem: FitProblem, optimum: BestFit) -> float:
    """Schwarz's criterion: -2 log likelihood of the whitened residuals, plus log(samples) for each unknown."""
    n = optimum.samples
    logs = sum(float(np.sum(np.log(w.weight[w.weight > 0.0]))) for w in problem.whitenings)
    return n * math.log(max(optimum.variance, 1e-300)) - 2.0 * logs + math.log(n) * optimum.point.size


def _correlation(covariance: Matrix) -> Matrix:
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return np.asarray(np.clip(covariance / np.outer(size, size), -1.0, 1.0))
