"""Properties of a study that a decision is about: its goal in words, the method, neglected elements, active bounds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isclose

from inerter.decision.results import AtBound
from inerter.files.study.limits import limit_text
from inerter.files.study.sections import OVER
from inerter.files.study.study import Study
from inerter.formatting import format_list, format_quantity, format_share
from inerter.indices.names import title_with_name
from inerter.methods.method import NonlinearitySupport
from inerter.methods.registry import brief_words_of, is_blind, nonlinearities_of, simulating_method
from inerter.networks.elements import Free, Inerter
from inerter.systems.graph import switching_parts
from inerter.vehicle.mechanism import Mechanism

_AT_BOUND = 1e-6  # relative distance to a bound


def decisive_method(methods: Sequence[str]) -> str:
    """First of the methods that models friction, else the first."""
    return next((method for method in methods if not is_blind(method)), methods[0])


def remedy_of(method: str) -> str:
    """Name of a method that models what this one neglects; empty if it neglects nothing."""
    return "" if nonlinearities_of(method) is NonlinearitySupport.BOTH else simulating_method()


def goal_sentence(study: Study, index: str, method: str) -> str:
    """Goal in words: index, conditions, quantile, limits and method."""
    over = ""
    if study.conditions:
        how = "mean over" if study.over == OVER[0] else "worst of"
        over = f", {how} {len(study.conditions)} operating conditions"
    quantile = (
        "" if study.quantile is None else f", at the {format_share(study.quantile, 4)} quantile of its tolerances"
    )
    within = f", with {format_list([limit_text(study, one) for one in study.limits])}" if study.limits else ""
    what = title_with_name(study.index(index).title, index)
    return f"Lowest {what}{over}{quantile}{within}, by {brief_words_of(method)}."


def nonlinear_elements(mechanism: Mechanism, method: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Friction and gaps of a mechanism that the method models, and those that it neglects, in words."""
    blind = is_blind(method)
    found = dict.fromkeys(
        f"{part.key} {element.label}" if element.label != part.key else part.key
        for element in mechanism.elements()
        for part in switching_parts(element)
        if part.acts
    )
    return ((), tuple(found)) if blind else (tuple(found), ())


def has_inerter(mechanism: Mechanism) -> bool:
    """Whether there is an inerter in the struts."""
    return any(isinstance(element, Inerter) for element in mechanism.strut_elements())


def at_bounds(free: Mapping[str, Free], values: Mapping[str, float], units: Mapping[str, str]) -> Iterator[AtBound]:
    """Design variables whose values are at a bound."""
    for name, one in free.items():
        for bound, end in (("lower", one.lower), ("upper", one.upper)):
            if end > 0.0 and isclose(values[name], end, rel_tol=_AT_BOUND):
                yield AtBound(name, bound, format_quantity(end, units[name]))
