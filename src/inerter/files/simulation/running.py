"""Run of a simulation file into a result folder, and summary quantities of the motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from inerter.atomic_io import write_netcdf, write_text
from inerter.errors import InerterError
from inerter.files.common.folder import FIGURES, WriteMode, open_results
from inerter.files.common.problem import at
from inerter.files.common.problems import refusal
from inerter.files.simulation.request import SimulationRequest, write_simulation
from inerter.formatting import format_list, in_words
from inerter.networks.elements import Element
from inerter.networks.elements.roles import LinearRole, SwitchRole
from inerter.simulation.peaks import is_coarse
from inerter.simulation.trajectory import Trajectory
from inerter.systems.graph import full_graph, switching
from inerter.systems.outputs import of_mount
from inerter.vehicle.mechanism import Mechanism
from inerter.work.origin import versions

TRAJECTORY, DATASET, EVENTS, RESOLVED = "trajectory.csv", "trajectory.nc", "events.csv", "simulation.toml"
NAMES = (TRAJECTORY, DATASET, EVENTS, RESOLVED, f"{FIGURES}/")


@dataclass(frozen=True)
class Nonlinear:
    """Friction or gap: its place, number of changes of state, and fraction of the time in each state."""

    name: str
    kind: str
    switch: SwitchRole
    strut: str
    events: int
    shares: dict[str, float]


@dataclass(frozen=True, eq=False)
class SimulationResult:
    """Motion of a simulation, with its request."""

    request: SimulationRequest
    run: Trajectory

    @cached_property
    def mechanism(self) -> Mechanism:
        """Mechanism that was simulated."""
        return self.request.design().mechanism()

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the outputs that equal the excited input: all roads, or the force."""
        roads = tuple(road.name for road in self.mechanism.roads)
        return roads if self.request.signal.unit == "m" else (self.request.signal.input,)

    @property
    def accelerations(self) -> tuple[str, ...]:
        """Names of the outputs that ride comfort is based on, with any weight."""
        return tuple(weighted.output for weighted in self.mechanism.measures.comfort)

    @property
    def displacements(self) -> tuple[str, ...]:
        """Name of the load-carrying output of a vehicle without comfort outputs, over moving ground; else empty."""
        answer = self.mechanism.measures.load_output
        if answer is not None and self.mechanism.ground_moves:
            answer = f"{answer.removesuffix('_displacement')}_relative_displacement"
        return () if answer is None or self.accelerations else (answer,)

    @property
    def on_rig(self) -> bool:
        """Whether the signal drives the displacement of one end of a device."""
        return self.request.signal.input == "displacement"

    @property
    def tyre_loads(self) -> tuple[str, ...]:
        """Names of the outputs that are tyre forces."""
        return tuple(of_mount(tyre)[0] for tyre in self.mechanism.tyres)

    @property
    def struts(self) -> tuple[str, ...]:
        """Names of the struts, or of the device."""
        return tuple(strut.name for strut in self.mechanism.struts)

    @property
    def main_outputs(self) -> tuple[str, ...]:
        """Names of the outputs that a summary contains."""
        forces = tuple(name for strut in self.mechanism.struts for name in of_mount(strut))
        return (*self.accelerations, *self.displacements, *self.tyre_loads, *forces)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the road, on wheel lift-off, and on outputs whose samples are too far apart."""
        notes = (*self.request.notes, *self.run.notes)
        coarse = [in_words(name) for name in self.main_outputs if is_coarse(self.run[name])]
        if not coarse:
            return notes
        few = f"Fewer than about ten samples for each oscillation of {format_list(coarse)}"
        return (*notes, f"{few}: r.m.s. and extreme values may be wrong. Choose a smaller step, and keep every one.")

    def rms(self, name: str) -> float:
        """Root mean square of an output; infinite if the motion has grown without bound."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.run.rms(name)

    @cached_property
    def nonlinear(self) -> tuple[Nonlinear, ...]:
        """State statistics of every friction and gap; empty if the integrator records no events."""
        found = []
        length = float(self.run.time[-1] - self.run.time[0]) or 1.0
        for strut, label, element in self._elements_by_mount():
            if label in self.run.states and element.switch is not None:
                switch = element.switch
                shares = {
                    state: sum(end - start for start, end in self.run.intervals(label, state)) / length
                    for state in (switch.states[i] for i in element.possible)
                }
                events = sum(event.element == label for event in self.run.events)
                found.append(Nonlinear(label, element.key, switch, strut, events, shares))
        return tuple(found)

    @property
    def unrecorded_elements(self) -> tuple[str, ...]:
        """Frictions and gaps whose events the integrator does not record."""
        known = self.run.states
        return tuple(n for _, n, element in self._elements_by_mount() if element.switch is not None and n not in known)

    def inerters(self, strut: str) -> tuple[str, ...]:
        """Inerters of a strut, by output name."""
        return tuple(
            n for mount, n, element in self._elements_by_mount() if mount == strut and element.linear is LinearRole.MASS
        )

    def _elements_by_mount(self) -> Iterator[tuple[str, str, Element]]:
        mechanism = switching(self.mechanism)
        branches = iter(full_graph(mechanism).branches)
        for mount in mechanism.mounts():
            for _ in mount.network.elements():
                branch = next(branches)
                yield mount.name, branch.label, branch.element


def run_simulation(
    request: SimulationRequest,
    folder: Path,
    *,
    force: bool = False,
    progress: Callable[[float], None] | None = None,
    finish: Callable[[SimulationResult, Path], object] = lambda result, folder: None,
) -> SimulationResult:
    """Simulate `request` and write the trajectory, its events and the resolved request into `folder`.

    With `force`, old results stay until the new ones are whole. Numbers in files are in SI units. `finish` may add
    files to the results, in the folder that it is given.

    Raises `StudyError` as `open_results` does, and if the request cannot be simulated.
    """
    with open_results(WriteMode(folder, "simulate", NAMES, request.inputs, force=force)) as results:
        try:
            result = SimulationResult(request, request.run(progress))
        except InerterError as error:
            raise refusal(request.path, [at(("simulation",), str(error))]) from None
        _write(result, results.draft)
        results.publish()
        finish(result, results.draft)
    return result


def _write(result: SimulationResult, folder: Path) -> None:
    header = "".join(f"# {name} {version}\n" for name, version in versions().items())
    write_text(folder / RESOLVED, f"{header}\n{write_simulation(result.request)}")
    result.run.to_csv(folder / TRAJECTORY)
    result.run.events_to_csv(folder / EVENTS)
    write_netcdf(folder / DATASET, result.run.to_xarray())
