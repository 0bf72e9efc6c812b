"""Modes of a piecewise-linear mechanism: from what slips, sticks, touches and opens to matrices.

With the velocities a that inertia carries, the positions g, the velocities w of massless motions, the forces F of the
nonlinear elements, and the roads' z, z', z'' and forces f of `Mechanics`:

    M a' + C_aw w + H_a^T F = -C_aa a - C_az z' - S_ag g - S_az z - M_z z'' + F_a f
           C_ww w + H_w^T F = -C_aw^T a - C_wz z' - S_wg g - S_wz z
    g' = P_a a + P_w w + P_z z'

An element i is either free, with F_i given (slip, open gap), or locked (stick, contact), with the rate of its
elongation H_a a + H_w w + H_z z' zero and F_i unknown. What a lock asks of massless velocities is met at once; what it
asks of inertial ones (the rows L) is differentiated, and must already be true when the mode begins. Massless motions
that only springs resist (Z) follow from the rate of the springs' balance, and those that nothing resists (Y) stay put;
their balance must be true too. These entry conditions, and the jump that would make them true, are kept with the mode.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inerter.kernels.arrays import FRICTION, GAP, Flags, Ints, MapRows, Matrix, Mechanics, Mode, Sizes
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import (
    absolute,
    add_block,
    block,
    drop_rounding,
    identity,
    inner,
    is_zero_row,
    product,
    set_rows,
    set_to_zero,
    solve_scaled,
    transpose,
)
from inerter.kernels.locking import Bases, Locks, Rates, bases_of, can_be_in, is_locked, limit_of, locks_of, rates_of


class Balance(NamedTuple):
    """Right-hand sides of the balances, and the rows that are differentiated."""

    sides: Matrix  # (na + nw, width)
    on_w: Matrix  # those of massless motions
    spring_rate: Matrix  # rate of the springs' balance, over (a, w, z')
    velocity: Matrix  # of inertial locks, over a ...
    road_velocity: Matrix  # ... and z'


class Solution(NamedTuple):
    """(a', w, forces of the locks) over the columns of maps, and the sizes that bound their rounding."""

    eta: Matrix
    bound: Matrix
    regular: bool


@kernel("modes of motion", typed=True)
def build(mechanics: Mechanics, mode: Mode) -> bool:
    """Fill one mode's maps, reaction, conditions and limits for its elements' states; False if it is singular."""
    sizes, rows = mechanics.sizes, mechanics.rows
    rates = rates_of(sizes, mechanics.rates)
    locks = locks_of(sizes, mechanics.kind, rates.locks, mode.state)
    bases = bases_of(rates, locks)
    balance = balance_of(mechanics, mode.state, rates, locks, bases)
    solution = solve_balance(sizes, mechanics.balance, balance, locks, bases)
    if not solution.regular:
        return False
    set_to_zero(mode.maps)
    fill_rates(sizes, rates.positions, solution, mode.maps)
    fill_eta(sizes, rows.eta, locks.held, solution, mode.maps)
    fill_guards(mechanics, mode, rates.locks, locks.still, solution)
    fill_outputs(rows, mechanics.over, mode.maps)
    fill_entry(sizes, rows.entry, balance, bases, mode)
    if not fill_reaction(sizes, mechanics.balance, rates, locks, bases, balance, mode.reaction):
        return False
    project_onto_entry(sizes, rows, mode)
    set_entry_limits(mechanics, mode, locks.still)
    return True


@part(typed=True, apart=True)
def balance_of(mechanics: Mechanics, state: Ints, rates: Rates, locks: Locks, bases: Bases) -> Balance:
    """Right-hand sides with the forces of what slips, and the rates of the springs' balance and of inertial locks."""
    sizes = mechanics.sizes
    na, n, nr, width = sizes.inertial, sizes.states, sizes.roads, mechanics.balance.shape[1]
    nv = na + sizes.massless
    sides = block(mechanics.balance, 0, nv, nv, width)
    for e in range(sizes.elements):
        if mechanics.kind[e] == FRICTION:
            for j in range(nv):
                sides[j, sides.shape[1] - 1] -= limit_of(mechanics.limits, e, state[e]) * rates.locks[e, j]
    spring_rate = product(inner(bases.sprung, block(sides, na, nv, na, n)), rates.positions)
    add_block(spring_rate, 0, nv, inner(bases.sprung, block(sides, na, nv, n, n + nr)), 1.0)
    on_w = block(sides, na, nv, 0, sides.shape[1])
    velocity, road_velocity = lock_velocities(bases.inertial, locks.on_a), lock_velocities(bases.inertial, locks.on_z)
    return Balance(sides, on_w, spring_rate, velocity, road_velocity)


@part(typed=True, apart=True)
def lock_velocities(forces: Matrix, locks: Matrix) -> Matrix:
    """Velocities across locks, with rounding set to zero, which at rest would look like a motion."""
    found = inner(forces, locks)
    drop_rounding(found, inner(absolute(forces), absolute(locks)))
    return found


@part(typed=True, apart=True)
def solve_balance(sizes: Sizes, inertia: Matrix, balance: Balance, locks: Locks, bases: Bases) -> Solution:
    """Inertial accelerations, massless velocities and forces of the locks, from as many equations."""
    nv, nl, width = balance.sides.shape[0], locks.held.shape[0], balance.sides.shape[1]
    S, right = np.zeros((nv + nl, nv + nl)), np.zeros((nv + nl, width))
    fill_equations(sizes, inertia, balance, locks, bases, S, right)
    solved = np.zeros((nv + nl, width + nv + nl))
    add_block(solved, 0, 0, right, 1.0)
    add_block(solved, 0, width, identity(nv + nl), 1.0)
    if not solve_scaled(S, solved):
        return Solution(right, right, False)
    eta, bound = block(solved, 0, nv + nl, 0, width), absolute(right)  # of the residual that elimination leaves
    add_block(bound, 0, 0, product(S, absolute(eta)), 1.0)
    bound = product(absolute(block(solved, 0, nv + nl, width, width + nv + nl)), bound)
    drop_rounding(eta, bound)
    return Solution(eta, bound, True)


@part(typed=True, apart=True)
def fill_equations(
    sizes: Sizes, inertia: Matrix, balance: Balance, locks: Locks, bases: Bases, S: Matrix, right: Matrix
) -> None:
    """Fill S and `right` with all balances, then with the loose motions and the locks."""
    na, n, nr, nv = sizes.inertial, sizes.states, sizes.roads, balance.sides.shape[0]
    add_block(S, 0, 0, block(inertia, 0, na, 0, nv), 1.0)
    add_block(S, 0, nv, transpose(locks.on_a), 1.0)
    add_block(right, 0, 0, block(balance.sides, 0, na, 0, right.shape[1]), 1.0)
    row = na
    # balances of massless motions that something damps or locks
    add_block(S, row, na, inner(bases.others, block(inertia, na, nv, na, nv)), 1.0)
    add_block(S, row, nv, inner(bases.others, transpose(locks.on_w)), 1.0)
    add_block(right, row, 0, inner(bases.others, balance.on_w), 1.0)
    row += bases.others.shape[1]
    # the rate of the springs' balance
    nz, rate = bases.sprung.shape[1], balance.spring_rate
    add_block(S, row, na, block(rate, 0, nz, na, nv), -1.0)
    add_block(right, row, 0, block(rate, 0, nz, 0, na), 1.0)
    add_block(right, row, n + nr, block(rate, 0, nz, nv, rate.shape[1]), 1.0)
    row += nz
    # loose motions
    add_block(S, row, na, transpose(bases.loose), 1.0)
    row += bases.loose.shape[1]
    # locks that massless motions meet at once, and locks between inertial motions
    add_block(S, row, na, inner(bases.at_once, locks.on_w), 1.0)
    add_block(right, row, 0, inner(bases.at_once, locks.on_a), -1.0)
    add_block(right, row, n + nr, inner(bases.at_once, locks.on_z), -1.0)
    row += bases.at_once.shape[1]
    add_block(S, row, 0, balance.velocity, 1.0)
    add_block(right, row, n + 2 * nr, balance.road_velocity, -1.0)


@part(typed=True, apart=True)
def fill_rates(sizes: Sizes, positions: Matrix, solution: Solution, maps: Matrix) -> None:
    """Rates of the state: a', and g' = P_a a + P_w w + P_z z'."""
    na, n, nr, width = sizes.inertial, sizes.states, sizes.roads, maps.shape[1]
    ng, nv = n - na, na + sizes.massless
    on_w = block(positions, 0, ng, na, nv)
    add_block(maps, 0, 0, block(solution.eta, 0, na, 0, width), 1.0)
    add_block(maps, na, 0, product(on_w, block(solution.eta, na, nv, 0, width)), 1.0)
    add_block(maps, na, 0, block(positions, 0, ng, 0, na), 1.0)
    add_block(maps, na, n + nr, block(positions, 0, ng, nv, positions.shape[1]), 1.0)
    grown = block(maps, na, n, 0, width)
    bound = absolute(grown)
    add_block(bound, 0, 0, product(absolute(on_w), block(solution.bound, na, nv, 0, width)), 1.0)
    drop_rounding(grown, bound)
    set_rows(maps, na, grown)


@part(typed=True, apart=True)
def fill_eta(sizes: Sizes, eta: int, held: Ints, solution: Solution, maps: Matrix) -> None:
    """Rows from `eta` on: a', w, and the forces of what is locked."""
    nv, width = sizes.inertial + sizes.massless, maps.shape[1]
    add_block(maps, eta, 0, block(solution.eta, 0, nv, 0, width), 1.0)
    for i in range(held.shape[0]):
        add_block(maps, eta + nv + held[i], 0, block(solution.eta, nv + i, nv + i + 1, 0, width), 1.0)


@part(typed=True, apart=True)
def fill_guards(mechanics: Mechanics, mode: Mode, locks: Matrix, still: Flags, solution: Solution) -> None:
    """Fill the guard of each element: a row, and the interval of its value in the present state."""
    sizes, maps, width = mechanics.sizes, mode.maps, mode.maps.shape[1]
    na, nv = sizes.inertial, sizes.inertial + sizes.massless
    for e in range(sizes.elements):
        row, own, state = mechanics.rows.guard + e, mechanics.own_position[e], mode.state[e]
        force = mechanics.rows.eta + nv + e
        if still[e] and own >= 0:
            for j in range(width):
                maps[na + own, j] = 0.0
        limit_guard(mode.limits, e, state, mechanics.limits)
        if mechanics.kind[e] == FRICTION:
            maps[force, width - 1] += limit_of(mechanics.limits, e, state)
        if is_locked(mechanics.kind[e], state):  # its force
            add_block(maps, row, 0, block(maps, force, force + 1, 0, width), 1.0)
        elif mechanics.kind[e] == GAP:  # open: its elongation
            add_block(maps, row, na, block(mechanics.lengths, e, e + 1, 0, mechanics.lengths.shape[1]), 1.0)
        elif not still[e]:
            set_rows(maps, row, slip_of(sizes, block(locks, e, e + 1, 0, locks.shape[1]), solution))


@part(typed=True, apart=True)
def slip_of(sizes: Sizes, lock: Matrix, solution: Solution) -> Matrix:
    """The velocity across an element, from its row of rates."""
    na, nv, width = sizes.inertial, sizes.inertial + sizes.massless, solution.eta.shape[1]
    on_w, slip = block(lock, 0, 1, na, nv), np.zeros((1, width))
    add_block(slip, 0, 0, block(lock, 0, 1, 0, na), 1.0)
    add_block(slip, 0, sizes.states + sizes.roads, block(lock, 0, 1, nv, lock.shape[1]), 1.0)
    add_block(slip, 0, 0, product(on_w, block(solution.eta, na, nv, 0, width)), 1.0)
    bound = absolute(slip)
    add_block(bound, 0, 0, product(absolute(on_w), block(solution.bound, na, nv, 0, width)), 1.0)
    drop_rounding(slip, bound)
    return slip


@part(typed=True, apart=True)
def limit_guard(guards: Matrix, e: int, state: int, limits: Matrix) -> None:
    """Set the interval of a guard: force limits of a lock, or the side of a slip or an open gap."""
    guards[e, 0], guards[e, 1] = -np.inf, np.inf
    if can_be_in(limits, e, 0):
        guards[e, 0] = limits[e, 0] if state == 0 else (0.0 if state > 0 else -np.inf)
        guards[e, 1] = limits[e, 1] if state == 0 else (0.0 if state < 0 else np.inf)


@part(typed=True, apart=True)
def fill_outputs(first: MapRows, over: Matrix, maps: Matrix) -> None:
    """Outputs over the state and inputs, by what they are over these and (a', w, F)."""
    inputs = maps.shape[1] - 1
    add_block(maps, first.output, 0, block(over, 0, over.shape[0], 0, inputs), 1.0)
    on_eta = block(over, 0, over.shape[0], inputs, over.shape[1])
    add_block(maps, first.output, 0, product(on_eta, block(maps, first.eta, first.entry, 0, maps.shape[1])), 1.0)


@part(typed=True, apart=True)
def fill_entry(sizes: Sizes, first: int, balance: Balance, bases: Bases, mode: Mode) -> None:
    """Conditions on entry: velocities across locks, balance of springs, balance of what is loose."""
    nc, nz = bases.inertial.shape[1], bases.sprung.shape[1]
    mode.conditions[0], mode.conditions[1], mode.conditions[2] = nc, nz, bases.loose.shape[1]
    add_block(mode.maps, first, 0, balance.velocity, 1.0)
    add_block(mode.maps, first, sizes.states + sizes.roads, balance.road_velocity, 1.0)
    add_block(mode.maps, first + nc, 0, inner(bases.sprung, balance.on_w), 1.0)
    add_block(mode.maps, first + nc + nz, 0, inner(bases.loose, balance.on_w), 1.0)


@part(typed=True, apart=True)
def fill_reaction(
    sizes: Sizes, inertia: Matrix, rates: Rates, locks: Locks, bases: Bases, balance: Balance, reaction: Matrix
) -> bool:
    """Jumps that fulfil the conditions, and their impulses on the elements; False if there are none."""
    set_to_zero(reaction)
    na, n, nv, ng = sizes.inertial, sizes.states, sizes.inertial + sizes.massless, sizes.states - sizes.inertial
    nc, nz = bases.inertial.shape[1], bases.sprung.shape[1]
    locks_w = block(rates.locks, 0, sizes.elements, na, nv)
    impulse, inverse = transpose(balance.velocity), identity(nc)
    if not solve_scaled(block(inertia, 0, na, 0, na), impulse):
        return False
    if not solve_scaled(product(balance.velocity, impulse), inverse):
        return False
    add_block(reaction, 0, 0, product(impulse, inverse), -1.0)
    forces = product(bases.inertial, inverse)
    for i in range(locks.held.shape[0]):
        add_block(reaction, n + locks.held[i], 0, block(forces, i, i + 1, 0, nc), 1.0)
    inverse = identity(nz)
    if not solve_scaled(product(block(balance.spring_rate, 0, nz, na, nv), bases.sprung), inverse):
        return False
    moved = product(bases.sprung, inverse)
    add_block(reaction, na, nc, product(block(rates.positions, 0, ng, na, nv), moved), -1.0)
    add_block(reaction, n, nc, product(locks_w, moved), -1.0)
    add_block(reaction, n, nc + nz, product(locks_w, bases.loose), 1.0)
    return True


@part(typed=True, apart=True)
def project_onto_entry(sizes: Sizes, first: MapRows, mode: Mode) -> None:
    """Project the state in all rows onto the conditions on entry, so that drift off them has no effect."""
    n, entry, conditions = sizes.states, first.entry, mode.conditions[0] + mode.conditions[1]
    maps, width = mode.maps, mode.maps.shape[1]
    add_block(maps, first.projected_state, 0, identity(n), 1.0)
    if conditions == 0:
        return
    mended = block(mode.reaction, 0, n, 0, conditions)
    asked, bound, rows = block(maps, entry, entry + conditions, 0, width), absolute(maps), maps.shape[0]
    add_block(bound, 0, 0, product(product(block(bound, 0, rows, 0, n), absolute(mended)), absolute(asked)), 1.0)
    for _ in range(2):  # what rounding of the first time leaves, the second removes
        add_block(maps, 0, 0, product(product(block(maps, 0, rows, 0, n), mended), asked), 1.0)
    drop_rounding(maps, bound)
    set_rows(maps, entry, asked)


@part(typed=True, apart=True)
def set_entry_limits(mechanics: Mechanics, mode: Mode, still: Flags) -> None:
    """Copy the limits to those on entry, then remove the limits of constant guards.

    A slip whose velocity is zero whatever happens sticks: its limits are then such that they cannot be kept.
    """
    maps, guard, n, k = mode.maps, mechanics.rows.guard, mechanics.sizes.states, mechanics.sizes.elements
    limits, width = mode.limits, maps.shape[1]
    guards, rates = block(maps, guard, guard + k, 0, n), block(maps, 0, n, 0, width)
    change = product(guards, rates)
    drop_rounding(change, product(absolute(guards), absolute(rates)))
    for e in range(k):
        state = mode.state[e]
        slips = mechanics.kind[e] == FRICTION and state != 0 and not still[e] and can_be_in(mechanics.limits, e, 0)
        if slips and is_zero_row(maps, guard + e):
            limits[e, 0 if state > 0 else 1] = state
        mode.entry_limits[e, 0], mode.entry_limits[e, 1] = limits[e, 0], limits[e, 1]
        moves = not is_zero_row(change, e)
        for j in range(n, width - 1):
            moves = moves or maps[guard + e, j] != 0.0
        if not moves:
            limits[e, 0], limits[e, 1] = -np.inf, np.inf
