"""Networks of springs, dampers and inerters with a given admittance.

Poles on the imaginary axis are split off the admittance or the impedance (Foster 1924, Cauer 1926). Then the smallest
real part is, from that of the two where it lies at zero or infinite frequency, so that the inverse has a pole there: a
regular biquadratic needs two reactive elements and three dampers (Jiang and Smith 2011, "Regular positive-real
functions and five-element network synthesis for electrical and mechanical networks", IEEE Trans. Autom. Control 56(6)).
Where it lies between, the step of Bott and Duffin (1949), "Impedance synthesis without use of transformers", J. Appl.
Phys. 20(8), lowers the degree by two and leaves two functions. Its six reactive elements are a balanced bridge, whose
two inner nodes may be joined by anything; joined by one element, five suffice (Pantell 1954; Reza 1954; Fialkow and
Gerst 1955). Partial fractions, each with the constant that makes it positive real, often need fewer where their sum
allows them, and bridges with two reactive elements, where a biquadratic has one (`synthesis.bridges`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from functools import partial, reduce
from itertools import pairwise
from operator import or_, sub

import numpy as np
from numpy.typing import NDArray

from inerter.errors import NetworkError, SynthesisError
from inerter.formatting import format_number
from inerter.networks.elements import Bridge, Damper, Inerter, Network, Spring
from inerter.synthesis.bridges import bridges_of_five
from inerter.synthesis.immittance import DIGITS, Immittance
from inerter.synthesis.positive_real import Ratio, find_violation
from inerter.systems.polynomials import Polynomial

ACCURACY = 1e-9  # relative deviation of the admittance of a network that is accepted
_TOLERANCES = (Decimal("1e-13"), Decimal("1e-50"))  # of coefficients rounded to double precision, and of exact ones
_MOST = 10  # degree up to which all ways are expanded; their number doubles with each degree
_POINTS = 60  # frequencies at which a network is compared with the request
_ANGLES = (0.0, 0.25 * np.pi, 0.45 * np.pi, 0.5 * np.pi)  # of s; the last one is the imaginary axis
Floats = NDArray[np.float64]
Attempt = Callable[[], Network | None]


def realise(numerator: Iterable[float], denominator: Iterable[float]) -> Network:
    """A network of springs, dampers and inerters, all positive, with the admittance numerator / denominator.

    The admittance is force over velocity [N s/m], its coefficients highest power of s first. Of several expansions (one
    above degree 10) the network with the fewest elements is returned; a smaller one may exist. Its admittance agrees
    with the request to 1e-9. So a request that is not positive real only because its coefficients are rounded is
    realised too.

    Raises `NotPositiveRealError` with a frequency at which the admittance is not passive, `SynthesisError` for other
    invalid requests, or if no network of that accuracy was found.

    >>> realise([300.0, 0.0], [1.0, 2.0])
    Series(parts=(Inerter(inertance=150.0, name=None), Damper(damping=300.0, name=None)))
    >>> f"{realise([1.0, 2.0, 3.0], [1.0, 1.0, 1.0]).admittance(2j):.4f}"
    '0.8462-0.7692j'
    """
    ratio = Ratio.of(numerator, denominator)
    if not ratio.top:
        raise SynthesisError("The admittance is zero, so no element is needed. Leave this branch out of the network.")
    violation = find_violation(ratio)
    closest = np.inf
    for tiny in _TOLERANCES if violation is None else _TOLERANCES[:1]:
        network = _try_expansion(ratio, tiny)
        if network is not None:
            deviation = relative_deviation(network, ratio)
            if deviation <= ACCURACY:
                return network
            closest = min(closest, deviation)
    if violation is not None:
        raise violation.to_error()
    reached = f"; the closest one deviates by {format_number(closest, 2)}" if np.isfinite(closest) else ""
    raise SynthesisError(
        f"No network with double-precision values has this admittance to {format_number(ACCURACY, 1)}{reached}. "
        "Reduce the ratio between its largest and smallest frequencies, or move it away from Re Y = 0 by a damper in "
        "parallel."
    )


def relative_deviation(network: Network, ratio: Ratio) -> float:
    """Largest relative difference between the admittance of a network and the requested one in the right half-plane.

    On the imaginary axis, where the admittance may vanish, it is relative to the sum of the terms of the polynomials.
    """
    logarithms = np.linspace(*_range(ratio.top, ratio.bottom), _POINTS)
    worst = 0.0
    for angle in _ANGLES:
        n, n_terms, n_scale = _at(ratio.top, logarithms, angle)
        d, d_terms, d_scale = _at(ratio.bottom, logarithms, angle)
        with np.errstate(all="ignore"):  # what is beyond the range of numbers gives nan, and does not agree
            found = network.admittance(np.exp2(logarithms) * np.exp(1j * angle)) * np.exp2(d_scale - n_scale)
            size = n_terms + abs(found) * d_terms if angle == _ANGLES[-1] else abs(n)
            worst = max(worst, *np.nan_to_num(abs(found * d - n) / size, nan=np.inf))
    return worst


def _range(*polynomials: Polynomial) -> tuple[float, float]:
    """Binary logarithms of the frequencies [rad/s] that contain all roots, with two decades on both sides."""
    ratios = [
        (math.log2(abs(p[i])) - math.log2(abs(p[j]))) / (j - i)
        for p in polynomials
        for i, j in pairwise(k for k, c in enumerate(p) if c)
    ] or [0.0]
    return min(ratios) - 7.0, max(ratios) + 7.0


def _at(p: Polynomial, logarithms: Floats, angle: float) -> tuple[NDArray[np.complex128], Floats, Floats]:
    """Values of p at s = 2^l exp(j angle) and the sum of the sizes of its terms, both over 2^scale, and the scale."""
    powers = [i for i, c in enumerate(p) if c]
    sizes = np.array([math.log2(abs(p[i])) + i * logarithms for i in powers])
    scale = sizes.max(axis=0)
    terms = np.exp2(sizes - scale)
    turns = np.array([(1.0 if p[i] > 0 else -1.0) * np.exp(1j * angle * i) for i in powers])
    return turns @ terms, terms.sum(axis=0), scale


def _try_expansion(ratio: Ratio, tiny: Decimal) -> Network | None:
    """The expansion of an admittance; None where an expansion at this tolerance fails."""
    with localcontext(Context(prec=DIGITS, Emax=MAX_EMAX, Emin=MIN_EMIN)):
        try:
            return expand(Immittance([Decimal(c) for c in ratio.top], [Decimal(c) for c in ratio.bottom], False, tiny))
        except (ArithmeticError, NetworkError):
            return None


def expand(f: Immittance) -> Network | None:
    """A network with a positive-real immittance; None if that is zero."""
    if not f.top:
        return None
    if len(f.top) == len(f.bottom) == 1:
        return _constant(f, f.top[0] / f.bottom[0])
    if len(f.top) > len(f.bottom):
        a, rest = f.without_pole_at_infinity()
        return _join(f, _proportional(f, a), expand(rest))
    if not f.bottom[0]:
        a, rest = f.without_pole_at_zero()
        return _join(f, _integral(f, a), expand(rest))
    if len(f.bottom) > len(f.top) or not f.top[0]:
        return expand(f.inverse())
    touching = f.touching()
    if touching:
        return _expand_at(f, touching[0])
    return _expand_smallest(f)


def _expand_smallest(f: Immittance) -> Network:
    """The smallest expansion of f, which has neither pole nor zero on the imaginary axis: a regular one if there is."""
    regular: list[Attempt] = []
    other: list[Attempt] = []
    for g in (f, f.inverse()):
        least, x = g.smallest_real_part()
        if least <= 0:
            raise ArithmeticError("not positive real")
        if x is None or not x:
            regular.append(partial(_remove_at_end, g, least, x))
        else:
            other.append(partial(_remove_inside, g, least, x))
    attempts: list[Attempt] = [*regular, partial(_split, f), partial(_split, f.inverse())]
    if not regular:
        attempts += [partial(next, bridges_of_five(f), None)] if len(f.bottom) == len(f.top) == 3 else []
        attempts += other
    networks: list[Network] = []
    for attempt in attempts:
        with suppress(ArithmeticError, NetworkError):
            network = attempt()
            networks += [] if network is None else [network]
        if networks and len(f.bottom) - 1 > _MOST:
            break
    if not networks:
        raise ArithmeticError("no expansion succeeded")
    return min(networks, key=lambda network: len(list(network.elements())))


def _remove_at_end(f: Immittance, least: Decimal, x: Decimal | None) -> Network | None:
    """The expansion of f after its real part at zero or, where x is None, infinity is removed."""
    rest = f.without_constant(least, at_zero=x is not None, at_infinity=x is None)
    return _join(f, _constant(f, least), expand(rest))


def _remove_inside(f: Immittance, least: Decimal, x: Decimal) -> Network | None:
    """The expansion of f after its smallest real part, at w^2 = x, is removed."""
    return _join(f, _constant(f, least), _expand_at(f.without_constant(least), x))


def _split(f: Immittance) -> Network | None:
    """The expansion of f by its partial fractions, each with the constant it needs; None if f has not as much."""
    parts = f.partial_fractions()
    if len(parts) < 2:
        return None
    rest, raised = f.top[-1] / f.bottom[-1], []
    for part in parts:
        least, x = part.smallest_real_part()
        rest += least
        raised.append(part.without_constant(least, at_zero=x is not None and not x))
    limit = f.tiny * f.top[-1] / f.bottom[-1]
    if rest < -limit:
        return None
    return _join(f, _constant(f, rest) if rest > limit else None, *map(expand, raised))


def _expand_at(f: Immittance, x: Decimal) -> Network | None:
    """The expansion of f, whose real part, or denominator, touches zero on the imaginary axis where w^2 = x."""
    if f.has_pole_at(x):
        return _remove_pole(f, x)
    if f.inverse().has_pole_at(x):
        return _remove_pole(f.inverse(), x)
    return _expand_bridge(f, x)


def _remove_pole(f: Immittance, x: Decimal) -> Network | None:
    """The expansion of f after its poles at s^2 = -x, those of a spring and an inerter, are removed."""
    a, rest = f.without_pole_at(x)
    return _join(f, _resonator(f, a, x), expand(rest))


def _expand_bridge(f: Immittance, x: Decimal) -> Network | None:
    """The expansion of f where Re f(j w) = 0 and Im f(j w) is not zero, with w^2 = x.

    By Richards' function R, whose zeros are at s^2 = -x, Bott and Duffin expand an impedance f as f(k) R beside
    k f(k) / s, in series with f(k) / R beside s f(k) / k. The poles a s / (s^2 + x) of 1 / (f(k) R) and of f(k) / R are
    one branch each. All potentials stay as they are if the second branch, of two elements, becomes the arm between both
    inner nodes, of one, and the others are `stiffer`.
    """
    slope = f.at(x)[1]
    if slope < 0:
        f = f.inverse()
        slope = f.at(x)[1]
    k, r = f.richards(slope)
    value, other = slope * k, f.inverse()
    a, across = other.over(r.bottom, [value * c for c in r.top]).without_pole_at(x)  # of 1 / (value R)
    along = f.over([value * c for c in r.bottom], r.top).without_pole_at(x)[1]  # of value / R
    ratio = a * value / k
    arm = 1 / (k * value * (1 + ratio))
    left = _join(other, _resonator(other, a + x * ratio * arm, x), expand(across))
    right, lower = expand(along), _proportional(f, value / k)
    if left is None or right is None:
        raise ArithmeticError("Richards' function is that of a lossless network")
    upper, between = _integral(f, 1 / arm), _proportional(f, 1 / (x * arm))
    return Bridge(left, lower, upper, right, between) if f.is_impedance else Bridge(left, upper, lower, right, between)


def _join(f: Immittance, *parts: Network | None) -> Network | None:
    """Parts whose immittances, of the kind of f, add up."""
    present = [part for part in parts if part is not None]
    return reduce(sub if f.is_impedance else or_, present) if present else None


def _constant(f: Immittance, a: Decimal) -> Network:
    """The damper of the immittance a."""
    return Damper(float(1 / a if f.is_impedance else a))


def _resonator(f: Immittance, a: Decimal, x: Decimal) -> Network | None:
    """The spring and inerter of the immittance a s / (s^2 + x)."""
    inverse = f.inverse()
    return _join(inverse, _proportional(inverse, 1 / a), _integral(inverse, x / a))


def _proportional(f: Immittance, a: Decimal) -> Network:
    """The element of the immittance a s."""
    return Spring(float(1 / a)) if f.is_impedance else Inerter(float(a))


def _integral(f: Immittance, a: Decimal) -> Network:
    """The element of the immittance a / s."""
    return Inerter(float(1 / a)) if f.is_impedance else Spring(float(a))
