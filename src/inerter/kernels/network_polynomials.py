"""Admittance of a network as a fraction of polynomials in s, with its adjoint, compiled.

The admittance (force over velocity) is s^v n(s) / d(s) with v in {-1, 0, 1}, where n and d have positive coefficients
and no root at zero. Powers of s and degrees follow from the structure of the network alone, so they are integers of the
`Program`, and a coefficient is a sum of products of positive numbers, right to a few roundings.

A program lists the parts of a network, each after those that it is made of. Polynomials are stored from the constant
upwards.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import IntTable, Matrix
from inerter.kernels.decorators import part
from inerter.kernels.double_double import add_product

Array = Any
LEAF, PARALLEL, SERIES, BRIDGE = 0, 1, 2, 3
OPERATION, FIRST, SECOND, SHIFT_FIRST, SHIFT_SECOND, TOP, BOTTOM = range(7)  # columns of `Program.parts`
ARMS, SPANNING = 5, 8  # of a bridge: arms, and spanning trees as products of arms
TREES = np.array(  # arms a, b, c, d, e by number: products of three in the numerator of a bridge's admittance
    [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3], [0, 1, 4], [0, 3, 4], [1, 2, 4], [2, 3, 4]]
)
FORESTS = np.array(  # and of two in its denominator
    [[0, 2], [0, 3], [1, 2], [1, 3], [0, 4], [1, 4], [2, 4], [3, 4]]
)
_ONE, _ZERO = np.ones(1), np.zeros(1)


class Program(NamedTuple):
    """Parts of a network in the order in which they are computed; the last one is the network."""

    parts: IntTable  # (parts, 7): operation, its operands, powers of s of its two terms, degrees of n and d
    bridges: IntTable  # (bridges, 5 + 16): arms, then the powers of s of the terms of n and of d


class Polynomials(NamedTuple):
    """Polynomials of the parts of a network and their adjoints (parts, size), with room for products."""

    top: Matrix
    bottom: Matrix
    top_low: Matrix  # what is to be added to them in twice the precision
    bottom_low: Matrix
    top_adjoint: Matrix
    bottom_adjoint: Matrix
    room: Matrix  # (4, size)


@part(borrowing=True)
def add_product_of_polynomials(
    result: Array,
    low: Array,
    first: int,
    way: int,
    p: Array,
    p_low: Array,
    p_degree: int,
    q: Array,
    q_low: Array,
    q_degree: int,
    fine: bool,
) -> None:
    """Add p q to `result`, its constant at place `first`, higher powers above (`way` is 1) or below it (-1).

    If `fine`, in twice the precision, with what is to be added in `low`.
    """
    for i in range(p_degree + 1):
        for j in range(q_degree + 1):
            k = first + way * (i + j)
            if fine:
                high, rest = add_product(result[k], low[k], p[i], q[j])
                rest += p[i] * q_low[j] + p_low[i] * q[j]
                result[k] = high + rest
                low[k] = rest - (result[k] - high)
            else:
                result[k] += p[i] * q[j]


@part(borrowing=True)
def _add_correlation(adjoint: Array, shift: int, of: Array, q: Array, q_degree: int, degree: int) -> None:
    """Add to the adjoint of p what the adjoint `of` of s^shift p q makes of it."""
    for i in range(degree + 1):
        total = 0.0
        for j in range(q_degree + 1):
            total += of[shift + i + j] * q[j]
        adjoint[i] += total


@part(borrowing=True)
def _clear(result: Array, degree: int) -> None:
    for i in range(degree + 1):
        result[i] = 0.0


@part(borrowing=True)
def _is_factor(term: int, arm: int, in_top: bool) -> bool:
    """Whether a term of a bridge's n (or d) has the numerator of an arm as a factor, not its denominator."""
    found = False
    for i in range(3 if in_top else 2):
        found = found or (TREES[term, i] if in_top else FORESTS[term, i]) == arm
    return found


@part(borrowing=True)
def _bridge_product(
    program: Program, room: Polynomials, row: int, term: int, in_top: bool, left_out: int, fine: bool
) -> int:
    """Fill room.room[0] (and, if `fine`, [1]) with a term of a bridge's n (or d), one arm left out; its degree.

    Without its power of s.
    """
    parts, bridges = program
    work = room.room
    work[0, 0], work[1, 0], degree = 1.0, 0.0, 0
    for arm in range(ARMS):
        if arm == left_out:
            continue
        child = bridges[row, arm]
        if _is_factor(term, arm, in_top):
            factor, low, own = room.top[child], room.top_low[child], parts[child, TOP]
        else:
            factor, low, own = room.bottom[child], room.bottom_low[child], parts[child, BOTTOM]
        _clear(work[2], degree + own)
        if fine:
            _clear(work[3], degree + own)
        add_product_of_polynomials(work[2], work[3], 0, 1, work[0], work[1], degree, factor, low, own, fine)
        degree += own
        for i in range(degree + 1):
            work[0, i] = work[2, i]
            if fine:
                work[1, i] = work[3, i]
    return degree


