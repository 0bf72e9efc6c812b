"""Mean values of random cars: positive numbers, or a status with a sentence, and no exception but the project's own."""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import elements, logarithmic, networks
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, ExpectedValue, Friction, Gap, InerterError, RideComfort, Spring, TyreLoad
from inerter.methods.equivalent_linear import has_play
from inerter.methods.steady_squares import steady_squares
from inerter.simulation.inputs import tabulate
from inerter.systems.piecewise import piecewise

INDICES = [RideComfort(ROAD), TyreLoad(ROAD)]


def honest(estimate):
    """A positive value with its error, or none and the reason."""
    if estimate.status.kind in ("ok", "inaccurate"):
        assert 0.0 < estimate.value < math.inf
        assert estimate.standard_error >= 0.0
        assert estimate.interval[0] <= estimate.value <= estimate.interval[1]
    else:
        assert not 0.0 < estimate.value < math.inf
    assert estimate.status.ok or estimate.status.message


@pytest.mark.campaign
@settings(max_examples=6)
@given(
    networks(depth=1, most=3), elements(), logarithmic(1.0, 1e3), logarithmic(1e-5, 1e-2), st.booleans(), st.booleans()
)
def test_random_struts_with_friction_or_a_gap(inner, other, force, width, gap, held):
    loose = Gap(width) if gap else Friction(force)
    strut = Spring(3e4) | Damper(500.0) | (Spring(5e5) | Damper(1e3)) - (inner | Friction(force)) - (other | loose)
    method = ExpectedValue(realisations=2, conventions="paper2008" if held else "exact")
    for index in INDICES:
        with suppress(InerterError):  # such as a gap between inertias
            honest(it.evaluate(paper_quarter_car(strut), index, method))


@pytest.mark.parametrize("seed", range(3))
def test_random_half_cars(seed):
    rng = np.random.default_rng(seed)
    front, rear = (
        Spring(1e5) | Damper(s) | Friction(f) for s, f in zip([2e3, 3e3], rng.uniform(1, 500, 2), strict=True)
    )
    method = ExpectedValue(realisations=2, conventions=["exact", "paper2008", "exact"][seed])
    for index in INDICES:
        estimate = it.evaluate(paper_half_car(front, rear), index, method)
        honest(estimate)
        assert estimate.status.ok


@pytest.mark.parametrize(
    ("beside", "has_gap"),
    [
        (Damper(400.0), False),
        (Friction(30.0), False),
        (Spring(2e4) - Gap(1e-3), True),
        (Friction(30.0) | Spring(2e4) - Gap(1e-3), True),  # one damper would stand for the friction alone
    ],
)
def test_a_gap_is_known_beside_friction_too(beside, has_gap):
    assert has_play(piecewise(paper_quarter_car(Spring(3e4) | Damper(500.0) | beside))) == has_gap


def test_mean_squares_with_a_spectrum_are_those_of_the_samples(monkeypatch):
    strut = Spring(1.2e5) | Damper(7e3) - (Spring(1e6) | Damper(3e3)) - Gap(2e-4) - (it.Inerter(300.0) | Friction(10.0))
    system, signal = piecewise(paper_quarter_car(strut).mechanism()), it.multisine(ROAD, seed=1)
    table, outputs = tabulate([signal, None], [0.0, 0.0], 10.0, 5e-4), ["sprung_acceleration", "strut_travel"]
    transformed, rfft = [], np.fft.rfft
    monkeypatch.setattr(np.fft, "rfft", lambda motions: transformed.append(motions) or rfft(motions))
    found = steady_squares(system, table, outputs, [], np.zeros(system.order), spectra=["strut_travel"])
    run = it.simulate(paper_quarter_car(strut), road=signal, duration=10.0, step=5e-4, initial="periodic")
    motions = np.array([run[name][:-1] for name in outputs])
    np.testing.assert_allclose(found.power, np.mean(motions**2, axis=1), rtol=1e-9)
    assert [one.shape for one in transformed] == [(1, 20000)]  # only the spectrum that is wanted
    np.testing.assert_allclose(transformed[0][0], motions[1], atol=1e-8 * np.abs(motions[1]).max())
    angles = 2.0 * np.pi * np.arange(1, 400)[:, None] / 20000 * np.arange(20000)  # up to 40 Hz, by the definition
    lines = (np.cos(angles) @ motions[1]) ** 2 + (np.sin(angles) @ motions[1]) ** 2
    assert found.lines[1] == pytest.approx(lines.sum() ** 2 / (lines**2).sum(), rel=1e-3)
    assert math.isnan(found.lines[0])
