"""Compiled code against the exact norms, its gradients against differences, and its cache."""

import math
import shutil
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from campaigns import sampled
from exact import quarter_car_norms
from wang_su import ROAD, paper_half_car, paper_quarter_car

from inerter import (
    ApproximateLinear,
    Damper,
    ExpectedValue,
    Friction,
    Inerter,
    LoadCarrying,
    Norm,
    QuarterCar,
    RideComfort,
    Road,
    Spring,
    StatisticalLinearisation,
    StatusKind,
    TyreLoad,
    at_most,
    evaluate,
    evaluate_many,
    free,
    optimise,
)
from inerter.kernels import cache, gain, h2, harmonic, modal
from inerter.kernels.decorators import Kernel
from inerter.methods.objective import Differentiable

INDICES = (RideComfort(ROAD), TyreLoad(ROAD), LoadCarrying())
c, b = Damper(free(10.0, 1e6, "c")), Inerter(free(0.01, 1e5, "b"))
k, screw = Spring(120e3), Spring(1e6) | Damper(3200.0)
STRUTS = {
    "S1": k | c,
    "S2": k | c | b,
    "S3": k | c - b,
    "elastic S2": k | c | screw - b,
    "elastic S3": k | c - screw - b,
}
CARS = {
    **{f"quarter {name}": paper_quarter_car(strut) for name, strut in STRUTS.items()},
    **{f"half {name}": paper_half_car(strut, strut) for name, strut in STRUTS.items()},
}


def draw(car, count, seed, stiffest=1e4):
    """Designs over the whole bounds, but for dampers so hard for their inerter that rounding alone decides."""
    rng = np.random.default_rng(seed)
    names = list(car.free_values())
    bounds = np.log([(value.lower, value.upper) for value in car.free_values().values()])
    points = np.exp(bounds[:, 0] + rng.random((50 * count, len(names))) * (bounds[:, 1] - bounds[:, 0]))
    values = dict(zip(names, points.T, strict=True))
    gentle = values["c"] < stiffest * values["b"] if "b" in values else np.ones(len(points), dtype=bool)
    return {name: column[gentle][:count] for name, column in values.items()}


def draw_usual(car, count, seed):
    """Designs near those that are built, where a difference of fourth order has ten digits."""
    rng, usual = np.random.default_rng(seed), {"c": (500.0, 2e4), "b": (10.0, 1e3)}
    return np.column_stack([np.exp(rng.uniform(*np.log(usual[name]), count)) for name in car.free_values()])


@pytest.mark.parametrize(
    ("name", "conventions"),
    sampled(
        product(CARS, ["exact", "paper2008"]),
        [(name, "exact" if i % 2 else "paper2008") for i, name in enumerate(CARS)][::2],
        kept=5,
    ),
)
def test_many_designs_at_once_are_the_same_as_one_by_one(name, conventions):
    car, method = CARS[name], Norm(conventions)
    values = draw(car, 16, seed=len(name))
    many = evaluate_many(car, INDICES, values, method)
    for i, row in enumerate(many):
        design = design_at(car, values, i)
        alone = [evaluate(design, index, method).value for index in INDICES]
        np.testing.assert_allclose(row[:2], alone[:2], rtol=1e-8)
        np.testing.assert_allclose(row[2], alone[2], rtol=1e-6)


def design_at(car, values, i):
    """The car with the numbers in row i of its drawn values."""
    return car.with_values({key: float(column[i]) for key, column in values.items()})


@pytest.mark.parametrize("layout", ["S1", "S2", "S3"])
def test_many_designs_in_rational_arithmetic(layout):
    car = paper_quarter_car(STRUTS[layout])
    values = draw(car, 200, seed=11)
    many = evaluate_many(car, INDICES[:2], values, Norm())
    for i, row in enumerate(many):
        design = design_at(car, values, i)
        np.testing.assert_allclose(row, np.array(quarter_car_norms(design)) * ROAD.velocity_intensity, rtol=1e-8)


