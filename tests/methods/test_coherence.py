"""Two tracks with a coherence: exact norms against quadrature of cross-spectra and against simulated roads."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from scipy.special import k1

import inerter as it
from inerter.errors import PerformanceIndexError, SimulationError

WHEELS = [f"{axle}_{side}" for axle in ("front", "rear") for side in ("left", "right")]


def car(rng):
    """A full car of random values, whose anti-roll bars are springs."""

    def about(value):
        return float(value * np.exp(rng.uniform(-0.3, 0.3)))

    strut = it.Spring(about(25e3)) | it.Damper(about(1500)) - it.Inerter(about(80)) | it.Damper(about(800))
    return it.FullCar(
        sprung_mass=about(1400),
        pitch_inertia=about(2400),
        roll_inertia=about(520),
        unsprung_mass_front=about(45),
        unsprung_mass_rear=about(40),
        tyre_stiffness_front=about(220e3),
        tyre_stiffness_rear=about(220e3),
        distance_front=about(1.2),
        distance_rear=about(1.5),
        track_front=1.52,
        track_rear=1.52,
        front=strut,
        rear=strut,
        anti_roll_front=it.Spring(about(8e3)),
        anti_roll_rear=it.Spring(about(5e3)),
    )


def by_quadrature(vehicle, road, outputs, coherence):
    """R.m.s. values of outputs: the integral of gains times the cross-spectra of four wheels, over all frequencies."""
    omega = np.geomspace(1e-4, 1e6, 12000)
    power = squared_gains(vehicle, road, outputs, coherence, omega)
    total = np.trapezoid(power * omega[:, None], np.log(omega), axis=0) / math.pi
    return road.velocity_intensity * np.sqrt(total)


def squared_gains(vehicle, road, outputs, coherence, omega):
    """Of outputs over white road velocity (frequencies, outputs); `coherence` is a function of wavenumber [cycle/m]."""
    roads = {r.name: r for r in vehicle.mechanism().roads}
    system = it.state_space(vehicle, list(roads), outputs)
    s = 1j * omega[:, None, None]
    gains = system.C @ np.linalg.solve(s * np.eye(len(system.A)) - system.A, system.B[None]) + system.D
    late = np.array([r.distance / road.speed for r in roads.values()])
    arriving = gains * np.exp(-1j * omega[:, None, None] * late)
    left = np.array([r.side == "left" for r in roads.values()])
    alike = left[:, None] == left[None, :]
    cross = coherence(omega / (2 * np.pi * road.speed))[:, None, None]
    spectra = np.where(alike, 1.0, cross)
    return np.einsum("woi,wij,woj->wo", arriving, spectra, arriving.conj()).real


def random_coherence(rng):
    """A coherence, and its formula as the literature has it."""
    level, corner, track = rng.uniform(0.2, 1.0), rng.uniform(0.05, 1.0), rng.uniform(0.8, 2.0)
    choice = int(rng.integers(3))
    if choice == 0:
        return it.Coherence.constant(level), lambda n: np.full_like(n, level)
    if choice == 1:
        return it.Coherence.first_order(corner, level), lambda n: level / (1 + (n / corner) ** 2)
    return it.Coherence.isotropic(track), lambda n: 2 * np.pi * n * track * k1(2 * np.pi * n * track)


def check_one(seed):
    rng = np.random.default_rng(seed)
    vehicle, (coherence, formula) = car(rng), random_coherence(rng)
    road = it.Road(5e-7, float(rng.uniform(8.0, 40.0)), coherence=coherence)
    outputs = ["sprung_acceleration", "roll_acceleration", "front_left_travel"]
    expected = by_quadrature(vehicle, road, outputs, formula)
    for output, value in zip(outputs, expected, strict=True):
        found = it.evaluate(vehicle, it.RandomResponse({output: 1.0}, road), it.Norm())
        assert found.status.ok
        assert found.value == pytest.approx(value, rel=2e-5), output


@pytest.mark.parametrize("seed", sampled(range(3), [0], kept=1))
def test_norms_by_quadrature(seed):
    check_one(seed)


@pytest.mark.parametrize("chunk", sampled(range(5), kept=0))
def test_many_norms_by_quadrature(chunk):
    for seed in range(3 + 12 * chunk, 15 + 12 * chunk):
        check_one(seed)


@pytest.mark.campaign
def test_searches_with_a_constant_coherence_are_compiled(monkeypatch):
    """Values and slopes against quadrature, and none of them from fractions, which take a thousand times as long."""
    vehicle, road = car(np.random.default_rng(1)), it.Road(5e-7, 22.0, coherence=it.Coherence.constant(0.6))
    strut = it.Spring(25e3) | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(it.free(1.0, 2e3, "b"))
    free, index = replace(vehicle, front=strut, rear=strut), it.RandomResponse({"roll_acceleration": 1.0}, road)
    objective = it.Norm().objective(free, index)
    assert np.isfinite(objective.values(np.array([[2e3, 100.0]]))).all()
    monkeypatch.setattr("inerter.methods.compiled_norm.h2_exactly", None)

    def at(c, b):
        expected = by_quadrature(free.with_values({"c": c, "b": b}), road, ["roll_acceleration"], road.coherence)
        return float(expected[0])

    for c, b in ((500.0, 30.0), (2e3, 100.0), (8e3, 400.0)):
        value, gradient = objective.value_and_gradient(np.array([c, b]))
        assert value == pytest.approx(at(c, b), rel=2e-5)
        ends = (at(c * 1.01, b), at(c / 1.01, b)), (at(c, b * 1.01), at(c, b / 1.01))
        slopes = [(above - below) / (2.0 * math.log(1.01)) for above, below in ends]
        np.testing.assert_allclose(gradient * [c, b], slopes, atol=2e-4 * value)


def test_a_filter_without_states_is_a_number():
    """Twice the road makes twice the motion, also where the road's shape is held in the tyres."""
    axle, strut = {"unsprung_mass": 40.0, "tyre_stiffness": 2e5}, it.Spring(3e4) | it.Damper(it.free(1e3, 1e4, "c"))
    vehicle = it.HalfCar(
        sprung_mass=700.0,
        pitch_inertia=1100.0,
        distance_front=1.2,
        distance_rear=1.4,
        front=strut,
        rear=strut,
        **{f"{name}_{where}": value for name, value in axle.items() for where in ("front", "rear")},
    )
    road = it.Road(5e-7, 22.0)
    indices = [it.RideComfort(road), it.RideComfort(it.FilteredExcitation(road, it.Filter([4.0], [2.0])))]
    many = it.evaluate_many(vehicle, indices, {"c": [1.5e3, 4e3]}, it.Norm())
    one = [it.evaluate(vehicle.with_values({"c": 4e3}), index, it.Norm()).value for index in indices]
    np.testing.assert_allclose(many[:, 1], 2.0 * many[:, 0], rtol=1e-9)
    np.testing.assert_allclose(one, many[1], rtol=1e-9)


