"""Numbers, networks and elements in the tables of a study file, which may be incomplete, with their keys in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.codec import INVALID, KeyPath, RawEntry
from inerter.files.common.codecs import with_name
from inerter.files.common.elements import ElementCodec, with_tied_values
from inerter.files.common.entries import LOWER, UPPER, ExpressionCodec, element_name
from inerter.files.common.number import Number
from inerter.files.common.problem import invalid_entry
from inerter.files.study.loading import study_of
from inerter.files.study.place import Place
from inerter.files.study.sections import study_codec
from inerter.files.study.study import element_names
from inerter.networks.elements import Element, Free, Tied
from inerter.systems.outputs import main_outputs, rename_output
from inerter.units import quote_value

Tables = Mapping[str, Any]
_LAYOUTS = "layouts"
_WITH_OUTPUTS = ("indices", "vehicle")  # sections that may name outputs
_ANY_ROAD = {"speed": "1 m/s", "roughness": "1e-6 m^3/cycle"}


@dataclass(frozen=True)
class WrittenNumber:
    """A number that a file gives: its place, its keys in the file, and a sentence; without a value if it is invalid."""

    place: Place
    keys: KeyPath
    number: Number
    sentence: str
    name: str  # as a design variable; empty if it cannot be one


@dataclass(frozen=True, eq=False)
class Draft:
    """Contents of the tables of a study file, valid or not."""

    tables: Tables

    @cached_property
    def entries(self) -> list[RawEntry]:
        """All entries without keys of their own, in the order of the file."""
        return list(study_codec().raw_entries(self.tables))

    @cached_property
    def numbers(self) -> list[WrittenNumber]:
        """All numbers, in the order of the file; those with bounds without their bounds."""
        return [number for entry in self.entries if entry.codec.is_number for number in _numbers(entry)]

    @cached_property
    def networks(self) -> dict[KeyPath, str]:
        """The texts of all networks, by their keys: those of layouts, and those of the vehicle."""
        found = {entry.keys: entry.raw for entry in self.entries if isinstance(entry.codec, ExpressionCodec)}
        return {keys: text for keys, text in found.items() if isinstance(text, str)}

    @cached_property
    def elements(self) -> dict[str, Element]:
        """The elements whose entries are valid, by name."""
        values = {entry.keys[-1]: entry.value() for entry in self.entries if isinstance(entry.codec, ElementCodec)}
        elements, _ = with_tied_values({name: value for name, value in values.items() if value is not INVALID})
        return elements

    @cached_property
    def layouts(self) -> dict[str, list[str]]:
        """Elements in the networks of each layout, in order of appearance, whether the file has them or not."""
        given = self.tables.get(_LAYOUTS)
        found: dict[str, list[str]] = {name: [] for name in given} if isinstance(given, Mapping) else {}
        for keys, text in self.networks.items():
            if keys[0] == _LAYOUTS:
                found[keys[1]] += element_names(text)
        return {layout: list(dict.fromkeys(several)) for layout, several in found.items()}

    @cached_property
    def elements_by_layout(self) -> dict[str, list[str]]:
        """Elements on which each layout depends: in its networks, in those of the vehicle, and those others follow."""
        common = [name for keys, text in self.networks.items() if keys[0] != _LAYOUTS for name in element_names(text)]
        found = {}
        for layout, own in self.layouts.items():
            values = [self.elements[name].value for name in (*own, *common) if name in self.elements]
            sources = [name for value in values if isinstance(value, Tied) for name in value.names]
            found[layout] = list(dict.fromkeys([*own, *common, *sources]))
        return found

    @cached_property
    def free(self) -> dict[str, list[str]]:
        """Names of the design variables of each layout: elements on which it depends, and quantities of the vehicle."""
        free = [(entry.codec, entry.keys[-1]) for entry in self.entries if isinstance(_value(entry), Free)]
        elements = {name for codec, name in free if isinstance(codec, ElementCodec)}
        others = [name for codec, name in free if not isinstance(codec, ElementCodec)]
        return {
            layout: [*(name for name in used if name in elements), *others]
            for layout, used in self.elements_by_layout.items()
        }


def _numbers(entry: RawEntry) -> Iterator[WrittenNumber]:
    value = entry.value()
    invalid = ((), Number(getattr(entry.codec, "unit", ""), entry.words, None))
    for keys, number in [invalid] if value is INVALID else entry.codec.numbers(value, entry.words):
        if keys[-1:] in ((LOWER,), (UPPER,)):
            continue
        words = number.words
        for name in entry.names:
            words = with_name(words, name)
        section, *more = *entry.keys, *keys
        yield WrittenNumber(
            Place(section, ".".join(more)),
            (*entry.keys, *entry.codec.keys_in_file(entry.raw, keys)),
            replace(number, words=words),
            entry.sentence,
            entry.keys[-1] if number.may_be_free else "",
        )


def _value(entry: RawEntry) -> Any:
    """Value of an entry; of an element that of its quantity."""
    value = entry.value()
    return value.value if isinstance(value, Element) else value


def rename_elements(tables: Tables, renamed: Mapping[str, str]) -> dict[str, Any]:
    """The tables with other names of elements, wherever the file has them.

    Raises `EntryError` for a name that an element cannot have, or that another one has; also for one that would make
    an output of an element one of the vehicle's, or the other way round.
    """
    given = tables.get("elements")
    known = given if isinstance(given, Mapping) else {}
    for new in renamed.values():
        element_name(new)
        if (new in known and new not in renamed) or list(renamed.values()).count(new) > 1:
            raise invalid_entry(new, fault="the name of another element", expected="an unused name")
    found = dict(study_codec().rename(tables, renamed))
    if any(found.get(section) != tables.get(section) for section in _WITH_OUTPUTS):
        _check_outputs(tables, renamed)
    return found


def _check_outputs(tables: Tables, renamed: Mapping[str, str]) -> None:
    """Raises `EntryError` if the name of an output in the tables is, or would become, one of a part of the vehicle."""
    try:
        study = study_of({**tables, **({"road": _ANY_ROAD} if "road" in tables else {})}, Path("study.toml"))
        own = {name for layout in study.layouts for name in main_outputs(study.design(layout).mechanism())}
    except InerterError:
        return
    used = {text for section in _WITH_OUTPUTS for text in _texts(tables.get(section))}
    for output in sorted(used):
        other = rename_output(output, renamed)
        if other != output and own & {output, other}:
            raise invalid_entry(
                other,
                fault=f"the name of an output of the vehicle, or that of {quote_value(output)}, which is one",
                expected="a name of an element that no part of the vehicle has",
            )


def _texts(tables: Any) -> Iterator[str]:
    """All texts and keys of tables."""
    match tables:
        case str():
            yield tables
        case Mapping():
            for name, entry in tables.items():
                yield from (name, *_texts(entry))
