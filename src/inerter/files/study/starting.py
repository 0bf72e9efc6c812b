"""Template study file for any vehicle, generated from the registries, with a remark above every key."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator
from shlex import quote
from typing import Any

from inerter.errors import InerterError, StudyError, with_article
from inerter.field_metadata import Field, fields_of, needed_mounts_of
from inerter.files.common.keys import keys_of
from inerter.files.common.roads import ROAD_QUANTITIES
from inerter.files.common.suggest import nearest
from inerter.files.common.toml import as_line
from inerter.files.common.vehicle_tables import MECHANISM
from inerter.files.study import KIND
from inerter.files.study.sections import study_models
from inerter.indices.registry import INDICES, make_index
from inerter.methods.registry import DEFAULT
from inerter.networks.elements import Damper, Inerter, Network, Spring
from inerter.networks.elements.registry import format_unit_kinds
from inerter.signals.road import Road
from inerter.units import quote_value
from inerter.vehicle.quarter_car import QuarterCar
from inerter.vehicle.registry import VEHICLES
from inerter.vehicle.vehicle import VehicleModel

_COLUMN = 42  # where remarks begin
_FREE = {Spring: ("1 kN/m", "1 MN/m"), Damper: ("100 N s/m", "100 kN s/m"), Inerter: ("1 kg", "2000 kg")}
_LAYOUTS = {
    "S1": ("k | c", "conventional strut: spring and damper in parallel"),
    "S2": ("k | c | b", "inerter in parallel with the damper"),
    "S3": ("k | c - b", "inerter in series with the damper"),
}
_JOINED = "# Networks: | in parallel, - in series (binds tighter), brackets group."
_MOST_ASKED = 3
_PARTS = (  # a quarter car, part by part
    "",
    "[vehicle.coordinates]                     # Degrees of freedom, each with its mass",
    'body = "250 kg"',
    'wheel = "35 kg"',
    "",
    "[vehicle.struts]                          # Networks between two ports; without a lower one, to the ground",
    "strut = { upper = { body = 1 }, lower = { wheel = 1 } }",
    "",
    "[vehicle.tyres]                           # Networks between a port and a road",
    'tyre = { port = { wheel = 1 }, road = "road", network = "kt" }',
    "",
    "[vehicle.roads]                           # Road inputs with their positions",
    "road = {}",
    "",
    "[vehicle.forces]                          # External forces, by the port on which they act",
    "load = { body = 1 }",
    "",
    "[vehicle.measures]                        # Performance outputs of each index",
    "comfort = { body_acceleration = 1 }",
    'load_input = "load"',
    'load_output = "body_displacement"',
)
_ELEMENTS = (
    "# Elements, by names that you choose. The unit determines the kind:",
    "# A value is fixed, or a design variable between two bounds, optimised for each layout and index separately.",
)


def starting_text(model: str, name: str = "STUDY.toml") -> str:
    """A whole study file of that vehicle, which runs; `name` is that of the file, for its remarks.

    Raises `StudyError` for a vehicle that study files do not know.
    """
    if model not in study_models():
        hint = nearest(model, study_models()) or " It is for: inerter simulate." * (model in VEHICLES)
        known = " or ".join(map(quote_value, study_models()))
        raise StudyError(f"unknown vehicle {quote_value(model)} in study files; expected {known}.{hint}")
    kind = _Quarter if model == MECHANISM else VEHICLES[model]
    car = model.replace("-", " ")
    blocks = [
        [
            f"# A study of {with_article(car)}: which values make each layout best, and which layout is the best?",
            "#",
            f"# Run it: inerter run {quote(name)}",
            "# What a key means: inerter explain road.speed",
        ],
        [as_line("title", f"{car.capitalize()}: with an inerter and without")],
        ["[vehicle]", as_line("model", model), *(_PARTS if kind is _Quarter else _quantities(fields_of(kind)))],
        *([["[road]", *_quantities(ROAD_QUANTITIES)]] if _moved_by_road(kind) else []),
        [*_elements(kind)],
        [_JOINED, *_mounts(kind), "[layouts]", *(_line(as_line(n, text), why) for n, (text, why) in _LAYOUTS.items())],
        [*_settings(kind)],
    ]
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


class _Quarter(QuarterCar):
    """Quarter car from which the template of a mechanism is generated."""

    key = MECHANISM


def _line(text: str, remark: str) -> str:
    return f"{text:<{_COLUMN - 1}} # {remark.rstrip('.')}"


def _quantities(fields: Iterable[Field]) -> Iterator[str]:
    """A line for each; one that may be left out is a remark."""
    for field in fields:
        text = as_line(field.key, field.example or f"1 {field.unit}")
        yield _line(text if field.default is None else f"# {text}", field.sentence)


def _moved_by_road(kind: type[VehicleModel]) -> bool:
    return bool(_unit_vehicle(kind).mechanism().roads)


def _elements(kind: type[VehicleModel]) -> Iterator[str]:
    """A spring, a damper and an inerter; a spring that carries a car is fixed by the load, not by what is best."""
    first, second = _ELEMENTS
    yield from (first, f"# {format_unit_kinds()}.", second, "[elements]")
    yield from [_line(as_line("kt", "150 kN/m"), "spring, fixed: the tyre")] if kind is _Quarter else []
    for element, ends in _FREE.items():
        fixed = element is Spring and _moved_by_road(kind)
        value = element.example if fixed else dict(zip(("from", "to"), ends, strict=True))
        yield _line(as_line(element.symbol, value), f"{element.key}, {'fixed' if fixed else 'free'}")


def _mounts(kind: type[VehicleModel]) -> Iterator[str]:
    """Remark on a separate network for each mount; none for a single mount."""
    mounts = needed_mounts_of(kind)
    if len(mounts) > 1:
        table = ", ".join(f'{mount} = "k | c"' for mount in mounts)
        yield f"# One network serves {' and '.join(mounts)}; a table gives one for each: S1 = {{ {table} }}"


def _settings(kind: type[VehicleModel]) -> Iterator[str]:
    """Section [study] of the template, with the further keys as remarks."""
    possible = [symbol for symbol in INDICES if _answers(kind, symbol)]
    asked = possible[:_MOST_ASKED]
    titles = ", ".join(f"{symbol} {INDICES[symbol].title}" for symbol in asked)
    given = {"indices": asked, "optimise": DEFAULT, "baseline": next(iter(_LAYOUTS))}
    keys = [key for key in keys_of(KIND.schema()) if key.place.startswith("study.") and key.place.count(".") == 1]
    sentences = {key.name: key.sentence for key in keys}
    yield from ("[study]", f"# {titles}")
    for name, value in given.items():
        yield _line(as_line(name, value), sentences[name])
    yield from ("", "# Further keys (remove the # to use one):")
    yield from [f"# More indices: {', '.join(possible[_MOST_ASKED:])}"] if possible[_MOST_ASKED:] else []
    for key in keys:
        if key.name not in given and key.example is not None:
            yield f"# {key.sentence}"
            yield f"# {as_line(key.name, key.example)}"


def _unit_vehicle(kind: type[VehicleModel]) -> VehicleModel:
    """Vehicle of a model with unit values."""
    network: Network = Spring(1.0) | Damper(1.0)
    values: dict[str, Any] = {field.name: 1.0 for field in fields_of(kind)}
    return kind(**values, **dict.fromkeys(needed_mounts_of(kind), network))


def _answers(kind: type[VehicleModel], symbol: str) -> bool:
    """Whether the index is defined for the vehicle without any setting."""
    row: Any = INDICES[symbol]
    bare = {f.name for f in dataclasses.fields(row) if f.default is f.default_factory is dataclasses.MISSING}
    if bare - {"road"}:
        return False
    try:
        make_index(symbol, Road(roughness=1.0, speed=1.0), {}).definition(_unit_vehicle(kind).mechanism())
    except InerterError:
        return False
    return True
