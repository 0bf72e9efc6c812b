"""Time stepping against closed forms, an integration by hand with events, laws of mechanics, and itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from campaigns import sampled
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import lsim
from wang_su import paper_quarter_car

from inerter import Damper, Friction, Gap, HalfCar, Inerter, Mechanism, Spring, free, state_space
from inerter.errors import SimulationError
from inerter.kernels.stepping import march
from inerter.networks.elements import Network
from inerter.simulation.time_stepping import Histories, Start, StepTable, step_through
from inerter.systems.graph import full_graph
from inerter.vehicle.mechanism import GROUND, Coordinate, Force, Strut
from inerter.vehicle.rig import Rig
from inerter.vehicle.vehicle import Vehicle

Signal = Callable[[np.ndarray], np.ndarray]
SCREW = (Spring(1e6) | Damper(3200.0)) - Gap(1e-4) - (Inerter(113.0) | Friction(10.0))


def block(network: Network, mass: float = 2.0) -> Mechanism:
    """A mass on a network that stands on the ground."""
    return Mechanism(
        (Coordinate("x", mass),), (Strut("s", network, {"x": 1.0}, GROUND),), forces=(Force("F", {"x": 1.0}),)
    )


def run(
    vehicle: Vehicle,
    duration: float,
    h: float,
    road: Signal | None = None,
    force: Signal | None = None,
    hold: str = "cubic",
    every: int = 1,
    velocity: dict[str, float] | None = None,
    displacement: dict[str, float] | None = None,
    relaxed: bool = False,
) -> Histories:
    """Histories of `vehicle`; `relaxed`: every elongation is zero at the start."""
    mechanism = vehicle.mechanism()
    graph = full_graph(mechanism)
    time = np.arange(round(duration / h) + 1) * h
    delays = [0.05 * i for i in range(len(mechanism.roads))]
    roads = [road or np.zeros_like for _ in delays]
    forces = [force or np.zeros_like for _ in mechanism.forces]
    table = StepTable(
        time,
        np.array([z(time - d) for z, d in zip(roads, delays, strict=True)]).reshape(-1, time.size),
        np.array([rate(z, time - d) for z, d in zip(roads, delays, strict=True)]).reshape(-1, time.size),
        np.array([F(time) for F in forces]).reshape(-1, time.size),
        np.array([rate(F, time) for F in forces]).reshape(-1, time.size),
        (hold,) * len(roads),
        (hold,) * len(forces),
    )
    d, v = ([(given or {}).get(node, 0.0) for node in graph.nodes] for given in (displacement, velocity))
    elongations = np.zeros(len(graph.branches)) if relaxed else None
    result = step_through(mechanism, graph, table, Start(np.array(d), np.array(v), elongations), every)
    assert result.status.ok, result.status
    return result


def rate(signal: Signal, t: np.ndarray, step: float = 1e-5) -> np.ndarray:
    """Derivative by differences of fourth order."""
    near = signal(t + step) - signal(t - step)
    return (8.0 * near - signal(t + 2.0 * step) + signal(t - 2.0 * step)) / (12.0 * step)


def bumpy(t: np.ndarray) -> np.ndarray:
    """A road that begins smoothly at t = 0."""
    s = np.maximum(t, 0.0)
    return np.tanh(40.0 * s) ** 3 * (4e-3 * np.sin(14.0 * s) + 2e-3 * np.sin(47.0 * s + 1.0))


def label(vehicle: Vehicle, name: str) -> int:
    return [branch.label for branch in full_graph(vehicle.mechanism()).branches].index(name)


def orders(errors: list[float]) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


# ------------------------------------------------------------------------------------------- closed forms


def coulomb(t: np.ndarray, x0: float, omega: float, delta: float) -> np.ndarray:
    """Free oscillator with friction: half cosines about +-delta, each 2 delta shorter, until it stops within delta."""
    x, half = np.empty_like(t), np.floor(t * omega / np.pi).astype(int)
    for n in range(half.max() + 1):
        turn = (-1.0) ** n * (x0 - 2.0 * n * delta)
        if abs(turn) <= delta or turn * (-1.0) ** n < 0.0:
            x[half >= n] = turn
            return x
        centre, here = (-1.0) ** n * delta, half == n
        x[here] = centre + (turn - centre) * np.cos(omega * t[here] - n * np.pi)
    return x


def test_coulomb_oscillator_at_first_order() -> None:
    m, k, f = 2.0, 800.0, 4.0
    x0, omega, delta = 9.3 * f / k, (k / m) ** 0.5, f / k
    errors = []
    for h in (4e-4, 2e-4, 1e-4, 5e-5):
        result = run(block(Spring(k) | Friction(f), m), 1.2, h, displacement={"x": x0}, every=round(4e-4 / h))
        exact = coulomb(result.time, x0, omega, delta)
        errors.append(float(np.abs(result.displacement[:, 0] - exact).max()))
        assert np.abs(result.velocity[-50:]).max() == 0.0
        assert abs(k * result.displacement[-1, 0]) <= f
        assert result.forces[-1].sum() == pytest.approx(0.0, abs=1e-9)
    assert errors[-1] < 5e-4 * x0
    assert orders(errors).mean() == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize(
    "network", [Friction(5.0), Friction(5.0) - Friction(8.0), Friction(8.0) - (Friction(5.0) | Spring(1e-6))]
)
def test_sliding_block_stops_where_it_must_and_stays(network: Network) -> None:
    m, f, v0, h = 2.0, 5.0, 0.731, 1e-4
    result = run(block(network, m), 0.5, h, velocity={"x": v0})
    stop = m * v0 / f
    after = result.time > stop + 5.0 * h
    assert result.displacement[-1, 0] == pytest.approx(0.5 * v0 * stop, abs=v0 * h)
    assert np.abs(result.velocity[after, 0]).max() < 1e-6 * v0
    assert np.abs(result.acceleration[after, 0]).max() < 1e-3
    assert result.acceleration[result.time < stop - 2.0 * h, 0] == pytest.approx(-f / m, rel=1e-5)


@pytest.mark.parametrize("network", [Friction(5.0), Friction(5.0) - Friction(8.0), Friction(8.0) | Damper(10.0)])
def test_what_sticks_is_at_rest(network: Network) -> None:
    result = run(block(network), 1.0, 1e-3, force=lambda t: 4.9 * np.sin(9.0 * t))
    assert np.abs(result.velocity[:, 0]).max() < 1e-15
    assert np.abs(result.displacement[:, 0]).max() < 1e-15
    assert result.forces[1:-1, 0] == pytest.approx(4.9 * np.sin(9.0 * result.time[1:-1]), abs=1e-4)


def test_friction_in_series_with_a_spring() -> None:
    k, f, a, omega = 2e4, 12.0, 2e-3, 9.0
    errors = []
    for h in (4e-4, 2e-4, 1e-4):
        result = run(Rig(Friction(f) - Spring(k)), 2.0, h, road=lambda t: a * np.cos(omega * t), relaxed=True)
        fine = np.arange(round(2.0 / 1e-5) + 1) * 1e-5
        force, exact = 0.0, np.zeros(fine.size)
        for i, step in enumerate(np.diff(a * np.cos(omega * fine))):
            force = min(max(force + k * step, -f), f)
            exact[i + 1] = force
        away = result.forces[:, 0] - exact[:: round(h / 1e-5)]
        errors.append(float(np.abs(away).max()))
        assert np.abs(result.forces).max() <= f * (1.0 + 1e-12)
        assert result.forces[:, 0] == pytest.approx(result.forces[:, 1], abs=2.0 * k * a * omega * h)
    assert errors[-1] < 1.5 * k * a * omega * 1e-4
    assert orders(errors).mean() == pytest.approx(1.0, abs=0.25)


def test_friction_in_series_with_a_damper() -> None:
    c, f, a, omega, h = 900.0, 12.0, 2e-3, 9.0, 1e-4
    result = run(Rig(Friction(f) - Damper(c)), 1.5, h, road=lambda t: a * np.cos(omega * t), relaxed=True)
    exact = np.clip(-c * a * omega * np.sin(omega * result.time), -f, f)
    assert result.forces[1:-1, 0] == pytest.approx(exact[1:-1], abs=c * a * omega**2 * h)
    assert result.forces[:, 1] == pytest.approx(result.forces[:, 0], abs=1e-9)


def test_open_gap_relaxes_and_its_inerter_coasts() -> None:
    """The table stops at once: the elastic element relaxes with its own time constant, friction slows the inerter."""
    h, k, c, b, f = 1e-5, 1e4, 50.0, 113.0, 40.0
    rig = Rig((Spring(k) | Damper(c)) - Gap(5e-3) - (Inerter(b) | Friction(f)))
    result = run(rig, 0.02, h, displacement={"device.node0_1": 1e-3}, velocity={"device.node1_2": 0.1})
    assert result.displacement[:, 0] == pytest.approx(1e-3 * np.exp(-k / c * result.time), rel=1e-4)
    assert result.velocity[:, 1] == pytest.approx(0.1 - f / b * result.time, rel=1e-9)
    assert np.abs(result.forces[:, label(rig, "gap")]).max() == 0.0


# --------------------------------------------------------------------------------- against other integrations


@pytest.mark.parametrize("hold", ["linear", "zero", "cubic"])
def test_linear_quarter_car_at_second_order(hold: str) -> None:
    ms, mu, kt, k, c, b = 181.75, 25.0, 120e3, 90e3, 1500.0, 60.0
    car = paper_quarter_car(Spring(k) | Damper(c) | Inerter(b))
    M, pair = np.array([[ms + b, -b], [-b, mu + b]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
    solve = np.linalg.inv(M)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-solve @ (k * pair + np.diag([0.0, kt])), -c * solve @ pair]])
    B = np.vstack([np.zeros((2, 2)), solve @ np.array([[0.0, 1.0], [kt, 0.0]])])

    def force(t: np.ndarray) -> np.ndarray:
        return 80.0 * np.sin(21.0 * t)

    errors = []
    for h in (2e-3, 1e-3, 5e-4):
        result = run(car, 0.6, h, road=bumpy, force=force, hold=hold)
        u = np.column_stack([bumpy(result.time), force(result.time)])
        if hold == "cubic":
            exact = solve_ivp(
                lambda t, x: A @ x + B @ np.array([bumpy(np.array(t)), force(np.array(t))]),
                (0.0, 0.6), np.zeros(4), "DOP853", result.time, rtol=1e-10, atol=1e-13,
            ).y.T  # fmt: skip
        else:
            exact = lsim((A, B, np.eye(4), np.zeros((4, 2))), u, result.time, interp=hold == "linear")[1]
        speeds = np.abs(result.velocity - exact[:, 2:]).max() / np.abs(exact[:, 2:]).max()
        places = np.abs(result.displacement - exact[:, :2]).max() / np.abs(exact[:, :2]).max()
        errors.append(float(max(speeds, places)))
        if hold != "zero":
            slope = exact @ A.T + u @ B.T
            away = np.abs(result.acceleration - slope[:, 2:])[2:-2].max()
            assert away < 3e-2 * (h / 5e-4) ** 2 * np.abs(slope[:, 2:]).max()
    assert orders(errors).mean() == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 1e-3


@pytest.mark.parametrize(
    "strut",
    [
        Spring(120e3) | Damper(2000.0) - Inerter(80.0),
        Spring(60e3) | Damper(3000.0) - (Spring(3e5) | Damper(800.0)) - Inerter(300.0),
        Spring(60e3) | (Spring(1e5) - Spring(2e5) - Damper(900.0)),
    ],
)
def test_linear_networks_with_massless_nodes_at_second_order(strut: Network) -> None:
    """Free motion from a velocity, against the matrix exponential of the assembled system."""
    car = paper_quarter_car(strut)
    system = state_space(car)
    names = [f"{c.name}_velocity" for c in car.mechanism().coordinates]
    start = np.zeros(len(system.states))
    errors = []
    for h in (2e-3, 1e-3, 5e-4, 2.5e-4):
        v = {"sprung": 0.3, "unsprung": -0.2}
        inerter = any(isinstance(e, Inerter) for e in strut.elements())
        if inerter:  # with its lower end at rest against the wheel
            v[full_graph(car.mechanism()).nodes[-1]] = -0.2
        for i, state in enumerate(system.states):
            start[i] = v.get(state.removesuffix("_velocity"), 0.0)
        result = run(car, 0.3, h, velocity=v)
        exact = expm(system.A * result.time[-1]) @ start
        away = [result.velocity[-1, i] - exact[system.states.index(name)] for i, name in enumerate(names)]
        errors.append(float(np.abs(away).max()))
    assert orders(errors).mean() == pytest.approx(2.0, abs=0.2)


def screw_by_hand(time: np.ndarray, u: Signal, k: float, c: float, eps: float, b: float, f: float) -> np.ndarray:
    """Force of (k | c) - gap - (b | f) under a displacement u, mode by mode; Nordin, Galic and Gutman (1997).

    States: elongation of the elastic element, displacement and velocity of the inerter.
    """

    def contact_force(t: float, x: np.ndarray) -> float:
        return float(k * x[0] + c * (rate(u, np.array(t)) - x[2]))

    def slope(t: float, x: np.ndarray, side: int, slip: int) -> list[float]:
        force = contact_force(t, x) if side else 0.0
        elastic = rate(u, np.array(t)) - x[2] if side else -k / c * x[0]
        return [float(elastic), x[2], (force - slip * f) / b if slip else 0.0]

    def guard(t: float, x: np.ndarray, side: int, slip: int) -> list[float]:
        gap = float(u(np.array(t))) - x[0] - x[1]
        force = contact_force(t, x) if side else 0.0
        return [side * force if side else eps - abs(gap), slip * x[2] if slip else f - abs(force)]

    events = [lambda t, x, *mode, i=i: guard(t, x, *mode)[i] for i in (0, 1)]
    for event in events:
        event.terminal, event.direction = True, -1.0
    t, x, side, slip = time[0], np.array([0.0, 0.0, 0.0]), 0, 0
    result = np.zeros(time.size)
    while t < time[-1]:
        part = solve_ivp(
            slope,
            (t, time[-1]),
            x,
            "DOP853",
            None,
            True,
            events,
            args=(side, slip),
            rtol=1e-9,
            atol=1e-12,
            max_step=2e-3,
        )
        here = (time >= t) & (time <= part.t[-1])
        result[here] = [contact_force(s, part.sol(s)) if side else 0.0 for s in time[here]]
        t, x = part.t[-1], part.y[:, -1].copy()
        if part.t_events[0].size:
            side = 0 if side else int(np.sign(float(u(np.array(t))) - x[0] - x[1]))
        elif part.t_events[1].size:
            slip = 0
        force = contact_force(t, x) if side else 0.0
        if slip == 0:
            x[2] = 0.0
            if abs(force) >= f:
                slip = int(np.sign(force))
                x[2] = slip * 1e-12
    return result


def test_ball_screw_on_the_rig() -> None:
    a, omega = 1e-3, 6.0 * np.pi
    rig = Rig(SCREW)

    def table(t: np.ndarray) -> np.ndarray:
        return a * np.cos(omega * t) - a

    time = np.arange(801) * 1e-3
    exact = screw_by_hand(time, table, 1e6, 3200.0, 1e-4, 113.0, 10.0)
    errors = []
    for h in (1e-4, 5e-5, 2.5e-5):
        result = run(rig, 0.8, h, road=table, every=round(1e-3 / h))
        away = np.abs(result.forces[:, label(rig, "gap")] - exact)
        errors.append(float(np.sqrt(np.mean(np.sort(away)[:-40] ** 2)) / np.sqrt(np.mean(exact**2))))  # not at jumps
    assert errors[-1] < 3e-3
    assert orders(errors).mean() == pytest.approx(1.0, abs=0.35)


# ------------------------------------------------------------------------------------------- laws


DEVICES: dict[str, Network] = {
    "friction": Spring(120e3) | Damper(3705.4) | Inerter(128.57) | Friction(60.0),
    "screw": Spring(120e3) | Damper(2000.0) | SCREW,
    "series": Spring(60e3) | Damper(1500.0) - SCREW,
    "stick": Spring(60e3) | (Friction(80.0) - Spring(90e3)) | (Friction(40.0) - Damper(3e3)) | Damper(500.0),
    "inner": Spring(60e3) | (Spring(2e5) - (Damper(500.0) | Friction(70.0)) - (Spring(1e5) | Friction(30.0))),
    "several": Spring(60e3)
    | Friction(10.0) - (Friction(15.0) | Spring(3e4))
    | (Spring(2e5) | Damper(900.0)) - Gap(2e-3),
}


@pytest.mark.parametrize("device", DEVICES)
def test_energy_balance_closes_at_first_order(device: str) -> None:
    car = paper_quarter_car(DEVICES[device])
    graph, left = full_graph(car.mechanism()), []
    mass = np.array([181.75, 25.0, *[0.0] * (len(graph.nodes) - 2)])
    for h in (2e-4, 5e-5):
        r = run(car, 1.0, h, road=bumpy)
        stored, spent = 0.5 * r.velocity**2 @ mass, np.zeros(r.time.size)
        for branch, force in zip(graph.branches, r.forces.T, strict=True):
            elongation = r.displacement @ branch.nodes + branch.roads[0] * bumpy(r.time)
            value = float(branch.element.value)  # type: ignore[arg-type]
            if isinstance(branch.element, Spring):
                stored += 0.5 * value * elongation**2
            elif isinstance(branch.element, Inerter):
                stored += 0.5 * value * (r.velocity @ branch.nodes) ** 2
            else:
                work = 0.5 * (force[1:] + force[:-1]) * np.diff(elongation)
                spent[1:] += np.cumsum(work)
                if not isinstance(branch.element, Gap):
                    assert -work[work < 0.0].sum() < 2e-3 * work.sum()
        tyre = r.forces[:, -1]
        input_work = np.zeros(r.time.size)
        input_work[1:] = np.cumsum(-0.5 * (tyre[1:] + tyre[:-1]) * np.diff(bumpy(r.time)))
        left.append(float(np.abs(input_work - stored - spent).max() / stored.max()))
    assert left[1] < 3e-3
    assert left[1] < 0.5 * left[0]


@pytest.mark.parametrize("device", ["screw", "series", "several"])
def test_contact_never_pulls_and_never_passes(device: str) -> None:
    car = paper_quarter_car(DEVICES[device])
    branches = full_graph(car.mechanism()).branches
    i = next(i for i, branch in enumerate(branches) if isinstance(branch.element, Gap))
    half = float(branches[i].element.value)  # type: ignore[arg-type]
    r = run(car, 1.0, 1e-4, road=bumpy)
    elongation, force = r.displacement @ branches[i].nodes, r.forces[:, i]
    assert np.abs(elongation).max() <= half * (1.0 + 1e-9)
    assert (force * elongation).min() >= 0.0
    assert np.abs(force).max() > 100.0
    inside = np.abs(elongation) < half * (1.0 - 1e-9)
    inside[1:-1] &= inside[:-2] & inside[2:]
    assert np.abs(force[inside]).max() == 0.0


@pytest.mark.parametrize("device", DEVICES)
def test_friction_is_bounded_and_against_the_motion(device: str) -> None:
    car = paper_quarter_car(DEVICES[device])
    r = run(car, 1.0, 1e-4, road=bumpy)
    for branch, force in zip(full_graph(car.mechanism()).branches, r.forces.T, strict=True):
        if isinstance(branch.element, Friction):
            size = float(branch.element.value)  # type: ignore[arg-type]
            assert np.abs(force).max() <= size * (1.0 + 1e-12)
            rates = np.diff(r.displacement @ branch.nodes) / 1e-4
            sliding = np.abs(rates) > 1e-2
            sliding[:-1] &= np.abs(rates[1:]) > 1e-2
            sliding[1:] &= np.abs(rates[:-1]) > 1e-2
            assert np.mean(force[1:][sliding] == pytest.approx(size * np.sign(rates[sliding]))) > 0.95


SAME_AS: list[tuple[Network, Network]] = [
    (Spring(6e4) | Damper(900.0) | Friction(0.0), Spring(6e4) | Damper(900.0)),
    (
        Spring(6e4) | (Spring(1e6) | Damper(3200.0)) - Gap(0.0) - Inerter(60.0),
        Spring(6e4) | (Spring(1e6) | Damper(3200.0)) - Inerter(60.0),
    ),
    (
        Spring(6e4) | (Spring(1e5) | Damper(900.0)) - (Inerter(60.0) | Friction(1e9)),
        Spring(6e4) | Spring(1e5) | Damper(900.0),
    ),
    (Spring(6e4) | Friction(20.0) | Friction(35.0), Spring(6e4) | Friction(55.0)),
    (Spring(6e4) | Friction(20.0) - Friction(35.0), Spring(6e4) | Friction(20.0)),
    (Spring(6e4) | Friction(20.0) - Friction(20.0), Spring(6e4) | Friction(20.0)),
    (Spring(6e4) | Gap(5e-3) - Friction(20.0) - Friction(35.0), Spring(6e4) | Gap(5e-3) - Friction(20.0)),
    (Spring(6e4) | Spring(1e5) - Gap(1e-3) - Gap(2e-3), Spring(6e4) | Spring(1e5) - Gap(3e-3)),
    (Spring(6e4) | (Gap(3e-3) | Gap(1e-3)) - Spring(1e5), Spring(6e4) | Gap(1e-3) - Spring(1e5)),
    (Spring(6e4) | Damper(900.0) - Gap(0.0) - Gap(0.0), Spring(6e4) | Damper(900.0)),
    (Spring(6e4) | (Friction(20.0) | Gap(0.0)) - Damper(900.0), Spring(6e4) | Damper(900.0)),
    (Spring(6e4) | Friction(15.0) | Friction(20.0) - Friction(10.0), Spring(6e4) | Friction(25.0)),
]


@pytest.mark.parametrize(("one", "other"), SAME_AS)
def test_networks_that_are_the_same(one: Network, other: Network) -> None:
    first, second = (run(paper_quarter_car(network), 0.6, 2e-4, road=bumpy, every=10) for network in (one, other))
    for what in ("displacement", "velocity"):
        a, b = getattr(first, what)[:, :2], getattr(second, what)[:, :2]
        assert a == pytest.approx(b, abs=2e-6 * np.abs(b).max())


def test_gaps_without_a_place_of_their_own() -> None:
    """Two gaps end to end bound their sum; how it is split between them is nobody's business."""
    r = run(Rig(Gap(1e-3) - Gap(2e-3) - Spring(1e4)), 1.0, 1e-4, road=lambda t: 5e-3 * np.sin(9.0 * t))
    total = 5e-3 * np.sin(9.0 * r.time)
    exact = 1e4 * (total - np.clip(total, -3e-3, 3e-3))
    assert r.forces[1:-1, 2] == pytest.approx(exact[1:-1], abs=1.0)


