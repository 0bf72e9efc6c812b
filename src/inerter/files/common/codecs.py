"""Codecs that are made of others: one of several tables, tables by names or by places, and lists of tables."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from inerter.files.common.codec import INVALID, Codec, KeyPath, LoadContext, RawEntry, TableCodec
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, invalid_entry
from inerter.systems.outputs import rename_output


@dataclass(frozen=True)
class TaggedCodec(Codec):
    """One of several tables, selected by the word at the key `tag`; `word_of` returns the word of a value."""

    tag: str
    of: Callable[[], Mapping[str, TableCodec]]
    word: Callable[[Any], str]  # checks the word; raises ValueError for an unknown one
    word_of: Callable[[Any], str]
    usual: str  # a word, for examples

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Value of the table that the word at `tag` selects."""
        table, inside = context.as_table(raw), context.at(self.tag)
        if self.tag not in table:
            inside.add(EntryError(fault="missing", expected=f'{self.tag} = "{self.usual}"'))
            return INVALID
        try:
            found = self.of()[self.word(table[self.tag])]
        except ValueError as error:
            inside.add(error)
            return INVALID
        return found.load(table, context)

    def table_of(self, value: Any) -> TableCodec:
        """The table of a value."""
        return self.of()[self.word_of(value)]

    def dump(self, value: Any) -> dict[str, Any]:
        """The table, with its word."""
        return self.table_of(value).dump(value)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of any of the tables."""
        return any_of([table.schema() for table in self.of().values()])

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The numbers of the value's table."""
        yield from self.table_of(value).numbers(value, words)

    def put(self, value: Any, keys: Sequence[str], number: float) -> Any:
        """The value with another number in its table."""
        return self.table_of(value).put(value, keys, number)

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The entries of the table that the word at `tag` selects; empty where it selects none."""
        table = self._table_of(raw)
        yield from () if table is None else table.raw_entries(raw)

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with other names of elements."""
        table = self._table_of(raw)
        return raw if table is None else table.rename(raw, names)

    def _table_of(self, raw: Any) -> TableCodec | None:
        word = raw.get(self.tag) if isinstance(raw, Mapping) else None
        return self.of().get(word) if isinstance(word, str) else None

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """Tables of all words, by their key paths."""
        for table in self.of().values():
            yield from table.table_codecs(place)


@dataclass(frozen=True)
class NamesCodec(Codec):
    """A table of names of the author's own, each with an entry of one kind."""

    item: Codec
    name: Callable[[Any], str] = str  # checks a name; raises ValueError
    least: int = 0
    example: str = ""  # of an entry, for messages; that of the whole table if left out

    def load(self, raw: Any, context: LoadContext) -> Any:
        """The values by their names."""
        table = context.as_table(raw)
        if len(table) < self.least:
            raise EntryError(fault="none given", expected=context.example)
        count, values = len(context.problems), {}
        for name, entry in table.items():
            inside = context.at(name, self.example)
            try:
                self.name(name)
            except ValueError as error:
                inside.add(error)
            values[name] = inside.read(self.item, entry)
        return values if len(context.problems) == count else INVALID

    def dump(self, value: Any) -> dict[str, Any]:
        """The entries by their names."""
        return {name: self.item.dump(part) for name, part in value.items()}

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the table."""
        least = {"minProperties": self.least} if self.least else {}
        return {"type": "object", "additionalProperties": self.item.schema(), **least}

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The numbers of all entries, in words with their names."""
        for name, part in (value or {}).items():
            for keys, number in self.item.numbers(part, ""):
                yield (name, *keys), replace(number, words=with_name(number.words, name))

    def put(self, value: Any, keys: Sequence[str], number: float) -> Any:
        """The table with another number in one of its entries, whose name may have points in it."""
        count = next(i for i in range(1, len(keys) + 1) if ".".join(keys[:i]) in value)
        name = ".".join(keys[:count])
        return {**value, name: self.item.put(value[name], keys[count:], number)}

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The entries of all names."""
        for name, part in raw.items() if isinstance(raw, Mapping) else ():
            for entry in self.item.raw_entries(part):
                yield entry.below(name, name=name)

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with other names of elements in its entries."""
        if not isinstance(raw, Mapping):
            return raw
        return {name: self.item.rename(part, names) for name, part in raw.items()}

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """The tables of its entries."""
        yield from self.item.table_codecs((*place, "*"))


