"""What the event-driven integrator spends on events: bounds of guards within a step, alarms, and roots."""

import numpy as np
import pytest

import inerter as it
from inerter.kernels import flow
from inerter.kernels.flow import first_root, inputs_from, orders_in, series, value_at
from inerter.kernels.integrate import fill_sharp_sways, fill_sways, path_in, room_of
from inerter.simulation import event_driven
from inerter.simulation.inputs import tabulate
from inerter.systems.piecewise import piecewise

FRICTION = it.Friction(10.0)
STRUTS = {
    "parallel": it.Spring(120e3) | it.Damper(3705.4) | it.Inerter(128.57) | FRICTION,
    "series": it.Spring(120e3) | it.Damper(7544.2) - (it.Inerter(366.52) | FRICTION),
    "two": (it.Spring(120e3) | it.Damper(3705.4) | FRICTION) - (it.Spring(1e6) | it.Damper(3200.0) | it.Friction(5.0)),
    "gap": it.Spring(120e3)
    | it.Damper(7353.0) - ((it.Spring(1e6) | it.Damper(3200.0)) - it.Gap(2e-4) - it.Inerter(300.0)),
}


def _begin(strut, step: float = 5e-4, duration: float = 10.0):
    system = piecewise(it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut))
    signals = [it.flat_multisine(0, 3e-3, 0.1, 500.0), *(None for _ in system.mechanism.forces)]
    table = tabulate(signals, [0.0 for _ in signals], duration, step)
    return event_driven.start(system, table, np.zeros(system.order))


@pytest.mark.parametrize("strut", STRUTS)
def test_a_guard_stays_within_its_ends_and_the_closest_bound_of_its_sway(strut):
    """Guards along the Taylor series of random motions, in every mode that was met."""
    run, rng = _begin(STRUTS[strut], step=2e-5, duration=0.5), np.random.default_rng(0)
    run.advance(run.table.time.size - 1)
    shape, sizes, h = run.march.shape, run.mechanics.sizes, run.table.step
    n, nu, nr, closer = sizes.states, sizes.inputs, sizes.roads, []
    for m in range(run.count):
        maps, path = run.modes.maps[m], path_in(np.zeros(room_of(shape)), shape)
        assert h < run.modes.reach[m]
        for _ in range(20):
            state, numbers = rng.normal(size=n), rng.normal(size=4 * (nr + len(run.system.mechanism.forces)))
            numbers[np.setdiff1d(np.arange(numbers.size), run.used)] = 0.0
            path.rows[0, :n], path.inputs[0, : run.used.size] = state, numbers[run.used]
            known = np.concatenate([state, numbers[run.used], [1.0]])
            path.rows[1] = known @ run.modes.steps[m][: known.size, : shape.rows]
            close, wide = np.zeros((2, sizes.elements))
            fill_sharp_sways(run.modes.steps[m], path, 0, shape, close)
            fill_sways(run.modes.steps[m], path, 0, 1, shape, wide)
            U, X = np.zeros((4, nu)), np.zeros_like(run.room.series)
            inputs_from(numbers, nr, nu, h, 0.0, h, U)
            count = series(run.modes.steps[m], state, U, n, nu, h, X)
            rows = maps[run.guards]
            terms = X[:count, :n] @ rows[:, :n].T
            terms[:4] += U @ rows[:, n : n + nu].T
            guards = X[orders_in(X) + 1 :][: count - 1, n : n + sizes.elements]  # as the series itself has them
            guards[0] -= rows[:, n + nu]
            rounding = np.abs(X[: count - 1, :n]) @ np.abs(rows[:, :n].T)
            rounding[:4] += np.abs(U) @ np.abs(rows[:, n : n + nu].T)
            assert np.all(np.abs(guards - terms[: count - 1]) <= 1e-14 * (rounding + np.abs(rows[:, n + nu])))
            guard = np.linspace(0.0, 1.0, 401)[:, None] ** np.arange(count) @ terms
            ends, rounding = guard[[0, -1]], 1e-12 * np.abs(terms).sum(axis=0)
            assert np.all(guard.max(axis=0) <= ends.max(axis=0) + close + rounding)
            assert np.all(guard.min(axis=0) >= ends.min(axis=0) - close - rounding)
            assert np.all(close <= wide * (1.0 + 1e-12))
            closer.append(close / np.maximum(wide, 1e-300))
    assert np.median(closer) < 0.9


def test_hardly_any_step_without_an_event_is_searched_for_one():
    """Of an event there are two pieces of a step and one or two modes on trial; an alarm is a piece more."""
    run = _begin(STRUTS["parallel"])
    run.advance(run.table.time.size - 1)
    spent = event_driven._PIECES - int(run.motion.place["left"][0])
    assert run.events > 100
    assert spent < 5.5 * run.events


@pytest.mark.parametrize("line", [[1.0, -4.0], [1.0, -2.0, -8.0], [0.3, -1.0, 0.0, 0.0]])
def test_a_root_that_newton_meets_to_the_last_bit_is_not_searched_further(monkeypatch, line):
    asked = []

    def counted(c, count, s):
        asked.append(s)
        return value_at(c, count, s)

    monkeypatch.setattr(flow, "value_at", counted)
    c = np.array(line)
    root = first_root(c, c.size, np.zeros(64))
    assert len(asked) < 12
    assert value_at(c, c.size, root) == pytest.approx(0.0, abs=1e-16)
