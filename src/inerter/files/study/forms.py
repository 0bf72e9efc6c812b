"""Value types of index settings in a study file other than quantities and words, such as a filter.

A form has a codec, and says what a report tells of it, which names in it have to be the vehicle's, and what becomes of
it in Python. A new form is a row of `FORMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from inerter.errors import RegistryError
from inerter.field_metadata import TypedField
from inerter.files.common.codec import REQUIRED, Codec, Declaration, KeyPath, Scalar
from inerter.files.common.codecs import WeightsCodec
from inerter.files.common.entries import OUTPUT_NAME, TEXT
from inerter.files.common.number import Number
from inerter.files.common.problem import invalid_entry
from inerter.files.study.excitations import (
    EXCITATION,
    AmountCodec,
    NameReference,
    SizeReference,
    StatedExcitation,
)
from inerter.files.study.filters import FILTER, in_s
from inerter.formatting import format_number, in_words
from inerter.indices.random_response import FixedWeights
from inerter.signals.road import Road
from inerter.units import PURE
from inerter.validation import is_number

_OF_INPUTS = {"N": "force", "N m": "moment", "m": "road", "m/s": "velocity of a road"}


@dataclass(frozen=True)
class Form:
    """Value type of a setting: its codec, and functions of a value."""

    codec: Codec
    told: Callable[[Any], Iterable[tuple[str, str]]] = lambda value: ()  # rows: what of the index, and what it is
    made: Callable[[Any, Road | None], Any] = lambda value, road: value  # in Python, on that road if it is on one
    on_road: Callable[[Any], bool] = lambda value: False  # whether that needs a road
    source: Callable[[Any], str] = lambda value: ""  # what it says that excites the vehicle, in words
    named: Callable[[Any], Iterable[NameReference]] = lambda value: ()
    sized: Callable[[Any], Iterable[SizeReference]] = lambda value: ()


def form_declaration(setting: TypedField) -> Declaration:
    """The key of a setting that has a form."""
    example, default = f"{setting.key} = {setting.example}", REQUIRED if setting.needed else None
    words = in_words(setting.key)
    return Declaration(form_of(setting).codec, setting.sentence, example, default, setting.key, setting.key, words)


def form_of(setting: TypedField) -> Form:
    """Value type of a setting; raises `RegistryError` for one that there is not."""
    if setting.form not in FORMS:
        raise RegistryError(f"The setting {setting.key!r} has the form {setting.form!r}; forms are {', '.join(FORMS)}.")
    return FORMS[setting.form]


def _weight(value: Any) -> float:
    if not is_number(value) or value == 0.0:
        raise invalid_entry(
            value,
            expected="a weight other than 0, a number without quotes, such as 1.0 (of an angle, its lever in m)",
        )
    return float(value)


_WEIGHT_SCHEMA: dict[str, Any] = {"type": "number", "not": {"const": 0}}


class WeightCodec(Scalar):
    """The weight of an output."""

    is_number: ClassVar[bool] = True

    def numbers(self, value: float, words: str) -> Iterator[tuple[KeyPath, Number]]:
        """The weight."""
        yield (), Number(PURE, words or "weight", value, signed=True)


_OUTPUTS = WeightsCodec(WeightCodec(_weight, lambda: _WEIGHT_SCHEMA), least=1)


def _sum(weights: Mapping[str, float]) -> str:
    """Weighted sum of outputs as text."""
    return " + ".join(in_words(name) + (f" x {format_number(w)}" if w != 1.0 else "") for name, w in weights.items())


def _name(what: str, codec: Codec = TEXT) -> Form:
    """The form of a name that has to be the vehicle's."""
    return Form(
        codec,
        told=lambda name: [(what.capitalize(), in_words(name))],
        named=lambda name: [NameReference((), what, name)],
    )


FORMS: dict[str, Form] = {
    "filter": Form(
        FILTER,
        told=lambda value: [("Filter", in_s(value))],
    ),
    "outputs": Form(
        _OUTPUTS,
        made=lambda weights, road: FixedWeights(weights),
        told=lambda weights: [("Outputs" if len(weights) > 1 else "Output", _sum(weights))],
        named=lambda weights: [NameReference((name,), "output", name) for name in weights],
    ),
    "excitation": Form(
        EXCITATION,
        told=StatedExcitation.report_rows,
        made=StatedExcitation.to_excitation,
        on_road=lambda value: value.on_road,
        source=lambda value: value.source,
        named=StatedExcitation.name_references,
        sized=StatedExcitation.size_references,
    ),
    "input": _name("input"),
    "output": _name("output", OUTPUT_NAME),
    "amplitude": Form(
        AmountCodec(_OF_INPUTS, "input"),
        made=lambda amount, road: amount.value,
        sized=lambda amount: [SizeReference((), amount.unit, str)],
    ),
}
