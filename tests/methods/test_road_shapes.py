"""Vehicles whose tyres keep a share of the road's shape, three axles under a rigid body for one: by compiled code."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from campaigns import sampled
from nodal import Nodal
from quadrature import h2_by_quadrature

from inerter import (
    Coordinate,
    Damper,
    Inerter,
    Mechanism,
    Norm,
    OutputWeight,
    PerformanceOutputs,
    RideComfort,
    Road,
    RoadInput,
    Spring,
    Strut,
    Tyre,
    TyreLoad,
    evaluate,
    evaluate_many,
    free,
    optimise,
)
from inerter.kernels import h2 as h2_kernels

INDICES = {"J1": RideComfort, "J3": TyreLoad}
c, b = Damper(free(1e3, 1e5, "c")), Inerter(free(10.0, 3e3, "b"))


def strut(rng):
    """A random strut with the free values c and b."""
    k, other = Spring(rng.uniform(1e5, 4e5)), Damper(rng.uniform(1e3, 3e4))
    screw = Spring(rng.uniform(5e5, 3e6)) | Damper(rng.uniform(1e3, 1e4))
    choices = (k | c | b, k | c - b, k | other | c - b, k | c - screw - b, k | c | screw - b)
    return choices[rng.integers(len(choices))]


def vehicle(rng, axles, twins):
    """A rigid body on so many axles, some of whose wheel sets stand on two tyres, behind each other or side by side."""
    levers = np.sort(rng.uniform(-4.0, 3.0, axles))[::-1].tolist()
    network, tyres, roads = strut(rng), [], []
    for i, lever in enumerate(levers):
        for j in range(1 + (i < twins)):
            stiffness, apart = Spring(rng.uniform(5e5, 1.5e6)), j * rng.choice([0.0, rng.uniform(0.2, 0.8)])
            tyres.append(Tyre(f"tyre{i}{j}", stiffness, {f"wheel{i}": 1.0}, f"road{i}{j}"))
            roads.append(RoadInput(f"road{i}{j}", distance=levers[0] - lever + apart))
    return Mechanism(
        coordinates=(
            Coordinate("body", rng.uniform(4e3, 1.5e4)),
            Coordinate("pitch", rng.uniform(8e3, 4e4), angle=True),
            *(Coordinate(f"wheel{i}", rng.uniform(200.0, 600.0)) for i in range(axles)),
        ),
        struts=tuple(
            Strut(f"strut{i}", network, upper={"body": 1.0, "pitch": lever}, lower={f"wheel{i}": 1.0})
            for i, lever in enumerate(levers)
        ),
        tyres=tuple(tyres),
        roads=tuple(roads),
        measures=PerformanceOutputs(
            comfort=(OutputWeight("body_acceleration"), OutputWeight("pitch_acceleration", 2.0)),
            tyre_load=tuple(OutputWeight(f"{tyre.name}_load") for tyre in tyres),
        ),
    )


def family(seed, count):
    """Random members in turn: three axles, four, two with a pair of tyres, three with two pairs."""
    rng, kinds = np.random.default_rng(seed), ((3, 0), (4, 0), (2, 1), (3, 2))
    for i in range(count):
        made, road = vehicle(rng, *kinds[i % len(kinds)]), Road(2e-6, rng.uniform(10.0, 40.0))
        free_values = made.free_values()
        bounds = np.log([(value.lower, value.upper) for value in free_values.values()])
        yield made, road, np.exp(rng.uniform(bounds[:, 0], bounds[:, 1], (5, len(free_values))))


def compiled(objective, points, weights=None):
    weights = np.empty(0) if weights is None else weights
    norms, gradients, doubts = h2_kernels.norms(points, *objective.arguments, weights)
    return norms, gradients, np.isfinite(doubts)


def check_family(seed, count, conventions, index):
    """Norms that compiled code says are good against those without rounding, and how many designs are good.

    Approximants of delays take seconds without rounding: one design of each vehicle with three arrivals is compared.
    """
    good = []
    for made, road, points in family(seed, count):
        objective = Norm(conventions).objective(made, INDICES[index](road))
        assert objective.arrivals[2][0].size > 0 or len(objective.problem.descriptor.inputs) < len(made.roads)
        norms, _, known = compiled(objective, points)
        good += known.tolist()
        few = np.flatnonzero(known)
        if conventions != "exact":
            few = few[: objective.arrivals[0].size <= 2]
        for i in few:
            np.testing.assert_allclose(norms[i], objective._exact_norms(points[i]), rtol=1e-9)
    return float(np.mean(good))


USUAL = {
    "exact": 0.9,
    "paper2008": 0.6,
}  # share of designs of which compiled code is sure: it bounds each delay's error


@pytest.mark.parametrize(
    ("index", "conventions"),
    sampled(product(INDICES, USUAL), seldom=[("J1", "exact"), ("J3", "paper2008"), ("J3", "exact")]),
)
def test_compiled_norms_are_those_without_rounding(index, conventions):
    assert check_family(21, 8, conventions, index) >= USUAL[conventions]


MANY = [(20, "J1", "exact"), *product([60], INDICES, USUAL)]


@pytest.mark.parametrize(("count", "index", "conventions"), sampled(MANY, seldom=MANY))
def test_compiled_norms_of_many_vehicles_are_those_without_rounding(count, index, conventions):
    assert check_family(22, count, conventions, index) >= USUAL[conventions]


@pytest.mark.parametrize("conventions", USUAL)
@pytest.mark.parametrize("index", INDICES)
def test_gradients_are_the_slopes_of_values(index, conventions):
    checked = 0
    for made, road, points in family(23, 8):
        objective, step = Norm(conventions).objective(made, INDICES[index](road)), 2e-3
        weights = objective.problem.weights
        norms, gradients, good = compiled(objective, points, weights)
        for value, gradient, point in zip(norms[good] @ weights, gradients[good], points[good], strict=True):
            for i in range(point.size):
                shifts = np.exp(step * np.arange(-2.0, 3.0)[:, None] * (np.arange(point.size) == i))
                f = compiled(objective, point * shifts)[0] @ weights
                slope = (f[0] - 8.0 * f[1] + 8.0 * f[3] - f[4]) / (12.0 * step)
                assert gradient[i] * point[i] == pytest.approx(slope, rel=0.0, abs=1e-8 * value)
            checked += 1
    assert checked >= 10


@pytest.mark.parametrize(("axles", "twins"), sampled([(3, 0), (2, 1)], kept=0))
def test_the_norm_is_the_integral_of_the_frequency_response(axles, twins):
    """By quadrature along the frequency axis: no states, and so no drift."""
    made, road = vehicle(np.random.default_rng(24), axles, twins), Road(2e-6, 20.0)
    design = dict.fromkeys(made.free_values(), 2e3) | {"c": 1.5e4}
    for index in INDICES.values():
        objective = Norm().objective(made, index(road))
        norms, _, good = compiled(objective, np.array([[design[name] for name in made.free_values()]]))
        assert good[0]
        mechanism, problem = made.with_values(design), objective.problem
        for found, name in zip(norms[0], problem.descriptor.outputs, strict=True):

            def response(omega, mechanism=mechanism, problem=problem, name=name):
                nodal = Nodal(mechanism, omega)
                return np.array([nodal.response(name, source) for source in problem.descriptor.inputs], complex).T

            expected = h2_by_quadrature(response, problem.delays, edge=4000.0)
            assert found == pytest.approx(expected, rel=1e-8), name


@pytest.mark.parametrize("index", INDICES)
def test_no_design_beside_an_optimum_is_better(index):
    made, asked = vehicle(np.random.default_rng(25), 3, 0), INDICES[index](Road(2e-6, 22.0))
    best = optimise(made, asked, Norm(), seed=0)
    assert best.status.ok
    least = evaluate(best.design, asked, Norm()).value
    assert best.value == pytest.approx(least, rel=1e-9)
    for name, value in best.parameters.items():
        limits = made.free_values()[name]
        for factor in (0.97, 1.03):
            beside = best.parameters | {name: float(np.clip(value * factor, limits.lower, limits.upper))}
            assert evaluate(made.with_values(beside), asked, Norm()).value >= least * (1.0 - 1e-12)


def test_a_shape_that_grows_without_bound_is_left_to_the_exact_way():
    """A spring to the ground holds the height of the road itself: the body's acceleration does not see it."""
    body = Coordinate("body", 500.0)
    height = Mechanism(
        coordinates=(body, Coordinate("wheel", 50.0)),
        struts=(
            Strut("strut", Spring(3e4) | Damper(free(1e3, 1e4, "c")), {"body": 1.0}, {"wheel": 1.0}),
            Strut("line", Spring(500.0), {"body": 1.0}, {}),
        ),
        tyres=(Tyre("tyre", Spring(2e5), {"wheel": 1.0}, "road"),),
        roads=(RoadInput("road"),),
        measures=PerformanceOutputs(
            comfort=(OutputWeight("body_acceleration"),), tyre_load=(OutputWeight("tyre_load"),)
        ),
    )
    road, values = Road(2e-6, 20.0), np.array([2e3, 5e3])
    objective = Norm().objective(height, RideComfort(road))
    assert not np.any(compiled(objective, values[:, None])[2])
    comfort, load = evaluate_many(height, (RideComfort(road), TyreLoad(road)), {"c": values}, Norm()).T
    alone = [evaluate(height.with_values({"c": float(v)}), RideComfort(road), Norm()).value for v in values]
    np.testing.assert_allclose(comfort, alone, rtol=1e-9)
    assert np.all(np.isnan(load))
    softer = replace(height, struts=height.struts[:1])  # without the line nothing drifts
    assert np.all(compiled(Norm().objective(softer, RideComfort(road)), values[:, None])[2])
