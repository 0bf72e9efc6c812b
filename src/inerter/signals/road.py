"""Roads as stationary random processes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Self

from inerter.errors import PerformanceIndexError
from inerter.field_metadata import quantity
from inerter.signals.coherence import Coherence
from inerter.validation import check_positive, use_python_numbers

_PER_N0_SQUARED = 100.0  # [m^2], where ISO 8608 states roughness at n0 = 0.1 cycle/m


@dataclass(frozen=True)
class RoadClass:
    """A road class of ISO 8608: geometric mean of Gd(n0), and limits a factor of two to either side.

    The first class has no lower limit, and the last no upper one. Source: ISO 8608:2016, Table C.1; words of the first
    five: J. Y. Wong, Theory of Ground Vehicles, "Classification of road roughness proposed by ISO".
    """

    letter: str
    mean: float  # Gd(n0) [m^3]
    words: str = ""

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
        """Roughness of the geometric mean, kappa = Gd(n0) n0^2 / 2 [m^3/cycle]."""
        return 0.5 * self.mean / _PER_N0_SQUARED

    def __str__(self) -> str:
        low, mean, high = (f"{round(1e6 * value)}e-6" for value in (self.lowest, self.mean, self.highest))
        span = f"from {low} to {high} m^3"
        if self.lowest == 0.0:
            span = f"up to {high} m^3"
        if math.isinf(self.highest):
            span = f"above {low} m^3"
        return f"class {self.letter} of ISO 8608, Gd(n0) = {mean} m^3 ({span})"


_CLASSES = "ABCDEFGH"
_WORDS = ("very good", "good", "average", "poor", "very poor", "", "", "")
ROAD_CLASSES = {
    letter: RoadClass(letter, 16e-6 * 4.0**i, words)
    for i, (letter, words) in enumerate(zip(_CLASSES, _WORDS, strict=True))
}


def road_class(letter: object) -> RoadClass:
    """The road class of a letter; raises `PerformanceIndexError` for an unknown one."""
    if not isinstance(letter, str) or letter not in ROAD_CLASSES:
        raise PerformanceIndexError(
            f'A class of ISO 8608 must be a letter from A (smooth) to H (rough), such as Road.iso8608("C", speed=25), '
            f"got {letter!r}."
        )
    return ROAD_CLASSES[letter]


@dataclass(frozen=True)
class RoadShape:
    """Ratio of a measured density to its fitted line at increasing wavenumbers.

    The mean of the density over a band of the width B has the relative variance 1 / (B `length`).
    """

    wavenumber: tuple[float, ...]  # [cycle/m], from the longest measured wave to the shortest
    ratio: tuple[float, ...]
    length: float = math.inf  # [m] of an undivided profile whose density scatters as much


@dataclass(frozen=True)
class Road:
    """A road with the two-sided displacement spectrum S(f) = roughness * speed / f^2 at `speed`.

    Its velocity is then white noise. `roughness` is kappa of Wang and Su (2008); the one-sided displacement power
    spectral density of ISO 8608 at n0 = 0.1 cycle/m is Gd(n0) = 2 kappa / n0^2. The tracks of a vehicle with two tracks
    are identical, or have the given `coherence`.

    Raises `PerformanceIndexError` unless both are positive and finite.

    >>> import inerter as it
    >>> it.Road.iso8608("B", speed=25.0).iso8608_class.letter
    'B'
    >>> slow, fast = (it.Road(roughness=5e-7, speed=speed) for speed in (10.0, 40.0))  # m^3/cycle, m/s
    >>> round(fast.velocity_intensity / slow.velocity_intensity, 9)
    2.0
    """

    roughness: float = field(
        metadata=quantity(
            "m^3/cycle",
            "Gd(n0) of ISO 8608 [m^3] or kappa = Gd(n0) n0^2 / 2 [m^3/cycle].",
            "5e-7 m^3/cycle",
        )
    )
    speed: float = field(metadata=quantity("m/s", "Vehicle speed V.", "25 m/s"))
    coherence: Coherence | None = None  # between left and right tracks; None: identical tracks
    shape: RoadShape | None = field(default=None, compare=False, repr=False)  # of a measured road

    def __post_init__(self) -> None:
        use_python_numbers(self)
        for name, unit in (("roughness", "m^3/cycle"), ("speed", "m/s")):
            check_positive(PerformanceIndexError, f"The {name} of a road", getattr(self, name), unit)
        if self.coherence is not None and not isinstance(self.coherence, Coherence):
            raise PerformanceIndexError(
                f"The coherence of a road must be a Coherence, such as Coherence.isotropic(track=1.5), got "
                f"{self.coherence!r}."
            )

    @classmethod
    def iso8608(cls, letter: str, speed: float, coherence: Coherence | None = None) -> Self:
        """A road of a class of ISO 8608, "A" to "H", with its geometric mean roughness.

        The limits of each class are in `ROAD_CLASSES`.

        Raises `PerformanceIndexError` for an unknown class, or a speed that is not positive.

        >>> road = Road.iso8608("C", speed=25.0)
        >>> road.roughness, str(road.iso8608_class)
        (1.28e-06, 'class C of ISO 8608, Gd(n0) = 256e-6 m^3 (from 128e-6 to 512e-6 m^3)')
        """
        return cls(roughness=road_class(letter).roughness, speed=speed, coherence=coherence)

    @property
    def iso8608_class(self) -> RoadClass:
        """ISO 8608 class of its roughness, the rougher one at a limit."""
        density = 2.0 * self.roughness * _PER_N0_SQUARED
        return next(c for c in ROAD_CLASSES.values() if density < c.highest)

    @property
    def velocity_intensity(self) -> float:
        """Root of the two-sided spectral density of the road's velocity, 2 pi sqrt(V kappa) [m/s per sqrt(Hz)].

        Source: Wang and Su (2008), eq. (4).
        """
        return 2.0 * math.pi * math.sqrt(self.speed * self.roughness)
