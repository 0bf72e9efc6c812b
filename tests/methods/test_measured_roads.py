"""Measured roads in indices: the density that drives them, and norms against quadrature of a power law."""

from __future__ import annotations

import math

import numpy as np
import pytest

import inerter as it
from inerter.errors import PerformanceIndexError
from inerter.roads.spectrum import RoadSpectrum


def line(waviness, unevenness=64e-6):
    empty = np.zeros(0)
    return RoadSpectrum(empty, empty, unevenness, waviness, unevenness, 1.1, 0.011, 2.83)


@pytest.mark.parametrize("waviness", [0.05, 0.4, 1.3, 1.8, 2.0, 2.2, 3.0, 3.7, 3.95])
def test_its_density_is_the_line(waviness):
    speed, spectrum = 20.0, line(waviness)
    shaped = it.measured_road(spectrum, speed)
    n = np.geomspace(0.011, 2.83, 300)
    velocity = np.abs(shaped.filter.response(2 * np.pi * n * speed)) ** 2 * shaped.size**2  # two-sided, per Hz
    density = 2.0 * velocity / (2 * np.pi * n * speed) ** 2 * speed  # of heights, one-sided, per cycle/m
    np.testing.assert_allclose(density, 64e-6 * (n / 0.1) ** -waviness, rtol=5.01e-3)


@pytest.mark.parametrize("waviness", [1.6, 2.4])
def test_norms_by_quadrature_of_the_power_law(waviness):
    """A comfort whose outputs feel little beyond the line: a quarter car with a soft spring."""
    speed = 20.0
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    found = it.evaluate(car, it.RandomResponse({"travel": 1.0}, it.measured_road(line(waviness), speed)), it.Norm())
    system = it.assemble(car, outputs="travel")
    omega = np.geomspace(2 * np.pi * speed * 0.011 / 10, 2 * np.pi * speed * 28.3, 20000)
    resolvent = np.linalg.solve(1j * omega[:, None, None] * np.eye(len(system.A)) - system.A, system.B[None])
    gain = np.abs((system.C @ resolvent + system.D)[:, 0, 0])
    heights = 64e-6 * (omega / (2 * np.pi * speed) / 0.1) ** -waviness / speed  # one-sided, per Hz
    power = np.trapezoid(gain**2 * omega**2 * heights * omega, np.log(omega)) / (2 * math.pi)
    assert found.status.ok
    assert found.value == pytest.approx(math.sqrt(power), rel=6e-3)


def test_at_another_speed_it_is_the_same_road():
    rng = np.random.default_rng(17)
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    for waviness in rng.uniform(1.0, 3.0, 6):
        (first, second), spectrum = rng.uniform(5.0, 40.0, 2), line(float(waviness))
        use = it.Conditions([it.Condition(road={"speed": float(second)})])
        for index in (it.RideComfort, it.TyreLoad):
            there = use.mean(index(it.measured_road(spectrum, float(first))))
            expected = it.evaluate(car, index(it.measured_road(spectrum, float(second))), it.Norm()).value
            assert it.evaluate(car, there, it.Norm()).value == pytest.approx(expected, rel=1e-12)


def test_another_road_takes_its_place():
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    road = it.Road(3e-7, 17.0)
    there = it.Conditions([it.Condition(road=road)]).mean(it.RideComfort(it.measured_road(line(1.4), 25.0)))
    expected = it.evaluate(car, it.RideComfort(road), it.Norm()).value
    assert it.evaluate(car, there, it.Norm()).value == pytest.approx(expected, rel=1e-12)


BAD = {
    "no spectrum": (lambda: it.measured_road(it.Road(1e-6, 20.0), 20.0), "that of road_spectrum"),
    "no speed": (lambda: it.measured_road(line(2.0), 0.0), "speed over a measured road must be a positive"),
    "too steep": (lambda: it.measured_road(line(4.5), 20.0), "waviness of the spectrum is 4.5"),
}


@pytest.mark.parametrize(("make", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_requests(make, sentence):
    with pytest.raises(PerformanceIndexError, match=sentence):
        make()
