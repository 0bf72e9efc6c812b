"""Reading a rig file: TOML to a virtual rig and what its table does, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.layouts import StrutLayout, chosen_layout, element_of, layout_problems, struts_of
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.signal_kinds import SIGNALS
from inerter.files.common.signals import SignalRequest, signal_of
from inerter.files.common.toml import read_shape
from inerter.files.rig.running import RigRequest
from inerter.files.rig.shape import RigSettings, shapes
from inerter.identification.virtual_rig import VirtualRig
from inerter.networks.elements import Element
from inerter.networks.parser import network
from inerter.systems.piecewise import piecewise
from inerter.units import shown
from inerter.vehicle.rig import Rig
from inerter.writing import characters

_OWN = ("layout", "duration", "start")  # of [rig], and not of the rig itself


def load_rig(path: str | Path) -> RigRequest:
    """The virtual rig that the TOML file at `path` describes.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    shape = read_shape(path, "a rig file", *shapes())
    elements = {name: element_of(name, entry) for name, entry in shape.elements.items()}
    layouts = {name: StrutLayout(struts_of(Rig.key, {}, entry)) for name, entry in shape.layouts.items()}
    chosen = shape.rig.layout or (next(iter(layouts)) if len(layouts) == 1 else "")
    signal = signal_of(path, {Rig.moved: "m"}, shape.signal.model_dump())
    problems = [
        *layout_problems(Rig.key, {}, elements, layouts),
        *chosen_layout("rig", chosen, tuple(layouts)),
        *_signal_problems(signal),
    ]
    if problems:
        raise refusal(path, problems)
    rig = _rig(path, shape.rig, next(iter(layouts[chosen].struts.values())), elements)
    return RigRequest(
        characters(path.stem) if shape.title is None else shape.title, rig, signal, shape.rig.duration, shape.rig.start
    )


def _signal_problems(signal: SignalRequest) -> Iterator[Problem]:
    if signal.input != Rig.moved:
        yield at(("signal", "input"), got=shown(signal.input), fault=f"a table is moved by a {Rig.moved}")
    elif SIGNALS[signal.kind].needs:
        yield at(
            ("signal", "kind"),
            got=shown(signal.kind),
            fault="it is the shape of a road",
            expected='another kind, such as "flat-multisine" or "cosine"',
        )
    else:
        try:
            signal.make()
        except InerterError as error:
            yield at(("signal",), str(error))


def _rig(path: Path, settings: RigSettings, expression: str, elements: dict[str, Element]) -> VirtualRig:
    given: dict[str, Any] = {
        name: value for name, value in settings.model_dump().items() if name not in _OWN and value is not None
    }
    try:
        device = network(expression, **elements)
        piecewise(Rig(device))
        return VirtualRig(device, **given)
    except InerterError as error:
        raise refusal(path, [at(("rig",), str(error))]) from None
