"""What a fit says to try where no tested cause accounts for its misfit."""

from __future__ import annotations

import re

import numpy as np
import pytest
from quick_fits import quick_fit

import inerter as it
from inerter.identification.conclusions import fit_of
from inerter.identification.intervals import CostProfile, Side
from inerter.identification.models import MODELS
from inerter.identification.solving import SolvedFit


def fit(rate: float) -> it.Fit:
    """A rigid device with a large quadratic damping, fitted with a viscous one; no cause is sought."""
    time = np.arange(600) / rate
    tones = [(2e-3, 1.3, 0.4), (6e-4, 3.0, 2.0)]
    x, v, a = (
        sum(s * np.real((2j * np.pi * f) ** n * np.exp(1j * (2 * np.pi * f * time + p))) for s, f, p in tones)
        for n in range(3)
    )
    random = np.random.default_rng(1)
    force = 60.0 * a + 100.0 * v + 8e4 * v * np.abs(v) + 0.01 * random.standard_normal(time.size)
    record = it.Record(time, x + 1e-8 * random.standard_normal(time.size), force, force_noise=0.01)
    return concluded(quick_fit(record, MODELS["ideal-viscous"], {"b": 60.0, "c": 500.0}))


def concluded(solution: SolvedFit) -> it.Fit:
    """The fit of a solution, without profiles and causes."""
    known = tuple(CostProfile(Side(x, True), Side(x, True), (), None) for x in solution.optimum.point)
    return fit_of(type(solution)(**{**vars(solution), "profiles": known}), explain=False)


@pytest.mark.parametrize(("rate", "few"), [(18.0, True), (150.0, False)])
def test_a_misfit_without_a_cause_says_so_and_what_to_try(rate: float, few: bool) -> None:
    message = fit(rate).status.message
    assert "no tested cause accounts for it" in message
    samples = re.search(r"has only some ([\d.]+) samples in a period", message)
    assert (samples is not None) == few
    if samples is not None:
        assert rate / 3.0 < float(samples[1]) < rate / 1.3
        assert "sample it faster" in message
    else:
        assert "repeat the test at another amplitude" in message


@pytest.mark.parametrize("what", ["force", "displacement", "both"])
def test_a_channel_of_something_else_is_said_to_follow_nothing(what: str) -> None:
    """A load cell or an encoder that is not connected, or the channels of two runs."""
    time, random = np.arange(2000) / 500.0, np.random.default_rng(3)
    x = 2e-3 * np.sin(8.0 * time) + 1e-3 * np.sin(31.0 * time)
    force = -60.0 * (0.128 * np.sin(8.0 * time) + 0.961 * np.sin(31.0 * time))
    noise = {"displacement": 1e-5 * random.standard_normal(time.size), "force": random.standard_normal(time.size)}
    record = it.Record(time, x + 1e-3 * noise["displacement"], force + 0.02 * noise["force"])
    assert "follows the displacement" not in concluded(quick_fit(record, MODELS["ideal"], {"b": 60.0})).status.message
    wrong = record.with_notes(**(noise if what == "both" else {what: noise[what]}))
    message = concluded(quick_fit(wrong, MODELS["ideal"], {"b": 60.0})).status.message
    assert message.startswith("the force follows the displacement at no frequency")


def test_a_force_that_the_motion_explains_is_of_this_device_though_the_model_is_not() -> None:
    """Two strokes against friction alone, too few for a coherence, fitted as an inertance."""
    time = np.arange(2000) / 500.0
    force = 20.0 * np.sign(np.cos(np.pi * time)) + 0.02 * np.random.default_rng(0).standard_normal(time.size)
    record = it.Record(time, 1e-2 * np.sin(np.pi * time), force)
    fit = concluded(quick_fit(record, MODELS["ideal"], {"b": 60.0}))
    assert fit.variance_explained < 0.5
    assert "follows the displacement" not in fit.status.message
