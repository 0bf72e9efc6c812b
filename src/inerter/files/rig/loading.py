"""Reading a rig file: TOML to a virtual rig and what its table does, or one error with a line for every problem."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, ValidationError

from inerter.errors import InerterError, StudyError
from inerter.files.common.entries import (
    Amount,
    fixed_amount,
    not_negative,
    positive,
    positive_number,
    quantity,
    text,
    whole,
    yes_or_no,
)
from inerter.files.common.problems import at, explain, refusal
from inerter.files.common.signal_kinds import KINDS, MOVED
from inerter.files.simulation.loading import chosen_layout, signal_of
from inerter.files.simulation.request import SignalRequest
from inerter.files.simulation.shape import SIMULATION_SHAPES, SignalEntry
from inerter.files.study.loading import element_of, layout_problems, read_tables, struts_of
from inerter.files.study.shape import RIG, ElementName, Layouts, Shape
from inerter.files.study.study import StrutLayout
from inerter.identification.virtual_rig import VirtualRig
from inerter.networks.elements import Element
from inerter.networks.parser import network
from inerter.records.record import Record
from inerter.systems.piecewise import piecewise
from inerter.units import shown
from inerter.vehicle.cars import Rig
from inerter.writing import characters

_OWN = ("layout", "duration", "start")  # of [rig], and not of the rig itself


class RigSettings(Shape):
    """How long is measured, and the sensors; what is left out is that of `VirtualRig`."""

    layout: Annotated[str | None, PlainValidator(text)] = None
    duration: Annotated[float, positive("s")] = Field(examples=['duration = "5 s"'])
    start: Annotated[float, not_negative("s")] = 0.0
    seed: Annotated[int, whole(0, 2**63 - 1)] = 0
    sampling: Annotated[float | None, positive("Hz")] = None
    table_bandwidth: Annotated[float | None, positive("Hz")] = None
    encoder_resolution: Annotated[float | None, not_negative("m")] = None
    encoder_noise: Annotated[float | None, not_negative("m")] = None
    force_range: Annotated[float | None, positive("N")] = None
    force_resolution: Annotated[float | None, not_negative("N")] = None
    force_noise: Annotated[float | None, not_negative("N")] = None
    force_bandwidth: Annotated[float | None, positive("Hz")] = None
    force_offset: Annotated[float | None, quantity("N")] = None
    force_gain: Annotated[float | None, PlainValidator(positive_number)] = None
    force_delay: Annotated[float | None, not_negative("s")] = None
    reversed: Annotated[bool, PlainValidator(yes_or_no)] = False


class RigFile(Shape):
    """The whole file."""

    title: Annotated[str | None, PlainValidator(text)] = None
    elements: dict[ElementName, Annotated[Amount, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as b = "113 kg"']
    )
    layouts: Layouts = Field(examples=['a section [layouts] with a line such as screw = "(ks | cs) - (b | f)"'])
    signal: SignalEntry = Field(examples=['a section [signal] with kind = "cosine"'])
    rig: RigSettings = Field(examples=['a section [rig] with duration = "5 s"'])


RIG_SHAPES: dict[tuple[str, ...], type[Shape]] = {
    **{place: shape for place, shape in SIMULATION_SHAPES.items() if place[:1] in (("signal",), ("layouts",))},
    (): RigFile,
    ("rig",): RigSettings,
}


@dataclass(frozen=True)
class RigRequest:
    """A virtual rig with what its table does, and for how long it is measured."""

    title: str
    rig: VirtualRig
    signal: SignalRequest
    duration: float  # [s]
    start: float  # [s]

    def run(self) -> Record:
        """What the sensors read; raises what `VirtualRig.run` raises."""
        return self.rig.run(self.signal.make(), self.duration, self.start)


def load_rig(path: str | Path) -> RigRequest:
    """The virtual rig that the TOML file at `path` describes.

    Raises `StudyError` with one line for every problem: file, place, what arrived, what was expected, what to try.
    """
    path = Path(path)
    tables = read_tables(path, "a rig file")
    try:
        shape = RigFile.model_validate(tables)
    except ValidationError as error:
        raise refusal(path, explain(error, RIG_SHAPES)) from None
    elements = {name: element_of(name, entry) for name, entry in shape.elements.items()}
    layouts = {name: StrutLayout(struts_of(RIG, entry)) for name, entry in shape.layouts.items()}
    chosen = shape.rig.layout or (next(iter(layouts)) if len(layouts) == 1 else "")
    signal = signal_of(path, RIG, shape.signal.model_dump())
    problems = [
        *layout_problems(RIG, elements, layouts),
        *chosen_layout("rig", chosen, tuple(layouts)),
        *_signal_problems(signal),
    ]
    if problems:
        raise refusal(path, problems)
    rig = _rig(path, shape.rig, next(iter(layouts[chosen].struts.values())), elements)
    return RigRequest(
        characters(path.stem) if shape.title is None else shape.title, rig, signal, shape.rig.duration, shape.rig.start
    )


def record_of(path: Path, request: RigRequest) -> Record:
    """What the sensors read; raises `StudyError` naming the file for a run that cannot be."""
    try:
        return request.run()
    except InerterError as error:
        raise StudyError(f"{path.name}: {at((RIG,), str(error))}") from None


def _signal_problems(signal: SignalRequest) -> Iterator[str]:
    if signal.input != MOVED[RIG]:
        yield at(("signal", "input"), f"got {shown(signal.input)}; a table is moved by a {MOVED[RIG]}.")
    elif KINDS[signal.kind].needs:
        yield at(
            ("signal", "kind"),
            f"got {shown(signal.kind)}, which is the shape of a road; expected another kind, such as "
            f'"flat-multisine" or "cosine".',
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
        raise refusal(path, [at((RIG,), str(error))]) from None
