"""An identification on other processes is the same to the last digit; a problem remembers nothing of what was asked."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from folders import EXAMPLES
from quick_fits import quick_fit

import inerter as it
from inerter.files.rig.loading import load_rig
from inerter.identification.models import MODELS
from inerter.identification.problem import FitProblem
from inerter.records.record import Record
from inerter.work.processes import Processes


@pytest.fixture(scope="module")
def record() -> Record:
    request = load_rig(EXAMPLES / "rig_fit.toml")
    return replace(request, duration=0.6).run()


@pytest.fixture(scope="module")
def problem(record: Record) -> FitProblem:
    """Which a fit has asked already."""
    values = {"ks": 1e6, "cs": 3200.0, "gap": 1e-6, "b": 113.0, "f": 10.0}
    return quick_fit(record, MODELS["ball-screw"], values).problem


@pytest.mark.marathon
def test_an_identification_on_other_processes_is_the_same(record: Record) -> None:
    with Processes(2) as processes:
        there = it.identify(record, "friction", starts=8, executor=processes)
    here = it.identify(record, "friction", starts=8)
    assert repr(there.parameters) == repr(here.parameters)
    assert there.simulations == here.simulations > 100
    assert there.misfit == here.misfit


@pytest.mark.parametrize("gap", sampled([0.0, 1e-16, 1e-10, 0.5], often=[1e-16], kept=0))
def test_residuals_do_not_depend_on_what_was_asked_before(problem: FitProblem, gap: float) -> None:
    """A gap beyond what can be computed with, which a search comes by, is refused when such a system is made first."""
    lower, upper = problem.space.bounds
    point = np.where(np.array(problem.space.names) == "gap", gap, 0.5 * (lower + upper))
    fresh: FitProblem = pickle.loads(pickle.dumps(problem))
    assert problem.systems
    assert not fresh.systems
    assert fresh.residual(point).tobytes() == problem.residual(point).tobytes()
    assert fresh.residual(point).tobytes() == problem.residual(point).tobytes()
    assert all(force is not None for force in fresh.forces(point))
