"""Signals that jump where steps join: whole steps at once against one by one, closed forms and time stepping."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from campaigns import sampled
from mechanisms import random_network
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, Friction, Inerter, Mechanism, Spring, Tyre
from inerter.errors import SimulationError
from inerter.simulation import event_driven
from inerter.simulation.initial_state import initial_state
from inerter.simulation.inputs import check_holds, parts_of, tabulate
from inerter.simulation.observe import trajectory_of
from inerter.simulation.periodic_steady_state import mean_squares, recorded_period
from inerter.systems.piecewise import piecewise

HOLD = 1e-3
S3 = Spring(120e3) | Damper(3e3) - (Inerter(300.0) | Friction(20.0, "f"))


def held(seed: int, hold: float = HOLD):
    return it.multisine(ROAD, seed=seed, highest=200.0).held(hold)


def pushes(seed: int):
    return it.held_noise(seed=seed, power=200.0, interval=5e-3, duration=3.0)


def through(car, signals, delays, outputs, whole_steps=True, parts=1, duration=1.0):
    """An integration that may take whole steps at once, or (with the energy account) may not; and its trajectory."""
    system = piecewise(car)
    check_holds(system, signals[: len(system.mechanism.roads)])
    table = tabulate(signals, delays, duration, HOLD / parts, every=parts)
    state = initial_state(system, table.value[0], "rest")
    run = event_driven.start(system, table, state, outputs, account=not whole_steps)
    run.advance(table.time.size - 1)
    assert run.status.ok
    return run, trajectory_of(run, None, "")


def same(one, other, outputs, close=1e-9):
    """Two runs agree in samples, events and mean squares; and their mean squares are those of their samples."""
    (run, motion), (check, slow) = one, other
    assert [(e.element, e.before, e.after) for e in motion.events] == [
        (e.element, e.before, e.after) for e in slow.events
    ]
    assert [e.time for e in motion.events] == pytest.approx([e.time for e in slow.events], abs=1e-9)
    for i, name in enumerate(outputs):
        size = slow.rms(name)
        assert motion[name] == pytest.approx(slow[name], abs=1e3 * close * size)
        for integration, samples in (one, other):
            assert integration.record.squares[i] == pytest.approx(np.sum(samples[name][1:] ** 2), rel=close)
    assert run.record.states == pytest.approx(check.record.states, abs=1e-9 * np.abs(check.record.states).max())


COMFORT = ["sprung_acceleration", "sprung_velocity"]
LOADS = {False: ["tyre_load"], True: ["tyre_front_load", "tyre_rear_load", "pitch_acceleration"]}


def random_car(seed: int):
    """Quarter and half cars of one or two nonlinear elements, roads with delays, forces that jump or do not."""
    rng = np.random.default_rng([99, seed])
    half = bool(seed % 2)
    inner = random_network(rng, 1 + seed % 3 // 2)
    strut = Spring(1e5) | Damper(2e3) | (Spring(5e5) | Damper(500.0)) - inner
    car = paper_half_car(strut, Spring(8e4) | Damper(1e3)) if half else paper_quarter_car(strut)
    roads = [held(seed)] * (1 + half)
    forces = [pushes(seed) if seed % 3 else None, *([None] * half)]
    delays = [0.0, 0.0816 if seed % 4 == 1 else 0.0805, 0.0, 0.0] if half else [0.0, 0.0]
    return car, [*roads, *forces], delays, half


@pytest.mark.parametrize("seed", sampled(range(8), [0, 4], kept=3))
def test_whole_steps_are_single_steps(seed):
    car, signals, delays, half = random_car(seed)
    outputs = COMFORT + LOADS[half]
    parts = parts_of(HOLD, delays)
    one, other = (through(car, signals, delays, outputs, whole, parts) for whole in (True, False))
    assert one[0].table.jumps
    same(one, other, outputs)
    if parts > 1:  # without parts, roads jump inside steps too, and each such step is taken with care
        again = through(car, signals, delays, outputs)
        assert again[0].table.special.size > 100
        same(one, again, outputs)


def test_a_held_road_by_hand():
    """Quarter car with an inerter beside spring and damper: the flow over a hold is one matrix exponential."""
    ms, mu, kt, k, c, b = 181.75, 25.0, 120e3, 8e4, 2e3, 30.0
    car = paper_quarter_car(Spring(k) | Damper(c) | Inerter(b))
    M = np.array([[ms + b, -b], [-b, mu + b]])
    on = np.linalg.solve(M, np.array([[-c, c, -k, 0.0], [c, -c, k, -kt]]))  # velocities, strut, tyre
    A = np.vstack([on, [1.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
    flow = scipy.linalg.expm(A * HOLD)
    height = held(5)(HOLD * np.arange(501))
    x, expected = np.zeros(4), np.zeros((501, 2))
    for i, rise in enumerate(np.diff(height, prepend=height[0])):
        before = on[0] @ x
        x[3] -= rise
        expected[i] = on[0] @ x, kt * x[3]
        x = flow @ x
    run = it.simulate(car, road=held(5), duration=0.5, step=HOLD)
    found = np.column_stack([run["sprung_acceleration"], run["tyre_load"]])
    assert found[:-1] == pytest.approx(expected[:-1], abs=1e-9 * np.abs(expected).max())
    squares = it.simulate_many([car], outputs=["sprung_acceleration"], road=[held(5)], duration=0.5, step=HOLD)
    total = np.sum(expected[1:-1, 0] ** 2) + before**2  # the last sample is that before the last jump
    assert squares.mean_square[0, 0, 0] == pytest.approx(total / 500, rel=1e-9)


@pytest.mark.parametrize("moved", [None, "held", "cubic"])
def test_squares_under_a_force_that_jumps_are_those_after_it(moved):
    car, force = paper_quarter_car(S3), pushes(3)
    road = {None: None, "held": held(1), "cubic": it.multisine(ROAD, seed=1, highest=200.0)}[moved]
    outputs = ["sprung_acceleration", "tyre_load", "f_velocity", "sprung_force"]
    one, other = (through(car, [road, force], [0.0, 0.0], outputs, whole) for whole in (True, False))
    same(one, other, outputs)
    batch = it.simulate_many(
        [car], outputs=outputs, road=road and [road], forces=[{"sprung_force": force}], duration=1.0, step=HOLD
    )
    assert batch.mean_square[0, 0] == pytest.approx([np.mean(one[1][name][1:] ** 2) for name in outputs], rel=1e-9)


def test_a_road_that_jumps_beside_one_that_an_inerter_follows():
    """Where one road jumps, the other one's acceleration is what it was."""
    mechanism = paper_half_car(Spring(120e3) | Damper(3e3), S3).mechanism()
    tyre = Tyre("tyre_rear", Spring(1e5) | Inerter(3.0), {"unsprung_rear": 1.0}, "road_rear")
    parts = (mechanism.struts, (mechanism.tyres[0], tyre), mechanism.roads, mechanism.forces, mechanism.measures)
    car = Mechanism(mechanism.coordinates, *parts)
    signals = [held(1), it.multisine(ROAD, seed=2, highest=200.0), None, None]
    outputs = ["tyre_rear_load", "tyre_front_load", "sprung_acceleration"]
    one, other = (through(car, signals, [0.0] * 4, outputs, whole) for whole in (True, False))
    same(one, other, outputs)


