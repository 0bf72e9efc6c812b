"""Noise of the displacement that passes through a device decides no value of a fit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import inerter as it
from inerter.identification.experiment import experiment_of
from inerter.identification.passed_noise import passed_noise, tones_of
from inerter.identification.statements.identifiability import Verdict

TRUTH = {"ks": 2.379e6, "cs": 10974.0, "b": 41.49}
RIG = it.VirtualRig(
    (it.Spring(TRUTH["ks"]) | it.Damper(TRUTH["cs"])) - it.Inerter(TRUTH["b"]),
    seed=0, sampling=500.0, encoder_noise=3e-7, force_noise=0.05, force_resolution=0.05,
)  # fmt: skip


@pytest.mark.campaign
def test_one_low_frequency_gives_no_value_of_an_elastic_device_that_noise_decides() -> None:
    """Of all stiffnesses, the noise alone prefers one a twelfth as large."""
    fit = it.identify(RIG.run(it.cosine(6e-4, 2.3), 3.0), "elastic", starts=16)
    ks = fit.parameters["ks"]
    assert fit.identifiable["ks"].verdict is Verdict.NOISY
    assert "noise of the displacement" in fit.identifiable["ks"].sentence
    assert math.isnan(ks.value)
    assert all(map(math.isnan, ks.interval))
    for name in filter(fit.identifiable.get, TRUTH):
        low, high = fit.parameters[name].interval
        assert low <= TRUTH[name] <= high, name


@pytest.mark.campaign
def test_one_tone_without_the_bandwidth_of_the_load_cell_gives_no_value() -> None:
    """A delay is then a fourth unknown: with it a shaft a hundredth as stiff fits as well, by its noise."""
    rig = RIG.run(it.cosine(6e-4, 2.3), 3.0)
    fit = it.identify(it.Record(rig.time, rig.displacement, rig.force), "elastic", starts=8)
    assert "sensor delay" in fit.identifiable
    assert not any(fit.identifiable.values())


def test_one_tone_is_told_from_two_and_from_a_sweep() -> None:
    tone = it.cosine(6e-4, 2.3)
    assert tones_of(experiment_of(RIG.run(tone, 3.0))) == 1
    assert tones_of(experiment_of(RIG.run(tone, 1.1))) == 1  # two periods and a half
    assert tones_of(experiment_of(RIG.run(tone + it.cosine(6e-5, 5.1), 3.0))) == 2
    assert tones_of(experiment_of(RIG.run(tone + it.cosine(3e-4, 3.4), 3.0))) == 2
    assert tones_of(experiment_of(RIG.run(it.chirp(2e-4, 2.0, 3.0, 3.2), 3.0))) is None
    assert tones_of(experiment_of(RIG.run(tone + it.cosine(3e-4, 3.4) + it.cosine(2e-4, 6.1), 3.0))) is None


@pytest.mark.marathon
def test_four_unknowns_of_one_tone_have_no_values() -> None:
    """Two equations; which of all solutions fits best, the noise decides."""
    device = (it.Spring(7.7e4) | it.Damper(2300.0)) - it.Inerter(17.0)
    rig = it.VirtualRig(
        device, seed=0, sampling=300.0, encoder_noise=4e-7, encoder_resolution=0.0, force_noise=0.5,
        force_resolution=0.0, force_range=1e5,
    )  # fmt: skip
    known = rig.run(it.cosine(3.5e-4, 14.0), 2.0)
    fit = it.identify(it.Record(known.time, known.displacement, known.force), "elastic", starts=16)
    assert not any(fit.identifiable.values())


@pytest.mark.marathon
def test_five_unknowns_of_two_tones_in_motion_have_no_values() -> None:
    """Four equations, for where a record begins in motion its start is not compared."""
    device = (it.Spring(9.13e5) | it.Damper(634.0)) - (it.Inerter(118.0) | it.Damper(321.0))
    rig = it.VirtualRig(
        device, seed=0, sampling=360.0, encoder_noise=9e-8, encoder_resolution=0.0, force_noise=0.0034,
        force_resolution=0.0, force_bandwidth=184.0, force_range=1e5,
    )  # fmt: skip
    known = rig.run(it.cosine(2.5e-4, 3.08) + it.cosine(6e-5, 5.73), 3.8, start=1.5)
    fit = it.identify(it.Record(known.time, known.displacement, known.force), "elastic-viscous", starts=16)
    assert not any(fit.identifiable.values())


@pytest.mark.campaign
def test_a_sweep_of_the_same_device_has_all_its_values() -> None:
    fit = it.identify(RIG.run(it.chirp(2e-4, 1.0, 15.0, 3.2), 3.0), "elastic", starts=8)
    assert fit.status.ok
    for name, truth in TRUTH.items():
        low, high = fit.parameters[name].interval
        assert fit.identifiable[name], name
        assert low <= truth <= high, name


def test_an_inertance_passes_noise_as_the_fourth_power_of_frequency() -> None:
    record = RIG.run(it.cosine(6e-4, 2.3), 3.0).with_notes(force_noise=0.1, displacement_noise=2e-7)
    spectrum = passed_noise(experiment_of(record))
    slow = spectrum.omega < 2.0 * np.pi * 10.0  # far below the bandwidth of the smoothed displacement
    expected = (50.0 * spectrum.omega[slow] ** 2 * 2e-7 / 0.1) ** 2
    np.testing.assert_allclose(spectrum(it.Inerter(50.0))[slow] - 1.0, expected, rtol=0.01)
