"""A mechanism as a graph: nodes that move, and elements between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from inerter.errors import DesignError, MechanismError
from inerter.networks.elements import Bridge, CombinedNetwork, Element, Free, Network, Parallel, Series
from inerter.networks.transform import (
    UpsideDown,
    expand_elements,
    linearise,
    map_elements,
    notes_of,
    parts_between,
    to_analysis,
    to_simulation,
)
from inerter.vehicle.mechanism import Mechanism, Strut, Tyre

Matrix = NDArray[np.float64]
Labelled = Element | CombinedNetwork
Carriers = dict[int, float]  # branches by number, with the sign of their share in a force


@dataclass(frozen=True, eq=False)
class Branch:
    """An element with its place: its elongation is `nodes` @ node displacements + `roads` @ road displacements."""

    element: Element
    label: str
    nodes: Matrix
    roads: Matrix


@dataclass(frozen=True, eq=False)
class Mount:
    """A network in its place: its own elongation, and branches whose forces, with their signs, add up to its force."""

    nodes: Matrix
    roads: Matrix
    carriers: Carriers


@dataclass(frozen=True, eq=False)
class Graph:
    """Nodes (coordinates first, then the massless ones inside networks), branches between them, and mounts by name.

    `groups` are networks with a label of their own, such as those that stand for an element. What a `silent` label
    means in linear analysis alone is no output.
    """

    nodes: tuple[str, ...]
    branches: tuple[Branch, ...]
    mounts: dict[str, Mount]
    groups: dict[str, Mount]
    silent: frozenset[str]
    notes: tuple[str, ...]


_last: tuple[Mechanism, Graph] | None = None  # several analyses of one design follow each other


def linear_graph(mechanism: Mechanism) -> Graph:
    """Graph of the linear model: neglects friction and treats gaps as closed, as `notes` states.

    What is left has the labels that it has in `full_graph`.

    Raises `MechanismError` if a mounted network then carries no force at all, or is rigid.
    """
    global _last  # noqa: PLW0603 - both together, so that threads see one or the other
    known = _last
    if known is None or known[0] is not mechanism:
        known = _last = mechanism, _linear_graph(mechanism)
    return known[1]


def _linear_graph(mechanism: Mechanism) -> Graph:
    whole, labels = _collect_labels(mechanism, to_analysis)
    made = {mount.name: linearise(whole[mount.name]) for mount in mechanism.mounts()}
    networks: dict[str, Network] = {}
    for name, linear in made.items():
        if linear.network is None and linear.rigid:
            raise MechanismError(
                f"{name!r} is rigid in linear analysis, which treats gaps as closed: {linear.gaps[0]!r} joins "
                "its two "
                f"ends with nothing in between. Put a spring or damper in series with the gap."
            )
        if linear.network is None:
            raise MechanismError(
                f"{name!r} carries no force in linear analysis, which neglects friction "
                f"({', '.join(linear.frictions)}): its ends are unconstrained there. Add a spring, damper or inerter."
            )
        networks[name] = linear.network
    graph = _expand(mechanism, networks, labels, tuple(notes_of(made)), dict(mechanism.twins))
    if all(element.plain for element in mechanism.elements()):
        return graph
    return replace(graph, silent=_other_meanings(graph, full_graph(mechanism)))


def full_graph(mechanism: Mechanism) -> Graph:
    """The graph with every element in it, friction and gaps included."""
    return _expand(mechanism, *_collect_labels(mechanism, _to_piecewise), (), {})


def _other_meanings(linear: Graph, full: Graph) -> frozenset[str]:
    """Labels of parts that represent an element in the linear model but not, or with other values, in simulation."""
    parts = {branch.label: branch.element for branch in full.branches}
    return frozenset(b.label for b in linear.branches if b.label not in full.groups and parts.get(b.label) != b.element)


def switching(mechanism: Mechanism) -> Mechanism:
    """Mechanism with the elements that simulation uses; the same object if none differs.

    Raises `DesignError` where that depends on a free value.
    """
    if all(element.as_piecewise() is element for element in mechanism.elements()):
        return mechanism
    return mechanism.with_networks(lambda mount: expand_elements(mount.network, to_simulation))


def switching_parts(element: Element) -> Iterator[Element]:
    """Elements that simulation uses in place of one; a free value may be at its upper bound in them."""
    return expand_elements(element, _to_piecewise).elements()


def _to_piecewise(element: Element) -> Network:
    """`Element.as_piecewise`, of a free value at its upper bound where need be: the shape does not depend on it."""
    try:
        return element.as_piecewise()
    except DesignError:
        assert isinstance(element.value, Free)
        return element.with_value(element.value.upper).as_piecewise()


def _collect_labels(
    mechanism: Mechanism, view: Callable[[Element], Network]
) -> tuple[dict[str, Network], dict[int, str]]:
    """The mounted networks with groups named by their labels, and the label of each element by its identity.

    Each element is an object of its own: one may be mounted several times.
    """
    networks = {mount.name: map_elements(expand_elements(mount.network, view), copy) for mount in mechanism.mounts()}
    placed = [(mount, part) for mount, network in networks.items() for part in _with_labels(network)]
    labels = {id(part): label for (_, part), label in zip(placed, _unique(placed), strict=True)}
    return {mount: _with_groups(network, labels) for mount, network in networks.items()}, labels


def _with_labels(network: Network) -> Iterator[Labelled]:
    """Groups and elements."""
    if isinstance(network, CombinedNetwork):
        if network.name is not None:
            yield network
        for part in network.parts:
            yield from _with_labels(part)
    elif isinstance(network, Element):
        yield network


def _with_groups(network: Network, labels: Mapping[int, str]) -> Network:
    if not isinstance(network, CombinedNetwork):
        return network
    parts = [_with_groups(part, labels) for part in network.parts]
    return replace(network.with_parts(parts), name=labels.get(id(network)))  # type: ignore[type-var]


def _expand(
    mechanism: Mechanism,
    networks: Mapping[str, Network],
    labels: Mapping[int, str],
    notes: tuple[str, ...],
    twins: Mapping[str, str],
) -> Graph:
    """The graph, in which `twins` have no inner nodes of their own: a difference of theirs would be a motion that
    nothing excites, and that nothing may damp.
    """
    coordinates = [c.name for c in mechanism.coordinates]
    roads = [r.name for r in mechanism.roads]
    size = len(coordinates) + sum(_inner_nodes(network) for name, network in networks.items() if name not in twins)
    builder = _Builder([*coordinates])
    mounts: dict[str, Mount] = {}
    for mount in mechanism.mounts():
        upper, lower = np.zeros(size + len(roads)), np.zeros(size + len(roads))
        match mount:
            case Strut():
                ports = ((upper, mount.upper), (lower, mount.lower))
            case Tyre():
                ports = ((upper, mount.port), (lower, {}))
                lower[size + roads.index(mount.road)] = 1.0
        for end, port in ports:
            for name, lever in port.items():
                end[coordinates.index(name) if name in coordinates else size + roads.index(name)] = lever
        carriers = builder.mount(mount.name, networks[mount.name], (upper, lower), twins.get(mount.name))
        elongation = upper - lower
        mounts[mount.name] = Mount(elongation[:size], elongation[size:], carriers)
    branches = tuple(Branch(element, labels[id(element)], row[:size], row[size:]) for element, row in builder.branches)
    groups = {label: Mount(row[:size], row[size:], carriers) for label, (row, carriers) in builder.groups.items()}
    return Graph(tuple(builder.nodes), branches, mounts, groups, frozenset(), notes)


@dataclass
class _Builder:
    nodes: list[str]
    branches: list[tuple[Element, Matrix]] = field(default_factory=list)
    groups: dict[str, tuple[Matrix, Carriers]] = field(default_factory=dict)
    places: dict[str, list[Matrix]] = field(default_factory=dict)  # of each mount: its ends and its inner nodes
    shared: list[Matrix] = field(default_factory=list)  # inner nodes of its twin that a mount will have

    def mount(self, name: str, network: Network, ends: tuple[Matrix, Matrix], twin: str | None) -> Carriers:
        """Add the network of a mount between its ends, in the places of its `twin` if it has one."""
        upper, lower = ends
        if twin is not None:
            alike = np.array_equal(upper - lower, np.subtract(*self.places[twin][:2]))
            upper, lower, *self.shared = (place if alike else 0.0 - place for place in self.places[twin])
        self.places[name] = [upper, lower]
        return self.add(name, network, upper, lower)

    def add(self, mount: str, network: Network, upper: Matrix, lower: Matrix) -> Carriers:
        """Add `network` between two ends; returns the branches whose forces add up to its force."""
        carriers = self._add(mount, network, upper, lower)
        if isinstance(network, CombinedNetwork) and network.name is not None:
            self.groups[network.name] = (upper - lower, carriers)
        return carriers

    def _add(self, mount: str, network: Network, upper: Matrix, lower: Matrix) -> Carriers:
        placed = parts_between(network, upper, lower, lambda number: self._node(mount, number, upper.size))
        carriers = [self.add(mount, *part) for part in placed]
        match network:
            case Element():
                self.branches.append((network, upper - lower))
                return {len(self.branches) - 1: 1.0}
            case Parallel():
                return _merge(carriers)
            case Series():
                return min(carriers, key=len)
            case Bridge():
                a, b, c, d, _ = carriers
                return min(_merge((a, c)), _merge((b, d)), key=len)
            case UpsideDown():
                return {branch: -sign for branch, sign in carriers[0].items()}
        raise TypeError(f"not a network: {network!r}")

    def _node(self, mount: str, number: int, size: int) -> Matrix:
        if self.shared:
            return self.shared.pop(0)
        end = np.zeros(size)
        end[len(self.nodes)] = 1.0
        self.nodes.append(f"{mount}.node{len(self.nodes)}_{number}")
        self.places[mount].append(end)
        return end


def _merge(several: Iterable[Carriers]) -> Carriers:
    return {branch: sign for carriers in several for branch, sign in carriers.items()}


def _inner_nodes(network: Network) -> int:
    match network:
        case Parallel(parts):
            return sum(map(_inner_nodes, parts))
        case Series(parts):
            return len(parts) - 1 + sum(map(_inner_nodes, parts))
        case Bridge():
            return 2 + sum(map(_inner_nodes, network.parts))
        case UpsideDown(turned):
            return _inner_nodes(turned)
    return 0


def _unique(placed: list[tuple[str, Labelled]]) -> list[str]:
    """Labels, plain where that is unique or the only name given; else with the mount before, or a number behind."""
    labels = [str(part.label if isinstance(part, Element) else part.name) for _, part in placed]
    names = [element.name for _, element in placed]
    plain = [
        labels.count(la) == 1 or (n is not None and names.count(n) == 1) for la, n in zip(labels, names, strict=True)
    ]
    full = [la if alone else f"{mount}.{la}" for (mount, _), la, alone in zip(placed, labels, plain, strict=True)]
    return [name if full.count(name) == 1 else f"{name}{full[: i + 1].count(name)}" for i, name in enumerate(full)]
