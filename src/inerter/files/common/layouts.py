"""Elements and layouts of files: what entries of them stand for, how they are written, what can be wrong with them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from inerter.errors import NetworkError
from inerter.fields import Field, fields_of, mounts_of
from inerter.files.common.entries import Amount
from inerter.files.common.kind_entry import KindEntry
from inerter.files.common.problem import Problem, at
from inerter.files.common.shape import Range, Shape
from inerter.files.common.suggest import nearest, some
from inerter.networks.elements import Element, Free
from inerter.networks.elements.registry import kinds_by_unit
from inerter.networks.parser import names, network
from inerter.units import shown
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.vehicle import VehicleModel


@dataclass(frozen=True)
class StrutLayout:
    """The network of every mount of the vehicle, as an expression: `strut`, or `front` and `rear`."""

    struts: dict[str, str]

    def design(self, model: str, vehicle: Mapping[str, float], elements: Mapping[str, Element]) -> VehicleModel:
        """The vehicle with these struts, made of `elements`."""
        mounted = {mount: network(text, **elements) for mount, text in self.struts.items()}
        arguments: dict[str, Any] = {**vehicle, **mounted}
        return VEHICLES[model](**arguments)

    def entry(self) -> str | dict[str, str]:
        """How a file says it."""
        return dict(self.struts) if len(self.struts) > 1 else next(iter(self.struts.values()))


def struts_of(model: str, entry: Shape | str) -> dict[str, str]:
    """The network of every mount."""
    return entry.model_dump() if isinstance(entry, Shape) else dict.fromkeys(mounts_of(VEHICLES[model]), entry)


def element_of(name: str, entry: Range | Amount | KindEntry) -> Element:
    """The element that its entry, or else the unit of its value, tells."""
    if isinstance(entry, KindEntry):
        return entry.element(name)
    if isinstance(entry, Range):
        return kinds_by_unit()[entry.lower.unit].of(Free(entry.lower.value, entry.upper.value, name), name)
    return kinds_by_unit()[entry.unit].of(entry.value, name)


def in_si(fields: Iterable[Field], values: Mapping[str, float]) -> dict[str, str]:
    """The texts of those quantities that there is a value of, in SI units."""
    return {f.key: f"{values[f.key]!r} {f.unit}" for f in fields if f.key in values}  # repr reads back as the same


def vehicle_entry(model: str, values: Mapping[str, float]) -> dict[str, str]:
    """How a file says a vehicle."""
    return {"model": model, **in_si(fields_of(VEHICLES[model]), values)}


def layout_problems(
    model: str, elements: Mapping[str, Element], layouts: Mapping[str, StrutLayout]
) -> Iterator[Problem]:
    """What is wrong with layouts: networks that cannot be, and elements that are not there."""
    mounts = mounts_of(VEHICLES[model])
    for name, layout in layouts.items():
        if tuple(layout.struts) != mounts:
            yield at(("layouts", name), got="a table", **_mounted(model, mounts, layout))
            continue
        alike = len(set(layout.struts.values())) == 1
        for mount, expression in list(layout.struts.items())[: 1 if alike else None]:
            place = ("layouts", name) if alike else ("layouts", name, mount)
            yield from network_problems(place, expression, elements)


def _mounted(model: str, mounts: tuple[str, ...], layout: StrutLayout) -> dict[str, str]:
    """How layouts of this vehicle are said."""
    text = shown(next(iter(layout.struts.values())))
    car = model.replace("-", " ")
    if len(mounts) == 1:
        return {"fault": f"a {car} has one {mounts[0]}", "expected": f"its network in quotes, such as {text}"}
    table = ", ".join(f"{mount} = {text}" for mount in mounts)
    return {"fault": f"a {car} has {', '.join(mounts[:-1])} and {mounts[-1]}", "expected": f"such as {{ {table} }}"}


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
