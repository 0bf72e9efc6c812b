"""Measured roads in indices: the density that drives them, and norms against quadrature of a power law."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal

import inerter as it
from inerter.errors import PerformanceIndexError
from inerter.indices.measured_road import _alternating
from inerter.methods.error_bounds import improvement_bound
from inerter.methods.measured_road_errors import ROAD_ERRORS
from inerter.roads.spectrum import RoadSpectrum
from inerter.signals.road import RoadShape


def line(waviness, unevenness=64e-6):
    empty = np.zeros(0)
    return RoadSpectrum(empty, empty, unevenness, waviness, unevenness, 1.1, 0.011, 2.83)


@pytest.mark.parametrize("waviness", [0.05, 0.4, 1.3, 1.8, 2.0, 2.2, 3.0, 3.7, 3.95])
def test_its_density_is_the_line(waviness):
    speed, spectrum = 20.0, line(waviness)
    shaped = it.measured_road(spectrum, speed)
    n = np.geomspace(0.011, 2.83, 300)
    velocity = (
        np.abs(shaped.filter.response(2 * np.pi * n * speed)) ** 2 * shaped.amplitude_density**2
    )  # two-sided, per Hz
    density = 2.0 * velocity / (2 * np.pi * n * speed) ** 2 * speed  # of heights, one-sided, per cycle/m
    np.testing.assert_allclose(density, 64e-6 * (n / 0.1) ** -waviness, rtol=5.01e-3)


@pytest.mark.parametrize("waviness", [1.6, 2.4])
def test_norms_by_quadrature_of_the_power_law(waviness):
    """A comfort whose outputs feel little beyond the line: a quarter car with a soft spring."""
    speed = 20.0
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    found = it.evaluate(car, it.RandomResponse({"travel": 1.0}, it.measured_road(line(waviness), speed)), it.Norm())
    system = it.state_space(car, outputs="travel")
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


def measured(rng, waviness):
    """A spectrum whose bands lie about its line by a third, as those of a road of a kilometre do."""
    n = np.geomspace(0.011, 2.83, 90)
    density = 64e-6 * (n / 0.1) ** -waviness * np.exp(0.3 * rng.standard_normal(n.size))
    slope, level = np.polyfit(np.log(n / 0.1), np.log(density), 1)
    standard = float(np.exp(np.mean(np.log(density) + 2.0 * np.log(n / 0.1))))
    averages = tuple(zip(n.tolist(), density.tolist(), strict=True))
    return RoadSpectrum(n, density, float(np.exp(level)), -float(slope), standard, 1.3, 0.011, 2.83, 90, averages)


def by_quadrature(car, output, spectrum, speed):
    """R.m.s. of an output over the measured densities, and over `beyond(n)` where nothing was measured, as a function
    of `beyond`; impedances are solved at each frequency.
    """
    omega = 2.0 * math.pi * speed * np.unique(np.concatenate([np.geomspace(1e-4, 300.0, 60001), [0.011, 2.83]]))
    n, density = (np.array(column) for column in zip(*spectrum.averages, strict=True))
    own = omega / (2.0 * math.pi * speed)
    inside = (own >= n[0]) & (own <= n[-1])
    heights = np.interp(np.log(own), np.log(n), density * n**2) / own**2
    gain = np.abs(Nodal(car.mechanism(), omega).response(output, "road")).astype(float)  # from the road's velocity

    def rms(beyond):
        one_sided = np.where(inside, heights, beyond(own)) / speed  # per Hz
        return math.sqrt(np.trapezoid(gain**2 * omega**2 * one_sided, omega) / (2.0 * math.pi))

    return rms


@pytest.mark.parametrize("seed", sampled(range(12), [0], kept=3))
def test_the_error_bound_holds_against_the_densities_that_were_measured(seed):
    rng = np.random.default_rng([8608, seed])
    spectrum, speed = measured(rng, float(rng.uniform(1.5, 2.6))), float(rng.uniform(5.0, 40.0))
    damper = float(np.exp(rng.uniform(np.log(300.0), np.log(5e3))))
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(damper))
    two = 0.5 * spectrum.standard * 0.01
    measures = {it.RideComfort: "sprung_acceleration", it.TyreLoad: "tyre_load"}
    rms = {kind: by_quadrature(car, output, spectrum, speed) for kind, output in measures.items()}
    for road in (spectrum.road(speed), it.measured_road(spectrum, speed)):
        filtered = road.filter if hasattr(road, "filter") else None

        def stands(n, filtered=filtered, road=road):
            """The density that stands for the road where nothing was measured."""
            if filtered is None:
                return 2.0 * two / n**2
            shaped = np.abs(filtered.response(2.0 * np.pi * n * speed)) ** 2
            return 2.0 * road.road.roughness * shaped / n**2

        for kind in measures:
            found = it.evaluate(car, kind(road), it.Norm())
            assert found.status.ok == (sum(s.bound for s in found.error_sources if s.name != "rounding") <= 0.1)
            for factor in (0.0, 1.0, 2.0):
                truth = rms[kind](lambda n, factor=factor: factor * stands(n))
                assert abs(truth / found.value - 1.0) <= found.error_bound * 1.001 + 1e-4, factor
            line = next(source.bound for source in found.error_sources if source.name == "line of the road")
            kept = rms[kind](stands)
            assert line >= abs(kept / found.value - 1.0) - 3.6e-3
            assert line <= abs(kept / found.value - 1.0) + 3.6e-3  # by the filter alone


@pytest.mark.parametrize("seed", sampled(range(8), [2], kept=2))
def test_a_mean_over_speeds_is_off_by_the_mean_of_the_errors_with_their_signs(seed):
    rng = np.random.default_rng([8615, seed])
    spectrum, slow, fast = measured(rng, 2.0), float(rng.uniform(3.0, 10.0)), float(rng.uniform(20.0, 40.0))
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    speeds, shares = (slow, fast), (0.4, 0.6)
    use = it.Conditions([it.Condition(share, road={"speed": v}) for share, v in zip(shares, speeds, strict=True)])
    found = it.evaluate(car, use.mean(it.RideComfort(spectrum.road(slow))), it.Norm())

    def line(n):
        return spectrum.standard * 0.01 / n**2

    true = sum(
        s * by_quadrature(car, "sprung_acceleration", spectrum, v)(line) for s, v in zip(shares, speeds, strict=True)
    )
    (bound,) = (source.bound for source in found.error_sources if source.name == "line of the road")
    assert bound == pytest.approx(abs(true / found.value - 1.0), abs=1e-4)


def test_conditions_on_measured_roads_of_their_own_add_their_errors():
    rng = np.random.default_rng(8616)
    first, second = (measured(rng, 2.0).road(20.0) for _ in range(2))
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    use = it.Conditions([it.Condition(road=first), it.Condition(road=second)])
    found = it.evaluate(car, use.mean(it.RideComfort(first)), it.Norm())
    parts = found.in_conditions
    assert found.error_bound * found.value == pytest.approx(0.5 * sum(one.error_bound * one.value for one in parts))
    assert found.shared_errors == {}
    same = it.evaluate(car, it.Conditions([it.Condition(road=first)] * 2).mean(it.RideComfort(first)), it.Norm())
    assert same.error_bound == pytest.approx(parts[0].error_bound)
    assert same.shared_errors.keys() == parts[0].shared_errors.keys()


@pytest.mark.parametrize("seed", sampled(range(8), [0], kept=2))
def test_two_values_on_one_measured_road_share_its_errors(seed):
    """Improvements on the measured densities, with longer and with shorter waves missing or twice as much."""
    rng = np.random.default_rng([8609, seed])
    spectrum, speed = measured(rng, float(rng.uniform(1.7, 2.3))), float(rng.uniform(8.0, 35.0))
    struts = [it.Spring(2e4) | it.Damper(1.5e3), it.Spring(2e4) | it.Damper(2.5e3) - it.Inerter(200.0)]
    cars = [it.QuarterCar(250.0, 35.0, 1.5e5, strut) for strut in struts]
    road, two = spectrum.road(speed), 0.5 * spectrum.standard * 0.01
    for kind, output in ((it.RideComfort, "sprung_acceleration"), (it.TyreLoad, "tyre_load")):
        own, base = (it.evaluate(car, kind(road), it.Norm()) for car in cars)
        bounds = own.error_bound, base.error_bound
        found = improvement_bound(own.value, base.value, *bounds, own.shared_errors, base.shared_errors)
        assert found <= improvement_bound(own.value, base.value, *bounds)  # less, unless their effects are opposite
        assert improvement_bound(1.0, 1.0, own.error_bound, own.error_bound, *[own.shared_errors] * 2) < 1e-6
        truths = [by_quadrature(car, output, spectrum, speed) for car in cars]
        for longer in (0.0, 1.0, 2.0):
            for shorter in (0.0, 1.0, 2.0):

                def stands(n, factors=(longer, shorter)):
                    return np.where(n < 0.1, *factors) * 2.0 * two / n**2

                truth, reference = (rms(stands) for rms in truths)
                off = 100.0 * abs(truth / reference - own.value / base.value)
                assert off <= 1.02 * found + 0.01, (longer, shorter)


def test_a_road_says_how_far_its_line_may_lead_whatever_the_method():
    rng = np.random.default_rng(5)
    road = measured(rng, 1.8).road(20.0)
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3) | it.Friction(5.0))
    names, known = set(ROAD_ERRORS), []
    for method in (it.Norm(), it.StatisticalLinearisation(), it.ExpectedValue(realisations=2), it.ApproximateLinear()):
        found = it.evaluate(car, it.RideComfort(road), method)
        bounds = {source.name: source.bound for source in found.error_sources if source.name in names}
        assert bounds.keys() == names
        known.append(bounds["line of the road"])
    assert known == pytest.approx([known[0]] * 4, rel=0.1)  # friction changes little
    assert known[0] > 0.01
    found = it.evaluate(car, it.RideComfort(it.Road(1e-6, 20.0)), it.Norm())
    assert [source.name for source in found.error_sources] == ["rounding"]


def test_a_waviness_far_from_two_makes_a_line_of_two_inaccurate_and_says_by_how_much():
    n = np.geomspace(0.011, 2.83, 90)
    shape = RoadShape(tuple(n.tolist()), tuple(((n / 0.2) ** -1.0).tolist()))
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    found = it.evaluate(car, it.TyreLoad(it.Road(1e-6, 10.0, shape=shape)), it.Norm())
    assert found.status.kind == "inaccurate"
    assert "mostly from line of the road" in found.status.message


LEVEL = 64e-6  # [m^3] of random roads, at 0.1 cycle/m


def drive(car, spring, damper, lines, n, speed):
    """Fourier coefficients of the body's acceleration and the tyre load of a quarter car, from those of heights."""
    s = 2j * np.pi * n * speed
    m, w, k = car.sprung_mass, car.unsprung_mass, car.tyre_stiffness
    strut = spring + damper * s
    wheel = k * lines * (m * s**2 + strut) / ((m * s**2 + strut) * (w * s**2 + strut + k) - strut**2)
    return {it.RideComfort: s**2 * wheel * strut / (m * s**2 + strut), it.TyreLoad: k * (lines - wheel)}


