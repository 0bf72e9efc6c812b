"""Networks with a given admittance: positive values, the admittance back, and no more elements than theory needs."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from functools import reduce
from itertools import product
from operator import or_, sub

import numpy as np
import pytest
from campaigns import sampled
from exact import add, admittance, multiply
from hypothesis import assume, given
from hypothesis import strategies as st
from strategies import logarithmic, networks, random_network

from inerter import Bridge, Damper, Inerter, Network, Spring, is_positive_real, realise
from inerter.errors import SynthesisError

Polynomial = list[Fraction]  # lowest power first
EXAMPLE = [1.0, 2.0, 3.0], [1.0, 1.0, 1.0]


def degree(n: Polynomial, d: Polynomial) -> int:
    return max(len(n), len(d)) - 1


def value(p: Polynomial, s: complex) -> complex:
    """p(s), without rounding but for the last step."""
    x, y, real, imaginary = Fraction(s.real), Fraction(s.imag), Fraction(0), Fraction(0)
    for c in reversed(p):
        real, imaginary = real * x - imaginary * y + c, real * y + imaginary * x
    return complex(real, imaginary)


def points(rng: np.random.Generator) -> list[complex]:
    """On the imaginary axis and right of it."""
    sizes = np.exp(rng.uniform(np.log(1e-2), np.log(1e4), 24))
    angles = np.concatenate([np.full(12, np.pi / 2), rng.uniform(-1.5, 1.5, 12)])
    return [1j * r if a == np.pi / 2 else complex(r * np.exp(1j * a)) for r, a in zip(sizes, angles, strict=True)]


def assert_realised(n: Polynomial, d: Polynomial, rng: np.random.Generator) -> Network:
    network = realise(n[::-1], d[::-1])
    assert all(element.value > 0.0 for element in network.elements())
    for s in points(rng):
        assert network.admittance(s) == pytest.approx(value(n, s) / value(d, s), rel=1e-9)
    return network


def count(network: Network) -> Counter[type]:
    return Counter(type(element) for element in network.elements())


def n_reactive(network: Network) -> int:
    kinds = count(network)
    return kinds[Spring] + kinds[Inerter]


def of_a_network(rng: np.random.Generator) -> tuple[Polynomial, Polynomial]:
    return admittance(random_network(rng, most=int(rng.integers(2, 8))))


def of_a_passive_state_space(rng: np.random.Generator) -> tuple[Polynomial, Polynomial]:
    """D + B' (s - J + L L')^-1 B with J skew, its characteristic polynomials in fractions by Leverrier's method."""
    order = int(rng.integers(1, 7))
    J, L = rng.integers(-9, 10, (order, order)), rng.integers(-3, 4, (order, int(rng.integers(1, order + 1))))
    B = [Fraction(int(b)) for b in rng.integers(1, 9, order)]
    A = [[Fraction(int(x)) for x in row] for row in (J - J.T) - L @ L.T]
    direct = Fraction(int(rng.integers(0, 3)), 4)
    d, n = [Fraction(1)], []
    adjugate = [[Fraction(i == j) for j in range(order)] for i in range(order)]
    for k in range(1, order + 1):
        n.insert(0, sum(B[i] * adjugate[i][j] * B[j] for i in range(order) for j in range(order)))
        product = [[sum(A[i][m] * adjugate[m][j] for m in range(order)) for j in range(order)] for i in range(order)]
        d.insert(0, -sum(product[i][i] for i in range(order)) / k)
        adjugate = [[product[i][j] + (d[0] if i == j else 0) for j in range(order)] for i in range(order)]
    return add(n, [direct * c for c in d]), d