def check_simulated(count, coherence, lowest, near, seed=0):
    """Norms against multisines simulated on both tracks: mean squares with their scatter.

    What a norm has beyond the lines of these roads is the difference to the sum over the lines, `near` of it at most.
    """
    vehicle, road = car(np.random.default_rng(seed)), it.Road(5e-7, 22.0, coherence=coherence)
    outputs = ["sprung_acceleration", "roll_acceleration", "front_left_travel"]
    roads = [it.two_tracks(road, 100 * seed + i, lowest, 50.0) for i in range(count)]
    runs = [it.simulate(vehicle, road=tracks, step=1e-3, initial="periodic") for tracks in roads]
    omega = 2 * np.pi * roads[0]["left"].frequencies
    power = squared_gains(vehicle, road, outputs, road.coherence, omega).sum(axis=0)
    on_lines = 2.0 * lowest * road.velocity_intensity**2 * power
    for output, lines in zip(outputs, on_lines, strict=True):
        squares = np.array([run.rms(output) ** 2 for run in runs])
        norm = it.evaluate(vehicle, it.RandomResponse({output: 1.0}, road), it.Norm()).value
        assert abs(lines - norm**2) < near * norm**2, output
        assert abs(squares.mean() - lines) < 4.5 * squares.std(ddof=1) / math.sqrt(count) + 1e-3 * lines, output


def test_simulated_roads_have_the_coherence():
    check_simulated(3, it.Coherence.first_order(0.3), lowest=0.125, near=0.15)


@pytest.mark.campaign
@pytest.mark.parametrize("coherence", [it.Coherence.first_order(0.3), it.Coherence.isotropic(1.52)])
def test_64_simulated_roads(coherence):
    check_simulated(64, coherence, lowest=0.1, near=0.05, seed=3)


@pytest.mark.marathon
def test_roads_of_the_expected_value():
    """With friction that hardly matters, means over random roads are near the norm without it."""
    vehicle = car(np.random.default_rng(5))
    rough = replace(vehicle, front=vehicle.front | it.Friction(2.0), rear=vehicle.rear | it.Friction(2.0))
    index = it.RideComfort(it.Road(5e-7, 22.0, coherence=it.Coherence.first_order(0.3)))
    found = it.evaluate(rough, index, it.ExpectedValue(realisations=8, seed=0))
    assert found.standard_error > 0.0
    assert found.value == pytest.approx(it.evaluate(vehicle, index, it.Norm()).value, rel=0.02)


