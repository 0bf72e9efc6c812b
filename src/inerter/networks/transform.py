"""Transformations of networks: naming and fixing of free values, expansion of elements, and linearisation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from typing import TypeVar

from inerter.errors import DesignError
from inerter.formatting import format_list, format_range
from inerter.networks.elements import Bridge, CombinedNetwork, Element, Free, Network, Parallel, Series, Tied
from inerter.networks.elements.algebra import Complex, Fraction, reduce_bridge
from inerter.networks.elements.roles import LinearRole
from inerter.networks.free_network import FreeNetwork, check_chosen

End = TypeVar("End")  # of a network, in whatever form a caller has it


def map_elements(network: Network, change: Callable[[Element], Network]) -> Network:
    """The same network with each element replaced by `change(element)`."""
    match network:
        case CombinedNetwork():
            return network.with_parts([map_elements(part, change) for part in network.parts])
        case Element():
            return change(network)
        case FreeNetwork():
            return network
    raise TypeError(f"not a network: {network!r}")


def expand_elements(network: Network, view: Callable[[Element], Network]) -> Network:
    """The network with each element replaced by `view(element)`, such as `to_simulation`, recursively.

    A single part without a name takes the label of the replaced element. For several parts, the network takes the
    label, and the parts take it as a prefix. Unchanged elements are the same objects.

    Raises `DesignError` for a network that is not chosen yet.
    """
    check_chosen(network)

    def change(element: Element) -> Network:
        seen = view(element)
        if seen is element:
            return element
        if isinstance(seen, Element):
            return expand_elements(seen if seen.name is not None else _with_name(seen, element.label), view)
        own = (None, element.label)
        named = map_elements(
            seen, lambda part: _with_name(part, f"{element.label}_{part.symbol}") if part.name in own else part
        )
        assert isinstance(named, CombinedNetwork)
        return expand_elements(replace(named, name=element.label), view)  # type: ignore[type-var]

    return map_elements(network, change)


def to_analysis(element: Element) -> Network:
    """Network that replaces an element in linear analysis."""
    return element.as_linear()


def to_simulation(element: Element) -> Network:
    """Network that replaces an element in simulation; raises `DesignError` if that depends on a free value."""
    return element.as_piecewise()


def _with_name(part: Element, name: str) -> Element:
    return replace(part, name=name)  # type: ignore[type-var]


def with_values(network: Network, values: Mapping[str, float]) -> Network:
    """`network` with the free values named in `values`, and values tied to them, fixed; other names are ignored."""

    def fix(element: Element) -> Network:
        value = element.value
        if isinstance(value, Tied):
            return element.with_value(value.substitute({name: values[name] for name in value.names if name in values}))
        if isinstance(value, Free) and value.name is not None and value.name in values:
            label = element.label
            fixed = element.with_value(values[value.name])
            return fixed if fixed.label == label else _with_name(fixed, label)
        return element

    return map_elements(network, fix)


def name_free_values(networks: Mapping[str, Network]) -> dict[str, Network]:
    """The networks with every free value named: by its own name, that of its element, or its symbol and a number.

    `networks` maps mount names to networks. Two free values of the same name are one and must have the same bounds and
    unit; unnamed ones are all different.

    Raises `DesignError` where one name has two different ranges, or a value is tied to an unknown one.
    """
    found = [element for network in networks.values() for element in network.elements()]
    if not any(isinstance(element.value, Free | Tied) for element in found):
        return dict(networks)
    taken = {e.value.name or e.name for e in found if isinstance(e.value, Free)} - {None}
    known: dict[str, tuple[str, float, float]] = {}

    def name(element: Element) -> Network:
        value = element.value
        if not isinstance(value, Free):
            return element
        label = value.name or element.name
        if label is None:
            label, count = element.symbol, 1
            while label in taken:
                count += 1
                label = f"{element.symbol}{count}"
            taken.add(label)
        here = (element.unit, value.lower, value.upper)
        if known.setdefault(label, here) != here:
            one, other = (format_range(low, high, unit, 6) for unit, low, high in (known[label], here))
            raise DesignError(
                f"The free value {label!r} has two ranges: {one} and {other}. Give them different names, or one range."
            )
        return element if value.name == label else element.with_value(Free(value.lower, value.upper, label))

    named = {mount: map_elements(network, name) for mount, network in networks.items()}
    if any(isinstance(element.value, Tied) for element in found):
        _check_ties(found, known)
    return named


def check_named_apart(names: Set[str], networks: Iterable[Network], what: str) -> None:
    """Raises `DesignError` if a free element of the networks is named after itself, and has one of these names.

    `names` are of other free values that nobody named: both would be one value. Who wants that gives both a name.
    """
    for element in (element for network in networks for element in network.elements()):
        if isinstance(element.value, Free) and element.value.name == element.name and element.name in names:
            raise DesignError(
                f"{element.name!r} is free twice, as {what} and as an element: they would be one value. Give the "
                "element another name."
            )


def _check_ties(elements: Sequence[Element], free: Mapping[str, object]) -> None:
    for element in elements:
        for name in element.value.names if isinstance(element.value, Tied) else ():
            if name not in free:
                raise DesignError(
                    f"{element.label!r} is tied to {name!r}, which is not a free value; free values: "
                    f"{', '.join(free) or 'none'}. If {name!r} is a number, give this value as a number too; if it is "
                    "free elsewhere only, put its element into this strut as well."
                )


_LEFT_OUT = (LinearRole.OPEN, LinearRole.CLOSED)


@dataclass(frozen=True)
class LinearisedNetwork:
    """The linearised network, and the neglected, closed and idle elements.

    `network` is None if no force can be transmitted (`rigid` False) or if the ends are rigidly connected (`rigid`
    True).
    """

    network: Network | None
    rigid: bool
    left_out: tuple[Element, ...]
    closed: tuple[Element, ...]
    idle: tuple[str, ...]

    @property
    def frictions(self) -> tuple[str, ...]:
        """Labels of the neglected elements."""
        return tuple(element.label for element in self.left_out)

    @property
    def gaps(self) -> tuple[str, ...]:
        """Labels of the closed gaps."""
        return tuple(element.label for element in self.closed)


def notes_of(networks: Mapping[str, LinearisedNetwork]) -> list[str]:
    """Notes on what linearised networks neglect, by the names of their mounts: one for elements of one kind."""
    labels: dict[tuple[str, str], dict[str, list[str]]] = {}
    for mount, made in networks.items():
        neglected = [
            *((f"{element.key} ", element.label, "left out") for element in made.left_out),
            *((f"{element.key} ", element.label, "taken as closed") for element in made.closed),
            *(("", label, "without force then") for label in made.idle),
        ]
        for kind, label, what in neglected:
            labels.setdefault((kind, what), {}).setdefault(mount, []).append(repr(label))
    places = {
        of: [f"{format_list(some)} in {mount!r}" for mount, some in there.items()] for of, there in labels.items()
    }
    return [f"{kind}{format_list(where)} {what}" for (kind, what), where in places.items()]


def linearise(network: Network) -> LinearisedNetwork:
    """Linearise a network: neglect friction (no force) and close every gap (rigid contact).

    Elements without force, in series with a friction, or without motion, in parallel with a closed gap, are listed in
    `idle`.
    """
    network = expand_elements(network, to_analysis)
    before = list(network.elements())
    kept, rigid = _linear(network)
    after = Counter(id(element) for element in kept.elements()) if kept is not None else Counter()
    dropped = Counter(id(element) for element in before) - after
    left_out, closed = (tuple(e for e in before if e.linear is role) for role in (LinearRole.OPEN, LinearRole.CLOSED))
    others = {id(e): e for e in before if e.linear not in _LEFT_OUT}
    idle = tuple(element.label for key, element in others.items() if dropped[key])
    return LinearisedNetwork(kept, rigid, left_out, closed, idle)


@dataclass(frozen=True)
class UpsideDown(Network):
    """A linear network with its ends exchanged: arm e of a bridge where it is passed from the right to the left."""

    network: Network

    def elements(self) -> Iterator[Element]:
        return self.network.elements()

    def fraction(self, s: Complex) -> Fraction:
        return self.network.fraction(s)


_Reduced = tuple[Network | None, bool]  # what is left of a network; if nothing is, whether it is rigid


def parts_between(
    network: Network, upper: End, lower: End, node: Callable[[int], End]
) -> list[tuple[Network, End, End]]:
    """Parts of a network between two ends, each with its own upper and lower end; none of an element.

    `node` gives the inner node of each number, counted from 1.

    >>> import inerter as it
    >>> strut = it.Spring(120e3) - it.Damper(4000.0)
    >>> [(part.label, *ends) for part, *ends in parts_between(strut, "body", "wheel", lambda number: f"node {number}")]
    [('k', 'body', 'node 1'), ('c', 'node 1', 'wheel')]
    """
    match network:
        case Parallel(parts):
            return [(part, upper, lower) for part in parts]
        case Series(parts):
            nodes = [upper, *(node(number) for number in range(1, len(parts))), lower]
            return list(zip(parts, nodes, nodes[1:], strict=False))
        case Bridge(a, b, c, d, e):
            left, right = node(1), node(2)
            return [(a, upper, left), (b, left, lower), (c, upper, right), (d, right, lower), (e, left, right)]
        case UpsideDown(turned):
            return [(turned, lower, upper)]
    return []


def _linear(network: Network) -> _Reduced:
    if isinstance(network, Element):
        left_out = network.linear in _LEFT_OUT
        return None if left_out else network, network.linear is LinearRole.CLOSED
    assert isinstance(network, CombinedNetwork)
    parts = [_linear(part) for part in network.parts]
    return _bridge(network, parts) if isinstance(network, Bridge) else _join(type(network), parts, network.name)


def _join(kind: type[CombinedNetwork], parts: Sequence[_Reduced], name: str | None = None) -> _Reduced:
    rigid = [r for kept, r in parts if kept is None]
    kept_parts = tuple(kept for kept, _ in parts if kept is not None)
    in_parallel = kind is Parallel
    if in_parallel in rigid:  # a rigid branch in parallel, or an open link in series, determines the whole
        return None, in_parallel
    if not kept_parts:
        return None, not in_parallel
    alone = len(kept_parts) == 1 and name is None
    return (kept_parts[0] if alone else kind(kept_parts, name=name)), False  # type: ignore[call-arg]


def _bridge(bridge: Bridge, arms: Sequence[_Reduced]) -> _Reduced:
    """The bridge of what is left of its arms; a series-parallel network if one of them is open or rigid."""
    lost = next((i for i, (kept, _) in enumerate(arms) if kept is None), None)
    if lost is None:
        return bridge.with_parts([kept for kept, _ in arms if kept is not None]), False
    kept, rigid = reduce_bridge(
        arms,
        lost,
        arms[lost][1],
        lambda *two: _join(Parallel, two),
        lambda *two: _join(Series, two),
        lambda arm: (None if arm[0] is None else UpsideDown(arm[0]), arm[1]),
    )
    if kept is not None and bridge.name is not None:
        return Parallel((kept,), name=bridge.name), False
    return kept, rigid
