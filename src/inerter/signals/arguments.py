"""Checks of the arguments of signals."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import SignalError
from inerter.formatting import format_alike, format_number, format_quantity
from inerter.validation import check_positive, check_whole, is_number, is_whole

Array = NDArray[np.float64]

MOST = 10**8  # entries of one signal: 0.8 GB


def finite_number(what: str, value: object, unit: str) -> float:
    """`value` as a float; raises `SignalError` unless it is a finite number."""
    if not is_number(value):
        raise SignalError(f"{what} must be a finite number of {unit}, got {value!r}.")
    return float(value)


def positive_number(what: str, value: object, unit: str) -> float:
    """`value` as a float; raises `SignalError` unless it is positive and finite."""
    check_positive(SignalError, what, value, unit)
    return float(value)  # type: ignore[arg-type]


def frequency_band(what: str, lowest: object, highest: object) -> tuple[float, float]:
    """Two frequencies [Hz]; raises `SignalError` unless both are positive and in order."""
    low = positive_number(f"The lowest frequency of a {what}", lowest, "Hz")
    high = positive_number(f"The highest frequency of a {what}", highest, "Hz")
    if low > high:
        ends = " and ".join(format_alike([low, high], "Hz"))
        raise SignalError(
            f"The lowest frequency of a {what} must not exceed the highest, got {ends}. Swap them if they are reversed."
        )
    return low, high


def speed_or_none(value: object) -> float | None:
    """The speed of a vehicle [m/s], or None where it is unknown."""
    return None if value is None else positive_number("The speed of a signal", value, "m/s")


def random_generator(seed: object) -> np.random.Generator:
    """Random number generator of a seed; raises `SignalError` unless it is a non-negative integer."""
    return np.random.default_rng(check_whole(SignalError, "A seed", seed))


def real_array(what: str, values: object) -> Array:
    """`values` as an array of any shape; raises `SignalError` unless all are finite real numbers."""
    try:
        given: NDArray[Any] = np.asarray(values)
    except (TypeError, ValueError):
        raise SignalError(
            f"{what} must be real numbers, got a {type(values).__name__} that cannot be converted to an array."
        ) from None
    if given.size and given.dtype.kind not in "iuf":
        raise SignalError(f"{what} must be real numbers, got {_kind(given, values)}.")
    array = given.astype(float)
    if not np.isfinite(array).all():
        worst = int(np.argmin(np.isfinite(array)))
        raise SignalError(f"{what} must be finite, but entry {worst} is {array.flat[worst]}.")
    return array


def real_vector(what: str, values: object) -> Array:
    """`values` as a read-only array of one dimension."""
    array = real_array(what, values)
    if array.ndim != 1:
        raise SignalError(f"{what} must be a one-dimensional array, got one of shape {array.shape}.")
    array.setflags(write=False)
    return array


def whole_number(length: float, interval: float, what: str) -> int:
    """Number of intervals in `length`; raises `SignalError` unless that is an integer."""
    ratio = length / interval
    if ratio > MOST:
        raise SignalError(
            f"{what} of {format_quantity(length, 's', 6)} has {format_number(ratio, 3)} intervals of "
            f"{format_quantity(interval, 's', 6)}; at most 1e8 are supported."
        )
    count = round(ratio)
    if count < 1 or abs(ratio - count) > 1e-6:
        given, step, better = format_alike([length, interval, length / max(count, 1)], "s", 12)
        raise SignalError(
            f"{what} of {given} is not a whole number of intervals of {step}. Use an interval such as {better}."
        )
    return count


def time_tolerance(time: Any, interval: float | None) -> Any:
    """Tolerance of a time against a knot, for rounding [s]; 1e-12 s where there is no table."""
    return 1e-9 * (interval or 1e-3) + 4.0 * np.finfo(float).eps * np.abs(time)


def times_within(times: Array, start: float, stop: float, interval: float | None = None) -> Array:
    """The times between `start` and `stop`, without those that differ from the ends by rounding only."""
    check_span(start, stop)
    inside: NDArray[np.bool_] = (times > start + time_tolerance(start, interval)) & (
        times < stop - time_tolerance(stop, interval)
    )
    return times[inside]


def check_grid(start: object, step: object, count: object) -> None:
    """Raises `SignalError` unless a uniform grid starts at a time, with a positive step and a possible count."""
    finite_number("The start of a grid", start, "s")
    positive_number("The step of a grid", step, "s")
    if not is_whole(count, 0, MOST):
        raise SignalError(f"The count of a grid must be an integer from 0 to 1e8, got {count!r}.")


def check_span(start: object, stop: object) -> None:
    finite_number("The start of a span", start, "s")
    finite_number("The end of a span", stop, "s")


def _kind(array: NDArray[Any], values: object) -> str:
    return repr(values) if isinstance(values, str | bool | complex) or values is None else f"an array of {array.dtype}"
