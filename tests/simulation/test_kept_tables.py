"""Tables of inputs that are kept from run to run change nothing."""

import numpy as np
import pytest
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter.simulation import inputs


def car(damping=3000.0):
    strut = it.Spring(1.2e5) | it.Damper(damping) - (it.Inerter(300.0) | it.Friction(10.0))
    return paper_quarter_car(strut)


def run(signal, **options):
    return it.simulate(car(), road=signal, **{"duration": 2.0, "step": 5e-4} | options)


@pytest.mark.parametrize(
    "options", [{}, {"every": 3}, {"duration": 1.0}, {"step": 2.5e-4}, {"forces": {"sprung_force": it.sine(50.0, 3.0)}}]
)
def test_runs_equal_those_without_kept_tables(options, monkeypatch):
    signal = it.multisine(ROAD, seed=3)
    kept = [run(signal, **options) for _ in range(2)]
    monkeypatch.setattr(inputs, "_KEPT", 0)
    fresh = run(signal, **options)
    for each in kept:
        assert np.array_equal(each.time, fresh.time)
        assert np.array_equal(each["sprung_acceleration"], fresh["sprung_acceleration"])


def test_other_signals_have_other_tables():
    one, other = (it.multisine(ROAD, seed=seed) for seed in (1, 2))
    assert not np.array_equal(run(one)["sprung_acceleration"], run(other)["sprung_acceleration"])
    assert np.array_equal(run(one)["sprung_acceleration"], run(it.multisine(ROAD, seed=1))["sprung_acceleration"])


def test_a_run_goes_on_from_the_end_of_another():
    signal = it.multisine(ROAD, seed=4)
    first = run(signal, duration=1.0)
    joined, whole = run(signal, duration=1.0, initial=first), run(signal)
    np.testing.assert_allclose(joined["sprung_velocity"][-1], whole["sprung_velocity"][-1], rtol=1e-9)


def test_writing_to_a_result_changes_no_other():
    signal = it.multisine(ROAD, seed=5)
    first = run(signal)
    expected = first.time.copy()
    np.asarray(first.time)[...] = 0.0
    assert np.array_equal(run(signal).time, expected)


def test_the_table_of_a_half_car_of_ten_seconds_is_kept():
    signal = it.multisine(ROAD, seed=6)
    given = ((signal, signal, None, None), (0.0, 0.08, 0.0, 0.0), 10.0, 2e-4)
    assert inputs.tabulate_once(*given) is inputs.tabulate_once(*given)
