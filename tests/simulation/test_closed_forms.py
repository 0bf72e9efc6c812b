"""The event-driven integrator against closed forms. Every run must also balance its energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from campaigns import sampled
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.optimize import brentq
from strategies import random_half_car, random_network, random_quarter_car
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter.networks.elements import Network
from inerter.vehicle.vehicle import Vehicle

Array = Any
SCREW = (it.Spring(1e6, name="shaft") | it.Damper(3200.0)) - it.Gap(1e-4) - (it.Inerter(113.0) | it.Friction(10.0))
LEG = (it.Spring(1e6) | it.Damper(3200.0)) - it.Inerter(300.0)


def run(vehicle: Vehicle, *, exchanged: float = 0.0, **request: Any) -> it.Trajectory:
    """A simulation that went to its end and whose energy is accounted for.

    `exchanged` [J] went to and fro where next to nothing is put in on the whole.
    """
    result = it.simulate(vehicle, **({"energy": True} | request))
    assert result.integration_status.ok, result.integration_status
    if result.energy is not None:
        assert result.energy.relative_residual < 1e-8 or abs(result.energy.residual) < 1e-8 * exchanged
    return result


def block(network: Network, mass: float = 2.0) -> it.Mechanism:
    """A mass on a network that stands on the ground, and a force on it."""
    return it.Mechanism(
        coordinates=(it.Coordinate("x", mass),),
        struts=(it.Strut("s", network, {"x": 1.0}, it.GROUND),),
        forces=(it.Force("F", {"x": 1.0}),),
    )


def flat(value: float = 0.0) -> it.Signal:
    return it.Signal.sampled([0.0, 100.0], [value, value], "zero")


def changes(result: it.Trajectory) -> list[tuple[str, str]]:
    return [(event.element, event.after) for event in result.events]


def assert_close(one: Array, other: Array, tolerance: float, size: float | None = None) -> None:
    """Equal within `tolerance` of the largest of `other`."""
    largest = float(np.abs(other).max()) if size is None else size
    np.testing.assert_allclose(one, other, rtol=0.0, atol=tolerance * largest)


# A mass on a spring with friction


@pytest.mark.parametrize("aligned", [True, False])
@pytest.mark.parametrize("start", [0.05, -0.0478, 0.0043])
def test_free_coulomb_oscillator(start: float, aligned: bool) -> None:
    """Each half period takes pi / omega and costs 2 f / k of amplitude; within f / k of the middle it stays."""
    m, k, f = 2.0, 800.0, 3.0
    omega, loss = np.sqrt(k / m), 2.0 * f / k
    half = np.pi / omega
    step = half / (50.0 if aligned else 37.3)
    moved = run(block(it.Spring(k) | it.Friction(f), m), forces=flat(), duration=600 * step, step=step,
                initial=[0.0, start])  # fmt: skip

    turns = int(np.ceil((abs(start) - 0.5 * loss) / loss))
    resting = np.sign(start) * (-1.0) ** turns * (abs(start) - turns * loss)
    times = np.array([event.time for event in moved.events])
    assert_close(times, half * np.arange(1, turns + 1), 1e-9, half)
    assert [event.after for event in moved.events][-1] == "stick"
    assert {event.after for event in moved.events[:-1]} <= {"slip up", "slip down"}
    x, v = moved["x_displacement"], moved["x_velocity"]
    after = moved.time > turns * half + 1e-9
    assert_close(x[after], np.full(after.sum(), resting), 1e-9, abs(start))
    assert np.all(v[after] == 0.0)
    n = np.floor(moved.time / half + 1e-9)
    amplitude = np.sign(start) * (-1.0) ** n * (abs(start) - n * loss)  # at the beginning of each half period
    middle = np.sign(start) * (-1.0) ** n * 0.5 * loss
    inside = middle + (amplitude - middle) * np.cos(omega * (moved.time - n * half))
    assert_close(x[~after], inside[~after], 1e-9, abs(start))


class DenHartog:
    """Mass m, spring k, friction f, force F cos(w t + phi): the motion of two turning points in a period.

    Between its maximum at t = 0 and its minimum at t = pi / w the mass moves down, and the friction pushes up. The
    four conditions on value and slope at both ends give x = x0 there and x0 = sqrt((F V / k)^2 - (f U / k)^2).
    Source: Den Hartog (1931), Trans. ASME 53, 107-115; derived anew.
    """

    def __init__(self, ratio: float, friction: float, m: float = 2.0, k: float = 800.0, force: float = 10.0) -> None:
        self.m, self.k, self.force, self.friction, self.ratio = m, k, force, friction, ratio
        self.own = np.sqrt(k / m)
        self.omega = ratio * self.own
        self.period = 2.0 * np.pi / self.omega
        half = np.pi / ratio
        self.shift = friction / k
        self.across = -self.shift * np.sin(half) / (1.0 + np.cos(half))  # beta a V sin(phi)
        response = force / k / (1.0 - ratio**2)
        self.amplitude = float(np.sqrt(response**2 - (self.across / ratio) ** 2))
        self.phase = float(np.arctan2(self.across / ratio / response, self.amplitude / response))

    def speed(self, t: Array) -> Array:
        """Velocity in the half period of downward motion, over the circular frequency of the mass on its spring."""
        own, driven = self.own * t, self.omega * t
        return (
            self.shift * np.sin(own)
            + self.across * (np.cos(own) - np.cos(driven))
            - self.ratio * self.amplitude * np.sin(driven)
        )

    def downward(self) -> bool:
        """Whether the mass never stops on its way down, nor stays at its ends."""
        t = np.linspace(0.0, np.pi / self.omega, 20001)[1:-1]
        return (
            bool(np.max(self.speed(t) / np.sin(self.omega * t)) < 0.0) and self.amplitude * self.ratio**2 > self.shift
        )

    def limit(self) -> float:
        """The friction at which stops begin."""

        def slack(friction: float) -> float:
            motion = DenHartog(self.ratio, friction)
            t = np.linspace(0.0, np.pi / motion.omega, 20001)[1:-1]
            return float(np.max(motion.speed(t) / np.sin(motion.omega * t)))

        half = np.pi / self.ratio  # without amplitude above this friction
        most = self.force * self.ratio / abs(1.0 - self.ratio**2) * abs((1.0 + np.cos(half)) / np.sin(half))
        return float(brentq(slack, 0.01 * most, (1.0 - 1e-12) * most, xtol=1e-12))

    def simulated(self, periods: float, steps: int = 1000, **request: Any) -> it.Trajectory:
        force = it.cosine(self.force, self.omega / (2.0 * np.pi), self.phase)
        network = it.Spring(self.k) | it.Friction(self.friction)
        return run(block(network, self.m), forces=force, duration=periods * self.period, step=self.period / steps,
                   **request)  # fmt: skip


@pytest.mark.parametrize(("ratio", "friction"), [(0.8, 3.0), (0.65, 3.5), (1.3, 2.0), (1.7, 3.0), (0.55, 0.5)])
def test_den_hartog_without_stops(ratio: float, friction: float) -> None:
    theory = DenHartog(ratio, friction)
    assert theory.downward()
    start = theory.simulated(3.75, initial=[0.0, theory.amplitude])
    assert [event.after for event in start.events] == ["slip up", "slip down"] * 3 + ["slip up"]
    turning = start["x_displacement"][::500]
    assert_close(turning, theory.amplitude * (-1.0) ** np.arange(8), 1e-9)
    down = slice(0, 501)
    assert_close(start["x_velocity"][down], theory.own * theory.speed(start.time[down]), 1e-9)


@pytest.mark.parametrize(("ratio", "friction"), [(0.8, 3.0), (1.3, 2.0)])
def test_den_hartog_as_a_periodic_steady_state(ratio: float, friction: float) -> None:
    theory = DenHartog(ratio, friction)
    settled = theory.simulated(1, initial="periodic")
    assert settled.repetition is not None
    assert settled.repetition.mismatch < 1e-9
    assert np.abs(settled["x_displacement"]).max() == pytest.approx(theory.amplitude, rel=1e-6)
    assert settled.energy is not None
    assert settled.energy.friction["f"] == pytest.approx(4.0 * friction * theory.amplitude, rel=1e-8)
    assert settled.energy.input_work == pytest.approx(4.0 * friction * theory.amplitude, rel=1e-8)


@pytest.mark.parametrize("ratio", [0.65, 0.8, 1.3, 1.7])
def test_den_hartog_stops_begin(ratio: float) -> None:
    limit = DenHartog(ratio, 1.0).limit()
    for share, stops in ((0.999, False), (1.001, True)):
        theory = DenHartog(ratio, share * limit)
        result = theory.simulated(60, steps=400, initial=[0.0, theory.amplitude], energy=False)
        assert ("f", "stick") in changes(result) or not stops
        assert ("f", "stick") not in changes(result) or stops


# Backlash


def rattle(seed: int, eps: float = 1e-4, friction: float = 10.0, duration: float = 2.0) -> it.Trajectory:
    """The screw with a gap on the rig, shaken at random."""
    screw = (it.Spring(1e6) | it.Damper(3200.0)) - it.Gap(eps) - (it.Inerter(113.0) | it.Friction(friction))
    signal = it.multisine(it.Road(roughness=2e-9, speed=10.0), seed=seed, lowest=0.5, highest=30.0) * (1 + eps / 1e-4)
    return run(it.Rig(screw), displacement=signal, duration=duration, step=2e-4)


def inside(time: Array, interval: tuple[float, float]) -> Array:
    return np.flatnonzero((time > interval[0]) & (time < interval[1]))


@pytest.mark.parametrize("seed", range(3))
def test_open_gap_relaxes(seed: int) -> None:
    """No force passes an open gap, so k x + c x' = 0."""
    result = rattle(seed)
    force, rate, found = result["k_force"], 1e6 / 3200.0, 0
    for interval in result.intervals("gap", "open"):
        at = inside(result.time, interval)
        if at.size > 3 and np.abs(force[at[0]]) > 0.0:
            expected = force[at[0]] * np.exp(-rate * (result.time[at] - result.time[at[0]]))
            np.testing.assert_allclose(force[at], expected, rtol=1e-10)
            found += 1
    assert found > 5


