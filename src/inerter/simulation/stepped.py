"""The time-stepping integrator behind `simulate`: its inputs, its start and its trajectory.

States (a, g) are those of `systems.piecewise`, so that either integrator goes on from where the other one ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from inerter.signals.signal import Signal
from inerter.simulation.inputs import check_steps, whole_steps
from inerter.simulation.time_stepping import Histories, Start, StepTable, step_through
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
    reached = int(
        np.sum(np.all(np.isfinite(history.displacement), axis=1) & np.all(np.isfinite(history.forces), axis=1))
    )
    return Trajectory(
        time=history.time[:reached],
        status=history.status,
        outputs=system.outputs,
        states={},
        final_state=_state_at(system, table, history, reached - 1, (reached - 1) * every),
        end=float(history.time[reached - 1]),
        label="; ".join(dict.fromkeys(s.label for s in signals if s is not None)),
        _evaluate=partial(_evaluate, table, history, every, reached),
    )


def _table(
    system: PiecewiseSystem,
    signals: Sequence[Signal | None],
    delays: Sequence[float],
    begin: float,
    duration: float,
    step: float,
) -> StepTable:
    """Roads and forces at every step; what has no signal stays at zero."""
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


def _start(system: PiecewiseSystem, table: StepTable, state: Matrix) -> Start:
    """Motions of all nodes in a state (a, g).

    Velocities are R a + V z', with massless nodes at rest. Displacements are the smallest that have the positions g,
    which fix the elongations of springs and gaps; those of other branches follow from the displacements.
    """
    R, _, V = system.motions
    a, g = np.split(state, [R.shape[1]])
    z, rate = table.road[:, 0], table.road_rate[:, 0]
    displacement = np.asarray(np.linalg.lstsq(system.positions, g - system.heights @ z, rcond=None)[0])
    over_g, over_z = system.elongations
    fixed = np.any(over_g, axis=1) | np.any(over_z, axis=1)
    others = np.array([b.nodes @ displacement + b.roads @ z for b in system.graph.branches])
    return Start(
        displacement=displacement,
        velocity=R @ a + V @ rate,
        elongations=np.where(fixed, over_g @ g + over_z @ z, others),
    )


def _state_at(system: PiecewiseSystem, table: StepTable, history: Histories, sample: int, step: int) -> Matrix:
    """The state (a, g) of a sample: its velocities are R a + N w + V z'."""
    R, N, V = system.motions
    z, rate = table.road[:, step], table.road_rate[:, step]
    a_and_w = np.linalg.lstsq(np.hstack([R, N]), history.velocity[sample] - V @ rate, rcond=None)[0]
    g = system.positions @ history.displacement[sample] + system.heights @ z
    return np.concatenate([a_and_w[: R.shape[1]], g])


def _evaluate(table: StepTable, history: Histories, every: int, reached: int, output: Output) -> Matrix:
    """The samples of an output."""
    total = np.zeros(history.time.size)
    for weights, motions in (
        (output.displacement, history.displacement.T),
        (output.velocity, history.velocity.T),
        (output.acceleration, history.acceleration.T),
        (output.forces, history.forces.T),
        (output.road, table.road[:, ::every]),
        (output.road_velocity, table.road_rate[:, ::every]),
        (output.external, table.force[:, ::every]),
    ):
        for i in np.flatnonzero(weights):
            total += weights[i] * motions[i]
    return total[:reached]
