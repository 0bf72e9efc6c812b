"""Filters as values: what is one, what is refused, and that a linear system is the filter of its transfer function."""

import math
from fractions import Fraction

import numpy as np
import pytest
import scipy
from filtered import iso_2631_wk, random_filter

import inerter as it
from inerter import Filter, LinearSystem
from inerter.errors import LinearSystemError, PerformanceIndexError
from inerter.indices.definition import Combination, IndexDefinition
from inerter.vehicle.mechanism import OutputWeight

# Frequency [Hz] and factor of Wk, ISO 2631-1:1997, Table 3
WK = [(0.5, 0.418), (1.0, 0.482), (2.0, 0.531), (4.0, 0.967), (8.0, 1.036), (16.0, 0.768), (31.5, 0.405), (80.0, 0.132)]


@pytest.mark.parametrize(("frequency", "factor"), WK)
def test_the_weighting_of_iso_2631_is_the_printed_one(frequency, factor):
    (found,) = np.abs(iso_2631_wk().response([2.0 * math.pi * frequency]))
    assert found == pytest.approx(factor, abs=6e-4 + 5e-3 * factor)


@pytest.mark.parametrize("seed", range(20))
def test_the_response_is_that_of_rational_arithmetic(seed):
    one = random_filter(np.random.default_rng(seed))
    for omega in (0.0, 0.01, 1.0, 30.0, 1e4):
        real, imaginary = [], []
        for p in (one.numerator, one.denominator):
            parts = [Fraction(0), Fraction(0)]
            for c in p:  # (a + jb) j omega + c
                parts = [-parts[1] * Fraction(omega) + Fraction(c), parts[0] * Fraction(omega)]
            real.append(parts[0])
            imaginary.append(parts[1])
        size = math.sqrt((real[0] ** 2 + imaginary[0] ** 2) / (real[1] ** 2 + imaginary[1] ** 2))
        terms = sum(abs(c) * omega**i for i, c in enumerate(reversed(one.numerator)))
        bottom = math.sqrt(real[1] ** 2 + imaginary[1] ** 2)
        poor = sum(abs(c) * omega**i for i, c in enumerate(reversed(one.denominator))) / bottom
        error = 1e-14 * (float(terms) / bottom + poor * size)
        assert abs(abs(one.response([omega])[0]) - size) <= error


@pytest.mark.parametrize("seed", range(20))
def test_a_linear_system_is_the_filter_of_its_transfer_function(seed):
    """Against C (j omega - A)^-1 B + D, for modes that are mixed by a rotation."""
    rng = np.random.default_rng(seed)
    blocks = [np.array([[-a, w], [-w, -a]]) for a, w in np.exp(rng.uniform(-1.0, 3.0, (int(rng.integers(1, 5)), 2)))]
    A = scipy.linalg.block_diag(*blocks, -np.exp(rng.uniform(-1.0, 3.0)))
    turn, n = np.linalg.qr(rng.normal(size=A.shape))[0], len(A)
    A, B, C, D = turn @ A @ turn.T, rng.normal(size=(n, 1)), rng.normal(size=(1, n)), rng.normal(size=(1, 1))
    omega = np.geomspace(0.01, 1e4, 30)
    expected = [(C @ np.linalg.solve(1j * w * np.eye(n) - A, B) + D)[0, 0] for w in omega]
    assert Filter.of(LinearSystem(A, B, C, D)).response(omega) == pytest.approx(np.array(expected), rel=1e-8)


def test_a_filter_is_a_value():
    high_pass = Filter([0, 1, 0], (1, 2.0))
    assert high_pass == Filter((1.0, 0.0), np.array([1.0, 2.0]))
    assert hash(high_pass) == hash(Filter.of(LinearSystem([[-2.0]], [[1.0]], [[-2.0]], [[1.0]])))
    assert high_pass.order == 1


@pytest.mark.parametrize("seed", range(30))
def test_what_is_stable_is_decided_as_its_poles_say(seed):
    rng = np.random.default_rng(seed)
    poles = rng.uniform(-3.0, 1.0, 2) + 0j
    pair = rng.uniform(-2.0, 0.5) + 1j * rng.uniform(0.0, 5.0)
    poles = np.concatenate([poles, [pair, pair.conjugate()]])
    bottom = np.poly(poles).real
    if np.all(poles.real < 0.0):
        assert Filter([1.0], bottom).order == 4
    else:
        with pytest.raises(LinearSystemError, match="open left half plane"):
            Filter([1.0], bottom)


REFUSED = {
    "undamped": (lambda: Filter([1.0], [1.0, 0.0, 4.0]), "open left half plane.*2j"),
    "integrator": (lambda: Filter([1.0], [1.0, 0.0]), "open left half plane"),
    "improper": (lambda: Filter([1.0, 0.0, 0.0], [1.0, 1.0]), "no higher order.*2 over 1"),
    "zero": (lambda: Filter([0.0], [1.0, 1.0]), "must not be zero"),
    "no denominator": (lambda: Filter([1.0], [0.0, 0.0]), "denominator"),
    "empty": (lambda: Filter([], [1.0]), "numerator.*finite real numbers"),
    "complex": (lambda: Filter([1.0], [1.0, 1.0 + 1.0j]), "denominator.*finite real numbers"),
    "infinite": (lambda: Filter([math.inf], [1.0]), "numerator.*finite real numbers"),
    "text": (lambda: Filter("12", [1.0]), "numerator.*finite real numbers"),
    "a number": (lambda: Filter(1.0, [1.0]), "numerator.*finite real numbers"),
    "two inputs": (lambda: Filter.of(LinearSystem([[-1.0]], [[1.0, 1.0]], [[1.0]], [[0.0, 0.0]])), "one input"),
    "late": (lambda: Filter.of(LinearSystem([[-1.0]], [[1.0]], [[1.0]], [[0.0]], delays=[1.0])), "a delay"),
    "unstable": (lambda: Filter.of(LinearSystem([[1.0]], [[1.0]], [[1.0]], [[0.0]])), "open left half plane"),
    "no system": (lambda: Filter.of("Wk"), "LinearSystem"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_filter_is_refused_in_a_sentence(case):
    make, words = REFUSED[case]
    with pytest.raises(LinearSystemError, match=words) as caught:
        make()
    assert str(caught.value).endswith(".")
    assert "\n" not in str(caught.value)


def definition(outputs, passed):
    return IndexDefinition(outputs, Combination.SUM_OF_RMS, it.Road(1e-6, 20.0), "N", filter=passed)


def test_a_question_takes_a_filter_for_all_outputs_or_one_for_each():
    two, one = (OutputWeight("a"), OutputWeight("b")), Filter([1.0], [1.0, 3.0])
    assert definition(two, None).filters == (None, None)
    assert definition(two, one).filters == (one, one)
    assert definition(two, (None, one)).filters == (None, one)
    assert definition(two, LinearSystem([[-3.0]], [[1.0]], [[1.0]], [[0.0]])).filters == (one, one)
    with pytest.raises(PerformanceIndexError, match="1 filters for 2 outputs"):
        definition(two, (one,))
    with pytest.raises(PerformanceIndexError, match="each output once"):
        definition((OutputWeight("a"), OutputWeight("a")), (one, None))
    with pytest.raises(LinearSystemError, match=r"Filter\(numerator, denominator\) or a LinearSystem"):
        definition(two, "Wk")
