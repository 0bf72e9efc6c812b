"""Operating conditions in a study file: `[[conditions]]`, each with its share and other numbers at some places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from inerter.field_metadata import fields_of
from inerter.files.common.entries import exact_text
from inerter.files.common.ties import with_known_values
from inerter.files.study.place import Place, element_at, place_of
from inerter.files.study.places import number_at, with_numbers
from inerter.files.study.sections import ConditionEntry
from inerter.methods.conditions import Condition
from inerter.networks.elements import Element, Tied
from inerter.units import quote_value
from inerter.vehicle.registry import VEHICLES

if TYPE_CHECKING:
    from inerter.files.study.study import Study

IN_CONDITIONS, CONDITION = "in_conditions.", "in_conditions.condition"  # variables and dimension of results
MOST_LISTED = 6  # conditions, one by one


@dataclass(frozen=True)
class StudyCondition:
    """Operating condition with its share of the time: values that replace those at some key paths, in SI units."""

    numbers: dict[str, float]
    share: float = 1.0
    name: str = ""

    def entry(self, study: Study) -> ConditionEntry:
        """Table entry of the condition for the study file."""
        units = {label: found.unit for label in self.numbers if (found := number_at(study, place_of(label)))}
        numbers = {label: exact_text(number, units[label]) for label, number in self.numbers.items()}
        return ConditionEntry(numbers=numbers, share=self.share, name=self.name or None)


def condition_labels(conditions: Sequence[StudyCondition]) -> list[str]:
    """Label of each condition in results: its name, else its number from 1."""
    return [one.name or f"{i}" for i, one in enumerate(conditions, start=1)]


def what_of(study: Study, place: Place) -> tuple[str, str] | None:
    """Section "vehicle" or "road" of the number at a place and its name there; None for any other place."""
    *inside, last = place.key.split(".")
    match place.section, inside:
        case "elements", []:
            return "vehicle", last
        case "road", []:
            return "road", last
        case "road", ["coherence"]:
            return "road", "coherence"
        case "vehicle", [] | ["coordinates"] | ["seat"]:
            fields = fields_of(VEHICLES[study.model]) if study.model in VEHICLES and not inside else ()
            return "vehicle", {field.key: field.name for field in fields}.get(last, last)
        case _:
            return None


def following(study: Study, numbers: Mapping[str, float]) -> dict[str, Element]:
    """Elements tied to the elements that `numbers` replaces, with their updated values."""
    changed = [(place_of(label), number) for label, number in numbers.items()]
    there = with_known_values(with_numbers(study, changed).elements)
    sources = {element_at(place) for place, _ in changed}
    tied = {name: e.value.names for name, e in study.elements.items() if isinstance(e.value, Tied)}
    return {name: there[name] for name, names in tied.items() if sources.intersection(names)}


def condition_of(study: Study, stated: StudyCondition) -> Condition:
    """Operating condition as the methods take it, with dependent values updated."""
    changed: dict[str, dict[str, Any]] = {"vehicle": {}, "road": {}}
    there = with_numbers(
        study, [(p, n) for label, n in stated.numbers.items() if (p := place_of(label)).section == "road"]
    )
    for label, number in stated.numbers.items():
        found = what_of(study, place_of(label))
        assert found is not None, label
        section, name = found
        changed[section][name] = getattr(there.road, name) if section == "road" else number
    changed["vehicle"] |= {
        name: e.value for name, e in following(study, stated.numbers).items() if isinstance(e.value, float)
    }
    name = stated.name or ", ".join(f"{label} = {quote_value(number)}" for label, number in stated.numbers.items())
    return Condition(stated.share, changed["vehicle"], changed["road"], name, if_there=True)
