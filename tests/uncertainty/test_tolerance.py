"""Designs that scatter: against plain random numbers, closed forms, and searches of another kind."""

from __future__ import annotations

import dataclasses
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import numpy as np
import pytest
import scipy.optimize
from campaigns import sampled
from slopes import assert_slopes
from wang_su import J1, J3, J5, paper_quarter_car

import inerter as it
from inerter.errors import DesignError
from inerter.methods.composite_index import objective_of
from inerter.uncertainty.distributions import scatter_of
from inerter.uncertainty.tolerance import quantile_error

NORM = it.Norm()


def fixed(c=7544.2, b=366.5):
    return paper_quarter_car(it.Spring(1.2e5) | it.Damper(c) - it.Inerter(b))


def free():
    return paper_quarter_car(
        it.Spring(1.2e5) | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(it.free(1.0, 2e3, "b"))
    )


@pytest.mark.parametrize("distribution", ["uniform", "normal"])
def test_the_distribution_is_that_of_plain_random_numbers(distribution):
    spread = {"c": 0.3, "b": 0.2, "k": 0.1}
    found = it.tolerance_analysis(fixed(), J1, NORM, spread=spread, samples=1024, distribution=distribution)
    rng, count = np.random.default_rng(5), 40_000
    factors = {}
    for name, part in spread.items():
        if distribution == "uniform":
            factors[name] = 1.0 + part * rng.uniform(-1.0, 1.0, count)
        else:
            drawn = rng.normal(0.0, part / 3.0, 2 * count)
            factors[name] = 1.0 + drawn[np.abs(drawn) <= part][:count]
    own = {"c": 7544.2, "b": 366.5, "k": 1.2e5}
    car = paper_quarter_car(
        it.Spring(it.free(1e3, 1e6, "k")) | it.Damper(it.free(1.0, 1e5, "c")) - it.Inerter(it.free(1.0, 1e4, "b"))
    )
    values = it.evaluate_many(car, J1, {n: own[n] * f for n, f in factors.items()}, NORM)[:, 0]
    error = values.std() / np.sqrt(count)
    assert abs(found.mean - values.mean()) <= 5.0 * error
    assert found.standard_deviation == pytest.approx(values.std(), rel=0.02)
    for share in (0.05, 0.5, 0.95):
        assert found.quantile(share) == pytest.approx(np.quantile(values, share), abs=20.0 * error)
    assert found.worst >= values.max() * (1.0 - 1e-9)
    assert found.nominal.value == it.evaluate(fixed(), J1, NORM).value
    worst = fixed(found.worst_values["c"], found.worst_values["b"])
    worst = dataclasses.replace(worst, strut=it.Spring(found.worst_values["k"]) | worst.strut.parts[1])
    assert it.evaluate(worst, J1, NORM).value == pytest.approx(found.worst, rel=1e-9)


def test_effects_are_those_of_a_product():
    """The static stiffness of springs in series and parallel against exact integrals of variances."""
    parts = {"k1": 0.2, "k2": 0.1}
    strut = it.Spring(1e5, "k1") | it.Spring(2e5, "k2") | it.Damper(3e3)
    found = it.tolerance_analysis(
        paper_quarter_car(strut), it.static_stiffness("strut"), NORM, spread=parts, samples=4096
    )
    variances = {"k1": (1e5 * 0.2) ** 2 / 3.0, "k2": (2e5 * 0.1) ** 2 / 3.0}
    whole = sum(variances.values())
    for name, variance in variances.items():
        assert found.first_order[name] == pytest.approx(variance / whole, abs=0.01)
        assert found.total_order[name] == pytest.approx(variance / whole, abs=0.01)
    assert found.mean == pytest.approx(3e5, rel=1e-4)
    assert found.standard_deviation == pytest.approx(np.sqrt(whole), rel=5e-3)
    assert found.worst == pytest.approx(1.2e5 + 2.2e5, rel=1e-12)


def found_again(executor=None):
    spread = {"c": 0.1, "sprung_mass": 0.1}
    return it.tolerance_analysis(fixed(), J1, NORM, spread=spread, samples=16, executor=executor)


