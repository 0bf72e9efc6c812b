"""Admittances: closed formulas of the literature, Kirchhoff's rules, and passivity."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import logarithmic, networks

from inerter import LAYOUTS, Damper, Friction, Gap, Inerter, Spring, free, network
from inerter.errors import DesignError
from inerter.networks.parser import names
from inerter.networks.transform import map_elements

K, c, b, kb, k1, k2 = 120e3, 3e3, 250.0, 4e5, 5e4, 7e4
S = 1j * np.geomspace(1e-3, 1e4, 71)

# Wang and Su (2008), Figure 1; Smith and Wang (2004), the admittances of their layouts S1 to S8
FORMULAS = {
    "S1": lambda s: K / s + c,
    "S2": lambda s: K / s + c + b * s,
    "S3": lambda s: K / s + 1 / (1 / c + 1 / (b * s)),
    "SW1": lambda s: K / s + c,
    "SW2": lambda s: K / s + 1 / (s / kb + 1 / c),
    "SW3": lambda s: K / s + c + b * s,
    "SW4": lambda s: K / s + 1 / (s / kb + 1 / (c + b * s)),
    "SW5": lambda s: K / s + 1 / (1 / c + 1 / (b * s)),
    "SW6": lambda s: K / s + 1 / (s / kb + 1 / c + 1 / (b * s)),
    "SW7": lambda s: K / s + 1 / (1 / (c + k1 / s) + 1 / (b * s + k2 / s)),
    "SW8": lambda s: K / s + 1 / (s / kb + 1 / (c + k1 / s) + 1 / (b * s + k2 / s)),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_layouts_have_the_admittances_of_the_literature(name):
    parts = {"c": Damper(c), "b": Inerter(b), "kb": Spring(kb), "k1": Spring(k1), "k2": Spring(k2)}
    layout = network(LAYOUTS[name].expression, k=Spring(K), K=Spring(K), **parts)
    np.testing.assert_allclose(layout.admittance(S), FORMULAS[name](S), rtol=1e-12)


def test_ball_screw_is_its_screw_and_its_flywheel_in_series():
    parts = {"ks": Spring(1e6), "cs": Damper(3200.0), "gap": Gap(1e-4), "b": Inerter(b), "f": Friction(10.0)}
    device = network(LAYOUTS["ball-screw"].expression, **parts)
    np.testing.assert_allclose(device.admittance(S), 1 / (1 / (1e6 / S + 3200.0) + 1 / (b * S)), rtol=1e-12)


def test_every_layout_has_a_formula_here():
    assert {*FORMULAS, "ball-screw"} == set(LAYOUTS)
    assert all(names(layout.expression) for layout in LAYOUTS.values())


@given(networks(), networks(), logarithmic(1e-2, 1e4), logarithmic(1e-2, 1e4))
def test_admittances_add_in_parallel_and_impedances_in_series(one, two, real, imaginary):
    s = complex(real, imaginary)
    Y1, Y2 = one.admittance(s), two.admittance(s)
    assert (one | two).admittance(s) == pytest.approx(Y1 + Y2, rel=1e-12)
    assert (one - two).admittance(s) == pytest.approx(1 / (1 / Y1 + 1 / Y2), rel=1e-12)


@given(networks(), logarithmic(1e-2, 1e4))
def test_a_passive_network_absorbs_power_at_every_frequency(network, omega):
    Y = network.admittance(1j * omega)
    assert Y.real >= -1e-12 * abs(Y)


@given(networks(), logarithmic(1e-2, 1e4), st.floats(-1e4, 1e4))
def test_an_admittance_is_positive_real_and_finite_in_the_right_half_plane(network, real, imaginary):
    Y = network.admittance(complex(real, imaginary))
    assert np.isfinite(Y)
    assert Y.real > -1e-12 * abs(Y)


@given(networks(), logarithmic(1e-2, 1e4), st.floats(-1e4, 1e4))
def test_an_admittance_is_real_on_the_real_axis_and_symmetric_about_it(network, real, imaginary):
    assert network.admittance(real).imag == 0.0
    assert network.admittance(complex(real, -imaginary)) == np.conj(network.admittance(complex(real, imaginary)))


@given(networks(), logarithmic(1e-2, 1e2), logarithmic(1e-3, 1e3))
def test_an_admittance_scales_with_force(network, s, factor):
    scaled = map_elements(network, lambda e: e.with_value(factor * e.value))
    assert scaled.admittance(s) == pytest.approx(factor * network.admittance(s), rel=1e-12)


@pytest.mark.parametrize(
    ("layout", "at_rest"),
    [
        (Spring(5.0), np.inf),
        (Damper(5.0), 5.0),
        (Inerter(5.0), 0.0),
        (Spring(5.0) - Damper(3.0), 3.0),
        (Inerter(5.0) - Inerter(3.0), 0.0),
        (Spring(5.0) - Spring(3.0), np.inf),
        (Spring(5.0) - Inerter(3.0), 0.0),
        ((Spring(5.0) | Inerter(3.0)) - Damper(2.0), 2.0),
        (Friction(1.0), 0.0),
        (Gap(1.0), np.inf),
        (Friction(1.0) - Gap(1.0), 0.0),
        (Friction(1.0) | Gap(1.0), np.inf),
        (Gap(1.0) | Gap(2.0), np.inf),
        (Friction(1.0) - Friction(2.0), 0.0),
        (Gap(1.0) - Damper(2.0) - Gap(1.0), 2.0),
        (Friction(1.0) | Damper(2.0), 2.0),
    ],
)
def test_admittance_at_standstill(layout, at_rest):
    assert layout.admittance(0.0) == at_rest


@given(networks())
def test_admittance_keeps_the_shape_of_its_argument(network):
    s = np.array([[1j, 2j, 3.0], [4j, 1 + 1j, 6j]])
    values = network.admittance(s)
    assert values.shape == s.shape
    alone = np.array([network.admittance(value) for value in s.ravel()]).reshape(s.shape)
    np.testing.assert_allclose(values, alone, rtol=1e-14)


def test_a_free_value_has_no_admittance():
    with pytest.raises(DesignError, match="'b' is free"):
        (Spring(1.0) | Inerter(free(1.0, 2.0))).admittance(1j)


def test_long_chains_neither_overflow_nor_underflow():
    chain, beside = Spring(1e100), Inerter(1e-100)
    for _ in range(50):
        chain, beside = chain - Spring(1e100), beside | Inerter(1e-100)
    assert chain.admittance(1j) == pytest.approx(-1j * 1e100 / 51, rel=1e-13)
    assert beside.admittance(1j) == pytest.approx(51e-100j, rel=1e-13)
