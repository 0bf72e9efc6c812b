"""Tuned mass dampers against the closed forms of the literature.

All with primary mass and stiffness 1; mu is the mass of the absorber, nu and zeta its frequency and damping ratio, so
that its stiffness is mu nu^2 and its damping 2 zeta mu nu. An inerter of inertance beta to the ground gives the
absorber the inertia mu + beta: under a force on the primary mass, which does not know the ground, nothing else changes.
"""

from __future__ import annotations

from fractions import Fraction
from math import sqrt

import numpy as np
import pytest
from wang_su import J1

import inerter as it
from inerter.errors import MechanismError

MASSES = [(0.02, 0.0), (0.1, 0.0), (0.1, 0.05), (0.03, 0.4), (0.5, 0.0)]  # mu, beta


def absorber(mu: float, beta: float, k: float | it.Free, c: float | it.Free, damping: float = 0.0) -> it.Absorber:
    mount = it.Spring(k) | it.Damper(c)
    return it.Absorber(1.0, 1.0, mu, mount, it.Inerter(beta) if beta else None, damping)


def peak_and_parameters(mu: float) -> tuple[float, float, float]:
    """The least largest gain from force to displacement, and the stiffness and damping that have it.

    Source: Nishihara and Asami (2002), the exact solution; Den Hartog's of fixed points is near it. At the optimum both
    peaks are equally high, so that |x/F|^2 = h^2 has two double roots in omega^2: see the test of just that.
    """
    root = sqrt(4.0 + 3.0 * mu)
    nu = 2.0 / (1.0 + mu)
    nu *= sqrt(
        2.0 * (16.0 + 23.0 * mu + 9.0 * mu**2 + 2.0 * (2.0 + mu) * root) / 3.0 / (64.0 + 80.0 * mu + 27.0 * mu**2)
    )
    zeta = 0.25 * sqrt((8.0 + 9.0 * mu - 4.0 * root) / (1.0 + mu))
    inside = (8.0 + 9.0 * mu) ** 2 * (16.0 + 9.0 * mu) - 128.0 * root**3
    return sqrt(inside / (3.0 * (32.0 + 27.0 * mu))) / (3.0 * mu), mu * nu**2, 2.0 * zeta * mu * nu


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_the_largest_gain_of_the_exact_optimum(mu: float, beta: float) -> None:
    h, k, c = peak_and_parameters(mu + beta)
    found = it.evaluate(absorber(mu, beta, k, c), it.LoadCarrying(), it.Norm())
    assert found.value == pytest.approx(h, rel=1e-8)
    assert len(found.peaks) == 2
    assert [peak.gain for peak in found.peaks] == pytest.approx([h, h], rel=1e-8)


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_at_the_exact_optimum_two_peaks_are_double_roots(mu: float, beta: float) -> None:
    """The closed form by itself: with x = omega^2, D(x) - N(x) / h^2 is the square of a quadratic."""
    h, k, c = peak_and_parameters(mu + beta)
    m, x = mu + beta, np.polynomial.Polynomial([0.0, 1.0])
    numerator = (k - m * x) ** 2 + c**2 * x
    denominator = ((1.0 - x) * (k - m * x) - k * m * x) ** 2 + c**2 * x * (1.0 - x - m * x) ** 2
    roots = np.sort_complex((denominator - numerator / h**2).roots())
    np.testing.assert_allclose(roots[::2], roots[1::2], rtol=1e-5)  # double roots, to the root of the rounding
    assert np.abs(roots.imag).max() < 1e-5


def assert_best(mu: float, beta: float, k: float, c: float, index: it.PerformanceIndex, value: float) -> None:
    """The search finds this stiffness and damping, and this value."""
    free = absorber(mu, beta, it.free(0.1 * k, 10.0 * k), it.free(0.1 * c, 10.0 * c))
    best = it.optimise(free, index, it.Norm(), seed=0)
    assert best.value == pytest.approx(value, rel=1e-8)
    assert best.parameters == pytest.approx({"k": k, "c": c}, rel=1e-5)


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_the_search_finds_the_exact_optimum(mu: float, beta: float) -> None:
    h, k, c = peak_and_parameters(mu + beta)
    assert_best(mu, beta, k, c, it.LoadCarrying(), h)


