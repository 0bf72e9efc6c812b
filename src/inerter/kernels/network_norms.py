"""Indices of r.m.s. values of a mechanism with one network in it, over the network's element values, compiled.

With the network's admittance s^v N/D, every transfer function of the mechanism is (D A + N B) / (D P + N Q) times
powers of s, where the polynomials A, B, P, Q are those of the mechanism without the network. P and Q have no negative
coefficients, so the denominator is a sum of positive numbers. See `systems.network_port`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import Floats, Ints, IntTable, Matrices, Matrix
from inerter.kernels.astrom_jury import Recursion, backward, fine_forward, forward
from inerter.kernels.decorators import kernel, part
from inerter.kernels.lanes import is_between, larger, root
from inerter.kernels.network_polynomials import (
    BOTTOM,
    TOP,
    Polynomials,
    Program,
    add_product_of_polynomials,
    admittance,
    admittance_adjoint,
)

Array = Any
ACCURATE = 1e-9  # relative error of a squared norm up to which it counts as known
_EPS, _FINE_EPS = 1.2e-16, 1e-30
_NOTHING = 1e-300  # squared norm of a group without functions
_DIFFERENCE = 1e-5  # relative step of differences
SHARP = 40.0  # of the smooth maximum over criteria, which is at most log(criteria) / SHARP too large
POWER_D, POWER_N, DROPPED, DEGREE, TOP_DEGREE = range(5)  # columns of `Port.forms`
POLES, POLES_RIGID, ZEROS, ZEROS_RIGID = range(4)  # P, Q, A, B


class Port(NamedTuple):
    """Transfer functions of a mechanism from its inputs to outputs, over the admittance of one network."""

    coefficients: Matrices  # (functions, 4, size): P, Q, A, B from the constant upwards
    low: Matrices  # what is to be added in twice the precision
    degrees: IntTable  # (functions, 4), -1 for zero
    forms: IntTable  # (functions, 5): powers of s of D and N, common power that is dropped, degrees of the fraction
    weights: Floats  # (functions,) of each squared norm in the square of its group
    groups: Floats  # (functions,) number of the group: roots of sums of squares, which add up


class TradeOff(NamedTuple):
    """The aim of one point of a front: how far criteria, each a sum of groups, exceed it; see `excess_in`."""

    criterion: Ints  # (groups,) number of the criterion to which each group belongs
    aims: Floats  # (criteria,) none for the index itself
    sizes: Floats  # (criteria,) excess of each that counts as one
    scale: float  # of the excess, which makes it a relative change of the criteria


class NormSpace(NamedTuple):
    """Room for an index and its gradient."""

    network: Polynomials
    fraction: Recursion
    sums: Floats  # (groups,)
    errors: Floats  # (groups,)
    slopes: Floats  # (groups,) derivative of the objective over the root of each
    top_shares: Matrix  # (functions, size): adjoints of N and D for a unit adjoint of each squared norm
    bottom_shares: Matrix


@part()
def space_sizes(program: Program, port: Port) -> Any:
    """Coefficients that polynomials of the network and of fractions have room for, and groups."""
    size, n, groups = 2, 2, 1
    for k in range(program.parts.shape[0]):
        size = max(size, program.parts[k, TOP] + 1, program.parts[k, BOTTOM] + 1)
    for k in range(port.weights.size):
        n = max(n, port.forms[k, DEGREE] + 1, port.forms[k, TOP_DEGREE] + 2)
        groups = max(groups, int(port.groups[k]) + 1)
    return size + 1, n + 1, groups


@part()
def norm_space(program: Program, port: Port) -> NormSpace:
    """Room for `index_in`."""
    parts, functions = program.parts.shape[0], port.weights.size
    size, full, groups = space_sizes(program, port)
    network = Polynomials(
        np.zeros((parts, size)),
        np.zeros((parts, size)),
        np.zeros((parts, size)),
        np.zeros((parts, size)),
        np.zeros((parts, size)),
        np.zeros((parts, size)),
        np.zeros((4, size)),
    )
    fraction = Recursion(
        np.zeros(full),
        np.zeros(full),
        np.zeros(full),
        np.zeros(full),
        np.zeros((full, full)),
        np.zeros((full, full)),
        np.zeros(full),
        np.zeros(full),
        np.zeros(full),
        np.zeros(full),
        np.zeros(full),
    )
    return NormSpace(
        network,
        fraction,
        np.zeros(groups),
        np.zeros(groups),
        np.ones(groups),
        np.zeros((functions, size)),
        np.zeros((functions, size)),
    )


@part(borrowing=True)
def fill_fraction(k: int, program: Program, port: Port, space: NormSpace, fine: bool) -> None:
    """Fill the coefficients of the fraction of function k, the highest power first."""
    network, fraction = space.network, space.fraction
    last = program.parts.shape[0] - 1
    N, D = network.top[last], network.bottom[last]
    N_low, D_low = network.top_low[last], network.bottom_low[last]
    top, bottom = program.parts[last, TOP], program.parts[last, BOTTOM]
    n = port.forms[k, DEGREE]
    power_D, power_N, dropped = port.forms[k, POWER_D], port.forms[k, POWER_N], port.forms[k, DROPPED]
    for i in range(n + 2):
        if i < fraction.a.size:
            fraction.a[i], fraction.b[i], fraction.a_low[i], fraction.b_low[i] = 0.0, 0.0, 0.0, 0.0
    own, own_low, eps = port.coefficients[k], port.low[k], _rounding(program, fine)
    for which in range(4):
        degree = port.degrees[k, which]
        if degree >= 0:
            poles = which < 2
            result, low = (fraction.a, fraction.a_low) if poles else (fraction.b, fraction.b_low)
            first = n + dropped if poles else n - 1 + dropped
            p, p_low = own[which], own_low[which]
            if which % 2 == 0:
                first -= power_D
                add_product_of_polynomials(result, low, first, -1, p, p_low, degree, D, D_low, bottom, fine)
            else:
                first -= power_N
                add_product_of_polynomials(result, low, first, -1, p, p_low, degree, N, N_low, top, fine)
    for i in range(n + 1):
        fraction.a_error[i] = eps * fraction.a[i]


@part(borrowing=True)
def _rounding(program: Program, fine: bool) -> float:
    """Relative error of the coefficients, which are sums of positive products."""
    last = program.parts.shape[0] - 1
    roundings = 2.0 * last + program.parts[last, TOP] + program.parts[last, BOTTOM] + 6.0
    return float(roundings * (_FINE_EPS if fine else _EPS))


@part(borrowing=True)
def fill_shares(k: int, program: Program, port: Port, space: NormSpace, fine: bool) -> Any:
    """Fill the adjoints of N and D for function k, and give the error of its squared norm by roundings of a and b."""
    network, fraction = space.network, space.fraction
    last = program.parts.shape[0] - 1
    N, D = network.top[last], network.bottom[last]
    top, bottom = program.parts[last, TOP], program.parts[last, BOTTOM]
    N_, D_ = space.top_shares[k], space.bottom_shares[k]
    for i in range(top + 1):
        N_[i] = 0.0
    for i in range(bottom + 1):
        D_[i] = 0.0
    n = port.forms[k, DEGREE]
    power_D, power_N, dropped = port.forms[k, POWER_D], port.forms[k, POWER_N], port.forms[k, DROPPED]
    eps, error = _rounding(program, fine), 0.0
    for which in range(4):
        degree = port.degrees[k, which]
        poles = which < 2
        adjoint = fraction.a_adjoint if poles else fraction.b_adjoint
        first = n + dropped if poles else n - 1 + dropped
        own = port.coefficients[k, which]
        for i in range(degree + 1):
            if own[i] == 0.0:
                continue
            if which % 2 == 0:
                for j in range(bottom + 1):
                    share = adjoint[first - power_D - i - j] * own[i]
                    D_[j] += share
                    error += eps * abs(share * D[j])
            else:
                for j in range(top + 1):
                    share = adjoint[first - power_N - i - j] * own[i]
                    N_[j] += share
                    error += eps * abs(share * N[j])
    return error


@part(borrowing=True)
def fill_squares(program: Program, port: Port, space: NormSpace, fine: bool) -> Any:
    """Fill the squared norms, the shares of their gradients and the groups' sums; the largest relative error.

    Infinite or nan where a function is not stable, or seems so by rounding.
    """
    functions, known = port.weights.size, 1.0
    for g in range(space.sums.size):
        space.sums[g], space.errors[g] = 0.0, 0.0
    for k in range(functions):
        fill_fraction(k, program, port, space, fine)
        n = port.forms[k, DEGREE]
        square = fine_forward(n, space.fraction) if fine else forward(n, space.fraction)
        error = backward(n, space.fraction, fine) + fill_shares(k, program, port, space, fine)
        known = known * is_between(square, -1.0, np.inf)
        g = int(port.groups[k])
        space.sums[g] += port.weights[k] * square
        space.errors[g] += port.weights[k] * error
    worst = 0.0
    for g in range(space.sums.size):
        error = space.errors[g] / larger(space.sums[g], _NOTHING)
        known = known * is_between(error, -1.0, np.inf)
        worst = larger(worst, error)
    return worst / known


@part(borrowing=True)
def _fill_differences(values: Array, program: Program, port: Port, space: NormSpace, gradient: Array) -> None:
    """Fill the gradient with differences in twice the precision, where adjoints in one would cancel."""
    for i in range(gradient.size):
        at, known, difference = values[i], True, 0.0
        for sign in (1.0, -1.0):
            values[i] = at * (1.0 + sign * _DIFFERENCE)
            admittance(values, program, space.network, True)
            known = known and fill_squares(program, port, space, True) <= ACCURATE
            for g in range(space.sums.size):
                difference += sign * space.slopes[g] * np.sqrt(space.sums[g])
        values[i] = at
        if known:
            gradient[i] = difference / (2.0 * _DIFFERENCE * at)


@part(borrowing=True)
def index_of(space: NormSpace) -> Any:
    """The index by the groups' sums."""
    value = 0.0
    for g in range(space.sums.size):
        value += root(space.sums[g])
    return value


