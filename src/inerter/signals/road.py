"""Roads as stationary random processes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Self

from inerter.checks import check_positive
from inerter.errors import PerformanceIndexError
from inerter.fields import quantity
from inerter.signals.coherence import Coherence

_PER_N0_SQUARED = 100.0  # [m^2], where ISO 8608 states roughness at n0 = 0.1 cycle/m


@dataclass(frozen=True)
class RoadClass:
    """A class of ISO 8608: the geometric mean of its Gd(n0) and the limits of the class, a factor of two to each side.

    The first class has no lower limit, and the last none above. Source: ISO 8608:2016, Table C.1.
    """

    letter: str
    mean: float  # Gd(n0) [m^3]

    @property
    def lowest(self) -> float:
        """Limit towards smoother roads [m^3]."""
        return 0.0 if self.letter == _CLASSES[0] else 0.5 * self.mean

    @property
    def highest(self) -> float:
        """Limit towards rougher roads [m^3]."""
        return math.inf if self.letter == _CLASSES[-1] else 2.0 * self.mean

    @property
    def roughness(self) -> float:
        """Of the geometric mean, kappa = Gd(n0) n0^2 / 2 [m^3/cycle]."""
        return 0.5 * self.mean / _PER_N0_SQUARED

    def __str__(self) -> str:
        low, mean, high = (f"{1e6 * value:.0f}e-6" for value in (self.lowest, self.mean, self.highest))
        span = f"from {low} to {high} m^3"
        if self.lowest == 0.0:
            span = f"up to {high} m^3"
        if math.isinf(self.highest):
            span = f"from {low} m^3 on"
        return f"class {self.letter} of ISO 8608, Gd(n0) = {mean} m^3 ({span})"


_CLASSES = "ABCDEFGH"
ROAD_CLASSES = {letter: RoadClass(letter, 16e-6 * 4.0**i) for i, letter in enumerate(_CLASSES)}


def road_class(letter: object) -> RoadClass:
    """The class of that letter; raises `PerformanceIndexError` if there is none."""
    if not isinstance(letter, str) or letter not in ROAD_CLASSES:
        raise PerformanceIndexError(
            f'A class of ISO 8608 is a letter from A (smooth) to H (rough), such as Road.iso8608("C", speed=25), '
            f"got {letter!r}."
        )
    return ROAD_CLASSES[letter]


@dataclass(frozen=True)
class RoadShape:
    """How a measured density lies about the line that stands for it: their ratio at rising wavenumbers."""

    wavenumber: tuple[float, ...]  # [cycle/m], from the longest measured wave to the shortest
    ratio: tuple[float, ...]


@dataclass(frozen=True)
class Road:
    """A road whose displacement has the two-sided spectrum S(f) = roughness * speed / f^2, driven at `speed`.

    Its velocity is then white noise. `roughness` is kappa of Wang and Su (2008); the one-sided displacement spectrum
    of ISO 8608 at n0 = 0.1 cycle/m is Gd(n0) = 2 kappa / n0^2. A vehicle whose wheels run on two tracks meets the same
    road on both, or roads that are as alike as a `coherence` says.

    Raises `PerformanceIndexError` unless both are positive and finite.
    """

    roughness: float = field(metadata=quantity("m^3/cycle", "kappa = Gd(n0) n0^2 / 2 of ISO 8608.", "5e-7 m^3/cycle"))
    speed: float = field(metadata=quantity("m/s", "V of the vehicle.", "25 m/s"))
    coherence: Coherence | None = None  # of left and right track; None: they are alike
    shape: RoadShape | None = field(default=None, compare=False, repr=False)  # of a road that was measured

    def __post_init__(self) -> None:
        for name, unit in (("roughness", "m^3/cycle"), ("speed", "m/s")):
            check_positive(PerformanceIndexError, f"The {name} of a road", getattr(self, name), unit)
        if self.coherence is not None and not isinstance(self.coherence, Coherence):
            raise PerformanceIndexError(
                f"The coherence of a road is a Coherence, such as Coherence.isotropic(track=1.5), got "
                f"{self.coherence!r}."
            )

    @classmethod
    def iso8608(cls, letter: str, speed: float, coherence: Coherence | None = None) -> Self:
        """A road of a class of ISO 8608, "A" to "H", with the geometric mean of its roughness.

        `ROAD_CLASSES` tells the limits of each class.

        Raises `PerformanceIndexError` if there is no such class, or the speed is not positive.

        >>> road = Road.iso8608("C", speed=25.0)
        >>> road.roughness, str(road.iso8608_class)
        (1.28e-06, 'class C of ISO 8608, Gd(n0) = 256e-6 m^3 (from 128e-6 to 512e-6 m^3)')
        """
        return cls(roughness=road_class(letter).roughness, speed=speed, coherence=coherence)

    @property
    def iso8608_class(self) -> RoadClass:
        """The class in which its roughness lies, the rougher one at a limit."""
        density = 2.0 * self.roughness * _PER_N0_SQUARED
        return next(c for c in ROAD_CLASSES.values() if density < c.highest)

    @property
    def velocity_intensity(self) -> float:
        """Root of the two-sided spectral density of the road's velocity, 2 pi sqrt(V kappa) [m/s per sqrt(Hz)].

        Source: Wang and Su (2008), eq. (4).
        """
        return 2.0 * math.pi * math.sqrt(self.speed * self.roughness)
