"""What is wrong with how a study file asks for its numbers: settings and elements that a method cannot do with."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from inerter.files.common.problem import Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.study.shape import AVERAGING, FORCED
from inerter.files.study.study import Study, elements_used
from inerter.networks.elements import Element
from inerter.networks.elements.roles import Statistical
from inerter.systems.graph import switching_parts
from inerter.units import shown

_BLIND = "norm"  # the method that sees neither friction nor gaps
_NO_GAPS = "statistical-linearisation"


def method_problems(study: Study) -> Iterator[Problem]:
    """One line for each."""
    yield from _road_problems(study)
    yield from _force_problems(study)
    yield from _gap_problems(study)
    yield from _budget_problems(study)


def budget_method(study: Study) -> str:
    """The first method of `evaluate` that sees friction, else the first."""
    return next((method for method in study.evaluate if method != _BLIND), study.evaluate[0])


def _road_problems(study: Study) -> Iterator[Problem]:
    given = [name for name in ("realisations", "relative_error") if getattr(study, name) is not None]
    if len(given) == 2:
        yield at(
            ("study", "relative_error"),
            got=f"{study.relative_error} beside realisations = {study.realisations}",
            expected="one of the two: how many roads, or how small an error they must reach",
        )
    elif given and not set(AVERAGING) & set(study.methods):
        yield at(
            ("study", given[0]),
            fault="no method averages over roads",
            expected=f"{_either(AVERAGING)} in evaluate, or no {given[0]}",
        )


def _force_problems(study: Study) -> Iterator[Problem]:
    concerned = [method for method in study.methods if method in FORCED] if "J5" in study.indices else []
    nonlinear = _layouts_with(study, lambda part: part.switch is not None)
    if study.force is None and concerned and nonlinear:
        yield at(
            ("study", "force"),
            fault=f"missing, but {concerned[0]} takes J5 of {some(nonlinear)}, where friction or gaps make it depend "
            f"on the size of the force",
            expected='its amplitude, such as force = "1 kN"',
        )
    if study.force is not None and not concerned:
        yield at(
            ("study", "force"),
            fault=f"the amplitude of the force of J5 for {_either(FORCED)}",
            expected='"J5" in indices and one of them in evaluate, or no force',
        )


def _gap_problems(study: Study) -> Iterator[Problem]:
    gaps = _layouts_with(study, lambda part: part.statistical is Statistical.REFUSED)
    key = "optimise" if study.optimise == _NO_GAPS else "evaluate"
    if _NO_GAPS in study.methods and gaps:
        yield at(
            ("study", key),
            got=shown(_NO_GAPS),
            fault=f"it has no answer for gaps, and {some(gaps)} has one",
            expected=f"another method, such as {shown(AVERAGING[0])}, or layouts without gaps",
        )


def _budget_problems(study: Study) -> Iterator[Problem]:
    place = ("study", "budgets")
    if study.budgets and study.sweep is not None:
        yield at(place, fault="given beside a sweep", expected="one of the two")
    if study.budgets and study.baseline is None:
        yield at(place, fault="there is but one layout", expected="another to compare it with, or no budgets")
        return
    used = elements_used(study)
    for name in study.budgets:
        if name not in study.elements:
            missing = f"{shown(name)} is not in [elements], where there are {some(study.elements)}"
            yield at(place, fault=missing, hint=nearest(name, study.elements))
        elif not set(used.get(name, ())) - {study.baseline}:
            only = f"no layout but the baseline has {name}"
            yield at(place, fault=only, expected="an element of a layout that is compared")
        elif study.elements[name].switch is not None and budget_method(study) == _BLIND:
            yield at(
                place,
                fault=f"{name} is a {study.elements[name].key}, which linear analysis does not see",
                expected=f"a method that does in evaluate, such as {shown(AVERAGING[0])}",
            )


def _layouts_with(study: Study, wanted: Callable[[Element], bool]) -> list[str]:
    """The layouts with an element of which simulation takes such a part."""
    having = {n for n, element in study.elements.items() if any(map(wanted, switching_parts(element)))}
    concerned = {layout for n, layouts in elements_used(study).items() if n in having for layout in layouts}
    return [layout for layout in study.layouts if layout in concerned]


def _either(words: tuple[str, ...]) -> str:
    return " or ".join(shown(word) for word in words)