def test_many_designs_in_the_far_corner_of_the_bounds():
    """Every number that is given is right; where rounding decides there is none, and `evaluate` says so."""
    car = paper_quarter_car(STRUTS["S3"])
    values = draw(car, 200, seed=12, stiffest=np.inf)
    many = evaluate_many(car, INDICES[:2], values, Norm())
    known = np.all(np.isfinite(many), axis=1)
    assert known.mean() > 0.95
    for i, row in enumerate(many):
        design = design_at(car, values, i)
        if known[i]:
            np.testing.assert_allclose(row, np.array(quarter_car_norms(design)) * ROAD.velocity_intensity, rtol=1e-6)
        else:
            assert evaluate(design, INDICES[0], Norm()).status.kind is StatusKind.INACCURATE


def test_sharp_resonances_are_valued_as_one_by_one():
    """Where a resonance is narrower than the rounding of its pole, the exact norm answers, or says that it cannot."""
    car = paper_quarter_car(STRUTS["S3"])
    values = draw(car, 150, seed=13, stiffest=np.inf)
    many = evaluate_many(car, INDICES[2], values, Norm())[:, 0]
    for i, value in enumerate(many):
        one = evaluate(design_at(car, values, i), INDICES[2], Norm())
        if one.status.ok:
            assert value == pytest.approx(one.value, rel=1e-6)


def slopes(function, point):
    """Gradient by logarithms, from differences of fourth order."""
    step, gradient = 2e-3, np.empty(point.size)
    for i in range(point.size):
        shift = np.exp(step * np.arange(-2.0, 3.0)[:, None] * (np.arange(point.size) == i))
        f = function(point * shift)
        gradient[i] = (f[0] - 8.0 * f[1] + 8.0 * f[3] - f[4]) / (12.0 * step)
    return gradient / point


@pytest.mark.parametrize(
    ("name", "conventions"),
    sampled(
        product(CARS, ["exact", "paper2008"]),
        [(name, "exact" if i % 2 else "paper2008") for i, name in enumerate(CARS)],
    ),
)
def test_gradients_of_mean_squares(name, conventions):
    car = CARS[name]
    for index in INDICES[:2]:
        objective = Norm(conventions).objective(car, index)
        for point in draw_usual(car, 6, seed=5):
            value, gradient = objective.value_and_gradient(point)
            assert value == pytest.approx(objective.values(point[None])[0], rel=1e-12)
            np.testing.assert_allclose(
                gradient * point, slopes(objective.values, point) * point, rtol=0.0, atol=1e-8 * value
            )


METHODS = [Norm(), StatisticalLinearisation(), ExpectedValue(realisations=2), ApproximateLinear(realisations=2)]


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_values_and_gradients_of_every_method_are_those_of_the_formula(method):
    """J1^2 = (S/2) (c kt + k^2 (m + mu) / c) / m^2 on a road whose velocity has the two-sided density S."""
    mass, unsprung, tyre = 300.0, 40.0, 180e3
    strut = Spring(free(5e3, 80e3, "k")) | Damper(free(500.0, 2e4, "c"))
    objective = method.objective(QuarterCar(mass, unsprung, tyre, strut), RideComfort(ROAD))
    density = 4.0 * math.pi**2 * ROAD.roughness * ROAD.speed
    for k, c in ((20e3, 2e3), (60e3, 1e3), (8e3, 9e3)):
        rise = (
            0.5
            * density
            / mass**2
            * np.array([2.0 * k * (mass + unsprung) / c, tyre - (k / c) ** 2 * (mass + unsprung)])
        )
        value = math.sqrt(0.5 * density * (c * tyre + k**2 * (mass + unsprung) / c)) / mass
        point = np.array([k, c])
        assert objective.values(point[None])[0] == pytest.approx(
            value, rel=2e-4 if method.name == "approximate-linear" else 1e-6
        )
        if isinstance(objective, Differentiable):
            found, gradient = objective.value_and_gradient(point)
            assert found == pytest.approx(value, rel=1e-9)
            assert gradient == pytest.approx(rise / (2.0 * value), rel=1e-7)
    assert isinstance(objective, Differentiable) == (method.name in ("norm", "statistical-linearisation"))


