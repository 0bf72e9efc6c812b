"""Norms by modes against covariances with states for filters and coherence, and where modes must not serve."""

import dataclasses

import numpy as np
import pytest
from campaigns import sampled
from wang_su import paper_half_car

import inerter as it
from inerter import Damper, Inerter, Spring, free
from inerter.kernels import h2
from inerter.methods.compiled_norm import CompiledNorm
from inerter.methods.modal_norm import modal_arguments

ROAD, TWO_TRACKS = it.Road(5e-7, 25.0), it.Road(5e-7, 25.0, it.Coherence.first_order(0.2))


def strut(end):
    inner = Inerter(free(1.0, 1e4, f"b{end}")) | Damper(free(10.0, 1e5, f"d{end}"))
    return Spring(free(1e4, 1e6, f"k{end}")) | Damper(free(10.0, 1e5, f"c{end}")) - inner


HALF = it.HalfCar(700.0, 900.0, 40.0, 40.0, 1.5e5, 1.5e5, 1.2, 1.4, strut("f"), strut("r"))
FULL = it.FullCar(
    1400, 2400, 520, 45, 40, 220e3, 220e3, 1.2, 1.5, 1.52, 1.5, front=strut("f"), rear=strut("r"),
    anti_roll_front=Spring(8e3), anti_roll_rear=Spring(8e3),
)  # fmt: skip
QUESTIONS = {
    "half J3": (HALF, it.TyreLoad(ROAD)),
    "half Wk": (HALF, it.RideComfort(ROAD, weighting="Wk")),
    "half J3 with an approximant": (HALF, it.TyreLoad(ROAD), "paper2008"),
    "half Wk with an approximant": (HALF, it.RideComfort(ROAD, weighting="Wk"), "paper2008"),
    "full J3": (FULL, it.TyreLoad(TWO_TRACKS)),
    "full Wk": (FULL, it.RideComfort(TWO_TRACKS, weighting="Wk")),
}


def draw(car, count, seed):
    bounds = np.log([(value.lower, value.upper) for value in car.free_values().values()])
    return np.exp(np.random.default_rng(seed).uniform(bounds[:, 0], bounds[:, 1], (count, len(bounds))))


@pytest.mark.parametrize("name", QUESTIONS)
def test_they_are_the_norms_with_states_for_filters(name):
    car, index, *conventions = QUESTIONS[name]
    objective, points = it.Norm(*conventions).objective(car, index), draw(car, 60, len(name))
    for seen, one in objective.per_source_definitions:
        own, weights = np.ascontiguousarray(points[:, objective._columns(one)]), np.ones(int(seen.sum()))
        norms, gradients, errors = one._by_modes(own, weights)
        expected, slopes, unsure = h2.norms(own, *one.arguments, weights)
        known, both = np.isfinite(errors), np.isfinite(errors) & np.isfinite(unsure)
        assert known.mean() > 0.9
        assert norms[both] == pytest.approx(expected[both], rel=1e-9)
        sure = both & (unsure < 1e-10)
        scale = expected[sure].sum(axis=1)[:, None] / own[sure]
        assert np.all(np.abs(gradients[sure] - slopes[sure]) <= 1e-8 * scale)


LIGHT = ["half J3", "half Wk", "half J3 with an approximant", "half Wk with an approximant"]


@pytest.mark.parametrize("name", sampled(LIGHT, [LIGHT[2]], [LIGHT[3]]))
def test_they_are_right_to_a_billionth_where_damping_is_light(name):
    car, index, *conventions = QUESTIONS[name]
    objective, points = it.Norm(*conventions).objective(car, index), draw(car, 12, 7)
    points[:, [i for i, n in enumerate(car.free_values()) if n[0] in "cd"]] *= 1e-2
    norms, _, errors = objective._by_modes(points, np.empty(0))
    known = np.flatnonzero(np.isfinite(errors))
    assert known.size >= 9
    for i in known[:6]:
        assert norms[i] == pytest.approx(objective._exact_norms(points[i]), rel=1e-9)


