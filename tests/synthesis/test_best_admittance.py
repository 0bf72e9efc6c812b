"""The best positive-real admittance of a degree: known optima, and never above a network of that degree."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import sampled
from exact import admittance
from scipy.optimize import minimize
from strategies import random_network
from wang_su import paper_quarter_car

from inerter import (
    Damper,
    Inerter,
    Norm,
    RideComfort,
    Road,
    Spring,
    evaluate,
    free,
    is_positive_real,
    optimise,
    realise,
)
from inerter.errors import SynthesisError
from inerter.synthesis.best_admittance import _families, best_admittance

S = 1j * np.geomspace(0.5, 200.0, 60)
ROAD = RideComfort(Road(roughness=5e-7, speed=25.0))


def distance_to(network):
    """Mean square of the relative deviation from the admittance of a network, as an index."""
    wanted = network.admittance(S)

    def index(numerator, denominator):
        with np.errstate(all="ignore"):
            found = np.polyval(numerator, S) / np.polyval(denominator, S)
        return float(np.mean(abs(found / wanted - 1.0) ** 2))

    return index


@pytest.mark.parametrize("family", [family for degree in range(6) for family in _families(degree)], ids=repr)
def test_every_point_of_the_search_is_positive_real(family):
    rng = np.random.default_rng(family.size)
    for _ in range(5):
        n, d = family.polynomials(2.0 * rng.standard_normal(family.size), 1e3, 10.0, exact=True)
        network = realise(n, d)
        np.testing.assert_allclose(
            network.admittance(S + 1.0), np.polyval(n, S + 1.0) / np.polyval(d, S + 1.0), rtol=1e-8
        )
        quick, _ = family.polynomials(x := rng.standard_normal(family.size), 1e3, 10.0)
        np.testing.assert_allclose(quick, family.polynomials(x, 1e3, 10.0, exact=True)[0], rtol=1e-9, atol=1e-9)


FOUND = [
    (Damper(800.0), 0),
    (Damper(800.0) - Inerter(50.0), 1),
    (Spring(5e3) | Damper(800.0), 1),
    (Damper(800.0) | Inerter(50.0), 1),
    (Spring(5e3) | Damper(800.0) | Inerter(30.0), 2),
    (Spring(5e3) - (Damper(800.0) | Inerter(30.0)), 2),
]


@pytest.mark.parametrize(("network", "degree"), sampled(FOUND, [FOUND[1], FOUND[-1]]))
def test_an_admittance_of_the_degree_is_found(network, degree):
    found = best_admittance(distance_to(network), degree, damping=1e3, omega=10.0, starts=7)
    assert found.value < 1e-7
    np.testing.assert_allclose(found.realise().admittance(S), network.admittance(S), rtol=3e-3)


@pytest.mark.marathon
def test_no_network_of_a_degree_is_closer_than_the_best_admittance():
    """To random admittances of higher degree, each network with its best values from many starts."""
    rng = np.random.default_rng(2)
    layouts = [
        lambda k, c, b: Damper(c) - Inerter(b) | Spring(k),
        lambda k, c, b: Damper(c) | Inerter(b) - Spring(k),
        lambda k, c, b: Spring(k) - (Inerter(b) | Damper(c)),
        lambda k, c, b: Spring(k) | Damper(c) | Inerter(b),
        lambda k, c, b: Damper(c) - (Inerter(b) | Spring(k)),
        lambda k, c, b: Inerter(b) - (Damper(c) | Spring(k)),
    ]
    for _ in range(4):
        index = distance_to(random_network(rng, most=9))
        best = best_admittance(index, 2, damping=1e3, omega=10.0, starts=40)
        for layout in layouts:

            def of_values(x, layout=layout, index=index):
                n, d = admittance(layout(*np.exp(np.clip(x, -30.0, 30.0))))
                return index([float(c) for c in n[::-1]], [float(c) for c in d[::-1]])

            for _ in range(5):
                start = np.log([1e4, 1e3, 1e2]) + rng.standard_normal(3)
                value = minimize(of_values, start, method="Nelder-Mead").fun
                assert best.value <= value * (1.0 + 1e-6) + 1e-9


def car(strut):
    return paper_quarter_car(Spring(120e3) | strut)


def ride_comfort(numerator, denominator):
    try:
        return evaluate(car(realise(numerator, denominator)), ROAD, Norm()).value
    except SynthesisError:
        return np.nan


@pytest.mark.campaign
def test_the_best_admittance_of_degree_one_is_that_of_the_literature():
    """Wang and Su (2008), Table 1: the lowest J1 beside k = 120 kN/m is that of damper and inerter in series."""
    found = best_admittance(ride_comfort, 1, damping=3e3, omega=20.0, starts=5)
    assert found.value == pytest.approx(2.4281, abs=5e-5)
    values = {type(element): element.value for element in found.realise().elements()}
    assert values[Damper] == pytest.approx(7544.2, rel=1e-3)
    assert values[Inerter] == pytest.approx(366.52, rel=1e-3)


@pytest.mark.marathon
def test_no_layout_of_a_degree_rides_better_than_the_best_admittance():
    c, b, k = Damper(free(10.0, 1e6, "c")), Inerter(free(0.01, 1e5, "b")), Spring(free(1e3, 1e7, "k1"))
    best = [best_admittance(ride_comfort, degree, damping=3e3, omega=20.0, starts=14).value for degree in (1, 2)]
    layouts = [(1, c | b), (1, c - b), (1, c - k), (2, c | b | k), (2, k - (c | b)), (2, b - (c | k)), (2, c - (b | k))]
    for degree, layout in [*layouts, (2, c | b - k), (2, b | c - k), (2, k | c - b), (2, b - c - k)]:
        assert best[degree - 1] <= optimise(car(layout), ROAD, Norm(), seed=0).value * (1.0 + 1e-8)


@pytest.mark.campaign
def test_the_same_seed_gives_the_same_admittance():
    index = distance_to(Spring(5e3) - (Damper(800.0) | Inerter(30.0)))
    one, other = (best_admittance(index, 2, damping=1e3, omega=10.0, starts=4, seed=3) for _ in range(2))
    assert one == other
    assert one.n_starts == 7  # one of each family at least
    assert 1 <= one.n_converged <= 7
    assert is_positive_real(one.numerator, one.denominator)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"degree": -1}, "degree of an admittance must be a non-negative integer, got -1"),
        ({"degree": 1.5}, "got 1.5"),
        ({"starts": 0}, "starts must be a positive integer, got 0"),
        ({"damping": 0.0}, "typical damping must be a positive number of N s/m"),
        ({"omega": float("nan")}, "typical frequency must be a positive number of rad/s"),
        ({"index": lambda n, d: float("nan")}, "does not exist for any of"),
    ],
)
def test_wrong_requests(changes, message):
    given = {"index": lambda n, d: 1.0, "degree": 1, "damping": 1e3, "omega": 10.0} | changes
    with pytest.raises(SynthesisError, match=message):
        best_admittance(given.pop("index"), given.pop("degree"), **given)
