"""Sentences about the roads of a study, and about what in it no road or vehicle is."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from inerter.errors import InerterError
from inerter.files.common.plausibility import class_words, is_on_road, road_sentence, road_warnings, vehicle_warnings
from inerter.files.study.place import place_of
from inerter.files.study.places import with_numbers
from inerter.files.study.quantity_texts import as_written
from inerter.files.study.study import Study, elements_used
from inerter.formatting import format_quantity

_ROUGHNESS, _SPEED = "road.roughness", "road.speed"


def roads_sentences(study: Study) -> list[str]:
    """Sentence on the class of the road and the speed, as far as both are fixed; none without a road."""
    if study.road is None:
        return []
    roads = sorted(filter(None, (one.road for one in _variants(study))), key=lambda road: road.roughness)
    if _ROUGHNESS in study.varied_labels and len({road.roughness for road in roads}) > 1:
        return [f"Roads: from {class_words(roads[0])} to {class_words(roads[-1])}."]
    speed = as_written(study, study.road.speed, "m/s") or format_quantity(study.road.speed, "m/s")
    return [road_sentence(study.road, "" if _SPEED in study.varied_labels else speed)]


def input_warnings(study: Study) -> list[str]:
    """Warnings on implausible roads, speeds or vehicles of the study."""
    if study.road is None or not is_on_road(study.model):
        return []
    found: dict[str, None] = {}
    for one in _variants(study):
        if one.road is not None:
            used = elements_used(one)
            elements = [(name, element) for name, element in one.elements.items() if name in used]
            found |= dict.fromkeys([*road_warnings(one.road), *vehicle_warnings(one.vehicle, elements)])
    return list(found)


def _variants(study: Study) -> Iterator[Study]:
    """Studies at the ends of the sweeps in each condition, without invalid combinations."""
    for swept in product(*({min(sweep.values), max(sweep.values)} for sweep in study.sweeps)):
        for condition in [one.numbers for one in study.conditions] or [{}]:
            try:
                yield with_numbers(study.at(swept), [(place_of(name), number) for name, number in condition.items()])
            except InerterError:
                continue
