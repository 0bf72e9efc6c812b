"""Fronts: ends against single optima, points against many random designs, spread, jumps, limits, hypervolume."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
import pytest
from campaigns import sampled
from strategies import random_half_car, random_quarter_car
from wang_su import J1, J3, J5, ROAD, paper_quarter_car

import inerter as it
from inerter.methods.multisine_lines import SampledObjective

NORM = it.Norm()


@dataclass(frozen=True)
class WithoutGradients(it.Norm):
    """Norms of which a search knows the values alone, as of what is simulated."""

    def objective(self, vehicle, index):
        return SampledObjective(self.estimate, vehicle, index)


def strut(kind):
    damper, inerter = it.Damper(it.free(100.0, 1e5, "c")), it.Inerter(it.free(1.0, 3e3, "b"))
    spring = it.Spring(it.free(3e4, 3e5, "k"))
    return {
        "S2": it.Spring(8e4) | damper | inerter,
        "S3": it.Spring(8e4) | damper - inerter,
        "S1 k": spring | damper,
        "S3 k": spring | damper - inerter,
        "four": spring | damper - inerter - it.Spring(it.free(1e5, 1e6, "k1")),
    }[kind]


def random_designs(car, indices, count, seed=0, around=()):
    """Values of random designs between the bounds, or around some."""
    rng, free = np.random.default_rng(seed), car.free_values()
    if around:
        which = rng.integers(len(around), size=count)
        spread = 10.0 ** rng.uniform(-4.0, -0.5, count)
        points = {
            name: np.clip(
                np.array([one[name] for one in around])[which] * np.exp(spread * rng.normal(size=count)),
                bounds.lower,
                bounds.upper,
            )
            for name, bounds in free.items()
        }
    else:
        points = {n: np.exp(rng.uniform(np.log(v.lower), np.log(v.upper), count)) for n, v in free.items()}
    return it.evaluate_many(car, indices, points, NORM)


def check_undominated(front, others, allowed=1e-7):
    for values in front.values:
        assert not np.any(np.all(others < values * (1.0 - allowed), axis=1))
    for i, values in enumerate(front.values):
        rest = np.delete(front.values, i, axis=0)
        assert not np.any(np.all(rest <= values * (1.0 + 1e-12), axis=1))


def gaps(front):
    return np.linalg.norm(np.diff(front.normalised, axis=0), axis=1)


TWO = [(J1, J3), (J1, J5), (J3, J5)]
KINDS = ["S2", "S3", "S1 k", "S3 k", "four"]
MEMBERS = list(product(KINDS, range(3), range(3), [20_000, 100_000]))  # with so many random designs


@pytest.mark.parametrize("other", sampled([J5, it.SuspensionTravel(ROAD)], [J5]), ids=["J5", "travel"])
def test_an_end_that_leaves_the_other_criterion_open_is_the_best_in_that_too(other):
    """The least static stiffness has any damper."""
    car, indices = paper_quarter_car(strut("S3 k")), [it.static_stiffness("strut"), other]
    front = it.pareto_front(car, indices, NORM, points=9, seed=0)
    softest = paper_quarter_car(it.Spring(3e4) | strut("S3").parts[1])
    least = it.optimise(softest, other, NORM, seed=0).value
    assert front.values[0] == pytest.approx([3e4, least], rel=1e-6)
    check_undominated(front, random_designs(car, indices, 2000))
    assert gaps(front).max() < 2.0 * np.median(gaps(front))


@pytest.mark.parametrize(
    ("kind", "pair", "number", "count"),
    sampled(
        MEMBERS, often=[("S3", 0, 0, 20_000)], seldom=[member for member in MEMBERS if member[-1] > 20_000], kept=0
    ),
)
def test_no_random_design_dominates_a_point(kind, pair, number, count):
    car, indices = random_quarter_car(np.random.default_rng([number, 77]), strut(kind)), list(TWO[pair])
    points = 9 if count == 20_000 else 15
    front = it.pareto_front(car, indices, NORM, points=points)
    assert all(status.ok for status in front.statuses)
    check_undominated(front, random_designs(car, indices, count))
    check_undominated(front, random_designs(car, indices, count // 5, 1, front.parameters))
    ends = [it.optimise(car, index, NORM).value for index in indices]
    assert front.values[0, 0] == pytest.approx(ends[0], rel=1e-6)
    assert front.values[-1, 1] == pytest.approx(ends[1], rel=1e-6)
    assert np.all(np.diff(front.values[:, 0]) > 0.0)
    assert np.all(np.diff(front.values[:, 1]) < 0.0)
    if len(front.values) > 1:
        closed = [gap for i, gap in enumerate(gaps(front)) if (i, i + 1) not in front.jumps]
        assert len(front.values) == points
        assert max(closed) <= 2.5 * np.median(closed)


HARD = [83, 89, 93, 95]  # fronts that had gaps, as 16


@pytest.mark.parametrize("number", sampled(range(120), often=[16, *HARD[2:]], kept=0))
def test_fronts_of_a_force_have_no_gaps_that_are_not_told(number):
    """Many designs may have the least force of a damper: the best of them in the other criterion is the end."""
    rng = np.random.default_rng([number, 818])
    kind = ["S2", "S3", "S1 k", "S3 k", "four", "S2"][int(rng.integers(6))]
    car = random_quarter_car(rng, strut(kind))
    other = [J1, J3, J5, it.SuspensionTravel(ROAD), J1, it.ElementVelocity(ROAD, "c")][int(rng.integers(6))]
    indices = [it.ElementForce(ROAD, "c"), other][:: -1 if rng.random() < 0.5 else 1]
    front = it.pareto_front(car, indices, NORM, points=15)
    check_undominated(front, random_designs(car, indices, 2_000))
    across = [gap for i, gap in enumerate(gaps(front)) if (i, i + 1) not in front.jumps]
    assert len(front.values) in (1, 15)
    assert max(across, default=0.0) <= 2.5 * np.median(across or [0.0])
    assert front.ideal == pytest.approx([it.optimise(car, index, NORM).value for index in indices], rel=1e-6)


def test_each_point_is_a_design_that_can_be_taken_on():
    car = paper_quarter_car(strut("S3"))
    front = it.pareto_front(car, [J1, J3], NORM, points=5)
    for design, parameters, values in zip(front.designs, front.parameters, front.values, strict=True):
        assert design == car.with_values(parameters)
        assert [it.evaluate(design, index, NORM).value for index in (J1, J3)] == pytest.approx(values, rel=1e-12)
    again = it.pareto_front(car, [J1, J3], NORM, points=5)
    assert np.array_equal(front.values, again.values)


@pytest.mark.parametrize("share", sampled([0.25, 0.75], kept=1))
def test_points_are_optima_with_the_other_criterion_as_a_limit(share):
    car = paper_quarter_car(strut("S3 k"))
    front = it.pareto_front(car, [J1, J5], NORM, points=9)
    i = int(share * 8)
    best = it.optimise(car, J1, NORM, subject_to=[it.at_most(J5, float(front.values[i, 1]))])
    assert best.value == pytest.approx(front.values[i, 0], rel=1e-5)


def test_limits_hold_along_a_front():
    car = paper_quarter_car(it.Spring(12e4) | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(it.free(1.0, 2e3, "b")))
    front = it.pareto_front(car, [J1, J5], NORM, points=5, subject_to=[it.at_most(J3, 540.0)])
    for design, held in zip(front.designs, front.limits, strict=True):
        value = it.evaluate(design, J3, NORM).value
        assert value <= 540.0 * (1.0 + 1e-6)
        assert held[0].value == value
    assert any(held[0].active for held in front.limits)
    others = random_designs(car, [J1, J5, J3], 2_000)
    check_undominated(front, others[others[:, 2] <= 540.0][:, :2])


@dataclass(frozen=True)
class Made:
    """A function of one value x: the two of Zitzler, Deb and Thiele's third problem, whose front is in five pieces."""

    which: int
    symbol = title = response = "made"
    unit = "1"

    def function(self, x):
        if self.which == 0:
            return 1.0 + x, np.ones_like(x)
        turn = 10.0 * np.pi
        value = 3.0 - np.sqrt(x) - x * np.sin(turn * x)
        return value, -0.5 / np.sqrt(x) - np.sin(turn * x) - turn * x * np.cos(turn * x)

    def constituents(self, vehicle):
        return []

    def per_output(self, split, vehicle):
        return [self]

    def estimate(self, vehicle, method):
        return it.Estimate(float(self.function(np.float64(vehicle.strut.parts[1].value))[0]), "1")

    def estimate_many(self, vehicle, method, points):
        return self.function(points["x"])[0]

    def as_objective(self, vehicle, method):
        return self

    def values(self, points):
        return self.function(points[:, 0])[0]

    def value_and_gradient(self, point):
        value, slope = self.function(point[0])
        return float(value), np.array([slope])

    def active(self, point):
        return None

    def components(self, point, which):
        raise AssertionError