def of_joined_biquadratics(rng: np.random.Generator) -> tuple[Polynomial, Polynomial]:
    """Of (s^2 + 2 p s + u^2)/(s^2 + 2 r s + v^2), with 4 p r >= (u - v)^2, in parallel and in series.

    Most of them have their smallest real part at a frequency between zero and infinity.
    """
    total: tuple[Polynomial, Polynomial] | None = None
    for _ in range(int(rng.integers(1, 4))):
        u, v = (Fraction(int(x)) for x in rng.integers(1, 30, 2))
        r = Fraction(int(rng.integers(1, 20)), 2)
        p = (u - v) ** 2 / (4 * r) * Fraction(int(rng.integers(4, 9)), 4) + Fraction(int(rng.integers(0, 2)), 8)
        size = Fraction(int(rng.integers(1, 1000)))
        n, d = [size * u * u, size * 2 * p, size], [v * v, 2 * r, Fraction(1)]
        if total is not None:
            swapped = rng.random() < 0.5
            (a, b), (e, f) = (total, (n, d)) if not swapped else (total[::-1], (d, n))
            a, b = add(multiply(a, f), multiply(e, b)), multiply(b, f)
            n, d = (b, a) if swapped else (a, b)
        total = n, d
    assert total is not None
    return total


FAMILIES = {of_a_network: 76, of_a_passive_state_space: 40, of_joined_biquadratics: 8}


@pytest.mark.parametrize("family", FAMILIES)
def test_positive_real_functions_are_realised(family):
    """124 in all, of degrees up to 6; campaigns have 500 of each family."""
    rng = np.random.default_rng(17)
    degrees = Counter()
    while degrees.total() < FAMILIES[family]:
        n, d = family(rng)
        if degree(n, d) <= 6:
            assert is_positive_real(n[::-1], d[::-1])
            assert_realised(n, d, rng)
            degrees[degree(n, d)] += 1
    assert max(degrees) == 6


@pytest.mark.parametrize(("family", "seed"), sampled(product(FAMILIES, range(100)), kept=2))
def test_many_positive_real_functions_are_realised(family, seed):
    rng = np.random.default_rng(100 + seed)
    for _ in range(50):
        n, d = family(rng)
        assert_realised(n, d, rng)


@given(networks(most=6))
def test_admittances_in_double_precision_are_realised(network):
    """Rounded coefficients may not be positive real any more, by a little: that much is granted."""
    n, d = ([float(c) for c in p] for p in admittance(network))
    found = realise(n[::-1], d[::-1])
    for s in points(np.random.default_rng(3)):
        if s.real > 0.0:
            assert found.admittance(s) == pytest.approx(network.admittance(s), rel=2e-9)


@given(logarithmic(1e-3, 1e3), logarithmic(1e-3, 1e3), logarithmic(1e-3, 1e3))
def test_a_zero_on_the_axis_survives_rounding(c, k, b):
    """A damper in series with a spring and an inerter in parallel, which move apart as they like at sqrt(k/b)."""
    found = realise([c * b, 0.0, c * k], [b, c, k])
    assert count(found) == {Damper: 1, Spring: 1, Inerter: 1}
    s = 1j * np.sqrt(k / b) * np.array([0.1, 0.5, 2.0, 10.0])
    np.testing.assert_allclose(found.admittance(s), (Damper(c) - (Spring(k) | Inerter(b))).admittance(s), rtol=1e-9)


@pytest.mark.parametrize("factor", [1e-60, 1e-9, 1e9, 1e60])
@pytest.mark.parametrize("speed", [1e-40, 1e-6, 1e6, 1e40])
def test_units_do_not_matter(factor, speed):
    n = [factor * c * speed**i for i, c in enumerate(EXAMPLE[0])]
    d = [c * speed**i for i, c in enumerate(EXAMPLE[1])]
    found, plain = realise(n, d), realise(*EXAMPLE)
    assert count(found) == count(plain)
    assert found.admittance(2j * speed) == pytest.approx(factor * plain.admittance(2j), rel=1e-12)


