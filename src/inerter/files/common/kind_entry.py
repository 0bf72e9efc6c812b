"""An element whose entry names its kind: where two kinds share a unit, or one is made of more than a value."""

from __future__ import annotations

from typing import Any, NamedTuple

from inerter.errors import UnitError
from inerter.fields import Field
from inerter.files.common.problem import EntryError
from inerter.files.common.schema import or_range_schema, quantity_schema
from inerter.files.common.sizes import check_size
from inerter.files.common.suggest import nearest
from inerter.files.common.ties import TIED, tie_text
from inerter.networks.elements import Element, Free, Tied
from inerter.networks.elements.registry import ELEMENTS, kinds_by_unit
from inerter.units import parse_quantity, shown

KIND = "kind"


class KindEntry(NamedTuple):
    """A kind of element by its key, its value or the two bounds of it, and its other numbers, all in SI units."""

    kind: str
    value: float | tuple[float, float]
    more: dict[str, float]

    def element(self, name: str) -> Element:
        """The element; a free value has its name."""
        value = Free(*self.value, name) if isinstance(self.value, tuple) else self.value
        return ELEMENTS[self.kind].of(value, name, **self.more)


def names_kind(entry: Any) -> bool:
    """Whether an entry is one that names its kind."""
    return isinstance(entry, dict) and KIND in entry


def kind_entry(entry: dict[str, Any], *, free: bool = True) -> KindEntry:
    """What such an entry says, whose value may be a range if it may be `free`.

    Raises ValueError for what is wrong with it.
    """
    named = entry[KIND]
    if not isinstance(named, str) or named not in ELEMENTS:
        listed = ", ".join(map(shown, ELEMENTS))
        raise EntryError(got=f"kind = {shown(named)}", fault="not a kind of element", expected=f"one of {listed}")
    kind = ELEMENTS[named]
    fields = {field.name: field for field in kind.fields()}
    for key in entry:
        if key not in (KIND, *fields):
            hint = nearest(key, fields)
            raise EntryError(got=shown(key), fault=f"not a key of a {named}", expected=", ".join(fields), hint=hint)
    for name, field in fields.items():
        if name not in entry:
            example = f'{name} = "1 {field.unit}"'
            raise EntryError(got=f"no {name} of the {named}", expected=example, hint=field.sentence)
    value, *more = fields.values()
    amounts = {field.name: _amount(field, entry[field.name], False) for field in more}
    given = entry[value.name]
    if not isinstance(given, dict):
        return KindEntry(named, _amount(value, given, kind.may_vanish), amounts)
    if not free or set(given) != {"from", "to"}:
        expected = f'a range {{ from = "1 {value.unit}", to = "2 {value.unit}" }}' if free else "one value"
        raise EntryError(got=f"a table for {value.name}", expected=expected)
    lower, upper = (_amount(value, given[end], kind.may_vanish) for end in ("from", "to"))
    if not lower < upper:
        ends = f"equal or reversed ends of {value.name}"
        raise EntryError(got=ends, expected="from less than to", hint="Swap them.")
    return KindEntry(named, (lower, upper), amounts)


def kind_schema() -> dict[str, Any]:
    """What a JSON Schema says of an entry that names its kind."""
    return {"anyOf": [_schema_of(name, kind) for name, kind in ELEMENTS.items()]}


def _schema_of(name: str, kind: type[Element]) -> dict[str, Any]:
    least = "not negative" if kind.may_vanish else "positive"
    value, *more = kind.fields()
    one = quantity_schema(value.unit, least=least)
    texts = {
        field.name: {**quantity_schema(field.unit, least="positive"), "description": field.sentence} for field in more
    }
    keys = {
        KIND: {"const": name, "description": "What it is, where its unit does not tell."},
        value.name: {**or_range_schema(one), "description": value.sentence},
        **texts,
    }
    return {"type": "object", "properties": keys, "required": list(keys), "additionalProperties": False}


def _amount(field: Field, text: Any, may_vanish: bool) -> float:
    try:
        amount = parse_quantity(text, field.unit)
    except UnitError as error:
        raise ValueError(f"{field.name}: {error}") from None
    check_size(amount, text, field.unit)
    if amount < 0.0 or (amount == 0.0 and not may_vanish):
        given = f"{field.name} = {shown(text)}"
        raise EntryError(got=given, fault="not positive", expected=f"more than 0 {field.unit}")
    return amount


def entry_of(element: Element) -> str | dict[str, Any]:
    """How a file says an element: by its value or range alone where its unit tells its kind."""

    def said(value: float, unit: str) -> str:
        return f"{value!r} {unit}"

    value, unit = element.value, element.unit
    alone: str | dict[str, str]
    if isinstance(value, Free):
        alone = {"from": said(value.lower, unit), "to": said(value.upper, unit)}
    elif isinstance(value, Tied):
        return {TIED: tie_text(value)}
    else:
        alone = said(value, unit)
    if kinds_by_unit().get(unit) is type(element):
        return alone
    more = {field.name: said(getattr(element, field.name), field.unit) for field in element.more}
    return {KIND: element.key, element.quantity: alone, **more}
