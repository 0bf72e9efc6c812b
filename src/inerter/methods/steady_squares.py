"""Mean squares of a periodic motion, of outputs that may pass through filters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ErrorSource, Status
from inerter.simulation.inputs import InputTable
from inerter.simulation.observe import trajectory_of
from inerter.simulation.steady import FEW_PERIODS, mean_squares, settle
from inerter.simulation.trajectory import Repetition
from inerter.systems.filters import Filter
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]


def unsettled(found: Sequence[Repetition], peaks: float) -> ErrorSource:
    """What r.m.s. values may be off by because motions have not settled for good; `peaks` are some times larger."""
    return ErrorSource("periodic steady state", 3.0 * peaks * max((one.left for one in found), default=0.0))


def steady_squares(
    system: PiecewiseSystem,
    table: InputTable,
    outputs: Sequence[str],
    filters: Sequence[Filter | None],
    state: Array,
    most: int = FEW_PERIODS,
    **repeats: float,
) -> tuple[Array, Status, Repetition]:
    """Mean squares over the period of `table` once the motion repeats, how far to trust them, how well it repeats.

    The first outputs pass through `filters`, in the frequency domain: as they do once the filters have settled too.
    """
    if not any(filters):
        found, integration, steady = mean_squares(system, table, outputs, state, most, **repeats)
        if not integration.status.ok:
            return np.full(len(outputs), np.nan), integration.status, steady
        return found, integration.warning, steady
    integration, steady = settle(system, table, state, energy=False)
    integration.advance(table.time.size - 1)
    trajectory = trajectory_of(integration, steady, "")
    if not integration.status.ok:
        return np.full(len(outputs), np.nan), integration.status, steady
    count, period = trajectory.time.size - 1, float(table.time[-1] - table.time[0])
    omega = 2.0 * np.pi / period * np.arange(count // 2 + 1)
    lines = np.array([np.abs(np.fft.rfft(trajectory[name][:count])) ** 2 for name in outputs])
    for line, one in zip(lines, filters, strict=False):
        if one is not None:
            line *= np.abs(one.response(omega)) ** 2
    lines[:, 1 : (count + 1) // 2] *= 2.0
    return lines.sum(axis=1) / count**2, trajectory.status, steady
