"""A study, resolved and checked: SI values, networks by name, and what is asked of them."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.errors import StudyError
from inerter.networks.elements import Element, Free
from inerter.networks.parser import network
from inerter.signals.road import Road
from inerter.study.schema import UNITS
from inerter.study.suggest import nearest
from inerter.vehicle.cars import HalfCar, QuarterCar

MOUNTS = {"quarter-car": ("strut",), "half-car": ("front", "rear")}
_CARS: dict[str, type[QuarterCar | HalfCar]] = {"quarter-car": QuarterCar, "half-car": HalfCar}
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True)
class StrutLayout:
    """The network of every mount of the vehicle, as an expression: `strut`, or `front` and `rear`."""

    struts: dict[str, str]


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

    def design(self, layout: str, swept: float | None = None) -> QuarterCar | HalfCar:
        """The vehicle with the struts of `layout`; `swept` replaces the value of the swept element [its SI unit].

        Raises `StudyError` for an unknown layout, or for `swept` where nothing is swept; `NetworkError` where `swept`
        is not a possible value.
        """
        if layout not in self.layouts:
            known = ", ".join(self.layouts)
            raise StudyError(f"Got layout {layout!r}; expected one of {known}.{nearest(layout, self.layouts)}")
        elements = dict(self.elements)
        if swept is not None:
            if self.sweep is None:
                raise StudyError(
                    f"Got a swept value, {swept!r}, but this study has no sweep. Add one, or leave it out."
                )
            elements[self.sweep.element] = elements[self.sweep.element].with_value(swept)
        mounted = {mount: network(text, **elements) for mount, text in self.layouts[layout].struts.items()}
        arguments: dict[str, Any] = {**self.vehicle, **mounted}
        return _CARS[self.model](**arguments)

    def resolved(self) -> dict[str, Any]:
        """The study as a study file says it: plain tables, every default filled in, every quantity in SI units.

        Two studies that ask the same of the same vehicle have the same dictionary, wherever their files are.
        """
        return {
            "title": self.title,
            "vehicle": {"model": self.model, **{key: _quantity(key, value) for key, value in self.vehicle.items()}},
            "road": {key: _quantity(key, getattr(self.road, key)) for key in ("speed", "roughness")},
            "elements": {name: _element(element) for name, element in self.elements.items()},
            "layouts": {
                name: layout.struts["strut"] if self.model == "quarter-car" else dict(layout.struts)
                for name, layout in self.layouts.items()
            },
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
            "high_pass": None if self.high_pass is None else _quantity("high_pass", self.high_pass),
        }
        return {key: value for key, value in settings.items() if value is not None}


def write_resolved(study: Study) -> str:
    """`study.resolved()` as TOML. `load_study` reads an equal study from it, to the last bit of every value."""
    resolved = study.resolved()
    lines = [f"{key} = {_toml(value)}" for key, value in resolved.items() if not isinstance(value, dict)]
    for section, table in resolved.items():
        if isinstance(table, dict):
            lines += ["", f"[{section}]", *(f"{_key(key)} = {_toml(value)}" for key, value in table.items())]
    return "\n".join(lines) + "\n"


def _quantity(key: str, value: float) -> str:
    return f"{value!r} {UNITS[key]}"  # repr is the shortest text that reads back as the same number


def _element(element: Element) -> str | dict[str, str]:
    value = element.value
    if isinstance(value, Free):
        return {"from": f"{value.lower!r} {element.unit}", "to": f"{value.upper!r} {element.unit}"}
    return f"{value!r} {element.unit}"


def _toml(value: object) -> str:
    match value:
        case dict():
            return "{ " + ", ".join(f"{_key(key)} = {_toml(item)}" for key, item in value.items()) + " }"
        case list():
            return "[" + ", ".join(_toml(item) for item in value) + "]"
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")  # JSON leaves DEL, TOML may not
        case _:
            return str(value)


def _key(key: str) -> str:
    return key if _BARE_KEY.fullmatch(key) else _toml(key)
