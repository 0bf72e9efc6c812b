"""Results of a search: the ranking, the frontier over the number of elements, and what can be said of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from math import isfinite
from typing import TYPE_CHECKING

from inerter.errors import OK, DesignError, NetworkError, Status, StatusKind
from inerter.methods.composite_index import estimate_of
from inerter.methods.error_bounds import with_verified_value
from inerter.methods.method import Estimate
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.networks.enumeration import BRIDGE, PARALLEL, SERIES, Topology, Tree
from inerter.networks.equivalence import equivalence_classes, transform_values
from inerter.notebook import shown_by
from inerter.validation import is_number
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from inerter.network_search.plan import SearchPlan

TIED = 1e-8  # relative difference up to which two networks have the same value
_LIKE = 1e-3  # the same for a network and what is left of it without elements at their bounds
_VERIFIED = 20  # networks from the best whose values are computed once more by the method itself


@dataclass(frozen=True, eq=False)
class FoundNetwork:
    """A network with its best values.

    `simpler` is the layout of a smaller network that does as well, within 0.1 %: one of equal admittance, or what is
    left without the elements at their bounds. `like` are all networks of equal admittance.

    >>> import inerter as it
    >>> place = it.any_network(1, springs=(1e3, 1e6), dampers=(100, 1e5))  # N/m, N s/m
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | place)
    >>> best = it.search(car, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm()).ranking[0]
    >>> best.layout, best.n_elements, best.unit, list(best.parameters)
    ('c1', 1, 'm/s^2', ['c1'])
    """

    topology: Topology
    layout: str
    value: float
    unit: str
    parameters: dict[str, float]
    active_bounds: dict[str, str]
    n_starts: int
    n_converged: int
    status: Status
    simpler: str
    like: tuple[str, ...]
    plan: SearchPlan

    @property
    def n_elements(self) -> int:
        """Number of elements."""
        return self.topology.size

    @cached_property
    def design(self) -> Vehicle:
        """The vehicle with this network and its best values."""
        return self.plan.design(self.topology).with_values(self.parameters)

    @cached_property
    def estimate(self) -> Estimate:
        """The index of the design by the method of the search."""
        return estimate_of(self.design, self.plan.index, self.plan.method)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """All networks of a search, the best first.

    Networks whose values differ by less than 1e-8 are ranked by number of elements, then by layout. `failed` are
    networks without a value, each with the reason.

    >>> import inerter as it
    >>> place = it.any_network(1, springs=(1e3, 1e6), dampers=(100, 1e5))  # N/m, N s/m
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | place)
    >>> found = it.search(car, it.RideComfort(it.Road(5e-7, 25.0)), it.Norm())
    >>> found.n_networks, found.ranking[0].value <= found.ranking[-1].value, found.unit
    (2, True, 'm/s^2')
    """

    _repr_html_ = shown_by("inerter.report.notebook:search_html")

    symbol: str
    unit: str
    ranking: tuple[FoundNetwork, ...]
    failed: tuple[tuple[str, str], ...]
    seed: int

    @property
    def n_networks(self) -> int:
        """Number of networks, those without a value included."""
        return len(self.ranking) + len(self.failed)

    @cached_property
    def frontier(self) -> tuple[FoundNetwork, ...]:
        """The best network of each number of elements that is better than all smaller ones, in ascending order.

        A network that does as well as a smaller one, with elements at their bounds, is counted there.
        """
        return tuple(self.ranking[i] for i in _frontier(self.ranking, lambda one: one.n_elements))

    @cached_property
    def frontier_of_inerters(self) -> tuple[FoundNetwork, ...]:
        """The best network of each number of inerters that is better than all of fewer; see `frontier`."""
        return tuple(self.ranking[i] for i in _frontier(self.ranking, _count_inerters))

    def near_optimal(self, within: float = 0.01) -> tuple[FoundNetwork, ...]:
        """Networks whose value is within a share of the best one, those of the fewest elements first.

        Raises `DesignError` for a share that is no number, or negative.
        """
        if not is_number(within) or within < 0.0:
            raise DesignError(f"The share must be a non-negative number such as 0.01 for 1 %, got {within!r}.")
        if not self.ranking:
            return ()
        limit = self.ranking[0].value * (1.0 + within)
        return tuple(sorted((one for one in self.ranking if one.value <= limit), key=lambda one: one.n_elements))


def _count_inerters(found: FoundNetwork) -> int:
    return found.topology.counts["b"]


def _frontier(ranking: Sequence[FoundNetwork], size_of: Callable[[FoundNetwork], int]) -> Iterator[int]:
    """Places in the ranking of the best network of each size, where it is better than all smaller ones."""
    first: dict[int, int] = {}
    for place, one in enumerate(ranking):
        if not one.simpler:
            first.setdefault(size_of(one), place)
    best = float("inf")
    for _, place in sorted(first.items()):
        if ranking[place].value < best * (1.0 - TIED):
            best = ranking[place].value
            yield place


def collect_results(plan: SearchPlan, searched: Iterable[SearchedNetwork]) -> SearchResult:
    """The result of a search from the optima of all its networks, in any order."""
    by_topology = {one.topology: one for one in searched}
    ordered = [by_topology[topology] for topology in plan.topologies]
    improved, like = _share_within_classes(plan, [one for one in ordered if isfinite(one.value)])
    lowest = {one.topology: one.value for one in improved}
    found = [_to_found_network(plan, one, like[one.topology], lowest) for one in rank_networks(improved)]
    frontiers = (_frontier(found, size_of) for size_of in (lambda one: one.n_elements, _count_inerters))
    for place in {*range(min(_VERIFIED, len(found))), *chain(*frontiers)}:
        found[place] = _verify(found[place])
    failed = tuple((plan.topology_text(one.topology), one.reason) for one in ordered if not isfinite(one.value))
    unit = found[0].unit if found else str(plan.index.unit)
    return SearchResult(str(plan.index.symbol), unit, tuple(found), failed, plan.seed)


def rank_networks(searched: Iterable[SearchedNetwork]) -> list[SearchedNetwork]:
    """Networks by value; those of equal value by number of elements, then by expression."""
    ranked: list[SearchedNetwork] = []
    group: list[SearchedNetwork] = []
    for one in sorted(searched, key=lambda one: (one.value, one.topology)):
        if group and one.value > group[0].value * (1.0 + TIED):
            ranked.extend(sorted(group, key=lambda each: each.topology))
            group = []
        group.append(one)
    return ranked + sorted(group, key=lambda each: each.topology)


def _share_within_classes(
    plan: SearchPlan, searched: Sequence[SearchedNetwork]
) -> tuple[list[SearchedNetwork], dict[Topology, tuple[Topology, ...]]]:
    """The networks, with the best values of one that has the same admittance where they keep the bounds.

    Also the other networks of each class.
    """
    known = {one.topology: one for one in searched}
    like: dict[Topology, tuple[Topology, ...]] = {}
    for members in equivalence_classes(known):
        best = min(members, key=lambda topology: (known[topology].value, topology))
        for topology in members:
            like[topology] = tuple(other for other in members if other != topology)
            own = known[topology]
            if plan.compiled_index is None or known[best].value >= own.value * (1.0 - TIED):
                continue
            try:
                values = transform_values(best, known[best].values, topology)
            except NetworkError:  # fewer elements have the admittance of the best, as those at equal bounds
                continue
            if plan.keeps_bounds(topology, values):
                value = known[best].value
                known[topology] = replace(own, value=value, values=tuple(values), n_converged=0)
    return list(known.values()), like


def _to_found_network(
    plan: SearchPlan, one: SearchedNetwork, like: tuple[Topology, ...], lowest: dict[Topology, float]
) -> FoundNetwork:
    names = one.topology.names(plan.taken_names)
    parameters = dict(zip(names, one.values, strict=True)) | one.others
    active = plan.active_bounds(one.topology, parameters)
    smaller = [other for other in like if other.size < one.topology.size]
    reduced = reduced_topology(one.topology, [active.get(name, "") for name in names]) if active else None
    if reduced is not None:
        smaller.append(reduced)
    simpler = [other for other in smaller if lowest.get(other, float("inf")) <= one.value * (1.0 + _LIKE)]
    return FoundNetwork(
        topology=one.topology,
        layout=plan.topology_text(one.topology),
        value=one.value,
        unit=str(plan.index.unit),
        parameters=parameters,
        active_bounds=active,
        n_starts=one.n_starts,
        n_converged=one.n_converged,
        status=OK if not one.reason else Status(StatusKind.INACCURATE, one.reason),
        simpler=plan.topology_text(min(simpler)) if simpler else "",
        like=tuple(map(plan.topology_text, like)),
        plan=plan,
    )


def _verify(found: FoundNetwork) -> FoundNetwork:
    """The network with the status of its value by the method itself."""
    if not found.status.ok:
        return found
    return replace(found, status=with_verified_value(found.estimate, found.value).status)


def reduced_topology(topology: Topology, at_bounds: Sequence[str]) -> Topology | None:
    """The network without elements at "lower" bounds (no force) and at "upper" ones (no motion).

    None if nothing is left, if it is the same network, or for a bridge.
    """
    rest = iter(at_bounds)
    found = _reduce(topology.tree, rest)
    if found is None or isinstance(found, bool):
        return None
    reduced = Topology(found)
    return reduced if reduced.size < topology.size else None


def _reduce(tree: Tree, rest: Iterator[str]) -> Tree | bool | None:
    """The tree without elements at bounds; False if it is open, True if it is rigid, None if that is not known."""
    if isinstance(tree, str):
        bound = next(rest)
        return {"lower": False, "upper": True}.get(bound, tree)
    operator, *parts = tree
    left = [_reduce(part, rest) for part in parts]
    if operator == BRIDGE:
        return tree if left == parts else None
    if any(part is None for part in left):
        return None
    decides = operator == PARALLEL
    if any(part is decides for part in left):
        return decides
    kept = [part for part in left if not isinstance(part, bool)]
    flat: list[Tree] = []
    for part in kept:
        flat.extend(part[1:] if isinstance(part, tuple) and part[0] == operator else [part])
    merged = [part for i, part in enumerate(flat) if not isinstance(part, str) or part not in flat[:i]]
    if not merged:
        return operator == SERIES
    return merged[0] if len(merged) == 1 else (operator, *merged)
