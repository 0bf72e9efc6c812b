"""The front of several indices over all networks that a free network may be.

All networks have the same aims: values of the indices on the line (or triangle) through the single optima. Each is
searched for the design that exceeds an aim least (`kernels.network_norms.excess_in`, or by `pareto_fronts`), so that at
an aim networks compare by one number. It grows with every index; so where the best values of a network in each index,
taken together, exceed an aim by more than a design that is known, no design of the network can be better there, and it
is not searched.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import InerterError
from inerter.kernels.network_norms import SHARP, TradeOff
from inerter.methods.composite_index import IndexLike, estimate_of
from inerter.methods.method import Method
from inerter.methods.network_norm import TRIED, NetworkIndex, join_indices, values_kernel
from inerter.network_search.front_results import FrontDesign, NetworkFront, collect_front
from inerter.network_search.plan import SearchPlan, plan_search
from inerter.network_search.results import FoundNetwork, SearchResult
from inerter.networks.enumeration import Topology
from inerter.optimisation.limits import Limit
from inerter.optimisation.optimise import quasi_random_points
from inerter.pareto_fronts.pareto import check_criteria, points_at_aims
from inerter.pareto_fronts.points import FrontPoint, non_dominated, triangle_steps
from inerter.vehicle.vehicle import Vehicle

Array = NDArray[np.float64]
NO_CONFLICT = 1e-6  # relative range of an index up to which there is no trade-off
SAME, TIED = 1e-4, 1e-6  # part of the range of an index that a network of more, or of as many, elements gains
_STARTS = 4  # of the sample, for each aim
_BLOCKS = 8  # of the sample for each value, of which each gives one start
_WAVE = 24  # networks that are searched before the next are chosen
_BEYOND = 1.0  # how far aims go on where networks of few elements have their single optima


@dataclass(frozen=True)
class FrontPlan:
    """A search for a front that can be handed to other processes."""

    plans: tuple[SearchPlan, ...]  # one for each index
    points: int

    @property
    def topologies(self) -> list[Topology]:
        """All networks, by number of elements."""
        return self.plans[0].topologies

    @cached_property
    def compiled_index(self) -> tuple[NetworkIndex, NDArray[np.int64]] | None:
        """The indices as one, and the index to which each group belongs; None where the search is not compiled."""
        several = [plan.compiled_index for plan in self.plans if plan.compiled_index is not None]
        if len(several) < len(self.plans) or any(one.is_peak for one in several):
            return None
        return join_indices(several)

    def kernels(self) -> list[Any]:
        """Compiled code that the search calls."""
        more = [] if self.compiled_index is None else [values_kernel()]
        return list(dict.fromkeys([*(kernel for plan in self.plans for kernel in plan.kernels()), *more]))


@dataclass(frozen=True, eq=False)
class FrontScale:
    """Aims (aims, indices) in multiples of the range of each index above its smallest value."""

    ideal: Array
    size: Array
    aims: Array
    is_smooth: bool

    def normalise(self, values: Array) -> Array:
        """Values of the indices as multiples of their ranges."""
        return np.asarray((values - self.ideal) / self.size)

    def excesses(self, values: Array) -> Array:
        """Excess of each row of values (designs, indices) over each aim; infinite where an index is."""
        over = self.normalise(np.where(np.isfinite(values), values, np.inf))[:, None] - self.aims
        worst = over.max(axis=2)
        if not self.is_smooth:
            return np.asarray(worst)
        with np.errstate(invalid="ignore"):
            total = np.exp(SHARP * (over - worst[:, :, None])).sum(axis=2)
        return np.where(np.isfinite(worst), worst + np.log(total) / SHARP, np.inf)


@dataclass(frozen=True)
class FrontTask:
    """A network to be searched for some of the aims, from its single optima (free values by name)."""

    topology: Topology
    ends: tuple[dict[str, float], ...]
    aims: tuple[int, ...]


@dataclass(frozen=True)
class NetworkPoints:
    """Designs of a network that exceed aims least, as plain data: values of the indices and of the free values."""

    topology: Topology
    aims: tuple[int, ...] = ()
    values: tuple[tuple[float, ...], ...] = ()
    parameters: tuple[dict[str, float], ...] = ()
    reason: str = ""  # why there are none
    doubts: tuple[str, ...] = ()  # of each, empty where its search is sure of it; none if all are

    @property
    def designs(self) -> list[FrontDesign]:
        """The designs as candidates for the front."""
        rows = zip(self.values, self.parameters, self.doubts or [""] * len(self.values), strict=True)
        return [FrontDesign(self.topology, *row) for row in rows]


def plan_front(
    vehicle: Vehicle,
    several: Sequence[IndexLike],
    method: Method,
    subject_to: Sequence[Limit],
    seed: int,
    starts: int | None,
    points: int,
) -> FrontPlan:
    """The search for a front as a plan; raises what `plan_search` and `pareto_front` raise."""
    criteria = check_criteria(several, points)
    plans = tuple(plan_search(vehicle, one, method, subject_to, seed, starts) for one in criteria)
    return FrontPlan(plans, int(points))


def front_group(plan: FrontPlan, scale: FrontScale, group: Iterable[FrontTask]) -> list[NetworkPoints]:
    """Points of some networks; a network that fails says why."""
    found = []
    for task in group:
        try:
            find = _points_compiled if scale.is_smooth else _points_by_pareto_front
            found.append(find(plan, scale, task))
        except InerterError as error:
            found.append(NetworkPoints(task.topology, reason=str(error)))
    return found


def _points_compiled(plan: FrontPlan, scale: FrontScale, task: FrontTask) -> NetworkPoints:
    assert plan.compiled_index is not None
    joined, criterion = plan.compiled_index
    first, size = plan.plans[0], task.topology.size
    network = first.network(task.topology)
    over = joined.over(network)
    each = [one.compiled_index.over(network) for one in plan.plans if one.compiled_index is not None]
    if over is None or any(one is None for one in each):
        return NetworkPoints(task.topology, reason="an index is infinite for all values")
    names, (lower, upper) = over.names, over.ends
    spread = np.log(upper / lower)

    def values_at(points: Array) -> Array:
        return np.column_stack([one.values(points) for one in each if one is not None])

    samples = quasi_random_points(_BLOCKS * size * TRIED, size, first.seed)
    excess = scale.excesses(values_at(lower * np.exp(samples * spread)))
    ends = [np.log(np.array([end[name] for name in names]) / lower) / spread for end in task.ends]
    relative = float(np.min(scale.size / scale.ideal))
    known: dict[int, tuple[float, Array]] = {}

    def search(aim: int, starts: Sequence[Array]) -> None:
        trade_off = TradeOff(criterion, scale.ideal + scale.aims[aim] * scale.size, scale.size, relative)
        found = over.search(np.clip(starts, 0.0, 1.0), 1, trade_off)
        best = int(np.argmin(found.values))
        if found.values[best] < known.get(aim, (np.inf,))[0]:
            known[aim] = found.values[best], np.log(found.points[best] / lower) / spread

    def nearest(aim: int) -> list[Array]:
        others = [one for one in known if one != aim]
        apart = [np.abs(scale.aims[one] - scale.aims[aim]).max() for one in others]
        return [known[others[i]][1] for i in np.argsort(apart, kind="stable")[:2]]

    for aim in task.aims:
        lowest = excess[:, aim].reshape(-1, TRIED).argmin(axis=1) + TRIED * np.arange(_BLOCKS * size)
        chosen = lowest[np.argsort(excess[lowest, aim], kind="stable")[:_STARTS]]
        search(aim, [*ends, *nearest(aim), *samples[chosen]])
    for aim in reversed(task.aims):  # once more from what its neighbours have by now
        search(aim, nearest(aim) or ends)
    aims = tuple(aim for aim in task.aims if aim in known)
    points = np.array([lower * np.exp(known[aim][1] * spread) for aim in aims]).reshape(-1, size)
    points = np.clip(points, lower, upper)
    return NetworkPoints(
        task.topology,
        aims,
        tuple(map(tuple, values_at(points).tolist())),
        tuple(dict(zip(names, point, strict=True)) for point in points.tolist()),
    )


def _points_by_pareto_front(plan: FrontPlan, scale: FrontScale, task: FrontTask) -> NetworkPoints:
    first = plan.plans[0]
    found = points_at_aims(
        first.design(task.topology),
        [one.index for one in plan.plans],
        first.method,
        first.limits,
        ends=task.ends,
        scale=(scale.ideal, scale.size),
        aims=scale.aims[list(task.aims)],
        seed=first.seed,
    )
    names = list(first.design(task.topology).free_values())
    kept = [(aim, one) for aim, one in zip(task.aims, found, strict=True) if one is not None]
    return NetworkPoints(
        task.topology,
        tuple(aim for aim, _ in kept),
        tuple(tuple(one.values.tolist()) for _, one in kept),
        tuple(dict(zip(names, one.point.tolist(), strict=True)) for _, one in kept),
        doubts=tuple(one.status.message for _, one in kept),
    )


def front_waves(
    plan: FrontPlan, searches: Sequence[SearchResult]
) -> Generator[tuple[FrontScale, list[FrontTask]], list[NetworkPoints], NetworkFront]:
    """The work that follows the search for each index: tasks in waves, after each of which its points are sent back.

    What a wave has depends on the points of those before it alone, so that the result does not depend on what shares
    the work. The generator returns the front.
    """
    ends = _single_optima(plan, searches)
    fronts = _without_conflict(ends)
    scale, trading = _scale_where_indices_trade(plan, ends)
    if scale is None:
        return collect_front(plan.plans, searches, fronts, 0, len(ends) - 1)
    bounds = {one.topology: scale.excesses(one.ideal[None])[0] for one in trading}
    found, reasons, n_searched = _Winners(scale), dict[Topology, str](), 0
    for size in sorted({one.topology.size for one in trading}):
        left = {one.topology: one for one in ends if one.topology.size == size}
        for one in left.values():
            found.enter(one.topology, one.designs)
        while tasks := _next_tasks(left, found.levels(size), bounds):
            several = yield scale, tasks
            for points in sorted(several, key=lambda one: one.topology):
                found.enter(points.topology, points.designs)
                reasons |= {points.topology: points.reason} if points.reason else {}
            for task in tasks:
                del left[task.topology]
            n_searched += len(tasks)
        smaller = [one for one in ends if one.topology.size <= size]
        best = [_best_in(smaller, index).designs[index] for index in range(len(scale.ideal))]
        fronts[size] = _non_dominated(scale, [*found.designs(), *best])
    return collect_front(plan.plans, searches, fronts, n_searched, len(ends) - n_searched, reasons)


@dataclass(frozen=True, eq=False)
class _SingleOptima:
    """The best designs of a network in each index; `values` (indices, indices) has a row for each of them."""

    topology: Topology
    values: Array
    parameters: tuple[dict[str, float], ...]
    doubts: tuple[str, ...]  # of the searches

    @property
    def ideal(self) -> Array:
        """Smallest value of each index."""
        return np.diagonal(self.values)

    @property
    def designs(self) -> list[FrontDesign]:
        """The best design in each index."""
        rows = zip(map(tuple, self.values.tolist()), self.parameters, self.doubts, strict=True)
        return [FrontDesign(self.topology, *row) for row in rows]


def _single_optima(plan: FrontPlan, searches: Sequence[SearchResult]) -> list[_SingleOptima]:
    """Single optima of the networks that have a value in every index, by number of elements."""
    by_topology = [{one.topology: one for one in result.ranking} for result in searches]
    found = []
    for topology in plan.topologies:
        own = [networks[topology] for networks in by_topology if topology in networks]
        if len(own) == len(searches):
            values = _all_values(plan, own)
            np.fill_diagonal(values, [one.value for one in own])
            doubts = tuple(one.status.message for one in own)
            found.append(_SingleOptima(topology, values, tuple(one.parameters for one in own), doubts))
    return found


def _all_values(plan: FrontPlan, own: Sequence[FoundNetwork]) -> Array:
    """Values of all indices at the best values in each (optima, indices)."""
    if plan.compiled_index is not None:
        first = plan.plans[0]
        network = first.network(own[0].topology)
        names = own[0].topology.names(first.taken_names)
        points = np.array([[one.parameters[name] for name in names] for one in own])
        over = [one.compiled_index.over(network) for one in plan.plans if one.compiled_index is not None]
        return np.column_stack([np.full(len(own), np.inf) if one is None else one.values(points) for one in over])
    asked = [one.index for one in plan.plans]
    return np.array([[estimate_of(one.design, index, one.plan.method).value for index in asked] for one in own])


def _scale_where_indices_trade(
    plan: FrontPlan, ends: Sequence[_SingleOptima]
) -> tuple[FrontScale | None, Sequence[_SingleOptima]]:
    """The networks of up to the most elements among which an index trades for another, and their scale."""
    for most in sorted({one.topology.size for one in ends}, reverse=True):
        trading = [one for one in ends if one.topology.size <= most]
        scale = _scale(plan, trading)
        if scale is not None:
            return scale, trading
    return None, ()


def _scale(plan: FrontPlan, ends: Sequence[_SingleOptima]) -> FrontScale | None:
    """Aims on the line or triangle through the single optima of all networks; None if no index trades for another."""
    count = len(plan.plans)
    best = [_best_in(ends, index) for index in range(count)]
    table = np.array([one.values[index] for index, one in enumerate(best)])
    ideal = np.diagonal(table).copy()
    size = np.where(np.isfinite(table), table, -np.inf).max(axis=0) - ideal
    traded = size > NO_CONFLICT * np.abs(ideal)
    if not traded.any():
        return None
    size = np.where(traded, size, np.abs(ideal))
    scale = FrontScale(ideal, size, np.zeros((0, count)), plan.compiled_index is not None)
    if count == 3:
        steps = triangle_steps(plan.points)
        shares = [one for one in product(range(steps + 1), repeat=3) if sum(one) == steps]
        return replace(scale, aims=np.array(shares[::-1]) / steps)
    places = []  # of the single optima of all networks up to each number of elements, along the line
    for most in sorted({one.topology.size for one in ends}):
        smaller = [one for one in ends if one.topology.size <= most]
        for index in range(count):
            x, y = scale.normalise(_best_in(smaller, index).values[index])
            places.append(0.5 * (x - y + 1.0))
    known = [place for place in places if np.isfinite(place)]
    step = 1.0 / (plan.points - 1)
    first, last = (np.clip(end, -_BEYOND, 1.0 + _BEYOND) / step for end in (min(known), max(known)))
    line = step * np.arange(np.floor(first + 1e-9), np.ceil(last - 1e-9) + 1)
    return replace(scale, aims=np.column_stack([line, 1.0 - line]))


def _best_in(ends: Sequence[_SingleOptima], index: int) -> _SingleOptima:
    """The network that is best in an index; of those that are as good within 1e-6 one of the fewest elements."""
    least = min(one.ideal[index] for one in ends)
    good = [one for one in ends if one.ideal[index] <= least * (1.0 + NO_CONFLICT)]
    return min(good, key=lambda one: (one.topology.size, one.ideal[index], one.topology))


def _without_conflict(ends: Sequence[_SingleOptima]) -> dict[int, list[FrontDesign]]:
    """Fronts of one design for each number of elements, where one network is best in all indices."""
    sizes = sorted({one.topology.size for one in ends})
    best = {size: _best_in([one for one in ends if one.topology.size <= size], 0) for size in sizes}
    return {size: one.designs[:1] for size, one in best.items()}


def _next_tasks(
    left: Mapping[Topology, _SingleOptima], level: Array, bounds: Mapping[Topology, Array]
) -> list[FrontTask]:
    """The networks that may come closest below the present level, each with the aims at which it may."""
    gains = {topology: level - bounds[topology] for topology in left}
    hopeful = sorted(
        (topology for topology, gain in gains.items() if gain.max() > 0.0),
        key=lambda topology: (-gains[topology].max(), topology),
    )
    return [
        FrontTask(one, left[one].parameters, tuple(np.flatnonzero(gains[one] > 0.0).tolist()))
        for one in hopeful[:_WAVE]
    ]


class _Winners:
    """The best design at each aim so far."""

    def __init__(self, scale: FrontScale) -> None:
        self.scale = scale
        self.excess = np.full(len(scale.aims), np.inf)
        self._best: list[FrontDesign | None] = [None] * len(scale.aims)

    def levels(self, size: int) -> Array:
        """The excess that a network of so many elements has to go below, at each aim."""
        smaller = np.array([one is None or one.topology.size < size for one in self._best])
        return self.excess - np.where(smaller, SAME, TIED)

    def enter(self, topology: Topology, designs: Sequence[FrontDesign]) -> None:
        """Let designs of a network take the aims at which they are better."""
        if not designs:
            return
        excess = self.scale.excesses(np.array([one.values for one in designs]))
        rows, level = excess.argmin(axis=0), self.levels(topology.size)
        for aim in np.flatnonzero(excess.min(axis=0) < level).tolist():
            self.excess[aim], self._best[aim] = excess[rows[aim], aim], designs[rows[aim]]

    def designs(self) -> list[FrontDesign]:
        """The best design at each aim."""
        return [one for one in self._best if one is not None]


def _non_dominated(scale: FrontScale, designs: Sequence[FrontDesign]) -> list[FrontDesign]:
    """Designs that no other one is better than in all indices, in ascending order of the first."""
    finite = [one for one in designs if np.all(np.isfinite(one.values))]
    points = [
        FrontPoint(np.array([i]), np.array(d.values), scale.normalise(np.array(d.values))) for i, d in enumerate(finite)
    ]
    kept = non_dominated(points, range(len(scale.ideal))) if points else []
    return [finite[int(one.point[0])] for one in kept]