@pytest.mark.parametrize("count", sampled([15, 25, 50], [25], [50]))
def test_a_front_in_pieces_says_where_it_leaps(count):
    car = paper_quarter_car(it.Spring(1e5) | it.Damper(it.free(1e-3, 1.0, "x")))
    front = it.pareto_front(car, [Made(0), Made(1)], NORM, points=count)
    x = np.array([values["x"] for values in front.parameters])
    every = np.linspace(1e-3, 1.0, 200_001)
    low = np.minimum.accumulate(Made(1).function(every)[0])
    for place, value in zip(x, front.values[:, 1], strict=True):
        assert value <= np.interp(place, every, low) + 1e-6
    starts = every[1:][np.diff(low) < 0.0]
    pieces = np.split(starts, np.flatnonzero(np.diff(starts) > 1e-3) + 1)
    assert len(pieces) == 5
    held = [np.flatnonzero((x > piece[0] - 1e-4) & (x < piece[-1] + 1e-4)) for piece in pieces]
    assert sum(map(len, held)) == len(x) == count
    across = [(int(one[-1]), int(other[0])) for one, other in pairwise(held)]
    assert set(front.jumps) <= set(across)
    assert len(front.jumps) >= (4 if count > 20 else 3)


def test_criteria_that_do_not_contradict_each_other():
    car = paper_quarter_car(strut("S3"))
    slow = it.RideComfort(it.Road(roughness=5e-7, speed=10.0))
    front = it.pareto_front(car, [J1, slow], NORM, points=7)
    assert front.values.shape == (1, 2)
    assert front.values[0, 0] == pytest.approx(it.optimise(car, J1, NORM).value, rel=1e-6)


