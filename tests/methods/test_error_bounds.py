"""Every estimate carries a bound of its error, and what is made of estimates carries theirs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from wang_su import ROAD, paper_quarter_car

import inerter as it
from inerter.errors import ErrorSource, StatusKind
from inerter.indices.excitation import RoadVelocity
from inerter.methods import steady_squares
from inerter.methods.error_bounds import of_weighted_sum, of_worst, with_error_sources
from inerter.uncertainty.distributions import scatter_of

COMFORT = it.RideComfort(ROAD)
USUAL = it.Spring(120e3) | it.Damper(4981)


def car(strut=USUAL):
    return paper_quarter_car(strut)


def off_by(value, **bounds):
    sources = tuple(ErrorSource(name, bound) for name, bound in bounds.items())
    return it.Estimate(value, "m", error_sources=sources)


@pytest.mark.parametrize("index", [COMFORT, it.TyreLoad(ROAD), it.LoadCarrying()])
@pytest.mark.parametrize("method", [it.Norm(), it.StatisticalLinearisation(), it.ExpectedValue()])
def test_a_linear_design_is_known_to_rounding(index, method):
    found = it.evaluate(car(), index, method)
    assert found.status.ok
    assert [source.name for source in found.error_sources] == ["rounding"]
    assert 0.0 < found.error_bound <= 1e-9


def test_an_estimate_that_names_no_source_has_no_bound():
    assert math.isnan(it.Estimate(1.0, "m").error_bound)


def test_an_infinite_value_is_so_exactly():
    found = it.evaluate(car(it.Spring(120e3)), it.LoadCarrying(), it.Norm())
    assert math.isinf(found.value)
    assert found.error_bound == 0.0


def test_a_bound_beyond_the_promise_is_said_with_its_number():
    found = with_error_sources(
        it.Estimate(2.0, "m"), [ErrorSource("rounding", 1e-10), ErrorSource("period", 0.02)], 0.01
    )
    assert found.status.kind is StatusKind.INACCURATE
    assert "relative error up to 0.02, more than 0.01" in found.status.message
    assert "period" in found.status.message
    assert with_error_sources(it.Estimate(2.0, "m"), [ErrorSource("rounding", 1e-10)], 0.01).status.ok


def test_a_sum_is_off_by_the_sum_of_what_its_parts_are_off_by():
    parts = [off_by(2.0, rounding=1e-3, line=0.02), off_by(8.0, rounding=2e-3)]
    (rounding, line) = of_weighted_sum(parts, [0.5, 0.25])
    assert rounding.bound == pytest.approx((1.0 * 1e-3 + 2.0 * 2e-3) / 3.0)
    assert line.bound == pytest.approx(0.02 / 3.0)
    assert of_weighted_sum([*parts, it.Estimate(1.0, "m")], [1.0, 1.0, 1.0]) == ()


def test_the_largest_is_off_by_what_any_part_may_exceed_it():
    parts = [off_by(2.0, rounding=0.2), off_by(3.0, line=0.1)]
    (source,) = of_worst(parts, 3.0)
    assert source == ErrorSource("rounding", pytest.approx(0.4 / 3.0))


@pytest.mark.parametrize("taken", ["mean", "worst"])
def test_an_index_over_conditions_carries_the_bounds(taken):
    use = it.Conditions([it.Condition(0.3, road={"speed": 15.0}), it.Condition(0.7, road={"speed": 30.0})])
    found = it.evaluate(car(), getattr(use, taken)(COMFORT), it.Norm())
    assert 0.0 < found.error_bound <= 1e-9


@dataclass(frozen=True)
class Approximate:
    """A road that something stands in for."""

    of: it.Road
    is_random = True
    amplitude_density = property(lambda self: self.of.velocity_intensity)
    unit = "m/s"

    def excited_mechanism(self, mechanism):
        return mechanism

    def input_paths(self, mechanism):
        return RoadVelocity(self.of).input_paths(mechanism)

    def error_sources(self, mechanism):
        return (ErrorSource("line", 2e-3),)


def test_what_stands_in_for_an_excitation_is_among_the_sources():
    asked = replace(COMFORT, road=Approximate(ROAD))
    exact = it.evaluate(car(), COMFORT, it.Norm())
    found = it.evaluate(car(), asked, it.Norm())
    assert found.status.ok
    assert found.value == exact.value
    assert found.error_bound == pytest.approx(2e-3 + exact.error_bound)
    shaped = it.FilteredExcitation(Approximate(ROAD), it.Filter([1.0], [1.0, 1.0]))
    assert it.evaluate(car(), replace(COMFORT, road=shaped), it.Norm()).error_bound > 2e-3


def test_static_stiffness_and_quantiles_have_bounds():
    assert it.evaluate(car(), it.static_stiffness("strut"), it.Norm()).error_bound <= 1e-9
    over = it.Quantile(COMFORT, scatter_of({"c": 0.1}, "uniform"), 0.9, samples=64)
    assert 0.0 < it.evaluate(car(), over, it.Norm()).error_bound <= 1e-9


@pytest.mark.parametrize("force", [5.0, 40.0])
def test_the_jump_of_an_acceleration_where_friction_turns_is_twice_its_force_over_the_mass(force, monkeypatch):
    """Also where slip was met one way only, beside stick: it could go as far the other way."""
    met = []
    monkeypatch.setattr(steady_squares, "missed_by_samples", lambda *given: met.append(given[:2]) or given[2] * 0.0)
    rubbing = car(it.Spring(30e3) | it.Damper(800) | it.Friction(force))
    it.evaluate(rubbing, COMFORT, it.ExpectedValue(realisations=2, jobs=1))
    (integration, outputs), *_ = met
    assert outputs[0] == "sprung_acceleration"
    expected = [[2.0 * force / 181.75]]
    maps, states = integration.modes.maps[: integration.count], integration.modes.state[: integration.count]
    assert {state.item() for state in states} == {-1, 0, 1}
    ways = {"both": states[:, 0] > -2, "up": states[:, 0] >= 0, "down": states[:, 0] <= 0}
    for kept in ways.values():
        modes = SimpleNamespace(maps=maps[kept], state=states[kept])
        some = SimpleNamespace(
            system=integration.system,
            count=int(kept.sum()),
            modes=modes,
            projected_state=integration.projected_state,
            eta=integration.eta,
        )
        np.testing.assert_allclose(steady_squares.jump_sizes(some, outputs[:1]), expected, rtol=1e-9)
