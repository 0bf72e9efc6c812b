"""Study, resolved and checked: SI values, networks by name, indices, methods and tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from inerter.deprecation import RenamedAttribute
from inerter.errors import NetworkError, StudyError
from inerter.field_metadata import fields_of
from inerter.files.common.codec import keyed_dataclass
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.number import Number
from inerter.files.common.problem import EntryError
from inerter.files.common.roads import MeasuredLine
from inerter.files.common.suggest import nearest
from inerter.files.study.conditions import StudyCondition, condition_labels, condition_of, what_of
from inerter.files.study.own_indices import OwnIndex
from inerter.files.study.place import ELEMENTS, Place, element_at, place_of
from inerter.files.study.places import free_in_vehicle, places, sections_of, with_numbers
from inerter.files.study.sections import OVER, Settings, study_codec
from inerter.indices.definition import Index
from inerter.indices.names import index_names
from inerter.indices.registry import INDICES, excitation_of, make_index
from inerter.methods.composite_index import IndexLike
from inerter.methods.conditions import Conditions
from inerter.methods.method import Method
from inerter.methods.registry import make_method
from inerter.networks.elements import Element, Free, Tied
from inerter.networks.free_network import FreeNetwork
from inerter.networks.parser import names
from inerter.signals.road import Road
from inerter.systems.graph import switching_parts
from inerter.uncertainty.distributions import DISTRIBUTIONS, scatter_of
from inerter.uncertainty.robust_design import Quantile
from inerter.vehicle.vehicle import Vehicle


@keyed_dataclass
class Study(Settings):
    """Contents of a study file, with defaults. Equal studies may come from different files."""

    title: str
    path: Path = field(compare=False)
    vehicle: dict[str, Any]  # the table, with its model
    road: Road | None  # None if no index needs one
    elements: dict[str, Element]  # a free element's value is named after its key, so that it is one in all layouts
    layouts: dict[str, StrutLayout]
    coherence: dict[str, float] = field(default_factory=dict)  # of the road, as the file says it
    line: MeasuredLine | None = field(default=None, compare=False)  # fitted to a measured profile
    tasks: dict[str, Any] = field(default_factory=dict)  # settings of the tasks that have keys of their own, by task
    settings: dict[str, float] = field(default_factory=dict)  # of indices, by their keys, in SI units
    conditions: tuple[StudyCondition, ...] = ()  # over which indices are taken
    texts: tuple[str, ...] = field(default=(), compare=False, repr=False)  # of the file, which may be quantities
    free_networks: dict[str, FreeNetwork] = field(default_factory=dict)  # among the elements of the file, by name
    own_indices: dict[str, OwnIndex] = field(default_factory=dict)  # by the names that the file gives them
    method_settings: dict[str, dict[str, float]] = field(default_factory=dict)  # by method and key, in SI units

    @property
    def model(self) -> str:
        """Model of the vehicle."""
        return str(self.vehicle["model"])

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of all methods in use, that of the optimisation first."""
        return tuple(dict.fromkeys([*([self.optimise] if self.optimise else []), *self.evaluate]))

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Paths of the files read: the study file, and a measured profile."""
        return (self.path,) if self.line is None else (self.path, self.line.path)

    @property
    def swept_labels(self) -> set[str]:
        """Labels of the swept places."""
        return {sweep.label for sweep in self.sweeps}

    @property
    def varied_labels(self) -> set[str]:
        """Labels of the places at which a sweep or a condition changes the number."""
        return self.swept_labels.union(*(condition.numbers for condition in self.conditions))

    def knows(self, name: str) -> bool:
        """Whether the study or the registry has an index of that name."""
        return name in self.own_indices or name in index_names()

    def symbol(self, name: str) -> str:
        """Symbol of the index of that name; raises `StudyError` for an unknown one."""
        own = self.own_indices.get(name)
        if not self.knows(name):
            known = [*self.own_indices, *index_names()]
            hint = nearest(name, known)
            raise StudyError(str(EntryError(got=f"index {name!r}", expected=f"one of {', '.join(known)}", hint=hint)))
        return own.symbol if own else index_names()[name]

    def index(self, name: str) -> Index:
        """Index of that name with the settings of the study."""
        if name not in self._made_indices:
            self._made_indices[name] = self._make_index(name)
        return self._made_indices[name]

    @cached_property
    def _made_indices(self) -> dict[str, Index]:
        """Indices by name, as far as they were needed: a page needs each many times for a design."""
        return {}

    def _make_index(self, name: str) -> Index:
        own = self.own_indices.get(name)
        given = {**self.settings_of(name), **own.constructor_arguments(self.road)} if own else self.settings_of(name)
        return make_index(self.symbol(name), self.road, given)

    def needs_road(self, name: str) -> bool:
        """Whether the index of that name is evaluated on the road of the study."""
        own = self.own_indices.get(name)
        return own.needs_road if own else excitation_of(self.symbol(name)) is not None

    def resolve_index(self, name: str, layout: str) -> IndexLike:
        """Objective of a layout for an index: over the conditions, and at the quantile, if the study has them."""
        return self.at_quantile(self.over_conditions(name), layout, self.quantile)

    def at_quantile(self, index: IndexLike, layout: str, share: float | None) -> IndexLike:
        """Quantile of an index over the tolerances of a layout; the index if there are none, or for None."""
        if share is None or not (spread := self.spread(layout)):
            return index
        return Quantile(index, scatter_of(spread, DISTRIBUTIONS[0]), share, seed=self.seed)

    def objective_title(self, name: str) -> str:
        """Title of the index of that name as it is minimised: over the conditions, and at the quantile, if any."""
        scattering_ones = [layout for layout in self.layouts if self.spread(layout)]
        return self.resolve_index(name, next(iter(scattering_ones or self.layouts))).title

    def spread(self, layout: str) -> dict[str, float]:
        """Relative tolerance of each value of a layout that has one, by name."""
        if not self.tolerance:
            return {}
        names, found = scattering(self, layout), {}
        for label, part in self.tolerance.items():
            place = place_of(label)
            known = what_of(self, place)
            if known is not None and element_at(place) in ("", *names):
                found[known[1]] = part
        return found

    def over_conditions(self, name: str) -> IndexLike:
        """Index of that name, combined over the conditions of the study if it has any."""
        index = self.index(name)
        if not self.conditions:
            return index
        use = Conditions([condition_of(self, condition) for condition in self.conditions])
        return use.mean(index) if self.over == OVER[0] else use.worst(index)

    def in_condition(self, number: int) -> Study:
        """Study with the numbers of one of its conditions in place of its own, and without conditions."""
        changed = [(place_of(label), value) for label, value in self.conditions[number].numbers.items()]
        return replace(with_numbers(self, changed), conditions=())

    @property
    def condition_labels(self) -> list[str]:
        """Label of each condition: its name, else its number from 1."""
        return condition_labels(self.conditions)

    def in_each(self, index: IndexLike) -> list[IndexLike]:
        """List of an index in each condition separately; of the index alone without conditions."""
        return [Conditions([condition_of(self, c)]).mean(index) for c in self.conditions] or [index]

    def unit(self, name: str) -> str:
        """SI unit of the index of that name; may depend on the vehicle."""
        index = self.index(name)
        return index.unit or index.definition(self.design(next(iter(self.layouts))).mechanism()).unit

    def settings_of(self, name: str) -> dict[str, Any]:
        """Settings of the index of that name by key; user-defined values override those of the study."""
        own, keys = self.own_indices.get(name), {field.key for field in fields_of(INDICES[self.symbol(name)])}
        shared = {key: value for key, value in self.settings.items() if key in keys}
        return {**shared, **own.settings} if own else shared

    def method(self, name: str, threads: int = 1) -> Method:
        """Method of that name with the settings of the study.

        A method that simulates shares its roads over `threads`, which changes no digit.
        """
        known = ("conventions", "seed", "realisations", "relative_error")
        shared = {**{key: getattr(self, key) for key in known}, "jobs": threads}
        return make_method(name, shared, self.method_settings.get(name, {}))

    def at(self, swept: Sequence[float]) -> Study:
        """The study at one point of its sweeps: with these values in the swept places [SI], in the order of the sweeps.

        Raises `StudyError` unless there are as many values as sweeps; `NetworkError` and others where one of them is
        not a possible value.
        """
        if not swept and not self.sweeps:
            return self
        if not self.sweeps:
            values = ", ".join(map(repr, swept))
            raise StudyError(f"Got a swept value, {values}, but this study has no sweep. Add one, or leave it out.")
        if len(swept) != len(self.sweeps):
            places = ", ".join(sweep.label for sweep in self.sweeps)
            raise StudyError(f"Got {len(swept)} swept values for {places}. Give one for each.")
        found = with_numbers(self, zip((sweep.place for sweep in self.sweeps), swept, strict=True))
        return replace(found, sweeps=())

    def design(self, layout: str, *swept: float) -> Vehicle:
        """The vehicle with the struts of `layout`; `swept` are values of the swept places, as in `at`.

        Raises `StudyError` for an unknown layout, or for values where nothing is swept; `NetworkError` where one of
        them is not possible.
        """
        if layout not in self.layouts:
            known = ", ".join(self.layouts)
            hint = nearest(layout, self.layouts)
            raise StudyError(str(EntryError(got=f"layout {layout!r}", expected=f"one of {known}", hint=hint)))
        if swept:
            return self.at(swept).design(layout)
        if layout not in self._made_designs:
            self._made_designs[layout] = self.layouts[layout].design(self.vehicle, self.elements, self.free_networks)
        return self._made_designs[layout]

    @cached_property
    def _made_designs(self) -> dict[str, Vehicle]:
        """Designs by layout, as far as they were needed: checks, results and reports need each many times."""
        return {}

    @cached_property
    def nonlinear_parts(self) -> dict[str, list[Element]]:
        """Frictions and gaps in a simulation of each element in layouts, by its name; only of elements with any."""
        used = [name for name in elements_used(self) if name in self.elements]
        parts = {name: [one for one in switching_parts(self.elements[name]) if one.switch is not None] for name in used}
        return {name: own for name, own in parts.items() if own}

    @cached_property
    def numbers(self) -> dict[str, Number]:
        """All numbers of the study by the labels of their places, in the order of the file."""
        return places(self)

    @cached_property
    def free_units(self) -> dict[str, str]:
        """The unit of each free value that some layout has, by name: elements, then numbers of the vehicle."""
        used = elements_used(self)
        elements = {name: e.unit for name, e in self.elements.items() if name in used and isinstance(e.value, Free)}
        return elements | {name: number.unit for name, (_, number) in free_in_vehicle(self).items()}

    def with_values(self, values: Mapping[str, float]) -> Study:
        """Study with the design variables replaced by these values [SI], by name."""
        in_vehicle = {name: place for name, (place, _) in free_in_vehicle(self).items()}
        found = {name: Place(ELEMENTS, name) if name in self.elements else in_vehicle[name] for name in values}
        return with_numbers(self, [(place, values[name]) for name, place in found.items()])

    def to_tables(self) -> dict[str, Any]:
        """The study as a study file says it: plain tables, every default filled in, every quantity in SI units.

        Two studies that ask the same of the same vehicle have the same dictionary, wherever their files are.
        """
        return study_codec().dump(sections_of(self))

    resolved = RenamedAttribute("to_tables")


def elements_used(study: Study) -> dict[str, list[str]]:
    """Elements in layouts, each with the layouts that contain it or an element tied to it."""
    used: dict[str, list[str]] = {}
    for layout, struts in study.layouts.items():
        named = [name for text in struts.struts.values() for name in element_names(text)]
        for element in dict.fromkeys([*named, *(other for name in named for other in _tied_names(study, name))]):
            used.setdefault(element, []).append(layout)
    return used


def searched_layouts(study: Study) -> dict[str, list[str]]:
    """Layouts with free networks, which `search` chooses, and the names of those."""
    found: dict[str, list[str]] = {}
    for name, layouts in elements_used(study).items():
        for layout in layouts if name in study.free_networks else ():
            found.setdefault(layout, []).append(name)
    return found


def scattering(study: Study, layout: str) -> set[str]:
    """Names of the elements in the networks of a layout, which can have tolerances."""
    return {name for text in study.layouts[layout].struts.values() for name in element_names(text)}


def _tied_names(study: Study, name: str) -> tuple[str, ...]:
    """Names of the elements on which a tied element depends; empty if it is not tied."""
    value = study.elements[name].value if name in study.elements else None
    return value.names if isinstance(value, Tied) else ()


def element_names(expression: str) -> tuple[str, ...]:
    """Names of the elements in the expression of a network; none if it is invalid."""
    try:
        return names(expression)
    except NetworkError:  # reported with its layout
        return ()
