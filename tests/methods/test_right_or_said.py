"""Every number of `Norm` is right to 1e-9, or it is nan with a status: against rational arithmetic, for random members.

Infinite means infinite, and zero means zero.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from campaigns import sampled
from random_mechanisms import FAMILIES, mechanisms
from wang_su import ROAD, paper_quarter_car

from inerter import (
    Damper,
    Inerter,
    LoadCarrying,
    Norm,
    RideComfort,
    Spring,
    TyreLoad,
    evaluate,
    evaluate_many,
    free,
    h2_norm,
    hinf_norm,
    optimise,
    state_space,
)
from inerter.errors import MechanismError
from inerter.networks.transform import map_elements

rational = pytest.importorskip("rational_norms", reason="python-flint is not installed")
INDICES = (RideComfort(ROAD), TyreLoad(ROAD), LoadCarrying())


def judged(mechanism, index) -> str:
    """What became of one number: right, said (nan, with a status), or how it is wrong."""
    try:
        estimate = evaluate(mechanism, index, Norm())
    except MechanismError:
        return "refused"
    expected = rational.index_value(mechanism, index)
    if expected is None:
        return "no reference"
    if math.isnan(estimate.value):
        return "said" if estimate.status.message else "nan without a reason"
    if expected is rational.INFINITE:
        return "right" if estimate.value == math.inf and not estimate.status.ok else f"{estimate} is infinite"
    good = math.isclose(estimate.value, expected, rel_tol=1e-9) and estimate.status.ok
    return "right" if good else f"{estimate.value!r} {estimate.status} for {expected!r}: {index.symbol} {mechanism}"


def tally(family: str, seed: int, count: int, extremes: float) -> dict[str, int]:
    found: dict[str, int] = {}
    for mechanism in mechanisms(family, seed, count, extremes):
        for index in INDICES:
            outcome = judged(mechanism, index)
            found[outcome] = found.get(outcome, 0) + 1
    return found


def assert_right(found: dict[str, int]) -> None:
    told = {"right", "said", "refused", "no reference"}
    assert set(found) <= told, [outcome for outcome in found if outcome not in told]
    assert found["right"] >= 0.9 * sum(found.values()), found
    assert found.get("said", 0) <= 0.01 * sum(found.values()), found


@pytest.mark.parametrize(
    ("family", "extremes"), sampled(product(FAMILIES, [1.0, 1e2]), [(family, 1e2) for family in FAMILIES], kept=2)
)
def test_a_sample_of_each_family(family, extremes):
    assert_right(tally(family, seed=1, count=8, extremes=extremes))


@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    ("family", "extremes"),
    sampled(product(FAMILIES, [1.0, 1e2, 1e4]), seldom=list(product(FAMILIES, [1.0, 1e2])), kept=1),
)
def test_many_of_each_family(family, extremes):
    assert_right(tally(family, seed=2, count=40, extremes=extremes))


@pytest.mark.parametrize("damping", [1e-12, 1e-6, 1e8, 1e10, 1e13])
def test_the_norms_of_an_assembled_system_are_as_right(damping):
    """Nearly rigid and nearly undamped, by the road from linear system to number that anyone may take."""
    car = paper_quarter_car(Spring(120e3) | Damper(damping))
    for index, output in zip(INDICES, ("sprung_acceleration", "tyre_load"), strict=False):
        expected = rational.index_value(car.mechanism(), index) / ROAD.velocity_intensity
        assert h2_norm(state_space(car, "road", output)) == pytest.approx(expected, rel=1e-9)
    expected = rational.index_value(car.mechanism(), INDICES[2])
    assert hinf_norm(state_space(car, "sprung_force", "sprung_displacement")).value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("strut", ["c - b", "k - c - b", "k - b"])
def test_a_body_that_nothing_holds_at_rest(strut):
    """A force sets it in motion for good; a road does not: poles at zero, which no rounding may move."""
    k, c, b = Spring(2e4), Damper(1e3), Inerter(50.0)
    car = paper_quarter_car({"c - b": c - b, "k - c - b": k - c - b, "k - b": k - b}[strut])
    assert evaluate(car, INDICES[2], Norm()).value == math.inf
    assert h2_norm(state_space(car, None, "sprung_velocity")) == math.inf
    assert hinf_norm(state_space(car, "sprung_force", "sprung_velocity")).value == math.inf


def layouts(seed: int, count: int):
    """Mechanisms whose element values are all free, over the range from a hundredth to a hundred times their own."""
    rng = np.random.default_rng(seed)
    for mechanism in mechanisms("quarter car", seed, count, 1e2):
        number = iter(range(100))

        def freed(element, number=number):
            return element.with_value(free(element.value / 1e2, element.value * 1e2, f"v{next(number)}"))

        (strut,) = mechanism.struts
        yield (
            rng,
            type(mechanism)(
                mechanism.coordinates,
                (type(strut)(strut.name, map_elements(strut.network, freed), strut.upper, strut.lower),),
                mechanism.tyres,
                mechanism.roads,
                mechanism.forces,
                mechanism.measures,
            ),
        )


def check_many(seed: int, count: int, designs: int) -> None:
    for rng, car in layouts(seed, count):
        bounds = np.log([(value.lower, value.upper) for value in car.free_values().values()])
        points = np.exp(bounds[:, 0] + rng.random((designs, len(bounds))) * (bounds[:, 1] - bounds[:, 0]))
        values = dict(zip(car.free_values(), points.T, strict=True))
        many = evaluate_many(car, INDICES, values, Norm())
        for point, row in zip(points, many, strict=True):
            design = car.with_values(dict(zip(car.free_values(), point.tolist(), strict=True)))
            for value, index in zip(row, INDICES, strict=True):
                expected = rational.index_value(design.mechanism(), index)
                if expected is rational.INFINITE:
                    assert math.isnan(value)
                elif expected is not None and not math.isnan(value):
                    assert value == pytest.approx(expected, rel=1e-9)
                elif expected is not None:
                    assert not evaluate(design, index, Norm()).status.ok


def test_many_designs_at_once():
    check_many(seed=3, count=12, designs=8)


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("count", sampled([20, 150], kept=0))
def test_very_many_designs_at_once(count):
    check_many(seed=4, count=count, designs=20)


def check_gradients(seed: int, count: int) -> None:
    """Against rational values a little to both sides; what is not known is nan."""
    for rng, car in layouts(seed, count):
        names = list(car.free_values())
        bounds = np.log([(value.lower, value.upper) for value in car.free_values().values()])
        point = np.exp(bounds[:, 0] + rng.random(len(names)) * (bounds[:, 1] - bounds[:, 0]))
        for index in INDICES[:2]:
            value, gradient = Norm().objective(car, index).value_and_gradient(point)
            if not math.isfinite(value):
                continue
            for i in range(len(names)):
                ends = []
                for step in (-2e-4, -1e-4, 1e-4, 2e-4):
                    moved = point * np.where(np.arange(len(names)) == i, math.exp(step), 1.0)
                    design = car.with_values(dict(zip(names, moved.tolist(), strict=True)))
                    ends.append(rational.index_value(design.mechanism(), index))
                slope = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / 12e-4
                if not math.isnan(gradient[i]):
                    assert gradient[i] * point[i] == pytest.approx(slope, abs=1e-6 * value)


def test_gradients():
    check_gradients(seed=5, count=10)


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("count", sampled([40, 300], kept=0))
def test_many_gradients(count):
    check_gradients(seed=6, count=count)


def check_searches(seed: int, count: int) -> None:
    """A search ends with a number that is right, or with a status, never with an exception or an unknown winner."""
    for _, car in layouts(seed, count):
        for index in INDICES:
            best = optimise(car, index, Norm(), starts=2)
            if best.status.ok:
                assert best.value == pytest.approx(rational.index_value(best.design.mechanism(), index), rel=1e-9)
            else:
                assert not math.isfinite(best.value)
                assert best.status.message


def test_searches():
    check_searches(seed=7, count=4)


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("count", sampled([12, 60], seldom=[60]))
def test_many_searches(count):
    check_searches(seed=8, count=count)