def test_the_spectra_of_both_tracks():
    """Means over many seeds: each track has the spectrum of the road, and both the cross-spectrum."""
    road = it.Road(5e-7, 20.0, coherence=it.Coherence.first_order(0.3))
    tracks = [it.two_tracks(road, seed, 0.5, 50.0) for seed in range(400)]
    left, right = (np.array([t[side].coefficient for t in tracks]) for side in ("left", "right"))
    frequency = tracks[0]["left"].frequencies
    alone = np.abs(it.multisine(road, 0, 0.5, 50.0).coefficient) ** 2
    np.testing.assert_allclose(np.mean(np.abs(left) ** 2, axis=0) / alone, 1.0, atol=0.25)
    np.testing.assert_allclose(np.mean(np.abs(right) ** 2, axis=0) / alone, 1.0, atol=0.25)
    cross = np.mean(left * right.conj(), axis=0) / alone
    np.testing.assert_allclose(cross, 1.0 / (1.0 + (frequency / 20.0 / 0.3) ** 2), atol=0.25)
    assert np.abs(np.mean(cross - road.coherence(frequency / 20.0))) < 0.02


def test_the_isotropic_one_is_its_formula():
    x = np.geomspace(1e-4, 50.0, 20000)
    np.testing.assert_allclose(it.Coherence.isotropic(1.0)(x / (2 * np.pi)), x * k1(x), rtol=1e-12, atol=1e-15)


def test_tracks_that_are_alike():
    vehicle = car(np.random.default_rng(1))
    alike, one = (it.Road(5e-7, 22.0, coherence=c) for c in (it.Coherence.constant(1.0), None))
    values = [it.evaluate(vehicle, it.TyreLoad(road), it.Norm()).value for road in (alike, one)]
    assert values[0] == pytest.approx(values[1], rel=1e-12)
    assert it.evaluate(vehicle, it.RandomResponse({"roll_acceleration": 1.0}, alike), it.Norm()).value < 1e-9


def test_one_track_has_no_coherence():
    """A quarter car meets one track, which is as rough as ever."""
    strut = it.Spring(2e4) | it.Damper(1.5e3)
    alone = it.QuarterCar(250.0, 35.0, 1.5e5, strut)
    values = [
        it.evaluate(alone, it.RideComfort(it.Road(5e-7, 22.0, coherence=c)), it.Norm()).value
        for c in (None, it.Coherence.first_order(0.2))
    ]
    assert values[0] == values[1]


BAD = {
    "a level above one": (lambda: it.Coherence.constant(1.5), "level of a coherence must be a number from -1 to 1"),
    "a level of words": (lambda: it.Coherence.constant("half"), "level of a coherence"),
    "no corner": (lambda: it.Coherence.first_order(0.0), "wavenumber of a coherence must be a positive"),
    "a wrong track": (lambda: it.Coherence.isotropic(-1.0), "track of a coherence must be a positive"),
    "more than one": (lambda: it.Coherence((1.0, 1.0), (1.0, 0.5)), "must be between -1 and 1"),
    "a pole": (lambda: it.Coherence((0.1,), (1.0, -1.0)), "must be between -1 and 1"),
    "nothing": (lambda: it.Coherence((), (1.0,)), "numerator of a coherence must be a list"),
    "a number": (lambda: it.Road(5e-7, 25.0, coherence=0.5), "coherence of a road must be a Coherence"),
}


@pytest.mark.parametrize(("make", "sentence"), BAD.values(), ids=BAD.keys())
def test_bad_coherences(make, sentence):
    with pytest.raises(PerformanceIndexError, match=sentence):
        make()


def test_a_wheel_on_neither_track():
    base = car(np.random.default_rng(1)).mechanism()
    third = it.Mechanism(
        coordinates=base.coordinates,
        struts=base.struts,
        tyres=(*base.tyres, it.Tyre("spare", it.Spring(1e5), {"sprung": 1.0}, "middle")),
        roads=(*base.roads, it.RoadInput("middle")),
        measures=base.measures,
    )
    road = it.Road(5e-7, 22.0, coherence=it.Coherence.first_order(0.2))
    with pytest.raises(PerformanceIndexError, match="'middle' is on neither of them"):
        it.evaluate(third, it.RideComfort(road), it.Norm())
    with pytest.raises(SimulationError, match="Unknown input 'left'"):
        it.simulate(third, road=it.two_tracks(road, 0), duration=1.0)