@pytest.mark.parametrize("seed", range(3))
def test_inerter_coasts_under_its_friction_alone(seed: int) -> None:
    result = rattle(seed, friction=30.0)
    velocity, found = result["b_velocity"], 0
    for way, sign in (("slip up", 1.0), ("slip down", -1.0)):
        for begin, end in result.intervals("f", way):
            for first, last in result.intervals("gap", "open"):
                at = inside(result.time, (max(begin, first), min(end, last)))
                if at.size > 3:
                    expected = velocity[at[0]] - sign * 30.0 / 113.0 * (result.time[at] - result.time[at[0]])
                    assert_close(velocity[at], expected, 1e-10)
                    found += 1
    assert found > 5


@pytest.mark.parametrize("seed", range(4))
def test_contact_never_pulls(seed: int) -> None:
    result = rattle(seed, eps=(1e-5, 5e-5, 2e-4, 1e-3)[seed])
    force = result["gap_force"]
    size = np.abs(force).max()
    met = 0
    for state, sign in (("upper contact", 1.0), ("lower contact", -1.0), ("open", 0.0)):
        for interval in result.intervals("gap", state):
            at = inside(result.time, interval)
            met += at.size
            if sign:
                assert np.all(sign * force[at] >= -1e-12 * size)
            else:
                assert np.all(np.abs(force[at]) <= 1e-12 * size)
    assert met > 0.9 * result.time.size
    assert len(result.events) > 20


