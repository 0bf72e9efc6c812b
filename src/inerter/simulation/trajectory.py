"""Results of a simulation: outputs by name, events, energy, and how far they can be trusted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.atomic_io import export, export_csv
from inerter.deprecation import RenamedAttribute
from inerter.errors import MechanismError, SimulationError, Status, StatusKind, worst_of
from inerter.notebook import shown_by
from inerter.simulation.peaks import LiftOff, Peak, lift_off_sentence, lift_offs_of, peak_of
from inerter.systems.outputs import Output, find
from inerter.systems.static_loads import static_tyre_loads
from inerter.vehicle.mechanism import Mechanism

if TYPE_CHECKING:
    import xarray

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """An element's change of state: friction `slip up`, `stick`, `slip down`; gap `open`, `upper contact`, ..."""

    time: float  # [s]
    element: str
    before: str
    after: str


@dataclass(frozen=True)
class Energy:
    """Energy balance [J]: work of the inputs, change in stored energy, and dissipation in dampers and friction."""

    inputs: Mapping[str, float]  # work of each road and force
    stored: float  # gained by masses, inerters and springs
    dampers: Mapping[str, float]
    friction: Mapping[str, float]

    @property
    def input_work(self) -> float:
        """Work of all inputs [J]."""
        return sum(self.inputs.values())

    put_in = RenamedAttribute("input_work")

    @property
    def residual(self) -> float:
        """Residual of the energy balance [J]."""
        return self.input_work - self.stored - sum(self.dampers.values()) - sum(self.friction.values())

    @property
    def relative_residual(self) -> float:
        """The residual over the largest of the account's sums; zero if nothing moved."""
        dissipated = sum(self.dampers.values()) + sum(self.friction.values())
        size = max(sum(abs(w) for w in self.inputs.values()), abs(self.stored), dissipated)
        return abs(self.residual) / size if size > 0.0 else 0.0


@dataclass(frozen=True)
class PeriodicState:
    """Convergence of a periodic response: period, number of periods, and remaining change per period."""

    period: float  # [s]
    periods: int
    mismatch: float  # largest change of the state over one period, relative to its largest value
    creep: float = 0.0  # the change that is left by the decline of the changes, relative to the same

    @property
    def remaining_change(self) -> float:
        """Estimated distance of the state from its limit, relative to its largest value.

        Changes that have become so small over so many periods, each as much smaller than the last, add up to that.
        """
        if not 0.0 < self.mismatch < 1.0:
            return self.mismatch
        return float(self.mismatch / (1.0 - self.mismatch ** (1.0 / self.periods)))

    @property
    def remaining_share(self) -> float:
        """Largest share of a motion that remains after one period; see `remaining_share_of`."""
        return remaining_share_of(self.mismatch, self.periods - 1.0)

    left = RenamedAttribute("remaining_share")


def remaining_share_of(mismatch: float, periods: float) -> float:
    """Largest share of a motion that remains after one period, from the relative change of state over the last one.

    In the `periods` before that, the motion lacking at first, at least a tenth as large as the state, falls to the
    change. This is an upper bound for several modes, whose decays add up to less than the first of them alone would.
    """
    return float(min((10.0 * mismatch) ** (1.0 / periods), 1.0)) if periods > 0.0 else 1.0


