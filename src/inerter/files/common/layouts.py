"""Elements and layouts of files: what entries of them stand for, how they are written, what can be wrong with them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from inerter.errors import NetworkError
from inerter.files.common.entries import Amount
from inerter.files.common.problem import Problem, at
from inerter.files.common.shape import UNITS, Axles, Range
from inerter.files.common.suggest import nearest, some
from inerter.files.common.told_kind import ToldKind
from inerter.networks.elements import Element, Free
from inerter.networks.elements.registry import kinds_by_unit
from inerter.networks.parser import names, network
from inerter.units import shown
from inerter.vehicle.cars import HalfCar, QuarterCar, Rig

MOUNTS = {"quarter-car": ("strut",), "half-car": ("front", "rear"), "rig": ("device",)}
_CARS: dict[str, type[QuarterCar | HalfCar | Rig]] = {"quarter-car": QuarterCar, "half-car": HalfCar, "rig": Rig}


@dataclass(frozen=True)
class StrutLayout:
    """The network of every mount of the vehicle, as an expression: `strut`, or `front` and `rear`."""

    struts: dict[str, str]

    def design(
        self, model: str, vehicle: Mapping[str, float], elements: Mapping[str, Element]
    ) -> QuarterCar | HalfCar | Rig:
        """The vehicle with these struts, made of `elements`."""
        mounted = {mount: network(text, **elements) for mount, text in self.struts.items()}
        arguments: dict[str, Any] = {**vehicle, **mounted}
        return _CARS[model](**arguments)

    def entry(self) -> str | dict[str, str]:
        """How a file says it."""
        return dict(self.struts) if len(self.struts) > 1 else next(iter(self.struts.values()))


def struts_of(model: str, entry: Axles | str) -> dict[str, str]:
    """The network of every mount."""
    return entry.model_dump() if isinstance(entry, Axles) else dict.fromkeys(MOUNTS[model], entry)


def element_of(name: str, entry: Range | Amount | ToldKind) -> Element:
    """The element that its entry, or else the unit of its value, tells."""
    if isinstance(entry, ToldKind):
        return entry.element(name)
    if isinstance(entry, Range):
        return kinds_by_unit()[entry.lower.unit].of(Free(entry.lower.value, entry.upper.value, name), name)
    return kinds_by_unit()[entry.unit].of(entry.value, name)


def in_si(key: str, value: float) -> str:
    """The text of a quantity, in the SI unit of its key."""
    return f"{value!r} {UNITS[key]}"  # repr is the shortest text that reads back as the same number


def layout_problems(
    model: str, elements: Mapping[str, Element], layouts: Mapping[str, StrutLayout]
) -> Iterator[Problem]:
    """What is wrong with layouts: networks that cannot be, and elements that are not there."""
    for name, layout in layouts.items():
        if tuple(layout.struts) != MOUNTS[model]:
            yield at(
                ("layouts", name),
                got="a table",
                fault=f"a {model.replace('-', ' ')} has one {MOUNTS[model][0]}",
                expected=f"its network in quotes, such as {shown(next(iter(layout.struts.values())))}",
            )
            continue
        alike = len(set(layout.struts.values())) == 1
        for mount, expression in list(layout.struts.items())[: 1 if alike else None]:
            place = ("layouts", name) if alike else ("layouts", name, mount)
            yield from network_problems(place, expression, elements)


def network_problems(place: tuple[str, ...], expression: str, elements: Mapping[str, Element]) -> Iterator[Problem]:
    """What is wrong with the network at one place: its syntax, or elements that are not there."""
    try:
        unknown = [name for name in names(expression) if name not in elements]
        for name in unknown:
            missing = f"{shown(name)} is not in [elements], where there are {some(elements)}"
            yield at(place, got=shown(expression), fault=missing, hint=nearest(name, elements))
        if not unknown:
            network(expression, **elements)
    except NetworkError as error:
        yield at(place, str(error))


def chosen_layout(section: str, layout: str, known: Collection[str]) -> Iterator[Problem]:
    """What is wrong with the layout that a section chooses."""
    layouts = some(known)
    if not layout:
        yield at((section, "layout"), fault="missing, but there are several layouts", expected=f"one of {layouts}")
    elif layout not in known:
        hint = nearest(layout, known)
        yield at((section, "layout"), got=shown(layout), expected=f"one of {layouts}", hint=hint)
