"""A law of the device that the model lacks is found where the noise of the force, as estimated, hides its residual."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from quick_fits import explained, quick_fit

import inerter as it
from inerter.identification.models import MODELS
from inerter.identification.statements.causes import Suspect

Matrix = NDArray[np.float64]
INERTANCE, DAMPING, CELL = 60.0, 300.0, 300.0  # [kg], [N s/m], [Hz]
LINES = 60  # of the motion


def record(square: float, seed: int, damping: float = DAMPING, gain: float = 0.0) -> it.Record:
    """Five seconds of lines up to a sixth of the rate, on a rigid inerter with damping; `square` [N s^2/m^2].

    The load cell delays such slow forces, and does no more, unless its `gain` changes with the square of the load.
    """
    random, rate = np.random.default_rng([29, seed]), 60.0
    time = np.arange(300) / rate
    omega = 2.0 * np.pi * np.sort(random.uniform(0.5, 10.0, LINES))
    phases = random.uniform(0.0, 6.28, LINES)

    def moved(time: Matrix, order: int) -> Matrix:
        return np.asarray(
            3e-4 * np.sum(((1j * omega) ** order * np.exp(1j * (np.outer(time, omega) + phases))).real, 1)
        )

    late = time - np.sqrt(0.5) / np.pi / CELL
    v = moved(late, 1)
    force = INERTANCE * moved(late, 2) + (damping + square * np.abs(v)) * v
    force *= 1.0 + gain * (force / np.abs(force).max()) ** 2
    noises = 3e-8, 2e-3 * float(np.std(force))
    x, read = (y + size * random.standard_normal(300) for y, size in zip((moved(time, 0), force), noises, strict=True))
    return it.Record(time, x, read, force_bandwidth=CELL)


@pytest.mark.parametrize(("square", "named"), [(1500.0, True), (0.0, False)])
def test_a_quadratic_damping_is_named_that_the_estimated_noise_of_the_force_hides(square: float, named: bool) -> None:
    solution = quick_fit(record(square, 2), MODELS["ideal-viscous"], {"b": INERTANCE, "c": DAMPING})
    assert solution.misfit.is_noise_limited
    found, _ = explained(solution)
    assert [e.name for e in found] == [Suspect.QUADRATIC] * named
    for e in found:
        assert abs(e.estimates["c"][0] / DAMPING - 1.0) < 0.1
        assert abs(e.values["quadratic damping"] / square - 1.0) < 0.05


@pytest.mark.parametrize("seed", [2, 3])
def test_a_load_cell_is_named_where_a_law_of_the_device_explains_less_of_what_it_does(seed: int) -> None:
    """A gain that falls with the force of a damper resembles a damping that falls with the speed."""
    read = record(0.0, seed, damping=6000.0, gain=-0.02)
    solution = quick_fit(read, MODELS["ideal-viscous"], {"b": INERTANCE, "c": 6000.0})
    assert solution.misfit.is_noise_limited
    found, _ = explained(solution)
    assert found[0].name is Suspect.NONLINEAR_GAIN
    assert found[0].values["gain at the largest force over that near zero"] == pytest.approx(-0.02, rel=0.2)


@pytest.mark.campaign
@pytest.mark.parametrize("square", [1500.0, 0.0])
def test_values_are_withheld_where_a_law_hides_in_the_noise(square: float) -> None:
    fit = it.identify(record(square, 2), "ideal-viscous", starts=8)
    assert fit.misfit.is_noise_limited
    assert fit.status.ok is (square == 0.0), fit.status
    low, high = fit.parameters["c"].interval
    assert low <= DAMPING <= high
    if square:
        assert "the square of the speed" in fit.status.message
        assert np.isnan(fit.parameters["c"].value)
