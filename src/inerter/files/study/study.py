"""A study, resolved and checked: SI values, networks by name, and what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.errors import NetworkError, StudyError
from inerter.files.common.layouts import StrutLayout, in_si
from inerter.files.common.problem import EntryError
from inerter.files.common.suggest import nearest
from inerter.files.common.told_kind import entry_of
from inerter.files.common.toml import as_toml
from inerter.networks.elements import Element
from inerter.networks.parser import names
from inerter.signals.road import Road
from inerter.vehicle.cars import HalfCar, QuarterCar, Rig


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
    vehicle: dict[str, float]
    road: Road
    elements: dict[str, Element]  # a free element's value is named after its key, so that it is one variable
    layouts: dict[str, StrutLayout]
    indices: tuple[str, ...]
    conventions: str = "exact"
    optimise: str | None = None
    evaluate: tuple[str, ...] = ("norm",)
    baseline: str | None = None  # the layout that the others are compared with; None if there is but one
    sweep: Sweep | None = None
    seed: int = 0
    high_pass: float | None = None  # corner of the filter of J3 [rad/s]
    realisations: int | None = None  # random roads of methods that average; None: as many as they like
    relative_error: float | None = None  # or as many as this needs
    force: float | None = None  # amplitude of the sinusoidal force of J5 [N]
    budgets: tuple[str, ...] = ()  # elements, each for which values a layout is better than the baseline

    @property
    def methods(self) -> tuple[str, ...]:
        """All methods that it uses."""
        return tuple(dict.fromkeys([*([self.optimise] if self.optimise else []), *self.evaluate]))

    def design(self, layout: str, swept: float | None = None) -> QuarterCar | HalfCar | Rig:
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
            "vehicle": {"model": self.model, **{key: in_si(key, value) for key, value in self.vehicle.items()}},
            "road": {key: in_si(key, getattr(self.road, key)) for key in ("speed", "roughness")},
            "elements": {name: entry_of(element) for name, element in self.elements.items()},
            "layouts": {name: layout.entry() for name, layout in self.layouts.items()},
            "study": self._settings(),
        }

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
            "high_pass": None if self.high_pass is None else in_si("high_pass", self.high_pass),
            "realisations": self.realisations,
            "relative_error": self.relative_error,
            "force": None if self.force is None else in_si("force", self.force),
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
