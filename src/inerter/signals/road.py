"""Roads as stationary random processes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from inerter.checks import check_positive
from inerter.errors import PerformanceIndexError


@dataclass(frozen=True)
class Road:
    """A road whose displacement has the two-sided spectrum S(f) = roughness * speed / f^2, driven at `speed`.

    Its velocity is then white noise. `roughness` is kappa of Wang and Su (2008); the one-sided displacement spectrum
    of ISO 8608 at n0 = 0.1 cycle/m is Gd(n0) = 2 kappa / n0^2.

    Raises `PerformanceIndexError` unless both are positive and finite.
    """

    roughness: float  # kappa [m^3/cycle]
    speed: float  # V [m/s]

    def __post_init__(self) -> None:
        for name, unit in (("roughness", "m^3/cycle"), ("speed", "m/s")):
            check_positive(PerformanceIndexError, f"The {name} of a road", getattr(self, name), unit)

    @property
    def velocity_intensity(self) -> float:
        """Root of the two-sided spectral density of the road's velocity, 2 pi sqrt(V kappa) [m/s per sqrt(Hz)].

        Source: Wang and Su (2008), eq. (4).
        """
        return 2.0 * math.pi * math.sqrt(self.speed * self.roughness)