@pytest.mark.parametrize("name", sampled(CARS, list(CARS)[::2]))
def test_gradients_of_gains_at_given_frequencies(name):
    car, omegas = CARS[name], np.array([0.0, 3.0, 17.0, 90.0])
    objective = Norm().objective(car, INDICES[2])
    for point in draw_usual(car, 6, seed=6):
        gains, gradients = objective.components(point, omegas)
        for i in range(omegas.size):

            def gain(points, i=i):
                return np.array([objective.components(p, omegas[i : i + 1])[0][0] for p in points])

            expected = slopes(gain, point) * point
            np.testing.assert_allclose(
                gradients[i] * point, expected, atol=1e-8 * max(gains[i], np.abs(expected).max())
            )


@pytest.mark.parametrize("name", sampled(CARS, list(CARS)[::2]))
def test_peaks_of_compiled_code_are_the_exact_ones(name):
    car = CARS[name]
    values = draw(car, 15, seed=7, stiffest=1e3)
    objective = Norm().objective(car, INDICES[2])
    for i, point in enumerate(np.column_stack([values[key] for key in car.free_values()])):
        design = design_at(car, values, i)
        expected = evaluate(design, INDICES[2], Norm()).peaks
        gains = np.sort(objective.components(point, objective.active(point))[0])[::-1]
        np.testing.assert_allclose(gains[: len(expected)], [peak.gain for peak in expected], rtol=1e-6)


def test_indices_asked_together_are_the_same_as_alone():
    car = CARS["half S3"]
    values = draw(car, 20, seed=8)
    indices = [*INDICES, TyreLoad(ROAD, high_pass=2.0), RideComfort(Road(1e-6, 40.0)), RideComfort(ROAD)]
    together = evaluate_many(car, indices, values, Norm())
    for j, index in enumerate(indices):
        np.testing.assert_allclose(together[:, j], evaluate_many(car, index, values, Norm())[:, 0], rtol=1e-12)


def test_one_number_serves_all_designs_and_the_order_of_names_does_not_matter():
    car = CARS["quarter S3"]
    row = evaluate_many(car, INDICES, {"b": [100.0, 100.0], "c": [2e3, 3e3]}, Norm())
    np.testing.assert_array_equal(evaluate_many(car, INDICES, {"c": [2e3, 3e3], "b": 100.0}, Norm()), row)
    assert evaluate_many(car, INDICES, {"c": 2e3, "b": 100.0}, Norm()).shape == (1, 3)
    assert evaluate_many(car, INDICES, {"c": [], "b": []}, Norm()).shape == (0, 3)


def test_a_value_without_effect_does_not_disturb_the_others():
    plain = evaluate_many(CARS["quarter S1"], INDICES, {"c": [2e3, 3e3]}, Norm())
    car = paper_quarter_car(k | Friction(free(1.0, 5.0, "f")) | c)
    np.testing.assert_array_equal(evaluate_many(car, INDICES, {"f": [1.0, 2.0], "c": [2e3, 3e3]}, Norm()), plain)


def test_what_has_no_finite_value_is_nan_and_does_not_hide_what_has():
    """The status of an infinite value is not ok, and so there is no number for it among many."""
    undamped = paper_quarter_car(Spring(free(1e4, 1e5, "k")))
    assert np.all(np.isnan(evaluate_many(undamped, INDICES[::2], {"k": [2e4, 5e4]}, Norm())))
    plain = paper_quarter_car(k | c).mechanism()
    (tyre,) = plain.tyres
    damped = replace(plain, tyres=(replace(tyre, network=tyre.network | Damper(50.0)),))  # white noise passes to J3
    comfort, load = evaluate_many(damped, INDICES[:2], {"c": [2e3, 5e3]}, Norm()).T
    assert np.all(np.isnan(load))
    alone = [evaluate(damped.with_values({"c": value}), INDICES[0], Norm()).value for value in (2e3, 5e3)]
    np.testing.assert_allclose(comfort, alone, rtol=1e-12)


