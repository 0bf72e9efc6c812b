"""Simulation request, resolved and checked: SI values, one layout, one signal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from pathlib import Path
from typing import Any, cast

from inerter.files.common.codec import keyed_dataclass
from inerter.files.common.layouts import StrutLayout
from inerter.files.common.roads import MeasuredLine, remark
from inerter.files.common.signals import SignalRequest
from inerter.files.common.toml import as_toml
from inerter.files.simulation.sections import SimulationSettings, simulation_codec
from inerter.networks.elements import Element
from inerter.signals.signal import Signal
from inerter.simulation.inputs import RunInputs
from inerter.simulation.simulate import RunSettings, check_simulation, simulate
from inerter.simulation.trajectory import Trajectory
from inerter.vehicle.vehicle import Vehicle


@keyed_dataclass
class SimulationRequest(SimulationSettings):
    """Contents of a simulation file, with defaults. Equal requests may come from different files."""

    title: str
    path: Path = field(compare=False)
    vehicle: dict[str, Any]  # the table, with its model
    road: dict[str, Any]  # by key, in SI units; empty without a road, and without roughness for what needs none
    elements: dict[str, Element]
    layouts: dict[str, StrutLayout]
    signal: SignalRequest
    layout: str = ""
    line: MeasuredLine | None = field(default=None, compare=False)  # that the roughness is of, if it was measured

    @property
    def model(self) -> str:
        """Model of the vehicle."""
        return str(self.vehicle["model"])

    @property
    def speed(self) -> float | None:
        """Vehicle speed [m/s]; None without a road."""
        return self.road.get("speed")

    @property
    def roughness(self) -> float | None:
        """Roughness of a random road [m^3/cycle]; None if not stated."""
        return self.road.get("roughness")

    @property
    def coherence(self) -> dict[str, float]:
        """Parameters of the coherence between the tracks, by key; empty if not stated."""
        return self.road.get("coherence") or {}

    @property
    def length(self) -> float | None:
        """Time from the first to the last sample [s]; None for a period that the signal does not have."""
        return self.period if self.duration is None else self.duration

    @property
    def period(self) -> float | None:
        """Period of the signal [s]; None if it is not periodic."""
        return self.make_signal().period

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Paths of the files read: request, signal, and measured profile."""
        return (self.path, *self.signal.inputs, *(() if self.line is None else (self.line.path,)))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the road fitted to a measured profile, with its warnings; empty without one."""
        return () if self.line is None else (self.line.note, *self.line.warnings)

    def design(self) -> Vehicle:
        """The vehicle, or rig, with the chosen layout; on moving ground if the signal is its acceleration."""
        found = self.layouts[self.layout].design(self.vehicle, self.elements)
        return found.mechanism().on_moving_ground() if self.signal.unit == "m/s^2" else found

    def make_signal(self) -> Signal:
        """The signal, of two tracks that of the left; raises `SignalError` as `signals` does."""
        return next(iter(self.signals().values()))

    def signals(self) -> dict[str, Signal]:
        """The signal of each track, as `SignalRequest.tracks` has it."""
        return self.signal.tracks(self.road)

    def check(self) -> int:
        """The number of steps; raises what `simulate` would raise before it integrates."""
        settings = RunSettings(**self._settings)
        return check_simulation(self.design(), self._input_arguments(), settings)

    def run(self, progress: Callable[[float], None] | None = None) -> Trajectory:
        """Simulate it; raises what `simulate` raises."""
        return simulate(self.design(), **self._input_arguments(), **self._settings, progress=progress)

    @property
    def _settings(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("duration", "step", "integrator", "every", "energy")}

    def _input_arguments(self) -> RunInputs:
        signals = self.signals()
        signal = signals.get("", signals)
        moved: Any = {"road": signal} if self.signal.input == "road" else {"forces": {self.signal.input: signal}}
        if self.signal.input == "displacement":
            moved = {"displacement": signal}
        return cast(RunInputs, {**moved, "speed": self.speed, "initial": self.initial})

    def to_tables(self) -> dict[str, Any]:
        """The request as a simulation file says it: every default filled in, every quantity in SI units."""
        return simulation_codec().dump(
            {
                "title": self.title,
                "vehicle": self.vehicle,
                "road": self.road or None,
                "elements": self.elements,
                "layouts": self.layouts,
                "signal": self.signal,
                "simulation": self,
            }
        )


def write_simulation(request: SimulationRequest) -> str:
    """`request.to_tables()` as TOML. `load_simulation` reads an equal request from it, to the last bit."""
    return remark(request.line) + as_toml(request.to_tables())