def test_samples_are_those_of_every_step() -> None:
    car = paper_quarter_car(DEVICES["screw"])
    full, some = (run(car, 0.3, 1e-4, road=bumpy, every=every) for every in (1, 7))
    for name in ("time", "displacement", "velocity", "acceleration", "forces"):
        assert np.array_equal(getattr(some, name), getattr(full, name)[::7]), name


def test_laying_out_inputs_in_pieces_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    car = paper_quarter_car(DEVICES["several"])
    whole = run(car, 0.3, 1e-4, road=bumpy, every=7)
    monkeypatch.setattr("inerter.simulation.time_stepping.CHUNK", 331)
    pieces = run(car, 0.3, 1e-4, road=bumpy, every=7)
    assert np.array_equal(whole.forces, pieces.forces)
    assert np.array_equal(whole.velocity, pieces.velocity)


# ------------------------------------------------------------------------------------------- random mechanisms


def random_network(rng: np.random.Generator, kinds: list[type]) -> Network:
    if len(kinds) == 1:
        low, high = {Spring: (5e3, 5e5), Damper: (2e2, 1e4), Inerter: (5, 500), Friction: (1, 300), Gap: (5e-5, 3e-3)}[
            kinds[0]
        ]
        return kinds[0](float(np.exp(rng.uniform(np.log(low), np.log(high)))))  # type: ignore[no-any-return]
    cut = int(rng.integers(1, len(kinds)))
    one, other = random_network(rng, kinds[:cut]), random_network(rng, kinds[cut:])
    return one | other if rng.random() < 0.5 else one - other