def ends_are_lowest(real: np.ndarray) -> bool | None:
    """Whether the smallest value stands at one of both ends; None if that is too close to say."""
    ends, middle = min(real[0], real[-1]), real[1:-1]
    least = min(middle[(middle < real[:-2]) & (middle < real[2:])], default=np.inf) / ends
    return None if abs(least - 1.0) < 1e-3 else bool(least > 1.0)


@pytest.mark.campaign
def test_regular_biquadratics_need_two_reactive_elements():
    """Jiang and Smith (2011): regular ones, and only they, are realised by two of them, with at most three dampers."""
    rng, kinds = np.random.default_rng(8), Counter()
    for _ in range(200):
        u, v, r, size = np.exp(rng.uniform(-2.0, 2.0, 4))
        slack = rng.choice([1.05, 1.2, 2.0])  # 1 where the real part touches zero
        n, d = [size, size * slack * (u - v) ** 2 / r, size * u**2], [1.0, r, v**2]
        Y = np.polyval(n, S := 1j * np.geomspace(1e-5, 1e5, 4000)) / np.polyval(d, S)
        regular = {ends_are_lowest(Y.real), ends_are_lowest((1.0 / Y).real)}
        network = realise(n, d)
        assert count(network)[Damper] <= 3
        if True in regular:
            assert n_reactive(network) == 2
        elif regular == {False}:
            assert n_reactive(network) == 5
        kinds[True in regular] += 1
    assert min(kinds[True], kinds[False]) > 20


def test_a_biquadratic_that_is_not_regular_needs_a_bridge_with_five_reactive_elements():
    """One less than Bott and Duffin: Pantell (1954), Reza (1954), Fialkow and Gerst (1955)."""
    found = realise(*EXAMPLE)
    assert n_reactive(found) == 5
    assert count(found)[Damper] == 3
    assert found.admittance(2j) == pytest.approx((3 - 4 + 4j) / (1 - 4 + 2j), rel=1e-12)
    minimum = realise([1, 1, 1], [1, 1, 4])  # its real part touches zero where w^2 = 2
    assert isinstance(minimum, Bridge)
    assert n_reactive(minimum) == 5
    assert count(minimum)[Damper] == 2


@pytest.mark.parametrize("inverted", [False, True])
@given(*[logarithmic(0.1, 10.0)] * 2, st.sampled_from([Fraction(1, 9), Fraction(1, 4), Fraction(4), Fraction(9)]))
def test_minimum_functions_of_degree_two_are_bridges_of_seven_elements(inverted, factor, speed, ratio):
    """(s^2 + a s + u^2) / (s^2 + b s + v^2) with a b = (u - v)^2 has Re Y = 0 at w^2 = u v, and nothing to remove."""
    u, v = Fraction(speed), Fraction(speed) * ratio
    n, d = [u * u, abs(u - v), Fraction(1)], [v * v, abs(u - v), Fraction(1)]
    n = [Fraction(factor) * c for c in n]
    found = assert_realised(*((d, n) if inverted else (n, d)), np.random.default_rng(4))
    assert isinstance(found, Bridge)
    assert (n_reactive(found), count(found)[Damper]) == (5, 2)


def of_a_bridge(bridge: Bridge) -> tuple[Polynomial, Polynomial]:
    """By Kirchhoff's laws at both inner nodes and the upper end, with all admittances times s."""
    powers = {Spring: 0, Damper: 1, Inerter: 2}
    a, b, c, d, e = ([Fraction(0)] * powers[type(arm)] + [Fraction(arm.value)] for arm in bridge.parts)
    left, right = reduce(add, (a, b, e)), reduce(add, (c, d, e))
    inner = add(multiply(left, right), [-x for x in multiply(e, e)])
    back = add(multiply(multiply(a, a), right), multiply(multiply(c, c), left))
    back = reduce(add, (back, multiply(multiply(a, c), e), multiply(multiply(a, c), e)))
    n, d = add(multiply(add(a, c), inner), [-x for x in back]), [Fraction(0), *inner]
    first = next(i for i in range(len(d)) if n[i] or d[i])
    last = max(i for i, x in enumerate(n) if x)
    return n[first : last + 1], d[first : last + 1]


