"""Codecs of file entries: each key is declared once for reading, writing, describing, finding and replacing its value.

A `Codec` is a kind of entry. A frozen dataclass has one for each of its fields that is a key, and with them is
a table of a file, `TableCodec(kind)`. Loading with a sentence for every problem, dumping, the JSON Schema, the numbers
in an object by their places, and the object with another number at a place all follow from that.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, TypeVar, dataclass_transform

from inerter.errors import InerterError
from inerter.files.common.kinds import kind_with
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, Problem, invalid_entry
from inerter.files.common.schema import INSTEAD, example_value
from inerter.files.common.suggest import closest, nearest
from inerter.formatting import in_words

INVALID: Any = object()  # stands for an entry that cannot be read
REQUIRED: Any = object()  # the default of a key that must be given
_DECLARATION = "inerter key"
KeyPath = tuple[str, ...]
Kind = TypeVar("Kind")


@dataclass(frozen=True)
class LoadContext:
    """Position of an entry in a file that is read, with the problems so far."""

    tables: Mapping[str, Any]  # of the whole file
    root: Codec
    place: KeyPath = ()
    example: str = ""  # of what may stand here, for messages
    problems: list[Problem] = field(default_factory=list)
    loaded: dict[str, Any] = field(default_factory=dict)  # sections that were read before, by their keys

    def at(self, key: str, example: str = "") -> LoadContext:
        """Context of the entry at `key`; without an example, that of the enclosing table."""
        return LoadContext(
            self.tables, self.root, (*self.place, key), example or self.example, self.problems, self.loaded
        )

    def add(self, error: Exception) -> None:
        """Add the problem of the entry that an error states."""
        problem = error.problem if isinstance(error, EntryError) else Problem(said=str(error))
        self.problems.append(replace(problem, place=(*self.place, *problem.place)))

    def read(self, codec: Codec, raw: Any) -> Any:
        """Value of an entry; `INVALID` for an invalid one, whose problems are added."""
        try:
            return codec.load(raw, self)
        except (ValueError, InerterError) as error:
            self.add(error)
            return INVALID

    def as_table(self, raw: Any) -> Mapping[str, Any]:
        """The entry, if it is a table; raises `EntryError` for another."""
        if not isinstance(raw, Mapping):
            raise invalid_entry(raw, fault="not a table", expected=self.example)
        return raw


@dataclass(frozen=True)
class RawEntry:
    """An entry without keys of its own as a file has it, valid or not, and the codec that reads it."""

    codec: Codec
    raw: Any
    keys: KeyPath = ()
    sentence: str = ""
    words: str = ""  # of its number, as the nearest key declares them
    names: tuple[str, ...] = ()  # of the author's own, in the keys that lead to it; the nearest first

    def below(self, key: str, *, name: str = "", sentence: str = "", words: str = "") -> RawEntry:
        """The entry in a table, at a key that declares words and a sentence, or that is a name of the author's own."""
        return RawEntry(
            self.codec,
            self.raw,
            (key, *self.keys),
            self.sentence or sentence,
            self.words or ("" if self.names else words),
            (*self.names, name) if name else self.names,
        )

    def value(self) -> Any:
        """The value; `INVALID` for an invalid entry."""
        return LoadContext({}, self.codec, self.keys).read(self.codec, self.raw)


class Codec:
    """A kind of entry of a file: reads, writes and describes it, and finds and replaces the numbers in its value."""

    is_number: ClassVar[bool] = False  # whether the value has one number without a key of its own

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Value of the entry; raises ValueError, or adds problems to the context and returns `INVALID`."""
        raise NotImplementedError

    def dump(self, value: Any) -> Any:
        """Entry of a value, in SI units; None or empty for a value that is left out of the file."""
        return value

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the entry."""
        raise NotImplementedError

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The numbers in a value, by the keys to them; `words` are those of the value."""
        yield from ()

    def put(self, value: Any, keys: Sequence[str], number: float) -> Any:
        """The value with another number at these keys, in its SI unit."""
        return number

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The entries without keys of their own in an entry of a file, which may be invalid."""
        yield RawEntry(self, raw)

    def keys_in_file(self, raw: Any, keys: KeyPath) -> KeyPath:
        """The keys in a file to the number that has these keys in the value."""
        return keys

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The entry of a file, valid or not, with other names of elements."""
        return raw

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """The tables that the entry may hold or be, by their places."""
        yield from ()


@dataclass(frozen=True)
class Declaration:
    """Key of a table: codec, sentence, example as a line of a file, and default."""

    codec: Codec
    sentence: str = ""
    example: str = ""
    default: Any = REQUIRED
    name: str = ""  # in files
    attribute: str = ""  # in Python
    words: str = ""  # of its number, in sentences
    implied: str = ""  # lines of other keys that say it in its place
    former: str = ""  # its name in files of the previous version, which is read too

    def name_in(self, raw: Mapping[str, Any]) -> str:
        """Name of the key in a table of a file that gives it; empty in one that does not."""
        return next((name for name in (self.name, self.former) if name and name in raw), "")

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the key."""
        found = dict(self.codec.schema())
        if self.sentence:
            found["description"] = self.sentence
        if (example := example_value(self.example)) is not None:
            found["examples"] = [example]
        default = None if self.default in (REQUIRED, None) else self.codec.dump(self.default)
        if isinstance(default, str | int | float) or (isinstance(default, list) and default):
            found["default"] = default
        if self.implied and self.default is REQUIRED:
            found[INSTEAD] = self.implied
        return found


