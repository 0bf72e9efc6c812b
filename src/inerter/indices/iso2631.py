"""Frequency weightings of ISO 2631-1:1997 for human vibration, from the parameters of its Annex A.

A weighting is a band pass (f1, f2, both of second order and Butterworth), a transition from acceleration to velocity
(f3, f4, Q4), which has no zero without f3 and may be left out, and perhaps an upward step (f5, Q5, f6, Q6), from
(f5/f6)^2 at low frequencies to one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce

import numpy as np
from numpy.typing import NDArray

from inerter.errors import PerformanceIndexError
from inerter.systems.filters import Filter
from inerter.systems.linear import LinearSystem
from inerter.validation import checked

Matrix = NDArray[np.float64]
_BUTTERWORTH = math.sqrt(0.5)


@dataclass(frozen=True)
class Weighting:
    """Parameters of a weighting: frequencies [Hz], quality factors, and purpose."""

    name: str
    purpose: str
    band: tuple[float, float]  # f1, f2
    transition: tuple[float | None, float, float] | None = None  # f3, f4, Q4
    step: tuple[float, float, float, float] | None = None  # f5, Q5, f6, Q6

    @property
    def sections(self) -> tuple[Filter, ...]:
        """Second-order filters in series, each with unit gain in its pass band."""
        f1, f2 = map(_rate, self.band)
        found = [
            Filter((1.0, 0.0, 0.0), (1.0, f1 / _BUTTERWORTH, f1**2)),
            Filter((f2**2,), (1.0, f2 / _BUTTERWORTH, f2**2)),
        ]
        if self.transition is not None:
            f3, f4, q4 = self.transition
            w4 = _rate(f4)
            top = (1.0,) if f3 is None else (1.0 / _rate(f3), 1.0)
            found.append(Filter(top, (1.0 / w4**2, 1.0 / (q4 * w4), 1.0)))
        if self.step is not None:
            f5, q5, f6, q6 = self.step
            w5, w6 = _rate(f5), _rate(f6)
            found.append(Filter((1.0, w5 / q5, w5**2), (1.0, w6 / q6, w6**2)))
        return tuple(found)


def _rate(frequency: float) -> float:
    return 2.0 * math.pi * frequency


WEIGHTINGS = {
    row.name: row
    for row in (
        Weighting("Wk", "vertical, seated or standing", (0.4, 100.0), (12.5, 12.5, 0.63), (2.37, 0.91, 3.35, 0.91)),
        Weighting("Wd", "horizontal, seated or standing", (0.4, 100.0), (2.0, 2.0, 0.63)),
        Weighting("Wf", "motion sickness, vertical", (0.08, 0.63), (None, 0.25, 0.86), (0.0625, 0.80, 0.1, 0.80)),
        Weighting("We", "rotation, seated", (0.4, 100.0), (1.0, 1.0, 0.63)),
        Weighting("Wc", "fore and aft, seat back", (0.4, 100.0), (8.0, 8.0, 0.63)),
        Weighting("Wj", "vertical, head of a recumbent person", (0.4, 100.0), None, (3.75, 0.91, 5.32, 0.91)),
    )
}
ROTATIONS = {"roll": 0.63, "pitch": 0.4}  # [m/rad] by what rotations of a seat are multiplied: k of 7.2.3


def check_weighting(name: object) -> str:
    """Name of a weighting, as given; raises `PerformanceIndexError` unless there is a weighting of this name."""
    if not isinstance(name, str) or name not in WEIGHTINGS:
        raise PerformanceIndexError(f"Unknown weighting {name!r}; available of ISO 2631-1: {', '.join(WEIGHTINGS)}.")
    return name


@cache
def weighting_filter(name: str) -> Filter:
    """The weighting as a `Filter`."""
    exact = reduce(Filter.then, WEIGHTINGS[check_weighting(name)].sections)
    unit = exact.denominator[0]
    return Filter(*(tuple(Fraction(c) / unit for c in part) for part in (exact.numerator, exact.denominator)))


@checked(PerformanceIndexError)
@cache
def iso2631_weighting(name: str) -> LinearSystem:
    """The frequency weighting "Wk", "Wd", "Wf", "We", "Wc" or "Wj" of ISO 2631-1:1997.

    Its input is an acceleration, its output the weighted one.

    Raises `PerformanceIndexError` for another name.

    >>> import numpy as np
    >>> iso2631_weighting("Wk")
    LinearSystem(8 states; inputs acceleration; outputs weighted_acceleration)
    """
    A, B, C, D = _blocks(WEIGHTINGS[check_weighting(name)].sections)
    return LinearSystem(A, B, C, D, inputs=("acceleration",), outputs=("weighted_acceleration",))


def _blocks(sections: tuple[Filter, ...]) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Matrices A, B, C, D of second-order sections in series, each in the units of its own frequency."""
    A, B, C, D = np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), np.eye(1)
    for one in sections:
        a, b, c, d, rate = _companion(one)
        A = np.block([[A, np.zeros((A.shape[0], a.shape[0]))], [rate * b @ C, rate * a]])
        B, C, D = np.vstack([B, rate * b @ D]), np.hstack([d @ C, c]), d @ D
    return A, B, C, D


def _companion(one: Filter) -> tuple[Matrix, Matrix, Matrix, Matrix, float]:
    """Matrices A, B, C, D of a second-order filter in units of its frequency, and the frequency [rad/s]."""
    rate, top, bottom = (np.asarray(part, dtype=float) for part in one.scaled_coefficients)
    a = np.array([[0.0, 1.0], -bottom[:2] / bottom[2]])
    d = top[2] / bottom[2]
    return a, np.array([[0.0], [1.0 / bottom[2]]]), (top[:2] - d * bottom[:2])[None], np.array([[d]]), float(rate)