@pytest.mark.parametrize("half", [False, True])
def test_steps_that_do_not_divide_the_hold(half):
    car = paper_half_car(S3, Spring(1e5) | Damper(2e3)) if half else paper_quarter_car(S3)
    whole = it.simulate(car, road=held(2), duration=0.7, step=HOLD, every=7)
    odd = it.simulate(car, road=held(2), duration=0.7, step=0.7 * HOLD, every=10)
    assert len(whole.events) == len(odd.events) > 5
    for name in COMFORT + LOADS[half]:
        assert whole[name] == pytest.approx(odd[name], abs=1e-7 * odd.rms(name))


@pytest.mark.parametrize("seed", sampled([0, 1, 3], [3]))
def test_time_stepping_comes_to_the_same(seed):
    car, (road, *_), _, half = random_car(seed)
    outputs = ["sprung_velocity", "sprung_displacement"] + (["pitch_velocity"] if half else [])
    run = it.simulate(car, road=road, duration=0.5, step=HOLD)
    errors = []
    for finer in (5, 80):
        check = it.simulate(car, road=road, duration=0.5, step=HOLD / finer, every=finer, integrator="time-stepping")
        errors.append(max(np.abs(check[name] - run[name]).max() / run.rms(name) for name in outputs))
    assert errors[1] < 5e-3
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize("half", [False, True])
def test_mean_squares_of_a_period_are_those_of_its_samples(half):
    """A coarse hold: one sample of a hundred that is taken on the wrong side of its jump would show."""
    car = paper_half_car(S3, Spring(1e5) | Damper(2e3)) if half else paper_quarter_car(S3)
    road = it.multisine(ROAD, seed=1, lowest=1.0, highest=50.0).held(0.01)
    outputs = COMFORT + LOADS[half]
    roads = 1 + half
    table = tabulate([road] * roads + [None] * roads, [0.0, 0.08][:roads] + [0.0] * roads, 1.0, 0.01)
    system = piecewise(car)
    found, integration, _ = mean_squares(
        system, table, outputs, initial_state(system, table.value[0], "rest"), 300, 1e-11
    )
    assert integration.status.ok
    assert integration.warning.ok
    run = it.simulate(car, road=road, initial="periodic", step=0.01, speed=2.04 / 0.08 if half else None)
    assert found == pytest.approx([np.mean(run[name][:-1] ** 2) for name in outputs], rel=1e-8)


