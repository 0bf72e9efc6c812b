"""Indices that a study file describes itself, in `[indices.NAME]`: a kind, with settings of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Never

from pydantic import AfterValidator, ConfigDict, Field, PlainValidator, create_model

from inerter.errors import RowError
from inerter.fields import fields_of
from inerter.files.common.entries import layout_name, one_of
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.schema import NEVER, checked
from inerter.files.common.shape import ANY, if_given, of_choices, one_of_shapes
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.vehicles import in_si
from inerter.files.study.forms import Form, form_of, of_forms
from inerter.indices.names import index_names, index_words
from inerter.indices.registry import INDICES, as_line, excitation_of, index_choices, index_forms, needed_settings
from inerter.signals.road import Road
from inerter.units import shown

_KIND = "kind"
_NO_TABLE = "<no table>"


@dataclass(frozen=True)
class OwnIndex:
    """An index by its symbol, and those of its settings that the file gives it, in SI units."""

    symbol: str
    settings: dict[str, Any]  # by their keys: numbers, texts, and what forms have made of the others

    @property
    def formed(self) -> list[tuple[str, Form, Any]]:
        """The settings that have forms of their own, by their keys, each with its form."""
        given = [one for one in index_forms(self.symbol) if one.key in self.settings]
        return [(one.key, form_of(one), self.settings[one.key]) for one in given]

    @property
    def needs_road(self) -> bool:
        """Whether it is asked on a road: nothing else excites it."""
        excitation = excitation_of(self.symbol)
        if excitation is None:
            return False
        return excitation.key not in self.settings or form_of(excitation).on_road(self.settings[excitation.key])

    @property
    def excited_by(self) -> str:
        """What it says that excites the vehicle, in words; empty where it says nothing of it."""
        return next((words for _, form, value in self.formed if (words := form.source(value))), "")

    def made(self, road: Road | None) -> dict[str, Any]:
        """Its settings as the index takes them, on that road if it is on one."""
        return {**self.settings, **{key: form.made(value, road) for key, form, value in self.formed}}

    def entry(self) -> dict[str, Any]:
        """How a file says it."""
        texts = {one.key: self.settings[one.key] for one in index_choices(self.symbol) if one.key in self.settings}
        numbers = in_si(fields_of(INDICES[self.symbol]), self.settings)
        formed = {key: form.written(value) for key, form, value in self.formed}
        return {_KIND: index_words()[self.symbol], **texts, **numbers, **formed}


def _kind(value: Any) -> str:
    return one_of("a kind of index", index_names())(value)


class _AnyIndex(Shape):
    """An index whose kind is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    kind: Annotated[str, PlainValidator(_kind)] = Field(examples=['kind = "ride-comfort"'])


def own_index(entry: Shape) -> OwnIndex:
    """What a table says."""
    given = {key: value for key in type(entry).model_fields if (value := getattr(entry, key)) is not None}
    return OwnIndex(index_names()[given.pop(_KIND)], given)


def indices_of(tables: Mapping[str, Any]) -> list[str]:
    """The names of all indices that a file can ask for: those that there are, and its own."""
    own = tables.get("indices")
    return [*index_names(), *(own if isinstance(own, dict) else ())]


def _refused(entry: Any) -> Never:
    raise EntryError(got=shown(entry), fault="not a table", expected='such as { kind = "ride-comfort" }')


def _own_name(name: Any) -> str:
    if name in index_names():
        raise EntryError(got=shown(name), fault="a name that an index has already", expected="another, such as comfort")
    return layout_name(name)


_OwnName = Annotated[str, AfterValidator(_own_name)]


def index_shapes() -> tuple[Any, Shapes]:
    """The section [indices], and its shapes by place."""
    shapes: dict[str, type[Shape]] = {}
    for name, symbol in index_names().items():
        fields, choices, forms = fields_of(INDICES[symbol]), index_choices(symbol), index_forms(symbol)
        taken = [_KIND, *(f.key for f in fields), *(one.key for one in choices), *(one.key for one in forms)]
        if (twice := next((key for key in taken if taken.count(key) > 1), None)) is not None:
            raise RowError(f"{symbol} has a setting {twice!r}, a key that [indices.NAME] has already. Choose another.")
        keys = {**if_given(fields), **of_choices(choices), **of_forms(forms)}
        what = Field(description="Which index it is.", examples=[f'{_KIND} = "{name}"'])
        shapes[f"<{name}>"] = create_model(f"Index {name}", __base__=Shape, **{_KIND: (Literal[name], what), **keys})
    shapes[ANY] = _AnyIndex

    def tag(entry: Any) -> str:
        if not isinstance(entry, dict):
            return _NO_TABLE
        kind = entry.get(_KIND)
        return f"<{kind}>" if isinstance(kind, str) and f"<{kind}>" in shapes else ANY

    no_table = Annotated[Any, checked(_refused, lambda: NEVER)]
    each: Any = one_of_shapes({**shapes, _NO_TABLE: no_table}, tag)
    table: Any = dict.__class_getitem__((_OwnName, each))
    inside = {
        ("indices", "*", f"<{name}>", one.key, *keys): held
        for name, symbol in index_names().items()
        for one in index_forms(symbol)
        for keys, held in form_of(one).tables.items()
    }
    return table, {**{("indices", "*", tagged): shape for tagged, shape in shapes.items()}, **inside}


def bare_index_problems(asked: Iterable[str]) -> Iterator[Problem]:
    """Indices that are asked for by their symbols or words though they cannot do without settings."""
    for name in dict.fromkeys(name for name in asked if name in index_names()):
        needed = needed_settings(index_names()[name])
        if needed:
            lines = " and ".join(map(as_line, needed))
            section = f'a section [indices.NAME] with kind = "{name}" and {lines}, and NAME here'
            keys = " and ".join(one.key for one in needed)
            yield at(("study", "indices"), got=shown(name), fault=f"it needs its {keys}", expected=section)


def own_index_problems(asked: Sequence[str], own: Mapping[str, OwnIndex], limited: Sequence[str]) -> Iterator[Problem]:
    """Indices that the file describes and makes no use of, and those that it asks for twice."""
    for name in own:
        if name not in asked and name not in limited:
            yield at(
                ("indices", name), fault="nothing asks for it", expected=f"{shown(name)} in indices, or no section"
            )
    names = [name for name in asked if name not in own]
    for name in names:
        first = next(other for other in names if index_names()[other] == index_names()[name])
        if first != name:
            same = f"{shown(first)} and {shown(name)}, which are the same index"
            yield at(("study", "indices"), got=same, expected="each at most once")