@pytest.mark.parametrize("hold", ["cubic", "linear", "zero"])
def test_friction_never_exceeds_its_limit_and_opposes_slip(hold: str) -> None:
    """At every sample, those where a held road or force jumps included."""
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(2000.0) | it.Friction(150.0))
    road = it.multisine(ROAD, seed=5, highest=200.0)
    time = np.linspace(0.0, 2.0, 2001)
    table = road if hold == "cubic" else it.Signal.sampled(time, road(time), hold)
    push = table * 2e4
    result = run(car, road=table, forces={"sprung_force": push}, duration=2.0, step=2e-4)
    force, velocity = result["f_force"], result["f_velocity"]
    assert np.abs(force).max() <= 150.0 * (1.0 + 1e-12)
    for state, sign in (("slip up", 1.0), ("slip down", -1.0), ("stick", 0.0)):
        for interval in result.intervals("f", state):
            at = inside(result.time, interval)
            if sign:
                assert np.all(sign * velocity[at] >= 0.0)
                assert np.all(force[at] == sign * 150.0)
            else:
                assert np.all(np.abs(velocity[at]) < 1e-12)
    assert ("f", "stick") in changes(result)


# Linear networks


@pytest.mark.parametrize("duration", [1e-3, 0.2])
def test_an_element_alone_on_the_rig(duration: float) -> None:
    """No state at all: the force follows the displacement, and an inerter takes in b v^2 / 2 and nothing else."""
    smooth = it.multisine(ROAD, seed=0)
    time = np.linspace(0.0, 0.2, 1001)
    value, slope = smooth.sample(time)
    table = it.Signal.sampled(time, value, "cubic", derivative=slope)
    end = round(duration / 2e-4)
    for step in (2e-4, 4e-5):
        spring, damper, inerter = (
            run(it.Rig(element), displacement=table, duration=duration, step=step)
            for element in (it.Spring(3e4), it.Damper(500.0), it.Inerter(80.0))
        )
        assert_close(spring["force"][:: round(2e-4 / step)], 3e4 * value[: end + 1], 1e-11)
        assert_close(damper["force"][:: round(2e-4 / step)], 500.0 * slope[: end + 1], 1e-11)
        assert inerter.energy is not None
        assert inerter.energy.input_work == pytest.approx(40.0 * (slope[end] ** 2 - slope[0] ** 2), rel=1e-10)


