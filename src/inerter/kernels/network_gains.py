"""Peak gains of many designs of one network, side by side, compiled; see `network_norms` and `lanes`.

A march from zero upwards looks at the gain |b(j omega) / a(j omega)|. Between two of its points the denominator
changes by less than half, which its Taylor coefficients bound, so that every resonance is resolved, however sharp; it
ends where the coefficients bound all that comes below the highest gain so far. The highest local maxima are refined by
Newton's method on the slope of the gain's logarithm. Where any of this fails the gain is unknown.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import Floats, Matrix
from inerter.kernels.astrom_jury import forward
from inerter.kernels.decorators import kernel, part
from inerter.kernels.lanes import WIDTH, choose, in_numbers, is_between, larger, largest_lane, root
from inerter.kernels.network_lanes import lane_space, line
from inerter.kernels.network_norms import ACCURATE, DEGREE, NormSpace, Port, fill_fraction, norm_space
from inerter.kernels.network_polynomials import BOTTOM, TOP, Program, admittance

Array = Any
_CHANGE = 0.5  # relative change of the denominator between points
_GROWTH = 1.5  # of the distance between points, at most
_POINTS = 3000
_KEPT = 4  # local maxima that are refined, the highest
_STEPS = 6  # of Newton's method
_ALIKE = 0.9  # ratio to the highest from which on a maximum must have converged
_CONVERGED = 1e-10  # rise of the gain that may be left
_EPS = 1.2e-16
_CORNER = 0.4142135623730951  # the modulus of a number is no more than its larger part plus this times its smaller


class GainSpace(NamedTuple):
    """Room for the peaks of a gain."""

    norms: NormSpace
    a: Floats  # the highest power first
    b: Floats
    real: Floats  # Taylor coefficients of a
    imag: Floats
    squares: Floats  # (maxima,) of the highest local maxima so far, in falling order
    omegas: Floats
    reaches: Floats  # distances of the points at them


@part(borrowing=True)
def _expand(n: int, space: GainSpace, omega: Any, guess: Any) -> Any:
    """Square of |a(j omega)|, and the distance over which it changes by `_CHANGE` at most, no more than `guess`."""
    real, imag = space.real, space.imag
    for i in range(n + 1):
        real[i], imag[i] = space.a[i], 0.0
    for k in range(n):
        for i in range(1, n + 1 - k):
            real[i] -= omega * imag[i - 1]
            imag[i] += omega * real[i - 1]
    change = 0.0
    for i in range(n):
        one, other = abs(real[i]), abs(imag[i])
        size = larger(one, other) + _CORNER * (one + other - larger(one, other))
        change = (change + size) * guess
    square = real[n] * real[n] + imag[n] * imag[n]
    allowed = _CHANGE * root(square) / change
    return square, guess * choose(is_between(allowed, 0.0, 1.0), allowed, 1.0)


@part(borrowing=True)
def _sizes(n: int, space: GainSpace, omega: Any) -> Any:
    """Sums of the sizes of the terms of a and b at j omega, and the size of the first term of a."""
    above, over, power = 0.0, 0.0, 1.0
    for i in range(n):
        above = above * omega + abs(space.a[i])
        over = over * omega + abs(space.b[i])
        power = power * omega
    return above * omega + abs(space.a[n]), over, power * abs(space.a[0])


@part(borrowing=True)
def _square_of(p: Array, degree: int, omega: Any) -> Any:
    real, imag = 0.0, 0.0
    for i in range(degree + 1):
        real, imag = p[i] - omega * imag, omega * real
    return real * real + imag * imag


@part(borrowing=True)
def _keep(square: Any, omega: Any, reach: Any, space: GainSpace) -> None:
    """Insert a local maximum in the list of the highest."""
    for i in range(_KEPT):
        higher = is_between(space.squares[i], -np.inf, square)
        one, two, three = space.squares[i], space.omegas[i], space.reaches[i]
        space.squares[i] = choose(higher, square, one)
        space.omegas[i] = choose(higher, omega, two)
        space.reaches[i] = choose(higher, reach, three)
        square, omega, reach = choose(higher, one, square), choose(higher, two, omega), choose(higher, three, reach)


@part(borrowing=True)
def _march(n: int, space: GainSpace) -> Any:
    """Fill the list of maxima; the highest square of the gain, and whether all of it is known (1 or 0)."""
    a, b = space.a, space.b
    for i in range(_KEPT):
        space.squares[i], space.omegas[i], space.reaches[i] = -1.0, 0.0, 0.0
    guess = a[n] / a[n - 1]
    omega, going, best, known = 0.0 * guess, 1.0 + 0.0 * guess, 0.0 * guess, 1.0 + 0.0 * guess
    before, last = -1.0 + 0.0 * guess, -1.0 + 0.0 * guess
    last_omega, last_reach = 0.0 * guess, 0.0 * guess
    for _ in range(_POINTS):
        square, reach = _expand(n, space, omega, guess)
        gain = _square_of(b, n - 1, omega) / square
        is_top = going * is_between(before, -np.inf, last) * (1.0 - is_between(last, -np.inf, gain))
        if largest_lane(is_top) > 0.0:
            _keep(choose(is_top, last, -1.0), last_omega, last_reach, space)
        size, over, first = _sizes(n, space, omega)
        known = known * (1.0 - going * (1.0 - is_between(_EPS * size, -1.0, ACCURATE * root(square))))
        best = larger(gain, best)
        beyond = larger(2.0 * first - size, 0.0)
        ended = is_between(over * over, -1.0, best * beyond * beyond)
        before, last = choose(going, last, before), choose(going, gain, last)
        last_omega, last_reach = choose(going, omega, last_omega), choose(going, reach, last_reach)
        going = going * (1.0 - ended)
        omega = choose(going, omega + reach, omega)
        guess = _GROWTH * reach
        if largest_lane(going) == 0.0:
            break
    return best, known * (1.0 - going)


@part(borrowing=True)
def _logarithm_at(p: Array, degree: int, omega: Any) -> Any:
    """Of p at j omega: square, slope of the modulus' logarithm over omega, and its second derivative."""
    real, imag, one, one_imag, two, two_imag = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(degree + 1):  # p, p' and p'' / 2 with respect to s
        two, two_imag = one - omega * two_imag, one_imag + omega * two
        one, one_imag = real - omega * one_imag, imag + omega * one
        real, imag = p[i] - omega * imag, omega * real
    square = real * real + imag * imag
    q, q_imag = (one * real + one_imag * imag) / square, (one_imag * real - one * imag) / square
    bend = 2.0 * (two * real + two_imag * imag) / square - (q * q - q_imag * q_imag)
    return square, -q_imag, -bend


