"""The shape of a simulation file: what it shares with study files, [signal] and [simulation]."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Field, PlainValidator, create_model

from inerter.files.common.entries import Amount, fixed_amount, one_of, positive, text, whole, yes_or_no
from inerter.files.common.kind_entry import KindEntry
from inerter.files.common.roads import CoherenceTable, RoadTable
from inerter.files.common.shape import ElementName, WithVehicle, layouts, vehicle_shapes
from inerter.files.common.signals import signal_shapes
from inerter.files.common.tables import Shape, Shapes
from inerter.files.common.vehicles import models
from inerter.rows import made_of_rows
from inerter.units import shown

INTEGRATORS = ("event-driven", "time-stepping")
INITIAL = ("rest", "preload", "periodic")


def _model(value: Any) -> str:
    return one_of("a vehicle model", models())(value)


class AnyVehicle(Shape):
    """A vehicle whose model is missing or unknown: nothing more can be said about its keys."""

    model_config = ConfigDict(extra="ignore")
    model: Annotated[str, PlainValidator(_model)] = Field(examples=['model = "quarter-car"'])


class PassedRoad(RoadTable):
    """The keys of `Road`; only a multisine cannot do without a roughness."""

    speed: Annotated[float, positive("m/s")] = Field(examples=['speed = "25 m/s"'])
    roughness: Annotated[float | None, positive("m^3/cycle")] = None


class SimulationSettings(Shape):
    """How the motion is computed, and what is kept of it."""

    layout: Annotated[str | None, PlainValidator(text)] = None
    duration: Annotated[float | None, positive("s")] = None
    step: Annotated[float, positive("s")] = 2e-4
    integrator: Annotated[str, PlainValidator(one_of("an integrator", INTEGRATORS))] = "event-driven"
    initial: Annotated[str, PlainValidator(one_of("an initial state", INITIAL))] = "rest"
    energy: Annotated[bool, PlainValidator(yes_or_no)] = False
    every: Annotated[int, whole(1, 10**9)] = 1


class SimulationFile(WithVehicle):
    """The whole file, but for what rows make of its vehicle, layouts and signal."""

    title: Annotated[str | None, PlainValidator(text)] = None
    vehicle: Any
    road: PassedRoad | None = Field(
        default=None, examples=['a section [road] with speed = "25 m/s" and roughness = "5e-7 m^3/cycle"']
    )
    elements: dict[ElementName, Annotated[Amount | KindEntry, PlainValidator(fixed_amount)]] = Field(
        min_length=1, examples=['a section [elements] with lines such as k = "120 kN/m"']
    )
    layouts: Any
    signal: Any
    simulation: SimulationSettings = Field(examples=['a section [simulation] with duration = "10 s"'])


@made_of_rows
def shapes() -> tuple[type[SimulationFile], Shapes]:
    """The shape of a simulation file, and all shapes in it by their place."""
    vehicle, vehicles = vehicle_shapes(models(), AnyVehicle, free=False)
    *others, last = map(shown, models())
    layout, tables = layouts()
    signal, signals = signal_shapes()
    file = create_model(
        "SimulationFile",
        __base__=SimulationFile,
        vehicle=(vehicle, Field(examples=[f"a section [vehicle] with model = {', '.join(others)} or {last}"])),
        layouts=(layout, ...),
        signal=(signal, Field(examples=['a section [signal] with kind = "multisine"'])),
    )
    return file, {
        **vehicles,
        (): file,
        ("road",): PassedRoad,
        ("road", "coherence"): CoherenceTable,
        **tables,
        **signals,
        ("simulation",): SimulationSettings,
    }
