"""The time-stepping integrator behind `simulate`: its inputs, its start and its trajectory.

States (a, g) are those of `systems.piecewise`, so that either integrator goes on from where the other one ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from inerter.signals.signal import Signal
from inerter.simulation.initial_state import Initial, initial_state
from inerter.simulation.inputs import check_steps, just_before, whole_steps
from inerter.simulation.time_stepping import Histories, Start, StepTable, Stop, step_through
from inerter.simulation.trajectory import Trajectory
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem
from inerter.vehicle.mechanism import Mechanism

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TimeSteppingState:
    """Final state of a run by time stepping, from which another run of the same mechanism continues."""

    mechanism: Mechanism
    stop: Stop


def run(
    system: PiecewiseSystem,
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    initial: Initial,
    begin: float,
    duration: float,
    step: float,
    every: int,
) -> Trajectory:
    """Integrate from an initial state at `begin` [s] by time stepping.

    Raises `SimulationError` as `initial_state`, `tabulate` and `step_through` do.
    """
    table, roads = _table(system, signals, delays, begin, duration, step), len(system.mechanism.roads)
    first = np.array([np.concatenate([of_roads[:, 0], of_forces[:, 0]]) for of_roads, of_forces in _pairs(table)])
    state = initial_state(system, first[0], initial, first[1])
    before = just_before(signals, delays, begin, step) if isinstance(initial, Trajectory) else first
    ending = initial._ending if isinstance(initial, Trajectory) else None
    start = (
        ending.stop
        if isinstance(ending, TimeSteppingState) and ending.mechanism == system.mechanism
        else _start(system, table, state, before[0][:roads])
    )
    history = step_through(system.mechanism, system.graph, table, start, every)
    reached = int(
        np.sum(np.all(np.isfinite(history.displacement), axis=1) & np.all(np.isfinite(history.forces), axis=1))
    )
    end = float(history.time[reached - 1])
    given = _inputs_at_samples(table, just_before(signals, delays, end, step), every, reached)
    return Trajectory(
        time=history.time[:reached],
        integration_status=history.status,
        outputs=system.outputs,
        states={},
        final_state=_state_at(system, history, given, reached - 1),
        end=end,
        label="; ".join(dict.fromkeys(s.label for s in signals if s is not None)),
        _mechanism=system.mechanism,
        _ending=TimeSteppingState(system.mechanism, history.stop) if history.status.ok else None,
        _evaluate=partial(_evaluate, given, roads, history),
    )


def _table(
    system: PiecewiseSystem,
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    begin: float,
    duration: float,
    step: float,
) -> StepTable:
    """Roads and forces at every step; inputs without a signal are zero."""
    count = whole_steps(duration, step)
    check_steps(signals, step, begin + duration)
    value, slope = np.zeros((2, len(signals), count + 1))
    for i, (signal, delay) in enumerate(zip(signals, delays, strict=True)):
        if signal is not None:
            value[i], slope[i] = signal.grid(begin - delay, step, count + 1)
    hold = ["cubic" if s is None else s.hold for s in signals]
    roads = len(system.mechanism.roads)
    return StepTable(
        time=begin + step * np.arange(count + 1, dtype=np.float64),
        road=value[:roads],
        road_rate=slope[:roads],
        force=value[roads:],
        force_rate=slope[roads:],
        road_hold=tuple(hold[:roads]),
        force_hold=tuple(hold[roads:]),
    )


def _pairs(table: StepTable) -> tuple[tuple[Matrix, Matrix], tuple[Matrix, Matrix]]:
    """Roads and forces: their values, and their rates."""
    return (table.road, table.force), (table.road_rate, table.force_rate)


def _start(system: PiecewiseSystem, table: StepTable, state: Matrix, before: Matrix) -> Start:
    """Motions of all nodes in a state (a, g) over roads that were at the heights `before` and may have jumped since.

    Velocities are R a + V z', with massless nodes at rest. Displacements are the smallest that have the positions g,
    which fix the elongations of springs and gaps; those of other branches follow from the displacements.
    """
    R, _, V = system.motions
    a, g = np.split(state, [R.shape[1]])
    displacement = np.asarray(np.linalg.lstsq(system.positions, g - system.heights @ before, rcond=None)[0])
    over_g, over_z = system.elongations
    fixed = np.any(over_g, axis=1) | np.any(over_z, axis=1)
    nodes, roads = (np.array([getattr(b, of) for b in system.graph.branches]) for of in ("nodes", "roads"))
    elongations = np.where(fixed, over_g @ g + over_z @ before, nodes @ displacement + roads @ before)
    return Start(
        displacement=displacement,
        velocity=R @ a + V @ table.road_rate[:, 0],
        elongations=elongations + roads @ (table.road[:, 0] - before),
    )


def _inputs_at_samples(table: StepTable, last: Matrix, every: int, reached: int) -> Matrix:
    """(2, inputs, samples): values and slopes of all inputs at the samples, at the last one from the left."""
    given = np.array([np.vstack(pair)[:, ::every][:, :reached] for pair in _pairs(table)])
    given[:, :, -1] = last
    return given


def _state_at(system: PiecewiseSystem, history: Histories, given: Matrix, sample: int) -> Matrix:
    """The state (a, g) of a sample: its velocities are R a + N w + V z'."""
    R, N, V = system.motions
    z, rate = given[:, : V.shape[1], sample]
    a_and_w = np.linalg.lstsq(np.hstack([R, N]), history.velocity[sample] - V @ rate, rcond=None)[0]
    g = system.positions @ history.displacement[sample] + system.heights @ z
    return np.concatenate([a_and_w[: R.shape[1]], g])


def _evaluate(given: Matrix, roads: int, history: Histories, output: Output) -> Matrix:
    """The samples of an output."""
    reached = given.shape[2]
    total = np.zeros(reached)
    for weights, motions in (
        (output.displacement, history.displacement.T),
        (output.velocity, history.velocity.T),
        (output.acceleration, history.acceleration.T),
        (output.forces, history.forces.T),
        (output.road, given[0]),
        (output.road_velocity, given[1]),
        (output.external, given[0, roads:]),
    ):
        for i in np.flatnonzero(weights):
            total += weights[i] * motions[i, :reached]
    return total