def test_the_cache_folder_changes_with_every_source_that_a_module_rests_on(tmp_path):
    source = Path(cache.__file__).parent
    folder = tmp_path / "kernels"
    shutil.copytree(source, folder, ignore=shutil.ignore_patterns("__pycache__"))
    original = cache.source_hash(folder / "h2.py")
    assert original == cache.source_hash(source / "h2.py")
    for name, matters in {"h2": True, "dense": True, "lyapunov": True, "compiler": True, "gain": False}.items():
        path = folder / f"{name}.py"
        text = path.read_text()
        path.write_text(text + "\n")
        assert (cache.source_hash(folder / "h2.py") != original) == matters
        path.write_text(text)


def test_the_cache_folder_is_where_the_environment_says(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    module = Path(cache.__file__).with_name("h2.py")
    folder = cache.cache_folder.__wrapped__(module)
    assert folder.is_relative_to(tmp_path)
    assert cache.source_hash(module) in folder.name


@pytest.mark.parametrize("conventions", ["exact", "paper2008"])
def test_kernels_are_called_with_the_types_that_they_are_prepared_for(conventions):
    strut = k | c - (b | Friction(10.0))
    for car in (paper_quarter_car(strut), paper_half_car(strut, strut)):
        for index in (*INDICES[:2], LoadCarrying(amplitude=100.0), LoadCarrying(amplitude=100)):
            for method in (Norm(conventions), StatisticalLinearisation(conventions)):
                objective = method.objective(car, index)
                point = np.array([3000.0, 100.0])
                objective.values(np.array([point, 2.0 * point]))
                active = objective.active(point)
                if active is None:
                    objective.value_and_gradient(point)
                else:
                    objective.components(point, active)
    for kernel in (h2.norms, gain.peaks_of, gain.gains, harmonic.gains):
        assert len(kernel.ready().signatures) == 1, kernel.title


@pytest.mark.parametrize(
    ("car", "index", "conventions"),
    [
        ("quarter S3", RideComfort(ROAD), "exact"),
        ("quarter S3", RideComfort(ROAD, weighting="Wk"), "exact"),
        ("quarter S3", LoadCarrying(), "exact"),
        ("quarter S3", RideComfort(ROAD), "paper2008"),
        ("half S1", RideComfort(ROAD), "exact"),
        ("half S3", TyreLoad(ROAD), "exact"),
        ("half S3", LoadCarrying(), "exact"),
    ],
)
def test_a_search_calls_what_is_prepared_for_it(car, index, conventions, monkeypatch):
    """What it calls besides would be compiled in each process that meets it, and what it does not call, in vain."""
    vehicle, method, called = CARS[car], Norm(conventions), set()
    prepared = method.kernels(index.definition(vehicle.mechanism()), search=vehicle)
    call = Kernel.__call__
    monkeypatch.setattr(Kernel, "__call__", lambda self, *given: called.add(self) or call(self, *given))
    optimise(vehicle, index, method, seed=0, starts=4)
    assert called == set(prepared)


@pytest.mark.parametrize(("index", "other"), [(RideComfort(ROAD), TyreLoad(ROAD)), (TyreLoad(ROAD), LoadCarrying())])
def test_a_search_within_limits_calls_what_is_prepared_for_it(index, other, monkeypatch):
    vehicle, method, called = CARS["quarter S3"], Norm(), set()
    mechanism = vehicle.mechanism()
    definitions = [one.definition(mechanism) for one in (index, other)]
    prepared = {kernel for one in definitions for kernel in method.kernels(one, search=vehicle, limited=True)}
    best = evaluate(optimise(vehicle, index, method, seed=0, starts=4).design, other, method).value
    call = Kernel.__call__
    monkeypatch.setattr(Kernel, "__call__", lambda self, *given: called.add(self) or call(self, *given))
    optimise(vehicle, index, method, subject_to=[at_most(other, 0.97 * best)], seed=0, starts=4)
    assert modal.norms_by_modes in called  # far from the optimum covariances are not sure
    assert called <= prepared
