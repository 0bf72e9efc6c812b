"""Formulas of docs/conventions.md, docs/criteria.md and docs/methods.md against numbers and laws from outside.

What other files of tests hold is not repeated: ports and levers (tests/vehicle), elements and energy
(tests/simulation), spectra (tests/signals, tests/roads), norms by quadrature (tests/norms, tests/methods).
"""

from __future__ import annotations

import math
import statistics

import numpy as np
import pytest
import scipy.optimize
import scipy.stats
from numpy.testing import assert_allclose

import inerter as it
from inerter.errors import DesignError
from inerter.formatting import choose_scale
from inerter.indices.iso2631 import weighting_filter
from inerter.methods.averages import interval_of, mean_and_error
from inerter.methods.compare import compare_estimates, difference_of
from inerter.methods.method import Estimate

ROAD = it.Road.iso8608("C", speed=20.0)
STRUT = it.Spring(25e3) | it.Damper(1500.0)
CAR = it.QuarterCar(sprung_mass=250.0, unsprung_mass=35.0, tyre_stiffness=180e3, strut=STRUT)
FULL = it.FullCar(
    sprung_mass=1400.0,
    pitch_inertia=2400.0,
    roll_inertia=520.0,
    unsprung_mass_front=45.0,
    unsprung_mass_rear=40.0,
    tyre_stiffness_front=220e3,
    tyre_stiffness_rear=220e3,
    distance_front=1.2,
    distance_rear=1.5,
    track_front=1.52,
    track_rear=1.4,
    front=STRUT,
    rear=STRUT,
)


def weights(index: it.RideComfort) -> dict[str, float]:
    return {w.output.removesuffix("_acceleration"): w.weight for w in index.definition(FULL.mechanism()).outputs}


def test_levers_of_ride_comfort() -> None:
    """Pitch counts with the mean distance of the axles, roll with half of the mean track, (t_f + t_r) / 4."""
    assert weights(it.RideComfort(ROAD)) == pytest.approx({"sprung": 1.0, "pitch": 2.7 / 2.0, "roll": 2.92 / 4.0})


def test_rotations_of_iso_2631() -> None:
    """Multiplying factors k of ISO 2631-1:1997, 7.2.3, of a seated person: 0.63 m/rad for roll, 0.4 for pitch."""
    assert weights(it.RideComfort(ROAD, weighting="Wk")) == {"sprung": 1.0, "pitch": 0.4, "roll": 0.63}


# Annex A of ISO 2631-1:1997: f1, f2, f3, f4, Q4, f5, Q5, f6, Q6; None where the table has infinity or nothing.
ANNEX_A = {
    "Wk": (0.4, 100.0, 12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91),
    "Wd": (0.4, 100.0, 2.0, 2.0, 0.63, None, None, None, None),
    "We": (0.4, 100.0, 1.0, 1.0, 0.63, None, None, None, None),
    "Wf": (0.08, 0.63, None, 0.25, 0.86, 0.0625, 0.80, 0.1, 0.80),
    "Wc": (0.4, 100.0, 8.0, 8.0, 0.63, None, None, None, None),
    "Wj": (0.4, 100.0, None, None, None, 3.75, 0.91, 5.32, 0.91),
}


@pytest.mark.parametrize("name", ANNEX_A)
def test_weightings_are_the_formulas_of_annex_a(name: str) -> None:
    """The moduli of the high pass, low pass, transition and step as the annex prints them."""
    f = np.geomspace(0.01, 500.0, 40)
    f1, f2, f3, f4, q4, f5, q5, f6, q6 = ANNEX_A[name]
    assert f1 is not None
    assert f2 is not None
    found = np.sqrt(f**4 / (f**4 + f1**4)) * np.sqrt(f2**4 / (f**4 + f2**4))
    if f3 is not None:
        found = found * np.sqrt((f**2 + f3**2) / f3**2)
    if f4 is not None and q4 is not None:
        lower = f**4 * q4**2 + f**2 * f4**2 * (1.0 - 2.0 * q4**2) + f4**4 * q4**2
        found = found * np.sqrt(f4**4 * q4**2 / lower)
    if f5 is not None and q5 is not None and f6 is not None and q6 is not None:
        upper = f**4 * q5**2 + f**2 * f5**2 * (1.0 - 2.0 * q5**2) + f5**4 * q5**2
        lower = f**4 * q6**2 + f**2 * f6**2 * (1.0 - 2.0 * q6**2) + f6**4 * q6**2
        found = found * (q6 / q5) * np.sqrt(upper / lower)
    assert_allclose(np.abs(weighting_filter(name).response(2.0 * np.pi * f)), found, rtol=1e-11)