@part(borrowing=True)
def _fill_adjoints(program: Program, port: Port, space: NormSpace) -> None:
    """Fill the adjoints of the network's N and D, for the objective, from the shares of each function."""
    last = program.parts.shape[0] - 1
    N_, D_ = space.network.top_adjoint[last], space.network.bottom_adjoint[last]
    top, bottom = program.parts[last, TOP], program.parts[last, BOTTOM]
    for i in range(top + 1):
        N_[i] = 0.0
    for i in range(bottom + 1):
        D_[i] = 0.0
    for k in range(port.weights.size):
        g = int(port.groups[k])
        root = np.sqrt(space.sums[g])
        share = 0.5 * port.weights[k] * space.slopes[g] / root if root > 0.0 else 0.0
        for i in range(top + 1):
            N_[i] += share * space.top_shares[k, i]
        for i in range(bottom + 1):
            D_[i] += share * space.bottom_shares[k, i]


@part(borrowing=True)
def index_in(values: Array, program: Program, port: Port, space: NormSpace, gradient: Array) -> Any:
    """The index for element values (leaves,), its gradient over them if there is room for it, and its relative error.

    The error is a bound at first order, infinite where the index is not known (the mechanism is not stable, or twice
    the precision does not suffice).
    """
    error, fine = _known_squares(values, program, port, space)
    if not error <= ACCURATE:
        return np.inf, np.inf
    value = index_of(space)
    if gradient.size > 0:
        _fill_gradient(values, program, port, space, fine, gradient)
    return value, 0.5 * error


