"""`simulate`: the motion of a vehicle or rig with real friction and backlash."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Unpack

import numpy as np

from inerter.errors import SimulationError
from inerter.formatting import format_alike
from inerter.signals.signal import Signal
from inerter.simulation import event_driven, time_stepping_run
from inerter.simulation.event_driven import check_elements
from inerter.simulation.initial_state import Initial, ending_of, initial_state
from inerter.simulation.inputs import (
    MEMORY_LIMIT,
    RunInputs,
    assign,
    check_holds,
    check_keywords,
    check_steps,
    initial_of,
    tabulate_once,
    whole_steps,
)
from inerter.simulation.observe import trajectory_of
from inerter.simulation.periodic_steady_state import common_period, settle
from inerter.simulation.trajectory import Trajectory
from inerter.systems.piecewise import PiecewiseSystem, piecewise
from inerter.validation import checked, is_number, use_python_numbers
from inerter.vehicle.mechanism import GROUND_ACCELERATION
from inerter.vehicle.vehicle import Vehicle

_REPORTS = 100  # of progress


@dataclass(frozen=True)
class RunSettings:
    """Integration settings, as the keywords of `simulate`."""

    duration: float | None = None  # [s]
    step: float = 2e-4  # [s]
    integrator: str = "event-driven"
    every: int = 1
    energy: bool = False
    memory_limit: float = MEMORY_LIMIT  # [bytes]

    def __post_init__(self) -> None:
        use_python_numbers(self)


@dataclass(frozen=True, eq=False)
class _Plan:
    """A run whose arguments go together."""

    system: PiecewiseSystem
    signals: tuple[Signal | None, ...]  # of roads, then forces
    delays: tuple[float, ...]  # [s]
    initial: Initial
    length: float = 0.0  # [s]

    @property
    def is_periodic(self) -> bool:
        """Whether the periodic steady state is requested."""
        return isinstance(self.initial, str) and self.initial == "periodic"

    @property
    def begin(self) -> float:
        """The time at which it begins [s]."""
        return self.initial.end if isinstance(self.initial, Trajectory) else 0.0


@checked(SimulationError)
def simulate(
    vehicle: Vehicle,
    *,
    duration: float | None = None,
    step: float = 2e-4,
    integrator: Literal["event-driven", "time-stepping"] = "event-driven",
    every: int = 1,
    energy: bool = False,
    memory_limit: float = MEMORY_LIMIT,
    progress: Callable[[float], None] | None = None,
    **driven: Unpack[RunInputs],
) -> Trajectory:
    """Simulate `vehicle` for `duration` [s] with true sticking and Nordin's backlash, sampled every `step` [s].

    The keywords of `RunInputs` are the excitation and the initial state. `road` moves all roads, each after its delay
    at `speed` [m/s] (by default the signal's own); given by name, each road has its own signal and no further delay.
    `displacement` moves a rig; `forces` are external forces by name. Roads may all stay at rest while forces act, and
    forces that get no signal are zero. The force "ground_acceleration" [m/s^2, up positive] shakes the ground of any
    vehicle with masses: displacements and velocities are then relative to it.

    The event-driven integrator is exact between events for inputs that are cubics over a step (Hermite data, lines,
    holds), and finds events to near machine precision. `"time-stepping"` is independent of it, of first order in
    `step`, and takes any number of elements. `every = n` keeps every n-th step only.

    `initial`: `"rest"`, as without it, unstrained over the roads as they are at t = 0; `"preload"`, in static
    equilibrium under the forces as they are at t = 0; `"periodic"`, the steady state of a periodic input, repeated
    until the state repeats (`run.repetition` says how well), with one period as default duration; a trajectory, to go
    on from its end; or an array, the state itself. `energy` requests the energy balance, which takes ten to
    twenty times longer.

    Raises `SimulationError` for inputs that are missing, end too early or do not fit the step, and for a run that
    would need more than `memory_limit` [bytes]; `SignalError`, `MechanismError` and `DesignError` as signals and
    vehicles do. An integration that cannot go on ends in the trajectory's `status`.

    >>> import inerter as it
    >>> stuck = it.Rig(it.Spring(1e5) - it.Friction(10.0))
    >>> run = it.simulate(stuck, displacement=it.sine(0.01, 1.0), duration=0.25)  # m, Hz, s
    >>> float(run["device_force"][-1]), len(run.events) > 0  # N
    (10.0, True)
    """
    check_keywords("simulate", driven)
    plan = _plan(vehicle, driven, RunSettings(duration, step, integrator, every, energy, memory_limit))
    system, signals, delays, initial, length = plan.system, plan.signals, plan.delays, plan.initial, plan.length
    if integrator == "time-stepping":
        return time_stepping_run.run(system, signals, delays, initial, plan.begin, length, step, int(every))
    joined = isinstance(initial, Trajectory)
    table = tabulate_once(signals, delays, length, step, int(every), plan.begin, joined)
    state, steady = initial_state(system, table.value[0], initial, table.slope[0]), None
    integration = event_driven.start_finely(system, table, state, account=energy, after=ending_of(initial))
    if plan.is_periodic:
        integration, steady = settle(system, table, state, energy)
    segments = integration.table.time.size - 1
    reports = 1 if progress is None else _REPORTS
    for part in range(1, reports + 1):
        integration.advance(segments * part // reports)
        if progress is not None:
            progress(integration.segment / segments)
    if integration.status.ok:
        integration.ended_on(table.repeating if plan.is_periodic else table)
    label = "; ".join(dict.fromkeys(s.label for s in signals if s is not None))
    return trajectory_of(integration, steady, label)


def check_simulation(vehicle: Vehicle, driven: RunInputs, settings: RunSettings) -> int:
    """The number of steps; raises what `simulate` would raise before it begins to integrate."""
    plan = _plan(vehicle, driven, settings)
    if settings.integrator != "time-stepping":
        check_elements(plan.system)
    check_steps(plan.signals, settings.step, plan.begin + plan.length)
    first = np.zeros((2, len(plan.signals)))
    for i, (signal, delay) in enumerate(zip(plan.signals, plan.delays, strict=True)):
        if signal is not None:
            first[:, i] = np.ravel(signal.sample(np.array([plan.begin - delay])))
    initial_state(plan.system, first[0], plan.initial, first[1])
    return whole_steps(plan.length, settings.step)


def _plan(vehicle: Vehicle, driven: RunInputs, settings: RunSettings) -> _Plan:
    initial = initial_of(driven)
    moved: dict[str, Any] = {name: given for name, given in driven.items() if name != "initial"}
    system = piecewise(_on_its_ground(vehicle, driven.get("forces")))
    signals, delays = assign(system.mechanism, **moved)
    plan = _Plan(system, tuple(signals), tuple(delays), initial)
    known = common_period(signals) if plan.is_periodic or settings.duration is None else None
    plan = replace(plan, length=_length(settings.duration, known, plan.is_periodic))
    _check_every(settings.every)
    _check_memory(system, whole_steps(plan.length, settings.step), int(settings.every), settings.memory_limit)
    if settings.integrator not in ("event-driven", "time-stepping"):
        raise SimulationError(f'The integrator is "event-driven" or "time-stepping", got {settings.integrator!r}.')
    check_holds(system, signals)
    if settings.integrator == "time-stepping" and (plan.is_periodic or settings.energy):
        raise SimulationError("A periodic steady state and the energy account need the event-driven integrator.")
    return plan


def _on_its_ground(vehicle: Vehicle, forces: object) -> Vehicle:
    """The vehicle on moving ground if the acceleration of the ground is among the forces that excite it."""
    if not isinstance(forces, Mapping) or GROUND_ACCELERATION not in forces:
        return vehicle
    mechanism = vehicle.mechanism()
    is_own = GROUND_ACCELERATION in [force.name for force in mechanism.forces]
    has_mass = any(not coordinate.angle for coordinate in mechanism.coordinates)
    return mechanism.on_moving_ground() if has_mass and not is_own else vehicle


def _length(duration: float | None, period: float | None, periodic: bool) -> float:
    """Simulated time [s]: `duration`, or one period by default."""
    if duration is None:
        assert period is not None
        return period
    if periodic and period is not None and abs(duration - period) > 1e-9 * period:
        one, asked = format_alike([period, duration], "s")
        raise SimulationError(f"A periodic steady state is recorded over one period, {one}; got duration = {asked}.")
    return duration


def _check_every(every: object) -> None:
    if not is_number(every) or every != int(every) or every < 1:
        raise SimulationError(f"`every` must be a positive whole number of steps, got {every!r}.")


def _check_memory(system: PiecewiseSystem, steps: int, every: int, limit: float) -> None:
    channels = len(system.mechanism.roads) + len(system.mechanism.forces)
    needed = 8.0 * (steps * (2 + 6 * channels) + steps / every * (system.order + 3 * channels + 4))
    if not is_number(limit) or needed > limit:
        size, most = format_alike([needed / 2**30, limit / 2**30 if is_number(limit) else limit], "GiB", 3)
        raise SimulationError(
            f"The run needs about {size} for {steps} steps, more than the limit of {most}. "
            f"Take a longer step, a shorter "
            f"duration, every = {2 * every} or more, simulate_many(...) for mean squares alone, or a higher "
            f"memory_limit."
        )