@pytest.mark.parametrize("names", [("k", "b"), ("k",)])
def test_rounding_is_due_to_no_value(names: tuple[str, ...]) -> None:
    """With spring, damper and inerter in parallel the mean square of the travel is S (ms + mu) / (2 c)."""
    car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.Damper(9000.0) | it.Inerter(60.0))
    travel = it.SuspensionTravel(it.Road(5e-7, 25.0))
    found = it.tolerance_analysis(car, travel, it.Norm(), spread=dict.fromkeys(names, 0.1), samples=64)
    assert found.status.ok
    assert found.mean == pytest.approx(2.0 * np.pi * np.sqrt(5e-7 * 25.0 * (250.0 + 35.0) / (2.0 * 9000.0)), rel=1e-9)
    assert found.first_order == found.total_order == dict.fromkeys(names, 0.0)


def test_quantities_of_the_vehicle_scatter_one_by_one():
    found = it.tolerance_analysis(fixed(), J1, NORM, spread={"sprung_mass": 0.1, "c": 0.1}, samples=16)
    top = found.worst_values
    car = dataclasses.replace(fixed(c=top["c"]), sprung_mass=top["sprung_mass"])
    assert it.evaluate(car, J1, NORM).value == pytest.approx(found.worst, rel=1e-9)
    alike = it.tolerance_analysis(fixed(), J1, NORM, spread={"c": 0.1, "k": 0.1}, samples=16)
    mechanism = it.tolerance_analysis(fixed().mechanism(), J1, NORM, spread={"c": 0.1, "sprung": 0.1}, samples=16)
    assert mechanism.values == pytest.approx(found_again().values, rel=1e-9)
    strut = it.tolerance_analysis(fixed().mechanism(), J1, NORM, spread={"c": 0.1, "k": 0.1}, samples=16)
    assert strut.values == pytest.approx(alike.values, rel=1e-9)
    with ThreadPoolExecutor(2) as pool:
        assert np.array_equal(found_again(pool).values, found_again().values)


@pytest.mark.parametrize("others", [{}, {"sprung_mass": 0.01}])
def test_elements_of_one_name_and_several_values_do_not_scatter_as_one(others):
    axle = {"unsprung_mass": 40.0, "tyre_stiffness": 2e5}
    car = it.HalfCar(
        sprung_mass=600.0,
        pitch_inertia=900.0,
        distance_front=1.2,
        distance_rear=1.4,
        **{f"{name}_{where}": value for name, value in axle.items() for where in ("front", "rear")},
        front=it.Spring(2e4, "k") | it.Damper(1500.0),
        rear=it.Spring(4e4, "k") | it.Damper(1500.0),
    )
    with pytest.raises(DesignError, match="is ambiguous"):
        it.tolerance_analysis(car, J1, NORM, spread={"k": 0.01, **others}, samples=16)


def test_a_design_whose_index_is_not_known_somewhere():
    car = paper_quarter_car(it.Spring(1.2e5) | it.Damper(it.free(1.0, 2.0, "c")))
    found = it.tolerance_analysis(car.with_values({"c": 1.5}), J1, NORM, spread={"c": 0.1}, samples=16)
    assert found.status.ok
    friction = paper_quarter_car(it.Spring(1.2e5) | it.Friction(1e4) - it.Spring(1e5) | it.Damper(1e-9))
    lost = it.tolerance_analysis(friction, J1, it.StatisticalLinearisation(), spread={"f": 0.5}, samples=16)
    assert lost.status.ok == bool(np.isfinite(lost.mean))
    assert np.isfinite(lost.worst) == lost.status.ok


def test_a_distribution_of_which_an_extreme_is_not_known_is_not_known():
    """Linearisation is ok for all designs of the sample itself, and inaccurate at some corners of the tolerances."""
    strut = it.Spring(120e3) | it.Damper(7353, name="c") - (it.Inerter(328.72) | it.Friction(200.0, name="f"))
    found = it.tolerance_analysis(
        paper_quarter_car(strut), J1, it.StatisticalLinearisation(), spread={"f": 0.1, "c": 0.1}, samples=16
    )
    assert found.status.kind is it.StatusKind.FAILED
    numbers = (found.mean, found.standard_deviation, found.worst, found.quantile(0.95))
    assert np.isnan([*numbers, *found.total_order.values()]).all()


