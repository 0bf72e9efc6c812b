"""The plan of a search over networks, and the best values of some of its networks.

A norm over random roads or forces without delays is searched in compiled code that takes any network
(`methods.network_norm`); anything else by `optimise`, network by network.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, InerterError, Status, StatusKind
from inerter.methods.composite_index import IndexLike, estimate_of, is_composite
from inerter.methods.method import Method, check_request
from inerter.methods.network_norm import PLACE, TRIED, NetworkIndex, network_index, network_kernel
from inerter.methods.norm import is_exact_norm
from inerter.network_search.network_optimum import SearchedNetwork
from inerter.networks.elements import Damper, Free, Network, Spring, free
from inerter.networks.enumeration import Topology
from inerter.networks.free_network import FreeNetwork, free_networks, with_free_networks
from inerter.optimisation.limits import Limit, check_limits
from inerter.optimisation.optimise import AGREEMENT, active_bounds, optimise, quasi_random_points
from inerter.validation import check_whole
from inerter.vehicle.replace_values import mounted_elements, with_networks
from inerter.vehicle.vehicle import Vehicle, check_vehicle

Array = NDArray[np.float64]
_STARTS = 8  # searches for each value
_SELDOM, _MORE = 10, 4  # where at most one start in so many finds the best value, so many times as many follow
_GROUP = 24  # networks that are handed out together
_CONFIRMED, _EQUAL = 6, 1e-8  # optima of a peak gain that are evaluated once more; largest relative difference


@dataclass(frozen=True)
class SearchPlan:
    """A search that can be handed to other processes in groups of networks."""

    vehicle: Vehicle
    index: IndexLike
    method: Method
    limits: tuple[Limit, ...]
    seed: int
    starts: int | None
    place: FreeNetwork
    compiled_index: NetworkIndex | None  # None: by `optimise`

    @cached_property
    def topologies(self) -> list[Topology]:
        """All networks, by number of elements, then by expression."""
        return self.place.topologies()

    def groups(self) -> list[tuple[Topology, ...]]:
        """The networks in groups, those with the most elements first, since they take longest."""
        several = self.topologies[::-1]
        size = _GROUP if self.compiled_index is not None else 1
        return [tuple(several[i : i + size]) for i in range(0, len(several), size)]

    @cached_property
    def taken_names(self) -> frozenset[str]:
        """Names of the elements and of the free values beside the free network."""
        labels = {element.label for part in mounted_elements(self.vehicle) for element in part}
        return frozenset(labels.union(self.other_values))

    @cached_property
    def other_values(self) -> dict[str, Free]:
        """Free values beside the free network."""
        return with_chosen_network(self.vehicle, self.place, Damper(1.0)).free_values()

    def network(self, topology: Topology) -> Network:
        """A network with free values."""
        return self.place.network(topology, self.taken_names)

    def design(self, topology: Topology) -> Vehicle:
        """The vehicle with a network with free values."""
        return with_chosen_network(self.vehicle, self.place, self.network(topology))

    def topology_text(self, topology: Topology) -> str:
        """The expression of a network by the names that its elements have in the design."""
        return topology.format_expression(topology.names(self.taken_names))

    def ends(self, topology: Topology) -> list[tuple[float, float]]:
        """Bounds of the elements in the order of the expression."""
        by_symbol = {kind.symbol: ends for kind, ends in self.place.bounds.items()}
        return [by_symbol[symbol] for symbol in topology.kinds]

    def keeps_bounds(self, topology: Topology, values: Sequence[float]) -> bool:
        """Whether element values lie between their bounds."""
        return all(low <= value <= high for value, (low, high) in zip(values, self.ends(topology), strict=True))

    def active_bounds(self, topology: Topology, parameters: Mapping[str, float]) -> dict[str, str]:
        """Free values at a bound, of the network and beside it, with "lower" or "upper", by name."""
        names, ends = topology.names(self.taken_names), self.ends(topology)
        own = {name: Free(low, high, name) for name, (low, high) in zip(names, ends, strict=True)}
        return active_bounds({**own, **self.other_values}, parameters)

    def kernels(self) -> list[Any]:
        """Compiled code that the search calls."""
        return [] if self.compiled_index is None else [network_kernel(self.compiled_index.definition)]


def plan_search(
    vehicle: Vehicle,
    index: IndexLike,
    method: Method,
    subject_to: Sequence[Limit] = (),
    seed: int = 0,
    starts: int | None = None,
) -> SearchPlan:
    """The search as a plan; see `search.search`."""
    check_vehicle(vehicle)
    check_whole(DesignError, "`seed`", seed)
    check_whole(DesignError, "`starts`", 1 if starts is None else starts, 1)
    places = places_of(vehicle)
    if len(set(places)) != 1:
        found = "no free network" if not places else f"{len(set(places))} different free networks"
        raise DesignError(
            f"A search needs a design with one free network, such as Spring(120e3) | any_network(4, ...); got {found}."
        )
    place, limits = places[0], check_limits(subject_to)
    kind, ends = next(iter(place.bounds.items()))
    probe = with_chosen_network(vehicle, place, kind.of(free(*ends), PLACE))
    for asked in (index, *(limit.of for limit in limits)):
        check_request(probe, asked, method)
    plan = SearchPlan(vehicle, index, method, limits, int(seed), None if starts is None else int(starts), place, None)
    if not plan.topologies:
        raise DesignError(f"There is no network to search: {place!r} leaves out all of them.")
    alone = len(places) == 1 and not limits and is_exact_norm(method) and not is_composite(index)
    if not alone:
        return plan
    probe = with_chosen_network(vehicle, place, Damper(free(1.0, 2.0, PLACE), PLACE))
    if set(probe.free_values()) != {PLACE}:
        return plan
    sprung = with_chosen_network(vehicle, place, Spring(1.0))
    try:
        mechanism = probe.mechanism()
        definition, other = (index.definition(m) for m in (mechanism, sprung.mechanism()))  # type: ignore[union-attr]
        if definition.outputs != other.outputs:  # the index depends on which networks carry weight
            return plan
        return replace(plan, compiled_index=network_index(mechanism, definition, PLACE))
    except InerterError:  # `optimise` says which networks have no index
        return plan


def places_of(vehicle: Vehicle) -> list[FreeNetwork]:
    """The free networks of a vehicle, as often as they occur."""
    found: list[FreeNetwork] = []

    def look(network: Network) -> Network:
        found.extend(free_networks(network))
        return network

    with_networks(vehicle, look)
    return found


def with_chosen_network(vehicle: Vehicle, place: FreeNetwork, network: Network) -> Vehicle:
    """The vehicle with a network in the place of its free network."""
    return with_networks(vehicle, lambda mounted: with_free_networks(mounted, {place: network}))


def search_group(plan: SearchPlan, group: Iterable[Topology]) -> list[SearchedNetwork]:
    """Optima of some networks; a network that fails says why."""
    one: Callable[[SearchPlan, Topology], SearchedNetwork] = (
        _search_compiled if plan.compiled_index else _search_by_optimise
    )
    found = []
    for topology in group:
        try:
            found.append(one(plan, topology))
        except InerterError as error:
            found.append(SearchedNetwork(topology, reason=str(error)))
    return found


def _search_compiled(plan: SearchPlan, topology: Topology) -> SearchedNetwork:
    assert plan.compiled_index is not None
    starts = plan.starts or _STARTS * topology.size
    over = plan.compiled_index.over(plan.network(topology))
    if over is None:  # for an index that is infinite, or zero, whatever the values
        return _search_by_optimise(plan, topology)
    found = over.search(quasi_random_points(starts * TRIED, topology.size, plan.seed))
    lowest = found.values.min()
    equal = int(np.sum(found.values <= lowest * (1.0 + AGREEMENT)))
    if plan.starts is None and np.isfinite(lowest) and equal * _SELDOM < starts:
        starts *= _MORE
        found = over.search(quasi_random_points(starts * TRIED, topology.size, plan.seed))
    values, points = found.values, found.points
    if not np.isfinite(values.min()):  # without damping, or with less than compiled code can tell from none
        middle = dict(zip(topology.names(plan.taken_names), np.sqrt(np.prod(over.ends, axis=0)).tolist(), strict=True))
        estimate = estimate_of(plan.design(topology).with_values(middle), plan.index, plan.method)
        if np.isfinite(estimate.value):
            return _search_by_optimise(plan, topology)
        return SearchedNetwork(topology, starts, reason=_infinite_reason(topology, estimate.status))
    best = _first_confirmed(plan, topology, values, points) if plan.compiled_index.is_peak else int(np.argmin(values))
    if best is None:
        return _search_by_optimise(plan, topology)
    agree = int(np.sum(np.abs(values - values[best]) <= values[best] * AGREEMENT))
    return SearchedNetwork(topology, starts, agree, float(values[best]), tuple(points[best].tolist()))


def _infinite_reason(topology: Topology, status: Status) -> str:
    """Why the index of a network is infinite: the status at the middle of its bounds."""
    undamped = "" if topology.counts["c"] else ", which has no damper"
    detail = f"{status.message} at the middle of the bounds" if status.message else "at the middle of the bounds too"
    return f"infinite at all starts of this network{undamped}: {detail}"


def _first_confirmed(plan: SearchPlan, topology: Topology, values: Array, points: Array) -> int | None:
    """The best of some optima whose value is that of the method itself, since a search may miss a sharp peak."""
    design, names = plan.design(topology), topology.names(plan.taken_names)
    for number in np.argsort(values, kind="stable")[:_CONFIRMED].tolist():
        values_of = dict(zip(names, points[number].tolist(), strict=True))
        estimate = estimate_of(design.with_values(values_of), plan.index, plan.method)
        if estimate.status.ok and abs(estimate.value - values[number]) <= _EQUAL * values[number]:
            return int(number)
    return None


def _search_by_optimise(plan: SearchPlan, topology: Topology) -> SearchedNetwork:
    design = plan.design(topology)
    found = optimise(design, plan.index, plan.method, subject_to=plan.limits, seed=plan.seed, starts=plan.starts)
    if not np.isfinite(found.value) or found.status.kind is StatusKind.INFEASIBLE:
        return SearchedNetwork(topology, found.n_starts, reason=found.status.message or "the index is infinite")
    names = topology.names(plan.taken_names)
    others = {name: value for name, value in found.parameters.items() if name not in names}
    return SearchedNetwork(
        topology,
        found.n_starts,
        found.n_converged,
        found.value,
        tuple(found.parameters[name] for name in names),
        others,
        found.status.message or found.status.doubt,
    )