def test_too_few_periods_are_owned_up_to():
    car = paper_quarter_car(Spring(120e3) | Damper(50.0) - (Inerter(300.0) | Friction(1.0)))
    road = it.multisine(ROAD, seed=1, lowest=1.0, highest=50.0)
    system = piecewise(car)
    table = tabulate([road, None], [0.0, 0.0], 1.0, 2e-3)
    _, integration, _ = mean_squares(
        system, table, ["tyre_load"], initial_state(system, table.value[0], "rest"), 3, 1e-9
    )
    assert integration.status.ok
    assert integration.warning.kind == "inaccurate"
    assert "after 3 periods" in integration.warning.message


@pytest.mark.parametrize("period", [1.0, 25.0])
def test_a_recorded_period_is_the_steady_state(period):
    """Of a long period its end alone settles; either way the state is that of the periodic motion."""
    car = paper_quarter_car(S3)
    road = it.multisine(ROAD, seed=4, lowest=1.0 / period, highest=50.0)
    system = piecewise(car)
    table = tabulate([road, None], [0.0, 0.0], period, 2e-3).repeating
    run, mismatch, _ = recorded_period(system, table)
    assert mismatch <= 1e-6
    steady = it.simulate(car, road=road, initial="periodic", step=2e-3)
    assert run.state == pytest.approx(steady.final_state, abs=1e-5 * np.abs(steady.final_state).max())
    moved = trajectory_of(run, None, "")
    for name in (*COMFORT, "tyre_load"):
        assert moved[name] == pytest.approx(steady[name], abs=1e-4 * steady.rms(name))


@pytest.mark.parametrize(
    ("delays", "parts"), [((0.0,), 1), ((0.0, 0.08), 1), ((0.0, 0.0816), 5), ((0.0, 0.0805, 0.1612), 10)]
)
def test_into_how_many_steps_a_hold_is_parted(delays, parts):
    assert parts_of(HOLD, delays) == parts
    signals = [held(1)] * len(delays)
    table = tabulate(signals, delays, 0.2, HOLD / parts, every=parts)
    assert table.special.tolist() == [table.time.size + 1]  # no step is cut
    assert table.samples == 201
    assert table.jumps


def test_a_hold_that_cannot_be_parted_stays_whole():
    assert parts_of(HOLD, (0.0, np.pi / 40.0)) == 1
    table = tabulate([held(1)] * 2, [0.0, np.pi / 40.0], 0.2, HOLD)
    assert table.special.size > 100


def test_what_a_held_road_cannot_drive():
    car = paper_quarter_car(S3).mechanism()
    tyre = Tyre("tyre", Spring(120e3) | Damper(50.0), {"unsprung": 1.0}, "road")
    damped = Mechanism(car.coordinates, car.struts, (tyre,), car.roads, car.forces, car.measures)
    index = it.RideComfort(ROAD)
    with pytest.raises(SimulationError, match="damper follows the velocity of 'road'"):
        it.evaluate(damped, index, it.ExpectedValue(realisations=2, conventions="paper2008"))
    assert it.evaluate(damped, index, it.ExpectedValue(realisations=2)).status.ok


@pytest.mark.parametrize(("interval", "step"), [(0.01, 2e-4), (0.0033, 2e-4)], ids=["at steps", "between steps"])
@pytest.mark.parametrize("late", [4e-13, -4e-13, 3e-12])
def test_samples_that_are_late_by_rounding_jump_where_the_others_do(interval, step, late):
    """Times that are sums of intervals differ from those of steps, or of samples of another road, by rounding."""
    times, heights = interval * np.arange(31), 0.01 * np.random.default_rng(1).standard_normal(31)
    strut = it.Spring(60e3) | it.Damper(3e3) - (it.Inerter(50.0) | it.Friction(20.0))
    car, length = paper_half_car(strut, strut), step * round(25 * interval / step)

    def moved(shift: float, cut: int = 0) -> it.Trajectory:
        late_times = np.where(times > 0.0, times + shift, 0.0)
        roads = {
            "road_front": it.Signal.sampled(times, heights, "zero"),
            "road_rear": it.Signal.sampled(late_times, heights, "zero"),
        }
        begin = it.simulate(car, road=roads, duration=cut * step, step=step) if cut else "rest"
        return it.simulate(car, road=roads, duration=length - cut * step, step=step, initial=begin)

    whole, shifted, rest = moved(0.0), moved(late), moved(late, cut=50)
    for name in ("tyre_rear_load", "pitch_acceleration"):
        close = 1e-7 * np.abs(whole[name]).max()
        np.testing.assert_allclose(shifted[name], whole[name], rtol=0.0, atol=close)
        np.testing.assert_allclose(rest[name], whole[name][50:], rtol=0.0, atol=close)
