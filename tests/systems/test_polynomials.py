"""Whole polynomials: intervals around all positive roots, whatever their scale."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from inerter.systems.polynomials import multiply, positive_roots, refine_positive_roots

NUMBERS = st.integers(1, 10**6)


@given(st.sets(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=5), st.integers(-120, 120), st.integers(0, 3))
def test_each_positive_root_has_an_interval_of_its_own(fractions, scale, zeros):
    roots = sorted({Fraction(*pair) * Fraction(2) ** scale for pair in fractions})
    p = [0] * zeros + [1]
    for root in roots:
        p = multiply(p, [-root.numerator, root.denominator])
    p = multiply(p, [3, 1, 2])  # two that are complex
    found = positive_roots(p)
    assert [low <= root <= high for root, (low, high) in zip(roots, found, strict=True)] == [True] * len(roots)
    assert all(before[1] < after[0] for before, after in pairwise(found))
    for root, refined in zip(roots, refine_positive_roots(p), strict=True):
        assert float(refined) == pytest.approx(float(root), rel=1e-15)


def test_no_positive_root_has_no_interval():
    assert positive_roots([1, 2, 3]) == positive_roots([5]) == positive_roots([0, 0, 4]) == []
