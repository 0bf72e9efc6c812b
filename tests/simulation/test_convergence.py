"""What must not change when the integration step is refined, and the order at which a finer input table converges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it

Array = Any
STATES = (
    "sprung_displacement",
    "sprung_velocity",
    "unsprung_displacement",
    "unsprung_velocity",
    "tyre_load",
    "k_shaft_force",
    "friction_velocity",
    "b_velocity",
)


def car(friction: float, half_gap: float = 0.0) -> it.QuarterCar:
    """Case 3 of the paper with a real screw."""
    shaft = it.Spring(1e6, name="k_shaft") | it.Damper(3200.0)
    flywheel = it.Inerter(328.72) | it.Friction(friction, name="friction")
    screw = shaft - it.Gap(half_gap, name="gap") - flywheel if half_gap else shaft - flywheel
    return paper_quarter_car(it.Spring(120e3) | it.Damper(7353.0) - screw)


def tabled(signal: it.Signal, duration: float, interval: float) -> it.Signal:
    """The signal as cubics through its values and slopes."""
    time = np.linspace(0.0, duration, round(duration / interval) + 1)
    value, slope = signal.grid(0.0, interval, time.size)
    return it.Signal.sampled(time, value, "cubic", derivative=slope, speed=25.0)


def run(vehicle: Any, **request: Any) -> it.Trajectory:
    result = it.simulate(vehicle, **request)
    assert result.status.ok, result.status
    if result.energy is not None:
        assert result.energy.relative_residual < 1e-8
    return result


def changes(result: it.Trajectory) -> list[tuple[str, str, str]]:
    return [(e.element, e.before, e.after) for e in result.events]


def difference(one: Array, other: Array) -> float:
    """The largest, relative to the largest of `other`."""
    return float(np.abs(one - other).max() / np.abs(other).max())


@pytest.mark.parametrize("half_gap", [0.0, 5e-5])
@pytest.mark.parametrize("friction", [10.0, 100.0, 500.0])
def test_the_step_does_not_matter(friction: float, half_gap: float) -> None:
    """One table every 0.2 ms; the flow is exact at every step, so states and events stay as they are."""
    duration = 3.0
    table = tabled(it.multisine(ROAD, seed=0), duration, 2e-4)
    vehicle = car(friction, half_gap)
    steps = (2e-4, 1e-4, 5e-5, 2e-5)
    first, *finer = (run(vehicle, road=table, duration=duration, step=step, energy=step == 2e-4) for step in steps)
    assert len(first.events) > 20
    for step, result in zip(steps[1:], finer, strict=True):
        assert changes(result) == changes(first)
        assert max(abs(a.time - b.time) for a, b in zip(result.events, first.events, strict=True)) < 1e-9
        for name in STATES:
            assert difference(result[name][:: round(2e-4 / step)], first[name]) < 1e-9


def test_the_step_does_not_matter_for_two_struts() -> None:
    duration = 1.0
    table = tabled(it.multisine(ROAD, seed=3), duration, 2e-4)
    legs = [car(friction, 5e-5).strut for friction in (30.0, 60.0)]
    vehicle = paper_half_car(*legs)
    coarse, fine = (run(vehicle, road=table, duration=duration, step=step) for step in (2e-4, 5e-5))
    assert len(coarse.events) > 40
    assert changes(coarse) == changes(fine)
    for name in ("sprung_acceleration", "pitch_velocity", "tyre_rear_load", "front_force"):
        assert difference(fine[name][::4], coarse[name]) < 1e-9


@pytest.mark.parametrize("half_gap", [0.0, 5e-5])
@pytest.mark.parametrize("friction", [10.0, 100.0])
def test_a_finer_table_converges_at_fourth_order(friction: float, half_gap: float) -> None:
    """The table's cubics are off by its interval to the fourth power, and so are states and the times of events."""
    duration, smooth = 1.0, it.multisine(ROAD, seed=6, lowest=1.0, highest=200.0)
    vehicle = car(friction, half_gap)
    intervals = (4e-4, 2e-4, 1e-4, 5e-5)
    *coarse, finest = (
        run(vehicle, road=tabled(smooth, duration, interval), duration=duration, step=interval)
        for interval in intervals
    )
    assert len(finest.events) > 5
    assert all(changes(result) == changes(finest) for result in coarse)
    # the finest is itself off by 1/16, 1/256, ... of the others
    share = [1.0 - 16.0 ** (i - 3) for i in range(3)]
    in_time = [max(abs(a.time - b.time) for a, b in zip(r.events, finest.events, strict=True)) for r in coarse]
    in_state = [max(difference(r[n], finest[n][:: 2 ** (3 - i)]) for n in STATES) for i, r in enumerate(coarse)]
    for errors in (in_time, in_state):
        corrected = np.array(errors) / share
        assert np.all(np.log2(corrected[:-1] / corrected[1:]) > 3.5), corrected
        assert corrected[-1] > 0.0


def test_a_formula_is_followed_at_fourth_order() -> None:
    """The same when the signal is given as it is, and tabled at every step."""
    smooth = it.multisine(ROAD, seed=6, lowest=1.0, highest=200.0)
    coarse, middle, fine = (run(car(50.0), road=smooth, duration=1.0, step=step) for step in (4e-4, 2e-4, 1e-4))
    for name in STATES:
        ratio = np.abs(coarse[name] - middle[name][::2]).max() / np.abs(middle[name] - fine[name][::2]).max()
        assert 3.5 < np.log2(ratio) < 5.0


@pytest.mark.parametrize("half_gap", [0.0, 5e-5])
def test_going_on_from_where_a_run_ended(half_gap: float) -> None:
    """Two halves are one whole: the state, the modes, the events and the energy."""
    signal = it.multisine(ROAD, seed=2)
    vehicle = car(50.0, half_gap)
    request: dict[str, Any] = {"road": signal, "step": 2e-4, "energy": True}
    whole = run(vehicle, duration=1.0, **request)
    begin = run(vehicle, duration=0.4, **request)
    rest = run(vehicle, duration=0.6, initial=begin, **request)
    assert rest.time[0] == pytest.approx(0.4)
    assert rest.time[-1] == pytest.approx(1.0)
    assert changes(begin) + changes(rest) == changes(whole)
    for name in STATES:
        both = np.concatenate([begin[name], rest[name][1:]])
        assert difference(both, whole[name]) < 1e-9
    assert begin.energy is not None
    assert rest.energy is not None
    assert whole.energy is not None
    assert begin.energy.input_work + rest.energy.input_work == pytest.approx(whole.energy.input_work, rel=1e-9)


def test_a_sample_every_so_many_steps() -> None:
    signal = it.multisine(ROAD, seed=2)
    every, fifth = (run(car(50.0, 5e-5), road=signal, duration=0.5, step=2e-4, every=n) for n in (1, 5))
    assert every.events == fifth.events
    for name in (*STATES, "sprung_acceleration"):
        assert np.array_equal(every[name][::5], fifth[name])
