"""Relative tolerance of each number of a study, by its key path."""

from __future__ import annotations

from collections.abc import Mapping

from inerter.files.common.problem import Problem, collect_problem, invalid_entry
from inerter.files.common.suggest import some
from inerter.files.study.conditions import what_of
from inerter.files.study.place import element_at, place_of
from inerter.files.study.places import number_at
from inerter.files.study.study import Study, scattering
from inerter.files.study.sweeps import unknown_place
from inerter.networks.elements import Tied

_PLACE = ("study", "tolerance")


def tolerance_of(study: Study, entries: Mapping[str, float]) -> tuple[dict[str, float], list[Problem]]:
    """Relative tolerance of each number, by its label, and the problems of the entries."""
    spread: dict[str, float] = {}
    problems: list[Problem] = []
    for label, part in entries.items():
        with collect_problem(problems, (*_PLACE, label)):
            place = place_of(label)
            if number_at(study, place) is None or what_of(study, place) is None or place.section == "road":
                raise unknown_place(study, place)
            _check_is_part(study, element_at(place))
            spread[place.label] = part
    return spread, problems


def _check_is_part(study: Study, name: str) -> None:
    """Raises `EntryError` for an element that no layout has, of which nothing is made that could scatter."""
    if name and not any(name in scattering(study, layout) for layout in study.layouts):
        tied = [other for other, e in study.elements.items() if isinstance(e.value, Tied) and name in e.value.names]
        hint = f"; {some(tied)} follows from it, and scatters by its own name" if tied else ""
        raise invalid_entry(name, fault=f"no layout has it as a part{hint}", expected="a part of a layout")