@pytest.mark.parametrize(
    ("letter", "upper"), list(zip("ABCDEFG", (32, 128, 512, 2048, 8192, 32768, 131072), strict=True))
)
def test_limits_of_road_classes(letter: str, upper: float) -> None:
    """Upper limits of Gd(n0) of ISO 8608, Table C.1 [1e-6 m^3]; at a limit a road is of the rougher class."""
    kappa = 0.5 * upper * 1e-6 * 0.1**2
    assert it.Road(kappa * (1.0 - 1e-9), 20.0).iso8608_class.letter == letter
    assert it.Road(kappa * (1.0 + 1e-9), 20.0).iso8608_class.letter == chr(ord(letter) + 1)
    assert it.Road(0.5 * it.ROAD_CLASSES[letter].highest / 100.0, 20.0).iso8608_class.letter == chr(ord(letter) + 1)


def test_intensity_of_a_white_force() -> None:
    """A mass m on a damper c under a white force S has the variance S / (2 c m) of its velocity."""
    m, c, S = 3.0, 7.0, 11.0
    index = it.RandomResponse({"m_velocity": 1.0}, it.WhiteForce("push", intensity=S))
    assert it.evaluate(mass_on(it.Damper(c), m), index, it.Norm()).value == pytest.approx(math.sqrt(S / (2.0 * c * m)))


def mass_on(network: it.Network, mass: float) -> it.Mechanism:
    return it.Mechanism(
        coordinates=(it.Coordinate("m", mass),),
        struts=(it.Strut("strut", network, upper={"m": 1.0}, lower={}),),
        forces=(it.Force("push", {"m": 1.0}),),
    )


@pytest.mark.parametrize("friction", [0.3, 3.0, 9.0])
def test_the_damper_of_a_friction_under_white_noise(friction: float) -> None:
    """c' = sqrt(2/pi) f / sigma, put into the variance of a mass on a damper, has one solution, here by bisection."""
    m, c, S = 3.0, 7.0, 110.0

    def off(sigma: float) -> float:
        return sigma**2 - S / (2.0 * m * (c + math.sqrt(2.0 / math.pi) * friction / sigma))

    expected = scipy.optimize.brentq(off, 1e-6, 100.0, xtol=1e-14)
    index = it.RandomResponse({"m_velocity": 1.0}, it.WhiteForce("push", intensity=S))
    found = it.evaluate(mass_on(it.Damper(c) | it.Friction(friction), m), index, it.StatisticalLinearisation())
    assert found.value == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("friction", [1.0, 10.0, 40.0])
def test_the_damper_of_a_friction_under_a_sine(friction: float) -> None:
    """abs(4 f / pi + Z V) = F with Z = c + j (m omega - k / omega): the largest V / (omega F) of all frequencies."""
    m, c, k, F = 3.0, 7.0, 1200.0, 100.0

    def gain(omega: float) -> float:
        x, y, held = c, m * omega - k / omega, 4.0 * friction / math.pi
        a, half_b, rest = x**2 + y**2, held * x, held**2 - F**2
        return (-half_b + math.sqrt(half_b**2 - a * rest)) / a / (omega * F)

    best = scipy.optimize.minimize_scalar(lambda omega: -gain(omega), bounds=(5.0, 40.0), options={"xatol": 1e-9})
    index = it.PeakResponse("push", "m_displacement", amplitude=F)
    network = it.Spring(k) | it.Damper(c) | it.Friction(friction)
    found = it.evaluate(mass_on(network, m), index, it.StatisticalLinearisation())
    assert found.value == pytest.approx(-best.fun, rel=1e-6)
    assert found.peaks[0].omega == pytest.approx(best.x, rel=1e-4)


@pytest.mark.parametrize("count", [2, 3, 8, 30])
def test_means_and_their_intervals(count: int) -> None:
    """Standard deviation by n - 1, and Student's quantile of n - 1 degrees of freedom."""
    values = np.random.default_rng(count).normal(2.0, 0.3, count)
    mean, error, interval = mean_and_error(values)
    assert mean == pytest.approx(statistics.fmean(values.tolist()))
    assert error == pytest.approx(statistics.stdev(values.tolist()) / math.sqrt(count))
    assert interval == pytest.approx(scipy.stats.t.interval(0.95, count - 1, mean, error))
    assert interval_of(1.0, 2.0, 0) == pytest.approx(scipy.stats.norm.interval(0.95, 1.0, 2.0))


