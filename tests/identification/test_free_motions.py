"""Records of linear devices that begin in motion: steady forces and a decaying resonance, in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.models import MODELS, on_rig
from inerter.identification.noise import uniform_whitening
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.records.record import Record

TRUE = {"ks": 6e5, "cs": 120.0, "b": 60.0}  # 15.9 Hz, with 1 % of the critical damping
BANDWIDTH, NOISE = 150.0, 0.5  # [Hz], [N]


def in_motion(seed: int, resonance: float, turning_point: bool = False) -> Record:
    """Three seconds of a table that moved for long, and of a shaft that resonates since a blow before [N].

    At a turning point all tones turn back at the first sample.
    """
    random = np.random.default_rng([21, seed])
    ks, cs, b = TRUE.values()
    time = np.arange(1500) / 500.0
    w = 2.0 * np.pi * BANDWIDTH

    def cell(s: complex) -> complex:
        return w**2 / (s**2 + np.sqrt(2.0) * w * s + w**2)

    moved, force = np.zeros(time.size), np.zeros(time.size)
    for frequency in (2.3, 5.1, 11.7):
        s = 2j * np.pi * frequency
        phase = 0.0 if turning_point else random.uniform()
        turning = np.exp(s * time + 2j * np.pi * phase) * 4e-4 / frequency
        moved += turning.real
        force += (cell(s) * s / (1.0 / (cs + ks / s) + 1.0 / (b * s)) * turning).real
    pole = -0.5 * cs / b + 1j * np.sqrt(ks / b - (0.5 * cs / b) ** 2)
    force += resonance * (cell(pole) * np.exp(pole * time + 2j * np.pi * random.uniform())).real
    noises = 2e-8 * random.standard_normal(time.size), NOISE * random.standard_normal(time.size)
    return it.Record(
        time, moved + noises[0], force + 12.0 + noises[1], force_bandwidth=BANDWIDTH, force_noise=NOISE,
        displacement_noise=2e-8,
    )  # fmt: skip


@pytest.mark.parametrize(("resonance", "turning_point"), [(0.0, False), (100.0, False), (0.0, True), (100.0, True)])
def test_a_resonance_from_before_the_record_is_not_in_the_residual(resonance: float, turning_point: bool) -> None:
    experiment = experiment_of(in_motion(0, resonance, turning_point))
    rig = on_rig(MODELS["elastic"], BANDWIDTH)
    space = space_of(rig, ())
    problem = FitProblem(rig, space, [experiment], [uniform_whitening(experiment.kept, NOISE)])
    point = space.coordinates_of(TRUE)
    assert np.std(problem.residual(point)[experiment.kept]) == pytest.approx(1.0, abs=0.1)
    (force,) = problem.forces(point)
    assert force is not None
    left = (experiment.record.force - force)[experiment.kept]
    assert np.mean(left) == pytest.approx(12.0, abs=0.1)  # the offset
    assert np.std(left) == pytest.approx(NOISE, rel=0.1)


def test_a_record_from_rest_has_no_free_motion() -> None:
    """Its start tells of the device, of which free motions would take a part."""
    moving = in_motion(0, 0.0)
    share = np.minimum(moving.time / 0.4, 1.0)
    moved = moving.displacement * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    experiment = experiment_of(replace(moving, displacement=moved))
    rig = on_rig(MODELS["elastic"], BANDWIDTH)
    problem = FitProblem(rig, space_of(rig, ()), [experiment], [uniform_whitening(experiment.kept, 1.0)])
    simulated = problem.simulate(experiment, problem.space.coordinates_of(TRUE))
    assert simulated is not None
    assert simulated.free.shape == (moving.time.size, 0)


@pytest.mark.campaign
def test_values_of_a_shaft_that_resonates_from_before_the_record() -> None:
    fit = it.identify(in_motion(0, 100.0), "elastic", starts=8)
    assert fit.status.ok, fit.status
    for name, truth in TRUE.items():
        parameter = fit.parameters[name]
        assert abs(parameter.best - truth) < 3.5 * parameter.standard_error, name
        assert parameter.standard_error < 0.05 * truth, name