@pytest.mark.parametrize("kinds", sampled([((Inerter, Spring),), ((Spring, Inerter),)], [((Inerter, Spring),)]))
def test_bridges_of_two_reactive_elements_are_found_again(kinds):
    """Ladenheim (1948): of biquadratics that are not regular, only these have two reactive elements."""
    rng, regular = np.random.default_rng(2), Counter()
    for _ in range(60):
        arm, *dampers, between = np.exp(rng.uniform(-2.0, 2.0, 5))
        n, d = of_a_bridge(Bridge(kinds[0](arm), *map(Damper, dampers), kinds[1](between)))
        assert degree(n, d) == 2
        found = assert_realised(n, d, rng)
        assert (n_reactive(found), count(found)[Damper]) == (2, 3)
        regular[isinstance(found, Bridge)] += 1
    assert min(regular.values()) > 10


@given(st.lists(st.integers(1, 50), min_size=2, max_size=7, unique=True), logarithmic(1e-2, 1e2), st.booleans())
def test_lossless_admittances_need_as_many_elements_as_their_degree(squares, factor, inverted):
    """Foster (1924): zeros and poles alternate on the axis."""
    n, d = [Fraction(factor)], [Fraction(0), Fraction(1)]
    for i, x in enumerate(sorted(squares)):
        p = [Fraction(x), Fraction(0), Fraction(1)]
        n, d = (multiply(n, p), d) if i % 2 == 0 else (n, multiply(d, p))
    n, d = (d, n) if inverted else (n, d)
    found = assert_realised(n, d, np.random.default_rng(1))
    assert sum(count(found).values()) == n_reactive(found) == degree(n, d)


@given(st.lists(st.integers(1, 10**4), min_size=2, max_size=8, unique=True), st.booleans())
def test_dampers_with_one_kind_need_as_many_of_it_as_their_degree(corners, inverted):
    """Cauer (1926): zeros and poles alternate on the negative real axis."""
    n, d = [Fraction(1)], [Fraction(1)]
    for i, x in enumerate(sorted(corners)):
        p = [Fraction(x), Fraction(1)]
        n, d = (multiply(n, p), d) if i % 2 == 0 else (n, multiply(d, p))
    n, d = (d, n) if inverted else (n, d)
    found = assert_realised(n, d, np.random.default_rng(1))
    assert n_reactive(found) == degree(n, d)
    assert not count(found)[Inerter] or not count(found)[Spring]


@given(st.lists(st.tuples(*[logarithmic(0.1, 10.0)] * 3), min_size=2, max_size=2), st.booleans())
def test_branches_that_are_apart_are_found_again(values, in_series):
    """Each has its smallest real part, zero, at a frequency of its own, and complex poles (or zeros, in series)."""
    if in_series:
        branches = [Damper(c) | Spring(k) - Inerter(b) for c, k, b in values]
        assume(all(k * b < 3.9 * c**2 for c, k, b in values))
    else:
        branches = [Damper(c) - (Spring(k) | Inerter(b)) for c, k, b in values]
        assume(all(c**2 < 3.9 * k * b for c, k, b in values))
    network = reduce(sub if in_series else or_, branches)
    n, d = admittance(network)
    found = assert_realised(n, d, np.random.default_rng(1))
    assert len(list(found.elements())) <= len(list(network.elements()))


def test_an_admittance_beyond_double_precision_is_refused_with_what_was_reached():
    with pytest.raises(SynthesisError, match="No network with double-precision values"):
        realise([10**400, 0], [1])


def test_inertances_of_any_size_have_a_network_or_a_reason():
    for size in (1e-290, 1e300):
        assert {getattr(one, "inertance", size) for one in realise([size, 1], [1]).elements()} == {size}
    with pytest.raises(SynthesisError, match="No network with double-precision values"):
        realise([5e-324, 1], [1])
