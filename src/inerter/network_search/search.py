"""`search`: the best values of every network that a free network may be, ranked, or the front of several indices.

A norm over random roads or forces without delays is searched in compiled code that takes any network
(`methods.network_norm`); anything else by `optimise` or `pareto_front`, network by network.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from typing import overload

import numpy as np

from inerter.errors import DesignError
from inerter.kernels.prepare import prepare_on
from inerter.methods.composite_index import IndexLike
from inerter.methods.method import Method
from inerter.network_search.front_results import NetworkFront
from inerter.network_search.fronts import FrontPlan, NetworkPoints, front_group, front_waves, plan_front
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.network_search.plan import SearchPlan, plan_search, search_group
from inerter.network_search.results import SearchResult, collect_results
from inerter.optimisation.limits import Limit
from inerter.validation import check_whole
from inerter.vehicle.vehicle import Vehicle
from inerter.work.pool import Pool, worker_pool
from inerter.work.progress import report


@overload
def search(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    *,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    starts: int | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
) -> SearchResult: ...


@overload
def search(
    vehicle: Vehicle,
    index: Sequence[IndexLike],
    method: Method,
    *,
    points: int = 25,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    starts: int | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
) -> NetworkFront: ...


def search(
    vehicle: Vehicle,
    index: IndexLike | Sequence[IndexLike],
    method: Method,
    *,
    points: int = 25,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    starts: int | None = None,
    jobs: int = 1,
    executor: Executor | None = None,
) -> SearchResult | NetworkFront:
    """The best values of every network that the free network in `vehicle` may be, ranked by `index`.

    The vehicle has one `any_network(...)`; in several places it is the same network with the same values. Each network
    is searched from `starts` points (default: 8 for each value, and 32 where few of them find the best), as in
    `optimise`. `jobs` processes or an `executor` (of `concurrent.futures`, of a dask client, of mpi4py) share the
    networks. The same seed gives the same result, whatever shares the work.

    For two or three indices the result is the front over all networks, with about `points` designs between the single
    optima.

    Raises `DesignError` without exactly one free network, or if `seed`, `starts`, `points` or `jobs` are not valid, and
    what `optimise` and `pareto_front` raise for the indices, the method and the constraints.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) | it.any_network(2, dampers=(10, 1e6), inerters=(0.01, 1e5))
    >>> car = it.QuarterCar(sprung_mass=181.75, unsprung_mass=25, tyre_stiffness=120e3, strut=strut)
    >>> road = it.Road(roughness=5e-7, speed=25)
    >>> found = it.search(car, it.RideComfort(road), it.Norm())
    >>> found.ranking[0].layout, round(found.ranking[0].value, 4)
    ('c1 - b1', 2.4281)
    >>> it.search(car, (it.RideComfort(road), it.TyreLoad(road)), it.Norm(), points=5).networks
    ('c1 - b1',)
    """
    check_whole(DesignError, "`jobs`", jobs, 1)
    if isinstance(index, Sequence) and not isinstance(index, str):
        front = plan_front(vehicle, index, method, subject_to, seed, starts, points)
        with worker_pool(int(jobs), executor) as pool:
            prepare_on(pool, front.kernels())
            return _search_front(front, pool)
    plan = plan_search(vehicle, index, method, subject_to, seed, starts)
    with worker_pool(int(jobs), executor) as pool:
        prepare_on(pool, plan.kernels())
        return _search_one_index(plan, pool)


def _search_one_index(plan: SearchPlan, pool: Pool) -> SearchResult:
    groups = plan.groups()
    found: list[SearchedNetwork] = []
    for result in pool.spread(partial(search_group, replace(plan)), groups):  # without all topologies in its cache
        found.extend(result)
        best = min((one.value for one in found), default=np.inf)
        report("networks", len(found), len(plan.topologies), best=best if np.isfinite(best) else None)
    return collect_results(plan, found)


def _search_front(plan: FrontPlan, pool: Pool) -> NetworkFront:
    searches = [_search_one_index(one, pool) for one in plan.plans]
    waves, done = front_waves(plan, searches), 0
    sent = replace(plan, plans=tuple(map(replace, plan.plans)))  # without all topologies in their caches
    try:
        scale, tasks = next(waves)
        while True:
            found: list[NetworkPoints] = []
            for result in pool.spread(partial(front_group, sent, scale), [(task,) for task in tasks]):
                found.extend(result)
                report("networks between single optima", done + len(found), done + len(tasks))
            done += len(found)
            scale, tasks = waves.send(found)
    except StopIteration as end:
        front: NetworkFront = end.value
        return front