@pytest.mark.parametrize("index", [J1, J3])
def test_gradients_of_a_quantile(index):
    of = it.Quantile(index, scatter_of({"c": 0.3, "b": 0.2, "k": 0.1}, "uniform"), samples=64)
    objective, point = objective_of(free(), of, NORM), np.array([6e3, 300.0])
    value, gradient = objective.value_and_gradient(point)
    assert value == pytest.approx(it.evaluate(free().with_values({"c": 6e3, "b": 300.0}), of, NORM).value, rel=1e-9)
    assert_slopes(objective, point, gradient, abs=1e-5 * value)


@pytest.mark.campaign
def test_the_robust_design_is_best_at_its_quantile():
    spread = {"c": 0.4, "b": 0.4}
    found = it.optimise_robust(free(), J1, NORM, spread=spread, samples=32)
    of = it.Quantile(J1, scatter_of(spread, "uniform"), samples=32)

    def at(x):
        return it.evaluate(free().with_values(dict(zip(("c", "b"), np.exp(x).tolist(), strict=True))), of, NORM).value

    other = scipy.optimize.minimize(
        at, np.log([9e3, 300.0]), method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-8, "maxfev": 60}
    )
    assert at(np.log([found.parameters["c"], found.parameters["b"]])) <= other.fun * (1.0 + 1e-5)
    best = it.optimise(free(), J1, NORM)
    worse, robust = (
        it.tolerance_analysis(design, J1, NORM, spread=spread, samples=256).quantile(0.95)
        for design in (best.design, found.design)
    )
    assert robust < worse
    assert best.value < found.value


def test_the_quantile_is_that_of_a_known_distribution():
    """A stiffness that is evenly spread between 0.8 and 1.2 of its value has its 95 % quantile at 1.18."""
    of = it.Quantile(it.static_stiffness("strut"), scatter_of({"k": 0.2}, "uniform"), samples=1024)
    found = it.evaluate(paper_quarter_car(it.Spring(1e5) | it.Damper(1e3)), of, NORM)
    assert found.value == pytest.approx(1.18e5, rel=1e-3)


def made_up():
    """A strut whose second spring makes up 100 kN/m with the first, and whose second damper is half the first."""
    k1, k2 = it.Spring(it.free(1.1e5, 1e6, "k1")), it.Spring(1.0 / (1.0 / 1e5 - 1.0 / it.tied("k1")), "k2")
    first, second = it.Damper(it.free(100.0, 1e5, "c")), it.Damper(it.tied("c", 0.5), "c2")
    return paper_quarter_car((k1 - k2) | first - it.Inerter(300.0) | second)


@pytest.mark.parametrize("spread", [{"c": 0.3, "k1": 0.2}, {"c": 0.3, "c2": 0.2, "k2": 0.1}, {"k2": 0.3}])
def test_what_is_tied_follows_in_the_design_and_scatters_by_itself(spread):
    """Quantiles of both ways against plain random numbers, each part written as a number."""
    at, rng, count = {"k1": 2.5e5, "c": 5e3}, np.random.default_rng(3), 4000
    design = made_up().with_values(at)
    parts = {**at, "k2": 1.0 / (1.0 / 1e5 - 1.0 / at["k1"]), "c2": 0.5 * at["c"]}
    made = {n: parts[n] * (1.0 + spread.get(n, 0.0) * rng.uniform(-1.0, 1.0, count)) for n in parts}
    k1, k2 = (it.Spring(it.free(1.0, 1e7, name)) for name in ("k1", "k2"))
    c, c2 = (it.Damper(it.free(1.0, 1e6, name)) for name in ("c", "c2"))
    loose = paper_quarter_car((k1 - k2) | c - it.Inerter(300.0) | c2)
    values = it.evaluate_many(loose, J3, made, NORM)[:, 0]
    found = it.tolerance_analysis(design, J3, NORM, spread=spread, samples=1024)
    of = it.Quantile(J3, scatter_of(spread, "uniform"), samples=1024)
    objective, point = objective_of(made_up(), of, NORM), np.array([at[name] for name in made_up().free_values()])
    near = 0.1 * values.std()
    assert found.mean == pytest.approx(values.mean(), abs=near)
    assert found.standard_deviation == pytest.approx(values.std(), rel=0.05)
    for quantile in (
        found.quantile(0.95),
        it.evaluate(design, of, NORM).value,
        float(objective.values(point[None])[0]),
    ):
        assert quantile == pytest.approx(np.quantile(values, 0.95), abs=near)
    objective = objective_of(made_up(), it.Quantile(J3, of.scatter, samples=32), NORM)  # whose samples keep their ranks
    value, gradient = objective.value_and_gradient(point)
    assert_slopes(objective, point, gradient, abs=1e-5 * value)


