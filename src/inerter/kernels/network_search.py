"""Minima of an index, or of a trade-off, over the values of one network, from many starts in one call, compiled.

Each search is a projected quasi-Newton method in logarithms: the BFGS matrix with Powell's damping, variables at a
bound with the gradient outwards held there, and a line search along the projected path (Nocedal and Wright, Numerical
Optimization, 2006, sections 16.7 and 18.3). Near an optimum a step of rounding size upwards is taken if the projected
gradient falls.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from inerter.kernels.arrays import Floats, Ints, Matrix
from inerter.kernels.decorators import kernel, part
from inerter.kernels.network_norms import NormSpace, Port, TradeOff, excess_in, index_in, norm_space
from inerter.kernels.network_polynomials import Program
from inerter.kernels.quasi_newton import factorise_free, reset, solve_lower, solve_upper, update

Array = Any
_ITERATIONS, _HALVINGS = 300, 30
_CONVERGED = 1e-9  # largest relative slope d log J / d log x of an optimum
_STEP = 2.0  # longest step of one value, in its logarithm
_ROUNDING = 1e-13  # relative increase that a step near an optimum may have


class Variables(NamedTuple):
    """Element values over the variables of a search, which are logarithms."""

    values: Floats  # (leaves,) element values; those that are variables are overwritten
    of_leaf: Ints  # (leaves,) number of the variable that a leaf is, or -1
    lower: Floats  # (variables,)
    upper: Floats


class SearchSpace(NamedTuple):
    """Room for a search."""

    norms: NormSpace
    slopes: Floats  # (leaves,) gradient over element values
    point: Floats  # (variables,)
    gradient: Floats
    trial: Floats
    trial_gradient: Floats
    step: Floats
    bend: Floats  # change of the gradient over a step
    change: Floats
    hessian: Matrix
    factor: Matrix
    held: Ints


@part(borrowing=True)
def _objective_at(
    point: Array,
    variables: Variables,
    program: Program,
    port: Port,
    trade_off: TradeOff,
    space: SearchSpace,
    gradient: Array,
) -> float:
    """Excess over the aim of a trade-off, or logarithm of the index without one.

    If there is room for it, also its gradient over the variables.
    """
    for leaf in range(variables.of_leaf.size):
        if variables.of_leaf[leaf] >= 0:
            variables.values[leaf] = np.exp(point[variables.of_leaf[leaf]])
    slopes = space.slopes if gradient.size > 0 else gradient
    divisor = 1.0
    if trade_off.aims.size > 0:
        value = excess_in(variables.values, program, port, trade_off, space.norms, slopes)
    else:
        divisor, _ = index_in(variables.values, program, port, space.norms, slopes)
        value = float(np.log(divisor))
    for i in range(gradient.size):
        gradient[i] = 0.0
    if gradient.size > 0 and value < np.inf:
        for leaf in range(variables.of_leaf.size):
            if variables.of_leaf[leaf] >= 0:
                gradient[variables.of_leaf[leaf]] += space.slopes[leaf] * variables.values[leaf] / divisor
    return value


@part(borrowing=True)
def _projected_slope(point: Array, gradient: Array, variables: Variables) -> float:
    worst = 0.0
    for i in range(point.size):
        low, high = point[i] <= variables.lower[i], point[i] >= variables.upper[i]
        if not (low and gradient[i] > 0.0) and not (high and gradient[i] < 0.0):
            worst = max(worst, abs(gradient[i]))
    return worst


@part(borrowing=True)
def _find_step(variables: Variables, space: SearchSpace) -> bool:
    """Fill the step that minimises the model over the variables that are not held; False if it has no minimum."""
    point, gradient, L, step = space.point, space.gradient, space.factor, space.step
    k = point.size
    for i in range(k):
        low, high = point[i] <= variables.lower[i], point[i] >= variables.upper[i]
        space.held[i] = 1 if (low and gradient[i] > 0.0) or (high and gradient[i] < 0.0) else 0
    if not factorise_free(space.hessian, space.held, L):
        return False
    longest = 0.0
    for i in range(k):
        step[i] = 0.0 if space.held[i] == 1 else -gradient[i]
    solve_lower(L, step)
    solve_upper(L, step)
    for i in range(k):
        longest = max(longest, abs(step[i]))
    if longest > _STEP:
        for i in range(k):
            step[i] *= _STEP / longest
    return bool(longest < np.inf)


@part(borrowing=True)
def descend(variables: Variables, program: Program, port: Port, trade_off: TradeOff, space: SearchSpace) -> Any:
    """Minimise from `space.point`, which becomes the optimum; the objective, and the number of evaluations."""
    point, gradient, trial, trial_gradient = space.point, space.gradient, space.trial, space.trial_gradient
    k = point.size
    f = _objective_at(point, variables, program, port, trade_off, space, gradient)
    count, fresh = 1, True
    reset(space.hessian, 1.0)
    if not f < np.inf:
        return f, count
    for _ in range(_ITERATIONS):
        slope = _projected_slope(point, gradient, variables)
        if slope <= _CONVERGED:
            break
        if not _find_step(variables, space):
            reset(space.hessian, 1.0)
            fresh = True
            if not _find_step(variables, space):
                break
        t, taken = 1.0, False
        for _ in range(_HALVINGS):
            along = 0.0
            for i in range(k):
                trial[i] = min(max(point[i] + t * space.step[i], variables.lower[i]), variables.upper[i])
                along += gradient[i] * (trial[i] - point[i])
            new = _objective_at(trial, variables, program, port, trade_off, space, trial_gradient)
            count += 1
            near = new <= f + _ROUNDING and _projected_slope(trial, trial_gradient, variables) < slope
            if (along < 0.0 and new <= f + 1e-4 * along) or near:
                taken = True
                break
            if along > -1e-15:
                break
            shrink = 0.5 * along / (along - (new - f)) if new < np.inf else 0.2
            t *= min(max(shrink, 0.1), 0.6)
        if not taken:
            if fresh:
                break
            reset(space.hessian, 1.0)
            fresh = True
            continue
        if fresh:  # scale of the first model
            sy, yy = 0.0, 0.0
            for i in range(k):
                y = trial_gradient[i] - gradient[i]
                sy += y * (trial[i] - point[i])
                yy += y * y
            if sy > 0.0:
                reset(space.hessian, yy / sy)
            fresh = False
        for i in range(k):
            space.step[i], space.bend[i] = trial[i] - point[i], trial_gradient[i] - gradient[i]
        update(space.hessian, space.step, space.bend, space.change)
        for i in range(k):
            point[i], gradient[i] = trial[i], trial_gradient[i]
        f = min(new, f) if abs(new - f) <= _ROUNDING else new
    return f, count


@kernel("search of a network", typed=True)
def search_network(
    samples: Matrix,
    tried: int,
    variables: Variables,
    program: Program,
    port: Port,
    trade_off: TradeOff,
    points: Matrix,
    counts: Ints,
) -> Floats:
    """Minima from the best of each `tried` rows of `samples`, which lie in the unit cube.

    Minimised is the index, or the excess over the aim of a trade-off (`excess_in`) if that has criteria. `points`
    (starts, variables) and `counts` (starts,) are filled with the optima, as element values, and the numbers of
    evaluations; the result has the values, infinite where all samples of a start are.
    """
    k, starts = samples.shape[1], points.shape[0]
    leaves = variables.of_leaf.size
    space = SearchSpace(
        norm_space(program, port),
        np.zeros(leaves),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros(k),
        np.zeros((k, k)),
        np.zeros((k, k)),
        np.zeros(k, np.int64),
    )
    result, none = np.zeros(starts), np.zeros(0)
    for start in range(starts):
        best, chosen = np.inf, -1
        for row in range(start * tried, (start + 1) * tried):
            for i in range(k):
                space.trial[i] = variables.lower[i] + samples[row, i] * (variables.upper[i] - variables.lower[i])
            f = _objective_at(space.trial, variables, program, port, trade_off, space, none)
            if f < best:
                best, chosen = f, row
        if chosen < 0:
            result[start] = np.inf
            continue
        for i in range(k):
            space.point[i] = variables.lower[i] + samples[chosen, i] * (variables.upper[i] - variables.lower[i])
        f, count = descend(variables, program, port, trade_off, space)
        result[start], counts[start] = np.exp(f) if trade_off.aims.size == 0 else f, tried + count
        for i in range(k):
            points[start, i] = np.exp(space.point[i])
    return result