@pytest.mark.campaign
def test_among_many_local_optima_points_are_searched_from_more_starts_and_ends_keep_their_doubt():
    """A half car at walking speed; the known design is the best of 40 searches by SLSQP at an equal tyre load."""

    def axle(stiffness, damping):
        link = it.Spring(it.free(1e3, 1e6, "s")) - it.Inerter(it.free(1.0, 2e3, "b"))
        return it.Spring(stiffness) | it.Damper(damping) | link

    front, rear = axle(105706.0, 111.57), axle(25366.6, 934.66)
    car = it.HalfCar(1144.65, 445.43, 65.222, 22.488, 223188.0, 171441.0, 1.33145, 1.22013, front=front, rear=rear)
    slow = it.Road(roughness=5e-7, speed=0.83185)
    indices = [it.RideComfort(slow), it.TyreLoad(slow)]
    found = it.pareto_front(car, indices, NORM, points=3)
    known = car.with_values({"s": 919579.9, "b": 4.142877})
    check_undominated(found, np.array([[it.evaluate(known, index, NORM).value for index in indices]]), 1e-6)
    assert found.statuses[0] == it.optimise(car, indices[0], NORM).status
    assert found.status.kind is it.StatusKind.INACCURATE


@pytest.mark.campaign
def test_points_among_many_local_optima_are_confirmed_by_independent_searches_or_doubted():
    """The searches for the ends agree; the known designs are the best of 40 searches by SLSQP at equal tyre loads."""
    link = it.Damper(it.free(100, 1e4, "c")) | it.Spring(it.free(1e3, 1e6, "s")) - it.Inerter(it.free(1, 2000, "b"))
    front, rear = it.Spring(13439.85239441) | link, it.Spring(130802.367995418) | link
    car = it.HalfCar(
        1131.0386, 2250.70562, 46.5993924, 35.0284072, 87152.89679, 328450.1994, 1.249038798, 0.805884722, front, rear
    )
    road = it.Road(roughness=5e-7, speed=8.548728508)
    indices = [it.RideComfort(road), it.TyreLoad(road)]
    found = it.pareto_front(car, indices, NORM, points=7)
    known = [(4598.777483, 38108.924237), (4405.824469, 123404.800818)]
    designs = [car.with_values({"c": c, "s": s, "b": 1.0}) for c, s in known]
    check_undominated(found, np.array([[it.evaluate(one, index, NORM).value for index in indices] for one in designs]))
    assert found.statuses[0].ok
    assert found.statuses[-1].ok
    assert {status.kind for status in found.statuses[1:-1]} == {it.StatusKind.OK, it.StatusKind.INACCURATE}
    assert "independent starts" in found.status.message


