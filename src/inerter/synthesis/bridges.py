"""Bridges of five elements with a biquadratic admittance: a spring, an inerter and three dampers.

Some biquadratics that are not regular have such a bridge (Ladenheim 1948; Jiang and Smith 2011, as for `realise`;
Chen, Wang, Li and Chen 2017, "Realization of biquadratic impedances as five-element bridge networks"). One of both
reactive elements then stands between the inner nodes and the other in an arm: with the inerter in that arm, in the
names of `Bridge`, and dampers x, y, z in the arms b, c, d, a bridge with the spring k and the inertance m has

    Y = (m (x y + y z + z x) s^2 + (k m (x + z) + x y z) s + k y (x + z))
        / (m (y + z) s^2 + (k m + x (y + z)) s + k (x + y + z)).

Its value at infinite frequency is the larger one of those at both ends, and these give y and z for each x; a root of
the condition that is left is sought over x.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from decimal import Decimal
from itertools import pairwise

from inerter.networks.elements import Bridge, Damper, Inerter, Network, Spring
from inerter.synthesis.immittance import ZERO, Immittance, Numbers

_REACH = 16  # the search reaches from exp(-16) of its interval to 1 - exp(-16)
_POINTS = 40  # at which the condition is evaluated, on each side of the middle
_HALVINGS = 40  # steps in which two roots between points are sought
_FINE = Decimal("1e-60")  # size of an interval that counts as a root
Condition = Callable[[Decimal], Decimal]


def bridges_of_five(f: Immittance) -> Iterator[Network]:
    """All bridges with this biquadratic immittance that have a spring, an inerter and three dampers."""
    admittance = f.inverse() if f.is_impedance else f
    top, bottom = admittance.top, admittance.bottom
    rises = top[2] * bottom[0] > top[0] * bottom[2]
    if not rises:  # over 1 / s springs and inerters change places
        top, bottom = top[::-1], bottom[::-1]
    for x in _roots(top, bottom):
        k, m, y, z = _values(top, bottom, x)
        if k > 0 and m > 0:
            b, c, d = (Damper(float(value)) for value in (x, y, z))
            arm, between = (Inerter(float(m)), Spring(float(k))) if rises else (Spring(float(m)), Inerter(float(k)))
            yield Bridge(arm, b, c, d, between)


def _roots(top: Numbers, bottom: Numbers) -> Iterator[Decimal]:
    """Dampers x at which the condition changes its sign."""
    at_zero, at_infinity = top[0] / bottom[0], top[2] / bottom[2]
    if at_infinity <= at_zero:
        return

    def at(place: Decimal) -> Decimal:  # of x over its interval
        return at_infinity - at_zero / (1 + place.exp())

    def condition(place: Decimal) -> Decimal:
        return _condition(top, bottom, at(place))

    places = [Decimal(i * _REACH) / _POINTS for i in range(-_POINTS, _POINTS + 1)]
    values = [condition(place) for place in places]
    for i in range(1, 2 * _POINTS):
        near, far = abs(values[i]), min(abs(values[i - 1]), abs(values[i + 1]))
        if near < far and values[i - 1] * values[i] > 0 and values[i] * values[i + 1] > 0:  # two roots may lie there
            lowest = _least_size(condition, places[i - 1], places[i + 1])
            places.append(lowest)
            values.append(condition(lowest))
    known = sorted(zip(places, values, strict=True))
    for (left, before), (right, after) in pairwise(known):
        if (before > 0) != (after > 0):
            yield at(_bisect(condition, left, right))


def _least_size(condition: Condition, left: Decimal, right: Decimal) -> Decimal:
    """A place between two others at which the condition has another sign, else the smallest size."""
    is_positive = condition(left) > 0
    for _ in range(_HALVINGS):
        third = (right - left) / 3
        low, high = condition(left + third), condition(right - third)
        if (low > 0) != is_positive or (high > 0) != is_positive:
            return left + third if (low > 0) != is_positive else right - third
        left, right = (left, right - third) if abs(low) < abs(high) else (left + third, right)
    return (left + right) / 2


def _bisect(condition: Condition, left: Decimal, right: Decimal) -> Decimal:
    """The root of the condition between two places."""
    is_positive = condition(left) > 0
    while right - left > _FINE:
        middle = (left + right) / 2
        left, right = (middle, right) if (condition(middle) > 0) == is_positive else (left, middle)
    return (left + right) / 2


def _others(top: Numbers, bottom: Numbers, x: Decimal) -> tuple[Decimal, Decimal, Decimal, Decimal]:
    """Dampers y and z, and two numbers of which the first over the second is the size of the bridge's polynomials."""
    at_zero, rest = top[0] / bottom[0], top[2] / bottom[2] - x  # the latter is y z / (y + z)
    z = ((x * x + 4 * x / (1 / rest - 1 / at_zero)).sqrt() - x) / 2
    y = 1 / (1 / rest - 1 / z)
    return y, z, x * (x * y + x * z + z * z), bottom[1] * (x + z) - top[1]


def _condition(top: Numbers, bottom: Numbers, x: Decimal) -> Decimal:
    """Residual of the condition on the middle coefficients for a damper x, over the size of its terms."""
    y, z, size, over = _others(top, bottom, x)
    product = bottom[0] * bottom[2] / ((x + y + z) * (y + z))  # k m for polynomials of size 1
    terms = product * size**2, -bottom[1] * size * over, x * (y + z) * over**2
    return sum(terms, ZERO) / sum(map(abs, terms), ZERO)


def _values(top: Numbers, bottom: Numbers, x: Decimal) -> tuple[Decimal, Decimal, Decimal, Decimal]:
    """k, m, y and z for a damper x."""
    y, z, size, over = _others(top, bottom, x)
    return size / over * bottom[0] / (x + y + z), size / over * bottom[2] / (y + z), y, z
