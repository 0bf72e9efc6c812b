"""`simulate`: the motion of a vehicle or rig with real friction and backlash."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import SimulationError, Status, StatusKind
from inerter.kernels.events import ENERGY, EVENTS, SEGMENT, SPECIAL, evaluate
from inerter.networks.elements import Damper, Friction, Spring
from inerter.signals.signal import Signal
from inerter.simulation import event_driven, stepped
from inerter.simulation.event_driven import Integration
from inerter.simulation.inputs import MEMORY_LIMIT, InputTable, assign, check_holds, tabulate, whole_steps
from inerter.simulation.start import Initial, initial_state
from inerter.simulation.trajectory import Energy, Event, Repetition, Trajectory
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem, output_rows, piecewise
from inerter.vehicle.cars import Vehicle

Matrix = NDArray[np.float64]
_CHUNK = 200_000  # segments between two looks at the keyboard
_PERIODS = 300
_REPEATS, _ENOUGH = 1e-10, 1e-6
_FRICTION = {-1: "slip down", 0: "stick", 1: "slip up"}
_GAP = {-1: "lower contact", 0: "open", 1: "upper contact"}


def simulate(
    vehicle: Vehicle,
    *,
    road: Signal | Mapping[str, Signal] | None = None,
    forces: Signal | Mapping[str, Signal] | None = None,
    displacement: Signal | None = None,
    duration: float | None = None,
    step: float = 2e-4,
    integrator: Literal["event-driven", "time-stepping"] = "event-driven",
    initial: Initial = "rest",
    speed: float | None = None,
    every: int = 1,
    energy: bool = False,
    memory_limit: float = MEMORY_LIMIT,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Simulate `vehicle` for `duration` [s] with true sticking and Nordin's backlash, sampled every `step` [s].

    `road` moves all roads, each after its delay at `speed` [m/s] (by default the signal's own); given by name, each
    road has its own signal and no further delay. `displacement` moves a rig; `forces` are external forces by name.
    Roads may all stay at rest while forces act, and forces that get no signal are zero.

    The event-driven integrator is exact between events for inputs that are cubics over a step (Hermite data, lines,
    holds), and finds events to near machine precision. `"time-stepping"` is independent of it, of first order in
    `step`, and takes any number of elements. `every` keeps each so-manieth step only.

    `initial`: `"rest"`, unstrained over the roads as they are at t = 0; `"preload"`, in static equilibrium under the
    forces as they are at t = 0; `"periodic"`, the steady state of a periodic input, repeated until the state repeats
    (`run.repetition` says how well), with one period as default duration; a trajectory, to go on from its end; or an
    array, the state itself. `energy` asks for the energy account, which takes about twenty times longer.

    Raises `SimulationError` for inputs that are missing, end too early or do not fit the step, and for a run that
    would need more than `memory_limit` [bytes]; `SignalError`, `MechanismError` and `DesignError` as signals and
    vehicles do. An integration that cannot go on ends in the trajectory's `status`.
    """
    system = piecewise(vehicle)
    signals, delays = assign(system.mechanism, road, forces, displacement, speed)
    if not is_number(every) or every != int(every) or every < 1:
        raise SimulationError(f"`every` must be a whole number of steps from 1 on, got {every!r}.")
    periodic = isinstance(initial, str) and initial == "periodic"
    period = common_period(signals) if periodic or duration is None else None
    if duration is None and period is None:
        raise SimulationError("Say how long to simulate: duration = ... [s].")
    length = period if periodic or duration is None else duration
    assert length is not None
    if periodic and duration is not None and abs(duration - length) > 1e-9 * length:
        raise SimulationError(
            f"A periodic steady state is recorded over one period, {length:g} s; got duration = {duration:g} s."
        )
    _check_memory(system, whole_steps(length, step), int(every), memory_limit)
    if integrator not in ("event-driven", "time-stepping"):
        raise SimulationError(f'The integrator is "event-driven" or "time-stepping", got {integrator!r}.')
    check_holds(system, signals)
    begin = initial.end if isinstance(initial, Trajectory) else 0.0
    if integrator == "time-stepping":
        if periodic or energy:
            raise SimulationError("A periodic steady state and the energy account need the event-driven integrator.")
        at = np.array([0.0 if s is None else s(begin - d) for s, d in zip(signals, delays, strict=True)])
        return stepped.run(system, signals, delays, initial_state(system, at, initial), begin, length, step, int(every))
    table = tabulate(signals, delays, length, step, int(every), begin)
    state, steady = initial_state(system, table.value[0], initial), None
    integration = event_driven.start(system, table, state, account=energy)
    if periodic:
        integration, steady = _settle(system, table, state, energy)
    segments = table.time.size - 1
    while integration.status.ok and integration.place[SEGMENT] < segments:
        integration.advance(min(segments, int(integration.place[SEGMENT]) + _CHUNK))
        if progress is not None:
            progress(integration.place[SEGMENT] / segments)
    label = "; ".join(dict.fromkeys(s.label for s in signals if s is not None))
    return trajectory_of(integration, steady, label, state)