@part(borrowing=True)
def excess_in(
    values: Array, program: Program, port: Port, trade_off: TradeOff, space: NormSpace, gradient: Array
) -> float:
    """Smooth maximum of the excesses (criterion - aim) / size, scaled, with its gradient as `index_in`.

    It grows with each criterion, so that no design is better in all than its minimum. It is infinite where an index
    is not known.
    """
    error, fine = _known_squares(values, program, port, space)
    if not error <= ACCURATE:
        return np.inf
    worst, total = -np.inf, 0.0
    for i in range(trade_off.aims.size):
        worst = max(worst, _excess(i, trade_off, space))
    for i in range(trade_off.aims.size):
        total += np.exp(SHARP * (_excess(i, trade_off, space) - worst))
    if gradient.size > 0:
        for g in range(space.slopes.size):
            i = trade_off.criterion[g]
            share = np.exp(SHARP * (_excess(i, trade_off, space) - worst)) / total
            space.slopes[g] = trade_off.scale * share / trade_off.sizes[i]
        _fill_gradient(values, program, port, space, fine, gradient)
    return float(trade_off.scale * (worst + np.log(total) / SHARP))


@part(borrowing=True)
def _excess(i: int, trade_off: TradeOff, space: NormSpace) -> float:
    value = 0.0
    for g in range(space.sums.size):
        if trade_off.criterion[g] == i:
            value += np.sqrt(space.sums[g])
    return float((value - trade_off.aims[i]) / trade_off.sizes[i])


