"""The line of ISO 8608 through roads that were made with a known one."""

from __future__ import annotations

import numpy as np
import pytest
import scipy
from campaigns import sampled

import inerter as it
from inerter.errors import RecordError
from inerter.roads.spectrum import SAMPLING, _folding, _freedom


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
    found = it.road_spectrum(made(ord(letter), mean, waviness), sampling="filtered")
    assert found.waviness == pytest.approx(waviness, abs=0.05)
    assert found.unevenness == pytest.approx(mean, rel=0.1)
    assert 1.0 < found.scatter < 1.6


def test_its_road_is_that_of_the_class():
    profile = made(5, it.ROAD_CLASSES["C"].mean, 2.0)
    found = it.road_spectrum(profile, sampling="filtered")
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
    "no profile": (lambda: it.road_spectrum([1.0, 2.0]), "requires a Profile"),
    "a band upside down": (lambda: it.road_spectrum(made(1, 1e-5, 2.0, 100.0), 2.0, 1.0), "lowest < highest"),
    "no sampling": (lambda: it.road_spectrum(made(1, 1e-5, 2.0, 100.0), sampling="point"), "sampling.*got 'point'"),
    "no track": (lambda: it.road_spectrum(made(1, 1e-5, 2.0, 100.0), side="right"), "unknown track 'right'"),
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
    found = [it.road_spectrum(random_profile(length, seed), sampling="filtered") for seed in range(roads)]
    for values, true in (([f.standard for f in found], 64e-6), ([f.waviness for f in found], 2.0)):
        error = np.std(values, ddof=1) / np.sqrt(roads)
        assert abs(np.mean(values) - true) < 4.0 * error
        assert error < 0.012 * true


FINE = 64  # points of a road for each of its samples


def sampled_profiles(seed: int, waviness: float, interval: float) -> dict[str, it.Profile]:
    """One random road of class B with waves down to a thirty-second of an interval, sampled in each of the ways."""
    rng, step, count = np.random.default_rng(seed), interval / FINE, 2**19
    n = np.arange(1, count // 2 + 1) / (count * step)
    lines = np.zeros(count // 2 + 1, complex)
    noise = rng.normal(size=n.size) + 1j * rng.normal(size=n.size)
    lines[1:] = 0.5 * count * noise * np.sqrt(64e-6 * (n / 0.1) ** -waviness * n[0])
    whole = np.fft.irfft(lines, count)
    long = np.fft.irfft(np.where(np.arange(lines.size) * n[0] < 0.5 / interval, lines, 0.0), count)
    heights = {"points": whole[::FINE], "averages": whole.reshape(-1, FINE).mean(axis=1), "filtered": long[::FINE]}
    half = count // FINE // 2
    return {way: it.Profile(interval * np.arange(half), values[:half]) for way, values in heights.items()}


@pytest.mark.parametrize(("waviness", "interval"), sampled([(2.0, 0.25), (2.0, 0.05), (2.5, 0.25), (3.0, 0.5)], kept=1))
def test_samples_that_show_shorter_waves_give_the_line_of_the_road(waviness: float, interval: float):
    """The same roads without those waves are the reference, so that what is random in the others is the waves alone."""
    roads = [sampled_profiles(seed, waviness, interval) for seed in range(16)]
    true = [it.road_spectrum(road["filtered"], sampling="filtered") for road in roads]
    for way in ("points", "averages"):
        for quantity in ("standard", "unevenness", "waviness"):
            found = [getattr(it.road_spectrum(road[way], sampling=way), quantity) for road in roads]
            ratio = np.array(found) / [getattr(one, quantity) for one in true]
            error = ratio.std(ddof=1) / np.sqrt(ratio.size)
            assert error < 0.01
            assert abs(ratio.mean() - 1.0) < 4.0 * error + 1e-3  # waves that even these roads do not have
    if (waviness, interval) == (2.0, 0.25):  # and by how much there would be too much
        raw = [it.road_spectrum(road["points"], sampling="filtered").standard for road in roads]
        assert np.mean(np.array(raw) / [one.standard for one in true]) > 1.08


@pytest.mark.parametrize("sampling", SAMPLING)
@pytest.mark.parametrize("waviness", [1.3, 2.0, 2.5, 4.0])
def test_waves_that_look_alike_add_up(sampling: str, waviness: float):
    part = np.array([0.01, 0.1, 0.25, 0.4, 0.499])
    k = np.arange(-200_000, 200_001)[:, None]
    seen = np.abs(part + k) ** -waviness * (np.sinc(part + k) ** 2 if sampling == "averages" else 1.0)
    rest = 2.0 * 200_000.5 ** (1.0 - waviness) / (waviness - 1.0) if sampling == "points" else 0.0
    total = part**waviness * (np.sum(seen, axis=0) + rest)
    expected = np.ones(part.size) if sampling == "filtered" else total
    assert _folding(part, waviness, sampling) == pytest.approx(expected, rel=1e-7)
    if (sampling, waviness) == ("points", 2.0):
        assert total == pytest.approx((np.pi * part / np.sin(np.pi * part)) ** 2, rel=1e-7)


def test_noise_whose_shorter_waves_have_no_end_has_a_line_too():
    """White heights have a waviness of 0, for which the sum has no end: it is that of the least waviness then."""
    profile = it.Profile(0.1 * np.arange(4000), np.random.default_rng(2).normal(size=4000))
    found = it.road_spectrum(profile)
    assert np.isfinite([found.standard, found.unevenness, found.waviness, found.scatter]).all()
    assert it.road_spectrum(profile, sampling="filtered").waviness == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("points", [3000, 3001, 3006, 3011, 3197])
def test_every_profile_has_eight_segments(points: int):
    """Their number is in the effective length: that of one segment, times their number, with their correlation."""
    spectrum = it.road_spectrum(it.Profile(0.1 * np.arange(points), np.random.default_rng(1).normal(size=points)))
    segment = 1.0 / (spectrum.wavenumber[1] - spectrum.wavenumber[0])
    independent = 8.0 / (1.0 + 2.0 / 36.0 * 7.0 / 8.0) / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0))
    assert spectrum.effective_length == pytest.approx(segment * independent, rel=1e-5)


@pytest.mark.parametrize("segments", [2, 3, 6])
@pytest.mark.parametrize("lines", [1, 4])
def test_degrees_of_freedom_are_those_of_the_scatter_of_welchs_method(segments, lines):
    """A mean over neighbouring lines of white noise scatters as chi squared with them: variance over squared mean."""
    size, draws = 128, 3000
    noise = np.random.default_rng(segments).normal(size=(draws, segments * size))
    density = scipy.signal.welch(noise, nperseg=size, window="hann", detrend=False)[1]
    means = density[:, 20 : 20 + lines].mean(axis=1)
    expected = 2.0 / float(_freedom(segments * size, size, np.array(float(lines))))
    assert np.var(means) / np.mean(means) ** 2 == pytest.approx(expected, rel=0.12)


def test_the_side_had_another_name():
    made_of_two = it.Profile([0.0, 1.0, 2.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1])
    with pytest.warns(DeprecationWarning, match="`track` is now `side`"):
        old = made_of_two.to_signal(9.0, track="right")
    assert old(0.1) == made_of_two.to_signal(9.0, side="right")(0.1)
    with pytest.warns(DeprecationWarning, match="`track` is now `side`"):
        road = it.RoadInput("r", track="left")
    assert road == it.RoadInput("r", side="left")
    with pytest.warns(DeprecationWarning, match="`track` is now `side`"):
        assert road.track == "left"