def common_period(signals: Sequence[Signal | None]) -> float:
    """The period of all signals [s].

    Raises `SimulationError` if one has none, or if no period is a multiple of all.
    """
    moving = [s for s in signals if s is not None]
    for signal in moving:
        if signal.period is None:
            raise SimulationError(
                f"The signal {signal.label!r} does not repeat: give a duration, or a periodic signal."
            )
    if not moving:
        raise SimulationError("Nothing moves the mechanism: give a road, forces or a displacement.")
    period = max(float(s.period or 0.0) for s in moving)
    for signal in moving:
        ratio = period / float(signal.period or 1.0)
        if abs(ratio - round(ratio)) > 1e-9 * ratio:
            raise SimulationError(
                f"The periods of {', '.join(f'{s.period:g}' for s in moving)} s are not multiples of each other."
            )
    return period


def _settle(system: PiecewiseSystem, table: InputTable, state: Matrix, energy: bool) -> tuple[Integration, Repetition]:
    """Repeat one period until the state repeats; an integration at the start of the one to record."""
    last = table.time.size - 1
    before, slope = table.value_before.copy(), table.slope_before.copy()
    before[0], slope[0] = before[last], slope[last]
    special = table.special
    if not np.array_equal(before[0], table.value[0]) and special[0] != 0:
        special = np.concatenate([[0], special])
    quick = event_driven.start(system, table, state, keep=False)
    quick.advance(last)
    quick.record = quick.record._replace(value_before=before, slope_before=slope, special=special)
    mismatch, periods = np.inf, 1
    while quick.status.ok and periods < _PERIODS and mismatch > _REPEATS:
        begun = quick.state
        quick.place[[SEGMENT, SPECIAL, EVENTS]] = 0
        quick.advance(last)
        periods += 1
        mismatch = quick.mismatch(begun)
    recorded = event_driven.start(system, table, quick.state, account=energy)
    recorded.record = recorded.record._replace(value_before=before, slope_before=slope, special=special)
    recorded.status = quick.status
    if quick.status.ok and mismatch > _ENOUGH:
        recorded.warning = Status(
            StatusKind.INACCURATE, f"after {periods} periods the state still changes by {mismatch:.1e} of its size"
        )
    return recorded, Repetition(float(table.time[-1] - table.time[0]), periods, mismatch)


