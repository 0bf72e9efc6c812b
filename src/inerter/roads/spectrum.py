"""Displacement power spectral density of a profile over spatial frequency, and its fitted line of ISO 8608."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.deprecation import renamed_keywords
from inerter.errors import RecordError
from inerter.formatting import format_quantity, format_range
from inerter.roads.profile import Profile
from inerter.signals.road import ROAD_CLASSES, Road, RoadClass, RoadShape
from inerter.validation import checked, is_number

Matrix = NDArray[np.float64]
N0 = 0.1  # [cycle/m]
LOWEST, HIGHEST = 0.011, 2.83  # [cycle/m] range of the fit in ISO 8608
_OCTAVE = 12  # parts of an octave in which densities are averaged before the fit
_FEWEST = 3  # bands of a fit
_FIRST = 3  # first line of the fit: detrending affects those below
_SEGMENTS = 8  # of the profile, which overlap by half
_MANY = 1e6  # lines of a wide band
POINTS, AVERAGES, FILTERED = SAMPLING = ("points", "averages", "filtered")  # kinds of heights of a profile
_STEEP = (1.05, 8.0)  # wavinesses for which aliasing is corrected: its sum diverges at 1


@dataclass(frozen=True, eq=False)
class RoadSpectrum:
    """One-sided power spectral density of the heights, and its fit Gd(n) = Gd(n0) (n / n0)^-waviness.

    The line is fitted by least squares to the logarithms of densities averaged in twelfths of an octave from `lowest`
    to `highest`; `scatter` is their standard deviation from the line, as a factor. Line and `averages` are those of the
    road. `density`, that of the samples, includes aliased waves shorter than two intervals; `folded` is the factor by
    which they would increase `standard`. A mean of the density over a band of the width B has the relative variance
    1 / (B `effective_length`).
    """

    wavenumber: Matrix  # (n,) [cycle/m]
    density: Matrix  # (n,) [m^3]
    unevenness: float  # Gd(n0) of the line [m^3]
    waviness: float
    standard: float  # Gd(n0) of the line with waviness 2, as in ISO 8608 [m^3]
    scatter: float
    lowest: float  # [cycle/m] of the line
    highest: float
    bands: int = 0  # of the line
    averages: tuple[tuple[float, float], ...] = ()  # of the bands: wavenumber and density
    folded: float = 1.0
    effective_length: float = math.inf  # [m]

    @property
    def iso8608_class(self) -> RoadClass:
        """Class of the line with waviness 2."""
        return next(c for c in ROAD_CLASSES.values() if self.standard < c.highest)

    def road(self, speed: float) -> Road:
        """The road of waviness 2 with the same roughness, for indices, at `speed` [m/s]."""
        shape = self.shape(self.standard, 2.0)
        return Road(roughness=0.5 * self.standard * N0**2, speed=speed, shape=shape)

    def shape(self, unevenness: float, waviness: float) -> RoadShape | None:
        """Ratio of the averages of the bands to a line; None where they are unknown."""
        if not self.averages:
            return None
        wavenumbers, densities = zip(*self.averages, strict=True)
        line = unevenness * (np.array(wavenumbers) / N0) ** -waviness
        return RoadShape(tuple(wavenumbers), tuple((np.array(densities) / line).tolist()), self.effective_length)


@renamed_keywords(track="side")
@checked(RecordError)
def road_spectrum(
    profile: Profile, lowest: float = LOWEST, highest: float = HIGHEST, side: str = "", sampling: str = POINTS
) -> RoadSpectrum:
    """The spectrum of one track of a profile, by Welch's method, and the line fitted from `lowest` to `highest`.

    The profile is divided into segments that overlap by half, detrended and Hann-windowed. Without a `side`, the mean
    of two tracks. Unevenly spaced points are interpolated linearly.

    `sampling` is the kind of heights: "points" of the road, or "averages", each over its interval, for both of which
    the line is corrected for aliasing of waves shorter than two intervals; or "filtered", without such waves.

    Raises `RecordError` for a profile that is too short, or spaced too widely, for three bands of the fit.

    >>> import inerter as it
    >>> import numpy as np
    >>> heights = np.cumsum(np.random.default_rng(0).normal(0.0, 1e-3, 8192))  # a random walk: waviness 2
    >>> spectrum = it.road_spectrum(it.Profile(0.1 * np.arange(8192), heights))
    >>> abs(spectrum.waviness - 2.0) < 0.2
    True
    """
    if not isinstance(profile, Profile):
        raise RecordError(f"road_spectrum requires a Profile, such as read_profile(...), got {profile!r}.")
    if not (is_number(lowest) and is_number(highest) and 0.0 < lowest < highest):
        raise RecordError(
            f"The fit range [cycle/m] must be positive with lowest < highest, got {lowest!r} to {highest!r}."
        )
    if sampling not in SAMPLING:
        known = " or ".join(repr(one) for one in SAMPLING)
        raise RecordError(f"The sampling of a profile must be {known}, got {sampling!r}.")
    even = profile.even()
    if side and side not in even.tracks:
        raise RecordError(f"{profile.source!r}: unknown track {side!r}.")
    heights = [even.tracks[side]] if side else list(even.tracks.values())
    size = max(2 * (even.distance.size // (_SEGMENTS + 1)), min(even.distance.size, 16))
    wavenumber, densities = scipy.signal.welch(
        np.array(heights), fs=1.0 / even.interval, nperseg=size, window="hann", detrend="linear"
    )  # type: ignore[call-overload]
    density = np.mean(densities, axis=0)
    if not np.any(density[1:] > 0.0):
        raise RecordError(f"{profile.source!r} is flat, so its spectrum cannot be fitted.")
    whole = slice(_FIRST, (size + 1) // 2)  # without the line at the Nyquist frequency
    leaked = _leakage(np.arange(_FIRST, whole.stop, dtype=float))
    n, smooth, lines = _bands(wavenumber[whole], density[whole] / leaked, lowest, highest)
    if n.size < _FEWEST:
        raise RecordError(
            f"{profile.source!r} is {format_quantity(profile.length, 'm', 6)} long with a point every "
            f"{format_quantity(even.interval, 'm', 6)}: too short, or too widely spaced, for a fit from "
            f"{format_range(lowest, highest, 'cycle/m', 6)}."
        )
    x, seen = np.log(n / N0), np.log(smooth) - _bias_of_logarithm(_freedom(even.distance.size, size, lines))
    folding = np.log(_folding(n * even.interval, _waviness(x, seen, n * even.interval, sampling), sampling))
    y = seen - folding
    slope, intercept = np.polyfit(x, y, 1)
    return RoadSpectrum(
        wavenumber=wavenumber[1:],
        density=density[1:],
        unevenness=math.exp(intercept),
        waviness=-float(slope),
        standard=math.exp(float(np.mean(y + 2.0 * x))),
        scatter=math.exp(float(np.std(y - slope * x - intercept))),
        lowest=float(n[0]),
        highest=float(n[-1]),
        bands=int(n.size),
        averages=tuple(zip(n.tolist(), (smooth * np.exp(-folding)).tolist(), strict=True)),
        folded=math.exp(float(np.mean(folding))),
        effective_length=size
        * even.interval
        * float(_freedom(even.distance.size, size, np.array(_MANY)))
        / (2.0 * _MANY),
    )


def _folding(part: Matrix, waviness: float, sampling: str) -> Matrix:
    """Ratio of the aliased density of samples to that of a road with this waviness, at wavenumbers times the interval.

    At points that are d apart, waves of n + k/d are aliased to n for every integer k. Their sum is a Hurwitz zeta
    function on each side. An average over d multiplies the height of a wave by sinc(n d).
    """
    if sampling == FILTERED:
        return np.ones_like(part)
    steep = waviness if sampling == POINTS else waviness + 2.0
    zeta = scipy.special.zeta
    total = part**steep * (zeta(steep, part) + zeta(steep, 1.0 - part))
    return np.asarray(total if sampling == POINTS else total * np.sinc(part) ** 2)


def _waviness(x: Matrix, seen: Matrix, part: Matrix, sampling: str) -> float:
    """The waviness consistent with the slope of the line after the correction of aliasing, within bounds.

    The solution is unique: a steeper spectrum has less aliasing, and hence a smaller correction.
    """

    def beyond(waviness: float) -> float:
        return float(-np.polyfit(x, seen - np.log(_folding(part, waviness, sampling)), 1)[0]) - waviness

    low, high = _STEEP
    if beyond(low) <= 0.0 or beyond(high) >= 0.0:
        return low if beyond(low) <= 0.0 else high
    return float(scipy.optimize.brentq(beyond, low, high, xtol=1e-9))


def _leakage(line: Matrix) -> Matrix:
    """Ratio of a line by Hann's window to the density there, for a density of waviness 2.

    The window adds a sixth of the power of each neighbour, of which the lower one has more.
    """
    return np.asarray(2.0 / 3.0 + ((line / (line - 1.0)) ** 2 + (line / (line + 1.0)) ** 2) / 6.0)


def _freedom(points: int, size: int, lines: Matrix) -> Matrix:
    """Degrees of freedom of a mean over neighbouring lines of Welch's method with Hann's window.

    Segments that overlap by half have squared correlations of 1/36 with the next, lines of (2/3)^2 and (1/6)^2 with the
    next two. Source: Welch (1967); Harris (1978), Table 1. Of two tracks one is counted, since they may be coherent.
    """
    pieces = max((points - size) // (size - size // 2) + 1, 1)
    single = 2.0 * pieces / (1.0 + 2.0 / 36.0 * (pieces - 1) / pieces)
    spread = 1.0 + 2.0 * sum(np.maximum(1.0 - j / lines, 0.0) * r for j, r in ((1, 4.0 / 9.0), (2, 1.0 / 36.0)))
    return np.asarray(single * lines / spread)


def _bias_of_logarithm(freedom: Matrix) -> Matrix:
    """Bias of the mean logarithm of a chi-squared density with these degrees of freedom."""
    return np.asarray(scipy.special.digamma(0.5 * freedom) - np.log(0.5 * freedom))


def _bands(wavenumber: Matrix, density: Matrix, lowest: float, highest: float) -> tuple[Matrix, Matrix, Matrix]:
    """Means in bands of a twelfth of an octave: wavenumber, density, and number of lines.

    The wavenumber of a band is the one at which a density of waviness 2 has its mean over the band.
    """
    inside = (wavenumber >= lowest) & (wavenumber <= highest) & (density > 0.0)
    n, d = wavenumber[inside], density[inside]
    number = np.floor(_OCTAVE * np.log2(n / lowest)).astype(int) if n.size else np.zeros(0, int)
    found = np.unique(number)
    centre = np.array([np.mean(n[number == band] ** -2.0) ** -0.5 for band in found])
    means, lines = (np.array([what(d[number == band]) for band in found], float) for what in (np.mean, np.size))
    return centre, means, lines
