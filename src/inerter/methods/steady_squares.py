"""Mean squares of a periodic motion, of outputs that may pass through filters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from inerter.errors import Status
from inerter.simulation.inputs import InputTable
from inerter.simulation.observe import trajectory_of
from inerter.simulation.steady import FEW_PERIODS, mean_squares, settle
from inerter.systems.filters import Filter
from inerter.systems.piecewise import PiecewiseSystem

Array = NDArray[np.float64]


def steady_squares(
    system: PiecewiseSystem,
    table: InputTable,
    outputs: Sequence[str],
    filters: Sequence[Filter | None],
    state: Array,
    most: int = FEW_PERIODS,
    **repeats: float,
) -> tuple[Array, Status, int]:
    """Mean squares over the period of `table` once the motion repeats, how far to trust them, after how many periods.

    The first outputs pass through `filters`, in the frequency domain: as they do once the filters have settled too.
    """
    if not any(filters):
        found, integration, periods = mean_squares(system, table, outputs, state, most, **repeats)
        if not integration.status.ok:
            return np.full(len(outputs), np.nan), integration.status, periods
        return found, integration.warning, periods
    integration, steady = settle(system, table, state, energy=False)
    integration.advance(table.time.size - 1)
    trajectory = trajectory_of(integration, steady, "")
    if not integration.status.ok:
        return np.full(len(outputs), np.nan), integration.status, steady.periods
    count, period = trajectory.time.size - 1, float(table.time[-1] - table.time[0])
    omega = 2.0 * np.pi / period * np.arange(count // 2 + 1)
    lines = np.array([np.abs(np.fft.rfft(trajectory[name][:count])) ** 2 for name in outputs])
    for line, one in zip(lines, filters, strict=False):
        if one is not None:
            line *= np.abs(one.response(omega)) ** 2
    lines[:, 1 : (count + 1) // 2] *= 2.0
    return lines.sum(axis=1) / count**2, trajectory.status, steady.periods
