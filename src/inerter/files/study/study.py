"""A study, resolved and checked: SI values, networks by name, and what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.errors import NetworkError, StudyError
from inerter.files.common.kind_entry import entry_of
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.problem import EntryError
from inerter.files.common.shape import ROAD
from inerter.files.common.suggest import nearest
from inerter.files.common.toml import as_toml
from inerter.files.common.vehicles import in_si, vehicle_entry
from inerter.indices.question import Index
from inerter.indices.registry import index_settings, make_index
from inerter.methods.method import Method
from inerter.methods.registry import DEFAULT, make_method, method_settings
from inerter.networks.elements import Element
from inerter.networks.parser import names
from inerter.signals.road import Road
from inerter.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class Sweep:
    """The values that one element takes in turn, in the SI unit of the element."""

    element: str
    values: tuple[float, ...]
    unit: str


@dataclass(frozen=True)
class Study:
    """All that a study file says, with defaults filled in. Equal studies may come from different files."""

    title: str
    path: Path = field(compare=False)
    model: str
    vehicle: dict[str, Any]
    road: Road | None  # of indices that are asked on one
    elements: dict[str, Element]  # a free element's value is named after its key, so that it is one variable
    layouts: dict[str, StrutLayout]
    indices: tuple[str, ...]
    conventions: str = "exact"
    optimise: str | None = None
    evaluate: tuple[str, ...] = (DEFAULT,)
    baseline: str | None = None  # the layout that the others are compared with; None if there is but one
    sweep: Sweep | None = None
    seed: int = 0
    realisations: int | None = None  # random roads of methods that average; None: as many as they like
    relative_error: float | None = None  # or as many as this needs
    settings: dict[str, float] = field(default_factory=dict)  # of indices, by their keys, in SI units
    method_settings: dict[str, dict[str, float]] = field(default_factory=dict)  # by method and key, in SI units
    budgets: tuple[str, ...] = ()  # elements, each for which values a layout is better than the baseline

    @property
    def methods(self) -> tuple[str, ...]:
        """All methods that it uses."""
        return tuple(dict.fromkeys([*([self.optimise] if self.optimise else []), *self.evaluate]))

    def index(self, symbol: str) -> Index:
        """The index of that symbol as the study asks it."""
        return make_index(symbol, self.road, self.settings)

    def method(self, name: str, threads: int = 1) -> Method:
        """The method of that name as the study asks it; one that simulates shares its roads over `threads`, which
        changes no digit.
        """
        known = ("conventions", "seed", "realisations", "relative_error")
        shared = {**{key: getattr(self, key) for key in known}, "jobs": threads}
        return make_method(name, shared, self.method_settings.get(name, {}))

    def design(self, layout: str, swept: float | None = None) -> Vehicle:
        """The vehicle with the struts of `layout`; `swept` replaces the value of the swept element [its SI unit].

        Raises `StudyError` for an unknown layout, or for `swept` where nothing is swept; `NetworkError` where `swept`
        is not a possible value.
        """
        if layout not in self.layouts:
            known = ", ".join(self.layouts)
            hint = nearest(layout, self.layouts)
            raise StudyError(str(EntryError(got=f"layout {layout!r}", expected=f"one of {known}", hint=hint)))
        elements = dict(self.elements)
        if swept is not None:
            if self.sweep is None:
                raise StudyError(
                    f"Got a swept value, {swept!r}, but this study has no sweep. Add one, or leave it out."
                )
            elements[self.sweep.element] = elements[self.sweep.element].with_value(swept)
        return self.layouts[layout].design(self.model, self.vehicle, elements)

    def resolved(self) -> dict[str, Any]:
        """The study as a study file says it: plain tables, every default filled in, every quantity in SI units.

        Two studies that ask the same of the same vehicle have the same dictionary, wherever their files are.
        """
        return {
            "title": self.title,
            "vehicle": vehicle_entry(self.model, self.vehicle),
            **({"road": self._road()} if self.road else {}),
            "elements": {name: entry_of(element) for name, element in self.elements.items()},
            "layouts": {name: layout.entry() for name, layout in self.layouts.items()},
            "study": self._settings(),
            **({"methods": own} if (own := self._of_methods()) else {}),
        }

    def _road(self) -> dict[str, str]:
        return in_si(ROAD, {f.key: getattr(self.road, f.key) for f in ROAD})

    def _of_methods(self) -> dict[str, Any]:
        return {name: in_si(method_settings(name), given) for name, given in self.method_settings.items()}

    def _settings(self) -> dict[str, Any]:
        sweep = self.sweep
        settings = {
            "indices": list(self.indices),
            "conventions": self.conventions,
            "optimise": self.optimise,
            "evaluate": list(self.evaluate),
            "baseline": self.baseline,
            "sweep": None if sweep is None else {sweep.element: [f"{v!r} {sweep.unit}" for v in sweep.values]},
            "seed": self.seed,
            "realisations": self.realisations,
            "relative_error": self.relative_error,
            **in_si(index_settings().values(), self.settings),
            "budgets": list(self.budgets) or None,
        }
        return {key: value for key, value in settings.items() if value is not None}


def elements_used(study: Study) -> dict[str, list[str]]:
    """The elements in layouts, each with the layouts that it is in."""
    used: dict[str, list[str]] = {}
    for layout, struts in study.layouts.items():
        for element in dict.fromkeys(name for text in struts.struts.values() for name in _names(text)):
            used.setdefault(element, []).append(layout)
    return used


def _names(expression: str) -> tuple[str, ...]:
    try:
        return names(expression)
    except NetworkError:  # reported with its layout
        return ()


def write_resolved(study: Study) -> str:
    """`study.resolved()` as TOML. `load_study` reads an equal study from it, to the last bit of every value."""
    return as_toml(study.resolved())
