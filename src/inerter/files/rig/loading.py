"""Reading a rig file: TOML to a virtual rig and what its table does, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from inerter.errors import InerterError
from inerter.files.common.layouts import layout_choice_problems, layout_problems
from inerter.files.common.problem import Problem, at
from inerter.files.common.problems import refusal
from inerter.files.common.signal_kinds import SIGNALS
from inerter.files.common.signals import SignalRequest, signal_of
from inerter.files.common.titles import title_of
from inerter.files.common.toml import read_tables, value_of
from inerter.files.rig.running import RigRequest
from inerter.files.rig.sections import rig_codec
from inerter.identification.virtual_rig import VirtualRig
from inerter.networks.elements import Element
from inerter.networks.parser import network
from inerter.systems.piecewise import piecewise
from inerter.units import quote_value
from inerter.vehicle.rig import Rig

_OWN = ("layout", "duration", "start")  # of [rig], and not of the rig itself


def load_rig(path: str | Path) -> RigRequest:
    """The virtual rig that the TOML file at `path` describes.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    return rig_of(read_tables(path, "a rig file"), path)


def rig_of(tables: Mapping[str, Any], path: Path) -> RigRequest:
    """Rig from the tables of a file at `path`; raises `StudyError` as `load_rig` does."""
    found = value_of(rig_codec(), tables, path)
    elements, layouts, settings = found["elements"], found["layouts"], found["rig"]
    chosen = settings.get("layout") or (next(iter(layouts)) if len(layouts) == 1 else "")
    signal = signal_of(path, {Rig.moved: "m"}, found["signal"])
    problems = [
        *layout_problems(elements, layouts),
        *layout_choice_problems("rig", chosen, tuple(layouts)),
        *_signal_problems(signal),
    ]
    if problems:
        raise refusal(path, problems)
    rig = _rig(path, settings, next(iter(layouts[chosen].struts.values())), elements)
    title = title_of(found, path)
    return RigRequest(title, rig, signal, settings["duration"], settings["start"])


def _signal_problems(signal: SignalRequest) -> Iterator[Problem]:
    if signal.input != Rig.moved:
        yield at(("signal", "input"), got=quote_value(signal.input), fault=f"a table is moved by a {Rig.moved}")
    elif SIGNALS[signal.kind].needs:
        yield at(
            ("signal", "kind"),
            got=quote_value(signal.kind),
            fault="it is the shape of a road",
            expected='another kind, such as "flat-multisine" or "cosine"',
        )
    else:
        try:
            signal.make()
        except InerterError as error:
            yield at(("signal",), str(error))


def _rig(path: Path, settings: Mapping[str, Any], expression: str, elements: dict[str, Element]) -> VirtualRig:
    given = {name: value for name, value in settings.items() if name not in _OWN}
    try:
        device = network(expression, **elements)
        piecewise(Rig(device))
        return VirtualRig(device, **given)
    except InerterError as error:
        raise refusal(path, [at(("rig",), str(error))]) from None
