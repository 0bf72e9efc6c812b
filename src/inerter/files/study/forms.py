"""The forms that settings of an index have in a study file beside quantities and words, such as a filter.

A form says how an entry is read and written, what a report tells of it, which numbers in it can be swept, which names
in it have to be the vehicle's, and what becomes of it in Python. A new form is a row of `FORMS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import Field

from inerter.checks import is_number
from inerter.errors import RowError
from inerter.fields import Formed
from inerter.files.common.entries import TEXT
from inerter.files.common.problem import EntryError
from inerter.files.common.schema import checked
from inerter.files.common.tables import Shape
from inerter.files.study.excitations import (
    EXCITATION,
    ExcitationTable,
    Named,
    Path,
    Sized,
    StatedExcitation,
    amount_of,
    in_words,
    number_of,
    written,
)
from inerter.files.study.filters import FILTER, FilterTable, filter_entry, in_s
from inerter.files.study.number import Number
from inerter.indices.random_response import FixedWeights
from inerter.signals.road import Road
from inerter.units import shown

_OF_INPUTS = {"N": "force", "N m": "moment", "m": "road", "m/s": "velocity of a road"}


@dataclass(frozen=True)
class Form:
    """What is particular to a form; functions are of a value, which is what `shape` makes of an entry."""

    shape: Any
    written: Callable[[Any], Any]  # as an entry, in SI units
    told: Callable[[Any], Iterable[tuple[str, str]]] = lambda value: ()  # rows: what of the index, and what it is
    made: Callable[[Any, Road | None], Any] = lambda value, road: value  # in Python, on that road if it is on one
    on_road: Callable[[Any], bool] = lambda value: False  # whether that needs a road
    source: Callable[[Any], str] = lambda value: ""  # what it says that excites the vehicle, in words
    numbers: Callable[[Any], dict[str, Number]] = lambda value: {}  # by what stands behind the key
    put: Callable[[Any, str, float], Any] = lambda value, key, number: value  # another number there
    named: Callable[[Any], Iterable[Named]] = lambda value: ()
    sized: Callable[[Any], Iterable[Sized]] = lambda value: ()
    tables: Mapping[Path, type[Shape]] = field(default_factory=dict)  # in an entry, by their keys


def of_forms(settings: Iterable[Formed]) -> dict[str, Any]:
    """Keys for settings that have a form."""
    keys: dict[str, Any] = {}
    for one in settings:
        shape = form_of(one).shape
        told: dict[str, Any] = {"description": one.sentence, "examples": [f"{one.key} = {one.example}"]}
        keys[one.key] = (shape, Field(**told)) if one.needed else (shape | None, Field(default=None, **told))
    return keys


def form_of(setting: Formed) -> Form:
    """The form of a setting; raises `RowError` for one that there is not."""
    if setting.form not in FORMS:
        raise RowError(f"The setting {setting.key!r} has the form {setting.form!r}; forms are {', '.join(FORMS)}.")
    return FORMS[setting.form]


def _weight(value: Any) -> float:
    if not is_number(value) or value == 0.0:
        raise EntryError(
            got=shown(value),
            expected="a weight other than 0, a number without quotes, such as 1.0 (of an angle, its lever in m)",
        )
    return float(value)


_WEIGHT_SCHEMA: dict[str, Any] = {"type": "number", "not": {"const": 0}}
_OUTPUTS: Any = Annotated[
    dict[str, Annotated[float, checked(_weight, lambda: _WEIGHT_SCHEMA)]],
    Field(min_length=1),
]


def _sum(weights: Mapping[str, float]) -> str:
    """Outputs with their weights, as they are read."""
    terms = (f"{in_words(name)}{'' if weight == 1.0 else f' x {weight:g}'}" for name, weight in weights.items())
    return " + ".join(terms)


def _name(what: str) -> Form:
    """The form of a name that has to be the vehicle's."""
    return Form(
        shape=Annotated[str, TEXT],
        written=str,
        told=lambda name: [(what.capitalize(), in_words(name))],
        named=lambda name: [Named((), what, name)],
    )


FORMS: dict[str, Form] = {
    "filter": Form(
        shape=FILTER,
        written=filter_entry,
        told=lambda value: [("Filter", in_s(value))],
        tables={(): FilterTable},
    ),
    "outputs": Form(
        shape=_OUTPUTS,
        written=dict,
        made=lambda weights, road: FixedWeights(weights),
        told=lambda weights: [("Outputs" if len(weights) > 1 else "Output", _sum(weights))],
        named=lambda weights: [Named((name,), "output", name) for name in weights],
    ),
    "excitation": Form(
        shape=EXCITATION,
        written=StatedExcitation.entry,
        told=StatedExcitation.told,
        made=StatedExcitation.made,
        on_road=lambda value: value.on_road,
        source=lambda value: value.source,
        numbers=StatedExcitation.numbers,
        put=StatedExcitation.with_number,
        named=StatedExcitation.named,
        sized=StatedExcitation.sized,
        tables={(): ExcitationTable, ("shaping",): FilterTable},
    ),
    "input": _name("input"),
    "output": _name("output"),
    "amplitude": Form(
        shape=amount_of(_OF_INPUTS, "input"),
        written=written,
        made=lambda amount, road: amount.value,
        numbers=lambda amount: {"": number_of(amount, "amplitude")},
        put=lambda amount, key, number: amount._replace(value=number),
        sized=lambda amount: [Sized((), amount.unit, str)],
    ),
}
