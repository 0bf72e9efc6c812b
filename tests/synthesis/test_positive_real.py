"""Positive-realness: what passive networks have, what is lost by a little, and how it is refused."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from exact import add, admittance, multiply
from hypothesis import given
from hypothesis import strategies as st
from strategies import networks, random_network

from inerter import is_positive_real, realise
from inerter.errors import NotPositiveRealError, SynthesisError

COEFFICIENTS = st.lists(st.integers(-6, 6), min_size=1, max_size=5)


def value(p: list[Fraction], s: complex) -> tuple[Fraction, Fraction]:
    """Real and imaginary part of p(s), lowest power first, without rounding."""
    x, y, real, imaginary = Fraction(s.real), Fraction(s.imag), Fraction(0), Fraction(0)
    for c in reversed(p):
        real, imaginary = real * x - imaginary * y + c, real * y + imaginary * x
    return real, imaginary


def real_part(n: list[Fraction], d: list[Fraction], s: complex) -> float:
    while not n[0] and not d[0]:
        n, d = n[1:], d[1:]
    (a, b), (e, f) = value(n, s), value(d, s)
    return float((a * e + b * f) / (e * e + f * f))


def smallest_on_axis(n: list[Fraction], d: list[Fraction]) -> tuple[float, float]:
    """Smallest of the real parts over many frequencies, and its frequency."""
    return min((real_part(n, d, 1j * omega), omega) for omega in np.geomspace(1e-3, 1e5, 400).tolist())


def assert_refused(n: list[Fraction], d: list[Fraction]) -> NotPositiveRealError:
    """Both functions refuse it, and the point they give shows that it is not positive real."""
    assert not is_positive_real(n[::-1], d[::-1])
    with pytest.raises(NotPositiveRealError, match="rad/s") as caught:
        realise(n[::-1], d[::-1])
    s = caught.value.s
    assert s.real >= 0.0
    found = real_part(n, d, s)
    assert found < 0.0
    assert found == pytest.approx(caught.value.admittance.real, rel=1e-6)
    return caught.value


@given(networks())
def test_admittances_of_networks_are_positive_real(network):
    n, d = admittance(network)
    assert is_positive_real(n[::-1], d[::-1])
    assert is_positive_real(d[::-1], n[::-1])


def test_what_supplies_energy_is_refused_at_a_frequency_where_it_does():
    """A hundred admittances of networks, less a damper that is too large or a pole that is, or turned round."""
    rng = np.random.default_rng(5)
    refused = 0
    while refused < 100:
        n, d = admittance(random_network(rng, most=6))
        if len(d) < 2 or len(n) < 2:
            continue
        way = refused % 5
        if way == 0:  # less than the smallest damping
            least, omega = smallest_on_axis(n, d)
            size = abs(complex(*map(float, value(n, 1j * omega)))) / abs(complex(*map(float, value(d, 1j * omega))))
            n = add(n, [-Fraction(1.01 * least + 1e-3 * size) * c for c in d])
        elif way == 1:  # a motion that grows
            d, n = multiply(d, [Fraction(-3), Fraction(1)]), multiply(n, [Fraction(5), Fraction(1)])
        elif way == 2:  # a pair of poles that grow slowly
            d, n = multiply(d, [Fraction(40), Fraction(-1, 10), Fraction(1)]), multiply(n, [Fraction(30), Fraction(1)])
        elif way == 3:  # a negative inerter
            n = add(n, [Fraction(0), *(-(Fraction(10) ** 6) * c for c in d)])
        else:
            n = [-c for c in n]
        assert_refused(n, d)
        refused += 1


@pytest.mark.parametrize(
    ("n", "d"),
    [
        ([1], [1, 0, 0]),  # a double pole at zero
        ([1, 0, 0], [1]),  # a double pole at infinity
        ([1, 0], [1, 0, 2, 0, 1]),  # double poles on the axis
        ([1, 0, 2], [1, 0, 1, 0]),  # poles on the axis with negative residues
        ([-1, 0, 0], [1, 0, 1]),
        ([1, -1], [1, 1]),
        ([1, 0, 1], [1]),
        ([-2.0], [3.0]),
    ],
)
def test_poles_of_no_network(n, d):
    assert_refused([Fraction(c) for c in n[::-1]], [Fraction(c) for c in d[::-1]])


@given(COEFFICIENTS, COEFFICIENTS)
def test_laws_of_positive_real_functions(n, d):
    """The inverse, the mirrored frequency 1/s, common factors, positive multiples."""
    if not any(n) or not any(d):
        return
    found = is_positive_real(n, d)
    size = max(len(n), len(d))
    reversed_n, reversed_d = ([*([0] * (size - len(p))), *p][::-1] for p in (n, d))
    assert is_positive_real(d, n) == found
    assert is_positive_real(reversed_n, reversed_d) == found
    assert is_positive_real(np.polymul(n, [1, -3, 2]), np.polymul(d, [1, -3, 2])) == found
    assert is_positive_real([0.3 * c for c in n], [-7 * c for c in d]) == is_positive_real([-c for c in n], d)


@given(COEFFICIENTS, COEFFICIENTS)
def test_the_answer_is_that_of_the_frequency_response_and_the_poles(n, d):
    """Wherever neither is close: poles well left of the axis, the real part well away from zero."""
    if not any(n) or not any(d):
        return
    poles = np.roots(d)
    response = np.polyval(n, S := 1j * np.geomspace(1e-4, 1e4, 2000)) / np.polyval(d, S)
    least = min(response.real / abs(response)) if any(abs(response)) else 1.0
    if len(np.trim_zeros(n, "f")) <= len(np.trim_zeros(d, "f")) and all(poles.real < -1e-3) and abs(least) > 1e-3:
        assert is_positive_real(n, d) == (least > 0.0)


def test_nothing_is_rounded():
    """(s^2 + 1)^2 + e over (s + 1)^4 has the real part e at w = 1 times a positive number plus zero."""
    square, tiny = [Fraction(1), 0, Fraction(2), 0, Fraction(1)], Fraction(1, 10**40)
    bottom = [Fraction(c) for c in (1, 1)]
    n, d = multiply([Fraction(0), Fraction(1)], square), multiply(bottom, square)
    assert is_positive_real(n[::-1], d[::-1])  # s / (s + 1) after the common factor is cancelled
    lossless = [Fraction(3), 0, Fraction(4), 0, Fraction(1)], [0, Fraction(2), 0, Fraction(1)]  # zeros 1, 3; poles 0, 2
    assert is_positive_real(lossless[0][::-1], lossless[1][::-1])
    for change in (tiny, -tiny):
        damped = add(lossless[0], [change * c for c in lossless[1]])
        assert is_positive_real(damped[::-1], lossless[1][::-1]) == (change > 0)


def test_a_damper_that_the_message_suggests_suffices():
    n, d = [1.0, 0.1, 3.0], [1.0, 1.0, 1.0]
    with pytest.raises(
        NotPositiveRealError, match=r"Re Y = -0\.347\d N s/m at .* Hz.*a damper of slightly more"
    ) as found:
        realise(n, d)
    damping = -1.001 * found.value.admittance.real
    assert is_positive_real(np.polyadd(n, damping * np.array(d)), d)


@pytest.mark.parametrize("damping", [Fraction(1, 10), Fraction(1, 1000), Fraction(1, 10**6)])
def test_the_damper_that_the_message_suggests_suffices_at_a_sharp_resonance(damping):
    """s / (s^2 + damping s + 1) squared: its smallest real part lies in a dip as narrow as the resonance."""
    n, d = [Fraction(1), 0, 0], [Fraction(c) for c in multiply([1, damping, 1], [1, damping, 1])]
    with pytest.raises(NotPositiveRealError, match="Add a damper of slightly more") as found:
        realise(n, d)
    needed = -Fraction(found.value.admittance.real)

    def with_damper(c):
        return add(n[::-1], [c * each for each in d[::-1]])[::-1]

    assert is_positive_real(with_damper(needed * Fraction(1000001, 1000000)), d)
    assert not is_positive_real(with_damper(needed * Fraction(999999, 1000000)), d)


WRONG = {
    "empty": (([], [1.0]), "numerator .* got an empty one"),
    "nan": (([1.0, float("nan")], [1.0]), "coefficient nan"),
    "infinite": (([1.0], [float("inf")]), "denominator .* coefficient inf"),
    "complex": (([1j], [1.0]), "coefficient 1j"),
    "text": (("1, 2", [1.0]), "got '1, 2'"),
    "texts": ((["1"], [1.0]), "coefficient '1'"),
    "truth": (([True], [1.0]), "coefficient True"),
    "a set, which has no order": (({1.0, 2.0}, [1.0]), "numerator .* list of real numbers.* got {1.0, 2.0}"),
    "a number": ((3.0, [1.0]), "numerator .* list of real numbers.* got 3.0"),
    "nothing": ((None, [1.0]), "got None"),
    "a matrix": ((np.ones((2, 2)), [1.0]), "coefficient array"),
    "zero denominator": (([1.0], [0.0, 0.0]), "denominator of the admittance is zero"),
}


@pytest.mark.parametrize("case", WRONG)
@pytest.mark.parametrize("function", [is_positive_real, realise])
def test_wrong_coefficients(case, function):
    given, message = WRONG[case]
    with pytest.raises(SynthesisError, match=message):
        function(*given)


def test_zero_is_positive_real_but_no_network():
    assert is_positive_real([0.0], [1.0, 2.0])
    with pytest.raises(SynthesisError, match="Leave this branch out"):
        realise([0.0], [1.0, 2.0])


def test_coefficients_of_any_size():
    assert is_positive_real([10**400, 1], [1, 10**400])
    assert is_positive_real(np.array([1, 2, 3]), np.array([1, 1, 1], dtype=np.int8))
    with pytest.raises(NotPositiveRealError, match="Re Y"):
        realise([-(10**400), 1], [1, 10**400])
