"""A place of a study file, such as `road.speed`: which number stands there, its unit, and the study with another one.

A section of the file that holds numbers is a row of `_SECTIONS`; what sweeps or varies a number asks here alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from inerter.fields import Field, fields_of
from inerter.files.common.roads import COHERENCE, coherence_of
from inerter.files.common.shape import ROAD
from inerter.files.common.vehicle_shapes import SEAT, Inertia
from inerter.files.study.forms import form_of
from inerter.files.study.number import Number
from inerter.indices.registry import INDICES, index_forms, index_settings
from inerter.methods.registry import method_settings
from inerter.networks.elements import Element, Free
from inerter.vehicle.registry import VEHICLES

if TYPE_CHECKING:
    from inerter.files.study.study import Study

_ELEMENTS, _LIMITS, _COHERENCE = "elements", "subject_to", "coherence"
_LOWER, _UPPER = "from", "to"  # the keys of the bounds of a free value


@dataclass(frozen=True)
class Place:
    """A section and what follows it, such as "elements" and "k"."""

    section: str
    key: str

    @property
    def label(self) -> str:
        """What it is called in results and in files: an element by its name alone."""
        return self.key if self.section == _ELEMENTS and "." not in self.key else f"{self.section}.{self.key}"


def place_of(text: str) -> Place:
    """The place that a file names; an element may go by its name alone.

    >>> place_of("k") == place_of("elements.k"), place_of("road.speed").label
    (True, 'road.speed')
    """
    section, _, key = text.partition(".")
    return Place(section, key) if key else Place(_ELEMENTS, section)


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


def element_at(place: Place) -> str:
    """The name of the element that a place is about; empty if it is about none."""
    return place.key.partition(".")[0] if place.section == _ELEMENTS else ""


def number_at(study: Study, place: Place) -> Number | None:
    """What stands at a place; None if it is no place of this study."""
    section = _SECTIONS.get(place.section)
    return section.numbers(study).get(place.key) if section else None


def places(study: Study) -> dict[str, Number]:
    """All numbers of a study by their labels, in the order of the file."""
    return {
        Place(name, key).label: number
        for name, section in _SECTIONS.items()
        for key, number in section.numbers(study).items()
    }


def with_numbers(study: Study, numbers: Iterable[tuple[Place, float]]) -> Study:
    """The study with other numbers at some of its places, in SI units.

    Raises `NetworkError` or `StudyError` for a number that cannot stand there.
    """
    for place, number in numbers:
        study = _SECTIONS[place.section].put(study, place.key, number)
    return study


class _Section(NamedTuple):
    numbers: Callable[[Study], Mapping[str, Number]]
    put: Callable[[Study, str, float], Study]


def _vehicle_numbers(study: Study) -> dict[str, Number]:
    values = study.vehicle
    found: dict[str, Number] = {}
    for f in fields_of(VEHICLES[study.model]) if study.model in VEHICLES else ():
        found |= _with_bounds(f.key, Number(f.unit, f.in_words, values.get(f.key), f.default == 0.0))
    for name, value in values.get("coordinates", {}).items():
        what, unit = ("inertia", "kg m^2") if isinstance(value, Inertia) else ("mass", "kg")
        found[f"coordinates.{name}"] = Number(unit, f"{what} of {name}", value)
    for name, road in values.get("roads", {}).items():
        found[f"roads.{name}.distance"] = Number("m", f"distance of {name}", road["distance"], may_vanish=True)
    if SEAT in values:
        found[f"{SEAT}.mass"] = Number("kg", "mass on the seat", values[SEAT]["mass"])
    return found


def _put_vehicle(study: Study, key: str, number: float) -> Study:
    return replace(study, vehicle=_put(study.vehicle, key.split("."), number))


def _put(table: Mapping[str, Any], keys: list[str], number: float) -> dict[str, Any]:
    """A table with a number in the place of another of the same sort."""
    first, *others = keys
    old = table.get(first)
    if isinstance(old, Free):
        return {**table, first: _other_bound(old, others[0], number) if others else number}
    new = _put(old, others, number) if others and isinstance(old, dict) else type(old or number)(number)
    return {**table, first: new}


def _road_numbers(study: Study) -> dict[str, Number]:
    if study.road is None:
        return {}
    own = {f.key: Number(f.unit, f.in_words, getattr(study.road, f.name)) for f in ROAD}
    values = study.coherence
    alike = {
        f.key: Number(f.unit, f"{f.in_words} of the coherence", values[f.key]) for f in COHERENCE if f.key in values
    }
    return {**own, **{f"{_COHERENCE}.{key}": number for key, number in alike.items()}}


def _put_road(study: Study, key: str, number: float) -> Study:
    assert study.road is not None
    section, _, part = key.rpartition(".")
    if section == _COHERENCE:
        values = {**study.coherence, part: number}
        return replace(study, coherence=values, road=replace(study.road, coherence=coherence_of(values)))
    changed: dict[str, Any] = {f.name: number for f in ROAD if f.key == key}
    return replace(study, road=replace(study.road, **changed))


def _element_numbers(study: Study) -> dict[str, Number]:
    found: dict[str, Number] = {}
    for name, element in study.elements.items():
        found |= _with_bounds(name, Number(element.unit, name, element.value, element.may_vanish))
        found |= {f"{name}.{field.name}": number for field, number in _further(name, element)}
    return found


def _with_bounds(key: str, number: Number) -> dict[str, Number]:
    """A number by its key, with its bounds if it is free."""
    found = {key: number}
    if isinstance(value := number.value, Free):
        found[f"{key}.{_LOWER}"] = Number(number.unit, f"lower bound of {number.words}", value.lower)
        found[f"{key}.{_UPPER}"] = Number(number.unit, f"upper bound of {number.words}", value.upper)
    return found


def _other_bound(value: Free, part: str, number: float) -> Free:
    lower, upper = (number, value.upper) if part == _LOWER else (value.lower, number)
    return Free(lower, upper, value.name)


def _further(name: str, element: Element) -> list[tuple[Field, Number]]:
    """The numbers of an element beside its value."""
    return [
        (field, Number(field.unit, f"{field.in_words} of {name}", getattr(element, field.name)))
        for field in element.more
    ]


def _put_element(study: Study, key: str, number: float) -> Study:
    name, _, part = key.partition(".")
    element = study.elements[name]
    return replace(study, elements={**study.elements, name: _with_part(element, part, number)})


def _with_part(element: Element, part: str, number: float) -> Element:
    value = element.value
    if not part:
        return element.with_value(number)
    if isinstance(value, Free) and part in (_LOWER, _UPPER):
        return element.with_value(_other_bound(value, part, number))
    more = {field.name: getattr(element, field.name) for field in element.more}
    return type(element).of(value, element.name, **{**more, part: number})


def _setting_numbers(study: Study) -> dict[str, Number]:
    settings = {key: Number(f.unit, f.in_words, study.settings.get(key)) for key, f in index_settings().items()}
    limits = {
        f"{_LIMITS}.{limit.of}.{limit.sense}": Number(limit.unit, limit.words, limit.value) for limit in study.limits
    }
    return {**settings, **limits}


def _put_setting(study: Study, key: str, number: float) -> Study:
    if not key.startswith(f"{_LIMITS}."):
        return replace(study, settings={**study.settings, key: number})
    found = (
        replace(limit, value=number) if key == f"{_LIMITS}.{limit.of}.{limit.sense}" else limit
        for limit in study.limits
    )
    return replace(study, limits=tuple(found))


def _index_numbers(study: Study) -> dict[str, Number]:
    found = {}
    for name, own in study.own_indices.items():
        for f in fields_of(INDICES[own.symbol]):
            found[f"{name}.{f.key}"] = Number(f.unit, f"{f.in_words} of {name}", own.settings.get(f.key))
        for one in index_forms(own.symbol):
            numbers = form_of(one).numbers(own.settings[one.key]) if one.key in own.settings else {}
            for key, number in numbers.items():
                place = f"{name}.{one.key}.{key}" if key else f"{name}.{one.key}"
                found[place] = replace(number, words=f"{number.words} for {name}")
    return found


def _put_index(study: Study, key: str, number: float) -> Study:
    name, setting, *further = key.split(".")
    own = study.own_indices[name]
    form = next((form_of(one) for one in index_forms(own.symbol) if one.key == setting), None)
    value = number if form is None else form.put(own.settings[setting], ".".join(further), number)
    changed = replace(own, settings={**own.settings, setting: value})
    return replace(study, own_indices={**study.own_indices, name: changed})


def _method_numbers(study: Study) -> dict[str, Number]:
    return {
        f"{name}.{f.key}": Number(f.unit, f"{f.in_words} of {name}", study.method_settings.get(name, {}).get(f.key))
        for name in study.methods
        for f in method_settings(name)
    }


def _put_method(study: Study, key: str, number: float) -> Study:
    name, _, setting = key.partition(".")
    given = {**study.method_settings.get(name, {}), setting: number}
    return replace(study, method_settings={**study.method_settings, name: given})


_SECTIONS = {
    "vehicle": _Section(_vehicle_numbers, _put_vehicle),
    "road": _Section(_road_numbers, _put_road),
    _ELEMENTS: _Section(_element_numbers, _put_element),
    "indices": _Section(_index_numbers, _put_index),
    "study": _Section(_setting_numbers, _put_setting),
    "methods": _Section(_method_numbers, _put_method),
}
