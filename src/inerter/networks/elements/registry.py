"""The kinds of element that there are, in one place, and how files and messages find the one that is meant."""

from __future__ import annotations

from inerter.errors import NetworkError
from inerter.networks.elements.damper import Damper
from inerter.networks.elements.element import Element
from inerter.networks.elements.friction import Friction
from inerter.networks.elements.gap import Gap
from inerter.networks.elements.inerter import Inerter
from inerter.networks.elements.spring import Spring
from inerter.units import parse_one_of

ELEMENT_TYPES: tuple[type[Element], ...] = (Spring, Damper, Inerter, Friction, Gap)
_KINDS: dict[str, type[Element]] = {}


def register(kind: type[Element]) -> type[Element]:
    """Let files know a kind of element, by its key; by the unit of its value too, if no kind before it has that unit.

    Serves as a decorator. Raises `NetworkError` if another kind has the key.
    """
    if _KINDS.setdefault(kind.key, kind) is not kind:
        raise NetworkError(f"There is another kind of element with the key {kind.key!r}. Choose another key.")
    return kind


def unregister(kind: type[Element]) -> None:
    """Forget a kind of element."""
    _KINDS.pop(kind.key, None)


def kinds() -> dict[str, type[Element]]:
    """All kinds by their keys, in the order in which they were registered."""
    return dict(_KINDS)


def kinds_by_unit() -> dict[str, type[Element]]:
    """The kinds that the unit of a value tells: of those that share one, the first that needs no other number."""
    told: dict[str, type[Element]] = {}
    for kind in _KINDS.values():
        if not kind.more:
            told.setdefault(kind.unit, kind)
    return told


def parse_element(text: str) -> tuple[str, float]:
    """The SI unit that tells the kind of element (a key of `kinds_by_unit`), and the value in that unit.

    Raises `UnitError` unless `text` is a finite number followed by a unit of one of the kinds.

    >>> parse_element("3.2 kN s/m")
    ('N s/m', 3200.0)
    """
    told = kinds_by_unit()
    return parse_one_of(text, {unit: f"{kind.key}, such as {kind.example}" for unit, kind in told.items()}, Damper.unit)


for _kind in ELEMENT_TYPES:
    register(_kind)
