"""Right valleys among many, and what errors of sensors do to a fit."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import BALL_SCREW, device, fit_test

import inerter as it
from inerter.identification.bootstrap import bootstrap
from inerter.identification.experiment import experiment_of
from inerter.identification.intervals import best_fit_of
from inerter.identification.noise import uniform_whitening
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.search import basin_hopping, search, starting_points
from inerter.identification.sensors import periodic_displacement, unavoidable_residual

FLYWHEEL = it.Inerter(it.free(10, 500, name="b")) | it.Friction(it.free(0, 200, name="f"))
RATTLING = {"b": 53.0, "f": 82.0, "ks": 4.7e5, "cs": 7900.0, "gap": 1.1e-4}


def rattle(seed: int = 0) -> it.Record:
    """A slow motion against the friction, with small quick ones on top: contact is lost again and again."""
    command = it.cosine(amplitude=0.05, frequency=1.0)
    for frequency, amplitude in ((5.2, 1e-3), (9.4, 5e-4), (15.8, 3e-4), (26.2, 2e-4)):
        command = command + it.cosine(amplitude=amplitude, frequency=frequency)
    return it.VirtualRig(device(**RATTLING), seed=seed, table_bandwidth=60.0, force_range=5e3).run(
        command, duration=4.0
    )


def problem_of(record: it.Record, model: it.Network) -> FitProblem:
    """The whole record with the errors that the virtual rig has."""
    rig, experiment = it.Rig(model), experiment_of(record)
    return FitProblem(rig, space_of(rig), [experiment], [uniform_whitening(experiment.kept, 0.12)])


@pytest.mark.marathon
def test_the_right_valley_of_a_rattling_device() -> None:
    fit = it.identify(rattle(), BALL_SCREW, seed=0)
    assert fit.status.ok
    assert fit.variance_explained > 0.999
    for name, value in RATTLING.items():
        assert fit.parameters[name].best == pytest.approx(value, rel=0.01)


def test_impacts_now_and_then_are_not_noise() -> None:
    record = fit_test(seed=3)
    random = np.random.default_rng(0)
    burst = np.zeros(record.force.size)
    for start in range(200, burst.size - 50, 400):  # a tenth of the time
        burst[start : start + 40] = 30.0 * random.standard_normal(40)
    struck = it.Record(
        time=record.time,
        displacement=record.displacement,
        force=record.force + burst,
        source="struck",
    )
    level = 0.12  # 0.1 N and steps of 0.2 N
    assert experiment_of(record).noise == pytest.approx(level, rel=0.3)
    assert experiment_of(struck).noise == pytest.approx(level, rel=0.3)


def test_part_of_a_record_is_part_of_what_its_force_tells() -> None:
    """In a motion that grows the first quarter of the squared force lies late."""
    table = it.VirtualRig(device(gap=0.0), seed=0)
    record = table.run(it.chirp(1e-3, lowest=0.5, highest=8.0, duration=4.0), duration=4.0)
    experiment = experiment_of(record)
    samples = int(np.searchsorted(experiment.information, 0.25))
    power = np.cumsum((record.force - np.median(record.force)) ** 2)
    assert samples > 0.5 * record.time.size
    assert power[samples] / power[-1] == pytest.approx(0.25, abs=0.02)


def test_starts_cover_orders_of_magnitude_of_what_may_be_zero() -> None:
    problem = problem_of(fit_test(), BALL_SCREW)
    gaps = np.array([problem.space.values_by_name(p)["gap"] for p in starting_points(problem, {}, seed=0, count=128)])
    assert np.mean(gaps < 1e-5) > 0.1
    assert np.mean(gaps > 3e-4) > 0.1


@pytest.mark.campaign
def test_hops_never_lead_to_a_worse_fit() -> None:
    problem = problem_of(rattle(), BALL_SCREW)
    start = problem.space.coordinates_of({**RATTLING, "gap": 1.2e-4, "cs": 7000.0})
    before = float(np.sum(problem.residual(start) ** 2))
    assert float(np.sum(problem.residual(basin_hopping(problem, start, seed=0)) ** 2)) < before


@pytest.mark.campaign
def test_a_bootstrap_agrees_with_curvature_where_nothing_strikes() -> None:
    """Without friction and backlash, and an encoder without errors, a bootstrap tells what the curvature tells."""
    model = it.Spring(it.free(1e4, 1e7, name="k")) | it.Damper(it.free(10, 1e5, name="c"))
    truth = it.Spring(2e5) | it.Damper(900.0)
    rig = it.VirtualRig(truth, seed=0, encoder_noise=0.0, encoder_resolution=0.0, force_resolution=0.0, force_range=1e4)
    problem = problem_of(rig.run(it.multisine(it.Road(1e-9, 10.0), seed=1, highest=20.0), duration=4.0), model)
    optimum = best_fit_of(problem, problem.space.coordinates_of({"k": 2e5, "c": 900.0}))
    drawn = bootstrap(problem, optimum, seed=0, draws=40)
    plain_errors = np.sqrt(np.diag(optimum.covariance))
    assert np.all(drawn.optimum.errors < 2.0 * plain_errors)
    assert np.all(np.abs(drawn.bias) < plain_errors)


def test_what_an_encoder_leaves_grows_with_the_stiffness() -> None:
    problem = problem_of(fit_test(), BALL_SCREW)
    point = {"ks": 1e6, "cs": 3200.0, "gap": 0.0, "b": 113.0, "f": 10.0}
    soft, stiff = (
        unavoidable_residual(problem, problem.space.coordinates_of({**point, "b": b}), seed=0) for b in (20.0, 400.0)
    )
    assert stiff > 1.5 * soft


def test_a_motion_repeats_only_without_tones_between_its_harmonics() -> None:
    """Or what a bootstrap draws would lack them."""
    periodic = experiment_of(fit_test(seed=4))
    moved = periodic_displacement(periodic)
    later = moved[1000:4000]
    assert np.abs(later - moved[2000:5000]).max() < 1e-9  # 3 periods are 1 s; the encoder's noise is 2e-7 m
    assert np.abs(moved - periodic.motion.displacement).max() < 2e-6
    mixed = experiment_of(rattle())
    assert np.array_equal(periodic_displacement(mixed), mixed.motion.displacement)


@pytest.mark.marathon
def test_a_device_that_nobody_can_predict_has_no_parameters() -> None:
    """Hardly damped, it rattles chaotically: errors of the encoder alone change much of its force."""
    command = it.cosine(amplitude=2e-3, frequency=4.0) + it.cosine(amplitude=3e-4, frequency=23.0)
    chaotic = it.VirtualRig(device(ks=3e5, cs=20.0, gap=3e-4, b=40.0, f=5.0), force_range=5e3)
    model = it.Rig(BALL_SCREW).with_values({"b": 40.0, "f": 5.0, "cs": 20.0}).device
    fit = it.identify(chaotic.run(command, duration=2.0), model, seed=0, starts=8)
    assert not fit.status.ok
    assert not any(told for told in fit.identifiable.values())
    assert all(np.isnan(parameter.value) for parameter in fit.parameters.values())


def test_progress_moves_with_each_point_of_a_search() -> None:
    told: list[float] = []
    search(problem_of(fit_test(duration=1.0), FLYWHEEL), {}, 0, 8, ((1 / 16, 2, 2), (1.0, 1, 1)), told.append)
    assert len(told) == 8 + 2 + 1  # points, and the candidates of both stages
    assert told == sorted(set(told))
    assert told[-1] == pytest.approx(1.0)


@pytest.mark.marathon
@pytest.mark.parametrize("model", [FLYWHEEL, BALL_SCREW], ids=["flywheel", "ball screw"])
def test_progress_never_goes_back(model: it.Network) -> None:
    """Also where a record asks for further searches."""
    told: list[float] = []
    record = rattle(seed=1)
    noisy = it.Record(
        time=record.time,
        displacement=record.displacement,
        force=record.force * (1.0 + 0.2 * np.sin(40.0 * record.time)),  # what no model explains
        source="modulated",
        force_bandwidth=record.force_bandwidth,
    )
    it.identify(noisy.trim(0.0, 0.5), model, seed=0, starts=8, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert len(told) > 10  # more than one search