def trajectory_of(integration: Integration, steady: Repetition | None, label: str, state: Matrix) -> Trajectory:
    system, table, record = integration.system, integration.table, integration.record
    kinds = [_FRICTION if isinstance(system.graph.branches[i].element, Friction) else _GAP for i in system.nonlinear]
    labels = system.elements
    rows = record.events[: integration.place[EVENTS]]

    def events() -> tuple[Event, ...]:
        listed = ((t, int(e), int(a), int(b)) for t, e, a, b in rows.tolist())
        return tuple(Event(t, labels[e], kinds[e][a], kinds[e][b]) for t, e, a, b in listed)

    reached, roads = table.samples, len(system.mechanism.roads)
    if not integration.status.ok:
        reached = int(np.sum(table.slot[: integration.place[SEGMENT] + 1] >= 0))
    first = integration.modes.state[record.visited[0]]
    states = {name: kind[int(s)] for name, kind, s in zip(labels, kinds, first, strict=False)}
    visited, history = record.visited[:reached], np.ascontiguousarray(record.states[:reached])

    def output(wanted: Output) -> Matrix:
        on_x, on_u, on_eta = output_rows(system, wanted)
        n, nu = on_x.size, on_u.size
        eta = integration.modes.maps[: integration.count, integration.eta]
        over = np.concatenate([on_x, on_u, [0.0]]) + np.einsum("i,mij->mj", on_eta, eta)
        out = np.empty(reached)
        channel = [*range(roads)] * 3 + [*range(roads, nu - 2 * roads)]
        used = [i for i in range(nu) if np.any(over[:, n + i]) and table.moving[channel[i]]]
        over = np.ascontiguousarray(np.concatenate([over[:, :n], over[:, [n + i for i in used]], over[:, -1:]], axis=1))
        inputs = np.empty((reached, len(used)))
        for column, i in enumerate(used):
            inputs[:, column] = sampled_input(table, i // roads if i < 3 * roads else 0, channel[i])[:reached]
        evaluate(over, visited, history, inputs, out)
        return out

    return Trajectory(
        time=table.sampled[:reached],
        status=integration.status if not integration.status.ok else integration.warning,
        outputs=system.outputs,
        states=states,
        energy=_energy(integration, state if steady is None else record.states[0]) if integration.account else None,
        repetition=steady,
        final_state=integration.state,
        end=integration.now,
        label=label,
        _evaluate=output,
        _list_events=events,
    )


def sampled_input(table: InputTable, derivative: int, channel: int) -> Matrix:
    """An input, or its first or second derivative, at the samples, from the right (at the last one from the left)."""
    at = np.flatnonzero(table.slot >= 0)
    if derivative < 2:
        return np.asarray((table.value, table.slope)[derivative][at, channel])
    segment = np.minimum(at, table.time.size - 2)
    length = np.diff(table.time)[segment]
    rise = table.value_before[segment + 1, channel] - table.value[segment, channel]
    s0, s1 = length * table.slope[segment, channel], length * table.slope_before[segment + 1, channel]
    first, last = 6.0 * rise - 4.0 * s0 - 2.0 * s1, -6.0 * rise + 2.0 * s0 + 4.0 * s1
    return np.asarray(np.where(at == segment, first, last) / length**2)


def _energy(integration: Integration, start: Matrix) -> Energy:
    system, table = integration.system, integration.table
    names = [*(r.name for r in system.mechanism.roads), *(f.name for f in system.mechanism.forces)]
    sums = integration.work[ENERGY]
    branches = list(zip(system.graph.branches, sums[len(names) :], strict=False))
    knot = int(integration.place[SEGMENT])
    return Energy(
        inputs={name: float(w) for name, w in zip(names, sums, strict=False)},
        stored=_stored(system, table, integration.state, knot, -1) - _stored(system, table, start, 0, 1),
        dampers={b.label: float(w) for b, w in branches if isinstance(b.element, Damper)},
        friction={b.label: float(w) for b, w in branches if isinstance(b.element, Friction)},
    )


def _stored(system: PiecewiseSystem, table: InputTable, state: Matrix, knot: int, side: int) -> float:
    """Kinetic and elastic energy [J]."""
    roads, na = len(system.mechanism.roads), system.motions[0].shape[1]
    z = (table.value if side > 0 else table.value_before)[knot, :roads]
    rate = (table.slope if side > 0 else table.slope_before)[knot, :roads]
    speeds = system.kinetic @ state[:na] + system.kinetic_road @ rate
    lengths = system.elongations[0] @ state[na:] + system.elongations[1] @ z
    k = np.array([float(b.element.value) if isinstance(b.element, Spring) else 0.0 for b in system.graph.branches])  # type: ignore[arg-type]
    return float(0.5 * system.inertia @ speeds**2 + 0.5 * k @ lengths**2)


def _check_memory(system: PiecewiseSystem, steps: int, every: int, limit: float) -> None:
    channels = len(system.mechanism.roads) + len(system.mechanism.forces)
    needed = 8.0 * (steps * (2 + 6 * channels) + steps / every * (system.order + 3 * channels + 4))
    if not is_number(limit) or needed > limit:
        raise SimulationError(
            f"The run needs about {needed / 2**30:.3g} GiB for {steps} steps, more than the limit of "
            f"{limit / 2**30 if is_number(limit) else limit:.3g} GiB. Take a longer step, a shorter duration, "
            f"every = {2 * every} or more, simulate_many(...) for mean squares alone, or a higher memory_limit."
        )