def bent(rng: np.random.Generator, duration: float, step: float, size: float) -> tuple[it.Signal, Array]:
    """A smooth table that begins at rest, with its cubics."""
    time = np.linspace(0.0, duration, round(duration / step) + 1)
    waves = [(size * rng.standard_normal(), rng.uniform(1.0, 30.0), rng.uniform(0.0, 6.0)) for _ in range(5)]
    value, slope = np.zeros_like(time), np.zeros_like(time)
    for a, f, phase in waves:
        w = 2.0 * np.pi * f
        grown, rate = 1.0 - np.exp(-((8.0 * time) ** 2)), 128.0 * time * np.exp(-((8.0 * time) ** 2))
        value += a * grown * np.sin(w * time + phase)
        slope += a * (grown * w * np.cos(w * time + phase) + rate * np.sin(w * time + phase))
    return it.Signal.sampled(time, value, "cubic", derivative=slope, speed=40.8), cubic(value, slope, step)


def cubic(value: Array, slope: Array, h: float) -> Array:
    """(steps, 4): coefficients of the Hermite cubics in powers of time."""
    rise = np.diff(value) / h
    left, right = slope[:-1], slope[1:]
    return np.stack([value[:-1], left, (3 * rise - 2 * left - right) / h, (left + right - 2 * rise) / h**2], axis=1)


def exactly(system: it.LinearSystem, pieces: Array, h: float) -> Array:
    """Outputs at the knots from rest: x' = A x + B u, u (steps, inputs, 4) cubic, by one matrix exponential."""
    n, m = system.B.shape
    chain = np.zeros((n + 4 * m, n + 4 * m))
    chain[:n, :n] = system.A
    for j in range(m):
        chain[:n, n + 4 * j] = system.B[:, j]
        for i in range(3):
            chain[n + 4 * j + i, n + 4 * j + i + 1] = 1.0
    step = expm(chain * h)[:n]
    x = np.zeros(n)
    at_ends = [system.D @ pieces[0, :, 0]]
    for u in pieces:
        derivatives = u * np.array([1.0, 1.0, 2.0, 6.0])
        x = step @ np.concatenate([x, derivatives.ravel()])
        at_ends.append(system.C @ x + system.D @ (u @ h ** np.arange(4)))
    return np.array(at_ends)


def derivative(pieces: Array) -> Array:
    return np.stack([pieces[:, 1], 2.0 * pieces[:, 2], 3.0 * pieces[:, 3], np.zeros(len(pieces))], axis=1)


def assert_exact(car: Vehicle, names: tuple[str, ...], inputs: dict[str, Array], h: float, **request: Any) -> None:
    """The outputs are those of the other assembler under inputs that are cubics over every step."""
    system = it.state_space(car, inputs=tuple(inputs), outputs=names)
    expected = exactly(system, np.stack([*inputs.values()], axis=1), h)
    result = run(car, step=h, **request)
    for i, name in enumerate(names):
        assert_close(result[name], expected[:, i], 1e-10)
    assert not result.events


@pytest.mark.parametrize("seed", sampled(range(12), range(3), kept=2))
def test_linear_quarter_car_by_the_matrix_exponential(seed: int) -> None:
    """Random networks; the matrices come from the other assembler, and the cubic input enters exactly."""
    rng = np.random.default_rng(seed)
    car = random_quarter_car(rng, random_network(rng) | it.Spring(3e4) | it.Damper(900.0))
    h, duration = 1e-3, 0.6
    road, height = bent(rng, duration, h, 3e-3)
    push, force = bent(rng, duration, h, 300.0)
    names = ("sprung_acceleration", "unsprung_acceleration", "tyre_load", "strut_force", "strut_travel")
    inputs = {"road": derivative(height), "sprung_force": force}
    assert_exact(car, names, inputs, h, road=road, forces={"sprung_force": push}, duration=duration)