@pytest.mark.campaign
def test_a_front_that_no_design_reaches():
    front = it.pareto_front(paper_quarter_car(strut("S3")), [J1, J5], NORM, subject_to=[it.at_most(J3, 100.0)])
    assert front.values.shape == (0, 2)
    assert front.status.kind is it.StatusKind.INFEASIBLE
    assert front.designs == ()
    with pytest.raises(it.InerterError, match="no knee"):
        _ = front.knee


@pytest.mark.parametrize("kind", sampled(["S3", "S3 k", "four"], kept=0))
def test_three_criteria(kind):
    car = paper_quarter_car(strut(kind))
    front = it.pareto_front(car, [J1, J3, J5], NORM, points=15)
    check_undominated(front, random_designs(car, [J1, J3, J5], 20_000), 1e-6)
    check_undominated(front, random_designs(car, [J1, J3, J5], 5_000, 1, front.parameters), 1e-6)
    for i, index in enumerate((J1, J3, J5)):
        assert front.ideal[i] == pytest.approx(it.optimise(car, index, NORM).value, rel=1e-6)
    assert 10 <= len(front.values) <= 15


def check_hypervolume(front):
    """The volume that random points fill, to five times its error."""
    reference = front.nadir * 1.05
    size = reference - front.ideal
    points = front.ideal + np.random.default_rng(0).uniform(size=(200_000, size.size)) * size
    covered = np.zeros(len(points), dtype=bool)
    for values in front.values:
        covered |= np.all(points >= values, axis=1)
    share = covered.mean()
    error = size.prod() * np.sqrt(share * (1.0 - share) / len(points))
    assert abs(front.hypervolume(reference) - share * size.prod()) <= 5.0 * error


def test_hypervolume_of_two_criteria_is_an_area():
    front = it.pareto_front(paper_quarter_car(strut("S3")), [J1, J3], NORM, points=9)
    check_hypervolume(front)
    assert front.hypervolume(front.ideal * 0.9) == 0.0


@pytest.mark.marathon
def test_hypervolume_of_three_criteria_is_a_volume():
    pytest.importorskip("moocore", reason="the volume of three criteria needs moocore (extra fronts)")
    front = it.pareto_front(paper_quarter_car(strut("S3")), [J1, J3, J5], NORM, points=6)
    check_undominated(front, random_designs(paper_quarter_car(strut("S3")), [J1, J3, J5], 2_000), 1e-6)
    check_hypervolume(front)


def test_the_knee_is_farthest_from_the_line_of_the_ends():
    front = it.pareto_front(paper_quarter_car(strut("S3")), [J1, J5], NORM, points=11)
    a, z = front.normalised[0], front.normalised[-1]
    along = (z - a) / np.linalg.norm(z - a)
    away = [np.linalg.norm((u - a) - ((u - a) @ along) * along) for u in front.normalised]
    assert front.knee == int(np.argmax(away))


