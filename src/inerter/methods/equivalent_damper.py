"""Equivalent damper of dry friction at a given size of the velocity across it, for Gaussian and sinusoidal motions.

The damper c nearest to a Coulomb friction f in the mean square, min E (f sgn v - c v)^2, is c = f E|v| / E v^2; it
dissipates the same power. For velocities of one shape that is a constant times f over the size of the velocity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from inerter.kernels.harmonic import FIRST_HARMONIC

Array = NDArray[np.float64]


@dataclass(frozen=True)
class VelocityShape:
    """Shape of the velocity across a friction, which decides its equivalent damper."""

    size: str  # measure of the velocity [m/s] and of the damper's force [N]
    force_ratio: float  # that force over the friction: size E|v| / E v^2
    source: str

    def force(self, friction: Array) -> Array:
        """Force of the equivalent damper [N], in the measure `size`, for the friction [N]."""
        return self.force_ratio * friction

    def damping(self, friction: Array, speed: Array) -> Array:
        """Equivalent damping [N s/m] for the friction [N] and a velocity of the size `speed` [m/s]."""
        return self.force(friction) / speed


GAUSSIAN = VelocityShape(
    size="r.m.s. value",
    force_ratio=math.sqrt(2.0 / math.pi),
    source="Caughey (1963); Roberts and Spanos, Random Vibration and Statistical Linearization (1990)",
)
SINUSOIDAL = VelocityShape(
    size="amplitude",
    force_ratio=FIRST_HARMONIC,
    source="Gelb and Vander Velde, Multiple-Input Describing Functions and Nonlinear System Design (1968)",
)