@dataclass(frozen=True)
class Driven:
    """A quarter car by one index on a random profile: its estimate, and its true r.m.s. values over the estimate."""

    found: it.Estimate
    on_profile: float  # of the motion on the profile itself
    on_road: float  # of the road that the profile is a sample of

    @property
    def by_bands(self):
        """The value on the densities of the bands, over the estimate."""
        return 1.0 + self.found.shared_errors["line of the road"][0]


def gaussian_road(rng, length, waviness):
    """Wavenumbers of a Gaussian road, Fourier coefficients of its heights, the part of anything on it that is a
    profile of this length, and the spectrum of that profile.
    """
    step = 0.1
    points = round(length / step)
    count = points * (8 if length < 5e3 else 2)
    n = np.arange(1, count // 2 + 1) / (count * step)
    noise = rng.standard_normal((2, n.size)).T @ [1.0, 1.0j]
    lines = 0.5 * count * noise * np.sqrt(LEVEL * (n / 0.1) ** -waviness * n[0])

    def section(coefficients):
        return np.fft.irfft(np.concatenate([[0.0], coefficients]), count)[count // 2 :][:points]

    profile = it.Profile(step * np.arange(points), section(lines))
    return n, lines, section, it.road_spectrum(profile, sampling="filtered")


@cache
def driven_members(seed, length, keep_waviness):
    """Two random quarter cars by two indices on a Gaussian profile, cut out of one at least twice as long."""
    members = []
    rng = np.random.default_rng([8611, round(length), seed])
    speed, waviness = rng.uniform(10.0, 30.0), rng.uniform(1.8, 2.2)
    n, lines, section, spectrum = gaussian_road(rng, length, waviness)
    road = it.measured_road(spectrum, speed) if keep_waviness else spectrum.road(speed)
    fine = np.geomspace(1e-4, 300.0, 6001)
    density = LEVEL * (fine / 0.1) ** -waviness
    for _ in range(2):
        spring, damper = np.exp(rng.uniform(np.log([1e4, 700.0]), np.log([5e4, 4e3])))
        car = it.QuarterCar(rng.uniform(200, 500), rng.uniform(25, 60), 2e5, it.Spring(spring) | it.Damper(damper))
        motion, gains = drive(car, spring, damper, lines, n, speed), drive(car, spring, damper, 1.0, fine, speed)
        for index, response in motion.items():
            found = it.evaluate(car, index(road), it.Norm())
            true = math.sqrt(np.trapezoid(np.abs(gains[index]) ** 2 * density, fine))
            own = math.sqrt(np.mean(section(response) ** 2))
            members.append((index, Driven(found, own / found.value, true / found.value)))
    return members


def rms(values):
    return math.sqrt(np.mean(np.square(values)))


LENGTHS = [
    (1e3, 40),
    pytest.param(16e3, 20, marks=pytest.mark.campaign),
    pytest.param(1e3, 150, marks=pytest.mark.campaign),
]


@pytest.mark.parametrize(("length", "count"), LENGTHS)
@pytest.mark.parametrize("keep_waviness", [True, False])
def test_the_scatter_of_the_spectrum_of_a_profile_is_in_the_bound(length, count, keep_waviness):
    """Random cars on random profiles: the scores are errors over their standard deviations, whose r.m.s. is one."""
    members = [driven_members(seed, length, keep_waviness) for seed in range(count)]
    for index in (it.RideComfort, it.TyreLoad):
        own = [one for each in members for kind, one in each if kind is index]
        for truth in ("on_road", "on_profile"):
            beyond = [abs(getattr(one, truth) - 1.0) > one.found.error_bound for one in own]
            assert np.mean(beyond) <= 0.05
        if index is it.TyreLoad:
            continue  # which longer waves than measured change
        half = [0.5 * math.hypot(*one.found.shared_errors["length of the profile"]) for one in own]
        scores = {
            truth: [(getattr(one, truth) / one.by_bands - 1.0) / sd for one, sd in zip(own, half, strict=True)]
            for truth in ("on_road", "on_profile")
        }
        assert 0.75 < rms(scores["on_road"]) < 1.25  # neither too narrow nor too wide
        assert rms(scores["on_profile"]) < rms(scores["on_road"])


@pytest.mark.parametrize(("length", "count"), LENGTHS)
def test_a_mean_over_speeds_has_the_scatter_of_the_spectrum_by_its_bands(length, count):
    beyond, scores, sizes = [], [], []
    for seed in range(count):
        rng = np.random.default_rng([8617, round(length), seed])
        waviness, speeds = rng.uniform(1.8, 2.2), rng.uniform([4.0, 20.0], [10.0, 40.0])
        fine = np.geomspace(1e-4, 300.0, 6001)
        spectrum = gaussian_road(rng, length, waviness)[-1]
        spring, damper = np.exp(rng.uniform(np.log([1e4, 700.0]), np.log([5e4, 4e3]))).tolist()
        car = it.QuarterCar(300.0, 35.0, 2e5, it.Spring(spring) | it.Damper(damper))
        road, density = it.measured_road(spectrum, float(speeds[0])), LEVEL * (fine / 0.1) ** -waviness
        use = it.Conditions([it.Condition(road={"speed": speed}) for speed in speeds.tolist()])
        found = it.evaluate(car, use.mean(it.RideComfort(road)), it.Norm())
        gains = [drive(car, spring, damper, 1.0, fine, speed)[it.RideComfort] for speed in speeds]
        true = np.mean([math.sqrt(np.trapezoid(np.abs(gain) ** 2 * density, fine)) for gain in gains]) / found.value
        bounds = {source.name: source.bound for source in found.error_sources}
        half = 0.5 * bounds["length of the profile"]
        beyond.append(abs(true - 1.0) > found.error_bound)
        scores.append((true / (1.0 + found.shared_errors["line of the road"][0]) - 1.0) / half)
        parts = sum(one.value * math.hypot(*one.shared_errors["length of the profile"]) for one in found.in_conditions)
        sizes.append(4.0 * half * found.value / parts)
    assert np.mean(beyond) <= 0.05
    assert 0.75 < rms(scores) < 1.25
    assert np.median(sizes) < 0.95  # of the sum of both errors


@pytest.mark.parametrize(("length", "count"), LENGTHS)
def test_two_designs_share_the_scatter_of_the_spectrum_by_its_bands(length, count):
    scores, beyond, sizes = [], [], []
    for seed in range(count):
        first, second = (one for kind, one in driven_members(seed, length, True) if kind is it.RideComfort)
        effects = [np.array(one.found.shared_errors["length of the profile"]) for one in (first, second)]
        ratio = first.found.value / second.found.value
        off = [getattr(first, truth) / getattr(second, truth) - 1.0 for truth in ("on_road", "on_profile")]
        errors = [one.found.error_bound for one in (first, second)]
        shared = [one.found.shared_errors for one in (first, second)]
        bound = improvement_bound(first.found.value, second.found.value, *errors, *shared)
        beyond += [100.0 * ratio * abs(one) > bound for one in off]
        sizes.append(np.linalg.norm(effects[0] - effects[1]) / sum(map(np.linalg.norm, effects)))
        by_bands = first.by_bands / second.by_bands
        scores.append(((off[0] + 1.0) / by_bands - 1.0) / (0.5 * np.linalg.norm(effects[0] - effects[1])))
    assert np.mean(beyond) <= 0.05
    assert 0.7 < rms(scores) < 1.3
    assert np.median(sizes) < 0.7  # of both together, which would be the error on roads of their own


def test_another_road_takes_its_place():
    car = it.QuarterCar(250.0, 35.0, 1.5e5, it.Spring(2e4) | it.Damper(1.5e3))
    road = it.Road(3e-7, 17.0)
    there = it.Conditions([it.Condition(road=road)]).mean(it.RideComfort(it.measured_road(line(1.4), 25.0)))
    expected = it.evaluate(car, it.RideComfort(road), it.Norm()).value
    assert it.evaluate(car, there, it.Norm()).value == pytest.approx(expected, rel=1e-12)


BAD = {
    "cannot be fitted": (lambda: it.measured_road(it.Road(1e-6, 20.0), 20.0), r"requires road_spectrum\(profile\)"),
    "no speed": (lambda: it.measured_road(line(2.0), 0.0), "speed over a measured road must be a positive"),
    "too steep": (lambda: it.measured_road(line(4.5), 20.0), "waviness of the spectrum is 4.5"),
}


@pytest.mark.parametrize(("make", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_requests(make, sentence):
    with pytest.raises(PerformanceIndexError, match=sentence):
        make()


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("power", [0.3, -0.7])
def test_the_filter_of_a_line_is_as_far_from_both_ends_of_its_band(power: float, count: int) -> None:
    """Poles and zeros lie evenly over the logarithm of the frequency: gains mirror in the middle of the band."""
    ends, unit = (0.4, 90.0), 2.0
    centre, away = math.sqrt(ends[0] * ends[1]), np.geomspace(1.0, 1e3, 13)
    found = _alternating(power, ends, unit, count)
    above, below = (np.abs(found.response(centre * ratio)) for ratio in (away, 1.0 / away))
    middle = (centre / unit) ** power
    np.testing.assert_allclose(above * below, middle**2, rtol=1e-9)
    assert above[0] == pytest.approx(middle, rel=1e-12)
