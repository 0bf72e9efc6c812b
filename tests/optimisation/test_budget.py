"""Break-even values against direct scans and roots of plain evaluations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
import scipy.stats
from campaigns import sampled
from wang_su import J1, J3, paper_half_car, paper_quarter_car

import inerter as it
from inerter import Damper, ExpectedValue, Friction, Gap, Inerter, Norm, RideComfort, Road, Spring, break_even
from inerter import StatisticalLinearisation as Linearisation
from inerter.errors import OK, DesignError, PerformanceIndexError, StatusKind
from inerter.optimisation import budget
from inerter.optimisation.budget import Crossing, is_within_range, with_element

shaft = Spring(1e6, "ks") | Damper(3200.0, "cs")


def conventional(stiffness=120e3, damping=4674.8):
    return paper_quarter_car(Spring(stiffness, "k") | Damper(damping, "c"))


def series(stiffness=120e3, friction=0.0, damping=6666.4):
    screw = shaft - (Inerter(363.55, "b") | Friction(friction, "f"))
    return paper_quarter_car(Spring(stiffness, "k") | Damper(damping, "c") - screw)


def value(car, index, method):
    return it.evaluate(car, index, method).value


def test_two_stiffness_curves_cross_where_their_values_are_equal():
    def difference(stiffness):
        return value(series(stiffness), J1, Norm()) - value(conventional(stiffness), J1, Norm())

    scan = np.geomspace(1e4, 3e5, 100)
    signs = np.sign([difference(s) for s in scan])
    at = np.flatnonzero(np.diff(signs))
    roots = [scipy.optimize.brentq(difference, scan[i], scan[i + 1]) for i in at]
    assert len(roots) == 1
    found = break_even(series(), conventional(), J1, parameter="k", method=Norm(), bounds=(1e4, 3e5))
    assert [c.value for c in found.crossings] == pytest.approx(roots, rel=1e-9)
    assert found.value == found.crossings[0].value
    assert found.crossings[0].better == "above"
    assert (found.unit, found.parameter, found.bounds) == ("N/m", "k", (1e4, 3e5))
    assert (found.standard_error, found.interval) == (0.0, (found.value, found.value))
    assert found.status.ok


@pytest.mark.parametrize("beyond", [1.02, 1.2, 1.6])
@pytest.mark.parametrize("present", sampled([700.0, 1500.0, 4000.0, 9000.0], [1500.0], kept=2))
def test_a_range_between_two_points_of_the_grid_is_found(present, beyond):
    """The baseline has the same damper with a little more than the best damping: its own is one end of the range."""

    def comfort(damping):
        return value(conventional(damping=damping), J1, Norm())

    best = scipy.optimize.minimize_scalar(comfort, bounds=(2e3, 2e4), method="bounded").x
    baseline = paper_quarter_car(Spring(120e3, "k") | Damper(beyond * best, "other"))
    found = break_even(conventional(damping=present), baseline, J1, parameter="c", method=Norm())
    other = scipy.optimize.brentq(lambda c: comfort(c) - comfort(beyond * best), 0.1 * best, best)
    assert [c.value for c in found.crossings] == pytest.approx([other, beyond * best], rel=1e-7)
    assert [r.better for r in found.ranges] == [False, True, False]


@pytest.mark.parametrize("inertance", sampled([5.0, 9.0, 16.0, 30.0, 50.0], [9.0, 30.0], kept=2))
def test_no_range_holds_a_value_at_which_an_undamped_motion_is_excited(inertance):
    """Inerter and spring in series hold the strut rigid at the frequency at which the car bounces on its tyre."""
    strut = Spring(120e3, "k") | Damper(4674.8, "c") | Inerter(inertance, "b") - Spring(1e4, "held")
    held = inertance * 120e3 / (181.75 + 25.0)
    found = break_even(paper_quarter_car(strut), conventional(damping=1e5), J1, parameter="held", method=Norm())
    assert not any(r.better for r in found.ranges if r.lower <= held <= r.upper)
    around = [held * factor for factor in (0.5, 2.0)]
    assert all(r.better for r in found.ranges for at in around if r.lower <= at <= r.upper)


@pytest.mark.campaign
def test_a_damper_of_the_design_alone_has_a_range():
    """Better between two dampings: the smallest that beats the baseline is the budget, and both are crossings."""
    found = break_even(series(), conventional(), J3, parameter="c", method=Norm(), bounds=(500.0, 1e5))
    scan = np.geomspace(500.0, 1e5, 300)
    better = [value(series(damping=c), J3, Norm()) < value(conventional(damping=c), J3, Norm()) for c in scan]
    edges = scan[1:][np.diff(better)]
    assert [c.value for c in found.crossings] == pytest.approx(edges, rel=0.02)
    alone = paper_quarter_car(Spring(120e3) | Damper(4674.8, "c0"))
    found = break_even(series(), alone, J3, parameter="c", method=Norm(), bounds=(500.0, 1e5))
    level = value(alone, J3, Norm())
    sides = [c.better for c in found.crossings]
    assert sides == ["above", "below"]
    for crossing in found.crossings:
        assert value(series(damping=crossing.value), J3, Norm()) == pytest.approx(level, rel=1e-6)
    assert found.value == found.crossings[0].value


def test_friction_budget_by_a_root_and_larger_for_a_worse_baseline():
    budgets = []
    for damping in (4674.8, 5600.0, 6500.0):
        level = value(conventional(damping=damping), J3, Norm())
        root = scipy.optimize.brentq(lambda f, y=level: value(series(friction=f), J3, Linearisation()) - y, 1.0, 1.5e3)
        found = break_even(series(), conventional(damping=damping), J3, parameter="friction", method=Linearisation())
        assert found.value == pytest.approx(root, rel=3e-5)
        assert found.bounds == (0.1, 1e4)
        assert found.unit == "N"
        assert found.crossings[0].better == "below"
        budgets.append(found.value)
    assert budgets == sorted(budgets)


def test_an_element_that_is_called_as_a_kind_is_no_other_one():
    """A label of the design is a label in the baseline too, and a kind is all of the kind there."""

    def found(parameter, label, size, others):
        design = paper_quarter_car(Spring(20e3) | Damper(1500.0) | Inerter(10.0) | Friction(size, label))
        baseline = Spring(20e3) | Damper(1500.0)
        for name, other in others.items():
            baseline |= Friction(other, name)
        return break_even(design, paper_quarter_car(baseline), J3, parameter=parameter, method=Linearisation())

    alone = found("own", "own", 0.0, {"f": 300.0})
    assert 200.0 < alone.value < 400.0
    assert found("friction", "friction", 0.0, {"f": 300.0}).value == alone.value
    several = found("friction", "own", 50.0, {"first": 200.0, "second": 100.0})
    assert found("friction", "own", 50.0, {"friction": 200.0, "second": 100.0}).ranges == several.ranges


def with_inertance(friction, damping=3000.0):
    return paper_quarter_car(Spring(40e3) | Damper(damping) | Inerter(20.0) | Friction(friction, "f"))


def with_the_value_of(friction, index):
    """A conventional car that has the value of `with_inertance(friction)` by statistical linearisation."""
    level = value(with_inertance(friction), index, Linearisation())
    damping = scipy.optimize.brentq(lambda c: value(conventional(40e3, c), index, Norm()) - level, 2e3, 2e4)
    return conventional(40e3, damping)


@pytest.mark.parametrize(("friction", "index"), [(20.0, J3), (60.0, J1), (100.0, J3)])
def test_a_break_even_value_is_as_uncertain_as_the_values_that_are_equal_there(friction, index):
    """At the ends of what its bound allows the values differ by as much as they may be off."""
    baseline = with_the_value_of(friction, index)
    wanted = {"parameter": "f", "method": Linearisation(), "bounds": (friction / 3.0, friction * 3.0)}
    found = break_even(with_inertance(0.0), baseline, index, **wanted)
    assert found.value == pytest.approx(friction, rel=1e-4)
    here = it.evaluate(with_inertance(friction), index, Linearisation())
    off = here.error_bound * here.value
    far = value(with_inertance(friction * (1.0 + found.error_bound)), index, Linearisation())
    near = value(with_inertance(friction / (1.0 + found.error_bound)), index, Linearisation())
    assert here.status.ok
    assert 0.5 * (far - near) == pytest.approx(off, rel=0.15)
    assert found.error_bound == found.crossings[0].error_bound
    if found.error_bound > 0.1:
        assert found.status.kind is StatusKind.INACCURATE
        assert "break-even value with a relative error of up to" in found.status.message
    else:
        assert found.status.ok


def test_a_break_even_value_with_an_enormous_error_has_no_number_for_it():
    here = it.compare(with_inertance(20.0), conventional(40e3, 3e3), J1, Linearisation())
    few, many = (budget._within_promise(bound, here, "f").message for bound in (0.5, 8.2e11))
    assert "with a relative error of up to 50 %, more than 10 %" in few
    assert "uncertain by more than a factor of 10: the values" in many
    assert "e+" not in many


@pytest.mark.campaign
@pytest.mark.parametrize(("friction", "index"), sampled([(20.0, J3), (60.0, J1), (100.0, J3)], kept=1))
def test_break_even_friction_is_within_its_bound_of_that_of_simulations(friction, index):
    """At 100 N the frictions are 7 % apart, where the values are within 1 %."""
    baseline = with_the_value_of(friction, index)
    wanted = {"parameter": "f", "bounds": (friction / 3.0, friction * 3.0)}
    found = break_even(with_inertance(0.0), baseline, index, method=Linearisation(), **wanted)
    true = break_even(with_inertance(0.0), baseline, index, method=ExpectedValue(realisations=8, seed=2), **wanted)
    apart = abs(found.value / true.value - 1.0)
    assert apart < found.error_bound + true.error_bound + 4.0 * true.standard_error / true.value


def test_the_bound_of_a_break_even_value_of_exact_values_is_of_rounding():
    found = break_even(series(), conventional(), J1, parameter="k", method=Norm(), bounds=(1e4, 3e5))
    assert found.error_bound < 1e-7


class Boundless(Norm):
    """A method whose values have no error bound."""

    def estimate(self, vehicle, index):
        return replace(super().estimate(vehicle, index), error_sources=())


def test_a_break_even_value_without_an_error_bound_is_not_ok():
    found = break_even(series(), conventional(), J1, parameter="k", method=Boundless(), bounds=(1e4, 3e5))
    assert math.isnan(found.error_bound)
    assert found.status.kind is StatusKind.INACCURATE
    assert "no error bound" in found.status.message


@pytest.mark.marathon
def test_a_friction_budget_of_simulated_values_is_where_the_difference_vanishes():
    method = ExpectedValue(realisations=3, seed=2)
    found = break_even(series(), conventional(), J3, parameter="f", method=method, bounds=(200.0, 2000.0))
    assert found.status.ok
    here = it.compare(series(friction=found.value), conventional(), J3, method)
    assert abs(here.difference.value) < 0.02 * here.difference.standard_error
    sides = [
        it.compare(series(friction=found.value * r), conventional(), J3, method).difference.value for r in (0.9, 1.1)
    ]
    assert sides[0] < 0.0 < sides[1]
    slope = (sides[1] - sides[0]) / (0.2 * found.value)
    assert found.standard_error == pytest.approx(here.difference.standard_error / slope, rel=0.1)
    reach = scipy.stats.t.ppf(0.975, 2) * found.standard_error / found.value
    expected = (found.value * math.exp(-reach), found.value * math.exp(reach))
    assert found.interval == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("lower", "upper"), sampled([(1.0, 2.0), (400.0, 1000.0)], kept=1))
def test_an_adaptive_method_keeps_its_roads_throughout(lower, upper):
    method, fixed = ExpectedValue(relative_error=0.02, seed=2), ExpectedValue(realisations=8, seed=2)
    wanted = {"parameter": "f", "bounds": (lower, upper)}
    found, expected = (break_even(series(), conventional(), J3, method=m, **wanted) for m in (method, fixed))
    assert found == expected


def test_further_roads_are_asked_for_near_the_crossing_only_and_change_no_digit(monkeypatch):
    method, controls, asked = ExpectedValue(realisations=4, seed=2), ExpectedValue.controls, []

    def counted(self, vehicle, index, count):
        asked.append(vehicle)
        return controls(self, vehicle, index, count)

    monkeypatch.setattr(ExpectedValue, "controls", counted)
    wanted = {"parameter": "f", "method": method, "bounds": (300.0, 3000.0)}
    found = break_even(series(), conventional(), J3, **wanted)
    assert 0 < len(asked) < 2 * (found.evaluations - 6)
    monkeypatch.setattr(budget, "_CERTAIN", math.inf)
    assert break_even(series(), conventional(), J3, **wanted) == found
    assert len(asked) > 2 * found.evaluations


def test_a_gap_budget():
    def backlash(width):
        inner = shaft - Gap(width, "play") - (Inerter(363.55) | Friction(10.0))
        return paper_quarter_car(Spring(120e3, "k") | Damper(6666.4) - inner)

    method = ExpectedValue(realisations=2, seed=2, conventions="paper2008")
    found = break_even(backlash(0.0), conventional(), J3, parameter="gap", method=method, bounds=(1e-4, 2e-2))
    assert found.status.ok
    assert found.unit == "m"
    inside, outside = (it.compare(backlash(found.value * r), conventional(), J3, method) for r in (0.95, 1.05))
    assert inside.difference.value < 0.0 < outside.difference.value


def test_better_or_worse_throughout_is_said():
    best, worst = conventional(damping=4674.8), conventional(damping=100.0)
    always = break_even(series(), worst, J3, parameter="friction", method=Linearisation(), bounds=(1.0, 100.0))
    assert always.status.kind is StatusKind.UNBOUNDED
    assert always.status.message == "the design is better for every friction from 1 to 100 N"
    never = break_even(series(), best, J3, parameter="friction", method=Linearisation(), bounds=(2e3, 1e4))
    assert never.status.kind is StatusKind.UNBOUNDED
    assert never.status.message == "the design is better for no friction from 2 to 10 kN"
    for found in (always, never):
        assert found.crossings == ()
        assert np.isnan([found.value, found.standard_error, *found.interval]).all()
    poor = paper_quarter_car(Spring(120e3) | Damper(1000.0) | Friction(0.0))
    only = break_even(
        poor, conventional(damping=1500.0), J3, parameter="friction", method=Linearisation(), bounds=(1.0, 500.0)
    )
    assert [c.better for c in only.crossings] == ["above"]
    assert only.status.kind is StatusKind.INACCURATE  # at 300 N and more friction sticks for a part of the time
    assert [r.better for r in only.ranges] == [False, True]
    assert only.ranges[1].lower == only.crossings[0].value
    assert " to 500 N only, of all friction from 1 to 500 N" in only.status.message


def test_equal_at_a_bound_is_a_crossing_too():
    at_bound = float(np.exp(np.log(8000.0)))
    alone = paper_quarter_car(Spring(120e3) | Damper(at_bound, "c0"))
    found = break_even(conventional(), alone, J3, parameter="c", method=Norm(), bounds=(5000.0, 8000.0))
    assert [c.value for c in found.crossings] == pytest.approx([8000.0], rel=1e-5)


def test_values_that_cannot_be_had_are_not_taken_for_worse():
    """A damper on next to no inertance is too stiff to simulate; what lies there stays unknown, and is said to be."""
    method = ExpectedValue(realisations=2)
    base = Spring(120e3) | Damper(4e3)
    design = paper_quarter_car(base | Damper(1e5) - (Inerter(100.0, "b") | Friction(10.0)))
    found = break_even(design, paper_quarter_car(base), J3, parameter="b", method=method, bounds=(1e-4, 2e-4))
    assert found.status.kind is StatusKind.FAILED
    assert "faster than the step" in found.status.message


def half_car(friction=0.0):
    front = Spring(120e3, "k") | Damper(4e3) - shaft - (Inerter(300.0) | Friction(friction, "f"))
    rear = Spring(100e3, "k") | Damper(3e3) - shaft - (Inerter(250.0) | Friction(2.0 * friction))
    return paper_half_car(front, rear)


def test_both_struts_of_a_half_car_change():
    base = paper_half_car(Spring(120e3) | Damper(3.5e3), Spring(100e3) | Damper(3e3))

    def same(f):
        front = Spring(120e3) | Damper(4e3) - shaft - (Inerter(300.0) | Friction(f))
        rear = Spring(100e3) | Damper(3e3) - shaft - (Inerter(250.0) | Friction(f))
        return value(paper_half_car(front, rear), J3, Linearisation())

    found = break_even(half_car(), base, J3, parameter="friction", method=Linearisation())
    root = scipy.optimize.brentq(lambda f: same(f) - value(base, J3, Norm()), 1.0, 1e4)
    assert found.value == pytest.approx(root, rel=3e-5)
    changed = with_element(half_car(), "k", 5e4)
    assert [next(iter(s.network.elements())).value for s in changed.mechanism().struts] == [5e4, 5e4]
    assert [t.network.value for t in changed.mechanism().tyres] == [120e3, 100e3]  # tyres keep theirs


@pytest.mark.parametrize("seed", range(4))
def test_what_is_in_a_tyre_has_a_budget(seed):
    """Of two vehicles that differ in the tyre alone, the softer one is the more comfortable: they cross where it is
    as stiff, beside another damper in the tyre or not."""
    random = np.random.default_rng(seed)
    body, wheel, stiffness = (float(x) for x in random.uniform((150, 20, 80e3), (400, 60, 300e3)))

    def car(tyre):
        return it.Mechanism(
            coordinates=(it.Coordinate("body", body), it.Coordinate("wheel", wheel)),
            struts=(
                it.Strut("strut", Spring(30e3, "k") | Damper(2e3, "c"), upper={"body": 1.0}, lower={"wheel": 1.0}),
            ),
            tyres=(it.Tyre("tyre", tyre, port={"wheel": 1.0}, road="road"),),
            roads=(it.RoadInput("road"),),
            measures=it.PerformanceOutputs(comfort=(it.OutputWeight("body_acceleration", 1.0),)),
        )

    more = Damper(10.0, "hysteresis") - Spring(1e5, "more")
    for design, plain in (
        (Spring(1.3 * stiffness, "kt"), Spring(stiffness)),
        (Spring(1e5, "kt") | more, Spring(stiffness) | more),
    ):
        found = break_even(
            car(design), car(plain), J1, parameter="kt", method=Norm(), bounds=(stiffness / 3, 3 * stiffness)
        )
        assert [c.value for c in found.crossings] == pytest.approx([stiffness], rel=3e-5)


def test_bounds_by_default_lie_about_the_present_value():
    found = break_even(series(friction=10.0), conventional(), J3, parameter="f", method=Linearisation())
    assert found.bounds == pytest.approx((0.01, 1e4))
    assert found.evaluations > 16


@pytest.mark.parametrize("kept", [1 / 1100, 1 / 900, 900, 1100])
def test_a_stiffness_is_looked_for_up_to_a_thousand_times_its_value(kept):
    """J1^2 goes as c kt / m^2 + k^2 (m + mu) / (c m^2): of two dampings alike at k = sqrt(kt c c' / (m + mu))."""
    expected = math.sqrt(120e3 * 3e3 * 5e3 / 206.75)
    present = expected / kept
    design, baseline = conventional(present, 5e3), conventional(present, 3e3)
    found = break_even(design, baseline, J1, parameter="k", method=Norm())
    if 1e-3 < kept < 1e3:
        assert found.value == pytest.approx(expected, rel=3e-5)
    else:
        assert found.status.message.startswith(f"the design is better for {'every' if kept < 1.0 else 'no'} k from ")


@pytest.mark.parametrize("expected", sampled([0.09, 0.11, 9e3, 11e3], [0.09, 9e3]))
def test_a_friction_that_is_not_there_yet_is_looked_for_between_a_tenth_of_a_newton_and_ten_kilonewtons(expected):
    """All power that enters, kt S / 2 for a road velocity of density S, leaves by the damping; friction adds to it."""
    damping, more = 6e3, 300.0
    density = 2.0 * damping / 120e3 * (expected / more) ** 2 * 2.0 / math.pi
    index = RideComfort(Road(roughness=density / (4.0 * math.pi**2 * 25.0), speed=25.0))
    design = paper_quarter_car(Spring(80e3) | Damper(damping - more) | Friction(0.0))
    baseline = paper_quarter_car(Spring(80e3) | Damper(damping))
    found = break_even(design, baseline, index, parameter="friction", method=Linearisation())
    if 0.1 < expected < 1e4:
        assert found.value == pytest.approx(expected, rel=3e-5)
    else:
        word = "no" if expected < 1.0 else "every"
        assert found.status.message.endswith(f"the design is better for {word} friction from 0.1 N to 10 kN")
        assert [r.better for r in found.ranges] == [expected > 1.0]


def test_a_play_that_is_not_there_yet_is_looked_for_between_a_micrometre_and_a_centimetre():
    """The norm closes gaps, so that one is as good as another."""
    design = paper_quarter_car(Spring(120e3) | Damper(6666.4) - shaft - Gap(0.0) - Inerter(363.55))
    found = break_even(design, conventional(), J3, parameter="gap", method=Norm())
    assert found.status.message == "the design is better for every gap from 1 um to 10 mm"
    assert found.bounds == (1e-6, 1e-2)


WRONG = {
    "no such name": (
        lambda: break_even(series(), conventional(), J3, parameter="q", method=Norm()),
        "unknown element 'q'",
    ),
    "no gap there": (lambda: break_even(series(), conventional(), J3, parameter="gap", method=Norm()), "Gap(0.0)"),
    "two kinds": (
        lambda: break_even(
            paper_quarter_car(Spring(1e5, "x") | Damper(1e3, "x")), conventional(), J3, parameter="x", method=Norm()
        ),
        "different kinds",
    ),
    "reversed bounds": (
        lambda: break_even(series(), conventional(), J3, parameter="k", method=Norm(), bounds=(2.0, 1.0)),
        "positive and in order",
    ),
    "a bound of zero": (
        lambda: break_even(series(), conventional(), J3, parameter="f", method=Norm(), bounds=(0.0, 1.0)),
        "positive and in order",
    ),
    "bounds of text": (
        lambda: break_even(series(), conventional(), J3, parameter="k", method=Norm(), bounds="12"),
        "two numbers in SI units",
    ),
    "one bound": (
        lambda: break_even(series(), conventional(), J3, parameter="k", method=Norm(), bounds=5.0),
        "two numbers in SI units",
    ),
    "an endless bound": (
        lambda: break_even(series(), conventional(), J3, parameter="k", method=Norm(), bounds=(1.0, math.inf)),
        "two numbers in SI units",
    ),
    "a free value": (
        lambda: break_even(
            paper_quarter_car(Spring(it.free(1e4, 1e5, "k"), "k") | Damper(1e3)),
            conventional(), J3, parameter="k", method=Norm(),
        ),
        "is free. Fix it",
    ),
    "a value of a condition": (
        lambda: break_even(
            series(), conventional(), it.Conditions([it.Condition(vehicle={"k": 9e4})]).mean(J3),
            parameter="k", method=Norm(),
        ),
        "A condition changes 'k'",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_wrong_requests_are_one_clear_error(case):
    request, words = WRONG[case]
    with pytest.raises(DesignError) as refusal:
        request()
    assert words in str(refusal.value)


def test_a_method_that_is_none():
    with pytest.raises(PerformanceIndexError, match="Expected a method"):
        break_even(series(), conventional(), J3, parameter="k", method="norm")


def test_a_budget_over_conditions_of_a_seat_is_that_of_the_laden_vehicles():
    def seated(strut, sprung_mass, occupant):
        car = it.QuarterCar(sprung_mass=sprung_mass, unsprung_mass=40.0, tyre_stiffness=2e5, strut=strut)
        return it.Seat(car, mass=occupant, network=it.Spring(12e3) | it.Damper(400.0, name="cs"))

    spring, damper = it.Spring(22e3), it.Damper(1500.0)
    struts = spring | damper - it.Inerter(50.0) | it.Friction(10.0, name="f"), spring | damper
    comfort = J1
    laden = it.Conditions([it.Condition(1.0, vehicle={"sprung_mass": 300.0, "mass": 100.0})])
    asked = {"parameter": "f", "method": it.StatisticalLinearisation(), "bounds": (1.0, 500.0)}
    over = it.break_even(*(seated(strut, 320.0, 70.0) for strut in struts), laden.mean(comfort), **asked)
    alone = it.break_even(*(seated(strut, 300.0, 100.0) for strut in struts), comfort, **asked)
    assert np.isfinite(over.value)
    assert over.value == pytest.approx(alone.value, rel=1e-6)


@pytest.mark.parametrize("seed", sampled(range(6), [0, 1], kept=2))
def test_a_budget_is_no_better_than_what_it_rests_on(seed):
    """Random cars by a method that is inaccurate where friction sticks, looked at between the points of its grid."""
    rng = np.random.default_rng([seed, 31])
    strut = Spring(rng.uniform(8e3, 1e5)) | Damper(10.0 ** rng.uniform(2.0, 4.0))
    car = it.QuarterCar(
        rng.uniform(80.0, 400.0), rng.uniform(10.0, 50.0), rng.uniform(8e4, 3e5), strut | Friction(30.0)
    )
    other = it.QuarterCar(
        car.sprung_mass, car.unsprung_mass, car.tyre_stiffness, Spring(2e4) | Damper(10.0 ** rng.uniform(2.0, 4.0))
    )
    found = break_even(car, other, J1, parameter="friction", method=Linearisation())
    end = found.value if np.isfinite(found.value) else found.bounds[1]
    inside = np.geomspace(found.bounds[0], end, 12)
    statuses = [it.evaluate(with_element(car, "friction", f), J1, Linearisation()).status for f in inside]
    if not all(status.ok for status in statuses[1:-1]):
        assert found.status.kind is StatusKind.INACCURATE
        assert "expected-value" in found.status.message
    if found.status.ok:
        assert all(status.ok for status in statuses)
    assert np.isnan(found.standard_error)
    assert found.ranges[0].lower == found.bounds[0]
    assert found.ranges[-1].upper == found.bounds[1]


@pytest.mark.parametrize("value", [1e-6, 3.0, 4e4])
def test_a_range_rests_on_its_own_points_and_on_the_next_beyond_its_end(value):
    step = 0.5
    for better, sign in (("below", 1.0), ("above", -1.0)):
        end = Crossing(value, 0.0, (value, value), better, OK)
        for steps, rests in ((-9.0, True), (-0.9, True), (0.9, True), (1.1, False), (9.0, False)):
            assert is_within_range(math.log(value) + sign * steps * step, end, step) is rests


def test_a_baseline_in_which_the_name_is_ambiguous_is_refused():
    """It was left as it is, as if it had no such element."""
    baseline = paper_quarter_car(Spring(100e3) | Damper(5e3) - Spring(3e5))
    with pytest.raises(DesignError, match="'k' is ambiguous: "):
        break_even(conventional(), baseline, J1, parameter="k", method=Norm())


def truck(strut: it.Network) -> it.QuarterCar:
    return it.QuarterCar(sprung_mass=4500.0, unsprung_mass=450.0, tyre_stiffness=2e6, strut=strut)


TRUCK = truck(Spring(400e3) | Damper(20e3))
IN_SERIES = truck(Spring(400e3) | Damper(18e3) - (Inerter(2000.0) | Friction(200.0)))
DAMPED = truck(Spring(400e3) | (Inerter(2000.0) | Friction(200.0)) - (Spring(142e3) | Damper(12.7e3)))


def test_worse_at_every_value_is_certain_where_no_error_can_change_it():
    """Values that are inaccurate at some frictions, but worse by more than their errors; simulation agrees there."""
    found = break_even(DAMPED, TRUCK, J3, parameter="friction", method=Linearisation())
    assert found.status.kind is StatusKind.UNBOUNDED
    assert "better for no friction" in found.status.message
    for friction in (200.0, 5e3):
        design = budget.with_element(DAMPED, "friction", friction)
        assert it.compare(design, TRUCK, J3, ExpectedValue(realisations=4)).relative.interval[0] > 0.0


def test_values_that_differ_by_less_than_their_errors_leave_it_open():
    found = break_even(IN_SERIES, TRUCK, J1, parameter="friction", method=Linearisation())
    assert found.status.kind is StatusKind.INACCURATE
    assert "more than they differ at some values of friction. By these values the design is better" in str(found.status)
