"""Local optima of a peak gain, and under constraints: of an index or, where no design is feasible, of the violation.

All functions are in logarithms. A smooth function is one row; a maximum of smooth functions has a row for each of its
peaks: those of the current point, each in its row, which converges where no peak appears or vanishes; then a fixed set,
to which exceeding peaks are added until there are none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.methods.objective import Differentiable, Objective
from inerter.optimisation.limits import Bound, Sense
from inerter.optimisation.local import LocalOptimum
from inerter.optimisation.minimax_level import LogRows, lowest_level
from inerter.optimisation.starts import APPROACHED, TIGHT, converge_promising, searches_from
from inerter.work.progress import report

Array = NDArray[np.float64]
KEPT = 1e-7  # tolerance of a constraint, of the logarithm; the exact optimum is on the limit
KEPT_COSTLY = 1e-4  # the same for values that are simulated
_STEEP = 10.0  # weight of the constraint violation in the selection of starts
_MOST_ROUNDS = 21  # of a refinement: along the peaks of each point, and over fixed sets
_PEAKS = 8  # slots for peaks during the approach
_HIDDEN = -700.0  # logarithm of an absent peak
_STANDS_OUT = 1e-9
_EXACTLY = 1e-8  # constraint violation that is ignored in the comparison of two ends of one search
_TRUSTED = 1e-3  # largest relative residual of the gradient balance of trusted multipliers
Known = tuple[Any, ...]  # peaks of each function; None for those of the current point


@dataclass(frozen=True, eq=False)
class ConstrainedProblem:
    """A constrained problem: an index, or without one the constraint violation, over the free values."""

    objective: Objective | None
    bounds: tuple[Bound, ...]
    lower: Array
    upper: Array

    def values(self, points: Array) -> Array:
        """Merit function for the selection of starts at each row of `points`: the index with a penalty."""
        over = np.exp(np.minimum(_STEEP * np.maximum(self.excess(points), 0.0), 600.0))
        return np.asarray(over if self.objective is None else over * self.objective.values(points), dtype=float)

    def excess(self, points: Array) -> Array:
        """Largest constraint violation of the logarithms at each row of `points`; negative if feasible."""
        found = [np.full(points.shape[0], -np.inf), *(bound.excess(points) for bound in self.bounds)]
        return np.asarray(np.max(found, axis=0))

    @cached_property
    def functions(self) -> tuple[Any, ...]:
        """The index, if there is one, and the constrained quantities."""
        own = () if self.objective is None else (self.objective,)
        return (*own, *(bound.function for bound in self.bounds))

    def active_peaks(self, point: Array) -> Known:
        """Peaks of each function at a point; None for smooth ones."""
        return tuple(function.active(point) for function in self.functions)

    def rows(self, point: Array, known: Known | None = None) -> LogRows:
        """Logarithms at a point and their slopes; constraints relative to their limits, not positive if satisfied."""
        which = (None,) * len(self.functions) if known is None else known
        found = [_log_rows(f, point, peaks, known is None) for f, peaks in zip(self.functions, which, strict=True)]
        if not self.bounds:
            return LogRows(*found[0], np.ones(found[0][0].size), np.zeros(0), np.zeros((0, point.size)))
        own = [] if self.objective is None else [found.pop(0)]
        logs, slopes, under = [a for a, _ in own], [b for _, b in own], [np.ones(a.size) for a, _ in own]
        equal, equal_slopes = [np.zeros(0)], [np.zeros((0, point.size))]
        for bound, (values, gradients) in zip(self.bounds, found, strict=True):
            off = values - np.log(bound.limit.value)
            if bound.limit.sense is not Sense.AT_MOST:  # of a peak gain, that of its highest peak
                top = [int(np.argmax(off))]
                off, gradients = off[top], gradients[top]
            level = np.full(off.size, 1.0 if self.objective is None else 0.0)
            if bound.limit.sense is Sense.EQUAL and self.objective is not None:
                if np.any(gradients):  # one that no free value changes would make the equations of a step singular
                    equal.append(off)
                    equal_slopes.append(gradients)
                continue
            signs = {Sense.AT_MOST: (1.0,), Sense.AT_LEAST: (-1.0,), Sense.EQUAL: (1.0, -1.0)}[bound.limit.sense]
            for sign in signs:
                logs.append(sign * off)
                slopes.append(sign * gradients)
                under.append(level)
        return LogRows(*map(np.concatenate, (logs, slopes, under, equal, equal_slopes)))

    def at(self, point: Array, evaluations: int) -> LocalOptimum:
        """The point as a local optimum, with its value and constraint violation."""
        excess = float(self.excess(point[None])[0])
        value = np.exp(excess) if self.objective is None else float(self.objective.values(point[None])[0])
        return LocalOptimum(point, value, evaluations, excess)


def _log_rows(function: Differentiable, point: Array, which: Any, following: bool) -> tuple[Array, Array]:
    peaks = function.active(point) if following else which
    if peaks is None:
        value, gradient = function.value_and_gradient(point)
        values, gradients = np.array([value]), gradient[None]
    else:
        chosen = peaks[:_PEAKS] if following else peaks
        if following and chosen.dtype == float:  # a frequency keeps its row when another peak becomes the highest
            chosen = np.sort(chosen)
        values, gradients = function.components(point, chosen)
    count = _PEAKS if peaks is not None and following else values.size
    logs, slopes = np.full(count, _HIDDEN), np.zeros((count, point.size))
    good = np.isfinite(values) & (values > 0.0) & np.isfinite(gradients).all(axis=1)
    if not good.all():
        low = np.isfinite(values) & (values <= 0.0)  # a condition that is never the worst is far below the level
        logs[: values.size] = np.where(low, _HIDDEN, -_HIDDEN)
    found = np.flatnonzero(good)
    logs[found], slopes[found] = np.log(values[found]), gradients[found] * point / values[found, None]
    return logs, slopes


def searches(problem: ConstrainedProblem, first: Sequence[Array]) -> list[LocalOptimum]:
    """A local search from each start; those close to the best feasible one are converged fully."""
    near = searches_from(first, lambda start, _: _approach_minimax(problem, start), APPROACHED)
    return converge_promising(near, partial(refine_minimax, problem))


def _approach_minimax(problem: ConstrainedProblem, start: Array) -> LocalOptimum:
    point, count = lowest_level(problem.rows, start, problem.lower, problem.upper, tolerance=1e-7, most_steps=60)
    begin, end = (problem.at(one, count + 2) for one in (start, point))
    return end if _is_better(end, begin, TIGHT) else begin


def refine_minimax(problem: ConstrainedProblem, start: LocalOptimum) -> LocalOptimum:
    """The optimum near `start`: by the peaks of each point, then by a fixed set, to which exceeding ones are added."""
    best, point, evaluations, known = start, start.point, start.evaluations, None
    for _ in range(_MOST_ROUNDS):
        rows = partial(problem.rows, known=known)
        point, count = lowest_level(rows, point, problem.lower, problem.upper, tolerance=1e-13, most_steps=100)
        found = problem.at(point, 0)
        evaluations += count + 2
        if _is_better(found, best, _EXACTLY):
            best = found
        point = best.point if known is None else point
        seen = problem.active_peaks(point)
        if all(peaks is None for peaks in seen) or (known and _is_converged(problem, point, known, found)):
            break
        pairs = zip(known or len(seen) * (None,), seen, strict=True)
        known = tuple(new if old is None else np.concatenate([old, new]) for old, new in pairs)
    return replace(best, evaluations=evaluations)


def _is_better(one: LocalOptimum, other: LocalOptimum, kept: float) -> bool:
    """Whether `one` has a smaller violation than `other`, or a lower value if both violations are below `kept`."""
    if max(one.excess, other.excess) <= kept:
        return one.value < other.value
    return one.excess < other.excess


def _is_converged(problem: ConstrainedProblem, point: Array, known: Known, found: LocalOptimum) -> bool:
    """Whether the fixed set contains the highest peaks of the index and the constrained quantities."""
    if not np.isfinite(found.value):
        return True
    rows = problem.rows(point, known)
    level = rows.logs[rows.under > 0.0].max()
    limits = np.append(rows.logs[rows.under == 0.0], np.abs(rows.equal))
    missed = 0.0 if problem.objective is None else max(found.excess, 0.0) - max(limits.max(initial=0.0), 0.0)
    return bool(np.log(found.value) <= level + _STANDS_OUT and missed <= _STANDS_OUT)


def most_evaluations(free: int, limited: bool) -> int:
    """Largest number of designs that `trust_region` evaluates for this many free values."""
    return (80 if limited else 60) * free


def trust_region(problem: ConstrainedProblem, start: Array) -> LocalOptimum:
    """The local optimum of a costly index near `start`, by a trust-region search without derivatives (COBYQA)."""
    assert problem.objective is not None
    objective, best = problem.objective, [LocalOptimum(start, np.inf, 0, np.inf)]
    memory: dict[bytes, tuple[float, Array]] = {}
    origin = np.log(start)
    radius = 1e-4 if problem.bounds else 1e-3
    most = most_evaluations(start.size, bool(problem.bounds))

    def at(x: Array) -> tuple[float, Array]:
        if x.tobytes() not in memory:
            is_start = np.array_equal(x, origin)  # whose value may be known
            point = (start if is_start else np.clip(np.exp(x), problem.lower, problem.upper))[None]
            value = float(objective.values(point)[0])
            over = np.array([float(bound.excess(point)[0]) for bound in problem.bounds])
            here = LocalOptimum(point[0], value, 0, float(over.max(initial=-np.inf)))
            count, lowest = len(memory) + 1, best[0].value
            report("evaluations", count, most, best=lowest if np.isfinite(lowest) else None, share=count / most)
            if np.isfinite(value) and _is_better(here, best[0], KEPT_COSTLY):
                best[0] = here
            log = float(np.log(value)) if 0.0 < value < np.inf else -_HIDDEN
            memory[x.tobytes()] = log, np.clip(over, _HIDDEN, -_HIDDEN)
        return memory[x.tobytes()]

    minimize: Any = scipy.optimize.minimize
    minimize(
        lambda x: at(x)[0],
        origin,
        method="COBYQA",
        bounds=scipy.optimize.Bounds(np.log(problem.lower), np.log(problem.upper)),
        constraints=scipy.optimize.NonlinearConstraint(lambda x: at(x)[1], -np.inf, 0.0) if problem.bounds else (),
        options={"initial_tr_radius": 0.1, "final_tr_radius": radius, "maxfev": most},
    )
    return replace(best[0], evaluations=len(memory))


def sensitivities(problem: ConstrainedProblem, point: Array) -> list[float]:
    """Sensitivity of the index to each limit, in % per %, from its multiplier; nan where unknown."""
    known = problem.active_peaks(point)
    slopes, own, limit_of, signs = [], [], [], []
    for number, (peaks, function) in enumerate(zip(known, problem.functions, strict=True)):
        logs, gradients = _log_rows(function, point, peaks, False)
        if number == 0:
            near = logs >= logs.max() - TIGHT
            slopes += list(gradients[near])
            own += [1.0] * int(near.sum())
            continue
        bound = problem.bounds[number - 1]
        off = logs - np.log(bound.limit.value)
        top = off.max()
        if bound.limit.sense is Sense.AT_MOST:
            rows = np.flatnonzero(np.abs(off) <= TIGHT)
        else:
            rows = np.array([int(np.argmax(off))]) if abs(top) <= TIGHT else np.zeros(0, dtype=int)
        for row in rows:
            slopes.append(gradients[row])
            own.append(0.0)
            limit_of.append(number - 1)
            signs.append(bound.limit.sense)
    multipliers = _multipliers(np.array(slopes), np.array(own), signs, point, problem)
    found = [0.0] * len(problem.bounds)
    for number, multiplier in zip(limit_of, multipliers, strict=True):
        found[number] -= float(multiplier)
    return found


def _multipliers(slopes: Array, own: Array, senses: list[Sense], point: Array, problem: ConstrainedProblem) -> Array:
    """Multipliers that balance the slopes of index, constraints and bounds; nan if there are none."""
    least = [0.0] * int(own.sum()) + [-np.inf if sense is not Sense.AT_MOST else 0.0 for sense in senses]
    most = [np.inf] * int(own.sum()) + [0.0 if sense is Sense.AT_LEAST else np.inf for sense in senses]
    at_lower = np.isclose(point, problem.lower, rtol=1e-9, atol=0.0)
    at_upper = np.isclose(point, problem.upper, rtol=1e-9, atol=0.0)
    sides = np.eye(point.size)[:, at_lower | at_upper] * np.where(at_lower, -1.0, 1.0)[:, None]
    A = np.vstack([np.hstack([slopes.T, sides]), np.append(own, np.zeros(sides.shape[1]))])
    b = np.append(np.zeros(point.size), 1.0)
    found: Any = scipy.optimize.lsq_linear(
        A, b, bounds=([*least, *[0.0] * sides.shape[1]], [*most, *[np.inf] * sides.shape[1]]), tol=1e-14
    )
    if np.linalg.norm(A @ found.x - b) > _TRUSTED * max(np.abs(slopes[own > 0.0]).max(), 1.0):
        return np.full(len(senses), np.nan)
    return np.asarray(found.x[int(own.sum()) : int(own.sum()) + len(senses)])
