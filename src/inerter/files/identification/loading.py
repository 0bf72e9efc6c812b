"""Configuration of `inerter identify`: reading of records, the model to fit, and settings of the fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from inerter.errors import InerterError, StudyError
from inerter.files.common.layouts import network_problems
from inerter.files.common.problem import EntryError, Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.suggest import nearest
from inerter.files.common.toml import read_tables, value_of
from inerter.files.identification.sections import AS_RECORDED, CHOOSE, RecordRequest, identification_codec
from inerter.identification.models import MODELS
from inerter.networks.elements import Element, Free, Network
from inerter.networks.parser import names, network
from inerter.networks.transform import map_elements
from inerter.units import quote_value
from inerter.vehicle.rig import Rig

CUSTOM = "custom"


@dataclass(frozen=True)
class IdentificationRequest:
    """A model by its name, or made of elements, and what else the configuration says. No model is yet to be named."""

    title: str | None = None
    record: RecordRequest = AS_RECORDED
    name: str | None = None
    layout: str | None = None
    elements: dict[str, Element] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)  # of `identify`

    @property
    def chooses(self) -> bool:
        """Whether a model is selected from several."""
        return self.layout is None and self.name == CHOOSE

    def models(self) -> dict[str, Network]:
        """The models to fit, by name: one, or the whole catalogue for "choose".

        Raises `StudyError` where none is named or a name is unknown.
        """
        if self.layout is not None:
            return {CUSTOM: network(self.layout, **self.elements)}
        known = ", ".join((*MODELS, CHOOSE))
        if self.name is None:
            raise StudyError(
                f"Model missing. Name one of {known} with --model, or write [model] and [elements] in a --config."
            )
        if self.name == CHOOSE:
            return {name: _replace_elements(model, self.elements) for name, model in MODELS.items()}
        if self.name not in MODELS:
            hint = nearest(self.name, (*MODELS, CHOOSE))
            raise StudyError(str(EntryError(got=f"--model {self.name}", expected=f"one of {known}", hint=hint)))
        return {self.name: _replace_elements(MODELS[self.name], self.elements)}


def load_identification(path: str | Path) -> IdentificationRequest:
    """The configuration in the TOML file at `path`.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    return identification_of(read_tables(path, "a configuration for inerter identify"), path)


def identification_of(tables: Mapping[str, Any], path: Path) -> IdentificationRequest:
    """Configuration from its tables; `path` is used in messages only."""
    found = value_of(identification_codec(), tables, path)
    request = IdentificationRequest(
        title=found["title"],
        record=found["record"],
        name=found["model"].name,
        layout=found["model"].layout,
        elements=found["elements"],
        settings=found["fit"],
    )
    problems = list(_problems(request))
    if problems:
        raise refusal(path, problems)
    return request


def _problems(request: IdentificationRequest) -> Iterator[Problem]:
    if request.layout is None:
        yield from _of_named(request)
        return
    if request.name is not None:
        yield at(("model",), got=f"both a name, {quote_value(request.name)}, and a layout", expected="one of them")
    wrong = list(network_problems(("model", "layout"), request.layout, request.elements))
    yield from wrong
    if wrong:
        return
    used = names(request.layout)
    for name in request.elements:
        if name not in used:
            unused = "it is not in the layout of [model]"
            yield at(("elements", name), fault=unused, hint="Use it there, or leave it out.")
    if not any(isinstance(request.elements[name].value, Free) for name in used):
        yield at(
            ("elements",),
            fault="nothing to identify, since every value is fixed",
            expected='a range, such as b = { from = "1 kg", to = "500 kg" }',
        )
    try:
        Rig(network(request.layout, **request.elements))
    except InerterError as error:
        yield at(("model", "layout"), str(error))


def _of_named(request: IdentificationRequest) -> Iterator[Problem]:
    """Elements that replace those of models of the catalogue."""
    units = {e.label: e.unit for model in MODELS.values() for e in model.elements()}
    for name, element in request.elements.items():
        if name not in units:
            unused = (
                f"there is no model.layout that would use it, and the models of the catalogue have {', '.join(units)}"
            )
            yield at(("elements", name), fault=unused, hint=nearest(name, units))
        elif element.unit != units[name]:
            yield at(("elements", name), got=f"a value in {element.unit}", expected=f"one in {units[name]}")


def _replace_elements(model: Network, elements: Mapping[str, Element]) -> Network:
    """A model with the values of some of its elements fixed, or free within other bounds."""
    return map_elements(model, lambda element: elements.get(element.label, element))