@part(borrowing=True)
def admittance(values: Array, program: Program, room: Polynomials, fine: bool) -> None:
    """Fill `room` with numerator and denominator of every part, for the element values (leaves,) [SI].

    If `fine`, in twice the precision.
    """
    parts, bridges = program
    for k in range(parts.shape[0]):
        top, bottom, top_low, bottom_low = room.top[k], room.bottom[k], room.top_low[k], room.bottom_low[k]
        operation, first, second = parts[k, OPERATION], parts[k, FIRST], parts[k, SECOND]
        _clear(top, parts[k, TOP])
        _clear(bottom, parts[k, BOTTOM])
        if fine:
            _clear(top_low, parts[k, TOP])
            _clear(bottom_low, parts[k, BOTTOM])
        if operation == LEAF:
            top[0], bottom[0] = values[first], 1.0
            continue
        if operation == BRIDGE:
            work = room.room
            for term in range(SPANNING):
                degree = _bridge_product(program, room, first, term, True, -1, fine)
                shift = bridges[first, ARMS + term]
                add_product_of_polynomials(top, top_low, shift, 1, work[0], work[1], degree, _ONE, _ZERO, 0, fine)
                degree = _bridge_product(program, room, first, term, False, -1, fine)
                shift = bridges[first, ARMS + SPANNING + term]
                add_product_of_polynomials(bottom, bottom_low, shift, 1, work[0], work[1], degree, _ONE, _ZERO, 0, fine)
            continue
        n1, d1, n2, d2 = room.top[first], room.bottom[first], room.top[second], room.bottom[second]
        l1, m1, l2, m2 = room.top_low[first], room.bottom_low[first], room.top_low[second], room.bottom_low[second]
        N1, D1, N2, D2 = parts[first, TOP], parts[first, BOTTOM], parts[second, TOP], parts[second, BOTTOM]
        mixed, mixed_low = (top, top_low) if operation == PARALLEL else (bottom, bottom_low)
        add_product_of_polynomials(mixed, mixed_low, parts[k, SHIFT_FIRST], 1, n1, l1, N1, d2, m2, D2, fine)
        add_product_of_polynomials(mixed, mixed_low, parts[k, SHIFT_SECOND], 1, n2, l2, N2, d1, m1, D1, fine)
        if operation == PARALLEL:
            add_product_of_polynomials(bottom, bottom_low, 0, 1, d1, m1, D1, d2, m2, D2, fine)
        else:
            add_product_of_polynomials(top, top_low, 0, 1, n1, l1, N1, n2, l2, N2, fine)


@part(borrowing=True)
def admittance_adjoint(program: Program, room: Polynomials, gradient: Array) -> None:
    """Add to `gradient` (leaves,) what the adjoints of the last part's polynomials make of it.

    The adjoints of all other parts are overwritten.
    """
    parts, _bridges = program
    last = parts.shape[0] - 1
    for k in range(last):
        _clear(room.top_adjoint[k], parts[k, TOP])
        _clear(room.bottom_adjoint[k], parts[k, BOTTOM])
    for k in range(last, -1, -1):
        top, bottom = room.top_adjoint[k], room.bottom_adjoint[k]
        operation, first, second = parts[k, OPERATION], parts[k, FIRST], parts[k, SECOND]
        if operation == LEAF:
            gradient[first] += top[0]
            continue
        if operation == BRIDGE:
            _bridge_adjoint(program, room, k, top, True)
            _bridge_adjoint(program, room, k, bottom, False)
            continue
        n1, d1, n2, d2 = room.top[first], room.bottom[first], room.top[second], room.bottom[second]
        n1_, d1_ = room.top_adjoint[first], room.bottom_adjoint[first]
        n2_, d2_ = room.top_adjoint[second], room.bottom_adjoint[second]
        N1, D1, N2, D2 = parts[first, TOP], parts[first, BOTTOM], parts[second, TOP], parts[second, BOTTOM]
        mixed, product = (top, bottom) if operation == PARALLEL else (bottom, top)
        shift_first, shift_second = parts[k, SHIFT_FIRST], parts[k, SHIFT_SECOND]
        _add_correlation(n1_, shift_first, mixed, d2, D2, N1)
        _add_correlation(d2_, shift_first, mixed, n1, N1, D2)
        _add_correlation(n2_, shift_second, mixed, d1, D1, N2)
        _add_correlation(d1_, shift_second, mixed, n2, N2, D1)
        if operation == PARALLEL:
            _add_correlation(d1_, 0, product, d2, D2, D1)
            _add_correlation(d2_, 0, product, d1, D1, D2)
        else:
            _add_correlation(n1_, 0, product, n2, N2, N1)
            _add_correlation(n2_, 0, product, n1, N1, N2)


@part(borrowing=True)
def _bridge_adjoint(program: Program, room: Polynomials, k: int, adjoint: Array, in_top: bool) -> None:
    parts, bridges = program
    row = parts[k, FIRST]
    shifts = ARMS if in_top else ARMS + SPANNING
    for term in range(SPANNING):
        for arm in range(ARMS):
            degree = _bridge_product(program, room, row, term, in_top, arm, False)
            child = bridges[row, arm]
            chosen = _is_factor(term, arm, in_top)
            target = room.top_adjoint[child] if chosen else room.bottom_adjoint[child]
            own = parts[child, TOP] if chosen else parts[child, BOTTOM]
            _add_correlation(target, bridges[row, shifts + term], adjoint, room.room[0], degree, own)
