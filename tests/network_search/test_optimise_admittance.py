"""The best admittance in a vehicle: its index by other code, and never above a network of its degree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import sampled
from wang_su import ROAD
from wang_su import paper_quarter_car as car

import inerter as it
from inerter.network_search.admittance import _AdmittanceIndex, _compile_index
from inerter.network_search.plan import plan_search
from inerter.synthesis.best_admittance import _families

INDICES = {"J1": it.RideComfort(ROAD), "J3": it.TyreLoad(ROAD)}
ANY = it.any_network(1, dampers=(10.0, 1e6))
KINDS = {"springs": (1.0, 1e8), "dampers": (1.0, 1e7), "inerters": (1e-3, 1e5)}
STRUTS = {
    "beside a spring": lambda part: it.Spring(120e3) | part,
    "in series": lambda part: it.Spring(120e3) | it.Damper(3e3) - part,
    "alone": lambda part: part,
}


USES = it.Conditions([it.Condition(0.3), it.Condition(0.7, road={"speed": 30.0})])
PUSH = it.WhiteForce("sprung_force", 1.0)
HALF_CAR = it.HalfCar(
    sprung_mass=600.0,
    pitch_inertia=900.0,
    unsprung_mass_front=40.0,
    unsprung_mass_rear=40.0,
    tyre_stiffness_front=2e5,
    tyre_stiffness_rear=2e5,
    distance_front=1.2,
    distance_rear=1.4,
    front=it.Spring(2e4) | ANY,
    rear=it.Spring(4e4) | it.Damper(1500.0),
)


def of_car(index, strut=STRUTS["beside a spring"]):
    """The compiled index over the admittance of the free network."""
    return _AdmittanceIndex(_compile_index(plan_search(car(strut(ANY)), index, it.Norm())))


@pytest.mark.parametrize("strut", STRUTS.values(), ids=STRUTS)
@pytest.mark.parametrize("index", INDICES.values(), ids=INDICES)
def test_the_index_is_that_of_the_design_with_the_network(index, strut):
    compiled, rng = of_car(index, strut), np.random.default_rng(1)
    compared = 0
    for degree in range(4):
        for family in _families(degree):
            n, d = family.polynomials(rng.standard_normal(family.size), 3e3, 20.0, exact=True)
            found, estimate = compiled.value(n, d), it.evaluate(car(strut(it.realise(n, d))), index, it.Norm())
            if np.isfinite(estimate.value):
                assert found == pytest.approx(estimate.value, rel=1e-8)
                compared += 1
            else:
                assert found == np.inf
    assert compared >= 9


@pytest.mark.parametrize("strut", STRUTS.values(), ids=STRUTS)
@pytest.mark.parametrize("index", INDICES.values(), ids=INDICES)
def test_gradients_over_the_coefficients_are_those_of_differences(index, strut):
    compiled, rng = of_car(index, strut), np.random.default_rng(2)
    for family in [family for degree in range(5) for family in _families(degree)]:
        n, d = family.polynomials(0.7 * rng.standard_normal(family.size), 3e3, 20.0)
        value, *gradients = compiled.value_and_gradients(n, d)
        if value == np.inf:
            continue
        assert value == compiled.value(n, d)
        for which, (p, slopes) in enumerate(zip((n, d), gradients, strict=True)):
            for i in np.flatnonzero(p):
                ends = []
                for step in (-1e-4, 1e-4):
                    changed = [n.copy(), d.copy()]
                    changed[which][i] *= 1.0 + step
                    ends.append(compiled.value(*changed))
                assert slopes[i] * p[i] == pytest.approx((ends[1] - ends[0]) / 2e-4, rel=1e-4, abs=1e-5 * value)


@pytest.mark.parametrize("family", [family for degree in range(5) for family in _families(degree)], ids=repr)
def test_slopes_of_the_coefficients_are_those_of_differences(family):
    x, h = np.random.default_rng(3).standard_normal(family.size), 1e-5
    n, d, *slopes = family.with_slopes(x, 1.0, 1.0)
    for found, expected in zip((n, d), family.polynomials(x, 1.0, 1.0), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12)
    for i in range(family.size):
        above, below = (family.polynomials(x + sign * h * np.eye(family.size)[i], 1.0, 1.0) for sign in (1, -1))
        for slope, high, low in zip(slopes, above, below, strict=True):
            np.testing.assert_allclose(slope[i], (high - low) / (2 * h), rtol=1e-6, atol=1e-7 * abs(high).max())


def lowest(index, max_elements, degree, **options):
    """The lowest index of all networks with at most so many springs and inerters."""
    found = it.search(
        car(it.Spring(120e3) | it.any_network(max_elements, **KINDS, **options)), index, it.Norm(), seed=1
    )
    return min(one.value for one in found.ranking if one.topology.counts["k"] + one.topology.counts["b"] <= degree)


@pytest.mark.parametrize("index", INDICES.values(), ids=INDICES)
def test_the_best_admittance_of_degree_one_is_that_of_a_network_of_three_elements(index):
    """Every positive-real function of degree one is that of a spring or an inerter and two dampers."""
    best = it.optimise_admittance(car(it.Spring(120e3) | ANY), index, 1)
    assert best.degree == 1
    assert best.value == pytest.approx(lowest(index, 3, 1, springs_at_most=1, inerters_at_most=1), rel=1e-6)


@pytest.mark.parametrize("symbol", sampled(INDICES, kept=0))
def test_no_network_of_degree_two_is_better(symbol):
    index = INDICES[symbol]
    best = it.optimise_admittance(car(it.Spring(120e3) | ANY), index, 2)
    assert best.value <= lowest(index, 4, 2, springs_at_most=2, inerters_at_most=2) * (1.0 + 1e-9)
    assert best.status.ok
    assert best.estimate.value == pytest.approx(best.value, rel=1e-8)


@pytest.mark.parametrize(("symbol", "degree"), sampled([("J1", 2), ("J1", 3), ("J3", 2), ("J3", 3)], kept=0))
def test_no_network_of_five_elements_is_better(symbol, degree):
    index = INDICES[symbol]
    best = it.optimise_admittance(car(it.Spring(120e3) | ANY), index, degree)
    assert best.status.ok
    assert best.value <= lowest(index, 5, degree) * (1.0 + 1e-9)


def test_a_higher_degree_is_never_worse_and_a_seed_gives_one_result():
    vehicle = car(it.Spring(120e3) | ANY)
    several = [it.optimise_admittance(vehicle, INDICES["J3"], degree, starts=12, seed=4) for degree in (0, 1, 2, 2)]
    values = [one.value for one in several]
    assert values == sorted(values, reverse=True)
    assert (several[2].numerator, several[2].denominator) == (several[3].numerator, several[3].denominator)
    assert several[2].n_starts == 12
    assert it.is_positive_real(several[1].numerator, several[1].denominator)


def test_the_design_has_the_realised_network():
    best = it.optimise_admittance(car(it.Spring(120e3) | ANY), INDICES["J1"], 1, starts=10)
    n, d = best.numerator, best.denominator
    s = 3.0 + 20.0j
    assert best.network().admittance(s) == pytest.approx(np.polyval(n, s) / np.polyval(d, s), rel=1e-9)
    assert best.design == car(it.Spring(120e3) | best.network())
    assert best.unit == "m/s^2"


def test_a_half_car_under_a_random_force():
    index = it.RandomResponse({"sprung_velocity": 1.0, "pitch_velocity": 0.5}, PUSH)
    best = it.optimise_admittance(HALF_CAR, index, 1, starts=10)
    assert best.status.ok
    front = it.Spring(2e4) | it.Damper(it.free(1.0, 1e6, "c"))
    assert best.value <= it.optimise(replace(HALF_CAR, front=front), index, it.Norm(), seed=0).value * (1.0 + 1e-9)


def test_a_value_that_is_not_that_of_the_network_is_told():
    best = it.optimise_admittance(car(it.Spring(120e3) | ANY), INDICES["J1"], 1, starts=10)
    assert "differs from that of the design" in str(replace(best, value=best.value * 1.01).status)
    assert "has no network" in str(replace(best, numerator=(-1.0,), denominator=(1.0,)).status)


FREE = it.Spring(it.free(1e4, 1e6, "k")) | ANY
QUICK = {"degree": 1, "starts": 2}  # for what only the best admittance shows
REFUSED = {
    "no free network": (car(it.Spring(120e3)), INDICES["J1"], {}, "with one free network"),
    "two places": (car(it.Spring(120e3) | ANY | it.Damper(1.0) - ANY), INDICES["J1"], {}, "is in 2 places"),
    "free values": (car(FREE), INDICES["J1"], {}, r"other free values \(k\)"),
    "peak": (
        car(it.Spring(120e3) | ANY),
        it.PeakResponse("road_velocity", "sprung_displacement"),
        {},
        "is a peak gain",
    ),
    "conditions": (car(it.Spring(120e3) | ANY), USES.mean(INDICES["J1"]), {}, "computed from several indices"),
    "two axles": (HALF_CAR, INDICES["J1"], {}, "a road that reaches several axles"),
    "rigid link": (car(it.Spring(120e3) | ANY), it.SuspensionTravel(ROAD), QUICK, "with a rigid link"),
    "no network": (car(ANY), INDICES["J1"], QUICK, "with no network"),
    "infinite": (HALF_CAR, it.RandomResponse({"sprung_acceleration": 1.0}, PUSH), {"degree": 1}, "is infinite for all"),
    "degree": (car(it.Spring(120e3) | ANY), INDICES["J1"], {"degree": -1}, "from 0 to 10, got -1"),
    "half a degree": (car(it.Spring(120e3) | ANY), INDICES["J1"], {"degree": 1.5}, "got 1.5"),
    "starts": (car(it.Spring(120e3) | ANY), INDICES["J1"], {"starts": 0}, "`starts` must be"),
}


@pytest.mark.parametrize(("vehicle", "index", "options", "message"), REFUSED.values(), ids=REFUSED)
def test_requests_that_are_refused(vehicle, index, options, message):
    with pytest.raises(it.errors.DesignError, match=message):
        it.optimise_admittance(vehicle, index, **options)