def sampled_estimate(samples: np.ndarray) -> Estimate:
    mean, error, interval = mean_and_error(samples)
    return Estimate(mean, "N", standard_error=error, interval=interval, samples=tuple(samples.tolist()))


def test_differences_road_by_road() -> None:
    """d_r = J_r(first) - J_r(second); `percent` is of the second."""
    one, other = np.random.default_rng(1).normal([[10.0], [12.0]], 1.0, (2, 9))
    found = difference_of(sampled_estimate(one), sampled_estimate(other))
    assert found.value == pytest.approx(statistics.fmean((one - other).tolist()))
    assert found.standard_error == pytest.approx(statistics.stdev((one - other).tolist()) / 3.0)
    assert found.interval == pytest.approx(scipy.stats.t.interval(0.95, 8, found.value, found.standard_error))
    two = compare_estimates(sampled_estimate(one), sampled_estimate(other))
    assert two.percent == pytest.approx(100.0 * found.value / two.second.value)
    ratio = one.mean() / other.mean()
    error = statistics.stdev((one - ratio * other).tolist()) / 3.0
    assert two.percent_error == pytest.approx(100.0 * error / two.second.value)


def test_a_control_variate_is_a_regression() -> None:
    """The difference at the mean of many more controls, and its variance, by ordinary least squares."""
    rng = np.random.default_rng(2)
    known, more = rng.normal(0.0, 1.0, 9), rng.normal(0.1, 1.0, 400)
    differences = 3.0 + 2.0 * known + rng.normal(0.0, 0.1, 9)
    zero = np.zeros(9)
    found = difference_of(
        sampled_estimate(10.0 + differences), sampled_estimate(10.0 + zero), [(known, more), (zero, np.zeros(400))]
    )
    fit = scipy.stats.linregress(known, differences)
    assert found.value == pytest.approx(fit.intercept + fit.slope * more.mean())
    residual = differences - fit.intercept - fit.slope * known
    mean_square = residual @ residual / 7.0
    far = (more.mean() - known.mean()) ** 2 / np.sum((known - known.mean()) ** 2)
    variance = mean_square * (1.0 / 9.0 + far) + fit.slope**2 * more.var(ddof=1) / 400.0
    assert found.standard_error == pytest.approx(math.sqrt(variance))


@pytest.mark.parametrize("bad", [0.0, -1.0, math.inf, math.nan])
def test_values_of_designs_are_positive(bad: float) -> None:
    free = it.QuarterCar(250.0, 35.0, 180e3, strut=it.Spring(25e3) | it.Damper(it.free(1.0, 1e5, name="c")))
    with pytest.raises(DesignError, match="positive, finite"):
        it.evaluate_many(free, it.RideComfort(ROAD), {"c": [1500.0, bad]}, it.Norm())
    smallest = it.evaluate_many(free, it.RideComfort(ROAD), {"c": [1e-3, 1500.0]}, it.Norm())
    assert smallest[0, 0] > smallest[1, 0]


@pytest.mark.parametrize(
    ("value", "unit", "name"),
    [
        (999.9, "N/m", "N/m"),
        (1000.0, "N/m", "kN/m"),
        (999.96, "N/m", "kN/m"),  # is written with four digits: 1000
        (999.9e3, "N s/m", "kN s/m"),
        (1e6, "N", "MN"),
        (9.9e-6, "m", "um"),
        (1e-5, "m", "mm"),
        (0.999, "m", "mm"),
        (1.0, "m", "m"),
        (-2e3, "N", "kN"),
        (0.0999, "s", "ms"),
        (0.1, "s", "s"),
        (0.0, "N", "N"),
    ],
)
def test_units_of_handy_size(value: float, unit: str, name: str) -> None:
    """A prefix of a thousand wherever the number would have four digits before its point, and that size beside it."""
    scale = choose_scale([value], unit)
    size, found = 1.0 / scale.factor, scale.unit
    assert found == name
    powers = {"k": 1e3, "M": 1e6, "u": 1e-6} if found != unit else {}
    milli = found != unit and found.startswith("m")
    assert size == (1e-3 if milli else powers.get(found[0], 1.0))


def test_improvement_is_a_part_of_the_baseline() -> None:
    """100 (1 - J / J_baseline), of a design that halves a white velocity's response: c four times as large."""
    index = it.RandomResponse({"m_velocity": 1.0}, it.WhiteForce("push", intensity=1.0))
    two = it.compare(mass_on(it.Damper(4.0), 1.0), mass_on(it.Damper(1.0), 1.0), index, it.Norm())
    assert two.percent == pytest.approx(-50.0)