@pytest.mark.parametrize("seed", sampled(range(6), range(2), kept=1))
def test_linear_half_car_by_the_matrix_exponential(seed: int) -> None:
    """The same with two wheels, the rear one met forty steps later, and a moment."""
    rng = np.random.default_rng(100 + seed)
    front, rear = (random_network(rng, most=6) | it.Spring(3e4) | it.Damper(900.0) for _ in range(2))
    car = random_half_car(rng, front, rear)
    h, duration, late = 1e-3, 0.5, 40
    road, height = bent(rng, duration, h, 3e-3)
    push, force = bent(rng, duration, h, 300.0)
    names = ("sprung_acceleration", "pitch_acceleration", "tyre_front_load", "tyre_rear_load", "rear_force")
    ahead = derivative(height)
    behind = np.concatenate([np.zeros((late, 4)), ahead[:-late]])
    inputs = {"road_front": ahead, "road_rear": behind, "pitch_moment": force}
    speed = (car.distance_front + car.distance_rear) / (late * h)
    assert_exact(car, names, inputs, h, road=road, forces={"pitch_moment": push}, duration=duration, speed=speed)


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_held_force_by_the_matrix_exponential(hold: str) -> None:
    """A table that jumps or bends at its knots, the last one included; four steps to a sample."""
    rng = np.random.default_rng(3)
    h, count = 5e-4, 100
    value = 200.0 * rng.standard_normal(count + 1)
    car = paper_quarter_car(it.Spring(120e3) | it.Damper(2500.0) - it.Spring(3e5))
    system = it.state_space(car, inputs="sprung_force", outputs=("tyre_load", "strut_travel"))
    pieces = np.zeros((count, 1, 4))
    pieces[:, 0, 0] = value[:-1]
    if hold == "linear":
        pieces[:, 0, 1] = np.diff(value) / (4 * h)
    expected = exactly(system, pieces, 4 * h)
    signal = it.Signal.sampled(4 * h * np.arange(count + 1), value, hold)
    result = run(car, forces={"sprung_force": signal}, duration=4 * h * count, step=h)
    for i, name in enumerate(("tyre_load", "strut_travel")):
        assert_close(result[name][::4], expected[:, i], 1e-10)


@pytest.mark.parametrize("frequency", [1.3, 4.0, 11.0])
def test_periodic_state_of_a_linear_car_by_its_frequency_response(frequency: float) -> None:
    """The transfer function from the road's velocity, at the amplitude and phase of a sine."""
    car = paper_quarter_car(it.Spring(60e3) | it.Damper(2500.0) | LEG)
    names = ("sprung_acceleration", "tyre_load", "strut_force")
    system = it.state_space(car, inputs="road", outputs=names)
    omega, height = 2.0 * np.pi * frequency, 4e-3
    gain = system.C @ np.linalg.solve(1j * omega * np.eye(system.order) - system.A, system.B) + system.D
    result = run(car, road=it.sine(height, frequency), initial="periodic", step=1.0 / frequency / 2000)
    assert result.repetition is not None
    assert result.repetition.mismatch < 1e-9
    phase = np.exp(1j * omega * result.time)
    for i, name in enumerate(names):
        assert_close(result[name], (gain[i, 0] * height * omega * phase).real, 1e-8)


# Massless networks under a given displacement


def test_jenkins_element_has_a_closed_loop() -> None:
    """Friction in series with a spring: F = k (z - s), where s follows z at a distance of f / k."""
    f, k, a, frequency = 40.0, 2e4, 5e-3, 3.0
    period, steps = 1.0 / frequency, 600
    result = run(it.Rig(it.Friction(f) - it.Spring(k)), displacement=it.cosine(a, frequency), duration=3 * period,
                 step=period / steps)  # fmt: skip
    z, expected, rests = result["displacement"], [], a
    for height in z:
        rests = min(max(rests, height - f / k), height + f / k)
        expected.append(k * (height - rests))
    assert_close(result["force"], expected, 1e-9)
    loop = result["force"][steps : 2 * steps + 1]
    assert loop[0] == pytest.approx(loop[-1], rel=1e-9)
    assert result.energy is not None
    first = f * (2.0 * a - f / k) + f * (2.0 * a - 2.0 * f / k)  # the first stroke begins unstrained
    assert result.energy.friction["f"] == pytest.approx(first + 2 * 4.0 * f * (a - f / k), rel=1e-8)
    late = [e.time for e in result.events if period < e.time < 2.9 * period]
    slide = np.arccos(1.0 - 2.0 * f / (k * a)) / (2.0 * np.pi * frequency)  # from the turning point on
    assert_close(late, [period + slide, 1.5 * period, 1.5 * period + slide, 2 * period, 2 * period + slide,
                        2.5 * period, 2.5 * period + slide], 1e-9, period)  # fmt: skip


