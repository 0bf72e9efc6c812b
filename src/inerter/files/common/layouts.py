"""Elements and layouts of files: what entries of them stand for, how they are written, what can be wrong with them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from inerter.errors import NetworkError
from inerter.files.common.entries import Amount
from inerter.files.common.kind_entry import KindEntry
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.shape import Range
from inerter.files.common.suggest import nearest, some
from inerter.files.common.tables import Shape
from inerter.files.common.ties import TieEntry, tied_element, with_known_values
from inerter.files.common.vehicles import MountEntry, made, mounts
from inerter.networks.elements import Element, Free
from inerter.networks.elements.registry import kinds_by_unit
from inerter.networks.parser import names, network
from inerter.units import shown
from inerter.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class StrutLayout:
    """The network of every mount of the vehicle, as an expression: `strut`, or `front` and `rear`."""

    struts: dict[str, str]

    def design(self, model: str, vehicle: Mapping[str, Any], elements: Mapping[str, Element]) -> Vehicle:
        """The vehicle with these struts, made of `elements`."""
        known = with_known_values(elements)
        return made(model, vehicle, {mount: network(text, **known) for mount, text in self.struts.items()})

    def entry(self) -> str | dict[str, str]:
        """How a file says it."""
        return dict(self.struts) if len(self.struts) > 1 else next(iter(self.struts.values()))


def struts_of(model: str, vehicle: Mapping[str, Any], entry: Shape | dict[str, str] | str) -> dict[str, str]:
    """The network of every mount: as the layout gives it, else as the vehicle does.

    One text is that of all mounts that need one.
    """
    known = mounts(model, vehicle)
    own = {name: mount.network for name, mount in known.items() if mount.network is not None}
    if isinstance(entry, str):
        return {**dict.fromkeys([n for n, mount in known.items() if mount.needed] or known, entry), **own}
    given = entry.model_dump(exclude_none=True) if isinstance(entry, Shape) else entry
    struts = {**own, **given}
    return {name: struts[name] for name in dict.fromkeys((*known, *struts)) if name in struts}


def elements_of(entries: Mapping[str, Any]) -> tuple[dict[str, Element], list[Problem]]:
    """The elements that the entries of a section tell, in their order, and what is wrong with those that are tied."""
    own = {name: element_of(name, entry) for name, entry in entries.items() if not isinstance(entry, TieEntry)}
    found, problems = {}, []
    for name, entry in entries.items():
        try:
            found[name] = tied_element(name, entry, own) if isinstance(entry, TieEntry) else own[name]
        except EntryError as error:
            problems.append(replace(error.problem, place=("elements", name)))
    return found, problems


def element_of(name: str, entry: Range | Amount | KindEntry) -> Element:
    """The element that its entry, or else the unit of its value, tells."""
    if isinstance(entry, KindEntry):
        return entry.element(name)
    if isinstance(entry, Range):
        return kinds_by_unit()[entry.lower.unit].of(Free(entry.lower.value, entry.upper.value, name), name)
    return kinds_by_unit()[entry.unit].of(entry.value, name)


def layout_problems(
    model: str, vehicle: Mapping[str, Any], elements: Mapping[str, Element], layouts: Mapping[str, StrutLayout]
) -> Iterator[Problem]:
    """What is wrong with layouts: networks that cannot be, mounts and elements that are not there."""
    known = mounts(model, vehicle)
    for name, layout in layouts.items():
        wrong = list(_mount_problems(name, model, known, layout))
        if wrong:
            yield from wrong
            continue
        alike = len(set(layout.struts.values())) == 1
        for mount, expression in list(layout.struts.items())[: 1 if alike else None]:
            place = ("layouts", name) if alike else ("layouts", name, mount)
            yield from network_problems(place, expression, elements)


def _mount_problems(name: str, model: str, known: Mapping[str, MountEntry], layout: StrutLayout) -> Iterator[Problem]:
    """Mounts that are not there, or not filled."""
    unknown = [mount for mount in layout.struts if mount not in known]
    if unknown and len(known) == 1:
        (only,), text = known, shown(next(iter(layout.struts.values())))
        fault = f"a {model.replace('-', ' ')} has one {only}"
        yield at(("layouts", name), got="a table", fault=fault, expected=f"its network in quotes, such as {text}")
        return
    for mount in unknown:
        hint = nearest(mount, known)
        yield at(("layouts", name, mount), fault="unknown key", expected=f"one of {some(known)}", hint=hint)
    for mount in known:
        if known[mount].needed and mount not in layout.struts:
            yield at(("layouts", name, mount), fault="missing", expected=f'{mount} = "k | c"')


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
