"""Descriptors whose outputs pass through filters: each filter is one more equation, and as many states as its order.

With a filter b(s)/a(s) on an output y, and z the solution of a(d/dt) z = y, the filtered output is b(d/dt) z. The
states are z and its derivatives but the highest, which is an unknown of the equation. So the coefficients enter as they
were given, and what an output owes to the free values stays affine in them.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from inerter.systems.descriptor import Descriptor
from inerter.systems.filters import Filter, with_filter_states

EquationStacks = tuple[Any, ...]  # S, R, F, Y_eta, Y_x, Y_u
FilteredOutputs = list[tuple[int, Filter, slice]]  # output, filter, its states


@lru_cache(maxsize=32)  # since designs of one structure share their descriptor
def with_output_filters(descriptor: Descriptor, filters: tuple[Filter | None, ...]) -> Descriptor:
    """`descriptor` with a filter, or none, on each output."""
    d, n = descriptor, descriptor.X_x.shape[0]
    chosen = [(i, f) for i, f in enumerate(filters) if f is not None]
    if not chosen:
        return d
    X_eta, X_x, slices = with_filter_states(d.X_eta, d.X_x, [f for _, f in chosen])
    places = [(i, f, at) for (i, f), at in zip(chosen, slices, strict=True)]
    states = len(X_x)
    X_u = np.concatenate((d.X_u, np.zeros((states - n, d.X_u.shape[1]))))
    names = [f"{d.outputs[i]}_filter_{k + 1}" for i, f, _ in places for k in range(f.order)]
    return d.with_stacks(
        _with_equations(d.stacks, places, states),
        _with_equations(d.sizes, places, states, sizes=True),
        X_eta=X_eta,
        X_x=X_x,
        X_u=X_u,
        states=(*d.states, *names),
        filters=tuple(filters),
    )


def _with_equations(
    stacks: EquationStacks, places: FilteredOutputs, states: int, sizes: bool = False
) -> EquationStacks:
    """Stacks with an equation a(d/dt) z = y for each filter, and output b(d/dt) z in place of y; or their sizes."""
    S, R, F, Y_eta, Y_x, Y_u = stacks
    _, e, n = R.shape
    both, q = (1.0, len(places)) if sizes else (-1.0, len(places))
    S2, R2, F2 = (_enlarge(s, e + q, width) for s, width in ((S, e + q), (R, states), (F, F.shape[2])))
    Y_eta2, Y_x2, Y_u2 = _enlarge(Y_eta, Y_eta.shape[1], e + q), _enlarge(Y_x, Y_x.shape[1], states), Y_u.copy()
    for unknown, (output, one, at) in enumerate(places, start=e):
        _, top, bottom = (abs(c) for c in one.scaled_coefficients) if sizes else one.scaled_coefficients
        S2[:, unknown, :e], R2[:, unknown, :n], F2[:, unknown] = both * Y_eta[:, output], Y_x[:, output], Y_u[:, output]
        S2[0, unknown, unknown], R2[0, unknown, at] = bottom[-1], both * bottom[:-1]
        Y_eta2[:, output], Y_x2[:, output], Y_u2[:, output] = 0.0, 0.0, 0.0
        Y_eta2[0, output, unknown], Y_x2[0, output, at] = top[-1], top[:-1]
    return S2, R2, F2, Y_eta2, Y_x2, Y_u2


def _enlarge(stack: Any, rows: int, columns: int) -> Any:
    result = np.zeros((stack.shape[0], rows, columns), stack.dtype)
    result[:, : stack.shape[1], : stack.shape[2]] = stack
    return result
