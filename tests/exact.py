"""H2 norms in rational arithmetic: no rounding anywhere, from coefficients to the square of the norm.

For G = b(s)/a(s) the integral of |G|^2 over all frequencies follows from the coefficients alone by the recursion of
Astrom, Jury and Agniel (1970), "A numerical method for the evaluation of complex integrals", IEEE Trans. Autom.
Control 15(4); Newton, Gould and Kaiser (1957) print the same integrals as a table up to order ten.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import zip_longest

from inerter import Damper, Inerter, QuarterCar, Spring
from inerter.networks.elements import Network, Parallel

Polynomial = list[Fraction]  # coefficients from the constant upwards


def add(p: Polynomial, q: Polynomial) -> Polynomial:
    return [a + b for a, b in zip_longest(p, q, fillvalue=Fraction(0))]


def multiply(p: Polynomial, q: Polynomial) -> Polynomial:
    result = [Fraction(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            result[i + j] += a * b
    return result


def admittance(network: Network) -> tuple[Polynomial, Polynomial]:
    """Numerator and denominator of force over velocity."""
    if isinstance(network, Spring):
        return [Fraction(network.value)], [Fraction(0), Fraction(1)]
    if isinstance(network, Damper):
        return [Fraction(network.value)], [Fraction(1)]
    if isinstance(network, Inerter):
        return [Fraction(0), Fraction(network.value)], [Fraction(1)]
    fractions = [admittance(part) for part in network.parts]
    if not isinstance(network, Parallel):
        fractions = [(d, n) for n, d in fractions]
    n, d = fractions[0]
    for n2, d2 in fractions[1:]:
        n, d = add(multiply(n, d2), multiply(n2, d)), multiply(d, d2)
    return (n, d) if isinstance(network, Parallel) else (d, n)


def h2_square(numerator: Polynomial, denominator: Polynomial) -> Fraction:
    """Integral of |b(j w) / a(j w)|^2 dw / (2 pi), for a stable a of higher degree than b."""
    shared = next(i for i, (p, q) in enumerate(zip_longest(numerator, denominator, fillvalue=0)) if p or q)
    a = list(reversed(denominator[shared:]))
    b = list(reversed(numerator[shared:]))
    while a[0] == 0:
        a = a[1:]
    b = [Fraction(0)] * (len(a) - 1 - len(b)) + b[max(0, len(b) - len(a) + 1) :]
    square = Fraction(0)
    while len(a) > 1:
        alpha, beta = a[0] / a[1], b[0] / a[1]
        assert a[0] * a[1] > 0, "not stable"
        square += beta**2 / (2 * alpha)
        n = len(a)
        a_next = [a[i + 1] - (alpha * a[i + 2] if i % 2 == 1 and i + 2 < n else 0) for i in range(n - 1)]
        b_next = [b[i + 1] - (beta * a[i + 2] if i % 2 == 1 and i + 2 < n else 0) for i in range(n - 2)]
        a, b = a_next, b_next
    return square


def quarter_car_norms(car: QuarterCar) -> tuple[float, float]:
    """Norms from road velocity to body acceleration and to tyre force, from the equations of motion by hand.

    m s v_s = Y (v_u - v_s) and m_u s v_u = Y (v_s - v_u) + k_t (v_r - v_u) / s with Y = N / D.
    """
    m, mu, kt = (Fraction(v) for v in (car.sprung_mass, car.unsprung_mass, car.tyre_stiffness))
    N, D = admittance(car.strut)
    body = add(multiply([Fraction(0), m], D), N)
    denominator = add(multiply([kt, Fraction(0), mu], body), multiply([Fraction(0), Fraction(0), m], N))
    comfort = multiply([Fraction(0), kt], N)
    load = multiply([Fraction(0), kt], add([mu * p for p in body], [m * p for p in N]))
    return root(h2_square(comfort, denominator)), root(h2_square(load, denominator))


def root(square: Fraction) -> float:
    """Square root to the last digit, also of fractions whose terms are beyond floating point."""
    shift = (square.denominator.bit_length() - square.numerator.bit_length()) // 2 * 2
    scaled = square * Fraction(2) ** shift
    return math.ldexp(math.sqrt(scaled), -shift // 2)
