"""Periodic steady states: a period is repeated until the state repeats."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SimulationError, Status, StatusKind
from inerter.formatting import format_alike, format_number
from inerter.signals.signal import Signal
from inerter.simulation import event_driven
from inerter.simulation.event_driven import Integration
from inerter.simulation.initial_state import initial_state
from inerter.simulation.inputs import InputTable
from inerter.simulation.trajectory import PeriodicState, remaining_share_of
from inerter.systems.piecewise import PiecewiseSystem

Matrix = NDArray[np.float64]
_PERIODS, _RECORDED, FEW_PERIODS = 300, 12, 30
_SETTLING = 20.0  # [s]
_REPEATS, _ENOUGH = 1e-10, 1e-6  # changes of the state over a period, relative to its size
_CREEP = 1e-4  # of its size: what a state that nearly repeats may still lack of the one that it approaches


def common_period(signals: Sequence[Signal | None]) -> float:
    """The period of all signals [s].

    Raises `SimulationError` if one has none, or if no period is a multiple of all.
    """
    moving = [s for s in signals if s is not None]
    for signal in moving:
        if signal.period is None:
            raise SimulationError(
                f"The signal {signal.label!r} does not repeat: give a duration, and an initial state other than "
                '"periodic"; or a periodic signal.'
            )
    if not moving:
        raise SimulationError("Nothing moves the mechanism: give a road, forces or a displacement.")
    period = max(float(s.period or 0.0) for s in moving)
    for signal in moving:
        ratio = period / float(signal.period or 1.0)
        if abs(ratio - round(ratio)) > 1e-9 * ratio:
            periods = ", ".join(format_alike([s.period for s in moving if s.period is not None], "s"))
            raise SimulationError(f"The periods of {periods} are not multiples of each other.")
    return period


def recorded_period(system: PiecewiseSystem, table: InputTable) -> tuple[Integration, float, float]:
    """The last period, recorded, how well it repeats, and how much of a motion a period leaves.

    It repeats as well as the change of the state over it is small, relative to its size. From rest, one period (or the
    end of a long one) is gone through to settle, then others until the state repeats. How fast it does tells what is
    left of a motion (see `remaining_share_of`). `table` is one period that is repeated.
    """
    at = int(np.searchsorted(table.time, table.time[-1] - _SETTLING))
    state, begin = initial_state(system, table.value_before[at], "rest"), table.time[at]
    run = event_driven.start_finely(system, table, state, keep=False)
    table = run.table
    last, first = table.time.size - 1, int(np.searchsorted(table.time, begin))
    run.motion.place["segment"] = first
    run.advance(last)
    mismatch, settled = np.inf, 0.0
    period = table.time[-1] - table.time[0]
    begun_at = (table.time[-1] - table.time[first]) / period
    for before in range(_RECORDED):
        if not run.status.ok or mismatch <= _ENOUGH:
            break
        begun = run.state
        run = event_driven.start(system, table, begun, after=run.ending)
        run.advance(last)
        mismatch, settled = run.mismatch(begun), begun_at + before
    return run, mismatch, remaining_share_of(mismatch, settled)


def settle(
    system: PiecewiseSystem,
    table: InputTable,
    state: Matrix,
    energy: bool,
    most: int = _PERIODS,
    outputs: Sequence[str] = (),
) -> tuple[Integration, PeriodicState]:
    """Repeat one period until the state repeats, at most `most` times; an integration at the end of the last one.

    The squares of `outputs` are added up over that one. With the `energy` it is at the start of the next one: the
    account takes ten times as long, and is of that alone.
    """
    found = event_driven.start_finely(system, table, state, outputs, keep=not energy)
    again = found.table.repeating
    found, settled = _repeat_period(found, again, _REPEATS, most)
    found.table = again
    if energy:
        status = found.status
        found = event_driven.start(system, again, found.state, account=True, after=found.ending)
        found.status = status
    if found.status.ok and max(settled.mismatch / _ENOUGH, settled.creep / _CREEP) > 1.0:
        found.warning = _steady_state_warning(settled)
    return found, settled


def mean_squares(
    system: PiecewiseSystem,
    table: InputTable,
    outputs: Sequence[str],
    state: Matrix,
    most: int = FEW_PERIODS,
    repeats: float = _ENOUGH,
) -> tuple[Matrix, Integration, PeriodicState]:
    """Mean squares of outputs over one period, once the state repeats, the integration, and how well it repeats.

    It repeats if it changes by less than `repeats` of its size. Goes through `most` periods at most. What the
    integration's `status` or `warning` say holds for the squares.
    """
    begun = event_driven.start_finely(system, table, state, outputs, keep=False)
    integration, settled = _repeat_period(begun, begun.table.repeating, repeats, most)
    if integration.status.ok and settled.mismatch > repeats:
        integration.warning = _steady_state_warning(settled)
    return powers_of(integration), integration, settled


def powers_of(integration: Integration) -> Matrix:
    """Mean squares over one period of the outputs whose squares were added up."""
    return np.asarray(integration.record.squares / (integration.table.samples - 1))


def _repeat_period(
    integration: Integration, again: InputTable, repeats: float, most: int
) -> tuple[Integration, PeriodicState]:
    """Repeat the period until the relative change of state is below `repeats`; sums are those of the last period."""
    place, last = integration.motion.place, again.time.size - 1
    integration.advance(last)
    integration.knots = again.knots
    place["settled"] = -1  # a jump at the start is one at the end of the period before
    mismatch, periods = np.inf, 1
    ends, changes = [integration.state], [np.inf]
    while integration.status.ok and periods < most and mismatch > repeats:
        begun = integration.state
        place["segment"] = place["special"] = place["events"] = 0
        integration.record.squares[:] = 0.0
        integration.record.states[:1], integration.record.visited[:1] = begun, place["mode"]
        integration.advance(last)
        periods += 1
        mismatch = integration.mismatch(begun)
        ends.append(integration.state)
        changes.append(mismatch)
    half = (periods - 1) // 2
    creep = _creep(integration.mismatch(ends[half]), changes[half:])
    return integration, PeriodicState(float(again.time[-1] - again.time[0]), periods, mismatch, creep)


def _creep(moved: float, changes: Sequence[float]) -> float:
    """Change that is left to a state that `moved` so far in as many periods as it has `changes` after the first.

    Changes that decline from the first to the last as a geometric series add up to that; rounding errors add up to
    little more than one of them, and leave none.
    """
    first, last = changes[0], changes[-1]
    if moved < 0.5 * last * (len(changes) - 1) or not last > 0.0:
        return last
    return moved * last / (first - last) if first > last else np.inf


def _steady_state_warning(found: PeriodicState) -> Status:
    message = (
        f"periodic steady state not reached after {found.periods} periods: relative change of state per period "
        f"{format_number(found.mismatch, 2)}"
    )
    if found.mismatch <= _ENOUGH:
        message += ", declining too slowly to end soon: a part of the motion relaxes over many more periods"
    return Status(StatusKind.INACCURATE, message)
