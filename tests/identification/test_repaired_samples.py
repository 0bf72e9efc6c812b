"""Samples that a hypothesis on the recorder replaces are not compared, whatever the offset of the load cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from numpy.typing import NDArray
from quick_fits import explained, quick_fit
from rigid_fits import rigid_record

import inerter as it
from inerter.identification.diagnosis import lost_samples
from inerter.identification.experiment import experiment_of
from inerter.identification.hypotheses import DELAY, delay
from inerter.identification.intervals import best_fit_of
from inerter.identification.models import MODELS
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.recording_faults import faulty_samples
from inerter.identification.statements.causes import Suspect

Matrix = NDArray[np.float64]


def with_fault(fault: Suspect, offset: float) -> it.Record:
    """80 kg with 12 N of friction, with 12 spikes, held values or places where samples were dropped."""
    record, _ = rigid_record(duration=2.0)
    record = replace(record, force_noise=0.15)
    at = 60 + 150 * np.arange(12)
    z, force = record.displacement.copy(), record.force + offset
    if fault is Suspect.SPIKES:
        force[at] += 400.0
    elif fault is Suspect.HELD:
        for n in at:
            z[n : n + 9], force[n : n + 9] = z[n], force[n]
    else:
        kept = np.ones(z.size, dtype=bool)
        for n in at[::3]:
            kept[n : n + 9] = False
        return replace(record, time=record.time[: kept.sum()], displacement=z[kept], force=force[kept])
    return replace(record, displacement=z, force=force)


def fitted_under(record: it.Record, fault: Suspect) -> tuple[Matrix, Matrix, float]:
    """Values under the hypothesis, their standard errors, and the normalised residual."""
    solution = quick_fit(record, MODELS["friction"], {"b": 80.0, "f": 12.0})
    lost = lost_samples(solution.problem.experiments)
    every = [*faulty_samples(solution.problem.experiments), *([] if lost is None else [lost])]
    (suspect,) = [h for h in every if h.name is fault]
    problem = replace(solution.problem, assumed=(suspect,), systems={})
    best = best_fit_of(problem, solution.optimum.point, evaluations=20)
    slopes = problem.space.slopes(best.point)
    return problem.space.to_values(best.point), best.errors * slopes, solution.judge.misfit(problem, best.point).worst


def viscous(repeated: int, noise: float) -> it.Record:
    """40 kg with 200 N s/m at 200 Hz, in closed form; of the force so many samples repeat the one before."""
    random, time = np.random.default_rng(5), np.arange(1200) / 200.0
    omega, size = 2.0 * np.pi * np.array([1.3, 4.1]), np.array([4e-3, 1e-3])
    sine, cosine = np.sin(np.outer(time, omega)), np.cos(np.outer(time, omega))
    force = 40.0 * (-sine @ (size * omega**2)) + 200.0 * (cosine @ (size * omega))
    force += noise * random.standard_normal(time.size)
    fast = np.flatnonzero(np.abs(np.gradient(force)) > 0.8 * np.abs(np.gradient(force)).max())
    at = fast[(fast > 50) & (fast < 900)][:: max(fast.size // 12, 1)][:repeated]
    force[at + 1] = force[at]
    return it.Record(
        time, sine @ size + 1e-7 * random.standard_normal(time.size), force, force_bandwidth=5000.0, force_noise=noise
    )


@pytest.mark.campaign
def test_single_repeated_forces_are_named_where_they_matter_and_withhold_nothing_where_not() -> None:
    start = {"b": 40.0, "c": 200.0}
    wrong = quick_fit(viscous(12, 0.05), MODELS["ideal-viscous"], start)
    assert not wrong.misfit.is_noise_limited
    found, _ = explained(wrong)
    assert found[0].name is Suspect.HELD
    assert found[0].explained > 0.9
    fine = quick_fit(viscous(2, 0.4), MODELS["ideal-viscous"], start)
    assert fine.misfit.is_noise_limited
    (suspect,) = faulty_samples(fine.problem.experiments)
    assert suspect.name is Suspect.HELD
    assert explained(fine)[0] == []
    assert faulty_samples(quick_fit(viscous(0, 0.1), MODELS["ideal-viscous"], start).problem.experiments) == []


@pytest.mark.parametrize("fault", sampled([Suspect.SPIKES, Suspect.HELD, Suspect.LOST_SAMPLES], [Suspect.SPIKES]))
def test_an_offset_of_the_load_cell_changes_no_values_under_replaced_samples(fault: Suspect) -> None:
    centred, errors, misfit = fitted_under(with_fault(fault, 0.0), fault)
    shifted, _, other = fitted_under(with_fault(fault, 3000.0), fault)
    assert other == pytest.approx(misfit, rel=0.02)
    assert np.all(np.abs(shifted - centred) < 0.2 * errors)


@pytest.mark.parametrize("fault", [Suspect.SPIKES, Suspect.HELD, Suspect.LOST_SAMPLES])
def test_replaced_samples_are_delayed_like_all_others(fault: Suspect) -> None:
    """The bandwidth of the load cell is not stated, and a delay stands for it: it acts on the motion that is mended."""
    experiment = experiment_of(with_fault(fault, 0.0), rigid=True)
    lost = lost_samples([experiment])
    (suspect,) = [h for h in (*faulty_samples([experiment]), *([] if lost is None else [lost])) if h.name is fault]
    assumed = (delay(0.02), suspect)
    rig = it.Rig(MODELS["friction"])
    problem = FitProblem(rig, space_of(rig, assumed), [experiment], [], assumed=assumed)
    values = {"b": 80.0, "f": 0.0, DELAY: 0.0}
    (prompt,), (late,) = (
        problem.forces(problem.space.coordinates_of({**values, DELAY: by * experiment.record.interval}))
        for by in (0, 5)
    )
    middle = slice(860, 900)  # where nothing is replaced
    assert np.std(late[middle] - prompt[middle]) > 0.01 * np.std(prompt)
    assert np.std(late[middle] - prompt[855:895]) < 0.1 * np.std(late[middle] - prompt[middle])


def test_hum_of_the_encoder_is_named_with_the_values_without_it() -> None:
    """4 um at 50 Hz are 30 N of the inertance, of which the force knows nothing."""
    record, _ = rigid_record(duration=2.0)
    hum = 4e-6 * np.sin(2.0 * np.pi * 50.0 * record.time + 0.3)
    wrong = replace(record, displacement=record.displacement + hum)
    (first, *_), _ = explained(quick_fit(wrong, MODELS["friction"], {"b": 80.0, "f": 12.0}))
    assert first.sentence.startswith("the displacement contains hum of 4")
    assert first.explained > 0.95
    for name, true in (("b", 80.0), ("f", 12.0)):
        value, error = first.estimates[name]
        assert abs(value - true) < 4.0 * error < 0.01 * true


@pytest.mark.parametrize("place", [700, 1111])
def test_a_slip_of_the_encoder_is_closed_where_it_is(place: int) -> None:
    """An extrapolation over one sample beyond a step is 19/16 of it: the joint was placed beside it, and not closed."""
    record, true = rigid_record(duration=2.0)
    slipped = replace(record, displacement=record.displacement + 3e-4 * (np.arange(record.time.size) > place))
    experiment = experiment_of(slipped, rigid=True)
    (suspect,) = faulty_samples([experiment])
    assert suspect.name is Suspect.JOINED
    mended = suspect.change_motion(experiment, {}).motion
    assert mended.bandwidth < 2.0 * experiment_of(record, rigid=True).motion.bandwidth
    inner = slice(100, -100)
    left = mended.displacement - true["x"]
    assert np.ptp(left[inner]) < 8e-6
    assert np.std((mended.acceleration - true["a"])[inner]) < 0.05 * np.std(true["a"])


@pytest.mark.campaign
def test_faulty_samples_of_a_channel_at_a_lower_rate_are_interpolated_at_the_rate_of_the_record() -> None:
    """A record at the readings alone has fewer samples than the forces that it is compared with."""
    record = with_fault(Suspect.SPIKES, 0.0)
    slow = replace(record, displacement=np.repeat(record.displacement[::4], 4)[: record.time.size])
    assert fitted_under(slow, Suspect.SLOWER)[2] < fitted_under(slow, Suspect.SPIKES)[2] < np.inf
