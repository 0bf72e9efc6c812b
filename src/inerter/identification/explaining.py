"""What may be wrong with a model or the sensors where a fit leaves more than sound sensors would.

Each hypothesis is fitted from the best fit on, device and all, to the part that was fitted, and judged by how much of
what was left on the check part it explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import Experiment, experiment_of
from inerter.identification.fit import Explanation, Localisation, Misfit
from inerter.identification.guess import chain_of
from inerter.identification.hypotheses import Hypothesis, Values, sensors
from inerter.identification.intervals import BestFit, best_fit_of, steps_of
from inerter.identification.judging import Judge
from inerter.identification.laws import laws
from inerter.identification.problem import FitProblem
from inerter.identification.recording_faults import faulty_samples, recording_faults
from inerter.identification.space import Space, space_of
from inerter.identification.suspects import Suspect
from inerter.records.lost import losses, restored
from inerter.vehicle.rig import Rig
from inerter.work.progress import report

Matrix = NDArray[np.float64]
_EVALUATIONS, _ACCURACY = 25, 1e-5
_BESIDE = 30  # samples to either side of lost ones, which the put-in motion makes too uncertain to compare
_LITTLE = 0.05  # of the size at which an unknown would be seen, where to begin
_AS_GOOD = 0.02  # of a misfit: what two explanations may differ by and explain as much
_STEP = 0.02  # of what a hypothesis would be seen at, for differences


@dataclass(frozen=True, eq=False)
class Trial:
    """The best fit of a hypothesis."""

    hypothesis: Hypothesis
    problem: FitProblem
    optimum: BestFit


def explanations(
    problem: FitProblem, optimum: BestFit, by: Judge, before: Misfit, places: Sequence[Localisation] = ()
) -> list[Explanation]:
    """Every hypothesis with what it explains of a misfit, the likeliest first; without one, what is known anyway.

    `places` is where the misfit is in each record. Of those that explain about as much, that with fewer unknowns is the
    likelier one.
    """
    found: dict[Suspect, Explanation] = {}
    lost = lost_samples(problem.experiments)
    known = [*([] if lost is None else [lost]), *faulty_samples(problem.experiments)]
    every = known if before.sound else [*known, *hypotheses(problem, places)]
    for tried, hypothesis in enumerate(every):
        report("possible causes", tried, len(every))
        e = _explanation(_tried(problem, optimum, hypothesis, by), by, before)
        if e.name not in found or e.explained > found[e.name].explained:
            found[e.name] = e
    return sorted(found.values(), key=lambda e: (-round(e.explained / _AS_GOOD), len(e.values), -e.explained))


def hypotheses(problem: FitProblem, places: Sequence[Localisation] = ()) -> list[Hypothesis]:
    """All that are not assumed already, and that these records could show."""
    chain = chain_of(problem.rig.device)
    fastest = max(float(np.abs(e.motion.velocity).max()) for e in problem.experiments)
    stroke = max(0.5 * float(np.ptp(e.motion.displacement)) for e in problem.experiments)
    peak = max(float(np.abs(e.record.force[e.kept]).max()) for e in problem.experiments)
    found = [*sensors(problem.offset), *recording_faults(problem, places)]
    found += [] if chain is None else laws(chain, fastest, stroke, peak)
    taken = {h.name for h in problem.assumed}
    return [h for h in found if h.name not in taken]


def lost_samples(experiments: Sequence[Experiment]) -> Hypothesis | None:
    """Samples that the displacement shows to be lost, put in again; None if there are none."""
    whole: dict[int, tuple[Experiment, NDArray[np.bool_]]] = {}
    places = []
    for e in experiments:
        lost = losses(e.record)
        if lost:
            record, measured = restored(e.record, lost)
            whole[id(e.record)] = (replace(experiment_of(record), tally=e.tally), measured)
            places.append(tuple((loss.count, float(e.record.time[loss.after])) for loss in lost))
    if not whole:
        return None

    def moved(e: Experiment, values: Values) -> Experiment:
        return whole[id(e.record)][0] if id(e.record) in whole else e

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        for other, measured in whole.values():
            if other.record is e.record:
                doubtful = np.convolve(~measured, np.ones(2 * _BESIDE + 1), "same") > 0.0
                return np.where(doubtful, other.record.force, force)[measured]
        return force

    return Hypothesis(Suspect.LOST_SAMPLES, moved=moved, read=read, details=lambda values: {"places": tuple(places)})


def _tried(problem: FitProblem, optimum: BestFit, hypothesis: Hypothesis, by: Judge) -> Trial:
    """A hypothesis after some steps from the best fit."""
    assumed = (*problem.assumed, hypothesis)
    rig = problem.rig if hypothesis.device is None else Rig(hypothesis.device)
    space = space_of(rig, assumed)
    other = replace(problem, rig=rig, space=space, assumed=assumed, whitenings=by.fitted, horizon=1.0, systems={})
    known = problem.space.named(optimum.point)
    widths = dict(zip(problem.space.names, steps_of(optimum), strict=True))
    sizes = {u.name: u.size for u in hypothesis.unknowns}
    zero = {u.name: _LITTLE * u.size if u.lower >= 0.0 else 0.0 for u in hypothesis.unknowns}
    trials = []
    begun = {other: known[name] for name, other in hypothesis.alike.items()}
    for start in hypothesis.starts:
        point = space.placed({**known, **zero, **begun, **start})
        seen = {**sizes, **start}
        alike = {other: widths[name] for name, other in hypothesis.alike.items()}
        steps = np.array(
            [widths.get(n) or alike.get(n) or _step(space, i, seen.get(n, 1.0)) for i, n in enumerate(space.names)]
        )
        trials.append(Trial(hypothesis, other, best_fit_of(other, point, steps, _EVALUATIONS, _ACCURACY)))
    return min(trials, key=lambda t: t.optimum.cost)


def _step(space: Space, i: int, size: float) -> float:
    """Of a coordinate that would be seen at this size, for differences."""
    return _STEP if space.lower[i] > 0.0 else _STEP * abs(size) / float(space.upper[i])


def _explanation(trial: Trial, by: Judge, before: Misfit) -> Explanation:
    space, hypothesis = trial.problem.space, trial.hypothesis
    point = trial.optimum.point
    after = by.misfit(trial.problem, point, hypothesis.slow)
    values = space.named(point)
    errors = trial.optimum.errors * space.slopes(point)
    own = {u.name for u in hypothesis.unknowns}
    parts = zip((after.fitted, after.checked), (before.fitted, before.checked), before.limits, strict=True)
    return Explanation(
        name=hypothesis.name,
        explained=min((_explained(now, then) for now, then, limit in parts if then > limit), default=1.0),
        misfit=after,
        values={name: values[name] for name in own},
        estimates={n: (values[n], float(e)) for n, e in zip(space.names, errors, strict=True) if n not in own},
        details=hypothesis.details(values),
    )


def _explained(now: float, then: float) -> float:
    """Part of a misfit that is gone."""
    return 1.0 - max(now**2 - 1.0, 0.0) / (then**2 - 1.0)
