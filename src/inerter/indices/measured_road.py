"""Measured road as an excitation: white velocity through a filter with the measured waviness."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from inerter.errors import ErrorSource, PerformanceIndexError
from inerter.formatting import format_number, format_range
from inerter.indices.excitation import Excitation, FilteredExcitation, FormerNames, error_sources_of
from inerter.roads.spectrum import N0, RoadSpectrum
from inerter.signals.road import Road, RoadShape
from inerter.systems.filters import Filter
from inerter.systems.input_paths import InputPath
from inerter.validation import check_positive
from inerter.vehicle.mechanism import Mechanism

DEVIATION = 5e-3  # of the density from that of the line
_BEYOND = (10.0, 20.0, 40.0)  # how much further than the line the filter follows its slope, as a factor at each end
_MOST = 24  # poles
_SLOPES = (0.0, 4.0)  # of wavinesses that a filter of this kind can have, without its ends


@dataclass(frozen=True)
class MeasuredRoad(FormerNames):
    """Road with fitted waviness between two spatial frequencies, as an excitation; valid at any speed.

    `road` is the one of waviness 2 that has the same density at 0.1 cycle/m.
    """

    road: Road
    waviness: float
    lowest: float  # [cycle/m]
    highest: float
    is_random = True

    @property
    def shape(self) -> RoadShape:
        """Ratio of the measured density to the fitted one over spatial frequency, or the fitted range alone."""
        return self.road.shape or RoadShape((self.lowest, self.highest), (1.0, 1.0))

    @property
    def speed(self) -> float:
        """Vehicle speed [m/s]."""
        return self.road.speed

    @property
    def filter(self) -> Filter:
        """Filter that gives the white velocity of the road its waviness, at the vehicle speed."""
        return _of_waviness(self.waviness, self.lowest, self.highest, self.road.speed)

    @property
    def amplitude_density(self) -> float:
        """Root of the two-sided spectral density of the white velocity [m/s per root of Hz]."""
        return self._shaped_road.amplitude_density

    @property
    def unit(self) -> str:
        """Unit of the source."""
        return self._shaped_road.unit

    @property
    def _shaped_road(self) -> Excitation:
        return FilteredExcitation(self.road, self.filter)

    def excited_mechanism(self, mechanism: Mechanism) -> Mechanism:
        """Mechanism as excited by a road."""
        return self._shaped_road.excited_mechanism(mechanism)

    def input_paths(self, mechanism: Mechanism) -> tuple[InputPath, ...]:
        """Input paths of a road, each with the filter."""
        return self._shaped_road.input_paths(mechanism)

    def error_sources(self, mechanism: Mechanism) -> tuple[ErrorSource, ...]:
        """Error sources of the road, and of the filter, whose density deviates from the line by at most `DEVIATION`."""
        return *error_sources_of(self._shaped_road, mechanism), ErrorSource("filter of the road", 0.5 * DEVIATION)


def measured_road(spectrum: RoadSpectrum, speed: float) -> MeasuredRoad:
    """The road whose density is the line of a spectrum, Gd(n0) (n / n0)^-waviness, driven at `speed` [m/s].

    An index takes it in the place of a road. The filter has poles and zeros in turn, evenly over the logarithm of
    frequency; within the wavenumbers of the line the density deviates by half a per cent at most, and ten times further
    on each side, or more, the road has a waviness of 2. Source: Oustaloup et al. (2000).

    Raises `PerformanceIndexError` unless `speed` is positive and the waviness lies between 0 and 4.

    >>> import inerter as it
    >>> import numpy as np
    >>> rng, step = np.random.default_rng(0), 0.1  # m
    >>> heights = np.cumsum(rng.normal(0.0, 1e-3, 4096))  # a random walk: waviness 2
    >>> spectrum = it.road_spectrum(it.Profile(step * np.arange(4096), heights))
    >>> it.measured_road(spectrum, speed=25.0).is_random
    True
    """
    if not isinstance(spectrum, RoadSpectrum):
        raise PerformanceIndexError(f"A measured road requires road_spectrum(profile), got {spectrum!r}.")
    check_positive(PerformanceIndexError, "The speed over a measured road", speed, "m/s")
    if not _SLOPES[0] < spectrum.waviness < _SLOPES[1]:
        raise PerformanceIndexError(
            f"The waviness of the spectrum is {format_number(spectrum.waviness, 3)}; a road for an index has one "
            f"between 0 and 4. Check the unit of the profile."
        )
    shape = spectrum.shape(spectrum.unevenness, spectrum.waviness)
    road = Road(0.5 * spectrum.unevenness * N0**2, speed, shape=shape)
    return MeasuredRoad(road, spectrum.waviness, spectrum.lowest, spectrum.highest)


@lru_cache(maxsize=64)
def _of_waviness(waviness: float, lowest: float, highest: float, speed: float) -> Filter:
    ends = (2.0 * math.pi * speed * lowest, 2.0 * math.pi * speed * highest)
    return _power_law(0.5 * (2.0 - waviness), ends, 2.0 * math.pi * speed * N0)


def _power_law(power: float, ends: tuple[float, float], unit: float) -> Filter:
    """A filter whose size is (omega / unit)^power between the ends [rad/s], by as few poles as will do."""
    omega = np.geomspace(*ends, 400)
    wanted = (omega / unit) ** (2.0 * power)
    for beyond in _BEYOND:
        for count in range(1, _MOST + 1):
            found = _alternating(power, (ends[0] / beyond, ends[1] * beyond), unit, count)
            ratio = np.abs(found.response(omega)) ** 2 / wanted
            level = math.sqrt(float(ratio.max() * ratio.min()))
            if max(ratio.max() / level, level / ratio.min()) <= 1.0 + DEVIATION:
                return Filter([float(c) / math.sqrt(level) for c in found.numerator], found.denominator)
    band = format_range(ends[0] / unit * N0, ends[1] / unit * N0, "cycle/m")
    raise PerformanceIndexError(
        f"No filter approximates the fitted PSD from {band}. Fit "
        f"the PSD over a narrower band: road_spectrum(profile, lowest=..., highest=...)."
    )


def _alternating(power: float, ends: tuple[float, float], unit: float, count: int) -> Filter:
    """Poles and zeros in turn between the ends, with the right size in their middle."""
    step = math.log(ends[1] / ends[0]) / count
    middle = math.log(ends[0]) + step * (np.arange(count) + 0.5)
    zeros, poles = np.exp(middle - 0.5 * power * step), np.exp(middle + 0.5 * power * step)
    centre = math.sqrt(ends[0] * ends[1])
    raw = Filter(*(tuple(map(float, np.poly(-roots))) for roots in (zeros, poles)))
    size = (centre / unit) ** power / float(np.abs(raw.response(np.array([centre])))[0])
    return Filter([size * float(c) for c in raw.numerator], raw.denominator)
