"""Modes that integrations of a system share change nothing."""

from dataclasses import replace

import numpy as np
import pytest
from wang_su import ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter.simulation import event_driven
from inerter.simulation.inputs import tabulate
from inerter.simulation.periodic_steady_state import settle
from inerter.systems.piecewise import piecewise

STRUT = it.Spring(1.2e5) | it.Damper(3000.0) | it.Friction(40.0)


def integrated(car, outputs):
    system, road = replace(piecewise(car)), it.multisine(ROAD, seed=1, lowest=1.0)  # a new one, without kept modes
    roads, forces = len(system.mechanism.roads), len(system.mechanism.forces)
    table = tabulate([road] * roads + [None] * forces, [0.0, 0.08][:roads] + [0.0] * forces, 1.0, 5e-4)
    runs = [event_driven.start(system, table, np.zeros(system.order), outputs) for _ in range(2)]
    for run in runs:
        run.advance(table.time.size - 1)
    return runs


@pytest.mark.parametrize("car", [paper_quarter_car(STRUT), paper_half_car(STRUT, STRUT)])
def test_runs_with_all_modes_share_them_and_equal_those_that_build_their_own(car, monkeypatch):
    outputs = ["sprung_acceleration"]
    shared, again = integrated(car, outputs)
    assert shared.modes is again.modes
    assert shared.events > 0
    monkeypatch.setattr(event_driven, "_MET_BY_ROADS", 0)
    own, other = integrated(car, outputs)
    assert own.modes is not other.modes
    assert own.count <= shared.count
    assert np.array_equal(again.record.states, shared.record.states)
    for run in (own, other):  # a mode that is built in between is entered anew, which rounds once more
        np.testing.assert_allclose(run.record.states, shared.record.states, rtol=0.0, atol=1e-12)
        assert run.record.squares == pytest.approx(shared.record.squares, rel=1e-12)
        assert run.events == shared.events


def test_the_period_that_is_recorded_is_the_one_that_repeats_so_well():
    system, road = piecewise(paper_quarter_car(STRUT)), it.sine(0.02, 2.0)
    table = tabulate([road, None], [0.0, 0.0], 1.0, 5e-4)
    run, steady = settle(system, table, np.zeros(system.order), energy=False)
    assert run.segment == table.time.size - 1
    assert run.events > 0
    assert run.mismatch(run.record.states[0]) == steady.mismatch < 1e-9
