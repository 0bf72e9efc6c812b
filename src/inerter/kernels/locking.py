"""Locked elements of a mode, and the massless motions that remain free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inerter.kernels.arrays import FRICTION, Flags, Ints, Matrix, Sizes
from inerter.kernels.decorators import part
from inerter.kernels.dense import block, is_independent, null_space, product, transpose


class Rates(NamedTuple):
    """Rates over (a, w, z')."""

    positions: Matrix
    locks: Matrix  # elongations of the elements that can be locked
    dampers: Matrix  # elongations over w alone
    springs: Matrix


class Locks(NamedTuple):
    """Independent locked elements and their rows."""

    held: Ints  # numbers of the elements
    still: Flags  # whether those hold each element
    on_a: Matrix  # H of these elements
    on_w: Matrix
    on_z: Matrix


class Bases(NamedTuple):
    """Directions, as columns: of the locks' forces (L, at once), and of massless motions (Z, Y) and their balances."""

    inertial: Matrix  # L
    at_once: Matrix
    sprung: Matrix  # Z
    loose: Matrix  # Y
    others: Matrix  # balances of motions that something damps or locks


@part(typed=True, apart=True)
def rates_of(sizes: Sizes, rates: Matrix) -> Rates:
    """The parts of the table of rates."""
    na, k, ng = sizes.inertial, sizes.elements, sizes.states - sizes.inertial
    nv, width = na + sizes.massless, rates.shape[1]
    return Rates(
        block(rates, 0, ng, 0, width),
        block(rates, ng, ng + k, 0, width),
        block(rates, ng + k, ng + k + sizes.dampers, na, nv),
        block(rates, ng + k + sizes.dampers, rates.shape[0], na, nv),
    )


@part(typed=True, apart=True)
def locks_of(sizes: Sizes, kind: Ints, locks: Matrix, state: Ints) -> Locks:
    """Locked elements whose rows are independent, and whether those hold each element.

    An element that depends on independent locks does not move; if it is locked itself, it is so without force.
    """
    k, na, nv, width = sizes.elements, sizes.inertial, sizes.inertial + sizes.massless, locks.shape[1]
    moving = block(locks, 0, k, 0, nv)
    basis, residual = np.zeros((k, nv)), np.zeros(nv)
    chosen, still = np.zeros(k, np.int64), np.zeros(k, np.bool_)
    count = 0
    for e in range(k):
        if is_locked(kind[e], state[e]) and is_independent(moving[e], basis, count, residual):
            for j in range(nv):
                basis[count, j] = residual[j]
            chosen[count] = e
            count += 1
    H = np.zeros((count, width))
    for e in range(k):
        still[e] = not is_independent(moving[e], basis, count, residual)
    for i in range(count):
        for j in range(width):
            H[i, j] = locks[chosen[i], j]
    H_a, H_w, H_z = block(H, 0, count, 0, na), block(H, 0, count, na, nv), block(H, 0, count, nv, width)
    return Locks(chosen[:count].copy(), still, H_a, H_w, H_z)


@part(typed=True, apart=True)
def is_locked(kind: int, state: int) -> bool:
    """Whether an element holds its elongation: friction that sticks, a gap that touches."""
    return (state == 0) == (kind == FRICTION)


@part(typed=True, borrowing=True)
def can_be_in(limits: Matrix, e: int, state: int) -> bool:
    """Whether an element can be in a state: in the middle one if its limits are apart, in another if that is finite.

    What has both limits in one place is always there, in state 1.
    """
    if not limits[e, 0] < limits[e, 1]:
        return state == 1
    return state == 0 or abs(limit_of(limits, e, state)) < np.inf


@part(typed=True, borrowing=True)
def limit_of(limits: Matrix, e: int, state: int) -> float:
    """The force or elongation of an element in state -1 or 1; zero in its middle state."""
    if state == 0:
        return 0.0
    return float(limits[e, 1] if state > 0 else limits[e, 0])


@part(typed=True, apart=True)
def bases_of(rates: Rates, locks: Locks) -> Bases:
    """Bases of the massless motions that locks leave free, divided into damped, sprung and loose ones."""
    free = null_space(locks.on_w).null
    forces = null_space(transpose(locks.on_w))
    undamped = product(free, null_space(product(rates.dampers, free)).null)
    parts = null_space(product(rates.springs, undamped))
    sprung, loose = product(undamped, parts.complement), product(undamped, parts.null)
    others = null_space(transpose(undamped)).null
    return Bases(forces.null, forces.complement, sprung, loose, others)
