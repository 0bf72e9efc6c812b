"""Matrices of a mechanism in fractions: sums and quotients of values many decades apart, without rounding."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.systems import exact_rank
from inerter.systems.descriptor import Descriptor
from inerter.systems.exact_rank import FractionRows

Matrix = NDArray[np.float64]


def rounded_stacks(descriptor: Descriptor, values: Mapping[str, float]) -> list[Matrix]:
    """S, R, F, Y_eta, Y_x and Y_u at numbers for the free values, each entry rounded once."""
    return [
        exact_rank.to_matrix(_at(stack, descriptor, values), stack.shape[2]).reshape(stack.shape[1:])
        for stack in descriptor.stacks
    ]


def close_exactly(descriptor: Descriptor, values: Mapping[str, float]) -> Matrix:
    """[A B; C D] at numbers for the free values, each entry rounded once."""
    S, R, F, Y_eta, Y_x, Y_u = (_at(stack, descriptor, values) for stack in descriptor.stacks)
    unknowns, columns = descriptor.S.shape[1], descriptor.X_x.shape[1] + descriptor.X_u.shape[1]
    right = exact_rank.transpose([[*r, *f] for r, f in zip(R, F, strict=True)], columns)
    solved = exact_rank.weights(exact_rank.transpose(S, unknowns), right) if unknowns else [[] for _ in right]
    eta = [column for column in solved if column is not None]
    assert len(eta) == len(right)  # S is regular for all positive values
    on_eta = [*exact_rank.exact(descriptor.X_eta), *Y_eta]
    direct = exact_rank.exact(np.hstack([descriptor.X_x, descriptor.X_u]))
    direct += [[*x, *u] for x, u in zip(Y_x, Y_u, strict=True)]
    through = exact_rank.product(on_eta, exact_rank.transpose(eta, unknowns), columns)
    whole = [[x + y for x, y in zip(one, other, strict=True)] for one, other in zip(through, direct, strict=True)]
    return exact_rank.to_matrix(whole, columns)


def _at(stack: NDArray[Any], descriptor: Descriptor, values: Mapping[str, float]) -> FractionRows:
    """A stack at numbers for the free values."""
    weights = [Fraction(1), *(Fraction(values[name]) for name in descriptor.free)]
    rows = [[Fraction(0)] * stack.shape[2] for _ in range(stack.shape[1])]
    for place, i, j in np.argwhere(stack).tolist():
        rows[i][j] += weights[place] * Fraction(*stack[place, i, j].as_integer_ratio())
    return rows
