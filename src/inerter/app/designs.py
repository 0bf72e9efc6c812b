"""The designs that a request is about: layouts of a study with a value for everything that is free."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import isfinite, sqrt
from typing import Any

from inerter.errors import DesignError
from inerter.files.study.limits import limits_in
from inerter.files.study.study import Study
from inerter.methods.composite_index import IndexLike
from inerter.networks.elements import Free
from inerter.units import parse_quantity, quote_value
from inerter.vehicle.mechanism import Mechanism
from inerter.vehicle.vehicle import Vehicle

Values = Mapping[str, "str | float"]
_NAME = re.compile(r"'(\w+)'")
_KEPT = 500  # designs, and digests of problems


@dataclass(frozen=True)
class Design:
    """A layout with numbers only."""

    study: Study = field(compare=False, repr=False)  # that it is of, and that says what is asked of it
    name: str = field(compare=False)
    layout: str = field(compare=False)
    vehicle: Vehicle
    values: dict[str, float] = field(compare=False)  # of what was free, in SI units
    unchosen: tuple[str, ...] = field(default=(), compare=False)  # of these, what nobody gave a value
    free: dict[str, Free] = field(default_factory=dict, compare=False, repr=False)  # bounds of what was free

    @cached_property
    def mechanism(self) -> Mechanism:
        """Mechanism of the design's vehicle."""
        return self.vehicle.mechanism()

    @cached_property
    def fixed_study(self) -> Study:
        """Study with the design variables replaced by the values of the design."""
        return self.study.with_values(self.values)

    def resolve_index(self, index: str) -> IndexLike:
        """Objective of the design's layout for an index of its study."""
        return self.study.resolve_index(index, self.layout)

    def describe_values(self) -> dict[str, Any]:
        """Name, layout, values with units, and design variables at default values, for an answer."""
        units = self.study.free_units
        values = {
            name: {"value": value, "unit": units[name], "text": f"{value!r} {units[name]}"}
            for name, value in self.values.items()
        }
        return {"name": self.name, "layout": self.layout, "values": values, "unchosen": list(self.unchosen)}


def design_of(study: Study, layout: str, values: Values, name: str = "") -> Design:
    """Design of a layout at these values; an omitted design variable takes the geometric mean of its bounds.

    Raises `StudyError` for an unknown layout, `DesignError` for a value of no element, or one that is not positive;
    `UnitError` for a text that is no quantity of the element.
    """
    vehicle = study.design(layout)
    units = study.free_units
    for key in values:
        if key not in study.elements and key not in units:
            known = ", ".join(dict.fromkeys([*study.elements, *units]))
            raise DesignError(f"Got a value of {quote_value(key)}, which is not in [elements]; available: {known}.")
    all_free = vehicle.free_values()
    chosen = {
        key: _number(key, values[key], units[key]) if key in values else _middle(free) for key, free in all_free.items()
    }
    unchosen = tuple(key for key in all_free if key not in values)
    return Design(study, name or layout, layout, vehicle.with_values(chosen), chosen, unchosen, all_free)


@dataclass(frozen=True, eq=False)
class _SameStudy:
    """A study as a key: equal to itself alone, which a study that requests share is."""

    study: Study

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SameStudy) and self.study is other.study

    def __hash__(self) -> int:
        return id(self.study)


def given_design(study: Study, given: Mapping[str, Any]) -> Design:
    """Design that a request gives by its layout, values and name; raises what `design_of` raises."""
    values = tuple((given.get("values") or {}).items())
    return _given_design(_SameStudy(study), given["layout"], values, given.get("name") or "")


@lru_cache(_KEPT)  # a step of a slider leaves most designs as they were
def _given_design(of: _SameStudy, layout: str, values: tuple[tuple[str, Any], ...], name: str) -> Design:
    return design_of(of.study, layout, dict(values), name)


def describe_index(study: Study, index: str) -> dict[str, str]:
    """Name, title and unit of an index for an answer."""
    return {"index": index, "title": study.index(index).title, "unit": study.unit(index)}


def problem_digest(study: Study, layout: str, index: str) -> str:
    """Digest of the problem that an optimum of a layout solves; empty without a design variable.

    It depends on vehicle, network, bounds, objective and limits, and not on the names of elements.
    """
    return _problem_digest(_SameStudy(study), layout, index)


@lru_cache(_KEPT)
def _problem_digest(of: _SameStudy, layout: str, index: str) -> str:
    study = of.study
    vehicle = study.design(layout)
    if not vehicle.free_values():
        return ""
    numbers: dict[str, str] = {}

    def number_of(name: re.Match[str]) -> str:
        return numbers.setdefault(name[1], f"#{len(numbers)}") if name[1] in study.elements else name[0]

    problem = repr((vehicle, study.resolve_index(index, layout), limits_in(study, layout)))
    return hashlib.sha256(_NAME.sub(number_of, problem).encode()).hexdigest()[:16]


def designs_of(study: Study, body: Mapping[str, Any]) -> list[Design]:
    """The `designs` of a request, or its `layouts` (all, if they are left out) with the `values` of each.

    Raises `DesignError` for a design of another study.
    """
    if body.get("designs"):
        if other := [d.get("name") or d["layout"] for d in body["designs"] if d.get("study")]:
            raise DesignError(
                f"Got {quote_value(other[0])}, a design of another study, which only the panel compare accepts."
            )
        return [given_design(study, given) for given in body["designs"]]
    return [_layout_design(study, body, layout) for layout in body.get("layouts") or study.layouts]


def one_design(study: Study, body: Mapping[str, Any]) -> Design:
    """Single design of a request: its `design`, or its `layout` at the `values` of that layout."""
    given = body.get("design")
    if given:
        return given_design(study, given)
    return _layout_design(study, body, body.get("layout") or next(iter(study.layouts)))


def baseline_of(study: Study, body: Mapping[str, Any], designs: Sequence[Design]) -> Design | None:
    """Baseline of a request: its `baseline`, else the study's among `designs`, else the study's at the given `values`.

    None if neither the request nor the study has a baseline.
    """
    given = body.get("baseline")
    if given:
        return given_design(study, given)
    if study.baseline is None:
        return None
    here = next((design for design in designs if design.layout == study.baseline), None)
    return here or _layout_design(study, body, study.baseline)


def _layout_design(study: Study, body: Mapping[str, Any], layout: str) -> Design:
    """Design of a layout at the `values` that a request gives for it."""
    return design_of(study, layout, (body.get("values") or {}).get(layout) or {})


def _number(name: str, given: str | float, unit: str) -> float:
    value = parse_quantity(given, unit) if isinstance(given, str) else float(given)
    if not isfinite(value) or value < 0.0:
        raise DesignError(
            f"The value of {quote_value(name)} must be a positive number of {unit}, got {quote_value(given)}."
        )
    return value


def _middle(free: Free) -> float:
    return sqrt(free.lower * free.upper) if free.lower > 0.0 else 0.5 * free.upper
