"""A search on two tracks asks halves of a car: the same norms as the whole has, without rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled

import inerter as it
from inerter.methods.compiled_norm import CompiledNorm
from inerter.methods.linear import CONVENTIONS, linear_problem
from inerter.norms.exact import h2_exactly

FORMS = (it.Coherence.isotropic, lambda x: it.Coherence.first_order(0.3 * x), lambda x: it.Coherence.constant(0.6 * x))


def car(rng, **bars):
    """A full car of random values with two free ones, whose struts hold an inerter."""
    about = [
        float(v * np.exp(rng.uniform(-0.4, 0.4))) for v in (1400, 2400, 520, 45, 40, 220e3, 210e3, 1.2, 1.5, 1.5, 1.4)
    ]
    spring = it.Spring(float(25e3 * np.exp(rng.uniform(-0.4, 0.4))))
    strut = (
        spring | it.Damper(it.free(100.0, 20e3, name="c")) | it.Damper(3e3) - it.Inerter(it.free(1.0, 900.0, name="b"))
    )
    return it.FullCar(*about, front=strut, rear=spring | it.Damper(1.5e3) | it.Inerter(20.0), **bars)


def compiled(mechanism, index):
    return CompiledNorm(linear_problem(mechanism, index.definition(mechanism), CONVENTIONS["exact"]))


def whole(definition, point):
    """Norms of the whole mechanism: behind filters without rounding, and corrected where these only stand in."""
    system = definition.problem.system(definition._close_at(point))
    return definition.problem.correct_norms(system, h2_exactly(system, None)[0])[0]


def check(seed):
    rng = np.random.default_rng(seed)
    found = car(rng, anti_roll_front=it.Spring(8e3)).mechanism()
    road = it.Road(5e-7, float(rng.uniform(5.0, 40.0)), FORMS[seed % 3](float(rng.uniform(0.5, 1.5))))
    index = (it.SuspensionTravel if seed % 2 == 0 and seed % 3 < 2 else it.RideComfort)(road)
    definition, point = compiled(found, index), np.exp(rng.uniform(np.log([200.0, 5.0]), np.log([9e3, 500.0])))
    expected = whole(definition, point)
    assert np.all(np.isfinite(expected))
    assert definition._exact_norms(point) == pytest.approx(expected, rel=1e-12)
    quick = definition._compiled_norms(point[None])[0]
    sure = np.isfinite(quick)
    assert quick[sure] == pytest.approx(expected[sure], rel=1e-9)
    return definition, point, sure.all()


@pytest.mark.parametrize("seed", range(3))
def test_halves_have_the_norms_of_the_whole(seed):
    definition, _, sure = check(seed)
    sizes = [len(one.problem.unfiltered.mechanism.coordinates) for one in definition.single_source_definitions]
    assert sizes == [4, 3]  # bounce, pitch and two wheels; roll and two wheels
    assert sure or seed % 3 == 2


@pytest.mark.parametrize("chunk", sampled(range(5), kept=0))
def test_halves_of_many_cars(chunk):
    seeds = range(3 + 18 * chunk, 21 + 18 * chunk)
    sure = [check(seed)[2] for seed in seeds]
    assert sum(sure[i] for i, seed in enumerate(seeds) if seed % 3 < 2) >= 9  # of twelve


def test_slopes_of_halves_are_those_of_the_whole():
    definition, point, _ = check(1)
    value, gradient = definition.value_and_gradient(point)
    problem = definition.problem
    total = lambda at: float(problem.definition.combine(whole(definition, at), problem.weights))  # noqa: E731
    assert value == pytest.approx(total(point), rel=1e-9)
    for i, slope in enumerate(gradient):
        step = 1e-4 * (np.arange(2) == i)
        assert slope * point[i] == pytest.approx(
            (total(point * (1 + step)) - total(point * (1 - step))) / 2e-4, rel=1e-5
        )


def test_a_car_with_one_heavier_wheel_stays_whole():
    mechanism = car(np.random.default_rng(4)).mechanism()
    (wheel,) = (c for c in mechanism.coordinates if c.name == "unsprung_front_left")
    heavier = replace(wheel, inertia=wheel.inertia * (1.0 + 1e-12))
    lopsided = replace(mechanism, coordinates=tuple(heavier if c is wheel else c for c in mechanism.coordinates))
    definition = compiled(lopsided, it.RideComfort(it.Road(5e-7, 20.0, it.Coherence.first_order(0.3))))
    assert [len(one.problem.unfiltered.mechanism.coordinates) for one in definition.single_source_definitions] == [7, 7]


def test_a_free_bar_keeps_the_half_that_feels_it():
    """Where both sides move alike nothing moves the bar, and its value makes no difference there."""
    rng = np.random.default_rng(7)
    mechanism = car(rng, anti_roll_front=it.Spring(it.free(1e3, 1e5, name="bar"))).mechanism()
    definition = compiled(mechanism, it.RideComfort(it.Road(5e-7, 20.0, it.Coherence.first_order(0.3))))
    point = np.array([{"c": 2e3, "b": 50.0, "bar": 9e3}[name] for name in mechanism.free_values()])
    assert [len(one.problem.unfiltered.mechanism.coordinates) for one in definition.single_source_definitions] == [4, 3]
    assert definition._exact_norms(point) == pytest.approx(whole(definition, point), rel=1e-12)
    assert definition._compiled_norms(point[None])[0] == pytest.approx(whole(definition, point), rel=1e-9)
    _, gradient = definition.value_and_gradient(point)
    ahead, behind = (
        whole(definition, point * (1 + step * (np.array(list(mechanism.free_values())) == "bar")))
        for step in (1e-4, -1e-4)
    )
    weighted = [
        float(definition.problem.definition.combine(one, definition.problem.weights)) for one in (ahead, behind)
    ]
    at = list(mechanism.free_values()).index("bar")
    assert gradient[at] * point[at] == pytest.approx((weighted[0] - weighted[1]) / 2e-4, rel=1e-5)


BRANCHES = {
    "spring and inerter": it.Spring(2e5) - it.Inerter(it.free(1.0, 900.0, name="b")),
    "a tuned inerter": it.Spring(2e5) - (it.Inerter(it.free(1.0, 900.0, name="b")) | it.Spring(3e4)),
    "a bridge": it.Bridge(
        it.Spring(2e5), it.Inerter(it.free(1.0, 900.0, name="b")), it.Inerter(30.0), it.Spring(5e4), it.Spring(1e5)
    ),
}
SPRINGS = [
    it.Spring(it.free(1e4, 1e5, name=f"k{axle}")) | it.Damper(it.free(300.0, 2e4, name=f"c{axle}")) for axle in "fr"
]


@pytest.mark.parametrize(("name", "form"), [*zip(BRANCHES, (*FORMS[:2], None), strict=True)], ids=BRANCHES)
def test_branches_without_a_damper_are_not_undamped_in_a_half(name, form):
    """Left against right, such branches would oscillate for ever, unexcited: no norm would be sure in doubles."""
    front, rear = (spring | BRANCHES[name] for spring in SPRINGS)
    full = it.FullCar(
        1400, 2400, 520, 45, 40, 22e4, 21e4, 1.2, 1.5, 1.5, 1.4, front, rear, anti_roll_front=it.Spring(8e3)
    )
    index = it.RideComfort(it.Road(5e-7, 20.0, form and form(1.0)))
    definition = compiled(full.mechanism(), index)
    bounds = np.log([(value.lower, value.upper) for value in full.free_values().values()])
    points = np.exp(np.random.default_rng(5).uniform(*bounds.T, (60, len(bounds))))
    assert definition.is_unsure(points).mean() < 0.1
    point = points[0]
    design = full.with_values(dict(zip(full.free_values(), point.tolist(), strict=True)))
    expected = it.evaluate(replace(design.mechanism(), mirror=()), index, it.Norm()).value  # of both sides
    assert definition.value_and_gradient(point)[0] == pytest.approx(expected, rel=2e-9)
    for output in ("front_right_force", "rear_left_travel"):
        both = it.RandomResponse({output: 1.0}, index.road)
        of_whole = it.evaluate(replace(design.mechanism(), mirror=()), both, it.Norm())
        assert it.evaluate(design, both, it.Norm()).value == pytest.approx(of_whole.value, rel=2e-9)
