"""From a mode's matrices to the steps that a march makes: exact for inputs that are cubics over the step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from inerter.kernels.arrays import AT_ONCE, SHARP, Floats, Ints, MapRows, MarchShape, Matrix, Sizes
from inerter.kernels.decorators import kernel, part
from inerter.kernels.dense import add_block, balance, block, count_squarings, exponential, product

_ORDERS = 60  # of the series of a guard's sway, at most
_NEGLIGIBLE = 1e-20  # terms relative to the guard: what they and all further ones add is below rounding


class Channels(NamedTuple):
    """Inputs that move."""

    numbers: Ints  # of those of which a knot number is used, in order
    used: Ints  # the used knot numbers, among theirs alone


@part(typed=True, apart=True)
def over_chains(maps: Matrix, first: int, n: int, nr: int, channels: Ints, h: float, out: Matrix) -> None:
    """Rows of maps, from `first` on, over the state, the chains of integrators of some channels, and 1."""
    for i in range(out.shape[0]):
        row = maps[first + i]
        for j in range(n):
            out[i, j] = row[j]
        for at in range(channels.shape[0]):
            c = channels[at]
            if c < nr:
                out[i, n + 4 * at] = row[n + c]
                out[i, n + 4 * at + 1] = row[n + nr + c] / h
                out[i, n + 4 * at + 2] = row[n + 2 * nr + c] / (h * h)
            else:
                out[i, n + 4 * at] = row[n + 2 * nr + c]
        out[i, out.shape[1] - 1] = row[maps.shape[1] - 1]


@part(typed=True, apart=True)
def moving_channels(used: Ints) -> Channels:
    """Numbers of the channels of which a knot number is used, in order, and the used numbers among theirs alone."""
    channels, among = np.zeros(used.shape[0], np.int64), np.zeros(used.shape[0], np.int64)
    count = 0
    for i in range(used.shape[0]):
        if count == 0 or channels[count - 1] != used[i] // 4:
            channels[count] = used[i] // 4
            count += 1
        among[i] = 4 * (count - 1) + used[i] % 4
    return Channels(channels[:count].copy(), among)


@part(typed=True, apart=True)
def into_knots(rows: Matrix, n: int, used: Ints, out: Matrix, top: int) -> None:
    """Rows over the chains at the start of a step, as columns over the numbers z0, z1 - z0, h z0', h z1' of cubics."""
    size = rows.shape[1]
    numbers = np.zeros(size - 1 - n)
    for i in range(rows.shape[0]):
        for c in range(0, size - 1 - n, 4):
            y0, y1, y2, y3 = rows[i, n + c], rows[i, n + c + 1], rows[i, n + c + 2], rows[i, n + c + 3]
            numbers[c] = y0
            numbers[c + 1] = 6.0 * y2 - 12.0 * y3
            numbers[c + 2] = y1 - 4.0 * y2 + 6.0 * y3
            numbers[c + 3] = 6.0 * y3 - 2.0 * y2
        for j in range(n):
            out[j, top + i] = rows[i, j]
        for j in range(used.shape[0]):
            out[n + j, top + i] = numbers[used[j]]
        out[n + used.shape[0], top + i] = rows[i, size - 1]


@part(typed=True, apart=True)
def set_binary_units(A: Matrix, units: Floats) -> None:
    """Fill `units` with powers of two that balance A: a change to them is exact."""
    balance(A, units, np.empty(A.shape[0]))
    for i in range(A.shape[0]):
        units[i] = np.ldexp(1.0, int(np.floor(np.log2(units[i]))))


@part(typed=True, apart=True)
def _bound_sway(
    guards: Matrix, chain: Matrix, units: Floats, n: int, used: Ints, steps: Matrix, bends: int, at_once: int, top: int
) -> None:
    """One eighth of the largest second derivative of each guard over a step, as weights on absolute values.

    The chain is over states in these units. So many first terms as are computed `at_once` with a step go to the columns
    from `bends` on as they are, all others to those from `top` on. For the closest bound, the last terms go to the
    columns after these, and the first ones to those after that as they are.
    """
    k, columns, size = guards.shape[0], n + used.shape[0] + 1, chain.shape[0]
    term, power, plain, norm = np.zeros((columns, k)), np.empty((k, size)), np.empty((k, size)), 0.0
    for i in range(k):
        for j in range(size):
            power[i, j] = guards[i, j] * units[j]
    for j in range(size):
        total = 0.0
        for i in range(size):
            total += abs(chain[i, j])
        norm = max(norm, total)
    for order in range(1, _ORDERS):
        power, more = product(power, chain), False
        for i in range(k):
            largest, guard = 0.0, 0.0
            for j in range(size):
                power[i, j] /= order
                plain[i, j] = power[i, j] / units[j]
                largest, guard = max(largest, abs(power[i, j])), max(guard, abs(guards[i, j] * units[j]))
            more = more or largest > _NEGLIGIBLE * guard
        into_knots(plain, n, used, term, 0)
        weight = order * (order - 1) / 8.0
        for j in range(columns):
            for i in range(k):
                bend = weight * term[j, i]
                if 2 <= order < 2 + at_once:
                    steps[j, bends + (order - 2) * k + i] = bend
                else:
                    steps[j, top + i] += abs(bend)
                if 2 <= order < 2 + SHARP:
                    steps[j, top + order * k + i] = bend
                else:
                    steps[j, top + k + i] += abs(bend)
        if not more and order > 2.0 * norm:  # each further term is less than half of the one before
            break


@part(typed=True, apart=True)
def spectral_radius_bound(maps: Matrix, n: int) -> float:
    """About the spectral radius of the state matrix, from above: the 32nd root of a norm of its 32nd power [1/s]."""
    A = block(maps, 0, n, 0, n)
    logarithm, power = 0.0, 1.0
    for _ in range(6):
        norm = 0.0
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += abs(A[i, j])
            norm = max(norm, total)
        if norm == 0.0:
            return 0.0
        logarithm += power * np.log(norm)
        for i in range(n):
            for j in range(n):
                A[i, j] /= norm
        A = product(A, A)
        power *= 0.5
    return float(np.exp(logarithm))


@part(typed=True, apart=True)
def fill_second_step(steps: Matrix, shape: MarchShape) -> None:
    """Fill the lines of two steps: the second one follows from the state after the first."""
    n, m, first = shape.states, shape.inputs, shape.states + shape.inputs + 1 + shape.jumps
    once = block(steps, 0, n + m + 1, 0, shape.rows)
    twice = product(block(once, 0, n + m + 1, 0, n), block(once, 0, n, 0, shape.rows))
    add_block(steps, first, 0, block(twice, 0, n + m, 0, shape.rows), 1.0)
    add_block(steps, first + n + m, 0, block(once, n, n + m + 1, 0, shape.rows), 1.0)
    add_block(steps, first + n + 2 * m, 0, block(twice, n + m, n + m + 1, 0, shape.rows), 1.0)


@part(typed=True, apart=True)
def _fill_series(maps: Matrix, rows: int, n: int, steps: Matrix) -> None:
    """Fill the last lines of `steps`, for `flow.series`: columns of rates and guards, and 1 where a rate is."""
    columns = maps.shape[1]
    top = steps.shape[0] - columns - 1
    for i in range(rows):
        for j in range(columns):
            steps[top + j, i] = maps[i, j]
    for i in range(n):
        steps[top + columns, i] = 1.0


@kernel("steps of a mode", typed=True)
def discretise(
    sizes: Sizes, first: MapRows, used: Ints, shape: MarchShape, maps: Matrix, steps: Matrix, h: float
) -> float:
    """Exact flow of one mode over a step of length h, its guards and outputs there, and the guards' sway within it.

    The input over the step is a cubic: a chain of four integrators for every road and force that moves stands for it.
    `first` rows are those of the parts of `maps`; `steps` is zero before. Returns how far a Taylor series serves [s].
    """
    n, nr, k = sizes.states, sizes.roads, sizes.elements
    moving = moving_channels(used)
    size = n + 4 * moving.numbers.shape[0] + 1
    rate, guards, outputs = np.zeros((n, size)), np.zeros((k, size)), np.zeros((sizes.squares, size))
    over_chains(maps, 0, n, nr, moving.numbers, h, rate)
    over_chains(maps, first.guard, n, nr, moving.numbers, h, guards)
    over_chains(maps, first.output, n, nr, moving.numbers, h, outputs)
    chain = np.zeros((size, size))
    add_block(chain, 0, 0, rate, h)
    for c in range(moving.numbers.shape[0]):
        for j in range(3):
            chain[n + 4 * c + j, n + 4 * c + j + 1] = 1.0
    units, balanced = np.empty(size), np.empty((size, size))
    set_binary_units(chain, units)
    for i in range(size):
        for j in range(size):
            balanced[i, j] = chain[i, j] * units[j] / units[i]
    exact = exponential(balanced, count_squarings(balanced))
    for i in range(size):
        for j in range(size):
            exact[i, j] *= units[i] / units[j]
    into_knots(block(exact, 0, n, 0, size), n, moving.used, steps, 0)
    into_knots(product(guards, exact), n, moving.used, steps, n)
    into_knots(guards, n, moving.used, steps, n + k)
    into_knots(product(outputs, exact), n, moving.used, steps, n + 2 * k)
    rows = n + 2 * k + sizes.squares
    for c in range(min(nr, shape.jumps)):  # roads that jump: positions follow; with a force nothing does
        for i in range(n):
            steps[n + shape.inputs + 1 + c, i] = maps[i, n + nr + c]
    if shape.jumps > 0:
        into_knots(outputs, n, moving.used, steps, rows)
        rows += sizes.squares
    at_once = AT_ONCE if shape.sharp else 0
    _bound_sway(guards, balanced, units, n, moving.used, steps, rows, at_once, shape.rows)
    fill_second_step(steps, shape)
    _fill_series(maps, first.guard + k, n, steps)
    return 1.0 / max(spectral_radius_bound(maps, n), 1e-9)