def mean_square(mu: float, beta: float, k: float, c: float, on_absorber: float) -> float:
    """The mean square of the primary displacement under white noise of two-sided density 1 per Hz.

    The force is 1 on the primary mass and `on_absorber` on the other. By the integral of Crandall and Mark (1963) for a
    transfer function of fourth order, in exact fractions.
    """
    m, k_, c_, f = Fraction(mu) + Fraction(beta), Fraction(k), Fraction(c), Fraction(on_absorber)
    a4, a3, a2, a1, a0 = m, c_ * (1 + m), k_ + m * (1 + k_), c_, k_  # (s^2 + 1 + Z) (m s^2 + Z) - Z^2, Z = c s + k
    b2, b1, b0 = m, c_ * (1 + f), k_ * (1 + f)
    top = b0**2 / a0 * (a2 * a3 - a1 * a4) + a3 * (b1**2 - 2 * b0 * b2) + a1 * b2**2
    return float(top / (2 * (a1 * (a2 * a3 - a1 * a4) - a0 * a3**2)))  # pi / (2 pi): per Hz


def random_force(mu: float) -> tuple[float, float, float]:
    """The least mean square under a white force, and stiffness and damping: Crandall and Mark (1963), Asami (2002)."""
    nu = sqrt(1.0 + 0.5 * mu) / (1.0 + mu)
    zeta = sqrt(mu * (4.0 + 3.0 * mu) / (8.0 * (1.0 + mu) * (2.0 + mu)))
    return 0.5 * sqrt((4.0 + 3.0 * mu) / (mu * (1.0 + mu))), mu * nu**2, 2.0 * zeta * mu * nu


def assert_least(mu: float, beta: float, k: float, c: float, on_absorber: float, least: float) -> None:
    for step in (0.99, 1.01):
        assert mean_square(mu, beta, step * k, c, on_absorber) > least
        assert mean_square(mu, beta, k, step * c, on_absorber) > least


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_the_mean_square_under_a_white_force(mu: float, beta: float) -> None:
    least, k, c = random_force(mu + beta)
    found = it.h2_norm(it.state_space(absorber(mu, beta, k, c), "primary_force", "primary_displacement"))
    assert found**2 == pytest.approx(mean_square(mu, beta, k, c, 0.0), rel=1e-8)
    assert found**2 == pytest.approx(least, rel=1e-8)
    assert_least(mu, beta, k, c, 0.0, least)


def random_ground(mu: float, beta: float) -> tuple[float, float]:
    """Stiffness and damping for the least mean square under white ground acceleration, of the displacement over it.

    Source: Marian and Giaralis (2014); Warburton (1982) without an inerter. The ground pushes masses alone.
    """
    m, wide = mu + beta, beta * (1.0 - mu) + (2.0 - mu) * (1.0 + mu)
    nu = sqrt(wide / (2.0 * (1.0 + mu))) / (1.0 + m)
    zeta = sqrt(m * (beta * (3.0 - mu) + (4.0 - mu) * (1.0 + mu)) / (8.0 * (1.0 + m) * wide))
    return m * nu**2, 2.0 * zeta * m * nu


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_the_mean_square_under_ground_acceleration(mu: float, beta: float) -> None:
    k, c = random_ground(mu, beta)
    on_ground = it.RandomResponse({"primary_relative_displacement": 1.0}, it.GroundAcceleration(intensity=1.0))
    found = it.evaluate(absorber(mu, beta, k, c), on_ground, it.Norm()).value
    least = mean_square(mu, beta, k, c, mu)  # the force on a mass is in proportion to it
    assert found**2 == pytest.approx(least, rel=1e-8)
    assert_least(mu, beta, k, c, mu, least)
    assert_best(mu, beta, k, c, on_ground, sqrt(least))


