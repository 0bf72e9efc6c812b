"""What something is made of, stated where it is: quantities with their units, texts, and what has a form of its own.

A frozen dataclass gives them to its own fields as `field(metadata=quantity(...))`. The keys of files, the rows of
reports and the checks are made of them; the tables of the docs are checked against them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from typing import Any, TypeVar

_QUANTITY, _MOUNT, _CHOICE, _FORMED = "inerter quantity", "inerter mount", "inerter choice", "inerter formed"


@dataclasses.dataclass(frozen=True)
class Field:
    """A positive number of `unit`; one with a `default` may be left out, and may be zero if that is."""

    name: str
    unit: str  # SI
    sentence: str
    example: str = ""  # of a value with its unit
    key: str = ""  # in files, if that is not the name
    words: str = ""  # to go before "of ...", if that is not the name
    default: float | None = None  # in `unit`
    may_be_free: bool = False  # whether an optimiser may choose it
    usual: tuple[float, float] | None = None  # least and largest [SI] beyond which a value is doubted, not refused

    @property
    def in_words(self) -> str:
        """What it is called in sentences."""
        return self.words or self.name.replace("_", " ")


@dataclasses.dataclass(frozen=True)
class TextChoice:
    """A text: one of the `options`, or any name if there are none."""

    name: str
    options: tuple[str, ...]
    sentence: str
    example: str = ""
    key: str = ""  # in files, if that is not the name
    needed: bool = False  # whether it must be given


@dataclasses.dataclass(frozen=True)
class Formed:
    """A value of a form that files know by its name, such as a filter."""

    name: str
    form: str
    sentence: str
    example: str  # as TOML writes it
    key: str = ""  # in files, if that is not the name
    needed: bool = False  # whether it must be given


Stated = TypeVar("Stated", TextChoice, Formed)


def quantity(
    unit: str,
    sentence: str,
    example: str,
    *,
    key: str = "",
    words: str = "",
    may_be_free: bool = False,
    usual: tuple[float, float] | None = None,
) -> Mapping[str, Any]:
    """The metadata of a dataclass field that is a positive quantity, in `unit`.

    `example` is a value with its unit, for messages. In files it has the name of the field or this `key`, and in
    sentences these `words` stand for it. One that `may_be_free` is the mass of a coordinate or the value of an element
    of the mechanism as it stands, so that an optimiser may choose it. `inerter check` warns of a value that is not
    within the `usual` ones, (least, largest).

    >>> @dataclasses.dataclass(frozen=True)
    ... class Wheel:
    ...     mass: float = dataclasses.field(metadata=quantity("kg", "With its tyre.", "25 kg"))
    >>> fields_of(Wheel)
    (Field(name='mass', unit='kg', sentence='With its tyre.', example='25 kg', key='mass', words='', default=None,
    may_be_free=False, usual=None),)
    """
    return {_QUANTITY: Field("", unit, sentence, example, key, words, may_be_free=may_be_free, usual=usual)}


def choice_field(options: tuple[str, ...], sentence: str, *, example: str = "", key: str = "") -> Mapping[str, Any]:
    """The metadata of a dataclass field that is one of these texts, or without `options` a name; as `quantity`.

    >>> @dataclasses.dataclass(frozen=True)
    ... class Wheel:
    ...     side: str = dataclasses.field(default="left", metadata=choice_field(("left", "right"), "Where it is."))
    >>> choices_of(Wheel)
    (TextChoice(name='side', options=('left', 'right'), sentence='Where it is.', example='left',
    key='side', needed=False),)
    """
    return {_CHOICE: TextChoice("", options, sentence, example or (options[0] if options else ""), key)}


def typed_field(form: str, sentence: str, example: str, *, key: str = "") -> Mapping[str, Any]:
    """The metadata of a field of an index that has this form in study files; else as `quantity`.

    A "filter" is a `Filter`, "outputs" are names with weights, an "excitation" is one for `RandomResponse`, an "output"
    or an "input" is the name of one, and an "amplitude" that of an input. `example` is written as in TOML.

    >>> @dataclasses.dataclass(frozen=True)
    ... class Heard:
    ...     at: str = dataclasses.field(metadata=typed_field("output", "Where.", '"sprung_velocity"'))
    >>> formed_of(Heard)
    (Formed(name='at', form='output', sentence='Where.', example='"sprung_velocity"', key='at', needed=True),)
    """
    return {_FORMED: Formed("", form, sentence, example, key)}


def mount(sentence: str) -> Mapping[str, Any]:
    """The metadata of a dataclass field that is a network; files give it in their layouts, unless it may be None."""
    return {_MOUNT: sentence}


def fields_of(kind: type) -> tuple[Field, ...]:
    """The quantities of a dataclass, in their order."""
    return _stated(kind)[0]


def choices_of(kind: type) -> tuple[TextChoice, ...]:
    """The texts of a dataclass that are chosen, in their order."""
    return tuple(_named(f, f.metadata[_CHOICE]) for f in dataclasses.fields(kind) if _CHOICE in f.metadata)


def formed_of(kind: type) -> tuple[Formed, ...]:
    """The fields of a dataclass that have a form of their own, in their order."""
    return tuple(_named(f, f.metadata[_FORMED]) for f in dataclasses.fields(kind) if _FORMED in f.metadata)


def mounts_of(kind: type) -> tuple[str, ...]:
    """The networks of a dataclass, in their order."""
    return tuple(_stated(kind)[1])


def needed_mounts_of(kind: type) -> tuple[str, ...]:
    """Those networks of a dataclass that cannot be left out, in their order."""
    return tuple(name for name, needed in _stated(kind)[1].items() if needed)


@cache
def _stated(kind: Any) -> tuple[tuple[Field, ...], dict[str, bool]]:
    every = dataclasses.fields(kind)
    quantities = tuple(_quantity_of(field) for field in every if _QUANTITY in field.metadata)
    return quantities, {f.name: f.default is dataclasses.MISSING for f in every if _MOUNT in f.metadata}


def _named(field: dataclasses.Field[Any], stated: Stated) -> Stated:
    needed = field.default is field.default_factory is dataclasses.MISSING
    return dataclasses.replace(stated, name=field.name, key=stated.key or field.name, needed=needed)


def _quantity_of(field: dataclasses.Field[Any]) -> Field:
    stated: Field = field.metadata[_QUANTITY]
    default = field.default if isinstance(field.default, float) else None
    return dataclasses.replace(stated, name=field.name, key=stated.key or field.name, default=default)
