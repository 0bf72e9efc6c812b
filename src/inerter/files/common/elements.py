"""Elements in files: a value whose unit tells the kind, a range, a table that names the kind, or one tied to others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, ClassVar

from inerter.files.common.codec import INVALID, Codec, KeyPath, LoadContext, RawEntry, TableCodec, section
from inerter.files.common.codecs import NamesCodec, TaggedCodec, any_of
from inerter.files.common.entries import (
    AMOUNT,
    LOWER,
    UPPER,
    QuantityCodec,
    amount,
    element_name,
    one_of,
    other_bound,
    range_codec,
    text_of,
    with_bounds,
)
from inerter.files.common.free_networks import FREE_NETWORK, is_free_network
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, Problem, collect_problem
from inerter.files.common.ties import TIED, TieEntry, is_tie, tie_entry, tie_schema, tie_text, tied_element
from inerter.formatting import format_quantity
from inerter.networks.elements import NAME, Element, Free, Tied
from inerter.networks.elements.registry import ELEMENTS, kinds_by_unit
from inerter.networks.free_network import FreeNetwork
from inerter.networks.parser import rename_in_expression

KIND = "kind"
_WHY = "Kind of element, where the unit alone does not determine it."


RANGE = range_codec(
    AMOUNT, "100 N s/m", "100 kN s/m", about="A free value: an optimiser chooses it between two bounds."
)


def _range_codec_for(raw: Mapping[str, Any]) -> TableCodec:
    """The same, whose example of a missing end has the unit of the other one."""
    try:
        known = amount(raw.get(LOWER, raw.get(UPPER)))
    except ValueError:
        return RANGE
    lower, upper = (format_quantity(factor * known.value, known.unit) for factor in (1e-3, 1e3))
    return range_codec(AMOUNT, lower, upper)


@dataclass(frozen=True)
class ElementCodec(Codec):
    """An element, which has the name of its key; its value may be a range if `free`, and `tied` to others.

    One that is tied is read as its expression, since the others may come later. With `networks`, an entry may be a free
    network.
    """

    is_number: ClassVar[bool] = True

    free: bool = True
    tied: bool = False
    networks: bool = False

    def load(self, raw: Any, context: LoadContext) -> Element | TieEntry | FreeNetwork:
        """Element of the entry, the expression of a tied element, or a free network."""
        name = context.place[-1] if NAME.fullmatch(context.place[-1]) else "unnamed"  # which is refused with the key
        if self.tied and is_tie(raw):
            return tie_entry(raw)
        if self.networks and is_free_network(raw):
            found = FREE_NETWORK.load(raw, context)
            return found if found is INVALID else replace(found, name=name)  # type: ignore[no-any-return]
        if _names_kind(raw):
            made = _kinds_codec(self.free).load(raw, context)
            return made if made is INVALID else _with_name(made, name)
        if not isinstance(raw, dict):
            value = amount(raw)
            return kinds_by_unit()[value.unit].of(value.value, name)
        if not self.free:
            hint = "Write one, or take the file of a best design: inerter export STUDY.toml --to simulation"
            raise EntryError(got="a range", fault="a simulation needs one value", hint=hint)
        found = _range_codec_for(raw).load(raw, context)
        if found is INVALID:
            return INVALID  # type: ignore[no-any-return]
        return kinds_by_unit()[found.lower.unit].of(found.free(name), name)

    def dump(self, value: Element | FreeNetwork) -> str | dict[str, Any]:
        """Value or range alone where the unit determines the kind of element; else a table."""
        if isinstance(value, FreeNetwork):
            return FREE_NETWORK.dump(value)
        if isinstance(value.value, Tied):
            return {TIED: tie_text(value.value)}
        if kinds_by_unit().get(value.unit) is type(value):
            return text_of(value.value, value.unit)
        return _kinds_codec(self.free).dump(value)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of all forms."""
        ties = [tie_schema()] if self.tied else []
        ranges = [RANGE.schema()] if self.free else []
        networks = [FREE_NETWORK.schema()] if self.networks else []
        return any_of([*ranges, AMOUNT.schema(), _kinds_codec(self.free).schema(), *ties, *networks])

    def numbers(self, value: Element | TieEntry | FreeNetwork, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """Value of the element with its bounds, and its further numbers, by their keys; none of a free network."""
        if isinstance(value, FreeNetwork):
            return
        if isinstance(value, TieEntry):
            yield (), Number("", words, None)
            return
        yield from with_bounds(Number(value.unit, words, value.value, value.may_vanish, self.free))
        for field in value.more:
            yield (field.name,), Number(field.unit, field.in_words, getattr(value, field.name))

    def put(self, value: Element, keys: Sequence[str], number: float) -> Element:
        """The element with another value, bound or further number."""
        if not keys:
            return value.with_value(number)
        old, (part,) = value.value, keys
        if isinstance(old, Free) and part in (LOWER, UPPER):
            return value.with_value(other_bound(old, part, number))
        more = {field.name: getattr(value, field.name) for field in value.more}
        return type(value).of(old, value.name, **{**more, part: number})

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The element, with the sentence on its kind."""
        kind = self.kind_of(raw)
        yield RawEntry(self, raw, sentence="" if kind is None else f"{kind.key}: {kind.sentence}")

    def kind_of(self, raw: Any) -> type[Element] | None:
        """Kind of the element that an entry states; None where it states none, or is tied."""
        value = RawEntry(self, raw, ("unnamed",)).value()
        return type(value) if isinstance(value, Element) else None

    def keys_in_file(self, raw: Any, keys: KeyPath) -> KeyPath:
        """The keys in a table that names the kind, or an expression."""
        if self.tied and is_tie(raw):
            return (TIED,)
        if keys or not _names_kind(raw):
            return keys
        kind = ELEMENTS.get(raw[KIND]) if isinstance(raw[KIND], str) else None
        quantity = "" if kind is None else kind.fields()[0].name
        return (quantity,) if quantity in raw else keys

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The element with other names in its expression, if it is tied."""
        tied = self.tied and is_tie(raw) and isinstance(raw[TIED], str)
        return {**raw, TIED: rename_in_expression(raw[TIED], names)} if tied else raw

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """The table of a range."""
        if self.free:
            yield place, RANGE
        if self.networks:
            yield from FREE_NETWORK.table_codecs(place)


class ElementsCodec(NamesCodec):
    """Elements by their names."""

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The elements by other names, in their order."""
        raw = super().rename(raw, names)
        return {names.get(name, name): entry for name, entry in raw.items()} if isinstance(raw, Mapping) else raw


def elements_codec(*, free: bool, tied: bool = False, networks: bool = False, least: int = 1) -> ElementsCodec:
    """The section [elements], with at least as many of them."""
    return ElementsCodec(ElementCodec(free, tied, networks), element_name, least)


def free_networks_in(entries: Mapping[str, Any]) -> dict[str, FreeNetwork]:
    """The free networks among the entries of the section [elements]."""
    return {name: entry for name, entry in entries.items() if isinstance(entry, FreeNetwork)}


def with_tied_values(
    entries: Mapping[str, Element | TieEntry | FreeNetwork],
) -> tuple[dict[str, Element], list[Problem]]:
    """Elements in their order, and the problems of tied elements; without free networks."""
    every = {name: entry for name, entry in entries.items() if not isinstance(entry, FreeNetwork)}
    own = {name: entry for name, entry in every.items() if not isinstance(entry, TieEntry)}
    found: dict[str, Element] = {}
    problems: list[Problem] = []
    for name, entry in every.items():
        with collect_problem(problems, ("elements", name)):
            found[name] = tied_element(name, entry, own) if isinstance(entry, TieEntry) else entry
    return found, problems


def _names_kind(entry: Any) -> bool:
    """Whether an entry is one that names its kind."""
    return isinstance(entry, dict) and KIND in entry


def _with_name(element: Element, name: str) -> Element:
    """The element by that name, which its free value has too."""
    value = replace(element.value, name=name) if isinstance(element.value, Free) else element.value
    return replace(element, name=name, **{element.quantity: value})  # type: ignore[type-var]


def _kinds_codec(free: bool) -> TaggedCodec:
    """The tables of elements that name their kind; the value may be `free`."""
    return TaggedCodec(
        KIND,
        lambda: {kind: _kind_table(element, free) for kind, element in ELEMENTS.items()},
        one_of("a kind of element", ELEMENTS),
        attrgetter("key"),
        "spring",
    )


def _kind_table(kind: type[Element], free: bool) -> TableCodec:
    """The numbers of an element, each by its name."""
    value, *more = kind.fields()
    codecs = [QuantityCodec(value.unit, "not negative" if kind.may_vanish else "positive", free)]
    codecs += [QuantityCodec(field.unit) for field in more]
    keys = (
        section(field.name, codec, field.sentence, f'{field.name} = "1 {field.unit}"')
        for field, codec in zip((value, *more), codecs, strict=True)
    )
    return TableCodec(tuple(keys), kind, tag=(KIND, kind.key, _WHY))
