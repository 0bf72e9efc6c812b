"""Whole steps: two from one state are two, and how many are made and judged together changes nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest
from same_motions import assert_same_motion
from wang_su import paper_quarter_car

import inerter as it
from inerter.kernels import integrate
from inerter.simulation import event_driven
from inerter.simulation.inputs import InputTable, tabulate
from inerter.systems.piecewise import PiecewiseSystem, piecewise

STEP = 1e-3
FRICTION = it.Spring(120e3) | it.Damper(3705.4) | it.Inerter(128.57) | it.Friction(100.0)
SHAFT = it.Spring(1e6) | it.Damper(3200.0)
BACKLASH = it.Spring(120e3) | it.Damper(7353.0) - SHAFT - it.Gap(5e-5) - (it.Inerter(328.72) | it.Friction(10.0))
ROAD = it.multisine(it.Road(roughness=5e-7, speed=25), seed=1, highest=100.0)
HELD = it.Signal.sampled(5e-3 * np.arange(801), 2e-3 * np.sin(np.arange(801.0)), hold="zero")
MEMBERS = {"friction": (FRICTION, ROAD), "backlash": (BACKLASH, ROAD), "held road": (FRICTION, HELD)}


def member(name: str) -> tuple[PiecewiseSystem, InputTable]:
    strut, road = MEMBERS[name]
    return piecewise(paper_quarter_car(strut)), tabulate([road, None], [0.0, 0.0], 4.0, STEP, every=3)


def started(name: str) -> event_driven.Integration:
    system, table = member(name)
    outputs = ["sprung_acceleration", "tyre_load"]
    return event_driven.start(system, table, np.zeros(system.order), outputs, discard=500)


@pytest.mark.parametrize("name", MEMBERS)
def test_steps_one_by_one_are_those_in_blocks(name):
    together, alone = started(name), started(name)
    last = together.table.time.size - 1
    together.advance(last)
    for knot in range(1, last + 1):
        alone.advance(knot)
    assert together.status.ok
    assert together.events > 20
    assert_same_motion(together, alone, instants=1e-11, states=1e-10)
    np.testing.assert_allclose(together.record.squares, alone.record.squares, rtol=1e-10)
    np.testing.assert_array_equal(together.record.visited, alone.record.visited)


@pytest.mark.parametrize("name", MEMBERS)
def test_two_steps_from_one_state_are_two_steps(name):
    run, rng = started(name), np.random.default_rng(0)
    run.advance(run.table.time.size - 1)
    shape = run.march.shape
    n, m, rows = shape.states, shape.inputs, shape.rows
    for mode in range(run.count):
        lines = run.modes.steps[mode, :, :rows]
        once, twice = lines[: n + m + 1], lines[n + m + 1 + shape.jumps :][: n + 2 * m + 1]
        state, first, second = rng.normal(size=n) / np.abs(once[:n, :n]).max(), rng.normal(size=m), rng.normal(size=m)
        middle = np.concatenate([state, first, [1.0]]) @ once
        expected = np.concatenate([middle[:n], second, [1.0]]) @ once
        found = np.concatenate([state, first, second, [1.0]]) @ twice
        size = np.abs(np.concatenate([middle[:n], second, [1.0]])) @ np.abs(once)
        assert np.all(np.abs(found - expected) <= 1e-12 * size)


@pytest.mark.parametrize("name", MEMBERS)
def test_sizes_that_are_compiled_change_no_bit(name, monkeypatch):
    runs = []
    for worth in (math.inf, 0):
        monkeypatch.setattr(integrate, "WORTH_COMPILING", worth)
        run = started(name)
        run.advance(run.table.time.size - 1)
        runs.append(run)
    read, compiled = runs
    assert read.march.address == 0
    assert compiled.march.address != 0
    assert read.events > 20
    for found, expected in zip(compiled.record, read.record, strict=True):
        np.testing.assert_array_equal(found, expected)


def test_sizes_are_compiled_once_the_steps_of_all_runs_repay_it(monkeypatch):
    steps = member("friction")[1].time.size
    monkeypatch.setattr(integrate, "WORTH_COMPILING", 2 * steps + 1)
    monkeypatch.setattr(integrate, "_STEPS", type(integrate._STEPS)())
    assert [started("friction").march.address != 0 for _ in range(4)] == [False, False, True, True]


def test_a_device_without_states_is_marched():
    run = it.simulate(it.Rig(it.Damper(100.0)), displacement=it.sine(0.01, 2.0), duration=0.5, step=1e-3)
    assert run.status.ok
    assert np.abs(run["force"]).max() == pytest.approx(100.0 * 0.01 * 4.0 * np.pi, rel=1e-12)