def key(codec: Codec, sentence: str = "", example: str = "", *, default: Any = REQUIRED, **more: Any) -> Any:
    """Field of a `keyed_dataclass` that is a key of a file; arguments are those of `Declaration`.

    It has the name of the field unless another `name` is given, as one that is a keyword of Python needs.
    """
    own: dict[str, Any] = {} if default is REQUIRED else {"default_factory": lambda: default}
    return field(**own, metadata={_DECLARATION: Declaration(codec, sentence, example, default, **more)})


def section(name: str, codec: Codec, sentence: str = "", example: str = "", default: Any = REQUIRED) -> Declaration:
    """A key that has the same name in Python."""
    return Declaration(codec, sentence, example, default, name, name)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(key, field))
def keyed_dataclass(kind: type[Kind]) -> type[Kind]:
    """A frozen dataclass, of keyword arguments alone, whose fields may be keys."""
    return dataclass(frozen=True, kw_only=True)(kind)


def keys_in(kind: Any) -> tuple[Declaration, ...]:
    """The keys that a keyed dataclass states, in their order."""
    every = [(f, f.metadata[_DECLARATION]) for f in dataclasses.fields(kind) if _DECLARATION in f.metadata]
    return tuple(
        replace(one, name=one.name or f.name, attribute=f.name, words=one.words or in_words(f.name)) for f, one in every
    )


def without_none(**values: Any) -> dict[str, Any]:
    """The values by name, without those that are None."""
    return {name: value for name, value in values.items() if value is not None}


def attributes(value: Any) -> Mapping[str, Any]:
    """The parts of what a table became, by their names."""
    return value if isinstance(value, Mapping) else vars(value)


