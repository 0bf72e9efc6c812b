"""The kinds of element that there are, in one place, and how files and messages find the one that is meant."""

from __future__ import annotations

from collections.abc import Mapping

from inerter.networks.elements.damper import Damper
from inerter.networks.elements.element import Element
from inerter.networks.elements.friction import Friction
from inerter.networks.elements.gap import Gap
from inerter.networks.elements.inerter import Inerter
from inerter.networks.elements.spring import Spring
from inerter.rows import Rows
from inerter.units import parse_one_of

ELEMENT_TYPES: tuple[type[Element], ...] = (Spring, Damper, Inerter, Friction, Gap)
ELEMENTS: Rows[type[Element]] = Rows(
    "kind of element", "key", ("symbol", "quantity", "unit", "sentence", "example", "linear", "drawing"), ELEMENT_TYPES
)


def kinds_by_unit() -> dict[str, type[Element]]:
    """The kinds that the unit of a value tells: of those that share one, the first that needs no other number."""
    told: dict[str, type[Element]] = {}
    for kind in ELEMENTS.values():
        if not kind.more:
            told.setdefault(kind.unit, kind)
    return told


def units_told() -> str:
    """What the unit of a value tells, for a reader, such as "N/m spring"."""
    return ", ".join(f"{unit} {kind.key}" for unit, kind in kinds_by_unit().items())


def kinds_in_unit() -> dict[str, type[Element]]:
    """The first kind with a value in each unit."""
    return {**{kind.unit: kind for kind in reversed(list(ELEMENTS.values()))}, **kinds_by_unit()}


def parse_element(text: str, known: Mapping[str, type[Element]] | None = None) -> tuple[str, float]:
    """The SI unit that tells the kind of element (a key of `known`, by default of `kinds_by_unit`), and the value in
    that unit.

    Raises `UnitError` unless `text` is a finite number followed by a unit of one of the kinds.

    >>> parse_element("3.2 kN s/m")
    ('N s/m', 3200.0)
    """
    told = kinds_by_unit() if known is None else known
    return parse_one_of(text, {unit: f"{kind.key}, such as {kind.example}" for unit, kind in told.items()}, Damper.unit)
