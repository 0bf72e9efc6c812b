"""Wrong models and faulty sensors, by a simulator that shares no code with the package: what `identify` says of them.

A sample here; more behind the marker `campaign`, and all in benchmarks/identification_troubles.py.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from scipy.stats import binom
from troubled_records import Case, clean, fits_fault, model_of, record_of, troubled
from troubled_rig import Device, Sensors, Tones, device_force, measured

import inerter as it
from inerter.identification.diagnosis import hypotheses
from inerter.identification.experiment import Experiment, experiment_of
from inerter.identification.friction_models import ChainValues, simulate_chain
from inerter.identification.hypotheses import delay
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.residual_tests import mean_square
from inerter.identification.statements.identifiability import Verdict

STARTS = 8


def fitted(case: Case, seed: int, **settings: object) -> it.Fit:
    return it.identify(record_of(case, seed), model_of(case), starts=STARTS, **settings)


def missed(fit: it.Fit, truth: dict[str, float]) -> list[str]:
    """Parameters whose interval, or range under explanations, is given and does not hold the truth."""
    given = [
        name
        for name, verdict in fit.identifiable.items()
        if (verdict or verdict.verdict is Verdict.CONDITIONAL) and name in truth
    ]
    return [n for n in given if not fit.parameters[n].interval[0] <= truth[n] <= fit.parameters[n].interval[1]]


def said_of(fit: it.Fit) -> list[tuple[str, str]]:
    return [(e.name, e.sentence) for e in fit.explanations[:2]]


def judged(number: int) -> tuple[bool, bool]:
    """Whether a faulty record is warned of or harmless, and whether its fault is named."""
    case = troubled(number)
    fit = fitted(case, number)
    named = case.fault == "fixture" or fits_fault(case.fault, said_of(fit), list(fit.notes))
    return not (fit.status.ok and missed(fit, case.truth)), named


NAMED = [(9, 1.5), (0, 5.0), (5, 5.0), (8, 5.0)]


@pytest.mark.parametrize(("number", "duration"), sampled(NAMED, kept=0))
def test_a_fault_is_named_and_no_wrong_interval_is_given_without_a_warning(number: int, duration: float) -> None:
    """Stribeck friction, a late displacement, lost samples and a drift."""
    case = replace(troubled(number), duration=duration)
    fit = fitted(case, number)
    assert not fit.status.ok
    assert fits_fault(case.fault, said_of(fit), [])
    assert fit.explanations[0].sentence in fit.status.message
    assert fit.misfit.excess > 1.0
    assert missed(fit, case.truth) == []


@pytest.mark.marathon
@pytest.mark.timeout(1800)
def test_faults_of_some_kinds() -> None:
    said = [judged(number) for number in (1, 4, 7, 10)]
    assert all(fair for fair, _ in said)
    assert sum(named for _, named in said) >= 3


@pytest.mark.parametrize("number", sampled([0, 2], seldom=[2]))
def test_a_sound_rig_is_not_warned_of_and_its_intervals_hold_the_truth(number: int) -> None:
    """A rigid device and one with backlash, of those whose intervals of 95 % all hold it."""
    case = replace(clean(number)[0], duration=1.5)
    fit = fitted(case, number)
    assert fit.status.ok, fit.status
    assert all(fit.identifiable.values())
    assert missed(fit, case.truth) == []


@pytest.mark.marathon
@pytest.mark.timeout(1800)
def test_sound_rigs_are_not_warned_of_and_intervals_miss_no_more_often_than_they_say() -> None:
    given, lost = 0, []
    for number in range(4):
        case = clean(number)[0]
        fit = fitted(case, number)
        assert fit.status.ok, (number, fit.status)
        given += sum(map(bool, fit.identifiable.values()))
        lost += [(number, name) for name in missed(fit, case.truth)]
    assert len(lost) <= binom.ppf(0.95, given, 0.05), lost


RIGID = Case(
    Device(80.0, 25.0, c=40.0),
    Tones((3e-3, 1.5e-3, 5e-4, 2e-4, 1e-4), (0.5, 1.1, 2.3, 4.1, 7.3), (0.0, 1.0, 2.0, 3.0, 4.0)),
    Sensors(force_noise=0.5),
    "rigid",
    duration=4.0,
)


@pytest.mark.marathon
def test_a_rigid_device_is_fitted_down_to_the_noise_of_the_cell() -> None:
    """Its force is that of the motion itself, so least squares on the true motion is a second way."""
    fit = fitted(RIGID, 1)
    assert fit.status.ok, fit.status
    moving = fit.comparisons[0].fitted & (np.abs(fit.comparisons[0].experiment.motion.velocity) > 2e-3)
    assert np.std(fit.comparisons[0].residual[moving]) < 1.1 * 0.5
    assert missed(fit, RIGID.truth) == []
    record = record_of(RIGID, 1)
    filtered = replace(RIGID, sensors=replace(RIGID.sensors, force_noise=0.0, force_step=1e-9))
    parts = [
        record_of(replace(filtered, device=replace(RIGID.device, **{"b": 0.0, "f": 0.0, "c": 0.0, name: 1.0})), 1).force
        for name in ("b", "f", "c")
    ]
    columns = np.column_stack([*parts, np.ones(record.time.size)])[fit.comparisons[0].fitted]
    best = np.linalg.lstsq(columns, record.force[fit.comparisons[0].fitted])[0]
    for name, value in zip("bfc", best, strict=False):
        p = fit.parameters[name]
        assert abs(p.value - value) < p.interval[1] - p.interval[0]


HEAVY = replace(RIGID, sensors=replace(RIGID.sensors, fixture=4.0))


@pytest.mark.marathon
def test_a_known_fixture_is_taken_away() -> None:
    known = fitted(HEAVY, 2)
    assert known.status.ok
    assert missed(known, HEAVY.truth) == []
    assert not any("fixture_mass" in note for note in known.notes)


@pytest.mark.marathon
def test_an_unknown_fixture_is_spoken_of() -> None:
    record = replace(record_of(HEAVY, 2), fixture_mass=None)
    unknown = it.identify(record, model_of(HEAVY), starts=STARTS)
    assert unknown.parameters["b"].value == pytest.approx(84.0, abs=0.5)
    assert any(note.startswith("b includes the fixture mass") for note in unknown.notes)


@pytest.mark.parametrize("duration", sampled([1.0, 2.0], kept=0))
def test_known_noise_is_what_a_residual_is_judged_by(duration: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a load cell that is said to be much better than it is, a right model leaves too much."""
    monkeypatch.setattr("inerter.identification.conclusions.explanations", lambda *arguments: [])  # which take long
    short = replace(RIGID, duration=duration)
    fit = it.identify(replace(record_of(short, 3), force_noise=0.05), model_of(short), starts=STARTS)
    assert not fit.status.ok
    assert fit.misfit.worst > 3.0


