"""Problems of settings and elements in a study file that a method does not support or does not use."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from inerter.errors import with_article
from inerter.field_metadata import Field, fields_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import some
from inerter.files.study.place import element_at, place_of
from inerter.files.study.study import Study, elements_used
from inerter.indices.registry import INDICES, amplitude_of, as_line, index_settings
from inerter.methods.registry import (
    averages,
    is_blind,
    methods_that,
    missing_settings,
    needs_amplitude,
    refuses_gaps,
    simulating_method,
)
from inerter.units import quote_value


def method_problems(study: Study) -> Iterator[Problem]:
    """Problems of the methods of a study; a swept setting counts as given."""
    yield from _unseen_numbers(study)
    study = study.at([sweep.values[0] for sweep in study.sweeps])
    yield from _road_problems(study)
    yield from _index_problems(study)
    yield from _own_problems(study)
    if study.nonlinear_parts:
        yield from _force_problems(study)
        yield from _gap_problems(study)


def _road_problems(study: Study) -> Iterator[Problem]:
    given = [name for name in ("realisations", "relative_error") if getattr(study, name) is not None]
    if len(given) == 2:
        yield at(
            ("study", "relative_error"),
            got=f"{study.relative_error} together with realisations = {study.realisations}",
            expected="one of the two: the number of roads, or the standard error to be reached",
        )
    elif given and not any(map(averages, study.methods)):
        yield at(
            ("study", given[0]),
            fault="no method averages over roads",
            expected=f"{_either(methods_that(averages))} in evaluate, or no {given[0]}",
        )


def _index_problems(study: Study) -> Iterator[Problem]:
    """Problems of index settings that no index in `indices` uses."""
    for key in study.settings:
        is_amplitude = any(isinstance(own := amplitude_of(symbol), Field) and own.key == key for symbol in INDICES)
        field = index_settings()[key]
        owners = [symbol for symbol, kind in INDICES.items() if key in {own.key for own in fields_of(kind)}]
        asked = set(owners) & set(map(study.symbol, study.indices))
        what, there = f"the {field.in_words} of {_either(owners, str)}", _either(owners)
        if is_amplitude and not (asked and any(map(needs_amplitude, study.methods))):
            yield at(
                ("study", key),
                fault=f"{what} for {_either(methods_that(needs_amplitude))}",
                expected=f"{there} in indices and one of them in evaluate, or no {key}",
            )
        elif not asked:
            wanted = f"{there} there, or no {key}"
            yield at(("study", key), fault=f"{what}, which is not in indices", expected=wanted)


def _own_problems(study: Study) -> Iterator[Problem]:
    """Problems of method settings that no method in use has, and of missing ones."""
    for name, given in study.method_settings.items():
        if name not in study.methods:
            yield at(
                ("methods", name),
                fault=f"{some(given)} of {quote_value(name)}, which is neither in optimise nor in evaluate",
                expected=f"{quote_value(name)} in one of them, or no section for it",
            )
    for name in study.methods:
        for field in missing_settings(name, study.method_settings.get(name, {})):
            example = f'{field.key} = "{field.example}"'
            yield at(("methods", name, field.key), fault="missing", expected=example, hint=field.sentence)


def _force_problems(study: Study) -> Iterator[Problem]:
    """Problems of missing amplitudes."""
    concerned = [method for method in study.methods if needs_amplitude(method)]
    for symbol in study.indices if concerned else ():
        field = amplitude_of(study.symbol(symbol))
        if field is not None and field.key not in study.settings_of(symbol):
            nonlinear = some(_layouts_with(study, study.nonlinear_parts))
            yield at(
                ("study", field.key) if isinstance(field, Field) else ("indices", symbol, field.key),
                fault=f"missing, but {concerned[0]} takes {symbol} of {nonlinear}, where friction or gaps make "
                f"it depend on the size of the {'force' if isinstance(field, Field) else 'input'}",
                expected=f"its amplitude, such as {as_line(field)}",
            )


def _gap_problems(study: Study) -> Iterator[Problem]:
    """Problem of a method that supports no element such as a gap, which no damper represents."""
    refusing = next(filter(refuses_gaps, study.methods), None)
    parts = [(name, part) for name, own in study.nonlinear_parts.items() for part in own]
    refused = [(name, part.key) for name, part in parts if part.acts and not part.is_damped]
    if refusing is not None and refused:
        kinds, layouts = dict.fromkeys(key for _, key in refused), _layouts_with(study, [name for name, _ in refused])
        yield at(
            ("study", "optimise" if study.optimise == refusing else "evaluate"),
            got=quote_value(refusing),
            fault=f"it has no answer for {' or '.join(map(with_article, kinds))}, as in {some(layouts)}",
            expected=f"another method, such as {quote_value(simulating_method())}, or layouts without",
        )


def _unseen_numbers(study: Study) -> Iterator[Problem]:
    """Swept numbers and those of conditions that change nothing in linear analysis."""
    for sweep in study.sweeps:
        yield from unseen_problem(study, ("study", "sweep", sweep.label), element_at(sweep.place))
    for number, condition in enumerate(study.conditions, start=1):
        for label in condition.numbers:
            yield from unseen_problem(study, (f"conditions[{number}]", label), element_at(place_of(label)))


def unseen_problem(study: Study, place: tuple[str, ...], name: str) -> Iterator[Problem]:
    """Problem of an element that is analysed but that every method of `evaluate` neglects."""
    element = study.elements.get(name)
    if element is not None and element.switch is not None and all(map(is_blind, study.evaluate)):
        yield at(
            place,
            fault=f"{name} is a {element.key} element, which linear analysis neglects",
            expected=f"a method that models it in evaluate, such as {quote_value(simulating_method())}",
        )


def _layouts_with(study: Study, elements: Iterable[str]) -> list[str]:
    """Layouts that contain one of these elements, each of which some layout does."""
    used = elements_used(study)
    concerned = {layout for name in elements for layout in used[name]}
    return [layout for layout in study.layouts if layout in concerned]


def _either(words: Iterable[str], write: Callable[[str], str] = quote_value) -> str:
    return " or ".join(map(write, words))
