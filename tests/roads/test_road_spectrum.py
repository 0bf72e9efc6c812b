"""The line of ISO 8608 through roads that were made with a known one."""

from __future__ import annotations

import numpy as np
import pytest

import inerter as it
from inerter.errors import RecordError


def made(seed, unevenness, waviness, length=4000.0, interval=0.1):
    """A profile with Gd(n) = unevenness (n / n0)^-waviness: harmonics of random phase, all over its length."""
    n = np.arange(1, int(length / interval) // 2) / length
    amplitude = np.sqrt(2.0 * unevenness * (n / 0.1) ** -waviness / length)
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, n.size)
    spectrum = np.concatenate([[0.0], 0.5 * amplitude * np.exp(1j * phase)])
    count = round(length / interval)
    return it.Profile(interval * np.arange(count), np.fft.irfft(spectrum, count, norm="forward"))


@pytest.mark.parametrize("waviness", [1.6, 2.0, 2.5])
@pytest.mark.parametrize("letter", ["A", "C", "E"])
def test_the_line_is_found_again(letter, waviness):
    mean = it.ROAD_CLASSES[letter].mean
    found = it.road_spectrum(made(ord(letter), mean, waviness))
    assert found.waviness == pytest.approx(waviness, abs=0.05)
    assert found.unevenness == pytest.approx(mean, rel=0.1)
    assert 1.0 < found.scatter < 1.6


def test_its_road_is_that_of_the_class():
    profile = made(5, it.ROAD_CLASSES["C"].mean, 2.0)
    found = it.road_spectrum(profile)
    assert found.iso8608_class.letter == "C"
    assert found.road(20.0).roughness == pytest.approx(it.Road.iso8608("C", 20.0).roughness, rel=0.1)
    assert found.road(20.0).speed == 20.0


def test_the_density_holds_the_variance():
    profile = made(7, 256e-6, 2.0)
    found = it.road_spectrum(profile)
    part = found.wavenumber > 0.05
    step = found.wavenumber[1] - found.wavenumber[0]
    expected = 256e-6 * 0.01 * (1 / 0.05 - 1 / 5.0)
    assert np.sum(found.density[part]) * step == pytest.approx(expected, rel=0.1)


BAD = {
    "short": (lambda: it.road_spectrum(it.Profile([0.0, 1.0, 2.0], [0.0, 1.0, 0.0])), "too short"),
    "flat": (lambda: it.road_spectrum(it.Profile(np.arange(500.0), np.zeros(500))), "is flat"),
    "no profile": (lambda: it.road_spectrum([1.0, 2.0]), "that of a profile"),
    "a band upside down": (lambda: it.road_spectrum(made(1, 1e-5, 2.0, 100.0), 2.0, 1.0), "from a low to a higher"),
    "no track": (lambda: it.road_spectrum(made(1, 1e-5, 2.0, 100.0), track="right"), "has no track 'right'"),
}


@pytest.mark.parametrize(("ask", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_requests(ask, sentence):
    with pytest.raises(RecordError, match=sentence):
        ask()


def random_profile(length, seed, interval=0.05):
    """Heights of a random road of class B, waviness 2, cut out of one that is eight times as long."""
    rng, count = np.random.default_rng(seed), int(8 * length / interval)
    n = np.arange(1, count // 2 + 1) / (count * interval)
    lines = np.zeros(count // 2 + 1, complex)
    noise = rng.normal(size=n.size) + 1j * rng.normal(size=n.size)
    lines[1:] = 0.5 * count * noise * np.sqrt(64e-6 * (n / 0.1) ** -2.0 * n[0])
    points = int(length / interval)
    return it.Profile(interval * np.arange(points), np.fft.irfft(lines, count)[:points])


@pytest.mark.parametrize(("length", "roads"), [(300.0, 60), (2000.0, 20)])
def test_a_line_through_logarithms_is_not_too_low(length, roads):
    """Mean over random roads, within four standard errors; logarithms of few degrees of freedom have a lower mean."""
    found = [it.road_spectrum(random_profile(length, seed)) for seed in range(roads)]
    for values, true in (([f.standard for f in found], 64e-6), ([f.waviness for f in found], 2.0)):
        error = np.std(values, ddof=1) / np.sqrt(roads)
        assert abs(np.mean(values) - true) < 4.0 * error
        assert error < 0.012 * true