def test_friction_in_series_with_a_damper() -> None:
    f, c = 40.0, 800.0
    signal = it.multisine(it.Road(roughness=1e-7, speed=10.0), seed=2, lowest=0.5, highest=40.0)
    result = run(it.Rig(it.Damper(c) - it.Friction(f)), displacement=signal, duration=2.0, step=5e-4)
    speed = signal.sample(result.time)[1]
    assert_close(result["force"], np.clip(c * speed, -f, f), 1e-12)
    assert {e.after for e in result.events} == {"stick", "slip up", "slip down"}


def test_friction_beside_a_damper_between_massless_nodes() -> None:
    """A ramp: stuck until K v t = f, then the force goes to f + c v; the way back by the same formula."""
    f, c, K, v, turn = 50.0, 400.0, 3e4, 0.05, 0.2
    ends = it.Spring(2.0 * K)
    signal = it.Signal.sampled([0.0, turn, 3 * turn], [0.0, v * turn, -v * turn], "linear")
    result = run(
        it.Rig(ends - (it.Friction(f) | it.Damper(c)) - ends), displacement=signal, duration=3 * turn, step=1e-3
    )
    t, rate = result.time, K / c
    begin = f / (K * v)
    up = np.where(t < begin, K * v * t, f + c * v * -np.expm1(-rate * (t - begin)))
    peak = f + c * v * -np.expm1(-rate * (turn - begin))
    # downward it first creeps on until the force is down to f
    stop = brentq(lambda s: (peak - f + c * v) * np.exp(-rate * s) - c * v, 0.0, 0.1, xtol=1e-16)
    back = stop + 2.0 * f / (K * v)
    s = t - turn
    down = np.select(
        [s < stop, s < back],
        [f - c * v + (peak - f + c * v) * np.exp(-rate * s), f - K * v * (s - stop)],
        -f + c * v * np.expm1(-rate * (s - back)),
    )
    assert_close(result["force"], np.where(t < turn, up, down), 1e-11)
    assert_close([e.time for e in result.events], [begin, turn + stop, turn + back], 1e-10, turn)
    assert changes(result) == [("f", "slip up"), ("f", "stick"), ("f", "slip down")]


OUTPUTS = ("sprung_acceleration", "sprung_displacement", "unsprung_velocity", "tyre_load", "strut_force")


def driven(strut: Network, step: float = 2e-4) -> it.Trajectory:
    signal = it.multisine(ROAD, seed=1, highest=100.0)
    return run(paper_quarter_car(it.Spring(60e3) | it.Damper(1500.0) | strut), road=signal, duration=1.0, step=step)


SAME = {
    "several frictions side by side are their sum": (
        it.Friction(20.0) | it.Friction(50.0) | it.Friction(30.0),
        it.Friction(100.0),
    ),
    "several frictions in a row are the least": (
        it.Friction(90.0) - it.Spring(4e5) - it.Friction(40.0) - it.Friction(200.0),
        it.Friction(40.0) - it.Spring(4e5),
    ),
    "a friction of zero is not there": (LEG | it.Friction(0.0), LEG),
    "a friction of zero beside an inerter": (
        (it.Spring(1e6) | it.Damper(3200.0)) - (it.Inerter(300.0) | it.Friction(0.0)),
        LEG,
    ),
    "a gap of zero is rigid": (LEG - it.Gap(0.0), LEG),
    "a gap of zero beside a damper": (it.Spring(2e5) - (it.Gap(0.0) | it.Damper(5e3)), it.Spring(2e5)),
    "a huge friction is a lock": (
        (it.Spring(2e5) | it.Damper(3200.0)) - (it.Inerter(300.0) | it.Friction(1e9)),
        it.Spring(2e5) | it.Damper(3200.0),
    ),
    "a huge friction in a row is a lock": (LEG - it.Friction(1e9), LEG),
    "a huge gap is never closed": (LEG | (it.Spring(1e6) - it.Gap(10.0)), LEG),
}


@pytest.mark.parametrize("pair", SAME.values(), ids=SAME)
def test_the_same_mechanism_in_two_ways(pair: tuple[Network, Network]) -> None:
    one, other = map(driven, pair)
    for name in OUTPUTS:
        assert_close(one[name], other[name], 1e-10)