@pytest.mark.campaign
def test_a_front_of_what_is_simulated():
    screw = it.Inerter(it.free(1.0, 2e3, "b")) | it.Friction(20.0)
    car = paper_quarter_car(it.Spring(12e4) | it.Damper(it.free(100.0, 1e5, "c")) - screw)
    quick = it.pareto_front(car, [J1, J3], it.StatisticalLinearisation(), points=3)
    assert len(quick.values) == 3
    assert np.all(np.diff(quick.values[:, 1]) < 0.0)


@pytest.mark.campaign
def test_a_front_without_gradients_is_the_same():
    car = paper_quarter_car(strut("S3"))
    exact, found = (
        it.pareto_front(car, [J1, J5], NORM, points=3),
        it.pareto_front(car, [J1, J5], WithoutGradients(), points=3),
    )
    assert found.values == pytest.approx(exact.values, rel=2e-3)


@pytest.mark.marathon
def test_a_front_of_what_is_simulated_on_roads():
    screw = it.Inerter(it.free(1.0, 2e3, "b")) | it.Friction(20.0)
    car = paper_quarter_car(it.Spring(12e4) | it.Damper(it.free(100.0, 1e5, "c")) - screw)
    front = it.pareto_front(car, [J1, J3], it.ExpectedValue(realisations=2), points=3)
    assert np.all(np.diff(front.values[:, 0]) > 0.0)
    assert np.all(np.diff(front.values[:, 1]) < 0.0)


def test_a_condition_that_is_never_the_worst_changes_no_front():
    """Its indices lie so far below the range of the front that, normalised, they are negative."""
    use = it.Conditions([it.Condition(0.5), it.Condition(0.5, road={"speed": 8.0})])
    car = paper_quarter_car(strut("S2"))
    over = it.pareto_front(car, [use.worst(J1), use.worst(J3)], NORM, points=7)
    alone = it.pareto_front(car, [J1, J3], NORM, points=7)
    assert over.values == pytest.approx(alone.values, rel=1e-6)


def test_a_front_of_a_half_car_over_conditions():
    use = it.Conditions([it.Condition(1.0, road={"speed": 15.0}), it.Condition(2.0, vehicle={"sprung_mass": 900.0})])
    front, rear = (
        it.Spring(6e4) | it.Damper(it.free(300.0, 3e4, "c")),
        it.Spring(5e4) | it.Damper(it.tied("c", factor=0.8)),
    )
    car = random_half_car(np.random.default_rng(4), front, rear)
    found = it.pareto_front(car, [use.mean(J1), use.worst(J3)], NORM, points=5)
    check_undominated(found, random_designs(car, [use.mean(J1), use.worst(J3)], 300))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"indices": [J1]}, "requires two or three indices, got 1"),
        ({"indices": J1}, "requires two or three indices"),
        ({"indices": "J1 J3"}, "requires two or three indices"),
        ({"indices": [J1, J1]}, "different indices"),
        ({"indices": [J1, "J3"]}, "Expected an index"),
        ({"points": 2}, "from 3 to 10000, got 2"),
        ({"points": 5, "indices": [J1, J3, J5]}, "of 3 indices must be an integer from 6"),
        ({"points": 7.5}, "an integer from 3"),
        ({"seed": -1}, "non-negative integer"),
        ({"subject_to": [J3]}, "list of constraints"),
        ({"vehicle": paper_quarter_car(it.Spring(1e5) | it.Damper(1e3))}, "no free value to optimise"),
    ],
)
def test_fronts_that_cannot_be(given, said):
    asked = {"vehicle": paper_quarter_car(strut("S3")), "indices": [J1, J3], "method": NORM, **given}
    with pytest.raises(it.InerterError, match=said):
        it.pareto_front(**asked)


def test_a_reference_that_cannot_be():
    front = it.pareto_front(paper_quarter_car(strut("S3")), [J1, J3], NORM, points=3)
    with pytest.raises(it.InerterError, match="must have 2 numbers"):
        front.hypervolume([1.0])
