"""Motions that are faster than a step: steps are divided, and the motion stays the same."""

import numpy as np
import pytest
from same_motions import assert_same_motion

import inerter as it
from inerter.simulation import event_driven
from inerter.simulation.inputs import InputTable, tabulate
from inerter.simulation.periodic_steady_state import mean_squares, recorded_period
from inerter.systems.piecewise import PiecewiseSystem, piecewise

SLOW = it.Spring(120e3) | it.Damper(3e3) - (it.Inerter(300.0) | it.Friction(10.0))
FAST = it.Spring(120e3) | it.Damper(2e3) | it.Damper(1e4) - (it.Inerter(2.0) | it.Friction(10.0))
RATTLING = it.Spring(120e3) | it.Damper(2e3) | (it.Spring(1e6) | it.Damper(1e4)) - it.Gap(1e-4) - it.Inerter(2.0)
STEP = 1e-3
HELD = it.Signal.sampled(4e-3 * np.arange(126), 5e-3 * np.sin(0.3 * np.arange(126.0)), hold="zero", periodic=True)
LINES = it.Signal.sampled(0.0173 * np.arange(30), 5e-3 * np.sin(0.4 * np.arange(30.0)), hold="linear")
ROADS = {"sine": it.sine(0.01, 2.0), "held": HELD, "lines that join between steps": LINES}


def member(strut: it.Network, road: it.Signal) -> tuple[PiecewiseSystem, InputTable]:
    system = piecewise(it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut))
    return system, tabulate([road, None], [0.0, 0.0], 0.5, STEP, every=2)


@pytest.mark.parametrize("strut", [FAST, RATTLING])
@pytest.mark.parametrize("road", ROADS)
def test_a_motion_in_divided_steps_is_that_in_pieces_of_a_series(strut, road):
    system, table = member(strut, ROADS[road])
    runs = [begin(system, table, np.zeros(system.order)) for begin in (event_driven.start, event_driven.start_finely)]
    for run in runs:
        run.advance(run.table.time.size - 1)
    whole, divided = runs
    assert whole.table is table
    assert 3 * table.time.size < divided.table.time.size < 16 * table.time.size
    assert whole.status.ok
    assert whole.events > 5
    assert_same_motion(divided, whole, instants=1e-10, states=1e-9)


@pytest.mark.parametrize("find", ["squares", "period"])
def test_a_periodic_state_of_a_fast_motion_is_not_searched_for_events_in_every_step(find, monkeypatch):
    monkeypatch.setattr(event_driven, "_PIECES", 10**9)
    system, table = member(FAST, ROADS["sine"])
    if find == "squares":
        _, run, _ = mean_squares(system, table, ["sprung_acceleration"], np.zeros(system.order))
    else:
        run, *_ = recorded_period(system, table)
    assert run.status.ok
    assert 10**9 - int(run.motion.place["left"][0]) < 8 * run.events + 20


@pytest.mark.parametrize("given", [{"duration": 0.5}, {"initial": "periodic"}])
def test_a_trajectory_in_divided_steps_has_the_samples_of_one_in_whole_steps(given, monkeypatch):
    car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=FAST)
    divided = it.simulate(car, road=ROADS["sine"], step=STEP, every=2, **given)
    monkeypatch.setattr(event_driven, "_MOST_PARTS", 1)
    whole = it.simulate(car, road=ROADS["sine"], step=STEP, every=2, **given)
    assert divided.status.ok
    assert divided.end == whole.end
    np.testing.assert_array_equal(divided.time, whole.time)
    for name in ("sprung_acceleration", "tyre_load", "road"):
        np.testing.assert_allclose(divided[name], whole[name], rtol=0.0, atol=1e-9 * np.abs(whole[name]).max())


@pytest.mark.parametrize("strut", [SLOW, FAST])
@pytest.mark.parametrize("road", ROADS)
def test_a_batch_squares_the_samples_after_those_that_it_discards(strut, road):
    car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    outputs = ["sprung_acceleration", "tyre_load"]
    batch = it.simulate_many([car], road=[ROADS[road]], outputs=outputs, duration=0.5, step=STEP, discard=0.25)
    run = it.simulate(car, road=ROADS[road], duration=0.5, step=STEP)
    expected = [np.mean(run[name][251:] ** 2) for name in outputs]
    np.testing.assert_allclose(batch.mean_square[0, 0], expected, rtol=1e-9)


def test_steps_that_resolve_a_motion_stay_as_they_are():
    system, table = member(SLOW, ROADS["sine"])
    assert event_driven.start_finely(system, table, np.zeros(system.order)).table is table
    assert table.refine(1) is table


def test_steps_are_not_divided_into_more_parts_than_memory_allows(monkeypatch):
    system, table = member(FAST, ROADS["sine"])
    monkeypatch.setattr(event_driven, "_MOST_ENTRIES", 3 * table.value.size)
    assert event_driven.start_finely(system, table, np.zeros(system.order)).table is table