def test_of_few_states_modes_know_designs_of_which_covariances_are_not_sure():
    inner = (Spring(1e6) | Damper(3200.0)) - (Inerter(free(1e2, 1e5, "b")) | Damper(free(1e4, 1e6, "d"), name="d"))
    car = it.QuarterCar(181.75, 25.0, 120e3, Spring(120e3) | Damper(free(10.0, 1e6, "c")) - inner)
    index = it.RandomResponse({"d_velocity": 1.0}, ROAD)  # as across friction that hardly slips
    objective, points = it.Norm().objective(car, index), draw(car, 200, 5)
    unsure = np.isinf(objective._by_covariances(points, np.empty(0))[2])
    assert unsure.sum() > 20
    norms, gradients, errors, is_modal = objective._kernel_norms(points, objective.problem.weights)
    assert np.array_equal(is_modal, unsure)
    known = np.flatnonzero(unsure & np.isfinite(errors))
    assert known.size > 0.8 * unsure.sum()
    for i in known[:6]:
        assert norms[i] == pytest.approx(objective._exact_norms(points[i]), rel=1e-9)
        step = 1e-3 * np.cos(np.arange(3.0))
        values = [objective._exact_index(points[i] * np.exp(by * step)) for by in (2.0, 1.0, -1.0, -2.0)]
        slope = np.dot([-1.0, 8.0, -8.0, 1.0], values) / 12.0
        assert (gradients[i] * points[i]) @ step == pytest.approx(slope, rel=1e-6)


def test_a_filter_behind_isotropic_tracks_is_not_lost():
    road, shape = it.Road(5e-7, 25.0, it.Coherence.isotropic(1.5)), it.Filter([20.0], [1.0, 20.0])
    index, point = it.TyreLoad(it.FilteredExcitation(road, shape)), draw(FULL, 1, 3)[0]
    values = dict(zip(FULL.free_values(), point.tolist(), strict=True))
    (found,) = it.evaluate_many(FULL, index, {name: np.array([v]) for name, v in values.items()}, it.Norm())[:, 0]
    assert found == pytest.approx(it.evaluate(FULL.with_values(values), index, it.Norm()).value, rel=1e-6)


def series_strut(end):
    inner = Spring(free(1e3, 1e6, f"s{end}")) - Inerter(free(1.0, 2e3, f"b{end}")) - Damper(free(10.0, 1e5, f"d{end}"))
    return Spring(8e4) | Damper(free(100.0, 2e4, f"c{end}")) | inner


def test_of_isotropic_tracks_modes_know_designs_at_bounds(monkeypatch):
    car = dataclasses.replace(FULL, front=series_strut("f"), rear=series_strut("r"))
    index = it.RideComfort(it.Road(5e-7, 25.0, it.Coherence.isotropic(1.5)), weighting="Wk")
    objective, points = it.Norm().objective(car, index), draw(car, 3, 2)
    names = list(car.free_values())
    corner = {"cf": 6587.0, "sf": 1e3, "bf": 2e3, "df": 10.0, "cr": 2659.0, "sr": 1e6, "br": 19.84, "dr": 7.732e4}
    points[:2] = [[corner[name] for name in names], [6539.0, 3.043e5, 1.0, 678.8, 1717.0, 1e6, 60.87, 1464.0]]
    expected = [objective._exact_index(point) for point in points]
    objective.supported_outputs  # noqa: B018 - found with the other code
    monkeypatch.setattr("inerter.methods.compiled_norm.h2_kernels", None)
    assert objective.values(points) == pytest.approx(expected, rel=2e-8)
    direction = np.cos(np.arange(8.0))
    for point in points:
        _, gradient = objective.value_and_gradient(point)
        ends = [objective.values(point * np.exp(step * direction[None]))[0] for step in (-1e-4, 1e-4)]
        assert (gradient * point) @ direction == pytest.approx((ends[1] - ends[0]) / 2e-4, rel=1e-4, abs=1e-5 * ends[0])