@dataclass(frozen=True)
class TableCodec(Codec):
    """A table that becomes `make(**values)`, an object of a keyed dataclass or a dictionary.

    `before` may change the raw table and `check` the value; both raise ValueError for what is wrong as a whole. One of
    several kinds has a tag: the key that decides that it is this one, its word there, and a sentence.
    """

    keys: tuple[Declaration, ...]
    make: Callable[..., Any] = dict
    values: Callable[[Any], Mapping[str, Any]] = attributes
    tag: tuple[str, str, str] = ("", "", "")
    before: Callable[[Mapping[str, Any]], Mapping[str, Any]] = dict
    check: Callable[[Any], Any] = lambda value: value
    rest: str = ""  # the attribute of all other keys, if they are not errors
    about: str = ""  # a sentence

    @property
    def names(self) -> list[str]:
        """Names of all keys of the table."""
        return [*filter(None, self.tag[:1]), *(one.name for one in self.keys)]

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Object or dictionary of the table; unknown keys are problems."""
        raw, count = self.before(context.as_table(raw)), len(context.problems)
        values: dict[str, Any] = {}
        known = {name for one in self.keys for name in (one.name, one.former)}.union(self.names)
        others = {name: entry for name, entry in raw.items() if name not in known}
        misspelt = set() if self.rest else {closest(n, self.names) for n in others if not self._belongs(n, context)}
        for one in self.keys:
            if name := one.name_in(raw):
                values[one.attribute] = context.at(name, one.example).read(one.codec, raw[name])
                if one.former in raw and name != one.former:
                    both = f"given together with {one.name}, the new name of the same key"
                    context.at(one.former).add(EntryError(fault=both, expected="one of the two"))
            elif one.default is REQUIRED and one.name in misspelt:
                values[one.attribute] = INVALID
            elif one.default is REQUIRED:
                example = one.example or f"a section [{'.'.join((*context.place, one.name))}]"
                wanted = f"{example}, or {one.implied}" if one.implied else example
                context.at(one.name).add(EntryError(fault="missing", expected=wanted))
                values[one.attribute] = INVALID
            else:
                values[one.attribute] = one.default
            if not context.place:
                context.loaded[one.name] = values[one.attribute]
        if self.rest:
            values[self.rest] = others
        for name in () if self.rest else others:
            hint = self._belongs(name, context) or nearest(name, self.names)
            expected = f"one of {', '.join(self.names)}"
            context.at(name).add(EntryError(fault="unknown key", expected=expected, hint=hint))
        return INVALID if len(context.problems) > count else self.check(self.make(**values))

    def _belongs(self, name: str, context: LoadContext) -> str:
        """Sentence on the section or kind that an unknown key belongs to; else empty."""
        other = None if context.place else kind_with(name)
        if other is not None:
            return f"It is a section of {other.plural}, for: inerter {other.command}."
        every = [(p, t) for p, t in context.root.table_codecs(()) if p and "*" not in p and name in t.names]
        for place, table in every:
            if place == context.place[:1] and table.tag[1]:
                return f'It is a key of {table.tag[0]} = "{table.tag[1]}".'
        elsewhere = sorted((place for place, _ in every if place[:1] != context.place[:1]), key=len)
        return f"It belongs in [{'.'.join(elsewhere[0])}]." if elsewhere else ""

    def dump(self, value: Any) -> dict[str, Any]:
        """The table without keys whose entry is None or an empty table."""
        values = self.values(value)
        entries = {
            one.name: one.codec.dump(part) for one in self.keys if (part := values.get(one.attribute)) is not None
        }
        tag, word, _ = self.tag
        others = values[self.rest] if self.rest else {}
        return {
            **others,
            **({tag: word} if tag else {}),
            **{k: entry for k, entry in entries.items() if entry not in (None, {})},
        }

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the table."""
        tag, word, what = self.tag
        decides = {"const": word, "type": "string", "description": what, "examples": [word]}
        former = {
            one.former: {**one.codec.schema(), "description": f"Former name of {one.name}.", "deprecated": True}
            for one in self.keys
            if one.former
        }
        own = {one.name: one.schema() for one in self.keys}
        properties = {**({tag: decides} if tag else {}), **own, **former}
        required = [one.name for one in self.keys if one.default is REQUIRED and not one.implied]
        return {
            "type": "object",
            **({"description": self.about} if self.about else {}),
            "properties": properties,
            **({"required": [*filter(None, [tag]), *required]} if tag or required else {}),
            "additionalProperties": bool(self.rest),
        }

    def numbers(self, value: Any, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """Numbers of all keys of the table; none without a table."""
        values = {} if value is None else self.values(value)
        for one in () if value is None else self.keys:
            for keys, number in one.codec.numbers(values.get(one.attribute), one.words):
                yield (one.name, *keys), number

    def put(self, value: Any, keys: Sequence[str], number: float) -> Any:
        """The object with another number at a key, or below it."""
        values = self.values(value)
        one = next(one for one in self.keys if one.name == keys[0])
        part = one.codec.put(values.get(one.attribute), keys[1:], number)
        return self.check(self.make(**{**values, one.attribute: part}))

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The entries of all keys that a table gives."""
        for one in self.keys if isinstance(raw, Mapping) else ():
            if name := one.name_in(raw):
                for entry in one.codec.raw_entries(raw[name]):
                    yield entry.below(name, sentence=one.sentence, words=one.words)

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The table with other names of elements in the entries of its keys."""
        if not isinstance(raw, Mapping):
            return raw
        codecs = {name: one.codec for one in self.keys for name in (one.name, one.former)}
        return {key: codecs[key].rename(entry, names) if key in codecs else entry for key, entry in raw.items()}

    def table_codecs(self, place: KeyPath) -> Iterator[tuple[KeyPath, TableCodec]]:
        """The table, and those at its keys."""
        yield place, self
        for one in self.keys:
            yield from one.codec.table_codecs((*place, one.name))


def table_of(kind: Any, **more: Any) -> TableCodec:
    """Codec of the table of a keyed dataclass, whose value is an object of the class; as `TableCodec`."""
    return TableCodec(**{"keys": keys_in(kind), "make": kind, **more})


@dataclass(frozen=True)
class Scalar(Codec):
    """An entry without keys of its own: `parse` gives its value, and raises ValueError for an invalid one."""

    parse: Callable[[Any], Any]
    describe: Callable[[], dict[str, Any]]  # its JSON Schema, made when it is asked for: rows may be added until then
    write: Callable[[Any], Any] = lambda value: value
    renamed: Callable[[Any, Mapping[str, str]], Any] = lambda raw, names: raw  # with other names of elements

    def load(self, raw: Any, context: LoadContext) -> Any:
        """Value of the entry, as `parse` returns it."""
        return self.parse(raw)

    def dump(self, value: Any) -> Any:
        """Entry of a value, as `write` returns it."""
        return self.write(value)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of the entry."""
        return self.describe()

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The entry with other names of elements, as `renamed` returns it."""
        return self.renamed(raw, names)


def load_tables(codec: Codec, tables: Mapping[str, Any]) -> tuple[Any, list[Problem]]:
    """The value of the tables of a file, and their problems; `INVALID` if there are any."""
    context = LoadContext(tables, codec)
    found = context.read(codec, tables)
    return (INVALID if context.problems else found), context.problems