def test_symmetric_struts_stay_symmetric() -> None:
    """Both ends meet every event at the same time, and no rounding may tell them apart."""
    leg = (it.Spring(4e5) | it.Damper(2000.0)) - it.Gap(2e-4) - (it.Inerter(150.0) | it.Friction(25.0))
    strut = it.Spring(60e3) | it.Damper(1500.0) | leg
    car = it.HalfCar(363.5, 200.0, 25.0, 25.0, 120e3, 120e3, 1.0, 1.0, strut, strut)
    push = it.multisine(ROAD, seed=4, highest=30.0) * 3e5
    result = run(car, forces={"sprung_force": push}, duration=2.0, step=2e-4)
    for front, rear in (("front_force", "rear_force"), ("front.f_force", "rear.f_force"),
                        ("unsprung_front_velocity", "unsprung_rear_velocity")):  # fmt: skip
        assert_close(result[front], result[rear], 1e-12)
    assert np.abs(result["pitch_displacement"]).max() < 1e-12 * np.abs(result["sprung_displacement"]).max()
    ahead, behind = (
        [(e.time, e.after) for e in result.events if e.element.startswith(end)] for end in ("front", "rear")
    )
    assert len(ahead) > 20
    assert [after for _, after in ahead] == [after for _, after in behind]
    assert_close([t for t, _ in ahead], [t for t, _ in behind], 1e-12, 1.0)


# Events at the edge of what can be told apart


def test_sticking_for_the_whole_run() -> None:
    """A friction that never slips holds its ends together exactly, and carries what passes."""
    strut = it.Spring(60e3) | it.Damper(1500.0) | it.Spring(2e4) - it.Friction(1e4)
    car = paper_quarter_car(strut)
    result = run(car, road=it.multisine(ROAD, seed=1, highest=100.0), duration=1.0, step=2e-4)
    assert not result.events
    assert result.states == {"f": "stick"}
    assert np.abs(result["f_velocity"]).max() <= 1e-15
    assert_close(result["f_force"], 2e4 * result["strut_travel"], 1e-10)
    assert result.energy is not None
    assert abs(result.energy.friction["f"]) < 1e-12 * result.energy.input_work


@pytest.mark.parametrize("excess", [-1e-9, 1e-9])
@pytest.mark.parametrize("peak", [0, 1])
def test_grazing_contact(excess: float, peak: int) -> None:
    """The displacement reaches the half-gap within 1e-9 from below, or goes beyond it by as much."""
    eps, frequency = 1e-3, 2.0
    steps = 400
    signal = it.sine(eps * (1.0 + excess) * (1, -1)[peak], frequency)
    result = run(it.Rig(it.Gap(eps) - (it.Spring(1e5) | it.Damper(50.0))), displacement=signal, duration=0.5,
                 step=0.5 / steps, exchanged=1e-12)  # fmt: skip
    first, second = (("upper contact", "lower contact"), ("lower contact", "upper contact"))[peak]
    if excess < 0.0:
        assert not result.events
        assert np.all(np.abs(result["force"]) < 1e-12)
    else:
        assert [after for _, after in changes(result)] == [first, "open", second, "open"]
        half = np.arccos(1.0 / (1.0 + excess)) / (2.0 * np.pi * frequency)
        assert_close([e.time for e in result.events[::2]], [0.125 - half, 0.375 - half], 1e-3, half)


@pytest.mark.parametrize("excess", [-1e-9, 1e-9])
def test_grazing_slip(excess: float) -> None:
    """The force of a spring reaches the friction within 1e-9 from below, or would go beyond it by as much."""
    f, k = 40.0, 2e4
    signal = it.sine(f / k * (1.0 + excess), 2.0)
    result = run(it.Rig(it.Friction(f) - it.Spring(k)), displacement=signal, duration=0.5, step=0.5 / 400,
                 exchanged=0.5 * f**2 / k)  # fmt: skip
    expected = [] if excess < 0.0 else ["slip up", "stick", "slip down", "stick"]
    assert [after for _, after in changes(result)][: len(expected)] == expected
    assert_close(result["force"], np.clip(k * result["displacement"], -f, f), 3e-9)


def test_two_crossings_within_one_step() -> None:
    """Cubics that go out and come back between two knots; a step fifty times finer sees the same events."""
    interval, count = 0.01, 60
    time = interval * np.arange(count + 1)
    rng = np.random.default_rng(8)
    value, slope = (
        1e-4 * rng.standard_normal(count + 1),
        rng.uniform(0.3, 1.5, count + 1) * (-1.0) ** np.arange(count + 1),
    )
    table = it.Signal.sampled(time, value, "cubic", derivative=slope)
    for device in (SCREW, it.Friction(200.0) - it.Spring(1e5), it.Gap(1e-3) - (it.Spring(1e5) | it.Damper(300.0))):
        coarse, fine = (
            run(it.Rig(device), displacement=table, duration=count * interval, step=interval / finer)
            for finer in (1, 50)
        )
        assert len(coarse.events) > count
        assert changes(coarse) == changes(fine)
        assert_close([e.time for e in coarse.events], [e.time for e in fine.events], 1e-10, interval)
        assert_close(coarse["force"], fine["force"][::50], 1e-9)


