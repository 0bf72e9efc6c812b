"""Poles of systems whose values scatter, against the roots of a characteristic polynomial written by hand."""

from __future__ import annotations

from fractions import Fraction

import flint
import numpy as np
import pytest
from numpy.typing import NDArray

import inerter as it
from inerter.norms.exact import poles_exactly
from inerter.systems.assemble import state_space

TYPICAL = np.array([250.0, 35.0, 150e3, 60e3, 2e3, 80.0])


def designs(decades: float, seed: int) -> list[list[float]]:
    return (TYPICAL * 10.0 ** np.random.default_rng(seed).uniform(-decades, decades, (25, 6))).tolist()


def car(values: list[float]) -> it.QuarterCar:
    body, wheel, tyre, k, c, b = values
    return it.QuarterCar(body, wheel, tyre, it.Spring(k) | it.Damper(c) - it.Inerter(b))


def roots(values: list[float]) -> list[complex]:
    """With the strut's dynamic stiffness k + c b s^2 / (c + b s)."""
    body, wheel, tyre, k, c, b = (flint.fmpq(*Fraction(value).as_integer_ratio()) for value in values)
    s, bottom = flint.fmpq_poly([0, 1]), flint.fmpq_poly([c, b])
    top = k * bottom + c * b * s**2
    full = body * wheel * s**4 * bottom + (body + wheel) * s**2 * top + body * tyre * s**2 * bottom + tyre * top
    return [complex(root) for root, count in full.complex_roots() for _ in range(count)]


def largest_difference(expected: list[complex], found: NDArray[np.complex128]) -> float:
    """Largest relative difference of the poles, each of which is the nearest of those that are left."""
    left, largest = found.tolist(), 0.0
    for pole in expected:
        nearest = min(left, key=lambda one, pole=pole: abs(one - pole))
        left.remove(nearest)
        largest = max(largest, abs(nearest - pole) / abs(pole))
    return largest


@pytest.mark.parametrize("decades", [1.0, 5.0, 8.0])
def test_poles_have_all_digits_however_values_scatter(decades: float) -> None:
    rounded = 0.0
    for values in designs(decades, seed=3):
        system = state_space(car(values))
        expected, found = roots(values), poles_exactly(system)
        assert largest_difference(expected, found) < 1e-15
        assert np.all(found.real <= 1e-15 * np.abs(found))
        rounded = max(rounded, largest_difference(expected, np.linalg.eigvals(system.A).astype(complex)))
    assert (rounded > 1e-8) == (decades > 1.0)  # by eigenvalues of a rounded matrix


def test_poles_that_coincide_and_poles_at_zero() -> None:
    strut = it.Spring(60e3) | it.Damper(2e3)
    two = it.Mechanism(
        coordinates=tuple(it.Coordinate(name, 250.0) for name in "ab"),
        struts=tuple(it.Strut(f"strut_{name}", strut, {name: 1.0}, {}) for name in "ab"),
        forces=(it.Force("load", {"a": 1.0, "b": 1.0}),),
    )
    real = -2e3 / (2.0 * 250.0)
    pair = complex(real, np.sqrt(60e3 / 250.0 - real**2))
    assert largest_difference([pair, pair.conjugate()] * 2, poles_exactly(state_space(two))) < 1e-7
    free = it.Mechanism(
        coordinates=(it.Coordinate("a", 2.0), it.Coordinate("b", 6.0)),
        struts=(it.Strut("strut", it.Spring(600.0), {"a": 1.0}, {"b": 1.0}),),
        forces=(it.Force("load", {"a": 1.0}),),
    )
    found = poles_exactly(state_space(free))
    assert found[0] == 0.0  # the drift of both is no state
    np.testing.assert_allclose(np.sort(found.imag), [-20.0, 0.0, 20.0], rtol=1e-15, atol=1e-15)
