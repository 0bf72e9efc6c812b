"""Registry of the kinds of elements, and their lookup by unit."""

from __future__ import annotations

from collections.abc import Mapping

from inerter.networks.elements.damper import Damper
from inerter.networks.elements.element import Element
from inerter.networks.elements.friction import Friction
from inerter.networks.elements.gap import Gap
from inerter.networks.elements.inerter import Inerter
from inerter.networks.elements.spring import Spring
from inerter.registry import Registry
from inerter.units import parse_one_of

ELEMENT_TYPES: tuple[type[Element], ...] = (Spring, Damper, Inerter, Friction, Gap)
ELEMENTS: Registry[type[Element]] = Registry(
    "kind of element", "key", ("symbol", "quantity", "unit", "sentence", "example", "linear", "drawing"), ELEMENT_TYPES
)


def kinds_by_unit() -> dict[str, type[Element]]:
    """Kind of element by the unit of its value: the first without further numbers."""
    told: dict[str, type[Element]] = {}
    for kind in ELEMENTS.values():
        if not kind.more:
            told.setdefault(kind.unit, kind)
    return told


def middle_phrases() -> dict[str, str]:
    """Verb phrases of the middle states of switching elements, by the names of these states.

    >>> middle_phrases()
    {'stick': 'sticks', 'open': 'is open'}
    """
    return {kind.switch.middle: kind.switch.middle_phrase for kind in ELEMENTS.values() if kind.switch}


def format_unit_kinds() -> str:
    """Kinds of elements by unit, in words, such as "N/m spring"."""
    notes = {kind: f" ({kind.unit_note})" if kind.unit_note else "" for kind in kinds_by_unit().values()}
    return ", ".join(f"{unit} {kind.key}{notes[kind]}" for unit, kind in kinds_by_unit().items())


def parse_element(text: str, known: Mapping[str, type[Element]] | None = None) -> tuple[str, float]:
    """SI unit of an element value (a key of `known`, by default of `kinds_by_unit`), and the value in that unit.

    Raises `UnitError` unless `text` is a finite number followed by a unit of one of the kinds.

    >>> parse_element("3.2 kN s/m")
    ('N s/m', 3200.0)
    """
    told = kinds_by_unit() if known is None else known
    return parse_one_of(text, {unit: f"{kind.key}, such as {kind.example}" for unit, kind in told.items()}, Damper.unit)
