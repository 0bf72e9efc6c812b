"""Layouts of files: the networks that they put in the mounts of a vehicle, and what can be wrong with them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from inerter.errors import NetworkError
from inerter.field_metadata import mounts_of
from inerter.files.common.codec import (
    INVALID,
    REQUIRED,
    Codec,
    Declaration,
    LoadContext,
    RawEntry,
    TableCodec,
    section,
    without_none,
)
from inerter.files.common.codecs import NamesCodec, any_of
from inerter.files.common.entries import EXPRESSION, layout_name
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.suggest import nearest, some
from inerter.files.common.ties import with_known_values
from inerter.files.common.vehicle_tables import SEAT
from inerter.files.common.vehicles import MountEntry, build_vehicle, mounts
from inerter.networks.elements import Element, Network
from inerter.networks.parser import names, network
from inerter.units import quote_value
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.vehicle import Vehicle


@dataclass(frozen=True)
class StrutLayout:
    """The network of every mount of the vehicle, as an expression: `strut`, or `front` and `rear`."""

    struts: dict[str, str]

    def design(
        self,
        vehicle: Mapping[str, Any],
        elements: Mapping[str, Element],
        networks: Mapping[str, Network] = MappingProxyType({}),
    ) -> Vehicle:
        """The vehicle with these struts, made of `elements` and `networks`."""
        known = {**with_known_values(elements), **networks}
        return build_vehicle(vehicle, {mount: network(text, **known) for mount, text in self.struts.items()})


@dataclass(frozen=True)
class LayoutCodec(Codec):
    """A text for all mounts that need a network, or a table with a text for each; `model` is that of all files, or else
    the vehicle of the file tells.
    """

    model: str = ""

    def load(self, raw: Any, context: LoadContext) -> StrutLayout:
        """The networks by mount: those of the layout, or else of the vehicle."""
        model, known = self._mounts(context)
        if not isinstance(raw, dict):
            text = EXPRESSION.load(raw, context)
            struts = dict.fromkeys([name for name, mount in known.items() if mount.needed] or known, text)
            return StrutLayout(struts | {n: mount.network for n, mount in known.items() if mount.network is not None})
        unknown = [name for name in raw if name not in known]
        if unknown and len(known) == 1:
            (only,), text = known, quote_value(next(iter(raw.values())))
            fault = f"a {model.replace('-', ' ')} has one {only}"
            raise EntryError(got="a table", fault=fault, expected=f"its network in quotes, such as {text}")
        found = (_mounts_table(known) if known else NamesCodec(EXPRESSION)).load(raw, context)
        return INVALID if found is INVALID else StrutLayout(found)

    def _mounts(self, context: LoadContext) -> tuple[str, dict[str, MountEntry]]:
        """The model of the vehicle and its mounts; none where they cannot be known."""
        if self.model:
            return self.model, mounts({"model": self.model})
        vehicle, raw = context.loaded.get("vehicle", INVALID), context.tables.get("vehicle")
        if vehicle is not INVALID:
            return vehicle["model"], mounts(vehicle)
        model = str(raw.get("model")) if isinstance(raw, Mapping) else ""
        seat = {SEAT: MountEntry(needed=False)} if model in VEHICLES and SEAT in (raw or ()) else {}
        return model, {**mounts({"model": model}), **seat} if model in VEHICLES else {}

    def dump(self, value: StrutLayout) -> str | dict[str, str]:
        """The text, or a table for several mounts."""
        return dict(value.struts) if len(value.struts) > 1 else next(iter(value.struts.values()))

    def raw_entries(self, raw: Any) -> Iterator[RawEntry]:
        """The text for all mounts, or those of the mounts."""
        yield from (NamesCodec(EXPRESSION) if isinstance(raw, Mapping) else EXPRESSION).raw_entries(raw)

    def rename(self, raw: Any, names: Mapping[str, str]) -> Any:
        """The networks with other names of elements."""
        return (NamesCodec(EXPRESSION) if isinstance(raw, Mapping) else EXPRESSION).rename(raw, names)

    def schema(self) -> dict[str, Any]:
        """The JSON Schema of a text, of the mounts of each model, and of mounts of the author's own."""
        each = {}
        for model, kind in VEHICLES.items():
            if len(names := mounts_of(kind)) > 1:
                each[names] = _mounts_table(mounts({"model": model})).schema()
        own = {"type": "object", "additionalProperties": EXPRESSION.schema()}
        return any_of([*each.values(), EXPRESSION.schema(), own])


def layouts_section(line: str = 'lines such as S1 = "k | c"', model: str = "") -> Declaration:
    """The section [layouts], for vehicles of one model, or of that which the file says; `line` is an example."""
    return section(
        "layouts",
        NamesCodec(LayoutCodec(model), layout_name, 1),
        "Networks of the elements: | in parallel, - in series.",
        f"a section [layouts] with {line}",
    )


def _mounts_table(known: Mapping[str, MountEntry]) -> TableCodec:
    """A text for each mount; those that may be left out have the network of the vehicle, if any."""
    return TableCodec(
        tuple(
            section(
                name,
                EXPRESSION,
                f'Network of the mount "{name}".',
                f'{name} = "k | c"',
                REQUIRED if mount.needed else mount.network,
            )
            for name, mount in known.items()
        ),
        without_none,
    )


def layout_problems(elements: Mapping[str, Network], layouts: Mapping[str, StrutLayout]) -> Iterator[Problem]:
    """Problems of layouts: invalid networks and unknown elements."""
    for name, layout in layouts.items():
        alike = len(set(layout.struts.values())) == 1
        for mount, expression in list(layout.struts.items())[: 1 if alike else None]:
            place = ("layouts", name) if alike else ("layouts", name, mount)
            yield from network_problems(place, expression, elements)


def network_problems(place: tuple[str, ...], expression: str, elements: Mapping[str, Network]) -> Iterator[Problem]:
    """Problems of the network at one place: its syntax, or unknown elements."""
    try:
        unknown = [name for name in names(expression) if name not in elements]
        for name in unknown:
            present = f"; available: {some(elements)}" if elements else ", which is empty"
            missing = f"{quote_value(name)} is not in [elements]{present}"
            yield at(place, got=quote_value(expression), fault=missing, hint=nearest(name, elements))
        if not unknown:
            network(expression, **elements)
    except NetworkError as error:
        yield at(place, str(error))


def layout_choice_problems(section: str, layout: str, known: Collection[str]) -> Iterator[Problem]:
    """Problem of the layout named in a section: missing where several exist, or unknown."""
    layouts = some(known)
    if not layout:
        yield at((section, "layout"), fault="missing, but there are several layouts", expected=f"one of {layouts}")
    elif layout not in known:
        hint = nearest(layout, known)
        yield at((section, "layout"), got=quote_value(layout), expected=f"one of {layouts}", hint=hint)