def test_where_modes_cannot_serve_covariances_do():
    struts = tuple(it.Strut(f"s{i}", strut(i), {f"body{i}": 1.0}, {f"wheel{i}": 1.0}) for i in range(3))
    masses = [it.Coordinate(f"{name}{i}", mass) for i in range(3) for name, mass in (("body", 300.0), ("wheel", 40.0))]
    tyres = tuple(it.Tyre(f"t{i}", Spring(2e5), {f"wheel{i}": 1.0}, f"r{i}") for i in range(3))
    roads = tuple(it.RoadInput(f"r{i}", distance=float(i)) for i in range(3))
    three = it.Mechanism(tuple(masses), struts, tyres, roads)
    index = it.RandomResponse({f"body{i}_acceleration": 1.0 for i in range(3)}, ROAD)
    assert modal_arguments(it.Norm().objective(three, index).problem) is not None
    assert modal_arguments(it.Norm("paper2008").objective(three, index).problem) is None  # a chain of approximants
    twice = it.Filter([1.0], [1.0, 2.0, 1.0])
    problem = it.Norm().objective(HALF, it.TyreLoad(ROAD)).problem
    definition = dataclasses.replace(problem.definition, filter=(twice, twice))
    assert modal_arguments(dataclasses.replace(problem, definition=definition)) is None
    even = it.Norm().objective(paper_half_car(strut("f"), strut("f")), it.TyreLoad(ROAD))
    points = draw(paper_half_car(strut("f"), strut("f")), 8, 1)
    refused = CompiledNorm(even.problem)
    refused.__dict__["_modal_arguments"] = None
    assert even._compiled_norms(points) == pytest.approx(refused._compiled_norms(points), rel=1e-9)


def test_no_gradient_is_computed_without_rounding_on_a_resonance_that_a_search_steps_over(monkeypatch):
    body, wheel, tyre, k, k1 = 250.0, 35.0, 150e3, 20e3, 1e4
    fastest = np.linalg.eigvals([[k / body, -k / body], [-k / wheel, (k + tyre) / wheel]]).max()
    series = Damper(free(100.0, 1e5, "c")) - (Inerter(free(0.1, 1e3, "b")) | Spring(k1))  # no damping at its notch
    objective = it.Norm().objective(it.QuarterCar(body, wheel, tyre, Spring(k) | series), it.RideComfort(ROAD))
    point = np.array([2000.0, k1 / fastest * (1.0 + 1e-7)])
    expected, asked, without_rounding = objective._exact_index(point), [], CompiledNorm._exact_norms
    monkeypatch.setattr(CompiledNorm, "_exact_norms", lambda one, at: asked.append(at) or without_rounding(one, at))
    value, gradient = objective.value_and_gradient(point)
    assert value == expected > 1e3 * objective.values(point[None] * [1.0, 1.006])[0]
    assert np.isnan(gradient).all()
    assert len(asked) == 1


def test_a_gradient_is_right_at_a_resonance_that_is_sharper_than_the_steps_of_differences():
    def end(name, *bounds):
        k, c, b, k1 = (free(0.5 * v, 2.0 * v, f"{letter}{name}") for letter, v in zip("kcbl", bounds, strict=True))
        return Spring(k) | Damper(c) - (Inerter(b) | Spring(k1))

    struts = end("f", 1e4, 178.5, 6.83, 4350.0), end("r", 1e4, 188.0, 64.0, 2.578e5)
    car = it.HalfCar(700.0, 900.0, 40.0, 40.0, 1.5e5, 1.5e5, 1.2, 1.4, *struts)
    objective = it.Norm().objective(car, it.TyreLoad(it.Road(1e-5, 25.0)))
    point = np.array([v.lower * 2.0 for v in car.free_values().values()])
    direction = np.cos(np.arange(8.0))
    _, gradient = objective.value_and_gradient(point)

    def exact_slope(step):
        ahead, behind = (objective._exact_index(point * np.exp(sign * step * direction)) for sign in (1.0, -1.0))
        return (ahead - behind) / (2.0 * step)

    expected = (4.0 * exact_slope(1e-6) - exact_slope(2e-6)) / 3.0
    assert (gradient * point) @ direction == pytest.approx(expected, rel=1e-6)