# The energy account


@pytest.mark.campaign
def test_energy_of_every_kind_of_input() -> None:
    """Held, bent and smooth signals on roads, forces and the rig, with the delay of the rear wheel."""
    leg = (it.Spring(4e5) | it.Damper(2000.0)) - it.Gap(5e-5) - (it.Inerter(150.0) | it.Friction(25.0))
    strut = it.Spring(60e3) | it.Damper(1500.0) | leg
    noise = it.held_noise(seed=1, power=1e-8, interval=1e-3, duration=1.0, speed=20.0)
    line = it.Signal.sampled(1e-2 * np.arange(101), 1e-3 * np.random.default_rng(0).standard_normal(101), "linear")
    for road in (noise, line, it.multisine(ROAD, seed=0)):
        run(paper_quarter_car(strut), road=road, duration=0.25, step=2e-4)
        run(paper_half_car(strut, strut), road=road, speed=20.0, duration=0.25, step=2e-4)
        run(paper_quarter_car(strut), forces={"sprung_force": road * 1e5}, duration=0.25, step=2e-4)
    run(it.Rig(SCREW), displacement=it.cosine(1e-3, 3.0), duration=0.5, step=1e-4)


def test_work_of_a_force_on_a_free_flywheel() -> None:
    """A case whose every sum has a closed form: a force F t on a mass under friction, from rest."""
    m, f, growth, end = 2.0, 3.0, 40.0, 0.5
    ramp = it.Signal.sampled([0.0, 1.0], [0.0, growth], "linear")
    result = run(block(it.Friction(f), m), forces=ramp, duration=end, step=1e-3)
    begin = f / growth

    def speed(t: float) -> float:
        return (0.5 * growth * (t**2 - begin**2) - f * (t - begin)) / m

    assert result.energy is not None
    assert result.events[0].time == pytest.approx(begin, rel=1e-12)
    assert result.energy.stored == pytest.approx(0.5 * m * speed(end) ** 2, rel=1e-10)
    assert result.energy.inputs["F"] == pytest.approx(quad(lambda t: growth * t * speed(t), begin, end)[0], rel=1e-10)
    assert result.energy.friction["f"] == pytest.approx(f * quad(speed, begin, end)[0], rel=1e-10)


@pytest.mark.parametrize(("relaxation", "settles"), [(1.0, True), (1e5, False), (1e7, False), (1e8, False)])
def test_a_load_that_a_leak_has_not_passed_to_its_spring_is_no_steady_state(relaxation: float, settles: bool) -> None:
    """A spring and a damper in series relax until the mean load rests on the spring beside them, in any time."""
    stiffness, inner = 4000.0, 4000.0
    strut = it.Spring(stiffness) | it.Damper(40.0) | it.Spring(inner, "inner") - it.Damper(inner * relaxation)
    mass = it.Mechanism(
        (it.Coordinate("mass", 10.0),),
        (it.Strut("strut", strut, {"mass": 1.0}, {}),),
        forces=(it.Force("f", {"mass": 1.0}),),
    )
    t = np.linspace(0.0, 0.25, 251)
    load = 100.0 * np.maximum(np.sin(8.0 * np.pi * t), 0.0)
    pulses = it.Signal.sampled(t, load, "linear", label="pulses", periodic=True)
    run = it.simulate(mass, forces={"f": pulses}, step=1e-3, initial="periodic")
    rests = np.trapezoid(run["mass_displacement"], t) / t[-1] == pytest.approx(
        np.trapezoid(load, t) / t[-1] / stiffness, rel=1e-5
    )
    assert (run.integration_status.ok, rests) == (settles, settles)


def test_a_motion_that_repeats_in_the_second_period_is_steady() -> None:
    """What the second of two periods changes is above rounding, below what counts as a change, and no creep."""
    car = it.QuarterCar(181.75, 25.0, 150e3, it.Spring(40e3) | it.Damper(8e3))
    run = it.simulate(car, road=it.cosine(1e-3, 0.2, speed=20.0), step=2.5e-3, initial="periodic")
    assert run.repetition.periods == 2
    assert run.repetition.mismatch > 0.0
    assert run.integration_status.ok