@pytest.mark.parametrize(("mu", "beta"), MASSES)
def test_the_search_finds_the_least_mean_square_under_a_white_force(mu: float, beta: float) -> None:
    least, k, c = random_force(mu + beta)
    pushed = it.RandomResponse({"primary_displacement": 1.0}, it.WhiteForce("primary_force", intensity=4.0))
    assert_best(mu, beta, k, c, pushed, 2.0 * sqrt(least))


def test_support_with_a_damper() -> None:
    """Without an absorber worth the name, a damped support has the gain 1 / (2 zeta sqrt(1 - zeta^2))."""
    zeta = 0.2
    tiny = absorber(1e-9, 0.0, 1e-9, 1e-9, damping=2.0 * zeta)
    assert it.evaluate(tiny, it.LoadCarrying(), it.Norm()).value == pytest.approx(
        1.0 / (2.0 * zeta * sqrt(1.0 - zeta**2)), rel=1e-8
    )


def test_energy_closes_and_forces_balance() -> None:
    made = it.Absorber(10.0, 4e3, 1.0, it.Spring(300.0) | it.Friction(0.4), it.Inerter(0.5), 2.0)
    force = it.sine(amplitude=20.0, frequency=3.0)
    run = it.simulate(made, forces={"primary_force": force}, duration=2.0, step=1e-3, energy=True)
    assert abs(run.energy.relative_residual) < 1e-9
    assert run.energy.friction["f"] > 0.0
    balance = 1.0 * run["absorber_acceleration"] + run["mount_force"] + run["ground_force"]
    assert np.abs(balance).max() < 1e-8 * np.abs(run["mount_force"]).max()


def test_it_is_written_as_in_the_readme_of_the_field() -> None:
    made = it.Absorber(
        primary_mass=1.0,
        primary_stiffness=1.0,
        mass=0.1,
        mount=it.Spring(it.free(1e-3, 1.0, name="k")) | it.Damper(it.free(1e-4, 1.0, name="c")),
        ground=it.Inerter(0.05),
    )
    assert list(made.free_values()) == ["k", "c"]
    assert [c.name for c in made.mechanism().coordinates] == ["primary", "absorber"]
    assert [f.name for f in made.mechanism().forces] == ["primary_force"]


BAD = {
    "no mass": ({"mass": 0.0}, "The mass of the absorber must be a positive number of kg, got 0.0"),
    "negative damping": ({"primary_damping": -1.0}, "primary damping of the absorber must be a positive number"),
    "text": ({"primary_damping": "0"}, "primary damping of the absorber must be a positive number of N s/m, got '0'"),
    "infinite": ({"primary_stiffness": float("inf")}, "primary stiffness of the absorber must be a positive number"),
}


@pytest.mark.parametrize(("given", "message"), BAD.values(), ids=BAD)
def test_bad_values_are_refused_in_one_sentence(given: dict[str, object], message: str) -> None:
    values: dict[str, object] = {"primary_mass": 1.0, "primary_stiffness": 1.0, "mass": 0.1, "mount": it.Spring(0.1)}
    with pytest.raises(MechanismError, match=message):
        it.Absorber(**{**values, **given})  # type: ignore[arg-type]


def test_on_a_road_it_cannot_be_judged() -> None:
    with pytest.raises(it.InerterError, match="requires a road, and this mechanism has no tyre"):
        it.evaluate(absorber(0.1, 0.0, 0.1, 0.1), J1, it.Norm())


@pytest.mark.parametrize("name", ["k", "c"])
def test_an_element_named_as_those_of_the_support_is_told_from_them(name: str) -> None:
    """A tolerance of the mount's own k or c, also of the mechanism, which has the support beside it."""
    mount = it.Spring(4e3, name="k") | it.Damper(300.0, name="c")
    made = it.Absorber(1e3, 40e3, 50.0, mount, primary_damping=100.0)
    index = it.PeakResponse(input="primary_force", output="primary_displacement")
    found = [
        it.tolerance_analysis(vehicle, index, it.Norm(), spread={name: 0.1}, samples=64, seed=1)
        for vehicle in (made, made.mechanism())
    ]
    assert found[0].standard_deviation > 0.0
    assert found[1].standard_deviation == pytest.approx(found[0].standard_deviation, rel=1e-9)