def random_strut(rng: np.random.Generator) -> Network:
    hard = [Friction if rng.random() < 0.6 else Gap for _ in range(rng.integers(1, 5))]
    kinds = [*hard, *([Spring, Damper, Inerter][rng.integers(3)] for _ in range(rng.integers(1, 5)))]
    return random_network(rng, [kinds[i] for i in rng.permutation(len(kinds))])


def random_vehicle(rng: np.random.Generator) -> Vehicle:
    match rng.integers(3):
        case 0:
            return paper_quarter_car(random_strut(rng) | Spring(4e4))
        case 1:
            struts = random_strut(rng) | Spring(4e4), random_strut(rng) | Damper(2e3)
            return HalfCar(700.0, 900.0, 30.0, 25.0, 2e5, 1.5e5, 0.8, 1.2, *struts)
    return Rig(random_strut(rng) - (Spring(3e5) | Damper(1e3)))


@pytest.mark.parametrize("count", sampled([15, 40], seldom=[40]))
def test_convergence_on_random_mechanisms(count: int) -> None:
    rng, gains = np.random.default_rng(5), []
    while len(gains) < count:
        vehicle = random_vehicle(rng)
        coordinates = len(vehicle.mechanism().coordinates)
        try:
            three = [run(vehicle, 0.4, h, road=bumpy, every=round(4e-4 / h)) for h in (1e-4, 2.5e-5, 6.25e-6)]
        except SimulationError:  # a gap that nothing gives way to
            continue
        if coordinates == 0:
            continue
        a, b, c = (np.hstack([30.0 * r.displacement[:, :coordinates], r.velocity[:, :coordinates]]) for r in three)
        size = np.sqrt(np.mean(c**2))
        coarse, fine = (float(np.sqrt(np.mean(d**2))) / size for d in (a - b, b - c))
        assert fine < 2e-3, vehicle
        gains.append(np.log(max(coarse, 1e-12) / max(fine, 1e-12)) / np.log(4.0))
    assert 0.9 < np.median(gains) < 2.1
    assert np.mean(np.array(gains) > 0.6) > 0.85


