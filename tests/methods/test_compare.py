"""Differences of designs on the same roads: honest, sharper than two estimates apart, and right where nothing pairs."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import scipy.stats
from campaigns import sampled
from filtered import Weighed, iso_2631_wk
from wang_su import J1, J3, ROAD, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, ExpectedValue, Friction, Gap, Inerter, Norm, Spring, TyreLoad
from inerter.errors import OK, Status, StatusKind
from inerter.methods.averages import CONFIDENCE, NORMAL_QUANTILE, mean_and_error
from inerter.methods.compare import Comparison, Difference, compare_estimates, difference_of
from inerter.methods.linear import CONVENTIONS, with_convention_filters
from inerter.methods.method import Estimate
from inerter.methods.perturbation import first_order, sides_of
from inerter.methods.realisations import random_excitation, realisation_seeds, run
from inerter.systems.piecewise import piecewise

k, shaft = Spring(120e3), Spring(1e6) | Damper(3200.0)
ROADS = 5


def parallel(friction):
    return paper_quarter_car(k | Damper(3705.4) | (Inerter(128.57) | Friction(friction)))


def series(friction):
    return paper_quarter_car(k | Damper(7544.2) - (Inerter(366.52) | Friction(friction)))


def light(friction):
    return paper_quarter_car(k | Damper(1500.0) | (Inerter(128.57) | Friction(friction)))


def elastic(friction):
    return paper_quarter_car(k | Damper(7353.0) - shaft - (Inerter(328.72) | Friction(friction)))


def half_car(friction):
    front = k | Damper(4e3) - (Inerter(300.0) | Friction(friction))
    return paper_half_car(front, Spring(100e3) | Damper(3e3) | (Inerter(50.0) | Friction(0.5 * friction)))


HELD = ExpectedValue(realisations=ROADS, seed=11, conventions="paper2008")  # quick, and its scatter is the same


@pytest.fixture(scope="module", params=sampled([100, 200], seldom=[200]))
def pools(request):
    """J1 and J3 of S2 and S3 with 100 N on 500 roads, (designs, roads, indices), and J3's first-order changes there.

    Every road has its own seed, so groups of 5 roads are as independent as runs with other seeds are.
    """
    systems = [piecewise(parallel(100.0)), piecewise(series(100.0))]
    definition = J3.definition(systems[0].mechanism)
    excitation = random_excitation(systems[0], definition, CONVENTIONS["paper2008"])
    changes = [first_order(system, definition, excitation) for system in systems]

    def on_road(seed):
        outputs = ("sprung_acceleration", "tyre_load")
        found = [run(system, excitation, outputs, (), (seed, None)).power for system in systems]
        return np.sqrt(found), [float(change([seed])[0]) for change in changes]

    with ThreadPoolExecutor(2) as pool:
        values, known = zip(*pool.map(on_road, realisation_seeds(11, 0, request.param * ROADS)), strict=True)
    return np.array(values).transpose(1, 0, 2), np.array(known).T


def coverage(intervals, truth):
    return np.mean([low <= truth <= high for low, high in intervals])


@pytest.mark.parametrize("index", sampled([J1, J3], seldom=[J1]), ids=["J1", "J3"])
def test_intervals_cover_the_converged_value_as_often_as_they_say(pools, index):
    samples = pools[0][1, :, [J1, J3].index(index)]
    groups = samples.reshape(-1, ROADS)
    first = it.evaluate(series(100.0), index, HELD)
    assert first.samples == pytest.approx(groups[0], rel=1e-12)
    assert first.interval == pytest.approx(mean_and_error(groups[0])[2], rel=1e-9)
    assert 0.90 <= coverage([mean_and_error(group)[2] for group in groups], samples.mean()) <= 0.99


def test_intervals_of_a_difference_do_too(pools):
    """Each group adds the first-order effect on the roads of forty further groups: within a group nothing is used
    twice, so that its interval is what it would be alone; that groups share those roads hardly correlates them.
    """
    (one, other), known = pools[0][:, :, 1], pools[1]
    differences, parts_of_second = [], []
    for group in range(one.size // ROADS):
        here = np.arange(group * ROADS, (group + 1) * ROADS)
        more = np.arange(here[-1] + 1, here[-1] + 1 + 40 * ROADS) % one.size
        parts = [Estimate(s[here].mean(), "N", realisations=ROADS, samples=tuple(s[here])) for s in (one, other)]
        found = compare_estimates(*parts, [(changes[here], changes[more]) for changes in known])
        differences.append(found.difference)
        parts_of_second.append(found.relative)
    for several, truth in (
        (differences, np.mean(one - other)),
        (parts_of_second, 100.0 * (one.mean() / other.mean() - 1.0)),
    ):
        assert 0.90 <= coverage([found.interval for found in several], truth) <= 0.99
        errors = np.array([found.standard_error for found in several])
        assert math.sqrt(np.mean(errors**2)) == pytest.approx(np.std([found.value for found in several]), rel=0.15)


def test_many_roads_are_not_made_worse_by_few_more(pools):
    """The first-order effect on a few more roads would add more scatter than it takes away."""
    (one, other), known = pools[0][:, :, 1], pools[1]
    parts = [Estimate(s.mean(), "N", realisations=s.size, samples=tuple(s)) for s in (one, other)]
    assert difference_of(*parts, [(changes, changes[:10]) for changes in known]) == difference_of(*parts)


@pytest.mark.parametrize("index", [J1, J3], ids=["J1", "J3"])
def test_few_roads_suffice_to_compare(index):
    found = it.compare(parallel(10.0), series(10.0), index, ExpectedValue(realisations=8, seed=0))
    assert math.hypot(found.first.standard_error, found.second.standard_error) > 3.0 * found.difference.standard_error
    norms = [it.evaluate(car(0.0), index, Norm()).value for car in (parallel, series)]
    assert found.difference.value == pytest.approx(norms[0] - norms[1], rel=0.1)  # 10 N change little
    assert "worse than the second" in str(found)
    assert found.percent == pytest.approx(100.0 * found.difference.value / found.second.value, rel=1e-2)


def test_a_design_against_itself():
    found = it.compare(series(10.0), series(10.0), J3, ExpectedValue(realisations=3))
    assert found.difference.value == 0.0
    assert found.difference.standard_error == 0.0
    assert found.is_tie
    assert "difference not significant at 95 %" in str(found)


def test_a_tie_is_what_chance_or_rounding_may_have_made(pools):
    """Without a difference some nineteen of twenty comparisons are ties; without scatter, those within the accuracy."""
    one, other = pools[0][:, :, 1]
    even = other + (one.mean() - other.mean())  # of the same mean
    ties = []
    for begin in range(0, one.size, ROADS):
        parts = [
            Estimate(s[begin : begin + ROADS].mean(), "N", samples=tuple(s[begin : begin + ROADS])) for s in (one, even)
        ]
        ties.append(compare_estimates(*parts).is_tie)
    assert 0.90 <= np.mean(ties) <= 0.99
    for share, tie in ((1e-12, True), (1e-6, False), (-1e-6, False), (math.nan, False)):
        parts = [Estimate(value, "N") for value in (600.0, 600.0 * (1.0 + share))]
        assert compare_estimates(*parts).is_tie == tie


def test_a_linear_design_does_not_scatter_but_is_compared_road_by_road():
    """What friction does to first order is known beforehand: at 10 N less than a third of its scatter is left."""
    for first, second, sign in ((series(0.0), series(10.0), 1.0), (series(10.0), series(0.0), -1.0)):
        found = it.compare(first, second, J3, ExpectedValue(seed=1))
        error = max(found.first.standard_error, found.second.standard_error)
        assert min(found.first.standard_error, found.second.standard_error) == 0.0
        assert 0.0 < found.difference.standard_error < error / 3.0
        assert abs(found.difference.value - (found.first.value - found.second.value)) < 4.0 * error
        assert found.difference.value * sign < 0.0


@pytest.mark.parametrize("method", [Norm(), it.StatisticalLinearisation()], ids=lambda m: m.name)
def test_what_does_not_scatter_has_no_error(method):
    found = it.compare(parallel(10.0), series(10.0), J1, method)
    values = [it.evaluate(car(10.0), J1, method).value for car in (parallel, series)]
    assert found.difference.value == values[0] - values[1]
    assert found.difference.standard_error == 0.0
    assert found.difference.interval == (found.difference.value, found.difference.value)


@pytest.mark.campaign
def test_both_get_as_many_roads_as_the_one_that_needs_more():
    method = ExpectedValue(relative_error=1.3e-3, seed=3)
    alone = [it.evaluate(car, J3, method).realisations for car in (parallel(10.0), series(100.0))]
    assert alone[0] < alone[1]
    for cars in ((parallel(10.0), series(100.0)), (series(100.0), parallel(10.0))):
        found = it.compare(*cars, J3, method)
        assert found.first.realisations == found.second.realisations == alone[1]
        assert len(found.first.samples) == len(found.second.samples)


def test_with_a_gap_differences_are_taken_road_by_road():
    method = ExpectedValue(realisations=3, seed=1)
    gap = paper_quarter_car(k | Damper(7353.0) - shaft - Gap(2e-4) - (Inerter(328.72) | Friction(10.0)))
    assert method.controls(gap, J3, 3) is None
    found = it.compare(gap, elastic(10.0), J3, method)
    apart = np.array(found.first.samples) - np.array(found.second.samples)
    assert found.difference.value == pytest.approx(found.first.value - found.second.value, rel=1e-12)
    assert found.difference.value == pytest.approx(apart.mean(), rel=1e-2)  # the values are roots of mean squares
    assert found.difference.standard_error == pytest.approx(scipy.stats.sem(apart), rel=1e-9)
    assert found.difference.interval == pytest.approx(
        scipy.stats.t.interval(0.95, 2, loc=found.difference.value, scale=scipy.stats.sem(apart)), rel=1e-9
    )


@pytest.mark.campaign
def test_a_design_that_needs_longer_roads_gives_them_to_the_other():
    ringing = paper_quarter_car(k | Damper(300.0) | Friction(20.0))
    found = it.compare(ringing, series(10.0), J3, ExpectedValue(realisations=3))
    period = found.first.period
    assert period is not None
    assert found.second.period == period > 10
    alone = it.evaluate(series(10.0), J3, ExpectedValue(realisations=3, period=period))
    assert found.second == alone
    assert it.evaluate(series(10.0), J3, ExpectedValue(realisations=3)).period == 10


def test_controls_are_taken_for_what_they_explain():
    rng = np.random.default_rng(0)
    one, other = (Estimate(s.mean(), "N", realisations=10, samples=tuple(s)) for s in rng.normal(5.0, 1.0, (2, 10)))
    plain = difference_of(one, other)
    noise = [(rng.normal(0.0, 50.0, 10), rng.normal(0.0, 50.0, 400)) for _ in range(2)]
    useless = difference_of(one, other, noise)
    assert useless.standard_error == pytest.approx(plain.standard_error, rel=0.3)
    assert abs(useless.value - plain.value) < 2.0 * plain.standard_error
    assert difference_of(one, other, [noise[0], None]) == plain
    whole = [(np.array(e.samples), np.full(400, 7.0 + i)) for i, e in enumerate((one, other))]
    assert difference_of(one, other, whole).value == pytest.approx(-1.0, abs=1e-12)
    assert difference_of(one, other, whole).standard_error == pytest.approx(0.0, abs=1e-12)


def test_a_comparison_is_as_good_as_the_worse_of_its_estimates():
    bad = Status(StatusKind.INACCURATE, "so so")
    for statuses in ((OK, bad), (bad, OK)):
        one, other = (Estimate(1.0 + i, "N", s) for i, s in enumerate(statuses))
        apart = Difference(-1.0, "N", 0.1, (-1.2, -0.8)), Difference(-50.0, "%", 5.0, (-60.0, -40.0))
        found = Comparison(one, other, *apart)
        assert found.status is bad
        assert found.percent == -50.0
        assert str(found) == "not certain (inaccurate: so so): the first is 50.0 ± 5.0 % better than the second"


CASES = {
    "light J1": (light, J1, ("sprung_acceleration",), "exact"),
    "S3 J3": (series, J3, ("tyre_load",), "exact"),
    "elastic J1": (elastic, J1, ("sprung_acceleration",), "exact"),
    "half J1": (half_car, J1, ("sprung_acceleration", "pitch_acceleration"), "exact"),
    "half J3 filtered": (half_car, TyreLoad(ROAD, high_pass=20.0), ("tyre_front_load", "tyre_rear_load"), "exact"),
    "half J1 weighted": (
        half_car,
        Weighed(J1, (iso_2631_wk(), None)),
        ("sprung_acceleration", "pitch_acceleration"),
        "exact",
    ),
    "half J3 held": (half_car, J3, ("tyre_front_load", "tyre_rear_load"), "paper2008"),
}


@pytest.mark.parametrize("case", sampled(CASES, ["light J1", "half J3 filtered"]))
def test_a_small_friction_changes_each_road_as_predicted(case):
    design, index, outputs, conventions = CASES[case]
    system = piecewise(design(0.0))
    definition = with_convention_filters(CONVENTIONS[conventions], system.mechanism, index.definition(system.mechanism))
    excitation = random_excitation(system, definition, CONVENTIONS[conventions])
    weights = [abs(output.weight) for output in definition.outputs]
    for seed in realisation_seeds(0, 0, 2):
        plain = run(system, excitation, outputs, definition.filters, (seed, None))
        assert plain.status.ok
        rubbing = piecewise(design(2.0))
        found = run(rubbing, excitation, outputs, definition.filters, (seed, None)).power
        change = (np.sqrt(found) - np.sqrt(plain.power)) @ weights
        assert first_order(rubbing, definition, excitation)([seed])[0] == pytest.approx(change, rel=0.05)


@pytest.mark.parametrize("case", CASES)
def test_the_mean_change_is_that_of_a_gaussian_motion(case):
    """For a Gaussian velocity v, E[y sgn v] = sqrt(2/pi) E[y v] / sigma: statistical linearisation is exact for it."""
    design, index, _, conventions = CASES[case]
    here, more = ExpectedValue(seed=1, conventions=conventions).controls(design(1.0), index, 2)
    method = it.StatisticalLinearisation(conventions)
    expected = it.evaluate(design(1.0), index, method).value - it.evaluate(design(0.0), index, method).value
    assert np.mean(more) == pytest.approx(expected, rel=0.05)
    assert here.shape == (2,)


def test_what_a_road_does_to_the_sign_of_a_velocity_is_found_once_for_all_forces():
    weak, strong = (
        paper_quarter_car(Spring(9e4) | Damper(5e3) - (Inerter(300.0) | Friction(force))) for force in (10.0, 25.0)
    )
    first = HELD.controls(weak, J1, 8)
    found_before = sides_of.cache_info().misses
    second = HELD.controls(strong, J1, 8)
    assert sides_of.cache_info().misses == found_before
    for one, other in zip(first, second, strict=True):
        assert other == pytest.approx(2.5 * one, rel=1e-12)


def test_first_order_is_silent_where_it_knows_nothing():
    loose = paper_quarter_car(k | Damper(4e3) - shaft - Gap(1e-4) - (Inerter(300.0) | Friction(10.0)))
    assert ExpectedValue().controls(loose, J1, 2) is None
    assert ExpectedValue().controls(series(10.0), it.LoadCarrying(1000.0), 2) is None
    nothing = ExpectedValue().controls(series(0.0), J1, 2)
    assert [part.tolist() for part in nothing] == [[0.0] * 2, [0.0] * nothing[1].size]


def test_the_normal_quantile_is_that_of_the_confidence_level():
    assert scipy.stats.norm.interval(CONFIDENCE)[1] == pytest.approx(NORMAL_QUANTILE, rel=1e-15)
