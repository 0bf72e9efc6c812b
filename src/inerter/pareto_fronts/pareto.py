"""`pareto_front`: the Pareto front of two or three indices, each point by multi-start search with exact gradients.

The criteria are normalised by their values at the single optima. A point of the front minimises t such that criterion i
exceeds a_i by at most t, where a is on the line (or triangle) through the single optima.
So points are evenly spread for convex and non-convex fronts, and each starts from its neighbours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import OK, DesignError, InerterError, PerformanceIndexError, Status, StatusKind, worst_of
from inerter.formatting import format_share
from inerter.methods.combined_objective import ObjectivePart, combine_objectives
from inerter.methods.composite_index import IndexLike, estimate_of, objective_of
from inerter.methods.method import Method, check_request
from inerter.methods.objective import Differentiable
from inerter.methods.registry import with_gradients
from inerter.networks.elements import Free
from inerter.optimisation.active_constraints import constraint_results
from inerter.optimisation.constrained_search import ConstrainedProblem, refine_minimax, searches, trust_region
from inerter.optimisation.limits import Bound, Limit, Sense, bounds_of, check_limits, is_smooth
from inerter.optimisation.local import LocalOptimum
from inerter.optimisation.optimise import check_free, default_starts, has_many_optima, optimise
from inerter.pareto_fronts.front import ParetoFront
from inerter.pareto_fronts.points import (
    SAME,
    FrontPoint,
    dominates,
    gap_key,
    gaps,
    non_dominated,
    thin_out,
    thin_out_triangle,
    triangle_steps,
)
from inerter.validation import check_whole
from inerter.vehicle.vehicle import Vehicle
from inerter.work.blas_threads import one_blas_thread
from inerter.work.running import running_on

Array = NDArray[np.float64]
_MOST_POINTS = 10_000
_NO_CONFLICT = 1e-6  # relative size of a trade-off up to which there is none
_SHIFT = 3.0  # added to normalised criteria, so that they have logarithms
_SLACK, _KEPT = 1e-6, 1e-6  # tolerances of a normalised criterion, and of a constraint
_WIDE, _DOUBTED = 1.6, 1.2  # of the typical gap: those that are filled, and those tested for a discontinuity
_AT_END = 0.02  # of a gap, within which a point is at its end
_STARTS = 3  # from the sample for each point
_DENSER, _MORE = 2, 4  # with many local optima: power of two of more samples, and times as many starts
_RESTARTS = 4  # with improved ends


def pareto_front(
    vehicle: Vehicle,
    indices: Sequence[IndexLike],
    method: Method,
    *,
    points: int = 25,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    executor: Executor | None = None,
) -> ParetoFront:
    """The Pareto front of two or three indices: non-dominated designs.

    The ends are the single optima. Between them `points` are spread evenly in the criteria, normalised by the ends;
    each is searched from a sample of all designs and from its neighbours, and repeated where another search found a
    better start. `subject_to` is as that of `optimise`. A method that simulates starts from the front of a quick one.
    The same seed gives the same front. An `executor` shares random roads, as that of `optimise` does.

    Raises `PerformanceIndexError` unless there are two or three different indices, `DesignError` if `points` is not an
    integer of at least 3 (6 for three indices), and the errors of `optimise`.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.Damper(it.free(100, 1e5, "c")) - it.Inerter(it.free(1, 2000, "b"))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> road = it.Road(roughness=5e-7, speed=25)
    >>> front = it.pareto_front(car, [it.RideComfort(road), it.TyreLoad(road)], it.Norm(), points=5)
    >>> front.values.round(3)[[0, -1]]
    array([[  2.428, 503.131],
           [  2.437, 501.205]])
    """
    criteria = check_criteria(indices, points)
    for one in criteria:
        check_request(vehicle, one, method)
    limits = check_limits(subject_to)
    free = check_free(vehicle)
    check_whole(DesignError, "The seed", seed)
    with one_blas_thread(), running_on(executor):
        ends = []
        for one in criteria:
            end = optimise(vehicle, one, method, subject_to=limits, seed=int(seed))
            if not np.isfinite(end.value) or end.status.kind is StatusKind.INFEASIBLE:
                return _empty(criteria, int(seed), end.status)
            ends.append(end)
        found_ends = [np.array(list(end.parameters.values())) for end in ends]
        trade = _trade(vehicle, criteria, method, limits, free, found_ends, int(seed))
        many = any(end.n_starts > default_starts(free) for end in ends)
        trade = replace(trade, has_many_optima=many)
        trade = replace(trade, ends=tuple(trade.strict(trade.at(point)).point for point in trade.ends))
        return _front(trade, trade.front(int(points)), [end.status for end in ends], int(seed))


def points_at_aims(
    vehicle: Vehicle,
    indices: Sequence[IndexLike],
    method: Method,
    limits: tuple[Limit, ...],
    *,
    ends: Sequence[Mapping[str, float]],
    scale: tuple[Array, Array],
    aims: Array,
    seed: int,
) -> list[FrontPoint | None]:
    """Designs whose largest excess over each of `aims` is the smallest; None where none is feasible.

    Aims (aims, criteria) are multiples of the `scale`, smallest value and range of each criterion. `ends` are the free
    values of single optima, from which the searches start.
    """
    free = check_free(vehicle)
    points = [np.array([end[name] for name in free]) for end in ends]
    with one_blas_thread():
        trade = replace(_trade(vehicle, tuple(indices), method, limits, free, points, seed), given_scale=scale)
        known = [trade.at(point) for point in trade.ends]
        found: list[FrontPoint | None] = []
        for aim in aims:
            one = trade.solve(aim, known)
            found.append(one)
            known += [] if one is None else [one]
    return found


def check_criteria(indices: object, points: object) -> tuple[IndexLike, ...]:
    """The indices of a front.

    Raises `PerformanceIndexError` unless there are two or three different ones, `DesignError` for too few points.
    """
    if not isinstance(indices, Sequence) or isinstance(indices, str):
        raise PerformanceIndexError(f"A Pareto front requires two or three indices, got {indices!r}.")
    if len(indices) not in (2, 3):
        raise PerformanceIndexError(f"A Pareto front requires two or three indices, got {len(indices)}.")
    if len(set(map(repr, indices))) < len(indices):
        raise PerformanceIndexError("A Pareto front requires different indices; one is repeated.")
    least = 3 if len(indices) == 2 else 6
    check_whole(DesignError, f"The number of points of a front of {len(indices)} indices", points, least, _MOST_POINTS)
    return tuple(indices)


@dataclass(frozen=True, eq=False)
class _Trade:
    """Criteria of a vehicle as functions of its free values, normalised by the single optima."""

    vehicle: Vehicle
    indices: tuple[IndexLike, ...]
    method: Method
    objectives: tuple[Any, ...]
    bounds: tuple[Bound, ...]
    lower: Array
    upper: Array
    ends: tuple[Array, ...]  # points
    hints: Array  # points of the front of a quick method
    seed: int
    given_scale: tuple[Array, Array] | None = None  # instead of that of the ends
    has_many_optima: bool = False  # as the searches for the ends have found
    is_dense: bool = False  # a sample with more points, of which more are starts

    def criteria(self, points: Array) -> Array:
        """The indices (n, criteria) at each row of `points`."""
        return np.column_stack([objective.values(points) for objective in self.objectives])

    @cached_property
    def scale(self) -> tuple[Array, Array]:
        """Smallest value of each criterion at the ends, and its range."""
        if self.given_scale is not None:
            return self.given_scale
        table = self.criteria(np.array(self.ends))
        ideal = table.min(axis=0)
        size = table.max(axis=0) - ideal
        return ideal, np.where(size > 0.0, size, 1.0)

    def at(self, point: Array) -> FrontPoint:
        """The point with its criteria."""
        values = self.criteria(point[None])[0]
        ideal, size = self.scale
        return FrontPoint(point, values, (values - ideal) / size)

    @cached_property
    def sample(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """Sample of designs, with penalised normalised criteria, and the numbers of their neighbours."""
        if not self._quick:
            table = self.criteria(self.hints)
            own = np.arange(len(self.hints), dtype=np.int64)[:, None]
            return self.hints, (table - self.scale[0]) / self.scale[1], own
        count = self.lower.size
        sampler = scipy.stats.qmc.Sobol(count, rng=np.random.default_rng(self.seed))
        unit = sampler.random_base2(min(7 + count, 12) + (_DENSER if self.is_dense else 0))
        points = np.exp(np.log(self.lower) + unit * (np.log(self.upper) - np.log(self.lower)))
        table = (self.criteria(points) - self.scale[0]) / self.scale[1]
        table += 10.0 * np.maximum(self._limits.excess(points), 0.0)[:, None]
        near = np.asarray(scipy.spatial.KDTree(unit).query(unit, k=4 * count + 1)[1], dtype=np.int64)
        return points, table, near

    @cached_property
    def _quick(self) -> bool:
        return all(isinstance(one, Differentiable) for one in self.objectives) and is_smooth(self.bounds)

    @cached_property
    def _has_peaks(self) -> bool:
        return any(one.active(self.lower) is not None for one in self.objectives)

    @cached_property
    def _denser(self) -> list[_Trade]:
        """The problem with two independent samples, for searches among many local optima."""
        return [replace(self, seed=self.seed + i, is_dense=True, given_scale=self.scale) for i in (1, 2)]

    @cached_property
    def _limits(self) -> ConstrainedProblem:
        """The constraints alone."""
        return ConstrainedProblem(None, self.bounds, self.lower, self.upper)

    def problem(self, aim: Array, which: Sequence[int]) -> ConstrainedProblem:
        """Minimisation of the largest excess of the normalised criteria over their aims."""
        ideal, size = self.scale
        parts = [
            ObjectivePart(self.objectives[i], None, 1.0 / size[i], _SHIFT - ideal[i] / size[i] - aim[i]) for i in which
        ]
        return ConstrainedProblem(combine_objectives(parts, worst=True), self.bounds, self.lower, self.upper)

    def starts(self, aim: Array, which: Sequence[int]) -> list[Array]:
        """The lowest local minima of the sample."""
        points, table, near = self.sample
        merit = np.max(table[:, which] - aim[list(which)], axis=1)
        merit = np.where(np.isfinite(merit), merit, np.inf)
        order = np.argsort(merit, kind="stable")
        most = _STARTS * (_MORE if self.is_dense else 1)
        lowest = [i for i in order[: 64 * most] if np.isfinite(merit[i]) and merit[i] <= merit[near[i]].min()]
        return [points[i] for i in lowest[:most]]

    def solve(self, aim: Array, known: Sequence[FrontPoint], which: Sequence[int] = ()) -> FrontPoint | None:
        """The point of the front closest to an aim, from the sample and known points; None if none is feasible."""
        which = which or range(len(self.objectives))
        close = sorted(known, key=lambda one: float(np.max(one.normal[list(which)] - aim[list(which)])))
        first = [one.point for one in close[:2]] + ([] if self.has_many_optima else self.starts(aim, which))
        problem = self.problem(aim, which)
        found = searches(problem, first) if self._quick else [_costly(problem, first)]
        lowest: list[float] = []  # of two searches that must agree, where there are many local optima
        if self._quick and (self.has_many_optima or has_many_optima(found, self._has_peaks)):
            for further in self._denser:
                again = [one for one in searches(problem, further.starts(aim, which)) if one.excess <= _KEPT]
                lowest.append(min((one.value for one in again), default=np.inf))
                found += again
        kept = [one for one in found if one.excess <= _KEPT and np.isfinite(one.value)]
        if not kept:
            return None
        nearest = min(kept, key=lambda one: one.value)
        best = self.at(nearest.point)
        if max(lowest, default=0.0) > nearest.value + SAME:
            best = replace(best, status=_many_optima_status(max(lowest) - nearest.value))
        over = best.normal[list(which)] - aim[list(which)]
        if len(which) < len(self.objectives) or over.max() - over.min() > _SLACK:
            return self.strict(best)
        return best

    def strict(self, found: FrontPoint) -> FrontPoint:
        """A non-dominated design that is no worse in any criterion."""
        if not self._quick:
            return found
        ideal, size = self.scale
        parts = [
            ObjectivePart(one, None, 1.0 / s, -i / s + 1.0)
            for one, i, s in zip(self.objectives, ideal, size, strict=True)
        ]
        no_worse = tuple(
            Bound(Limit(index, Sense.AT_MOST, float(value)), objective)
            for index, value, objective in zip(self.indices, found.values, self.objectives, strict=True)
        )
        problem = ConstrainedProblem(
            combine_objectives(parts, worst=False), (*self.bounds, *no_worse), self.lower, self.upper
        )
        end = refine_minimax(problem, problem.at(found.point, 0)).point
        better = replace(self.at(end), status=found.status)
        gained = found.normal.sum() - better.normal.sum()
        is_kept = np.all(better.normal <= found.normal + _SLACK) and self._limits.excess(end[None])[0] <= _KEPT
        return better if gained > _SLACK and is_kept else found

    def front(self, count: int, restarts: int = _RESTARTS) -> tuple[list[FrontPoint], set[tuple[bytes, bytes]]]:
        """Points of the front, and the pairs between which it is discontinuous."""
        ends = [self.at(point) for point in self.ends]
        table = np.array([one.values for one in ends])
        if np.all(np.ptp(table, axis=0) <= _NO_CONFLICT * self.scale[0]):
            return ends[:1], set()
        if len(self.objectives) == 3:
            return self.over_triangle(ends, count), set()
        found = self.between(ends, count)
        closer = [next((one for one in found if dominates(one, end)), end) for end in ends]
        if restarts and any(one is not end for one, end in zip(closer, ends, strict=True)):
            return replace(self, ends=tuple(one.point for one in closer)).front(count, restarts - 1)
        return self.fill_gaps(found, count, (0, 1))

    def between(self, ends: Sequence[FrontPoint], count: int, which: Sequence[int] = (0, 1)) -> list[FrontPoint]:
        """Points of the front of two criteria, from one end to the other."""
        a, z = (one.normal for one in ends)
        aims = [a + (z - a) * share for share in np.linspace(0.0, 1.0, count)[1:-1]]
        found: list[FrontPoint] = list(ends)
        for aim in aims:
            one = self.solve(aim, found, which)
            found += [] if one is None else [one]
        for aim in reversed(aims):  # repeated from the best of all points
            if self._quick:
                best = min(found, key=lambda one: float(np.max(one.normal[list(which)] - aim[list(which)])))
                problem = self.problem(aim, which)
                again = refine_minimax(problem, problem.at(best.point, 0))
                if again.excess <= _KEPT:
                    found.append(replace(self.at(again.point), status=best.status))
        return non_dominated(found, which)

    def fill_gaps(
        self, found: list[FrontPoint], count: int, which: Sequence[int]
    ) -> tuple[list[FrontPoint], set[tuple[bytes, bytes]]]:
        """Up to `count` points after filling the widest gaps, and the gaps without points."""
        jumps: set[tuple[bytes, bytes]] = set()
        found = thin_out(found, count, which)
        for _ in range(3 * count):
            free = gaps(found, jumps, which)
            if not free:
                break
            widest, i = max(free)
            if len(found) >= count and widest <= _WIDE * float(np.median([gap for gap, _ in free])):
                break
            one = self.inside(found[i], found[i + 1], which)
            if one is None:
                jumps.add(gap_key(found, i))
            else:
                found = thin_out(non_dominated([*found, one], which), max(count, 3), which, keep=one)
        free = gaps(found, jumps, which)
        typical = float(np.median([gap for gap, _ in free])) if free else 0.0
        jumps |= {
            gap_key(found, i)
            for gap, i in free
            if gap > _DOUBTED * typical and self.inside(found[i], found[i + 1], which) is None
        }
        return found, jumps

    def inside(self, a: FrontPoint, b: FrontPoint, which: Sequence[int]) -> FrontPoint | None:
        """A point between two neighbours; None if the search ends at one of them: the front is discontinuous there."""
        one = self.solve(0.5 * (a.normal + b.normal), [a, b], which)
        if one is None:
            return None
        apart = [float(np.linalg.norm((one.normal - other.normal)[list(which)])) for other in (a, b)]
        return one if min(apart) > _AT_END * float(np.linalg.norm((a.normal - b.normal)[list(which)])) else None

    def over_triangle(self, ends: Sequence[FrontPoint], count: int) -> list[FrontPoint]:
        """The front of three criteria: the fronts of each two, and points between them."""
        steps = triangle_steps(count)
        found = list(ends)
        for i, j in combinations(range(3), 2):
            along = self.between([ends[i], ends[j]], steps + 1, (i, j))
            found += self.fill_gaps(along, steps + 1, (i, j))[0]
        found = [self.strict(one) for one in found]
        corners = np.array([one.normal for one in ends])
        for a in range(1, steps):
            for b in range(1, steps - a):
                one = self.solve(np.array([a, b, steps - a - b]) / steps @ corners, found)
                found += [] if one is None else [one]
        found = non_dominated(found, (0, 1, 2))
        rng = scipy.stats.qmc.Sobol(3, rng=np.random.default_rng(self.seed))
        shares = -np.log(np.maximum(rng.random(32), 1e-9))
        for share in shares / shares.sum(axis=1, keepdims=True):
            if len(found) >= count:
                break
            one = self.solve(share @ corners, found)
            found = found if one is None else non_dominated([*found, one], (0, 1, 2))
        return thin_out_triangle(found, count, ends)


def _many_optima_status(apart: float) -> Status:
    """Status of a point whose searches differ by that share of the range of the criteria."""
    found = "one of two searches from independent starts found no design within the limits"
    if np.isfinite(apart):
        found = f"searches from independent starts end {format_share(apart)} of the range apart among many local optima"
    return Status(StatusKind.INACCURATE, f"{found}, so that a better design may exist")


def _costly(problem: ConstrainedProblem, first: Sequence[Array]) -> LocalOptimum:
    start = first[int(np.argmin(problem.values(np.array(first))))]
    return trust_region(problem, start)


def _trade(
    vehicle: Vehicle,
    indices: tuple[IndexLike, ...],
    method: Method,
    limits: tuple[Limit, ...],
    free: dict[str, Free],
    found: Sequence[Array],
    seed: int,
) -> _Trade:
    return _Trade(
        vehicle=vehicle,
        indices=indices,
        method=method,
        objectives=tuple(objective_of(vehicle, one, method) for one in indices),
        bounds=bounds_of(vehicle, limits, method),
        lower=np.array([value.lower for value in free.values()]),
        upper=np.array([value.upper for value in free.values()]),
        ends=tuple(found),
        hints=np.array([*found, *_hints(vehicle, indices, method, limits, seed)]),
        seed=seed,
    )


def _hints(
    vehicle: Vehicle, indices: tuple[IndexLike, ...], method: Method, limits: tuple[Limit, ...], seed: int
) -> list[Array]:
    """Points of the front of a quick method, for a method without gradients."""
    if isinstance(objective_of(vehicle, indices[0], method), Differentiable):
        return []
    for quick in with_gradients(getattr(method, "conventions", "exact")):
        try:
            if not isinstance(objective_of(vehicle, indices[0], quick), Differentiable):
                continue
            front = pareto_front(vehicle, indices, quick, points=3 * len(indices), subject_to=limits, seed=seed)
        except InerterError:
            continue
        return [np.array(list(values.values())) for values in front.parameters]
    return []


def _empty(indices: tuple[IndexLike, ...], seed: int, status: Status) -> ParetoFront:
    return ParetoFront(indices, np.zeros((0, len(indices))), (), (), (), (), (), seed, status)


def _front(
    trade: _Trade, found: tuple[list[FrontPoint], set[tuple[bytes, bytes]]], of_ends: Sequence[Status], seed: int
) -> ParetoFront:
    several, jumps = found
    names = tuple(trade.vehicle.free_values())
    parameters = tuple(dict(zip(names, one.point.tolist(), strict=True)) for one in several)
    designs = tuple(trade.vehicle.with_values(values) for values in parameters)
    estimates = tuple(tuple(estimate_of(design, one, trade.method) for one in trade.indices) for design in designs)
    values = np.array([[estimate.value for estimate in row] for row in estimates])
    of_points = [[one.status, *(e.status for e in row)] for one, row in zip(several, estimates, strict=True)]
    for end, status in zip(np.argmin(values, axis=0).tolist(), of_ends, strict=True):
        of_points[end].append(status)
    statuses = tuple(map(worst_of, of_points))
    bad, troubled = worst_of(statuses), sum(not one.ok for one in statuses)
    status = OK if bad.ok else Status(bad.kind, f"{troubled} of {len(statuses)} points, such as one with {bad.message}")
    held = tuple(
        constraint_results(trade._limits, design, trade.method, one.point, known=False)
        for design, one in zip(designs, several, strict=True)
    )
    keys = [one.point.tobytes() for one in several]
    pairs = tuple((i, i + 1) for i in range(len(keys) - 1) if (keys[i], keys[i + 1]) in jumps)
    return ParetoFront(trade.indices, values, parameters, designs, statuses, pairs, held, seed, status, estimates)
