"""Parts of a study one by one: networks as trees with places, quantities read and written."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Any

from inerter.errors import InerterError, UnitError
from inerter.files.common.entries import expression
from inerter.files.common.problem import EntryError
from inerter.formatting import format_quantity
from inerter.networks.elements.registry import kinds_by_unit, parse_element
from inerter.networks.parser import BRIDGE, ExpressionError, ExpressionPart, parse_expression
from inerter.units import is_unit, parse_quantity, quote_value

_JOINED = {"|": "parallel", "-": "series", BRIDGE: "bridge"}


def parse_network(text: str, elements: Container[str] | None) -> dict[str, Any]:
    """Tree of a network with the place of each part, or the place and sentence of its error."""
    try:
        tree = parse_expression(expression(text), elements)
    except ExpressionError as error:
        end = next((i for i in range(error.at, len(text)) if not (text[i].isalnum() or text[i] == "_")), len(text))
        return {"at": [error.at, max(end, error.at + 1)], "sentence": str(error)}
    except (InerterError, EntryError) as error:
        return {"at": [0, len(text)], "sentence": str(error)}
    return {"tree": _tree(tree), "names": list(dict.fromkeys(_names(tree)))}


def _tree(part: ExpressionPart) -> dict[str, Any]:
    place = {"from": part.begin, "to": part.end}
    if part.name:
        return {"kind": "element", "name": part.name, **place}
    return {"kind": _JOINED[part.sign], "parts": [_tree(each) for each in part.parts], **place}


def _names(part: ExpressionPart) -> list[str]:
    return [part.name] if part.name else [name for each in part.parts for name in _names(each)]


def quantity(asked: Mapping[str, Any]) -> dict[str, Any]:
    """A quantity read from text, or written as text; a sentence where that cannot be."""
    text, value, unit, digits = (asked.get(key) for key in ("text", "value", "unit", "digits"))
    if (text is None) == (value is None) or (text is None and unit is None):
        return {"sentence": "Give a text to read, or a value and its unit to write."}
    try:
        if text is None:
            return {"value": value, "unit": unit, "text": format_quantity(float(str(value)), str(unit), digits or 4)}
        if unit is not None:
            if not is_unit(unit):
                return {"sentence": f"{quote_value(unit)} is not known as a unit."}
            found, more = parse_quantity(text, unit), {}
        else:
            unit, found = parse_element(text)
            more = {"key": kinds_by_unit()[unit].key}
    except UnitError as error:
        return {"sentence": str(error)}
    return {"value": found, "unit": unit, "text": format_quantity(found, unit, digits or 4), **more}
