"""Diagnosis of a misfit: possible causes in the model or the sensors where the residual exceeds sensor noise.

Each hypothesis is fitted together with the device, from the best fit, to the estimation data, and assessed by the share
of the residual on the validation data that it explains. All are fitted by a few steps of one simulation each; only the
best of them are fitted to convergence (decision 0056).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment, experiment_of
from inerter.identification.fit import Explanation, Localisation, NormalisedResidual
from inerter.identification.friction_models import law_hypotheses
from inerter.identification.hypotheses import Hypothesis, Values, load_cell, sensor_hypotheses
from inerter.identification.initial_estimate import chain_of
from inerter.identification.intervals import ROBUST, BestFit, best_fit_of, fit_by_secants, robust_cost, steps_of
from inerter.identification.parameter_space import WIDER, Space, space_of
from inerter.identification.problem import FitProblem, map_problems
from inerter.identification.recording_faults import as_measured, faulty_samples, nonlinear_load_cells, recording_faults
from inerter.identification.residual_tests import NoiseReference, scatter_of
from inerter.identification.scales import POWERS
from inerter.identification.search import improve
from inerter.identification.statements.causes import Details, Suspect
from inerter.networks.elements import Element, Free, Network
from inerter.networks.transform import map_elements
from inerter.records.dropouts import find_dropouts, insert_samples
from inerter.vehicle.rig import Rig
from inerter.work.progress import counter
from inerter.work.running import over_threads

Matrix = NDArray[np.float64]
_ROUNDS, _MORE_ROUNDS = 6, 10  # steps of a rough fit from each start, and from where the best of them ended
_ROUGH = 1e-3  # change of the cost at which a rough fit ends
_FITTED = 5  # hypotheses that are fitted to convergence
_EVALUATIONS, _ACCURACY = 25, 1e-5
_FAR = 2.0  # excess of fits that may not have converged, of which so many are restarted ...
_RESTARTED, _FIRST, _FIRST_EVALUATIONS = 3, 1 / 2, 12  # ... over the first part of the information
_DAMPED = 3e-3  # [s] default damping of a shaft over its stiffness
_BESIDE = 30  # samples to either side of dropped ones, where the interpolated motion is too uncertain to compare
_LITTLE = 0.05  # of the detectable size of an unknown: starting value
_AS_GOOD = 0.02  # of a misfit: difference within which two explanations count as equally good
_STEP = 0.02  # of the detectable size of an unknown, for differences
_SEEN, _SURE = 0.1, 30.0  # of a residual that noise may hide: share that is explained, and Fisher's ratio of it
_CLEAR = 20.0  # Fisher's ratio of a nonlinear load cell
_LIKE = 0.5  # of the share of the best explanation of such a residual: another one
_OF_SENSORS = (Suspect.FILTERED_FORCE, Suspect.ASYMMETRIC_GAIN, Suspect.NONLINEAR_GAIN)  # like a law of the device
_DELAYED = (Suspect.CLOCK_DRIFT, Suspect.AVERAGED_FORCE)  # with a delay of their own
_SHAFTS = (Suspect.ELASTIC, Suspect.RIGID, Suspect.BACKLASH)  # a stiff one also changes the errors of the simulation
_UNITS = (  # column of the powers of scales, channel, true unit, unit as read, true value over reading
    (0, "force", "kN", "N", 1e3),
    (0, "force", "N", "kN", 1e-3),
    (1, "displacement", "mm", "m", 1e-3),
    (1, "displacement", "m", "mm", 1e3),
)
_AT_BOUND = 1e-3  # of the range of a coordinate: at its end


class HiddenCause(StrEnum):
    """Causes that a residual within sensor noise may hide."""

    NONE = "none"
    LAW = "law of the device"  # where the noise of the force, as estimated, is too large
    LOAD_CELL = "load cell"  # changes values by more than their errors before its residual exceeds the noise


@dataclass(eq=False)
class Causes:
    """Hypotheses on a misfit. Each process builds them, because their functions cannot be pickled."""

    before: NormalisedResidual
    places: Sequence[Localisation]
    made: list[Hypothesis] | None = None
    point: Matrix | None = None  # the best fit
    hidden: HiddenCause = HiddenCause.NONE

    def of(self, problem: FitProblem) -> list[Hypothesis]:
        """Hypotheses of the problem; without a misfit those that the records show, or on the device if it is hidden."""
        if self.made is None:
            lost = lost_samples(problem.experiments)
            known = [*([] if lost is None else [lost]), *faulty_samples(problem.experiments)]
            if self.hidden is HiddenCause.LAW:
                taken = (*_SHAFTS, *(h.name for h in problem.assumed))
                known = [*laws(problem), *nonlinear_load_cells(problem.experiments)]
                known = [h for h in known if h.name not in taken]
            elif self.hidden is HiddenCause.LOAD_CELL:
                known = nonlinear_load_cells(problem.experiments)
            elif not self.before.is_noise_limited:
                known += hypotheses(problem, self.places)
                known += [] if self.point is None else beyond_bounds(problem, self.point)
            self.made = known
        return self.made

    def __getstate__(self) -> dict[str, object]:
        """State without the hypotheses, which each process builds."""
        return {**vars(self), "made": None}


@dataclass(frozen=True, eq=False)
class Attempt:
    """A hypothesis by its number, the point from which to fit it, the steps there, and the cost reached."""

    number: int
    point: Matrix
    steps: Matrix
    cost: float
    explanation: Explanation


def explanations(
    problem: FitProblem,
    optimum: BestFit,
    by: NoiseReference,
    before: NormalisedResidual,
    places: Sequence[Localisation] = (),
) -> list[Explanation]:
    """Every hypothesis with the share of a misfit that it explains, the most likely first.

    Without a misfit only the hypotheses that the records show and that change a value by more than its standard error,
    and laws that explain much of the residual where the noise of the force is only estimated. `places` localises the
    misfit in each record. All hypotheses are fitted roughly, by secants, and those that explain most are fitted to
    convergence. Of those that explain about as much, that with fewer unknowns is the more likely.
    """
    causes = Causes(before, places, point=optimum.point)
    known = replace(problem, whitenings=by.fitted, horizon=1.0)
    every = causes.of(known)
    slopes = known.jacobian(optimum.point, steps_of(optimum))
    found = _fit_all(causes, by, optimum, slopes, known) if every else []
    if before.is_noise_limited:
        found = [e for e in found if _changes_values(e, problem.space, optimum)]
    if found:
        return found
    hidden = (replace(causes, made=None, hidden=kind) for kind in (HiddenCause.LAW, HiddenCause.LOAD_CELL))
    likely = (c for c in hidden if _is_hidden(known, optimum, slopes, c))
    return next(filter(None, (_fit_all(c, by, optimum, slopes, known) for c in likely)), [])


def _fit_all(
    causes: Causes, by: NoiseReference, optimum: BestFit, slopes: Matrix, known: FitProblem
) -> list[Explanation]:
    """The hypotheses fitted: all of them roughly, and the best to convergence."""
    every, before = causes.of(known), causes.before
    rough = partial(_fit_roughly, causes, by, optimum, slopes)
    first = map_problems(
        rough, [(known, n) for n in range(len(every))], over_threads, counter("possible causes", len(every))
    )
    first.sort(key=lambda attempt: attempt.cost)
    best = first[:_FITTED]
    last = map_problems(
        partial(_fit_fully, causes, by), [(known, a) for a in best], map, counter("likely causes", len(best))
    )
    last.sort(key=lambda attempt: attempt.cost)
    if last and not before.is_noise_limited and all(a.explanation.misfit.excess > _FAR for a in last):
        restart = partial(_refit_from_stiff_shaft, causes, by)
        again = map_problems(
            restart, [(known, a) for a in last[:_RESTARTED]], map, counter("stiffer shafts", _RESTARTED)
        )
        last[:_RESTARTED] = again
    return _rank([a.explanation for a in (*last, *first[_FITTED:])], causes.hidden)


def _changes_values(e: Explanation, space: Space, optimum: BestFit) -> bool:
    """Whether a value differs under the hypothesis by more than its standard error."""
    values, errors = space.to_values(optimum.point), optimum.errors * space.slopes(optimum.point)
    known = zip(space.names, values, errors, strict=True)
    return any(not abs(e.estimates[name][0] - value) <= error for name, value, error in known if name in e.estimates)


def _rank(every: Sequence[Explanation], hidden: HiddenCause) -> list[Explanation]:
    """One explanation of each name, the most likely first; of a misfit that noise hides, those that explain much."""
    found: dict[Suspect, Explanation] = {}
    for e in every:
        if e.name not in found or e.explained > found[e.name].explained:
            found[e.name] = e
    ranked = sorted(found.values(), key=_likelihood)
    names = [e.name for e in ranked]
    # Clocks that differ may have begun apart, and an average may be late: a delay that explains as much is both.
    ranked = [e for i, e in enumerate(ranked) if e.name not in _DELAYED or Suspect.DELAY not in names[:i]]
    if hidden is HiddenCause.NONE or not ranked:
        return ranked
    if ranked[0].name is Suspect.FILTERED_FORCE:  # in place of a delay: intervals contain its values already
        return []
    least = _SEEN if hidden is HiddenCause.LAW else 0.0
    return [e for e in ranked if e.explained > max(least, _LIKE * ranked[0].explained)]


def _is_hidden(problem: FitProblem, optimum: BestFit, slopes: Matrix, causes: Causes) -> bool:
    """Whether one of the causes explains, to first order, some of a residual within sensor noise more than by chance.

    The share that it explains, and Fisher's ratio of it, do not depend on the noise that is expected. Of a law of the
    device the share has to be large, where the noise is not stated; a nonlinear load cell has to change a value by more
    than its standard error, as one that no residual shows may change it by many.
    """
    if causes.hidden is HiddenCause.LAW and all(e.record.force_noise is not None for e in problem.experiments):
        return False
    base = np.linalg.qr(slopes)[0]

    def project(values: Matrix) -> Matrix:
        return np.asarray(values - base @ (base.T @ values))

    residual = problem.residual(optimum.point)
    left = project(residual)
    square = float(left @ left)
    competing = _OF_SENSORS if causes.hidden is HiddenCause.LAW else ()
    for hypothesis in (h for h in causes.of(problem) if h.name not in competing):
        other = _with_hypothesis(problem, hypothesis)
        for point, _ in _starting_points(problem, optimum, other, hypothesis):
            change = other.residual(point) - residual
            way = project(change)
            length = max(float(way @ way), 1e-300)
            gain = float(left @ way) ** 2 / length
            ratio = gain * optimum.samples / max(square - gain, 1e-300)
            if causes.hidden is HiddenCause.LAW:
                found = gain > _SEEN * square and ratio > _SURE
            else:
                by = float(left @ way) / length * np.linalg.lstsq(slopes, change)[0]
                found = ratio > _CLEAR and bool(np.any(np.abs(by) > optimum.errors))
            if found:
                return True
    return False


def _likelihood(e: Explanation) -> tuple[int, int, float]:
    """Key by which the most likely explanation comes first."""
    return -round(e.explained / _AS_GOOD), len(e.values) + len(e.estimates), -e.explained


def hypotheses(problem: FitProblem, places: Sequence[Localisation] = ()) -> list[Hypothesis]:
    """All hypotheses that are not assumed already and that these records could show."""
    stated = {bandwidth for e in problem.experiments if (bandwidth := e.record.force_bandwidth) is not None}
    cells = [load_cell(bandwidth) for bandwidth in sorted(stated)]
    found = [*sensor_hypotheses(problem.offset), *cells, *recording_faults(problem, places), *laws(problem)]
    taken = {h.name for h in problem.assumed}
    return [h for h in found if h.name not in taken]


def laws(problem: FitProblem) -> list[Hypothesis]:
    """Hypotheses on the device, and that on a load cell of unstated bandwidth, which acts like some of them."""
    chain = chain_of(problem.rig.device)
    fastest = max(float(np.abs(e.motion.velocity).max()) for e in problem.experiments)
    stroke = max(0.5 * float(np.ptp(e.motion.displacement)) for e in problem.experiments)
    peak = max(float(np.abs(e.record.force[e.kept]).max()) for e in problem.experiments)
    found = [load_cell()] if any(e.record.force_bandwidth is None for e in problem.experiments) else []
    return found if chain is None else [*found, *law_hypotheses(chain, fastest, stroke, peak)]


def beyond_bounds(problem: FitProblem, point: Matrix) -> list[Hypothesis]:
    """Hypothesis of wider bounds for the values that end at a bound of the search; none without such values.

    A lower bound of zero is none of the search.
    """
    space = problem.space
    lower, upper = space.bounds
    near = _AT_BOUND * (upper - lower)
    ends = [
        (name, unit, float(bound), above)
        for above, at, bounds in (
            (True, point >= upper - near, space.upper),
            (False, point <= lower + near, space.lower),
        )
        for name, unit, kind, there, bound in zip(space.names, space.units, space.kinds, at, bounds, strict=True)
        if kind is not None and there and bound > 0.0
    ]
    wider = {name: (above, WIDER if above else 1.0 / WIDER) for name, _, _, above in ends}

    def widen(element: Element) -> Network:
        value = element.value
        if not isinstance(value, Free) or value.name not in wider:
            return element
        above, by = wider[value.name]
        return element.with_value(
            replace(value, upper=by * value.upper) if above else replace(value, lower=by * value.lower)
        )

    device = map_elements(problem.rig.device, widen)

    def details(values: Values) -> Details:
        return {"values": tuple(ends), "units": tuple(_units_within_bounds(space, values))}

    return [Hypothesis(Suspect.BEYOND_BOUNDS, device=device, details=details)] if ends else []


def _units_within_bounds(space: Space, values: Values) -> Iterator[tuple[str, str, str, tuple[tuple[str, float], ...]]]:
    """Wrong units with which all values are within the bounds of their search: channel, true unit and that read."""
    for column, role, true, read, factor in _UNITS:
        scaled = {
            name: values[name] * factor ** POWERS[kind.linear][column]
            for name, kind in zip(space.names, space.kinds, strict=True)
            if kind is not None
        }
        bounds = zip(space.names, space.lower, space.upper, strict=True)
        if all(lower <= scaled[name] <= upper for name, lower, upper in bounds if name in scaled):
            yield role, true, read, tuple(scaled.items())


def lost_samples(experiments: Sequence[Experiment]) -> Hypothesis | None:
    """Hypothesis of dropped samples that the displacement shows, interpolated; None if there are none."""
    whole: dict[int, tuple[Experiment, NDArray[np.bool_]]] = {}
    places = []
    for e in experiments:
        lost = find_dropouts(e.record)
        if lost:
            record, measured = insert_samples(e.record, lost)
            whole[id(e.record)] = (replace(experiment_of(record, rigid=e.rigid), tally=e.tally), measured)
            places.append(tuple((loss.count, float(e.record.time[loss.after])) for loss in lost))
    if not whole:
        return None

    def change_motion(e: Experiment, values: Values) -> Experiment:
        return whole[id(e.record)][0] if id(e.record) in whole else e

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        for other, measured in whole.values():
            if other.record is e.record:
                doubtful = np.convolve(~measured, np.ones(2 * _BESIDE + 1), "same") > 0.0
                return as_measured(force, other.record.force, doubtful[: force.size])[measured[: force.size]]
        return force

    return Hypothesis(
        Suspect.LOST_SAMPLES, change_motion=change_motion, read=read, details=lambda values: {"places": tuple(places)}
    )


def _with_hypothesis(problem: FitProblem, hypothesis: Hypothesis) -> FitProblem:
    """The problem with one further hypothesis."""
    assumed = (*problem.assumed, hypothesis)
    if hypothesis.device is None:
        return replace(problem, space=space_of(problem.rig, assumed), assumed=assumed)
    rig = Rig(hypothesis.device)
    return replace(problem, rig=rig, space=space_of(rig, assumed), assumed=assumed, systems={})


def _fit_roughly(
    causes: Causes, by: NoiseReference, optimum: BestFit, slopes: Matrix, problem: FitProblem, number: int
) -> Attempt:
    """The best of a few steps from each start of a hypothesis, and further ones with derivatives at its end.

    At the starts derivatives by the parameters of the model are those at its best fit, unless the device is another
    one.
    """
    hypothesis = causes.of(problem)[number]
    other = _with_hypothesis(problem, hypothesis)
    names, space = problem.space.names, other.space
    shared = [n for n in space.names if n in names and hypothesis.device is None]
    own = [i for i, n in enumerate(space.names) if n not in shared]
    found = []
    for point, steps in _starting_points(problem, optimum, other, hypothesis):
        jacobian = np.zeros((slopes.shape[0], len(space.names)))
        jacobian[:, [i for i, n in enumerate(space.names) if n in shared]] = slopes[:, [names.index(n) for n in shared]]
        if own:
            jacobian[:, own] = other.jacobian(point, steps, own)
        found.append((fit_by_secants(other, point, jacobian, _ROUNDS, _ROUGH), steps))
    fit, steps = min(found, key=lambda f: f[0].cost)
    if own:
        again = fit_by_secants(other, fit.point, other.jacobian(fit.point, steps), _MORE_ROUNDS, _ROUGH)
        fit = min(fit, again, key=lambda f: f.cost)
    return Attempt(number, fit.point, steps, fit.cost, _explanation(other, fit, hypothesis, by, causes))


def _fit_fully(causes: Causes, by: NoiseReference, problem: FitProblem, attempt: Attempt) -> Attempt:
    """The attempt fitted to convergence."""
    hypothesis = causes.of(problem)[attempt.number]
    other = _with_hypothesis(problem, hypothesis)
    fit = best_fit_of(other, attempt.point, attempt.steps, _EVALUATIONS, _ACCURACY)
    return replace(
        attempt, point=fit.point, cost=fit.cost, explanation=_explanation(other, fit, hypothesis, by, causes)
    )


def _refit_from_stiff_shaft(causes: Causes, by: NoiseReference, problem: FitProblem, attempt: Attempt) -> Attempt:
    """The attempt refitted from a stiff shaft, first over the first part of the records; or the attempt if better."""
    other = _with_hypothesis(problem, causes.of(problem)[attempt.number])
    start = _with_stiff_shaft(other, attempt.point)
    if start is None:
        return attempt
    first = replace(other, horizon=_FIRST)
    point, _, _, _ = improve(first, start, _FIRST_EVALUATIONS, attempt.steps, ROBUST, _ROUGH)
    if robust_cost(other.residual(point)) >= attempt.cost:
        return attempt
    return min(attempt, _fit_fully(causes, by, problem, replace(attempt, point=point)), key=lambda a: a.cost)


def _with_stiff_shaft(problem: FitProblem, point: Matrix) -> Matrix | None:
    """The point with a shaft half-way to the stiffest one, in logarithms; None for a device without a free shaft.

    A wrong model may have ended with a far too compliant shaft, separated from the right one by further local minima;
    from a stiff one the cost decreases.
    """
    chain = chain_of(problem.rig.device)
    spring, damper = (None, None) if chain is None else (chain.spring, chain.damper)
    if spring is None or not isinstance(spring.value, Free):
        return None
    values = problem.space.values_by_name(point)
    stiffness = math.sqrt(values[str(spring.value.name)] * spring.value.upper)
    values[str(spring.value.name)] = stiffness
    if damper is not None and isinstance(damper.value, Free):
        values[str(damper.value.name)] = _DAMPED * stiffness
    return problem.space.coordinates_of(values)


def _starting_points(
    problem: FitProblem, optimum: BestFit, other: FitProblem, hypothesis: Hypothesis
) -> Iterator[tuple[Matrix, Matrix]]:
    """Starting points of a fit, and the steps of differences there."""
    space, known = other.space, problem.space.values_by_name(optimum.point)
    widths = dict(zip(problem.space.names, steps_of(optimum), strict=True))
    sizes = {u.name: u.size for u in hypothesis.unknowns}
    zero = {u.name: _LITTLE * u.size if u.lower >= 0.0 else 0.0 for u in hypothesis.unknowns}
    begun = {other: known[name] for name, other in hypothesis.counterparts.items()}
    equal = {other: widths[name] for name, other in hypothesis.counterparts.items()}
    for start in hypothesis.starts:
        seen = {**sizes, **start}
        steps = [
            widths.get(n) or equal.get(n) or _difference_step(space, i, seen.get(n, 1.0))
            for i, n in enumerate(space.names)
        ]
        yield space.coordinates_of({**known, **zero, **begun, **start}), np.array(steps)


def _difference_step(space: Space, i: int, size: float) -> float:
    """Step of a coordinate for differences, from its detectable size."""
    return _STEP if space.lower[i] > 0.0 else _STEP * abs(size) / float(space.upper[i])


def _explanation(
    problem: FitProblem, fit: BestFit, hypothesis: Hypothesis, by: NoiseReference, causes: Causes
) -> Explanation:
    space, point, before = problem.space, fit.point, causes.before
    after = by.misfit(problem, point, hypothesis.slow)
    values = space.values_by_name(point)
    errors = fit.errors * space.slopes(point)
    own = {u.name for u in hypothesis.unknowns}
    parts = list(zip((after.fitted, after.checked), (before.fitted, before.checked), before.limits, strict=True))
    shares = [_explained_share(now, then) for now, then, limit in parts if then > limit]
    if causes.hidden is not HiddenCause.NONE:
        # Fisher's ratio has shown the load cell already, of which the validation data may be too few to show anything:
        # the residual there need not get smaller, but it does not grow by more than its scatter.
        agrees = after.checked <= before.checked * (1.0 + scatter_of(before.limits[1]))
        counted = parts[:1] if causes.hidden is HiddenCause.LOAD_CELL and agrees else parts
        shares = [1.0 - (now / then) ** 2 for now, then, _ in counted if then > 0.0]
    return Explanation(
        name=hypothesis.name,
        explained=min(shares, default=1.0),
        misfit=after,
        values={name: values[name] for name in own},
        estimates={n: (values[n], float(e)) for n, e in zip(space.names, errors, strict=True) if n not in own},
        details=hypothesis.details(values),
    )


def _explained_share(now: float, then: float) -> float:
    """Share of a squared misfit that is explained."""
    return 1.0 - max(now**2 - 1.0, 0.0) / (then**2 - 1.0)
