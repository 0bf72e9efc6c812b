"""Sweeps and conditions of a study file: the values that places take, or what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import prod
from typing import Any

import numpy as np

from inerter.files.common.entries import MOST_POINTS, check_ascending, quantity_text
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError, Problem, at, collect_problem, invalid_entry
from inerter.files.common.suggest import nearest, some
from inerter.files.study.conditions import StudyCondition, condition_labels, following, what_of
from inerter.files.study.limits import limit_words
from inerter.files.study.place import Place, Sweep, element_at, place_of
from inerter.files.study.places import number_at, with_numbers
from inerter.files.study.sections import SweepRange
from inerter.files.study.study import Study, elements_used
from inerter.networks.elements import Free, Tied
from inerter.units import are_compatible, is_unit_for, parse_quantity, quote_value, unit_in

Entry = SweepRange | tuple[str, ...]
_MOST = 2  # places at once: what a map shows
_PLACE, _CONDITIONS = ("study", "sweep"), "conditions"


def sweeps_of(study: Study, entries: Mapping[str, Entry]) -> tuple[tuple[Sweep, ...], list[Problem]]:
    """Sweeps of the study from the entries of the file, and the problems of the entries."""
    if not 1 <= len(entries) <= _MOST:
        got = f"{len(entries)} swept elements ({', '.join(map(quote_value, entries)) or 'none'})"
        return (), [at(_PLACE, got=got, expected="exactly one, or two for a map")]
    sweeps: list[Sweep] = []
    problems: list[Problem] = []
    for name, entry in entries.items():
        with collect_problem(problems, (*_PLACE, name)):
            sweep = _sweep(study, place_of(name), entry)
            for value in (min(sweep.values), max(sweep.values)):
                with_numbers(study, [(sweep.place, value)])
            sweeps.append(sweep)
    if len({sweep.place for sweep in sweeps}) < len(sweeps):
        problems.append(at(_PLACE, got=f"{sweeps[0].label} twice", expected="two different key paths"))
    if (points := prod(len(sweep.values) for sweep in sweeps)) > MOST_POINTS:
        problems.append(at(_PLACE, got=f"{points} points", expected=f"at most {MOST_POINTS} in all"))
    return tuple(sweeps), problems


def number_of(study: Study, place: Place) -> Number:
    """Number at a swept place; raises `EntryError` where there is none that can."""
    number, element = number_at(study, place), element_at(place)
    if number is None:
        raise unknown_place(study, place)
    if isinstance(number.value, Free | Tied):
        fault = f"{place.label} is {'free' if isinstance(number.value, Free) else 'tied to others'}"
        raise EntryError(fault=fault, expected="a number with a fixed value", hint="Fix it, or leave this out.")
    if element and element not in elements_used(study):
        unused = f"{element} is in no layout, so a sweep changes nothing"
        raise EntryError(fault=unused, expected="an element that a layout uses")
    return number


def unknown_place(study: Study, place: Place) -> EntryError:
    """Error for a place without a number, with the nearest known place as a hint."""
    if element_at(place) in study.free_networks:
        return invalid_entry(place.label, fault="a free network has no value", expected="an element or another number")
    if element_at(place) == place.key:
        missing = f"{quote_value(place.key)} is not in [elements]; available: {some(study.elements)}"
        return EntryError(fault=missing, hint=nearest(place.key, study.numbers))
    expected = "a key path such as road.speed or vehicle.sprung_mass, or an element"
    hint = nearest(place.label, study.numbers)
    return EntryError(fault=f"this study has no number at {place.label}", expected=expected, hint=hint)


def _sweep(study: Study, place: Place, entry: Entry) -> Sweep:
    number = number_of(study, place)
    texts = (entry.lower, entry.upper) if isinstance(entry, SweepRange) else entry
    _check_units(place, number, texts)
    values = tuple(value_of(number, text) for text in texts)
    if isinstance(entry, SweepRange):
        values = _spread(number, entry, *values)
    elif len(set(values)) < len(values):
        raise EntryError(got="the same value more than once", expected="each once")
    units = set(map(unit_in, texts))
    words = next((limit_words(study, one) for one in study.limits if one.place == place.label), number.words)
    return Sweep(place, values, number.unit, words, units.pop() if len(units) == 1 else "")


def _check_units(place: Place, number: Number, texts: tuple[str, ...]) -> None:
    given = dict.fromkeys(map(unit_in, texts))
    alike = [is_unit_for(unit, number.unit) for unit in given]
    if all(alike):
        return
    if any(alike) or not all(are_compatible(unit, next(iter(given))) for unit in given):
        raise EntryError(got=f"values of unlike units, {', '.join(sorted(given))}", expected="one")
    other = f"{place.label} is in {number.unit}"
    raise EntryError(got=f"values in {', '.join(given)}", fault=other, expected=f"the unit of {place.label}")


def value_of(number: Number, text: str) -> float:
    """Value [SI] of a text for the number at a place; raises `UnitError`, or `EntryError` if it is not possible."""
    value = parse_quantity(text, number.unit)
    if (value < 0.0 and not number.signed) or (value == 0.0 and not number.may_vanish):
        raise invalid_entry(text, fault="not positive", expected=f"more than 0 {number.unit}")
    return value


def _spread(number: Number, entry: SweepRange, low: float, high: float) -> tuple[float, ...]:
    """Values from one end to the other."""
    check_ascending(low, high, number.unit, "Give them apart.")
    if entry.spacing == "log" and low == 0.0:
        wanted = 'from greater than zero, or spacing = "linear"'
        raise EntryError(got='spacing = "log" from zero', expected=wanted)
    space = np.geomspace if entry.spacing == "log" else np.linspace
    return tuple(float(value) for value in space(low, high, entry.points))


def conditions_of(study: Study, entries: Sequence[Any]) -> tuple[tuple[StudyCondition, ...], list[Problem]]:
    """The conditions that a file states, and what is wrong with them."""
    conditions: list[StudyCondition] = []
    problems: list[Problem] = []
    for i, entry in enumerate(entries, start=1):
        numbers = {}
        for label, given in entry.numbers.items():
            where = (f"{_CONDITIONS}[{i}]", label)
            with collect_problem(problems, where):
                place = place_of(label)
                numbers[place.label] = _number(study, place, given)
                problems += _not_followed(study, where, {place.label: numbers[place.label]})
        conditions.append(StudyCondition(numbers, entry.share, entry.name or ""))
    labels = condition_labels(conditions)
    for i, condition in enumerate(conditions, start=1):
        unnamed = [label for one, label in zip(conditions[i:], labels[i:], strict=True) if not one.name]
        if condition.name in [*labels[: i - 1], *unnamed]:
            got = f"{condition.name!r}, the name of another condition"
            problems.append(at((f"{_CONDITIONS}[{i}]", "name"), got=got, expected="a different name"))
    for i, condition in enumerate(conditions, start=1):
        for label in condition.numbers.keys() & study.swept_labels:
            both = f"{label} is swept, and in a condition"
            problems.append(at((f"{_CONDITIONS}[{i}]", label), fault=both, expected="one of the two"))
    return tuple(conditions), problems


def _not_followed(study: Study, where: tuple[str, ...], number: Mapping[str, float]) -> Iterator[Problem]:
    """Problems of elements that depend both on a number of a condition and on design variables."""
    for name, element in following(study, number).items():
        if isinstance(element.value, Tied):
            fault = f"{name} depends on it and on a design variable"
            yield at(where, fault=fault, expected="an element on which no tied value depends")


def _number(study: Study, place: Place, given: Any) -> float:
    number = number_of(study, place)
    if what_of(study, place) is None:
        raise EntryError(
            got=place.label,
            fault="not what a condition can change",
            expected="a number of the vehicle or the road, or the value of an element",
        )
    return value_of(number, quantity_text(given))
