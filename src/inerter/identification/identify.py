"""`identify`: from measured records to the parameters of a device, with honest uncertainty."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from inerter.checks import is_number
from inerter.errors import OK, IdentificationError, Status, StatusKind
from inerter.identification.experiment import Experiment, experiment_of, forgotten, reading_of, saturated
from inerter.identification.fit import Comparison, Fit, Parameter
from inerter.identification.guess import chain_of, guess_of, sign_of
from inerter.identification.intervals import Optimum, Profile, optimum_of, profiles, robust_cost, steps_of
from inerter.identification.models import mounted, unmounted
from inerter.identification.noise import plain, whitening_of
from inerter.identification.problem import Problem
from inerter.identification.redrawing import redrawn, unavoidable
from inerter.identification.search import POINTS, QUICK, THOROUGH, search, soft, wander
from inerter.identification.space import DELAY, GAIN, Space, space_of
from inerter.identification.telling import suggestions, told
from inerter.networks.elements import Gap, Network
from inerter.networks.transform import with_values
from inerter.optimisation.threads import one_blas_thread
from inerter.records.record import Record
from inerter.vehicle.cars import Rig

Matrix = NDArray[np.float64]
LONGEST_DELAY = 0.02  # [s] that is looked for when a delay is free
_ROUGH = 0.003  # of the r.m.s. force: what a residual counts as until the errors are known
_ROUNDS = 3
_FINE, _POOR = 2.0, 20.0  # whitened residual (its last tenth) that needs no further search, and that which always does
_FAIR = 1.5  # between them: over what the errors of the sensors leave
_SAME = 1e-3  # relative difference of what two searches leave that have come to the same
_ENOUGH = 0.985  # of the variance of the force: a model that explains less is not the device
_LAGS = 20
_INDEPENDENT = 1e-3  # p-value below which residuals still hang together


def identify(
    records: Record | Sequence[Record],
    model: Network,
    *,
    seed: int = 0,
    offset: bool = True,
    gain: bool = False,
    delay: bool | float | None = None,
    check: float = 0.2,
    bandwidth: float | None = None,
    lead: float | None = None,
    starts: int = POINTS,
    progress: Callable[[float], None] | None = None,
) -> Fit:
    """Fit the free values of `model`, the device on the rig, to the force of one record or several together.

    The model is moved as the record's displacement was, smoothed below `bandwidth` [Hz] (by default as far as it
    stands out of its noise), and its force compared; no measured motion is differentiated twice. Sensors may have an
    `offset` of their own in each record, and one `gain` and one `delay` (up to a number of seconds) of the force in
    all; by default a delay is sought where the bandwidth of a load cell is not known, because that is what its filter
    does to slow forces. The last part `check` of each record is not fitted but kept to check the fit on; `lead` [s]
    at the start, or as much as the start of the device matters, are not compared either. A device in which nothing
    gives way is fitted on a very stiff mount.

    `starts` points from a Sobol sequence with `seed`, and a first guess without simulation for devices that are a
    chain, are improved by least squares; errors are weighted and whitened as the residuals ask; intervals are from
    profile likelihoods at 95 %, at least as wide as fits to records drawn anew scatter. A parameter that the records
    cannot tell has the value nan, with a sentence in `fit.identifiable`. See docs/identification.md.

    Raises `IdentificationError` for a model without free values or a request that cannot be, and `RecordError` for
    records that cannot be used.
    """
    given, rig = _checked(records, model, check, starts)
    sought = any(r.force_bandwidth is None for r in given) if delay is None else delay
    longest = LONGEST_DELAY if sought is True else float(sought)
    if not is_number(longest) or not 0.0 <= longest < 0.5 * min(r.duration for r in given):
        raise IdentificationError(f"A delay is True, False or its largest size in s, got {delay!r}.")
    space = space_of(rig, gain, longest)
    _check_gain(rig, gain)
    with one_blas_thread(), warnings.catch_warnings():
        warnings.simplefilter("ignore", category=RuntimeWarning)
        chain = chain_of(rig.device)
        experiments, notes = [], []
        for record in given:
            turned, said = sign_of(chain, experiment_of(record, bandwidth, lead))
            experiments.append(turned)
            notes += said
        problem = Problem(rig, space, _for_fit(experiments, check), [], offset)
        problem.whitenings = [
            plain(e.kept, max(e.noise, _ROUGH * float(np.std(e.record.force)))) for e in problem.experiments
        ]
        guess = {} if chain is None else guess_of(chain, list(problem.experiments))
        point, costs = _searched(problem, guess, seed, starts, _part(progress, 0.0, 0.6))
        problem.experiments, leads = _leads(problem, point, lead)
        anew = redrawn(problem, _refined(problem, point), seed)
        if progress is not None:
            progress(0.7)
        optimum, found = _profiled(problem, anew.optimum)
        optimum, found = _straightened(problem, optimum, found, anew.lean)
        if progress is not None:
            progress(1.0)
        return _fit(problem, optimum, found, experiments, leads, tuple(costs), tuple(notes), anew.predicted, seed)


def _searched(
    problem: Problem,
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
        part = _part(progress, attempt / 3.0, (attempt + 1) / 3.0)
        point, costs = search(problem, guess, seed + attempt, points, stages, part)
        if stages is THOROUGH:
            point = wander(problem, point, seed)
        residual = problem.residual(point)
        cost, left = soft(residual), float(np.quantile(np.abs(residual[kept]), 0.9))
        again = any(math.isclose(cost, earlier, rel_tol=_SAME) for earlier, _, _ in found)
        found.append((cost, point, costs))
        if again or left < _FINE or left < min(_FAIR * unavoidable(problem, point, seed), _POOR):
            break
    _, point, costs = min(found, key=lambda f: f[0])
    return point, costs


def _checked(records: Record | Sequence[Record], model: Network, check: float, starts: int) -> tuple[list[Record], Rig]:
    given = [records] if isinstance(records, Record) else list(records) if isinstance(records, Sequence) else []
    if not given or not all(isinstance(r, Record) for r in given):
        raise IdentificationError(
            f"identify(...) takes a record or a list of records, such as [read_record('bench.csv')], got {records!r}."
        )
    rig = Rig(mounted(model))
    if not rig.free_values():
        raise IdentificationError(
            "The model has no free values: there is nothing to identify. Write Spring(free(1e5, 1e7, name='ks')), ..."
        )
    if not is_number(check) or not 0.0 <= check <= 0.6:
        raise IdentificationError(f"The part kept for the check is a fraction from 0 to 0.6, got {check!r}.")
    if isinstance(starts, bool) or not isinstance(starts, int) or starts < 8:
        raise IdentificationError(f"The number of starts is a whole number from 8 on, got {starts!r}.")
    return given, rig


def _check_gain(rig: Rig, gain: bool) -> None:
    """A gain of the load cell and the size of every element are one and the same, unless one of them is known."""
    known = [e for e in rig.device.elements() if not isinstance(e, Gap) and is_number(e.value)]
    if gain and not known:
        raise IdentificationError(
            "A gain of the load cell cannot be told from larger springs, dampers, inerters and frictions: fix one of "
            "them, such as the inertance from the geometry, or leave the gain out."
        )


def _for_fit(experiments: Sequence[Experiment], check: float) -> list[Experiment]:
    """The experiments with the last part of each left out."""
    result = []
    for e in experiments:
        kept = e.kept.copy()
        kept[e.size - round(check * e.size) :] = False
        result.append(replace(e, kept=kept))
    return result


def _leads(problem: Problem, point: Matrix, lead: float | None) -> tuple[list[Experiment], list[float]]:
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


def _refined(problem: Problem, start: Matrix) -> Optimum:
    """The best fit with the weights, and the steps of the differences, that it asks for itself."""
    point, steps, optimum = start, None, None
    for _ in range(_ROUNDS):
        forces = problem.forces(point)
        whitenings = []
        for e, force in zip(problem.experiments, forces, strict=True):
            if force is None:
                raise IdentificationError(f"The best fit to {e.record.source!r} cannot be simulated.")
            floor = e.noise / 3.0
            whitenings.append(whitening_of(e.record.force - force, force, e.kept, floor))
        problem.whitenings = whitenings
        optimum = optimum_of(problem, point, steps)
        point, steps = optimum.point, steps_of(optimum)
    assert optimum is not None
    return optimum


def _profiled(problem: Problem, optimum: Optimum) -> tuple[Optimum, list[Profile]]:
    """Profiles of all parameters; a better fit met on the way becomes the optimum, and all are walked anew."""
    found = profiles(problem, optimum)
    for _ in range(2):
        better = min((p.better for p in found if p.better is not None), key=lambda b: b[0], default=None)
        if better is None:
            break
        nearer = optimum_of(problem, better[1], steps_of(optimum))
        optimum = replace(nearer, widening=np.maximum(nearer.widening, optimum.widening))
        found = profiles(problem, optimum)
    return optimum, found


def _straightened(
    problem: Problem, optimum: Optimum, found: Sequence[Profile], lean: Matrix
) -> tuple[Optimum, list[Profile]]:
    """The best fit and its profiles without what the sensors' errors did to them.

    Where a record tells a value on one side only, or not at all, the curvature says nothing of how far that is.
    """
    lower, upper = problem.space.bounds
    told_on_both_sides = np.array([p.lower.told and p.upper.told for p in found])
    point = np.clip(optimum.point - np.where(told_on_both_sides, lean, 0.0), lower, upper)
    if robust_cost(problem.residual(point)) > optimum.cost + 2.0 * float(np.max(optimum.threshold)):
        return optimum, list(found)
    by = point - optimum.point
    return replace(optimum, point=point), [p.moved(float(d)) for p, d in zip(found, by, strict=True)]


def _fit(
    problem: Problem,
    optimum: Optimum,
    found: Sequence[Profile],
    whole: Sequence[Experiment],
    leads: Sequence[float],
    costs: tuple[float, ...],
    notes: tuple[str, ...],
    predicted: float,
    seed: int,
) -> Fit:
    space = problem.space
    comparisons = _comparisons(problem, optimum, whole, leads)
    values = space.named(optimum.point)
    device = unmounted(with_values(problem.rig.device, values))
    draft = Fit(
        parameters={}, identifiable={}, correlation=_correlation(optimum.covariance),
        covariance=optimum.covariance * np.outer(space.slopes(optimum.point), space.slopes(optimum.point)),
        device=device, comparisons=comparisons, criterion=_criterion(problem, optimum), costs=costs,
        simulations=problem.simulations, notes=notes, predicted=predicted, settings={"seed": seed},
    )  # fmt: skip
    status = _status(draft)
    parameters = {name: _parameter(space, i, optimum, found[i], values[name]) for i, name in enumerate(space.names)}
    explains = min(draft.explained, predicted) >= _ENOUGH
    identifiable = {
        name: told(space.kinds[i], p, found[i], space, i, comparisons, values, explains)
        for i, (name, p) in enumerate(parameters.items())
    }
    parameters = {name: p if identifiable[name] else replace(p, value=float("nan")) for name, p in parameters.items()}
    return replace(
        draft,
        parameters=parameters,
        identifiable=identifiable,
        status=status,
        next_experiment=tuple(suggestions(space, parameters, identifiable, comparisons)),
    )


def _parameter(space: Space, i: int, optimum: Optimum, profile: Profile, best: float) -> Parameter:
    def value(coordinate: float) -> float:
        point = optimum.point.copy()
        point[i] = coordinate
        return float(space.to_values(point)[i])

    return Parameter(
        name=space.names[i],
        unit=space.units[i],
        value=best,
        interval=(value(profile.lower.end), value(profile.upper.end)),
        best=best,
        standard_error=float(optimum.errors[i] * space.slopes(optimum.point)[i]),
        profile=tuple((value(x), rise) for x, rise in profile.points),
    )


def _comparisons(
    problem: Problem, optimum: Optimum, whole: Sequence[Experiment], leads: Sequence[float]
) -> tuple[Comparison, ...]:
    result, first = [], 0
    residuals = problem.residual(optimum.point)
    values = problem.space.named(optimum.point)
    for e, all_kept, w, lead, offset in zip(
        problem.experiments, whole, problem.whitenings, leads, problem.offsets(optimum.point), strict=True
    ):
        system = problem.system(optimum.point, e.record)
        run = None if system is None else e.run(system, values.get(DELAY, 0.0))
        assert system is not None
        assert run is not None
        model = values.get(GAIN, 1.0) * run[reading_of(e.record)] + offset
        white = residuals[first : first + e.size][w.weight > 0.0]
        first += e.size
        checked = all_kept.kept & ~e.kept
        checked[: round(lead / e.record.interval)] = False
        checked[: int(np.flatnonzero(e.kept)[-1])] = False
        gaps = {b.label for b in system.graph.branches if isinstance(b.element, Gap)}
        openings = {g: sum(event.element == g and event.after == "open" for event in run.events) for g in gaps}
        result.append(
            Comparison(
                experiment=e,
                model=model,
                offset=offset,
                fitted=e.kept,
                checked=checked,
                whitened=white,
                lead=lead,
                whiteness=ljung_box(white),
                openings=openings,
            )
        )
    return tuple(result)


def ljung_box(white: Matrix) -> float:
    """The p-value of independent residuals, from their first 20 autocorrelations (Ljung and Box 1978)."""
    x, n = np.clip(white - np.median(white), -4.0, 4.0), white.size
    square = max(float(x @ x), 1e-300)
    rho = np.array([float(x[k:] @ x[:-k]) / square for k in range(1, _LAGS + 1)])
    statistic = n * (n + 2.0) * float(np.sum(rho**2 / (n - np.arange(1, _LAGS + 1))))
    return float(chi2.sf(statistic, _LAGS))


def _criterion(problem: Problem, optimum: Optimum) -> float:
    """Schwarz's criterion: -2 log likelihood of the whitened residuals, plus log(samples) for each unknown."""
    n = optimum.samples
    logs = sum(float(np.sum(np.log(w.weight[w.weight > 0.0]))) for w in problem.whitenings)
    return n * math.log(max(optimum.variance, 1e-300)) - 2.0 * logs + math.log(n) * optimum.point.size


def _correlation(covariance: Matrix) -> Matrix:
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    return np.asarray(np.clip(covariance / np.outer(size, size), -1.0, 1.0))


def _status(fit: Fit) -> Status:
    if fit.explained < _ENOUGH:
        return Status(
            StatusKind.INACCURATE,
            f"the model explains {100.0 * max(fit.explained, 0.0):.1f} % of the force only, so none of its parameters "
            f"is that of the device; try a model with other elements, or a record in which the device rattles less",
        )
    if fit.predicted < _ENOUGH:
        changed = 100.0 * min(1.0 - fit.predicted, 1.0)
        return Status(
            StatusKind.INACCURATE,
            f"errors as small as those of the encoder change {changed:.1f} % of the force of this device, so none of "
            f"its parameters can be told; try a record in which it rattles less",
        )
    lost = sum(float(saturated(c.record).mean()) for c in fit.comparisons) / len(fit.comparisons)
    if lost > 0.2:
        return Status(StatusKind.INACCURATE, f"the load cell was saturated in {100.0 * lost:.0f} % of the samples")
    return OK


def _part(progress: Callable[[float], None] | None, first: float, last: float) -> Callable[[float], None] | None:
    return None if progress is None else lambda done: progress(first + (last - first) * done)
