"""Frequency responses against direct solves, and poles on the axis."""

import numpy as np
import pytest
from strategies import random_stable

from inerter import LinearSystem, frequency_response
from inerter.errors import LinearSystemError
from inerter.norms.response import modal_response


@pytest.mark.parametrize("order", [1, 4, 11, 40])
def test_random_systems_against_a_solve_at_each_frequency(order):
    system = random_stable(np.random.default_rng(order), order, 2, 3, 1e-4)
    omega = np.geomspace(1e-3, 1e4, 40)
    expected = [
        system.C @ np.linalg.solve(1j * w * np.eye(order) - system.A, system.B.astype(complex)) + system.D
        for w in omega
    ]
    np.testing.assert_allclose(frequency_response(system, omega), expected, rtol=1e-9)


def test_negative_frequencies_are_the_conjugate_and_static_gains_are_real():
    system = random_stable(np.random.default_rng(0), 7, 2, 2, 1e-2)
    omega = np.array([0.5, 3.0])
    np.testing.assert_allclose(frequency_response(system, -omega), frequency_response(system, omega).conj(), rtol=1e-11)
    static = frequency_response(system, 0.0)
    assert static.shape == (1, 2, 2)
    np.testing.assert_allclose(static[0], -system.C @ np.linalg.solve(system.A, system.B), rtol=1e-10)


def test_small_responses_beside_large_ones_keep_their_digits():
    """Ten lags in a row: far above their corner the last one's response is 1e-30, exactly (1 + j omega)^-10."""
    n = 10
    system = LinearSystem(-np.eye(n) + np.eye(n, k=-1), np.eye(n)[:, :1], np.eye(n), np.zeros((n, 1)))
    omega = np.geomspace(0.1, 1e3, 30)
    expected = (1.0 + 1j * omega[:, None]) ** -np.arange(1.0, n + 1)
    np.testing.assert_allclose(frequency_response(system, omega)[:, :, 0], expected, rtol=1e-12)


def test_a_pole_on_the_axis_is_infinite_and_its_neighbours_are_not():
    system = LinearSystem([[0.0]], [[1.0]], [[1.0]], [[0.0]])
    response = np.abs(frequency_response(system, [0.0, 2.0]))[:, 0, 0]
    assert response[0] == np.inf
    assert response[1] == pytest.approx(0.5)


def test_arrivals_of_one_source_are_one_column_with_their_delays():
    system = LinearSystem(
        [[-1.0]], [[1.0, 2.0, 5.0]], [[1.0]], [[0.0] * 3], sources=("a", "a", "b"), delays=[0.0, 0.3, 0.1]
    )
    omega = np.array([0.2, 4.0])
    lag = 1.0 / (1.0 + 1j * omega)
    expected = np.column_stack([lag * (1.0 + 2.0 * np.exp(-0.3j * omega)), 5.0 * lag * np.exp(-0.1j * omega)])
    np.testing.assert_allclose(frequency_response(system, omega)[:, 0], expected, rtol=1e-12)


def oscillator(damping):
    """An oscillator; at damping 2 its eigenvalue is double, with one eigenvector."""
    return LinearSystem([[0.0, 1.0], [-1.0, -damping]], [[0.0], [1.0]], [[1.0, 0.0], [0.0, 1.0]], [[0.0], [0.5]])


@pytest.mark.parametrize(
    "system",
    [
        *(random_stable(np.random.default_rng(order), order, 2, 2, 1e-2) for order in (1, 4, 11)),
        *(oscillator(damping) for damping in (1e-6, 0.3, 2.0, 2.0 + 1e-9, 2.0 - 1e-6)),
        LinearSystem([[-1.0, 1e3], [0.0, -1.0]], np.eye(2), np.eye(2), np.zeros((2, 2)), delays=[0.0, 0.3]),
        LinearSystem([[-1.0]], [[1.0, 2.0]], [[1.0]], [[0.0, 0.0]], delays=[0.0, 0.3], sources=("z", "z")),
    ],
)
def test_the_sum_over_modes_is_the_response(system):
    omega = np.linspace(0.1, 30.0, 3000)
    exact, found = frequency_response(system, omega), modal_response(system, omega)
    assert np.all(np.abs(found - exact).max(axis=0) <= 1e-11 * np.abs(exact).max(axis=0))


@pytest.mark.parametrize("omega", [[np.nan], [np.inf], [[1.0, 2.0]]])
def test_frequencies_that_are_none(omega):
    with pytest.raises(LinearSystemError, match="finite frequencies"):
        frequency_response(LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]]), omega)