def test_two_parts_of_one_free_value_scatter_by_their_names():
    """Dampers side by side, both c: the sum of two that scatter scatters less than twice one of them."""
    pair = it.Damper(it.free(100.0, 1e5, "c"), "left") | it.Damper(it.free(100.0, 1e5, "c"), "right")
    car, one = paper_quarter_car(it.Spring(1.2e5) | pair), paper_quarter_car(it.Spring(1.2e5) | it.Damper(1e4, "c"))
    scattered, alone = scatter_of({"left": 0.3, "right": 0.3}, "uniform"), scatter_of({"c": 0.3}, "uniform")
    here = it.evaluate(car.with_values({"c": 5e3}), it.Quantile(J1, scattered, samples=256), NORM).value
    objective = objective_of(car, it.Quantile(J1, scattered, samples=256), NORM)
    assert float(objective.values(np.array([[5e3]]))[0]) == pytest.approx(here, rel=1e-9)
    assert here < it.evaluate(one, it.Quantile(J1, alone, samples=256), NORM).value


SCATTER = {"index": J1, "method": NORM, "spread": {"c": 0.1}}


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"spread": {}}, "spread is required"),
        ({"spread": {"c": 0.0}}, "between 0 and 1"),
        ({"spread": {"c": 1.0}}, "between 0 and 1"),
        ({"spread": {"c": "10 %"}}, "between 0 and 1"),
        ({"spread": ["c"]}, "must map names"),
        ({"spread": {"d": 0.1}}, "unknown value 'd'"),
        ({"samples": 100}, "power of two"),
        ({"samples": 8}, "power of two"),
        ({"seed": -1}, "seed must be a non-negative integer"),
        ({"distribution": "cauchy"}, "'uniform' or 'normal'"),
        ({"design": free()}, "still has free values"),
        ({"index": "J1"}, "Expected an index"),
    ],
)
def test_tolerances_that_cannot_be(given, said):
    with pytest.raises(it.InerterError, match=said):
        it.tolerance_analysis(**{"design": fixed(), **SCATTER, **given})


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"spread": {"sprung_mass": 0.1}}, "element values only"),
        ({"quantile": 1.0}, "between 0 and 1"),
        ({"samples": 15}, "power of two"),
        ({"vehicle": fixed()}, "no free value to optimise"),
    ],
)
def test_robust_designs_that_cannot_be(given, said):
    with pytest.raises(it.InerterError, match=said):
        it.optimise_robust(**{"vehicle": free(), **SCATTER, **given})


def test_shares_of_a_quantile():
    found = it.tolerance_analysis(fixed(), J1, NORM, spread={"c": 0.1}, samples=16)
    assert found.quantile(0.0) == found.values.min()
    with pytest.raises(it.InerterError, match="between 0 and 1"):
        found.quantile(1.5)
    with pytest.raises(it.InerterError, match="is 0, so it cannot have a relative tolerance"):
        it.tolerance_analysis(
            paper_quarter_car(it.Spring(1e5) | it.Damper(1e3) | it.Friction(0.0)),
            J1,
            NORM,
            spread={"f": 0.1},
            samples=16,
        )