@pytest.mark.marathon
def test_simulations_are_counted_once(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = []
    run = Experiment.run
    monkeypatch.setattr(Experiment, "run", lambda *args, **kwargs: (runs.append(1), run(*args, **kwargs))[1])
    fit = fitted(replace(RIGID, duration=0.6), 4)
    assert fit.simulations == len(runs)


@pytest.mark.parametrize("seed", sampled(range(6), [1], often=[2], kept=1))
def test_friction_laws_are_stepped_as_the_rig_does(seed: int) -> None:
    """Two explicit steppings that share no code, with Stribeck friction, a skew and a gap."""
    random = np.random.default_rng([5, seed])
    ks, b, f = 10 ** random.uniform(5.3, 6.3), random.uniform(20.0, 200.0), random.uniform(5.0, 30.0)
    cs, gap = 0.01 * ks / 2.0, (0.0, 5e-5)[seed % 2]
    rise, speed = random.uniform(0.3, 1.0), random.uniform(0.005, 0.02)
    changed = seed // 2 == 0
    device = Device(
        b, f, ks, cs, gap, 10.0, static=1.0 + rise * changed, stribeck_speed=speed, bias=0.2 * (not changed)
    )
    motion = Tones((2e-3, 3e-4), (1.3, 4.1), (0.2, 1.0))
    quiet = Sensors(encoder_step=1e-9, encoder_noise=0.0, force_step=1e-9, force_noise=0.0)
    time, z, force = measured(device, motion, quiet, 2.0, 0)
    record = it.Record(time, z, force)
    experiment = experiment_of(record, bandwidth=150.0)
    chain = ChainValues(ks, cs, gap, b, f, 10.0, rise * f * changed, speed, skew=0.2 * (not changed))
    fine = np.arange(round(2.0 / 2e-6) + 1) * 2e-6
    exact = device_force(device, *motion.at(fine))[::500]
    found = simulate_chain(chain, experiment, time.size)
    use = slice(50, -100)
    assert np.std((found - exact)[use]) < 0.03 * np.std(exact)


def test_the_largest_hundredth_does_not_judge() -> None:
    white = np.random.default_rng(0).standard_normal(10_000)
    struck = white.copy()
    struck[:90] = 1e3
    assert mean_square(struck) == pytest.approx(mean_square(white), rel=0.1)
    assert mean_square(2.0 * white) > 3.0 * mean_square(white)
    assert math.isfinite(mean_square(struck))


def test_what_is_assumed_already_is_no_explanation() -> None:
    rig, assumed = it.Rig(model_of(RIGID)), (delay(0.01),)
    problem = FitProblem(rig, space_of(rig, assumed), [experiment_of(record_of(RIGID, 5))], [], assumed=assumed)
    names = [h.name for h in hypotheses(problem)]
    assert "delay" not in names
    assert "filtered force" in names
    assert "offset or asymmetric friction" not in names
    assert "offset or asymmetric friction" in [h.name for h in hypotheses(replace(problem, offset=False))]
