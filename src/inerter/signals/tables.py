"""Tables of samples as piecewise polynomials: the coefficients of each hold."""

from __future__ import annotations

import numpy as np
import scipy

from inerter.errors import SignalError
from inerter.formatting import format_alike
from inerter.signals.arguments import Array, real_vector

HOLDS = ("zero", "linear", "cubic")  # from the roughest


def check_times(time: Array, count: int) -> None:
    """Raise `SignalError` unless `time` [s] has `count` entries, at least two, that increase."""
    if len(time) != count:
        raise SignalError(f"A table requires one value for each time, got {len(time)} times and {count} values.")
    if len(time) < 2:
        raise SignalError(f"A table requires at least two samples, got {len(time)}.")
    after = np.flatnonzero(np.diff(time) <= 0.0)
    if after.size:
        i = int(after[0])
        earlier, later = format_alike(time[i : i + 2], "s")
        raise SignalError(
            f"The times of a table must increase, but time {i + 1} is {later} and follows {earlier}. Sort the samples "
            f"and drop repeated ones."
        )


def spacing(time: Array) -> float:
    """The smallest interval of a table; exactly the common one if they differ by rounding alone."""
    steps = np.diff(time)
    common = (time[-1] - time[0]) / len(steps)
    return float(common if np.ptp(steps) <= 1e-9 * common else steps.min())


def close_period(value: Array) -> Array:
    """The values of one period, the last made equal to the first.

    Raises `SignalError` if they differ by more than rounding, 1e-9 of the range.
    """
    if abs(value[-1] - value[0]) > 1e-9 * np.ptp(value):
        raise SignalError(
            f"The last value of a periodic table, one period after the first, must equal the first, got "
            f"{' first and '.join(format_alike(value[[0, -1]], ''))} last. Append the first value again, "
            f"at the time of one period."
        )
    return np.append(value[:-1], value[0])


def coefficients(time: Array, value: Array, hold: str, derivative: object, periodic: bool) -> Array:
    """Ascending coefficients, (order, piece), of the polynomials in the time since the start of each piece.

    A table of n samples has n - 1 pieces; a zero hold that is not periodic has one more, which begins at the last.
    """
    if hold == "zero":
        return (value[:-1] if periodic else value)[None]
    with np.errstate(all="ignore"):
        step = np.diff(time)
        secant = np.diff(value) / step
        parts = [value[:-1], secant]
        if hold == "cubic":
            slope = _slopes(time, value, derivative, periodic)
            left, right = slope[:-1], slope[1:]
            parts = [value[:-1], left, (3 * secant - 2 * left - right) / step, (left + right - 2 * secant) / step**2]
        table = np.array(parts)
    if not np.isfinite(table).all():
        raise SignalError("The samples of a table are too far apart in value, or too close in time, for its slopes.")
    return table


def _slopes(time: Array, value: Array, derivative: object, periodic: bool) -> Array:
    if derivative is None:
        try:
            spline = scipy.interpolate.CubicSpline(time, value, bc_type="periodic" if periodic else "not-a-knot")
        except (ValueError, np.linalg.LinAlgError):
            return np.full_like(value, np.nan)
        return np.asarray(spline(time, 1), dtype=float)
    given = real_vector("The derivatives of a table", derivative)
    if len(given) != len(value):
        raise SignalError(f"A table requires one derivative for each value, got {len(given)} for {len(value)} values.")
    return given
