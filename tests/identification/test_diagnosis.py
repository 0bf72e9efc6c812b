"""All causes of a misfit are tried at little cost, the likeliest are fitted to the end, and steps say what is tried."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest
from campaigns import sampled
from faulty_rig import model, record_of
from numpy.typing import NDArray
from quick_fits import explained, quick_fit
from scipy.optimize import least_squares
from test_further_causes import CAUSES, rig_under

import inerter as it
from inerter.identification.diagnosis import Causes, hypotheses
from inerter.identification.fit import NormalisedResidual
from inerter.identification.intervals import fit_by_secants, robust_cost
from inerter.identification.problem import map_problems
from inerter.work.running import over_threads

Matrix = NDArray[np.float64]


@dataclass
class Curve:
    """Residuals of a curve a exp(-b t) + c t^2 against data, as a fit asks for them."""

    seed: int
    upper: float = 10.0
    asked: list[Matrix] = field(default_factory=list)

    def __post_init__(self) -> None:
        random = np.random.default_rng(self.seed)
        self.t = np.linspace(0.0, 2.0, 400)
        self.truth = random.uniform([1.0, 0.5, -1.0], [3.0, 2.0, 1.0])
        self.data = self.curve(self.truth) + 0.01 * random.standard_normal(400)
        self.space = SimpleNamespace(bounds=(np.full(3, -10.0), np.full(3, self.upper)))
        self.whitenings = [SimpleNamespace(weight=np.ones(400))]

    def curve(self, p: Matrix) -> Matrix:
        return np.asarray(p[0] * np.exp(-p[1] * self.t) + p[2] * self.t**2)

    def residual(self, p: Matrix) -> Matrix:
        self.asked.append(p)
        return (self.curve(p) - self.data) / 0.01

    def jacobian(self, p: Matrix) -> Matrix:
        e = np.exp(-p[1] * self.t)
        return np.stack([e, -p[0] * self.t * e, self.t**2], axis=1) / 0.01


@pytest.mark.parametrize("seed", range(5))
def test_secants_reach_the_least_squares_from_derivatives_of_elsewhere(seed: int) -> None:
    """With one simulation a step, from derivatives that are 10 to 20 % off."""
    curve = Curve(seed)
    start = curve.truth * 1.2
    found = fit_by_secants(curve, start, curve.jacobian(1.1 * start), 15, 1e-6)  # type: ignore[arg-type]
    best = least_squares(curve.residual, curve.truth, jac=curve.jacobian, loss="soft_l1", f_scale=3.0)
    assert found.point == pytest.approx(best.x, rel=2e-3)
    assert found.cost == pytest.approx(best.cost, rel=1e-3)
    assert found.cost < 0.01 * robust_cost(curve.residual(start))


def test_secants_stay_within_bounds() -> None:
    curve = Curve(1, upper=0.8)
    start = np.array([0.7, 0.7, 0.1])
    found = fit_by_secants(curve, start, curve.jacobian(start), 12, 1e-6)  # type: ignore[arg-type]
    assert all(np.all(p <= 0.8 + 1e-9) for p in curve.asked)
    assert found.point.max() == pytest.approx(0.8)


def test_work_within_work_over_threads_comes_to_an_end() -> None:
    """More items than threads, each of which comes apart once more."""
    inner = [list(row) for row in over_threads(lambda n: list(over_threads(lambda m: n * m, range(5))), range(40))]
    assert inner == [[n * m for m in range(5)] for n in range(40)]


@pytest.mark.campaign
def test_steps_say_what_an_identification_does() -> None:
    """From the first moment on, and in order; what is prepared has a name too."""
    record = it.VirtualRig(it.Inerter(113.0) | it.Friction(10.0)).run(it.cosine(2e-3, 3.0), duration=0.6)
    seen: list[it.ProgressStep] = []
    with it.progress(seen.append):
        it.identify(record, "friction", starts=8)
    names = list(dict.fromkeys(step.what for step in seen))
    wanted = [
        *("smoothing of records", "first guess", "starting points", "search, stage 1 of 5: start"),
        *("search, stage 5 of 5: start", "refinement", "bootstrap", "sides of intervals", "next experiment"),
    ]
    assert [name for name in names if name in wanted] == wanted
    assert all(step.total for step in seen if step.what in wanted)
    assert sum(step.what == "preparing" for step in seen) <= 1


@pytest.mark.campaign
def test_causes_are_made_anew_in_another_process() -> None:
    """What a hypothesis does to a force cannot be sent; what it is about can."""
    rig, fault = rig_under("quadratic")
    values = {"b": rig.b, "f": rig.f, "ks": rig.ks, "cs": rig.cs}
    problem = quick_fit(record_of(rig, fault, 0), model(rig), values).problem
    causes = Causes(NormalisedResidual(9.0, 9.0, (1.1, 1.1)), ())
    here = [h.name for h in causes.of(problem)]
    there, other = pickle.loads(pickle.dumps((causes, problem)))
    assert there.made is None
    assert [h.name for h in there.of(other)] == here
    assert map_problems(lambda p, n: there.of(p)[n].name, [(other, n) for n in range(len(here))]) == here


@pytest.mark.marathon
def test_trying_all_causes_takes_few_simulations() -> None:
    """Some thirty causes with fifty starts, of which the best five are fitted to the end."""
    rig, fault = rig_under("stiffening")
    solution = quick_fit(record_of(rig, fault, 0), model(rig), {"b": rig.b, "f": rig.f, "ks": rig.ks, "cs": rig.cs})
    (experiment,) = solution.problem.experiments
    before = experiment.tally.total
    found, _ = explained(solution)
    assert len(found) >= len({h.name for h in hypotheses(solution.problem)})
    assert experiment.tally.total - before < 1500


@pytest.mark.marathon
@pytest.mark.parametrize(("name", "seed"), sampled([(n, s) for n in ("quadratic", "ripple") for s in range(3)], kept=0))
def test_a_law_explains_the_misfit_it_makes(name: str, seed: int) -> None:
    """Down to the noise, also where the model without it is at best with a shaft that is far too soft."""
    rig, fault = rig_under(name)
    values = {"b": rig.b, "f": rig.f, "ks": rig.ks, "cs": rig.cs}
    found, _ = explained(quick_fit(record_of(rig, fault, seed), model(rig), values))
    cause = next(e for e in found if e.name is CAUSES[name])
    assert cause.explained > 0.98
    for parameter, (value, _) in cause.estimates.items():
        assert value == pytest.approx(values[parameter], rel=0.05)
