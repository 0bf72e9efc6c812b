"""Frictions that never slip: intervals of the shaft are those of a spring and damper, and f has a lower end."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from scipy.stats import binom
from troubled_records import model_of, record_of, sticking

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.intervals import best_fit_of
from inerter.identification.noise import uniform_whitening
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.statements.identifiability import Verdict
from inerter.identification.sticking import profiles_at_rest, with_adhesion

KS, CS, LEVEL = 2e4, 300.0, 0.12
SHAFT = it.Spring(it.free(1e3, 1e7, name="ks")) | it.Damper(it.free(1, 2e4, name="cs"))
MODEL = SHAFT - (it.Inerter(it.free(1, 500, name="b")) | it.Friction(it.free(0, 500, name="f")))
HELD = 2.0 * 1.25e-3 * abs(KS + 2j * np.pi * CS)  # [N] from the end at which the table starts to the other


def problem(seed: int, friction: float, model: it.Network = MODEL) -> FitProblem:
    """A slow cosine of 1.25 mm under a device with this friction."""
    device = it.Rig(MODEL).with_values({"ks": KS, "cs": CS, "b": 50.0, "f": friction}).device
    record = it.VirtualRig(device, seed=seed, sampling=500.0).run(it.cosine(1.25e-3, 1.0), duration=2.0)
    experiment, rig = experiment_of(record), it.Rig(model)
    return FitProblem(rig, space_of(rig), [experiment], [uniform_whitening(experiment.kept, LEVEL)])


def widths(seed: int, start: float) -> tuple[np.ndarray, tuple[float, float], float]:
    """Of ks and cs, over 3.92 of their standard errors; the interval of f; and the largest force held."""
    fit = problem(seed, 2.0 * HELD)
    near = fit.space.coordinates_of({"ks": 1.0005 * KS, "cs": CS, "b": 400.0, "f": start})
    optimum, adhesion = with_adhesion(fit, best_fit_of(fit, near))
    assert adhesion
    found = profiles_at_rest(fit, optimum, adhesion)
    shaft = np.array([p.upper.end - p.lower.end for p in found[:2]])
    assert not found[3].upper.known
    low, high = (float(v) * 500.0 for v in (found[3].lower.end, found[3].upper.end))
    assert [side.known for side in (found[2].lower, found[2].upper)] == [False, False]
    (held,) = adhesion.held.values()
    return shaft, (low, high), held


@pytest.mark.campaign
def test_like_records_have_like_widths_wherever_the_search_ended() -> None:
    """On the plateau, and on the edge where the device slips by a hair."""
    shaft = it.Rig(SHAFT)
    for seed, start in ((1, 0.998 * HELD), (2, 300.0), (3, 0.9995 * HELD)):
        found, (low, high), held = widths(seed, start)
        alone = problem(seed, 2.0 * HELD, SHAFT)
        reference = best_fit_of(alone, alone.space.coordinates_of({"ks": KS, "cs": CS}))
        assert found == pytest.approx(2.0 * 1.96 * reference.errors, rel=0.1)  # of a spring and damper alone
        assert held == pytest.approx(HELD, rel=0.02)
        assert 0.95 * held < low <= held
        assert high == pytest.approx(500.0)
    assert len(shaft.free_values()) == 2


@pytest.mark.parametrize("part", [0.5, 0.9])
def test_a_device_that_slips_is_not_held(part: float) -> None:
    fit = problem(4, part * HELD)
    optimum = best_fit_of(fit, fit.space.coordinates_of({"ks": KS, "cs": CS, "b": 50.0, "f": part * HELD}))
    same, adhesion = with_adhesion(fit, optimum)
    assert not adhesion
    assert same is optimum


@pytest.mark.parametrize("number", sampled(range(4), kept=0))
def test_a_friction_that_never_slipped_is_known_from_below(number: int) -> None:
    """By a simulator that shares no code with the package."""
    case = sticking(number)
    record = record_of(case, number).trim(0.0, 1.5)
    fit = it.identify(record, model_of(case), starts=8)
    assert fit.identifiable["f"].verdict is Verdict.ABOVE
    low, high = fit.parameters["f"].interval
    assert 0.8 * np.abs(record.force).max() < low <= case.device.f < high
    assert "It never slipped" in fit.identifiable["f"].sentence
    for name in ("ks", "cs"):
        p = fit.parameters[name]
        assert (p.interval[1] - p.interval[0]) / p.standard_error == pytest.approx(3.92, rel=0.1)


@pytest.mark.marathon
@pytest.mark.timeout(3600)
def test_intervals_of_devices_that_stick_hold_the_truth() -> None:
    held = []
    for number in range(60):
        case = sticking(number)
        fit = it.identify(record_of(case, number), model_of(case), starts=8)
        for name, p in fit.parameters.items():
            if fit.identifiable[name]:
                held.append(p.interval[0] <= case.truth[name] <= p.interval[1])
        assert fit.parameters["f"].interval[0] <= case.device.f
    assert sum(held) >= binom.ppf(0.025, len(held), 0.95)
