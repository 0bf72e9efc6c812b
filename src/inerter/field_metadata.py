"""Metadata of dataclass fields: quantities with units, choices of text, typed settings and mounted networks.

A frozen dataclass declares them as `field(metadata=quantity(...))`. Keys of files, rows of reports and validation are
derived from them; the tables of the documentation are checked against them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from typing import Any

from inerter.formatting import in_words

_QUANTITY, _MOUNT, _CHOICE, _FORMED = "inerter quantity", "inerter mount", "inerter choice", "inerter formed"


@dataclasses.dataclass(frozen=True)
class Field:
    """Positive quantity in `unit`; optional with a `default`, and possibly zero if the default is.

    >>> import inerter as it
    >>> it.Field("pitch", "m", "Travel of the nut in one turn.").unit
    'm'
    """

    name: str
    unit: str  # SI
    sentence: str
    example: str = ""  # value with its unit
    key: str = ""  # in files, if it differs from the name
    words: str = ""  # before "of ..." in sentences, if they differ from the name
    default: float | None = None  # in `unit`
    may_be_free: bool = False  # whether it may be a design variable
    usual: tuple[float, float] | None = None  # smallest and largest [SI] without a warning

    @property
    def in_words(self) -> str:
        """Name for use in sentences."""
        return self.words or in_words(self.name)


@dataclasses.dataclass(frozen=True)
class TextChoice:
    """Text setting: one of the `options`, or any name if there are none."""

    name: str
    options: tuple[str, ...]
    sentence: str
    example: str = ""
    key: str = ""  # in files, if it differs from the name
    needed: bool = False  # whether it is required
    of_element: bool = False  # whether it is the name of an element


@dataclasses.dataclass(frozen=True)
class TypedField:
    """Setting of a value type that files know by name, such as a filter."""

    name: str
    form: str
    sentence: str
    example: str  # in TOML
    key: str = ""  # in files, if it differs from the name
    needed: bool = False  # whether it is required


@dataclasses.dataclass(frozen=True)
class MountField:
    """Network that is mounted in a vehicle."""

    name: str
    sentence: str
    key: str = ""
    needed: bool = False  # whether it is required


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
    """Metadata of a dataclass field that is a positive quantity, in `unit`.

    `example` is a value with its unit, for messages. The key in files is the name of the field or `key`; in sentences
    the quantity is called `words`. One that `may_be_free` may be a design variable: it is the mass of a coordinate or
    the value of an element of the mechanism, unchanged. `inerter check` warns of values outside `usual`, (smallest,
    largest).

    >>> @dataclasses.dataclass(frozen=True)
    ... class Wheel:
    ...     mass: float = dataclasses.field(metadata=quantity("kg", "With its tyre.", "25 kg"))
    >>> fields_of(Wheel)
    (Field(name='mass', unit='kg', sentence='With its tyre.', example='25 kg', key='mass', words='', default=None,
    may_be_free=False, usual=None),)
    """
    return {_QUANTITY: Field("", unit, sentence, example, key, words, may_be_free=may_be_free, usual=usual)}


def choice_field(
    options: tuple[str, ...], sentence: str, *, example: str = "", key: str = "", of_element: bool = False
) -> Mapping[str, Any]:
    """Metadata of a dataclass field that is one of these texts, or any name without `options`; else like `quantity`.

    A name `of_element` is that of an element of the file, and follows it when the element is renamed.

    >>> @dataclasses.dataclass(frozen=True)
    ... class Wheel:
    ...     side: str = dataclasses.field(default="left", metadata=choice_field(("left", "right"), "Where it is."))
    >>> choices_of(Wheel)
    (TextChoice(name='side', options=('left', 'right'), sentence='Where it is.', example='left',
    key='side', needed=False, of_element=False),)
    """
    shown = example or (options[0] if options else "")
    return {_CHOICE: TextChoice("", options, sentence, shown, key, of_element=of_element)}


def typed_field(form: str, sentence: str, example: str, *, key: str = "") -> Mapping[str, Any]:
    """Metadata of a setting of an index with this value type in study files; else like `quantity`.

    A "filter" is a `Filter`, "outputs" are names with weights, an "excitation" is one for `RandomResponse`, an "output"
    or an "input" is the name of one, and an "amplitude" that of an input. `example` is written as in TOML.

    >>> @dataclasses.dataclass(frozen=True)
    ... class Heard:
    ...     at: str = dataclasses.field(metadata=typed_field("output", "Where.", '"sprung_velocity"'))
    >>> typed_fields_of(Heard)
    (TypedField(name='at', form='output', sentence='Where.', example='"sprung_velocity"', key='at', needed=True),)
    """
    return {_FORMED: TypedField("", form, sentence, example, key)}


def mount(sentence: str) -> Mapping[str, Any]:
    """Metadata of a dataclass field that is a network, given in the layouts of a file; optional if it may be None.

    >>> import inerter as it
    >>> from dataclasses import field
    >>> field(metadata=it.mount("Between body and wheel.")).metadata is not None
    True
    """
    return {_MOUNT: MountField("", sentence)}


def fields_of(kind: type) -> tuple[Field, ...]:
    """Quantities of a dataclass, in the order of its fields."""
    return _declarations(kind, _QUANTITY)


def choices_of(kind: type) -> tuple[TextChoice, ...]:
    """Choices of text of a dataclass, in the order of its fields."""
    return _declarations(kind, _CHOICE)


def typed_fields_of(kind: type) -> tuple[TypedField, ...]:
    """Typed settings of a dataclass, in the order of its fields."""
    return _declarations(kind, _FORMED)


def mounts_of(kind: type) -> tuple[str, ...]:
    """Names of the mounted networks of a dataclass, in the order of its fields."""
    return _mount_names(kind)


def needed_mounts_of(kind: type) -> tuple[str, ...]:
    """Names of the required networks of a dataclass, in the order of its fields."""
    return _mount_names(kind, needed=True)


@cache
def _mount_names(kind: Any, needed: bool = False) -> tuple[str, ...]:
    return tuple(one.name for one in _declarations(kind, _MOUNT) if one.needed or not needed)


@cache
def _declarations(kind: Any, what: str) -> tuple[Any, ...]:
    fields = dataclasses.fields(kind)
    return tuple(_with_field(field, field.metadata[what]) for field in fields if what in field.metadata)


def _with_field(field: dataclasses.Field[Any], declared: Any) -> Any:
    """A declaration with what the dataclass field says by itself: its name, and its default or whether it has one."""
    default = field.default if isinstance(field.default, float) else None
    is_needed = field.default is field.default_factory is dataclasses.MISSING
    own = {"default": default} if isinstance(declared, Field) else {"needed": is_needed}
    return dataclasses.replace(declared, name=field.name, key=declared.key or field.name, **own)