@dataclass(frozen=True, eq=False)
class FinalState:
    """Contact state and scales with which, besides the state, another simulation of the mechanism continues exactly."""

    mechanism: Mechanism
    mode: tuple[int, ...]  # states of friction and gaps
    scale: Matrix  # largest size of the state so far


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A simulated motion; `run["name"]` is an output along `time`.

    `outputs` lists all names with units. If the integration had to stop, `status` says why and `time` ends there; if a
    tyre pulls on its road, `status` says from when on the motion is not that of a vehicle.

    >>> import inerter as it
    >>> run = it.simulate(it.Rig(it.Damper(100.0)), displacement=it.sine(0.01, 1.0), duration=2.0)
    >>> run.status.ok, run.unit("device_force"), run["device_force"].shape == run.time.shape
    (True, 'N', True)
    >>> round(run.rms("device_force"), 2) == round(100.0 * 0.01 * 2 * 3.141592653589793 / 2**0.5, 2)
    True
    """

    _repr_html_ = shown_by("inerter.report.notebook:trajectory_html")

    time: Matrix  # [s]
    integration_status: Status
    outputs: Mapping[str, Output]
    states: Mapping[str, str]  # state of every nonlinear element at the start
    energy: Energy | None = None  # if it was asked for
    repetition: PeriodicState | None = None  # of a periodic steady state
    final_state: Matrix = field(default_factory=lambda: np.zeros(0))  # to go on from: simulate(..., initial=...)
    end: float = 0.0  # [s] when that is
    label: str = ""  # of the signals
    _mechanism: Mechanism | None = field(repr=False, default=None)
    _ending: object = field(repr=False, default=None)  # what the integrator that made it needs to go on from here
    _evaluate: Callable[[Output], Matrix] = field(repr=False, default=lambda output: np.zeros(0))
    _list_events: Callable[[], tuple[Event, ...]] = field(repr=False, default=tuple)
    _known: dict[str, Any] = field(repr=False, default_factory=dict)

    @property
    def mechanism(self) -> Mechanism | None:
        """Mechanism that moved; None where it is not known."""
        return self._mechanism

    @property
    def events(self) -> tuple[Event, ...]:
        """Every change of state of a friction or gap, in order."""
        if "" not in self._known:
            self._known[""] = self._list_events()
        return tuple(self._known[""])

    def __getitem__(self, name: str) -> Matrix:
        """The output `name` at `time`.

        Raises `SimulationError` for a name that is not there.
        """
        output = find(self.outputs, name, SimulationError)
        if name not in self._known:
            self._known[name] = self._evaluate(output)
        return np.asarray(self._known[name])

    def evaluate(self, output: Output) -> Matrix:
        """Samples of an output that has no name of its own.

        Its displacements must be combinations of coordinates and of elongations of springs and gaps.
        """
        return self._evaluate(output)

    def rms(self, name: str) -> float:
        """Root of the mean square of an output over the time of the samples, by the trapezoidal rule.

        Samples are evenly spaced; the two ends of a period, which are one instant, count as one of them.
        """
        values = self[name]
        if values.size == 1:
            return abs(float(values[0]))
        ends = 0.5 * (values[0] ** 2 + values[-1] ** 2)
        total = np.einsum("i,i", values, values)  # not a product of BLAS, whose threads would spin for longer
        return float(np.sqrt((total - ends) / (values.size - 1)))

    def peak(self, name: str) -> Peak:
        """The sample of an output that is farthest from zero, and when it was."""
        return peak_of(self.time, self[name])

    @property
    def static_loads(self) -> dict[str, float]:
        """Static load of each tyre [N], by name; empty where unknown, with the reason in `notes`."""
        return self._static_loads[0]

    @cached_property
    def _static_loads(self) -> tuple[dict[str, float], str]:
        """Static loads of the tyres [N], and the reason if they are unknown."""
        try:
            return ({} if self._mechanism is None else static_tyre_loads(self._mechanism)), ""
        except MechanismError as problem:
            return {}, str(problem)

    @property
    def least_tyre_loads(self) -> dict[str, Peak]:
        """The least force with which each tyre presses on the road [N], and when; negative where it would lift off."""
        found = {}
        for tyre, static in self.static_loads.items():
            pressing = static - self[_load(tyre)]
            at = int(np.argmin(pressing))
            found[tyre] = Peak(float(pressing[at]), float(self.time[at]))
        return found

    @cached_property
    def lift_offs(self) -> tuple[LiftOff, ...]:
        """Intervals of wheel lift-off, in which a tyre pulls by more than its static load, in the order of time."""
        found = [
            one
            for tyre, static in self.static_loads.items()
            for one in lift_offs_of(tyre, self.time, self[_load(tyre)], static)
        ]
        return tuple(sorted(found, key=lambda one: one.begin))

    @cached_property
    def status(self) -> Status:
        """Whether the integration is accurate, and whether all tyres stay on their roads as its model has it."""
        if not self.lift_offs:
            return self.integration_status
        pulled = Status(StatusKind.INACCURATE, lift_off_sentence(self.lift_offs))
        return worst_of((self.integration_status, pulled))

    @property
    def notes(self) -> tuple[str, ...]:
        """What could not be checked."""
        _, unknown = self._static_loads
        return (f"Wheel lift-off cannot be checked. {unknown}",) if unknown else ()

    def unit(self, name: str) -> str:
        """Unit of an output."""
        self[name]
        return self.outputs[name].unit

    def intervals(self, element: str, state: str) -> list[tuple[float, float]]:
        """The times [s] between which a nonlinear element was in a state.

        Raises `SimulationError` for an unknown element.
        """
        if element not in self.states:
            known = ", ".join(self.states) or "none"
            raise SimulationError(f"Unknown friction or gap {element!r}; available: {known}.")
        found: list[tuple[float, float]] = []
        since, now = float(self.time[0]), self.states[element]
        for event in self.events:
            if event.element == element:
                if now == state and event.time > since:
                    found.append((since, event.time))
                since, now = event.time, event.after
        if now == state:
            found.append((since, float(self.time[-1])))
        return found

    def _names_or_all(self, names: Sequence[str] | None) -> list[str]:
        """The named outputs, or all."""
        return list(self.outputs) if names is None else [names] if isinstance(names, str) else list(names)

    def to_xarray(self, names: Sequence[str] | None = None) -> xarray.Dataset:
        """The named outputs, or all, as a dataset over `time` with units and long names."""
        import xarray  # noqa: PLC0415 - heavy

        chosen = self._names_or_all(names)
        data = {
            name: ("time", self[name], {"units": self.outputs[name].unit, "long_name": self.outputs[name].title})
            for name in chosen
        }
        coords = {"time": ("time", self.time, {"units": "s", "long_name": "time"})}
        return xarray.Dataset(data, coords, {"signal": self.label, "status": str(self.status)})

    def to_csv(self, path: str | Path, names: Sequence[str] | None = None, *, overwrite: bool = False) -> None:
        """Write the named outputs, or all, with a header `name [unit]`; numbers read back to the last bit.

        Raises `SimulationError` if the file cannot be written, or exists and `overwrite` does not say to replace it.
        """
        chosen = self._names_or_all(names)
        header = ["time [s]", *(f"{name} [{self.outputs[name].unit}]" for name in chosen)]
        rows = np.column_stack([self.time, *(self[name] for name in chosen)]).tolist()
        export_csv(path, SimulationError, header, rows, overwrite=overwrite)

    def events_to_csv(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the table of events.

        Raises `SimulationError` if the file cannot be written, or exists and `overwrite` does not say to replace it.
        """
        header = ["time [s]", "element", "from", "to"]
        rows = ((event.time, event.element, event.before, event.after) for event in self.events)
        export_csv(path, SimulationError, header, rows, overwrite=overwrite)

    def to_mat(self, path: str | Path, names: Sequence[str] | None = None, *, overwrite: bool = False) -> None:
        """Write a MATLAB 5 file with `time`, the named outputs, or all, a struct `units`, and the events.

        Raises `SimulationError` if the file cannot be written, or exists and `overwrite` does not say to replace it.
        """
        chosen = self._names_or_all(names)
        data: dict[str, Any] = {name[:31]: self[name] for name in chosen}
        data["time"] = self.time
        data["units"] = {name[:31]: self.outputs[name].unit for name in chosen}
        data["events"] = {
            "time": np.array([e.time for e in self.events]),
            "element": np.array([e.element for e in self.events], dtype=object),
            "before": np.array([e.before for e in self.events], dtype=object),
            "after": np.array([e.after for e in self.events], dtype=object),
        }
        with export(path, SimulationError, overwrite=overwrite) as draft:
            scipy.io.savemat(draft, data, oned_as="column", long_field_names=True)


def _load(tyre: str) -> str:
    """The output that is the force of a tyre."""
    return f"{tyre}_load"
