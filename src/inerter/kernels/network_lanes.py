"""Indices of many designs of one network, side by side, compiled; see `network_norms` and `lanes`."""

from __future__ import annotations

from typing import Any

import numpy as np

from inerter.kernels.arrays import Floats, Matrix
from inerter.kernels.astrom_jury import Recursion
from inerter.kernels.decorators import kernel, part
from inerter.kernels.lanes import WIDTH, in_lanes, in_numbers
from inerter.kernels.network_norms import ACCURATE, NormSpace, Port, fill_squares, index_of, space_sizes
from inerter.kernels.network_polynomials import Polynomials, Program, admittance

Array = Any


@part()
def line(n: int) -> Array:
    """A row of n numbers in lanes, zero."""
    return in_lanes(np.zeros((n + 1) * WIDTH), (n,))


@part()
def _table(m: int, n: int) -> Array:
    return in_lanes(np.zeros((m * n + 1) * WIDTH), (m, n))


@part()
def lane_space(program: Program, port: Port) -> NormSpace:
    """Room for `fill_squares`."""
    parts, functions = program.parts.shape[0], port.weights.size
    size, full, groups = space_sizes(program, port)
    network = Polynomials(
        _table(parts, size),
        _table(parts, size),
        _table(parts, size),
        _table(parts, size),
        _table(0, 0),
        _table(0, 0),
        _table(4, size),
    )
    fraction = Recursion(
        line(full),
        line(full),
        line(full),
        line(full),
        _table(full, full),
        _table(full, full),
        line(full),
        line(full),
        line(full),
        line(full),
        line(full),
    )
    return NormSpace(
        network, fraction, line(groups), line(groups), line(groups), _table(functions, size), _table(functions, size)
    )


@kernel("indices of many designs of a network", typed=True)
def indices_in_lanes(points: Matrix, program: Program, port: Port, errors: Floats) -> Floats:
    """Index at each column of element values (leaves, designs), infinite where unknown, and its relative errors.

    A design has the digits of `network_norms.indices`, whichever are beside it.
    """
    space, leaves, designs = lane_space(program, port), points.shape[0], points.shape[1]
    values, outcome = line(leaves), line(2)
    numbers, found = in_numbers(values), in_numbers(outcome)
    result = np.full(designs, np.inf)
    for first in range(0, designs, WIDTH):
        count = min(WIDTH, designs - first)
        for leaf in range(leaves):
            for lane in range(WIDTH):  # what is beyond the last design repeats it
                numbers[leaf, lane] = points[leaf, first + min(lane, count - 1)]
        for fine in (False, True):
            admittance(values, program, space.network, fine)
            outcome[0] = fill_squares(program, port, space, fine)
            outcome[1] = index_of(space)
            unsure = False
            for lane in range(count):
                design = first + lane
                if result[design] == np.inf:
                    known = found[0, lane] <= ACCURATE
                    result[design] = found[1, lane] if known else np.inf
                    errors[design] = 0.5 * found[0, lane] if known else np.inf
                    unsure = unsure or not known
            if not unsure:
                break
    return result