@part(borrowing=True)
def _known_squares(values: Array, program: Program, port: Port, space: NormSpace) -> Any:
    """Fill the squared norms; their relative error, and whether they took twice the precision."""
    admittance(values, program, space.network, False)
    error, fine = fill_squares(program, port, space, False), False
    if not error <= ACCURATE:
        fine = True
        admittance(values, program, space.network, True)
        error = fill_squares(program, port, space, True)
    return error, fine


@part(borrowing=True)
def _fill_gradient(values: Array, program: Program, port: Port, space: NormSpace, fine: bool, gradient: Array) -> None:
    """Fill the gradient over element values of an objective with the slopes of `space`."""
    _fill_adjoints(program, port, space)
    for i in range(gradient.size):
        gradient[i] = 0.0
    admittance_adjoint(program, space.network, gradient)
    if fine:
        _fill_differences(values, program, port, space, gradient)


@kernel("indices of a network", typed=True)
def indices(points: Matrix, program: Program, port: Port, gradients: Matrix, errors: Floats) -> Floats:
    """Index at each row of element values (designs, leaves), infinite where unknown, and its relative errors.

    `gradients` is filled if it has as many rows.
    """
    space = norm_space(program, port)
    none = np.zeros(0)
    result = np.zeros(points.shape[0])
    for i in range(points.shape[0]):
        gradient = gradients[i] if gradients.shape[0] > 0 else none
        result[i], errors[i] = index_in(points[i], program, port, space, gradient)
    return result


@kernel("indices of an admittance", typed=True)
def admittance_indices(
    tops: Matrix, bottoms: Matrix, program: Program, port: Port, top_gradients: Matrix, bottom_gradients: Matrix
) -> Floats:
    """Index at each row of coefficients of N and D, from the constant upwards, infinite where unknown.

    The program has one part with the degrees of N and D, which are taken as exact. The gradients over the coefficients
    are filled if they have as many rows.
    """
    space = norm_space(program, port)
    N, D = space.network.top[0], space.network.bottom[0]
    result = np.zeros(tops.shape[0])
    for row in range(tops.shape[0]):
        for i in range(tops.shape[1]):
            N[i] = tops[row, i]
        for i in range(bottoms.shape[1]):
            D[i] = bottoms[row, i]
        error = fill_squares(program, port, space, False)
        if not error <= ACCURATE:
            error = fill_squares(program, port, space, True)
        result[row] = index_of(space) if error <= ACCURATE else np.inf
        if row < top_gradients.shape[0] and result[row] < np.inf:
            _fill_adjoints(program, port, space)
            for i in range(tops.shape[1]):
                top_gradients[row, i] = space.network.top_adjoint[0, i]
            for i in range(bottoms.shape[1]):
                bottom_gradients[row, i] = space.network.bottom_adjoint[0, i]
    return result
