"""Fits from values that are nearly right on, without search, profiles and bootstrap: what explains their misfit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from inerter.identification.conclusions import _comparisons
from inerter.identification.diagnosis import explanations
from inerter.identification.experiment import experiment_of
from inerter.identification.fit import Explanation, Localisation
from inerter.identification.hypotheses import Hypothesis
from inerter.identification.intervals import best_fit_of
from inerter.identification.localising import localisation_of
from inerter.identification.models import is_rigid
from inerter.identification.noise import uniform_whitening
from inerter.identification.options import FitOptions
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.residual_tests import check_parts, noise_reference
from inerter.identification.solving import SolvedFit, _without_validation_part
from inerter.identification.sticking import Adhesion
from inerter.networks.elements import Network
from inerter.records.record import Record
from inerter.vehicle.rig import Rig


def quick_fit(
    record: Record, model: Network, values: Mapping[str, float], assumed: tuple[Hypothesis, ...] = ()
) -> SolvedFit:
    """The best fit near these values, judged as `identify` judges it."""
    rig, whole = Rig(model), [experiment_of(record, rigid=is_rigid(model))]
    space = space_of(rig, assumed)
    experiments = _without_validation_part(whole, 0.2)
    problem = FitProblem(
        rig, space, experiments, [uniform_whitening(e.kept, 1.0) for e in experiments], assumed=assumed
    )
    optimum = best_fit_of(problem, space.coordinates_of(values), evaluations=40)
    lead = float(experiments[0].record.time[int(experiments[0].kept.argmax())] - record.time[0])
    checked = tuple(check_parts(experiments, whole, [lead]))
    judge = noise_reference(problem, optimum.point, checked, 0)
    assert judge is not None
    problem = replace(problem, whitenings=judge.fitted, systems={})
    optimum = best_fit_of(problem, optimum.point, evaluations=40)
    misfit = judge.misfit(problem, optimum.point)
    return SolvedFit(
        problem=problem, optimum=optimum, profiles=(), checked=checked, leads=(lead,), costs=(), findings=(),
        predicted=1.0, judge=judge, misfit=misfit, options=FitOptions(), adhesion=Adhesion({}), scales=None,
        noisy=np.zeros(optimum.point.size, dtype=bool),
    )  # fmt: skip


def explained(solution: SolvedFit) -> tuple[list[Explanation], Localisation]:
    """What explains the misfit of a fit to one record, and where it is."""
    (comparison,) = _comparisons(solution)
    place = localisation_of(comparison)
    found = explanations(solution.problem, solution.optimum, solution.judge, solution.misfit, [place])
    return found, place
