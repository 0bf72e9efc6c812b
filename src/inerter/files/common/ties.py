"""Values that follow from those of other elements, as files say them: `{ tied = "0.8 * c_front" }`."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Any, NamedTuple

from inerter.files.common.problem import invalid_entry
from inerter.files.common.suggest import nearest, some
from inerter.networks.elements import Element, Tied, tied
from inerter.networks.elements.registry import kinds_by_unit
from inerter.units import PURE, are_compatible, combine_units, quote_value

TIED = "tied"
_LONGEST = 200
_SIGNS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
_EXAMPLE = 'sums, differences, products and quotients of elements and numbers, such as "0.8 * c_front"'


class TieEntry(NamedTuple):
    """Expression of a tied value, as the file has it."""

    expression: str


class _Part(NamedTuple):
    """A part of an expression: its value, and its unit as a product."""

    value: Tied | float
    unit: str


def is_tie(entry: Any) -> bool:
    """Whether an entry is one of a value that follows from others."""
    return isinstance(entry, dict) and TIED in entry


def tie_entry(entry: dict[str, Any]) -> TieEntry:
    """Expression of a tied entry; raises `EntryError` for what is wrong with it."""
    others = [key for key in entry if key != TIED]
    if others:
        raise invalid_entry(others[0], fault="not a key of a tied value", expected='tied = "..." alone')
    text = entry[TIED]
    if not isinstance(text, str) or not text.strip() or len(text) > _LONGEST:
        raise invalid_entry(text, expected=_EXAMPLE)
    _tree(text)
    return TieEntry(text)


def tie_schema() -> dict[str, Any]:
    """JSON Schema of a tied entry."""
    about = f"Expression for the value: {_EXAMPLE}."
    text = {"type": "string", "minLength": 1, "maxLength": _LONGEST, "description": about}
    text |= {"examples": ["0.8 * c_front"]}
    return {"type": "object", "properties": {TIED: text}, "required": [TIED], "additionalProperties": False}


def tied_element(name: str, entry: TieEntry, elements: Mapping[str, Element]) -> Element:
    """Element of that name, tied to `elements`. Raises `EntryError` if there is none such."""
    found = _part(_tree(entry.expression), entry.expression, elements)
    if not isinstance(found.value, Tied):
        raise invalid_entry(entry.expression, fault="it names no element", expected=_EXAMPLE)
    for unit, kind in kinds_by_unit().items():
        if are_compatible(unit, found.unit):
            return kind.of(found.value, name)
    known = ", ".join(kinds_by_unit())
    raise invalid_entry(entry.expression, fault=f"it is in {found.unit}", expected=f"a value in one of {known}")


def with_known_values(elements: Mapping[str, Element]) -> dict[str, Element]:
    """The elements, with the numbers of those that are fixed in what is tied to them."""
    known = {name: element.value for name, element in elements.items() if isinstance(element.value, float)}
    return {name: _substitute_ties(element, known) for name, element in elements.items()}


def tie_text(value: Tied) -> str:
    """The expression of a tied value, with all digits of its numbers."""
    stack: list[str] = []
    for part in value.program:
        if isinstance(part, str) and part in _SIGNS.values():
            second, first = stack.pop(), stack.pop()
            stack.append(f"({first} {part} {second})")
        else:
            stack.append(part if isinstance(part, str) else repr(part))
    (text,) = stack
    return text.removeprefix("(").removesuffix(")") if text.startswith("(") else text


def _substitute_ties(element: Element, known: Mapping[str, float]) -> Element:
    value = element.value
    if not isinstance(value, Tied):
        return element
    return element.with_value(value.substitute({name: known[name] for name in value.names if name in known}))


def _tree(text: str) -> ast.expr:
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise invalid_entry(text, fault="it cannot be read", expected=_EXAMPLE) from None


def _part(node: ast.expr, text: str, elements: Mapping[str, Element]) -> _Part:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        return _Part(float(node.value), PURE)
    if isinstance(node, ast.Name):
        if node.id not in elements:
            missing = f"unknown element {quote_value(node.id)}; elements with a value: {some(elements)}"
            raise invalid_entry(text, fault=missing, hint=nearest(node.id, elements))
        return _Part(tied(node.id), elements[node.id].unit)
    if not isinstance(node, ast.BinOp) or type(node.op) not in _SIGNS:
        raise invalid_entry(text, fault="it cannot be read", expected=_EXAMPLE)
    sign = _SIGNS[type(node.op)]
    first, second = (_part(side, text, elements) for side in (node.left, node.right))
    if sign in "+-":
        if not are_compatible(first.unit, second.unit):
            fault = f"{first.unit} and {second.unit} cannot be added or subtracted"
            raise invalid_entry(text, fault=fault, expected="values of one unit")
        return _Part(_apply_operator(sign, first.value, second.value), first.unit)
    return _Part(_apply_operator(sign, first.value, second.value), combine_units(first.unit, sign, second.unit))


def _apply_operator(sign: str, first: Tied | float, second: Tied | float) -> Tied | float:
    match sign:
        case "+":
            return first + second
        case "-":
            return first - second
        case "*":
            return first * second
        case _:
            return first / second