@pytest.mark.parametrize(("count", "share"), [(64, 0.95), (256, 0.95), (256, 0.5), (1024, 0.99)])
def test_the_interval_of_a_quantile_covers(count, share):
    """At least 95 % of 400 random samples, within three binomial standard errors."""
    rng, true = np.random.default_rng(count), -np.log(1.0 - share)
    inside = 0
    for _ in range(400):
        error, (low, high) = quantile_error(rng.exponential(1.0, count), share)
        assert error == pytest.approx((high - low) / 2.0 / 1.959964, rel=1e-6)
        inside += low <= true <= high
    assert inside >= 0.95 * 400 - 3.0 * np.sqrt(400 * 0.05 * 0.95)


@pytest.mark.parametrize("distribution", ["uniform", "normal"])
def test_errors_of_mean_and_standard_deviation_are_those_of_resampling(distribution: str) -> None:
    """By bootstrap, within three times the error of 400 resamples; a Sobol' sequence scatters less than that."""
    spread, seeds = {"c": 0.3, "b": 0.2}, range(8)
    several = [
        it.tolerance_analysis(fixed(), J1, NORM, spread=spread, samples=128, seed=seed, distribution=distribution)
        for seed in seeds
    ]
    found, rng = several[0], np.random.default_rng(1)
    drawn = rng.choice(found.values, (400, found.values.size))
    resampled = {"mean": drawn.mean(axis=1).std(), "standard_deviation": drawn.std(axis=1, ddof=1).std()}
    assert found.standard_errors == pytest.approx(resampled, rel=3.0 / np.sqrt(2.0 * 400))
    for name, error in found.standard_errors.items():
        assert np.std([getattr(one, name) for one in several]) < error


@pytest.mark.campaign
def test_a_quantile_of_values_that_scatter_is_no_more_certain_than_they_are():
    """Where hardly anything varies, a quantile is the value itself, with its errors by random roads."""
    car = paper_quarter_car(it.Spring(120e3, "k") | it.Damper(4e3, "c") | it.Friction(200.0))
    method = it.ExpectedValue(2)
    value, spread = it.evaluate(car, J1, method), {"c": 1e-6}
    quantile = it.evaluate(car, it.Quantile(J1, scatter_of(spread, "uniform"), samples=16), method)
    analysed = it.tolerance_analysis(car, J1, method, spread=spread, samples=16).quantile_estimate(0.95)
    for found in (quantile, analysed):
        assert found.value == pytest.approx(value.value, rel=1e-5)
        assert found.standard_error == pytest.approx(value.standard_error, rel=1e-2)
        assert found.interval == pytest.approx(value.interval, rel=1e-4)
    assert quantile.realisations == 2  # roads, on which a comparison or a break-even value simulates both designs


def test_a_quantile_on_a_measured_road_has_its_error():
    car = paper_quarter_car(it.Spring(120e3, "k") | it.Damper(4e3, "c"))
    heights = np.cumsum(np.random.default_rng(0).normal(0.0, 1e-3, 4096))
    spectrum = it.road_spectrum(it.Profile(0.1 * np.arange(4096), heights))
    comfort = it.RideComfort(it.measured_road(spectrum, speed=25.0))
    value = it.evaluate(car, comfort, NORM)
    quantile = it.evaluate(car, it.Quantile(comfort, scatter_of({"c": 0.1}, "uniform"), samples=16), NORM)
    assert value.error_bound > 1e-3
    assert quantile.error_bound >= value.error_bound


@pytest.mark.parametrize("seed", sampled(range(3), kept=1))
def test_a_robust_quantile_is_that_of_its_design(seed):
    """By a sample of its own: within its interval of that by 4096 samples, not below as that of the search."""
    spread = {"c": 0.4, "b": 0.4}
    found = it.optimise_robust(free(), J1, NORM, spread=spread, samples=64, seed=seed)
    truth = it.tolerance_analysis(found.design, J1, NORM, spread=spread, samples=4096, seed=99).quantile_estimate(0.95)
    low, high = found.estimate.interval
    assert low <= truth.value <= high
    assert truth.interval[0] < truth.value < truth.interval[1]
    assert truth.standard_error < found.estimate.standard_error


