"""A network that is not chosen yet: `any_network`, a part of a strut that `search` finds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from functools import reduce
from operator import index, or_, sub

from inerter.errors import DesignError, NetworkError
from inerter.networks.elements import (
    CombinedNetwork,
    Damper,
    Element,
    Free,
    Inerter,
    Network,
    Parallel,
    Series,
    Spring,
    free,
)
from inerter.networks.elements.algebra import Complex, Fraction
from inerter.networks.elements.values import check_name
from inerter.networks.enumeration import Topology, enumerate_networks

Bounds = tuple[float, float] | None
_MOST = 7  # elements: seven give 11 thousand networks
_NOT_CHOSEN = (
    "The design contains any_network(...), which is not a network yet. Use search(...) to find the best one, "
    "or put a network in its place."
)


@dataclass(frozen=True)
class FreeNetwork(Network):
    """Any network of some springs, dampers and inerters, in parallel, in series and, if asked for, in bridges.

    Bounds are those of every element of a kind [N/m, N s/m, kg]; None leaves the kind out. Only `search` takes a
    vehicle with a free network.

    Raises `NetworkError` for bounds or numbers that are not valid.

    >>> import inerter as it
    >>> place = it.any_network(2, dampers=(10, 1e6), inerters=(1, 1e3))  # N s/m, kg
    >>> isinstance(place, it.FreeNetwork), len(list(place.topologies()))  # c, b, c | b, c - b
    (True, 4)
    """

    max_elements: int
    springs: Bounds = None
    dampers: Bounds = None
    inerters: Bounds = None
    min_elements: int = 1
    springs_at_most: int | None = None
    dampers_at_most: int | None = None
    inerters_at_most: int | None = None
    bridges: bool = False
    name: str | None = None

    def __post_init__(self) -> None:
        check_name(self.name)
        for what in ("max_elements", "min_elements", "springs_at_most", "dampers_at_most", "inerters_at_most"):
            object.__setattr__(self, what, _count(what, getattr(self, what)))
        if not 1 <= self.min_elements <= self.max_elements <= _MOST:
            raise NetworkError(
                f"A free network has from 1 to {_MOST} elements, got min_elements={self.min_elements} and "
                f"max_elements={self.max_elements}."
            )
        if not isinstance(self.bridges, bool):
            raise NetworkError(f"bridges must be True or False, got {self.bridges!r}.")
        for what, kind in (("springs", Spring), ("dampers", Damper), ("inerters", Inerter)):
            object.__setattr__(self, what, _bounds(what, kind, getattr(self, what)))
        if not self.bounds:
            raise NetworkError("A free network needs bounds of at least one kind, such as springs=(1e3, 1e7).")

    @property
    def bounds(self) -> dict[type[Element], tuple[float, float]]:
        """Bounds of the values of each kind of element in the network."""
        given = {Spring: self.springs, Damper: self.dampers, Inerter: self.inerters}
        return {kind: ends for kind, ends in given.items() if ends is not None}

    def elements(self) -> Iterator[Element]:
        """No elements yet."""
        return iter(())

    def fraction(self, s: Complex) -> Fraction:
        """Raises `DesignError`: no network is chosen yet."""
        raise DesignError(_NOT_CHOSEN)

    def topologies(self) -> list[Topology]:
        """All networks that it may be, by number of elements, then by expression."""
        limits = {"k": self.springs_at_most, "c": self.dampers_at_most, "b": self.inerters_at_most}
        return [
            topology
            for count in range(self.min_elements, self.max_elements + 1)
            for topology in enumerate_networks(count, kinds=tuple(self.bounds), bridges=self.bridges)
            if all(most is None or topology.counts[symbol] <= most for symbol, most in limits.items())
        ]

    def network(self, topology: Topology, taken: Set[str] = frozenset()) -> Network:
        """One of its networks with free values between the bounds; names that are `taken` are left out."""
        names = topology.names(taken)
        by_symbol = {kind.symbol: kind for kind in self.bounds}
        return topology.network(
            [
                by_symbol[symbol].of(free(*self.bounds[by_symbol[symbol]], name), name)
                for symbol, name in zip(topology.kinds, names, strict=True)
            ]
        )


def any_network(
    max_elements: int,
    springs: Bounds = None,
    dampers: Bounds = None,
    inerters: Bounds = None,
    *,
    min_elements: int = 1,
    springs_at_most: int | None = None,
    dampers_at_most: int | None = None,
    inerters_at_most: int | None = None,
    bridges: bool = False,
    name: str | None = None,
) -> FreeNetwork:
    """Any network of up to `max_elements` springs, dampers and inerters, for `search` to choose.

    `springs`, `dampers` and `inerters` are the lower and upper bounds of their values [N/m, N s/m, kg]; a kind without
    bounds is not used. Elements of one kind next to each other act as one, so such networks are not tried.

    Raises `NetworkError` for bounds or numbers that are not valid.

    >>> len(any_network(2, springs=(1e3, 1e6), dampers=(10.0, 1e5)).topologies())
    4
    """
    return FreeNetwork(
        max_elements,
        springs,
        dampers,
        inerters,
        min_elements,
        springs_at_most,
        dampers_at_most,
        inerters_at_most,
        bridges,
        name,
    )


def free_networks(network: Network) -> list[FreeNetwork]:
    """The free networks within a network, in the order of its parts."""
    if isinstance(network, FreeNetwork):
        return [network]
    if not isinstance(network, CombinedNetwork):
        return []
    return [found for part in network.parts for found in free_networks(part)]


def with_free_networks(network: Network, chosen: Mapping[FreeNetwork, Network]) -> Network:
    """The network with free networks replaced by others."""
    if isinstance(network, FreeNetwork):
        return chosen.get(network, network)
    if not isinstance(network, CombinedNetwork):
        return network
    parts = [with_free_networks(part, chosen) for part in network.parts]
    if network.name is None and isinstance(network, Parallel | Series):
        return reduce(or_ if isinstance(network, Parallel) else sub, parts)
    return network.with_parts(parts)


def check_chosen(network: Network) -> Network:
    """The network; raises `DesignError` if there is a free network in it."""
    if free_networks(network):
        raise DesignError(_NOT_CHOSEN)
    return network


def _count(what: str, value: object) -> int | None:
    if value is None and what.endswith("_at_most"):
        return None
    try:
        if isinstance(value, bool):
            raise TypeError
        found = index(value)  # type: ignore[arg-type]
    except TypeError:
        found = -1
    if found < 0:
        raise NetworkError(f"{what} must be a whole number, got {value!r}.")
    return found


def _bounds(what: str, kind: type[Element], given: object) -> Bounds:
    if given is None:
        return None
    if isinstance(given, Free):
        given = (given.lower, given.upper)
    lower: float
    upper: float
    try:
        lower, upper = given  # type: ignore[misc]
    except (TypeError, ValueError):
        raise NetworkError(
            f"{what} needs the lower and upper bound of a {kind.quantity} [{kind.unit}], such as (10, 1e6), "
            f"got {given!r}."
        ) from None
    kind.of(free(lower, upper))  # which checks both
    return float(lower), float(upper)
