"""The structure of a mechanism: all of it but the values of elements and inertias, as a key of caches.

Designs that differ in values alone have equal structures: the same elements in the same places, with the same names and
lever arms, and the same ones free. What follows from the structure is found once and takes the values later (see
`systems.descriptor`).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache, wraps
from typing import TypeVar

from inerter.networks.elements import CombinedNetwork, Element, Free, Network, Tied
from inerter.networks.transform import map_elements
from inerter.systems.graph import Graph, linear_graph
from inerter.vehicle.mechanism import Mechanism, Port
from inerter.vehicle.vehicle import remember_last

Values = list[float | Free]
_Answer = TypeVar("_Answer")


@dataclass(frozen=True, eq=False)
class Structure:
    """The structure of a mechanism, equal for all values, and those of this one: of elements, then of coordinates."""

    key: Hashable
    values: Values
    mechanism: Mechanism

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Structure) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    @property
    def parameters(self) -> dict[str, float | Free]:
        """The values by name: by their number, or by the name of a free value."""
        found = {_parameter_name(number, value): value for number, value in enumerate(self.values)}
        if self.mechanism.ground_moves:  # whose masses are part of the structure, free ones too
            found |= {str(c.inertia.name): c.inertia for c in self.mechanism.coordinates if isinstance(c.inertia, Free)}
        return found

    def parametrise(self) -> tuple[Mechanism, Graph]:
        """The mechanism whose inertias are free, by the names of `parameters`, and its linear graph with all values so.

        Labels are those of the mechanism itself.
        """
        numbers = iter(range(len(self.values)))
        mechanism = self.mechanism.with_networks(
            lambda mount: map_elements(mount.network, lambda element: _with_number(element, next(numbers)))
        )
        if not mechanism.ground_moves:
            masses = {
                number: replace(c, inertia=_parameter(_parameter_name(next(numbers), c.inertia)))
                for number, c in mechanism.masses.items()
            }
            coordinates = dict(enumerate(mechanism.coordinates)) | masses
            mechanism = replace(mechanism, coordinates=tuple(coordinates.values()))
        graph = linear_graph(mechanism)
        branches = tuple(replace(b, element=_with_parameter(b.element)) for b in graph.branches)
        return mechanism, replace(graph, branches=branches)


@remember_last
def structure_of(mechanism: Mechanism) -> Structure | None:
    """The structure of a mechanism; None where it depends on values, as for elements of other laws or tied values."""
    values: Values = []
    try:
        struts = tuple([(s.name, _port(s.upper), _port(s.lower), _key(s.network, values)) for s in mechanism.struts])
        tyres = tuple([(_key(t.network, values), t.name, _port(t.port), t.road) for t in mechanism.tyres])
        still = tuple([(_key(s.network, []), s.name) for s in mechanism.still])
    except _DependsOnValuesError:
        return None
    coordinates = tuple([(c.name, c.angle, c.is_massless, _free_name(c.inertia)) for c in mechanism.coordinates])
    ground = tuple([c.inertia for c in mechanism.coordinates]) if mechanism.ground_moves else None
    if ground is None:  # else masses are lever arms of the force of the ground
        values += [c.inertia for c in mechanism.coordinates if not c.is_massless]
    forces = tuple([(force.name, _port(force.port)) for force in mechanism.forces])
    points = tuple([(point.name, _port(point.port), point.angle) for point in mechanism.points])
    key = (struts, tyres, still, mechanism.twins, coordinates, ground, mechanism.roads, forces, points)
    return Structure(key, values, mechanism)


def once_per_structure(answer: Callable[[Mechanism], _Answer]) -> Callable[[Mechanism], _Answer]:
    """A function of a mechanism that does not depend on values, computed once for each structure."""
    known = lru_cache(maxsize=128)(lambda structure: answer(structure.mechanism))

    @wraps(answer)
    def look_up(mechanism: Mechanism) -> _Answer:
        structure = structure_of(mechanism)
        return answer(mechanism) if structure is None else known(structure)

    return look_up


class _DependsOnValuesError(Exception):
    """An element whose part in linear analysis may depend on its value."""


def _key(network: Network, values: Values) -> Hashable:
    """The structure of a network, whose values are appended to `values`."""
    if isinstance(network, CombinedNetwork):
        return (type(network), network.name, *[_key(part, values) for part in network.parts])
    if not isinstance(network, Element) or not network.plain or isinstance(value := network.value, Tied):
        raise _DependsOnValuesError
    values.append(value)
    more = [getattr(network, field.name) for field in network.more] if network.more else ()
    return (type(network), network.name, _free_name(value), *more)


def _free_name(value: float | Free) -> str | None:
    return value.name if isinstance(value, Free) else None


def _port(port: Port) -> tuple[tuple[str, float], ...]:
    return tuple(port.items())


def _parameter_name(number: int, value: float | Free) -> str:
    return f"free_{value.name}" if isinstance(value, Free) else f"number_{number}"


def _parameter(name: str) -> Free:
    return Free(1.0, 2.0, name)  # the bounds have no meaning


def _with_number(element: Element, number: int) -> Element:
    """The element with its number as its value; a free value remains free, by which it may be labelled."""
    value = element.value
    return element.with_value(_parameter(str(value.name)) if isinstance(value, Free) else 1.0 + number)


def _with_parameter(element: Element) -> Element:
    """The element with the parameter of which it has the number, or the name."""
    value = element.value
    number = 0 if isinstance(value, Free) else int(value) - 1  # type: ignore[arg-type]
    return element.with_value(_parameter(_parameter_name(number, value)))  # type: ignore[arg-type]
