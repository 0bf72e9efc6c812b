"""Numbers of a study by their places: which there are, and the study with another one.

The codec of the file finds and puts them; what sweeps or varies a number asks here alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from inerter.files.common.codec import Codec
from inerter.files.common.elements import free_networks_in
from inerter.files.common.number import Number
from inerter.files.common.roads import road_of, road_values
from inerter.files.study.place import ELEMENTS, Place
from inerter.files.study.sections import study_codec
from inerter.networks.elements import Free

if TYPE_CHECKING:
    from inerter.files.study.study import Study


def number_at(study: Study, place: Place) -> Number | None:
    """Number at a place; None if the study has no number there."""
    return _numbers_in(study, place.section).get(place)


def places(study: Study) -> dict[str, Number]:
    """All numbers of a study by their labels, in the order of the file."""
    return {place.label: number for section in _SECTIONS for place, number in _numbers_in(study, section).items()}


def free_in_vehicle(study: Study) -> dict[str, tuple[Place, Number]]:
    """The free numbers of the vehicle with their places, by the names that they have in designs."""
    found = _numbers_in(study, "vehicle").items()
    return {place.key.rpartition(".")[2]: (place, one) for place, one in found if isinstance(one.value, Free)}


def _numbers_in(study: Study, name: str) -> dict[Place, Number]:
    """The numbers of a section by their places."""
    codec, section = _codec(name), _SECTIONS.get(name)
    if codec is None or section is None:
        return {}
    return {Place(name, ".".join(keys)): number for keys, number in codec.numbers(section.get(study), "")}


def with_numbers(study: Study, numbers: Iterable[tuple[Place, float]]) -> Study:
    """The study with other numbers at some of its places, in SI units.

    Raises `NetworkError` or `StudyError` for a number that cannot stand there.
    """
    for place, number in numbers:
        section, codec = _SECTIONS[place.section], _codec(place.section)
        assert codec is not None
        changed = codec.put(section.get(study), place.key.split("."), number)
        study = replace(study, **section.arguments(study, changed))
    return study


def _codec(section: str) -> Codec | None:
    return next((one.codec for one in study_codec().keys if one.name == section), None)


def sections_of(study: Study) -> dict[str, Any]:
    """Sections of the study file as its codec takes them; None for a section that is left out."""
    return {
        "title": study.title,
        "layouts": study.layouts,
        "conditions": [condition.entry(study) for condition in study.conditions] or None,
        **{name: section.get(study) for name, section in _SECTIONS.items()},
    }


class _Section(NamedTuple):
    """A section that may hold numbers: its value in a study, and the arguments of a study that a value gives."""

    get: Callable[[Study], Any]
    arguments: Callable[[Study, Any], dict[str, Any]]


def _of_road(study: Study, values: Mapping[str, Any]) -> dict[str, Any]:
    assert study.road is not None
    return {"road": road_of(values, study.road.shape), "coherence": values["coherence"] or {}}


def _elements(found: Mapping[str, Any]) -> dict[str, Any]:
    networks = free_networks_in(found)
    return {"elements": {n: e for n, e in found.items() if n not in networks}, "free_networks": networks}


_SECTIONS = {
    "vehicle": _Section(lambda study: study.vehicle, lambda study, found: {"vehicle": found}),
    "road": _Section(lambda study: study.road and road_values(study.road, study.coherence), _of_road),
    ELEMENTS: _Section(lambda study: {**study.elements, **study.free_networks}, lambda study, found: _elements(found)),
    "indices": _Section(lambda study: study.own_indices, lambda study, found: {"own_indices": found}),
    "study": _Section(lambda study: study, lambda study, found: found),
    "methods": _Section(
        lambda study: {**{name: {} for name in study.methods}, **study.method_settings},
        lambda study, found: {"method_settings": {name: table for name, table in found.items() if table}},
    ),
}
