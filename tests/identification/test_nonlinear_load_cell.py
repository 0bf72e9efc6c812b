"""A load cell that is not linear is named, also where noise hides its residual; those of sound records are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from quick_fits import explained, quick_fit
from rigid_fits import rigid_record

import inerter as it
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect

TRUE = {"b": 80.0, "f": 12.0}
GAINS = {Suspect.ASYMMETRIC_GAIN: (0.01, np.sign), Suspect.NONLINEAR_GAIN: (-0.02, np.square)}


def read(cause: Suspect | None, noise: float, seed: int = 0) -> it.Record:
    """The rigid device as read by a load cell with a gain that changes by a law, and noise [N]."""
    record, motion = rigid_record(seed, duration=3.0)
    force = motion["force"]
    if cause is not None:
        size, law = GAINS[cause]
        force = force * (1.0 + size * law(force / np.abs(force).max()))
    random = np.random.default_rng([seed, 11])
    return replace(record, force=force + 5.0 + noise * random.standard_normal(force.size), force_noise=noise)


@pytest.mark.parametrize("cause", sampled(GAINS, [Suspect.NONLINEAR_GAIN]))
def test_the_gain_is_named_first_and_its_change_is_estimated(cause: Suspect) -> None:
    solution = quick_fit(read(cause, 0.15), MODELS["friction"], TRUE)
    assert not solution.misfit.is_noise_limited
    (first, *_), _ = explained(solution)
    assert first.name is cause
    assert first.misfit.excess < 1.0
    (change,) = first.values.values()
    assert change == pytest.approx(GAINS[cause][0], rel=0.1)
    for name, true in TRUE.items():
        value, error = first.estimates[name]
        assert abs(value - true) < 4.0 * error


@pytest.mark.parametrize("noise", [0.5, 1.5])
def test_a_gain_by_load_is_named_where_noise_hides_its_residual(noise: float) -> None:
    """Values are then off by several standard errors, with a residual that is as large as the noise."""
    solution = quick_fit(read(Suspect.NONLINEAR_GAIN, noise), MODELS["friction"], TRUE)
    assert solution.misfit.is_noise_limited
    space, best = solution.problem.space, solution.optimum
    errors = dict(zip(space.names, best.errors * space.slopes(best.point), strict=True))
    assert any(abs(space.values_by_name(best.point)[n] - true) > 3.0 * errors[n] for n, true in TRUE.items())
    (first, *_), _ = explained(solution)
    assert first.name is Suspect.NONLINEAR_GAIN


@pytest.mark.parametrize(("noise", "seed"), sampled([(n, s) for n in (0.15, 1.0, 4.0) for s in range(8)], kept=3))
def test_sound_load_cells_are_not_suspected(noise: float, seed: int) -> None:
    solution = quick_fit(read(None, noise, seed), MODELS["friction"], TRUE)
    assert solution.misfit.is_noise_limited
    found, _ = explained(solution)
    assert found == []


@pytest.mark.parametrize(("seed", "every"), [(0, 28), (5, 28), (6, 12)])
def test_a_gain_by_load_is_named_where_the_validation_data_are_too_few_to_show_it(seed: int, every: int) -> None:
    """Of so few samples, the fitted part shows what a value is off by, and the validation data only their noise."""
    whole = read(Suspect.NONLINEAR_GAIN, 0.3, seed)
    record = it.Record(whole.time[::every], whole.displacement[::every], whole.force[::every])
    solution = quick_fit(record, MODELS["friction"], TRUE)
    assert solution.misfit.is_noise_limited
    space, best = solution.problem.space, solution.optimum
    errors = dict(zip(space.names, best.errors * space.slopes(best.point), strict=True))
    assert abs(space.values_by_name(best.point)["b"] - TRUE["b"]) > 3.0 * errors["b"]
    (first, *_), _ = explained(solution)
    assert first.name is Suspect.NONLINEAR_GAIN