@dataclass(frozen=True)
class WeightsCodec(NamesCodec):
    """Weights of outputs by their names, which may be outputs of elements."""

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with the other names of elements in those of outputs."""
        raw = super().rename(raw, names)
        return {rename_output(name, names): one for name, one in raw.items()} if isinstance(raw, Mapping) else raw


def with_name(words: str, name: str) -> str:
    """Words for a number of an entry that has a name: "mass of body", "intensity of a force for sway"."""
    return f"{words} {'for' if ' of ' in words else 'of'} {name}" if words else name


@dataclass(frozen=True)
class RowsCodec(Codec):
    """A list of tables, which has as many places."""

    item: TableCodec

    def load(self, raw: Any, context: LoadContext) -> Any:
        """The values of the tables, in their order."""
        if not isinstance(raw, list):
            raise invalid_entry(raw, fault="not a list of tables", expected=context.example)
        *above, name = context.place
        rows = (replace(context, place=(*above, f"{name}[{i}]")) for i in range(1, len(raw) + 1))
        return tuple(inside.read(self.item, entry) for inside, entry in zip(rows, raw, strict=True))

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """Empty: places in a list have no names."""
        yield from ()

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The list with other names of elements in its tables."""
        return [self.item.rename(one, names) for one in raw] if isinstance(raw, list) else raw

    def dump(self, value: Any) -> list[Any]:
        """List of the tables."""
        return [self.item.dump(one) for one in value]

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the list."""
        return {"type": "array", "items": self.item.schema()}


@dataclass(frozen=True)
class EitherCodec(Codec):
    """Codec of a table of one kind, or of an entry that is not a table."""

    table: TableCodec
    other: Codec

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Value of the entry, by the codec that applies to it."""
        return (self.table if isinstance(raw, dict) else self.other).load(raw, context)

    def schema(self) -> dict[str, Any]:
        """JSON Schema of the table or the other entry."""
        return any_of([self.table.schema(), self.other.schema()])

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """Table of the codec and those in it, by their key paths."""
        yield from self.table.table_codecs(place)


@dataclass(frozen=True)
class ByPlaceCodec(NamesCodec):
    """A table by places of the whole file, which may be written with quotes, or as tables in tables."""

    entries: bool = False  # whether an entry may be a table, one that holds no other

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Entries by key path; their values are checked once the whole file is read."""
        return super().load(by_place(raw, entries=self.entries), context)

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """Empty: the numbers belong to other key paths."""
        yield from ()

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """Empty for the same reason."""
        yield from ()

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of both ways to write it."""
        inside = {"additionalProperties": {"type": ["array", "object"]}} if self.entries else {}
        deeper = {"type": "object", **inside, "minProperties": 1}
        each = any_of([*_alternatives(self.item.schema()), deeper])
        return {"type": "object", "additionalProperties": each}


def by_place(table: Any, *, entries: bool = True) -> Any:
    """A table of a file by places: a place that is written without quotes is a table in a table.

    Tables may be `entries` too, where they hold no others.

    >>> by_place({"road": {"speed": ["20 m/s", "30 m/s"]}, "k": {"from": "1 N/m", "to": "2 N/m"}})
    {'road.speed': ['20 m/s', '30 m/s'], 'k': {'from': '1 N/m', 'to': '2 N/m'}}
    """
    if not isinstance(table, dict):
        return table
    found: dict[Any, Any] = {}
    for key, entry in table.items():
        further = isinstance(entry, dict)
        if further and entries:
            further = any(isinstance(inner, dict | list) for inner in entry.values())
        if further:
            found |= by_place({f"{key}.{name}": inner for name, inner in entry.items()}, entries=entries)
        else:
            found[key] = entry
    return found


def _alternatives(schema: dict[str, Any]) -> list[dict[str, Any]]:
    return list(schema["anyOf"]) if set(schema) == {"anyOf"} else [schema]


def any_of(schemas: Collection[dict[str, Any]]) -> dict[str, Any]:
    """The JSON Schema of what one of these takes."""
    return {"anyOf": list(schemas)} if len(schemas) > 1 else dict(next(iter(schemas)))
