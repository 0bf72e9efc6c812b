"""Results of a search for the front of several indices over networks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from inerter.errors import Status, StatusKind, worst_of
from inerter.methods.composite_index import estimate_of
from inerter.methods.error_bounds import with_verified_value
from inerter.methods.method import Estimate
from inerter.network_search.results import SearchResult
from inerter.networks.enumeration import Topology
from inerter.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from inerter.network_search.plan import SearchPlan

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrontDesign:
    """A network with free values, by name, the values of the indices, and what its search leaves uncertain."""

    topology: Topology
    values: tuple[float, ...]
    parameters: dict[str, float] = field(compare=False)
    doubt: str = field(default="", compare=False)


@dataclass(frozen=True, eq=False)
class FrontNetwork:
    """A point of a front: a network with its values, and the values of the indices.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.any_network(1, dampers=(100, 1e5)))
    >>> road = it.Road(5e-7, 25.0)
    >>> point = it.search(car, (it.RideComfort(road), it.TyreLoad(road)), it.Norm(), points=3).front[0]
    >>> point.layout, len(point.values)
    ('c1', 2)
    """

    topology: Topology
    layout: str
    values: tuple[float, ...]
    parameters: dict[str, float]
    active_bounds: dict[str, str]
    plans: tuple[SearchPlan, ...]  # of each index
    doubt: str = ""  # of the search: there may be a better design

    @property
    def n_elements(self) -> int:
        """Number of elements."""
        return self.topology.size

    @cached_property
    def design(self) -> Vehicle:
        """The vehicle with this network and its values."""
        return self.plans[0].design(self.topology).with_values(self.parameters)

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """The indices of the design by the method of the search."""
        return tuple(estimate_of(self.design, plan.index, plan.method) for plan in self.plans)

    @cached_property
    def status(self) -> Status:
        """Whether the search is sure of the design, and whether it has these values by the method itself."""
        pairs = zip(self.estimates, self.values, strict=True)
        worst = worst_of(with_verified_value(*pair).status for pair in pairs)
        return Status(StatusKind.INACCURATE, self.doubt) if worst.ok and self.doubt else worst


@dataclass(frozen=True, eq=False)
class NetworkFront:
    """The front of two or three indices over all networks: designs than which no design found is better in all.

    `by_elements` has the fronts of networks of up to so many elements, in ascending order of the first index. A network
    is on them where it gains more than 1e-4 of the range of the indices on all of fewer elements. `searches` are the
    rankings for each index. `n_bounded` networks were not searched between their single optima, since even the best
    values in each index, taken together, are no better than the front.

    >>> import inerter as it
    >>> car = it.QuarterCar(250.0, 35.0, 180e3, it.Spring(60e3) | it.any_network(1, dampers=(100, 1e5)))
    >>> road = it.Road(5e-7, 25.0)
    >>> front = it.search(car, (it.RideComfort(road), it.TyreLoad(road)), it.Norm(), points=3)
    >>> front.symbols, front.units, front.networks
    (('J1', 'J3'), ('m/s^2', 'N'), ('c1',))
    """

    symbols: tuple[str, ...]
    units: tuple[str, ...]
    by_elements: dict[int, tuple[FrontNetwork, ...]]
    searches: tuple[SearchResult, ...]
    failed: tuple[tuple[str, str], ...]
    n_searched: int
    n_bounded: int
    seed: int

    @property
    def front(self) -> tuple[FrontNetwork, ...]:
        """The front over all networks."""
        return self.by_elements[max(self.by_elements)] if self.by_elements else ()

    @property
    def n_networks(self) -> int:
        """Number of networks, those without a value included."""
        return self.searches[0].n_networks

    @property
    def values(self) -> Array:
        """Values of the indices (points, indices) along the front."""
        return np.array([one.values for one in self.front]).reshape(-1, len(self.symbols))

    @property
    def networks(self) -> tuple[str, ...]:
        """Layouts of the networks on the front, in the order in which they occur."""
        return tuple(dict.fromkeys(one.layout for one in self.front))


def collect_front(
    plans: Sequence[SearchPlan],
    searches: Sequence[SearchResult],
    fronts: Mapping[int, Sequence[FrontDesign]],
    n_searched: int,
    n_bounded: int,
    reasons: Mapping[Topology, str] | None = None,
) -> NetworkFront:
    """The result from the fronts by number of elements."""
    first, known = plans[0], dict[FrontDesign, FrontNetwork]()
    for one in dict.fromkeys(design for several in fronts.values() for design in several):
        layout, active = first.topology_text(one.topology), first.active_bounds(one.topology, one.parameters)
        known[one] = FrontNetwork(one.topology, layout, one.values, one.parameters, active, tuple(plans), one.doubt)
    told = {layout: f"{result.symbol}: {reason}" for result in searches for layout, reason in result.failed}
    told |= {first.topology_text(topology): reason for topology, reason in (reasons or {}).items()}
    return NetworkFront(
        tuple(one.symbol for one in searches),
        tuple(one.unit for one in searches),
        {size: tuple(known[one] for one in several) for size, several in fronts.items()},
        tuple(searches),
        tuple(told.items()),
        n_searched,
        max(n_bounded, 0),
        first.seed,
    )
