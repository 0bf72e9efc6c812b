"""Two tones that grow smoothly from rest, in closed form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def growing_tones(time: Array) -> tuple[Array, Array, Array]:
    """Displacement [m], velocity and acceleration at these times [s]: 1.3 and 3.1 Hz, within half a second."""
    omega, size = 2.0 * np.pi * np.array([1.3, 3.1]), np.array([8e-3, 2e-3])
    share = np.minimum(time / 0.5, 1.0)
    ramp = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    slope = 60.0 * share**2 * (1.0 - share) ** 2
    bend = np.where(share < 1.0, 240.0 * share * (1.0 - 3.0 * share + 2.0 * share**2), 0.0)
    sine, cosine = np.sin(np.outer(time, omega)), np.cos(np.outer(time, omega))
    x, v, a = sine @ size, cosine @ (size * omega), -sine @ (size * omega**2)
    return ramp * x, ramp * v + slope * x, ramp * a + 2.0 * slope * v + bend * x