# ------------------------------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("vehicle", "message"),
    [
        (paper_quarter_car(Spring(1e4) | Gap(1e-3)), "no compliance"),
        (paper_quarter_car(Spring(1e4) | Gap(1e-3) - Inerter(10.0)), "no compliance"),
        (paper_quarter_car(Spring(1e4) | (Inerter(10.0) - Gap(1e-3) - Gap(1e-3))), "no compliance"),
        (Rig(Gap(1e-3)), "no compliance"),
        (Rig(Gap(0.0) - Gap(0.0)), "rigidly"),
        (Rig(Spring(1e3) | Damper(free(1.0, 2.0))), "free"),
    ],
)
def test_undefined_mechanisms_are_refused(vehicle: Vehicle, message: str) -> None:
    with pytest.raises(SimulationError, match=message):
        run(vehicle, 0.1, 1e-2)


def test_unusable_input_is_refused() -> None:
    with pytest.raises(SimulationError, match="jumps"):
        run(Rig(Inerter(1.0) - Spring(10.0)), 0.1, 1e-2, hold="zero")
    with pytest.raises(SimulationError, match="beyond"):
        run(Rig(Gap(1e-3) - Spring(10.0)), 0.1, 1e-2, displacement={"device.node0_1": 2e-3})
    with pytest.raises(SimulationError, match="finite"):
        run(Rig(Spring(10.0)), 0.1, 1e-2, road=lambda t: np.where(t > 0.05, np.nan, 0.0))


def test_a_node_that_springs_hold_starts_in_balance() -> None:
    r = run(Rig(Spring(1e3) - Spring(3e3)), 0.1, 1e-2, displacement={"device.node0_1": 1.0})
    assert np.abs(r.displacement).max() < 1e-12


def test_steps_are_made_of_the_types_that_their_code_is_prepared_for() -> None:
    run(paper_quarter_car(Spring(120e3) | Damper(3705.4) | SCREW), 0.01, 1e-3)
    assert len(march.ready().signatures) == 1