SCATTERED = {"elements": {"k": 0.05, "c": 0.15}, "a mass": {"sprung_mass": 0.05}}


@pytest.mark.parametrize(
    ("over", "scattered"),
    sampled(product(["one condition", "mean", "worst"], SCATTERED), often=[("worst", "elements")], kept=0),
)
def test_designs_beyond_double_precision_are_sampled_less_and_said_so(over: str, scattered: str):
    """Masses 44 decades apart: each value takes thousands of times longer, so 256 are taken, of the same sample."""
    strut = it.Spring(1.07503e16, name="k") | it.Damper(2.38633e-10, name="c")
    car = it.QuarterCar(sprung_mass=5.24436e-23, unsprung_mass=2.87718e21, tyre_stiffness=77555.9e3, strut=strut)
    index = it.RideComfort(it.Road(roughness=7464.31, speed=2.77159e-22))
    use = it.Conditions([it.Condition(0.3), it.Condition(0.7, road={"speed": 3e-22})])
    if over != "one condition":
        index = getattr(use, over)(index)
    found = it.tolerance_analysis(car, index, NORM, spread=SCATTERED[scattered], seed=0)
    assert found.values.size == 2 * 256
    assert str(found.status.kind) == "inaccurate"
    assert "256 of 4096 designs of the sample" in found.status.message


@pytest.mark.parametrize(
    "spread",
    [{"k": 0.05, "c": 0.1}, pytest.param({"sprung_mass": 0.05}, marks=pytest.mark.campaign)],
    ids=["elements", "a mass"],
)
def test_designs_within_double_precision_keep_their_sample_over_conditions(spread: dict[str, float]):
    car = fixed()
    use = it.Conditions([it.Condition(0.3), it.Condition(0.7, road={"speed": 30.0})])
    found = it.tolerance_analysis(car, use.mean(J1), NORM, spread=spread, samples=512)
    assert found.values.size == 2 * 512
    assert found.status.ok


@pytest.mark.parametrize("worst", [False, True], ids=["mean", "worst"])
@pytest.mark.parametrize("name", ["k", "sprung_mass"])
def test_a_value_that_a_condition_changes_scatters_about_what_it_is_there(name: str, worst: bool) -> None:
    """The sample is that of the changed designs, taken together: their values have the same tolerance."""
    numbers = {"k": 60e3, "sprung_mass": 260.0}
    use = it.Conditions([it.Condition(1.0), it.Condition(3.0, vehicle={name: numbers[name]})])
    changed = (
        paper_quarter_car(it.Spring(60e3) | fixed().strut.parts[1])
        if name == "k"
        else dataclasses.replace(fixed(), sprung_mass=260.0)
    )
    asked = {"method": NORM, "spread": {name: 0.1, "c": 0.05}, "samples": 16, "seed": 3}
    found = it.tolerance_analysis(fixed(), (use.worst if worst else use.mean)(J1), **asked)
    first, second = (it.tolerance_analysis(car, J1, **asked).values for car in (fixed(), changed))
    expected = np.maximum(first, second) if worst else 0.25 * first + 0.75 * second
    assert found.values == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("number", "name"), [("k", "k"), ("c", "c"), ("valve", "x")])
def test_a_search_refuses_the_tolerance_of_a_value_that_a_condition_changes(number: str, name: str) -> None:
    valve = it.Damper(it.free(100.0, 1e4, "x"), "valve")
    car = paper_quarter_car(it.Spring(1.2e5) | valve | it.Damper(it.free(100.0, 1e5, "c")) - it.Inerter(300.0))
    use = it.Conditions([it.Condition(1.0), it.Condition(1.0, vehicle={number: 6e3})])
    with pytest.raises(DesignError, match=f"that a condition changes, '{number}'"):
        it.optimise_robust(car, use.mean(J1), NORM, spread={name: 0.1}, samples=16)


def rubbing(**values: float) -> it.QuarterCar:
    """A friction beside an inerter, and a damper that friction alone loads."""
    inside = it.Inerter(50.0) - (it.Spring(1e6) | it.Damper(values.get("c2", 300.0), "c2") | it.Friction(20.0, "f"))
    strut = it.Spring(22e3) | it.Damper(1500.0, "c") | inside | it.Damper(900.0, "d") - it.Friction(30.0, "g")
    return it.QuarterCar(250.0, 35.0, 150e3, strut)


