"""The international roughness index of a profile: suspension travel of a reference quarter car per distance driven."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import RecordError
from inerter.formatting import format_alike
from inerter.roads.profile import Profile

Matrix = NDArray[np.float64]
# The Golden Car of ASTM E1926, as rates over its sprung mass, and the speed and lengths of the procedure.
SPRING, TYRE, DAMPER, MASS = 63.3, 653.0, 6.0, 0.15  # [1/s^2], [1/s^2], [1/s], [-]
SPEED = 80.0 / 3.6  # [m/s]
BASE, START = 0.25, 11.0  # [m]
_LONGEST = 0.61  # [m] between points


def iri(profile: Profile) -> float:
    """International roughness index [m/km]; for two tracks the mean (mean roughness index).

    Slopes over 250 mm excite the Golden Car at 80 km/h by its exact state transition, from the state of the mean slope
    of the first 11 m. Unevenly spaced points are interpolated linearly. Source: ASTM E1926 and Sayers, Gillespie
    and Paterson (1986), World Bank Technical Paper 46.

    Raises `RecordError` for a profile of less than 11 m, or with points more than 0.61 m apart, which the procedure
    excludes.

    >>> import inerter as it
    >>> import numpy as np
    >>> distance = np.arange(0.0, 100.0, 0.1)  # m
    >>> it.iri(it.Profile(distance, 0.02 * distance)) < 1e-9  # an even slope; m/km
    True
    """
    if not isinstance(profile, Profile):
        raise RecordError(f"iri requires a Profile, such as read_profile(...), got {profile!r}.")
    widest = float(np.diff(profile.distance).max())
    if widest > _LONGEST * (1.0 + 1e-9):
        most, widest_text = format_alike([_LONGEST, widest], "m")
        raise RecordError(
            f"The IRI requires points at most {most} apart; those of {profile.source!r} are up to {widest_text} apart."
        )
    if profile.length < START:
        least, length = format_alike([START, profile.length], "m")
        raise RecordError(f"The IRI requires a profile of at least {least}; {profile.source!r} has {length}.")
    even = profile.even()
    return float(np.mean([_track_iri(heights, even.interval) for heights in even.tracks.values()]))


def transition(interval: float) -> tuple[Matrix, Matrix]:
    """The Golden Car over one interval [m] of constant slope: the next state is the first times the state, plus the
    second times the slope. States are the slopes of sprung and unsprung mass, each followed by its rate [1/s].
    """
    A, B = _golden_car()
    joint = np.zeros((5, 5))
    joint[:4, :4], joint[:4, 4] = A, B
    moved = scipy.linalg.expm(joint * (interval / SPEED))
    return moved[:4, :4], moved[:4, 4]


def _golden_car() -> tuple[Matrix, Matrix]:
    A = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-SPRING, -DAMPER, SPRING, DAMPER],
            [0.0, 0.0, 0.0, 1.0],
            [SPRING / MASS, DAMPER / MASS, -(TYRE + SPRING) / MASS, -DAMPER / MASS],
        ]
    )
    return A, np.array([0.0, 0.0, 0.0, TYRE / MASS])


@lru_cache(maxsize=8)
def _modal_form(interval: float) -> tuple[NDArray[np.complex128], ...]:
    """Modal form over one interval: factor and gain of each mode, its part in the travel, and modes from states."""
    A, B = _golden_car()
    rates, shapes = np.linalg.eig(A)
    inverse = np.linalg.inv(shapes)
    factor = np.exp(rates * (interval / SPEED))
    return factor, (factor - 1.0) / rates * (inverse @ B), shapes[0] - shapes[2], inverse


def _nearest_integer(ratio: float) -> int:
    """Nearest integer, the larger of two, also for a half with rounding errors."""
    return int(ratio + 0.5 + 1e-6)


def _track_iri(height: Matrix, interval: float) -> float:
    span = max(1, _nearest_integer(BASE / interval))  # of the slopes, in intervals
    slope = (height[span:] - height[:-span]) / (span * interval)
    first = min(_nearest_integer(START / interval), height.size - 1)
    start = (height[first] - height[0]) / (first * interval)
    factor, gain, seen, inverse = _modal_form(interval)
    initial = inverse @ np.array([start, 0.0, start, 0.0])
    travel = np.zeros(slope.size)
    for at in range(factor.size):  # the modes are decoupled, so each is a filter of first order
        mode, _ = scipy.signal.lfilter(
            [gain[at]], [1.0, -factor[at]], slope.astype(complex), zi=[factor[at] * initial[at]]
        )
        travel += (seen[at] * mode).real
    return 1e3 * float(np.mean(np.abs(travel)))