@part(borrowing=True)
def _peak(n: int, roundings: float, space: GainSpace) -> Any:
    """Peak gain of the fraction in `space`, and its relative error, infinite or nan where unknown."""
    best, known = _march(n, space)
    known = known * is_between(space.squares[_KEPT - 1], -np.inf, _ALIKE * best)
    value, error = 0.0 * best, 0.0 * best
    for i in range(_KEPT):
        omega, reach = space.omegas[i], space.reaches[i]
        peak, left = 0.0 * best, 0.0 * best
        for step in range(_STEPS + 1):
            over, rise, bend = _logarithm_at(space.b, n - 1, omega)
            under, fall, bend_under = _logarithm_at(space.a, n, omega)
            slope, curvature = rise - fall, bend - bend_under
            peak = over / under
            left = choose(is_between(curvature, -np.inf, 0.0), -0.5 * slope * slope / curvature, 1.0)
            left = choose(is_between(omega, -1.0, 1e-300), 0.0, left)  # the gain is even
            change = -slope / curvature
            change = choose(
                is_between(change, -reach, reach), change, choose(is_between(slope, 0.0, np.inf), reach, -reach) * 0.5
            )
            if step < _STEPS:
                omega = larger(omega + choose(is_between(left, 0.0, np.inf), change, 0.0), 0.0)
        size, above, _ = _sizes(n, space, omega)
        own = roundings * _EPS * (size / root(under) + above / root(over)) + left
        counts = is_between(_ALIKE * best, -np.inf, larger(peak, space.squares[i]))
        known = known * (1.0 - counts * (1.0 - is_between(left, -1.0, _CONVERGED)))
        higher = counts * is_between(value, -np.inf, peak)
        error = choose(higher, own, error)
        value = choose(higher, peak, value)
    known = known * is_between(value, best * (1.0 - 1e-12), np.inf)
    return root(value), error / known


@part()
def _fill_peak(values: Array, program: Program, port: Port, space: GainSpace) -> Any:
    """Peak gain at element values, and its relative error."""
    n, last = port.forms[0, DEGREE], program.parts.shape[0] - 1
    admittance(values, program, space.norms.network, False)
    fill_fraction(0, program, port, space.norms, False)
    fraction = space.norms.fraction
    for i in range(n + 1):
        space.a[i], space.b[i] = fraction.a[i], fraction.b[i]
    stable = is_between(forward(n, fraction), -1.0, np.inf)
    roundings = 2.0 * program.parts.shape[0] + program.parts[last, BOTTOM] + program.parts[last, TOP] + 4.0 + 3.0 * n
    value, error = _peak(n, roundings, space)
    return value, error / stable


@kernel("peak gains of many designs of a network", typed=True)
def peaks_in_lanes(points: Matrix, program: Program, port: Port, errors: Floats) -> Floats:
    """Peak gain at each column of element values (leaves, designs), infinite where unknown, and relative errors."""
    leaves, designs, n = points.shape[0], points.shape[1], port.forms[0, DEGREE]
    room = line(n + 1), line(n + 1), line(n + 1), line(n + 1)
    space = GainSpace(lane_space(program, port), *room, line(_KEPT), line(_KEPT), line(_KEPT))
    values, outcome = line(leaves), line(2)
    numbers, found = in_numbers(values), in_numbers(outcome)
    result = np.full(designs, np.inf)
    for first in range(0, designs, WIDTH):
        count = min(WIDTH, designs - first)
        for leaf in range(leaves):
            for lane in range(WIDTH):  # what is beyond the last design repeats it
                numbers[leaf, lane] = points[leaf, first + min(lane, count - 1)]
        outcome[0], outcome[1] = _fill_peak(values, program, port, space)
        for lane in range(count):
            known = found[1, lane] <= ACCURATE
            result[first + lane] = found[0, lane] if known else np.inf
            errors[first + lane] = found[1, lane] if known else np.inf
    return result


@kernel("peak gains of a network", typed=True)
def peaks_in_turn(points: Matrix, program: Program, port: Port, errors: Floats) -> Floats:
    """Peak gain at each column of element values, as in `peaks_in_lanes`, one after the other."""
    n = port.forms[0, DEGREE]
    room = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    space = GainSpace(norm_space(program, port), *room, np.zeros(_KEPT), np.zeros(_KEPT), np.zeros(_KEPT))
    values, result = np.zeros(points.shape[0]), np.full(points.shape[1], np.inf)
    for design in range(points.shape[1]):
        for leaf in range(points.shape[0]):
            values[leaf] = points[leaf, design]
        value, error = _fill_peak(values, program, port, space)
        known = error <= ACCURATE
        result[design] = value if known else np.inf
        errors[design] = error if known else np.inf
    return result
