"""Autocorrelation of filtered noise against its spectrum, and against norms of the filters by states."""

import numpy as np
import pytest
from filtered import iso_2631_wk
from scipy.integrate import quad

from inerter import Filter
from inerter.systems.autocorrelation import autocorrelation

LAG, BAND = Filter([3.0], [1.0, 2.0]), Filter([5.0, 0.0], [1.0, 5.0, 400.0])
WK = iso_2631_wk()


def response(filters, omega):
    return np.prod([one.response(omega) for one in filters], axis=0)


@pytest.mark.parametrize(
    "filters", [(LAG,), (BAND,), (WK,), (LAG, BAND), (BAND, WK), (Filter([1.0, 7.0], [1.0, 2.0]),)]
)
def test_the_spectrum_is_that_of_the_filters(filters):
    found, omega = autocorrelation(*filters), np.geomspace(1e-2, 1e4, 200)
    density = np.abs(response(filters, omega)) ** 2
    sizes = found.direct + np.abs(found._terms(1j * omega)).sum(axis=1)
    assert np.all(np.abs(found.spectrum(1j * omega) - density) <= 1e-14 * sizes)


@pytest.mark.parametrize("filters", [(LAG,), (BAND,), (WK,), (LAG, BAND)])
def test_its_values_are_the_inverse_transform_of_the_spectrum(filters):
    def density(omega):
        return float(abs(response(filters, np.array([omega]))[0]) ** 2)

    found = autocorrelation(*filters)
    power = quad(lambda u: density(u / (1.0 - u)) / (1.0 - u) ** 2, 0.0, 1.0, limit=500, epsabs=0.0, epsrel=1e-11)[0]
    assert found(np.array(0.0)) == pytest.approx(power / np.pi, rel=1e-9)
    for time in (0.01, 0.3):
        expected = quad(density, 0.0, np.inf, weight="cos", wvar=time, epsabs=1e-11 * power, limlst=400)[0]
        assert found(np.array(time)) == pytest.approx(expected / np.pi, abs=1e-8 * power)


def test_a_product_of_densities_is_that_of_filters_in_series():
    omega = np.geomspace(1e-2, 1e4, 50)
    product, series = autocorrelation(LAG).behind(autocorrelation(BAND)), autocorrelation(LAG, BAND)
    assert product.spectrum(1j * omega) == pytest.approx(series.spectrum(1j * omega), rel=1e-11)


def test_equal_poles_have_no_sum_of_exponentials():
    assert autocorrelation(LAG, LAG) is None
    assert autocorrelation(Filter([1.0], [1.0, 2.0, 1.0])) is None


def test_no_filter_leaves_the_noise_white():
    found = autocorrelation(None)
    assert found.direct == 1.0
    assert found.poles.size == 0
