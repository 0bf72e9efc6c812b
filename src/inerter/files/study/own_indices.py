"""User-defined indices of a study file, in `[indices.NAME]`: a kind, with its settings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from inerter.errors import RegistryError
from inerter.field_metadata import fields_of
from inerter.files.common.codec import TableCodec, without_none
from inerter.files.common.codecs import NamesCodec, TaggedCodec
from inerter.files.common.entries import declaration_of, layout_name, one_of
from inerter.files.common.problem import Problem, at, invalid_entry
from inerter.files.study.forms import Form, form_declaration, form_of
from inerter.indices.names import index_names, index_words
from inerter.indices.registry import INDICES, as_line, excitation_of, index_choices, index_forms, needed_settings
from inerter.signals.road import Road
from inerter.units import quote_value

_KIND = "kind"


@dataclass(frozen=True)
class OwnIndex:
    """An index by its symbol, and those of its settings that the file gives it, in SI units."""

    symbol: str
    settings: dict[str, Any]  # by their keys: numbers, texts, and what forms have made of the others

    @property
    def typed_settings(self) -> list[tuple[str, Form, Any]]:
        """Key, value type and value of each setting that has a value type other than a quantity."""
        given = [one for one in index_forms(self.symbol) if one.key in self.settings]
        return [(one.key, form_of(one), self.settings[one.key]) for one in given]

    @property
    def needs_road(self) -> bool:
        """Whether the index is excited by the road of the study."""
        excitation = excitation_of(self.symbol)
        if excitation is None:
            return False
        return excitation.key not in self.settings or form_of(excitation).on_road(self.settings[excitation.key])

    @property
    def excited_by(self) -> str:
        """Excitation stated for the index, in words; empty if none is stated."""
        return next((words for _, form, value in self.typed_settings if (words := form.source(value))), "")

    def constructor_arguments(self, road: Road | None) -> dict[str, Any]:
        """Settings of the index by key, converted for its constructor; `road` is used where a setting is on a road."""
        return {**self.settings, **{key: form.made(value, road) for key, form, value in self.typed_settings}}


def indices_of(tables: Mapping[str, Any]) -> list[str]:
    """Names of all indices that a file can use: those of the registry, and its user-defined ones."""
    own = tables.get("indices")
    return [*index_names(), *(own if isinstance(own, dict) else ())]


def _own_name(name: Any) -> str:
    if name in index_names():
        raise invalid_entry(name, fault="a name that an index has already", expected="another, such as comfort")
    return layout_name(name)


def own_indices_codec() -> NamesCodec:
    """The section [indices].

    Raises `RegistryError` if an index has two settings of one key.
    """
    tables = {name: _index_table(name, symbol) for name, symbol in index_names().items()}
    example = 'such as { kind = "ride-comfort" }'
    check = one_of("a kind of index", index_names())
    each = TaggedCodec(_KIND, lambda: tables, check, lambda own: index_words()[own.symbol], "ride-comfort")
    return NamesCodec(each, _own_name, example=example)


def _index_table(name: str, symbol: str) -> TableCodec:
    def make(**values: Any) -> OwnIndex:
        return OwnIndex(symbol, without_none(**values))

    fields, choices = fields_of(INDICES[symbol]), index_choices(symbol)
    keys = (
        *(declaration_of(field, optional=True) for field in fields),
        *(declaration_of(one) for one in choices),
        *(form_declaration(one) for one in index_forms(symbol)),
    )
    taken = [_KIND, *(one.name for one in keys)]
    if (twice := next((key for key in taken if taken.count(key) > 1), None)) is not None:
        raise RegistryError(f"{symbol} has a setting {twice!r}, a key that [indices.NAME] has already. Choose another.")
    return TableCodec(keys, make, lambda own: own.settings, tag=(_KIND, name, "Kind of index."))


def bare_index_problems(asked: Iterable[str]) -> Iterator[Problem]:
    """Problems of indices used by their symbols or words although they have required settings."""
    for name in dict.fromkeys(name for name in asked if name in index_names()):
        needed = needed_settings(index_names()[name])
        if needed:
            lines = " and ".join(map(as_line, needed))
            section = f'a section [indices.NAME] with kind = "{name}" and {lines}, and NAME here'
            keys = " and ".join(one.key for one in needed)
            yield at(("study", "indices"), got=quote_value(name), fault=f"it needs its {keys}", expected=section)


def own_index_problems(asked: Sequence[str], own: Mapping[str, OwnIndex], limited: Sequence[str]) -> Iterator[Problem]:
    """Problems of user-defined indices not in use, and of indices listed twice."""
    for name in own:
        if name not in asked and name not in limited:
            yield at(("indices", name), fault="not used", expected=f"{quote_value(name)} in indices, or no section")
    names = [name for name in asked if name not in own]
    for name in names:
        first = next(other for other in names if index_names()[other] == index_names()[name])
        if first != name:
            same = f"{quote_value(first)} and {quote_value(name)}, which are the same index"
            yield at(("study", "indices"), got=same, expected="each at most once")
