"""Operating conditions in a study file: `[[conditions]]`, each with its share and other numbers at some places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, PlainValidator

from inerter.errors import InerterError
from inerter.fields import fields_of
from inerter.files.common.entries import one_of, positive_number, quantity_text, text
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.shape import ROAD, Shape
from inerter.files.study.places import Place, by_place, number_at, place_of
from inerter.files.study.sweeps import number_of, value_of
from inerter.methods.conditions import Condition
from inerter.units import shown
from inerter.vehicle.registry import VEHICLES

if TYPE_CHECKING:
    from inerter.files.study.study import Study

OVER = ("mean", "worst")
Over = Annotated[str | None, PlainValidator(one_of("a way to take an index over conditions", OVER))]
_PLACE = "conditions"


@dataclass(frozen=True)
class StudyCondition:
    """How the vehicle goes for a part of the time: other numbers at some places, by their labels, in SI units."""

    numbers: dict[str, float]
    share: float = 1.0
    name: str = ""

    def entry(self, study: Study) -> dict[str, str | float]:
        """How a file says it."""
        units = {label: found.unit for label in self.numbers if (found := number_at(study, place_of(label)))}
        given = {label: f"{number!r} {units[label]}" for label, number in self.numbers.items()}
        return {**given, "share": self.share, **({"name": self.name} if self.name else {})}


def _by_place(table: Any) -> Any:
    return by_place(table, entries=False)


class _ConditionShape(Shape):
    """Numbers by their places, and how much of the time they are so."""

    model_config = ConfigDict(extra="allow")
    share: Annotated[float, PlainValidator(positive_number)] = Field(default=1.0, examples=["share = 0.3"])
    name: Annotated[str, PlainValidator(text)] = Field(default="", examples=['name = "loaded"'])


ConditionShape = Annotated[_ConditionShape, BeforeValidator(_by_place)]


def conditions_of(study: Study, entries: Sequence[Any]) -> tuple[tuple[StudyCondition, ...], list[Problem]]:
    """The conditions that a file states, and what is wrong with them."""
    conditions, problems = [], []
    for i, entry in enumerate(entries, start=1):
        numbers = {}
        for label, given in (entry.model_extra or {}).items():
            where = (f"{_PLACE}[{i}]", label)
            try:
                place = place_of(label)
                numbers[place.label] = _number(study, place, given)
            except EntryError as error:
                problems.append(replace(error.problem, place=where))
            except InerterError as error:
                problems.append(at(where, str(error)))
        conditions.append(StudyCondition(numbers, entry.share, entry.name))
    swept = {sweep.label for sweep in study.sweeps}
    for i, condition in enumerate(conditions, start=1):
        for label in condition.numbers.keys() & swept:
            both = f"{label} is swept, and in a condition"
            problems.append(at((f"{_PLACE}[{i}]", label), fault=both, expected="one of the two"))
    return tuple(conditions), problems


def _number(study: Study, place: Place, given: Any) -> float:
    number = number_of(study, place)
    if _section(study, place) is None:
        raise EntryError(
            got=place.label,
            fault="not what a condition can change",
            expected="a number of the vehicle or the road, or the value of an element",
        )
    return value_of(number, quantity_text(given))


def _section(study: Study, place: Place) -> tuple[str, str] | None:
    """Whether a place is of the vehicle or of the road, and what it is called there; None if of neither."""
    names = {
        "vehicle": {f.key: ("vehicle", f.name) for f in fields_of(VEHICLES[study.model])},
        "road": {f.key: ("road", f.name) for f in ROAD},
        "elements": {name: ("vehicle", name) for name in study.elements},
    }
    return names.get(place.section, {}).get(place.key)


def condition_of(study: Study, stated: StudyCondition) -> Condition:
    """What a method takes."""
    changed: dict[str, dict[str, float]] = {"vehicle": {}, "road": {}}
    for label, number in stated.numbers.items():
        found = _section(study, place_of(label))
        assert found is not None, label
        changed[found[0]][found[1]] = number
    name = stated.name or ", ".join(f"{label} = {shown(number)}" for label, number in stated.numbers.items())
    return Condition(stated.share, changed["vehicle"], changed["road"], name)