@pytest.mark.parametrize(
    ("spread", "unseen"),
    [
        ({"c": 0.1}, ""),
        ({"c": 0.1, "f": 0.2}, "of f;"),
        ({"d": 0.1, "c": 0.1}, "of d;"),
        ({"f": 0.1, "g": 0.1}, "f and g"),
    ],
)
def test_what_linear_analysis_leaves_out_does_not_scatter_in_silence(spread: dict[str, float], unseen: str) -> None:
    """The friction itself, and a damper in series with it, which carries no force without it."""
    found = it.tolerance_analysis(rubbing(), J1, it.Norm(), spread=spread, samples=64)
    quantile = it.evaluate(rubbing(), it.Quantile(J1, scatter_of(spread, "uniform"), samples=64), it.Norm())
    assert found.status.ok == (not unseen)
    assert unseen in found.status.message
    assert quantile.status.ok == (not {"f", "g"} & set(spread))


@pytest.mark.campaign
def light_car(friction: float) -> it.QuarterCar:
    """A light car with a parallel inerter whose nut has friction."""
    strut = it.Spring(15e3) | it.Damper(299.7, name="c") | it.Inerter(2.08) | it.Friction(friction, name="f")
    return it.QuarterCar(62.0, 11.5, 105e3, strut)


def test_a_scatter_within_the_errors_of_the_values_is_uncertain() -> None:
    """Nearly at its optimum: the index hardly changes with the values."""
    comfort, method = it.RideComfort(it.Road(3.2e-7, 80 / 3.6)), it.StatisticalLinearisation()
    found = it.tolerance_analysis(light_car(15.0), comfort, method, spread={"c": 0.15, "f": 0.3}, samples=256)
    assert found.nominal.status.ok
    assert found.nominal.error_bound * found.mean > found.standard_deviation > 0.0
    assert "more than they scatter" in found.status.message
    wide = it.tolerance_analysis(light_car(15.0), comfort, method, spread={"c": 0.5, "f": 0.1}, samples=256)
    assert wide.nominal.error_bound * wide.mean < wide.standard_deviation
    assert wide.status.ok
    linear = it.tolerance_analysis(light_car(15.0), comfort, it.Norm(), spread={"c": 0.15}, samples=256)
    assert linear.status.ok


@pytest.mark.campaign
def test_linearised_friction_may_scatter_several_times_less_than_simulated_friction() -> None:
    """Which the bound of the values covers, and nothing else does."""
    comfort = it.RideComfort(it.Road(3.2e-7, 80 / 3.6))

    def change(method: it.Method) -> float:
        values = [it.evaluate(light_car(f), comfort, method).value for f in (10.5, 19.5)]
        return abs(values[1] - values[0])

    linear, simulated = change(it.StatisticalLinearisation()), change(it.ExpectedValue(realisations=8, seed=1))
    bound = it.evaluate(light_car(15.0), comfort, it.StatisticalLinearisation()).error_bound
    assert simulated > 3.0 * linear
    assert simulated < 2.0 * bound * it.evaluate(light_car(15.0), comfort, it.StatisticalLinearisation()).value


def test_a_method_that_simulates_sees_friction_scatter() -> None:
    method = it.ExpectedValue(realisations=2, seed=1)
    found = it.tolerance_analysis(rubbing(), J1, method, spread={"f": 0.5}, samples=16)
    assert found.status.ok
    assert found.standard_deviation > 0.0


def test_a_value_without_effect_in_a_linear_design_is_no_fault() -> None:
    """Where damping is high, load carrying is that of the springs at rest."""
    car = it.QuarterCar(250.0, 35.0, 150e3, it.Spring(22e3, "k") | it.Damper(2e4, "c"))
    found = it.tolerance_analysis(car, J5, NORM, spread={"c": 0.1, "k": 0.1}, samples=16)
    assert found.status.ok
    assert found.total_order["c"] == pytest.approx(0.0, abs=1e-6)
