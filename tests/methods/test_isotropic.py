"""Isotropic coherence: norms against quadrature with the Bessel function over a balance of forces of their own."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from campaigns import sampled
from scipy.special import digamma, k1

import inerter as it
from inerter.errors import PerformanceIndexError
from inerter.kernels.excess import corrections
from inerter.norms import excess
from inerter.signals.coherence import isotropic_exponentials

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
LEFT = np.array([True, False, True, False])
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True)
class Car:
    """The numbers of a full car whose struts are k | c | (c2 - b), the same on both sides; or k | c | (k2 - b)."""

    body: np.ndarray  # mass, moments of inertia of pitch and roll
    wheels: np.ndarray  # masses (4,)
    tyres: np.ndarray  # stiffnesses (2,)
    places: np.ndarray  # distances of the axles from the centre of mass
    tracks: np.ndarray
    struts: np.ndarray  # k, c, c2, b (2, 4)
    bar: float  # N/m, of the front
    beside: type[it.Damper] | type[it.Spring] = it.Damper  # the inerter

    def mechanism(self) -> it.Mechanism:
        """As the package has it, with wheels of their own masses."""
        rows = self.struts.tolist()
        struts = [it.Spring(k) | it.Damper(c) | self.beside(own) - it.Inerter(b) for k, c, own, b in rows]
        numbers = [*self.body, *self.wheels[::2], *self.tyres, *self.places, *self.tracks]
        car = it.FullCar(*map(float, numbers), front=struts[0], rear=struts[1], anti_roll_front=it.Spring(self.bar))
        masses = dict(zip((f"unsprung_{wheel}" for wheel in WHEELS), self.wheels.tolist(), strict=True))
        found = car.mechanism()
        own = (replace(c, inertia=masses[c.name]) if c.name in masses else c for c in found.coordinates)
        return replace(found, coordinates=tuple(own))

    def gains(self, omega: np.ndarray, output: str) -> np.ndarray:
        """Of an output over the velocity of the road at each wheel (frequencies, 4): balance of forces of 7 bodies."""
        s = 1j * omega
        front, side = np.array([1, 1, -1, -1]), np.where(LEFT, 0.5, -0.5)
        arms = np.column_stack([np.ones(4), front * self.places.repeat(2), side * self.tracks.repeat(2)])
        k, c, own, b = (self.struts[:, i].repeat(2) for i in range(4))
        s4 = s[:, None]
        beside = own * (s4 if self.beside is it.Damper else 1.0)  # its dynamic stiffness
        dynamic = k + s4 * c + beside * b * s4**2 / (beside + b * s4**2)
        kt = self.tyres.repeat(2)
        travel = np.hstack([arms, -np.eye(4)])
        Z = np.einsum("wi,ij,ik->wjk", dynamic, travel, travel).astype(complex)
        roll = travel[0] - travel[1]
        Z += self.bar * np.outer(roll, roll)
        Z[:, range(7), range(7)] += np.concatenate([self.body, self.wheels]) * s4**2
        Z[:, range(3, 7), range(3, 7)] += kt
        right = np.vstack([np.zeros((3, 4)), np.diag(kt)]).astype(complex)
        x = np.linalg.solve(Z, np.broadcast_to(right, (omega.size, 7, 4))) / s[:, None, None]
        wheel = x[:, 3] - np.array([1, 0, 0, 0]) / s4
        return {
            "sprung_acceleration": x[:, 0] * s4**2,
            "roll_acceleration": x[:, 2] * s4**2,
            "roll_displacement": x[:, 2],
            "front_left_travel": np.einsum("j,wji->wi", travel[0], x),
            "anti_roll_front_travel": np.einsum("j,wji->wi", roll, x),
            "tyre_front_left_load": kt[0] * wheel,
        }[output]

    def poles(self) -> np.ndarray:
        """Where gains are large: they only place the panels of a quadrature."""
        return np.linalg.eigvals(it.state_space(self.mechanism()).A)


OUTPUTS = (
    "sprung_acceleration", "roll_acceleration", "roll_displacement", "front_left_travel", "anti_roll_front_travel",
    "tyre_front_left_load",
)  # fmt: skip


def random_car(rng, lopsided):
    """A car of random values, some of them hardly damped."""

    def about(*values):
        return np.array(values) * np.exp(rng.uniform(-0.5, 0.5, len(values)))

    damping = math.exp(rng.uniform(math.log(3.0), math.log(5e3)))
    struts = np.array([about(25e3, damping, 2e3, 60.0), about(25e3, damping, 1e3, 90.0)])
    wheels = about(45.0, 40.0).repeat(2) * (np.exp(rng.uniform(-0.2, 0.2, 4)) if lopsided else 1.0)
    return Car(
        about(1400.0, 2400.0, 520.0), wheels, about(2e5, 2e5), about(1.2, 1.5), about(1.5, 1.5), struts,
        float(about(1e4)[0]),
    )  # fmt: skip


def difference(x):
    """1 - x K1(x); by its series in long waves, where it would cancel."""
    near = np.minimum(x, 0.5)
    series, term = np.zeros_like(near), np.ones_like(near)
    for k in range(10):
        series += term * (digamma(k + 1) + digamma(k + 2) - 2.0 * np.log(near / 2.0))
        term = term * (near / 2.0) ** 2 / ((k + 1) * (k + 2))
    far = np.maximum(x, 0.5)
    return np.where(x < 0.5, (near / 2.0) ** 2 * series, 1.0 - far * k1(far))


def by_quadrature(car, speed, track, output):
    """Norm over unit white velocity of each track: cross-spectra of the four wheels, Gauss rules on graded panels."""
    poles, late = car.poles(), car.places.sum() / speed
    sizes = np.abs(poles)
    slowest, fastest = sizes[sizes > 1e-9 * sizes.max()].min(), sizes.max()
    low, high = 1e-9 * min(slowest, speed / track), 1e9 * max(fastest, speed / track)
    edges = [np.geomspace(low, high, int(3 * math.log2(high / low)))]
    for pole in poles[poles.imag > 0.0]:
        steps = max(abs(pole.real), 1e-14 * abs(pole)) * 1.8 ** np.arange(0.0, 60.0)
        edges += [pole.imag + steps[steps < pole.imag], pole.imag - steps[steps < 0.9 * pole.imag], [pole.imag]]
    edges = np.unique(np.concatenate(edges))
    resolved = fastest * min(max(60.0, 2e4 / (late * fastest)), 6e3)
    pieces = np.where(edges[:-1] < resolved, 1 + (np.diff(edges) * late / 6.0).astype(int), 1)
    parts = [np.linspace(a, b, n + 1) for a, b, n in zip(edges[:-1], edges[1:], np.minimum(pieces, 20000), strict=True)]
    panels = np.concatenate([np.column_stack([p[:-1], p[1:]]) for p in parts])
    total = 0.0
    for some in np.array_split(panels, max(1, len(panels) // 1000)):
        centre, half = some.mean(axis=1)[:, None], 0.5 * np.diff(some, axis=1)
        omega, weights = (centre + half * PLACES).ravel(), (half * WEIGHTS).ravel()
        gains = car.gains(omega, output) * np.exp(-1j * omega[:, None] * late * np.array([0, 0, 1, 1]))
        alike, apart = np.abs(gains.sum(axis=1)) ** 2, np.abs(gains @ np.where(LEFT, 1, -1)) ** 2
        half_apart = 0.5 * difference(omega * track / speed)
        total += weights @ (alike * (1.0 - half_apart) + apart * half_apart)
    return math.sqrt(total / math.pi)


def check(seed):
    """Relative difference of one output of a random car, from what its bound allows; the value is ok."""
    rng = np.random.default_rng(seed)
    car, output = random_car(rng, lopsided=seed % 4 == 3), OUTPUTS[seed % len(OUTPUTS)]
    speed, track = (math.exp(rng.uniform(math.log(a), math.log(b))) for a, b in ((0.5, 100.0), (0.05, 5.0)))
    road = it.Road(5e-7, speed, it.Coherence.isotropic(track))
    found = it.evaluate(car.mechanism(), it.RandomResponse({output: 1.0}, road), it.Norm())
    assert found.status.ok, found.status
    assert found.error_bound < 1e-6
    expected = road.velocity_intensity * by_quadrature(car, speed, track, output)
    return found.value / expected - 1.0, (seed, output, speed, track)


@pytest.mark.parametrize("output", ["sprung_acceleration", "roll_acceleration", "front_left_travel"])
def test_resonances_of_one_side_against_the_other_in_which_nothing_moves_leave_no_doubt(output):
    car = replace(random_car(np.random.default_rng(3), lopsided=False), beside=it.Spring)
    car.struts[:] = [25e3, 1500.0, 150e3, 7.0], [25e3, 1500.0, 120e3, 9.0]
    road = it.Road(5e-7, 25.0, it.Coherence.isotropic(1.5))
    found = it.evaluate(car.mechanism(), it.RandomResponse({output: 1.0}, road), it.Norm())
    assert found.status.ok, found.status
    assert found.error_bound < 1e-8
    assert found.value == pytest.approx(road.velocity_intensity * by_quadrature(car, 25.0, 1.5, output), rel=1e-8)


@pytest.mark.campaign
def test_many_designs_with_a_resonance_on_the_imaginary_axis():
    strut = it.Spring(20e3) | it.Damper(it.free(500.0, 5000.0, "c")) | it.Spring(1e4) - it.Inerter(20.0)
    car = it.FullCar(1400.0, 2400.0, 520.0, 45.0, 40.0, 2.2e5, 2.2e5, 1.2, 1.5, 1.5, 1.5, front=strut, rear=strut)
    comfort = it.RideComfort(it.Road(5e-7, 25.0, it.Coherence.isotropic(1.5)))
    coefficients = np.geomspace(500.0, 5000.0, 32)
    found = np.ravel(it.evaluate_many(car, comfort, {"c": coefficients}, it.Norm()))
    for i in (0, 16, 31):
        one = it.evaluate(car.with_values({"c": float(coefficients[i])}), comfort, it.Norm())
        assert found[i] == pytest.approx(one.value, rel=1e-7)
    assert np.all(np.isfinite(found))


@pytest.mark.parametrize("seed", sampled(range(8), [1, 2], kept=3))
def test_norms_by_quadrature(seed):
    off, case = check(seed)
    assert abs(off) < 1e-6, case


@pytest.mark.parametrize("chunk", sampled(range(10), kept=0))
def test_many_norms_by_quadrature(chunk):
    for seed in range(8 + 24 * chunk, 32 + 24 * chunk):
        off, case = check(seed)
        assert abs(off) < 1e-6, case


def long_car(distance, track):
    strut = it.Spring(60e3) | it.Damper(3e3)
    inertia = {"sprung_mass": 1200.0, "pitch_inertia": 1500.0, "roll_inertia": 450.0}
    return it.FullCar(
        **inertia, unsprung_mass_front=40.0, unsprung_mass_rear=35.0, tyre_stiffness_front=180e3,
        tyre_stiffness_rear=180e3, distance_front=1.2, distance_rear=distance, track_front=track, track_rear=track,
        front=strut, rear=strut,
    )  # fmt: skip


@pytest.mark.parametrize("distance", [8.0, 60.0])
def test_phases_that_are_not_resolved_are_in_the_bound(distance, monkeypatch):
    """With fewer panels than the delay of a long vehicle takes, the value is off by no more than it says."""
    road = it.Road(5e-7, 20.0, it.Coherence.isotropic(0.5))
    index = it.RandomResponse({"roll_acceleration": 1.0}, road)
    full = it.evaluate(long_car(distance, 0.5), index, it.Norm())
    assert full.status.ok
    monkeypatch.setattr(excess, "_MOST_PANELS", 3)
    few = it.evaluate(long_car(distance, 0.5), index, it.Norm())
    assert abs(few.value / full.value - 1.0) <= few.error_bound
    assert few.error_bound > 1e3 * full.error_bound


@pytest.mark.campaign
def test_a_vehicle_of_any_length_has_a_value_or_a_reason_in_time():
    """Of 1e8 m between the axles no panels would do; they are no more than memory holds."""
    road = it.Road(5e-7, 25.0, it.Coherence.isotropic(1.5))
    found = it.evaluate(long_car(8.9e7, 0.05), it.RandomResponse({"roll_acceleration": 1.0}, road), it.Norm())
    assert found.status.ok or "density of the tracks" in found.status.message


def free_car():
    strut = it.Spring(25e3) | it.Damper(it.free(100.0, 1e4, "c")) | it.Damper(2e3) - it.Inerter(60.0)
    rear = it.Spring(25e3) | it.Damper(1500.0) | it.Damper(1e3) - it.Inerter(90.0)
    return it.FullCar(
        1400.0, 2400.0, 520.0, 45.0, 40.0, 2e5, 2e5, 1.2, 1.5, 1.5, 1.5, front=strut, rear=rear,
        anti_roll_front=it.Spring(1e4),
    )  # fmt: skip


def as_numbers(c):
    rows = np.array([[25e3, c, 2e3, 60.0], [25e3, 1500.0, 1e3, 90.0]])
    pairs = [np.array(pair) for pair in ((2e5, 2e5), (1.2, 1.5), (1.5, 1.5))]
    return Car(np.array([1400.0, 2400.0, 520.0]), np.array([45.0, 45.0, 40.0, 40.0]), *pairs, rows, 1e4)


@pytest.mark.campaign
def test_a_search_has_the_values_that_are_reported_and_their_slopes():
    """Compiled values and slopes against those of one design at a time, at a track and speed where roll feels much."""
    index = it.RandomResponse({"roll_displacement": 1.0}, it.Road(5e-7, 10.0, it.Coherence.isotropic(0.5)))

    def value(c):
        return it.evaluate(free_car().with_values({"c": c}), index, it.Norm()).value

    found, (slope,) = it.Norm().objective(free_car(), index).value_and_gradient(np.array([700.0]))
    assert found == pytest.approx(value(700.0), rel=1e-7)
    assert slope * 700.0 == pytest.approx(
        (value(700.0 * math.exp(1e-3)) - value(700.0 * math.exp(-1e-3))) / 2e-3, rel=1e-4
    )


def test_corrections_are_called_with_the_types_that_they_are_prepared_for():
    """Other types would be compiled once more, for a quarter of a minute."""
    index = it.RandomResponse({"roll_displacement": 1.0}, it.Road(5e-7, 10.0, it.Coherence.isotropic(0.5)))
    it.Norm().objective(free_car(), index).value_and_gradient(np.array([700.0]))
    assert len(corrections.ready().signatures) == 1


@pytest.mark.marathon
def test_a_search_minimises_the_value_that_is_reported():
    """Values and slopes of the search against the quadrature, whose minimum over the damper the optimum has."""
    speed, track = 10.0, 0.5
    road = it.Road(5e-7, speed, it.Coherence.isotropic(track))
    index = it.RandomResponse({"roll_displacement": 1.0}, road)
    best = it.optimise(free_car(), index, it.Norm(), starts=2)
    assert best.status.ok

    def value(c):
        return road.velocity_intensity * by_quadrature(as_numbers(c), speed, track, "roll_displacement")

    at = best.parameters["c"]
    assert best.value == pytest.approx(value(at), rel=1e-7)
    steps = np.array([-0.05, -0.01, 0.01, 0.05])
    inside = np.clip(at * np.exp(steps), 100.0, 1e4)
    assert min(map(value, inside)) > best.value * (1.0 - 1e-7)
    objective = it.Norm().objective(free_car(), index)
    for c in (300.0, 5e3):
        found, (slope,) = objective.value_and_gradient(np.array([c]))
        ends = value(c * math.exp(1e-3)), value(c * math.exp(-1e-3))
        assert found == pytest.approx(value(c), rel=1e-7)
        assert slope * c == pytest.approx((ends[0] - ends[1]) / 2e-3, rel=1e-4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_exponentials_have_the_density_of_each_part(sign):
    """To 2e-8 in all waves that excite a vehicle, and near to it in longer ones, which have next to no power."""
    rates, residues, direct = isotropic_exponentials(sign)
    x = np.geomspace(1e-7, 1e5, 3000)
    found = direct - (2.0 * residues * rates / (rates**2 + x[:, None] ** 2)).sum(axis=1)
    expected = 1.0 - 0.5 * difference(x) if sign > 0.0 else 0.5 * difference(x) / x**2
    error = np.abs(found / expected - 1.0)
    assert error[x > 1e-6].max() < 2e-8
    assert error.max() < 1e-5
    assert rates.real.max() < 0.0


def test_other_coherences_have_no_such_error():
    vehicle = as_numbers(1500.0).mechanism()
    for coherence in (it.Coherence.first_order(0.2), it.Coherence.constant(1.0), None):
        found = it.evaluate(vehicle, it.RideComfort(it.Road(5e-7, 20.0, coherence)), it.Norm())
        assert [source.name for source in found.error_sources] == ["rounding"]
        assert found.error_bound < 1e-9


def test_simulated_tracks_have_the_spectra():
    """The sizes of lines of the mean of both tracks and of half of their difference."""
    road = it.Road(5e-7, 10.0, it.Coherence.isotropic(0.5))
    tracks = it.two_tracks(road, seed=3, lowest=0.01, highest=20.0)
    left, right = (tracks[side].coefficient for side in ("left", "right"))
    alone = np.abs(it.multisine(road, 0, 0.01, 20.0).coefficient) ** 2
    apart = 0.5 * difference(2 * np.pi * tracks["left"].frequencies * 0.5 / 10.0)
    np.testing.assert_allclose(np.abs(left + right) ** 2 / (4.0 * alone), 1.0 - apart, rtol=1e-9)
    np.testing.assert_allclose(np.abs(left - right) ** 2 / (4.0 * alone), apart, rtol=1e-9)


def test_its_polynomials_are_its_own():
    with pytest.raises(PerformanceIndexError, match=r"Use Coherence\.isotropic"):
        it.Coherence((1.0,), (1.0, 1.0), 1.5, is_isotropic=True)
