"""The time-stepping integrator behind `simulate`: its inputs, its start and its trajectory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.signals.signal import Signal
from inerter.simulation.inputs import check_steps, whole_steps
from inerter.simulation.time_stepping import Start, StepTable, step_through
from inerter.simulation.trajectory import Trajectory
from inerter.systems.outputs import Output
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]


def run(
    system: PiecewiseSystem,
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    state: Matrix,
    begin: float,
    duration: float,
    step: float,
    every: int,
) -> Trajectory:
    """Integrate from `state` at `begin` [s] by time stepping.

    Raises `SimulationError` as `tabulate` and `step_through` do.
    """
    table = _table(system, signals, delays, begin, duration, step)
    history = step_through(system.mechanism, system.graph, table, _start(system, table, state), every)
    height, rate = table.road[:, ::every], table.road_rate[:, ::every]

    def output(wanted: Output) -> Matrix:
        total = np.zeros(history.time.size)
        for rows, values in (
            (wanted.displacement, history.displacement.T),
            (wanted.velocity, history.velocity.T),
            (wanted.acceleration, history.acceleration.T),
            (wanted.forces, history.forces.T),
            (wanted.road, height),
            (wanted.road_velocity, rate),
            (wanted.external, table.force[:, ::every]),
        ):
            for i in np.flatnonzero(rows):
                total += rows[i] * values[i]
        return total

    R, N, V = system.motions
    last = history.velocity[-1] - V @ table.road_rate[:, -1]
    a = np.linalg.lstsq(np.hstack([R, N]), last, rcond=None)[0][: R.shape[1]]
    g = system.positions @ history.displacement[-1] + system.heights @ table.road[:, -1]
    return Trajectory(
        time=history.time,
        status=history.status,
        outputs=system.outputs,
        states={},
        final_state=np.concatenate([a, g]),
        end=float(history.time[-1]),
        label="; ".join(dict.fromkeys(s.label for s in signals if s is not None)),
        _evaluate=output,
    )


def _table(
    system: PiecewiseSystem,
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    begin: float,
    duration: float,
    step: float,
) -> StepTable:
    count = whole_steps(duration, step)
    check_steps(signals, step, begin + duration)
    values = [
        (np.zeros(count + 1), np.zeros(count + 1)) if s is None else s.grid(begin - d, step, count + 1)
        for s, d in zip(signals, delays, strict=True)
    ]
    value, slope = (np.array([pair[i] for pair in values]).reshape(len(signals), count + 1) for i in range(2))
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


def _start(system: PiecewiseSystem, table: StepTable, state: Matrix) -> Start:
    """Displacements, velocities and elongations of the state."""
    na = system.motions[0].shape[1]
    z, rate = table.road[:, 0], table.road_rate[:, 0]
    displacement = np.linalg.lstsq(system.positions, state[na:] - system.heights @ z, rcond=None)[0]
    branches = system.graph.branches
    elongations = np.array([b.nodes @ displacement + b.roads @ z for b in branches])
    known = np.any(system.elongations[0], axis=1) | np.any(system.elongations[1], axis=1)
    exact = system.elongations[0] @ state[na:] + system.elongations[1] @ z
    return Start(
        displacement=np.asarray(displacement, dtype=np.float64),
        velocity=system.motions[0] @ state[:na] + system.motions[2] @ rate,
        elongations=np.where(known, exact, elongations),
    )
