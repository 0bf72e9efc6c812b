"""How rough a profile is over wavenumbers: its spectrum, and the straight line of ISO 8608 through it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.checks import is_number
from inerter.errors import RecordError
from inerter.roads.profile import Profile
from inerter.signals.road import ROAD_CLASSES, Road, RoadClass, RoadShape

Matrix = NDArray[np.float64]
N0 = 0.1  # [cycle/m]
LOWEST, HIGHEST = 0.011, 2.83  # [cycle/m] of the line of ISO 8608
_OCTAVE = 12  # parts of an octave in which densities are averaged before the line is laid
_FEWEST = 3  # bands that make a line
_FIRST = 3  # line that counts: the straight lines that are taken away are felt below
_SEGMENTS = 8  # of the profile, which overlap by half
POINTS, AVERAGES, FILTERED = SAMPLING = ("points", "averages", "filtered")  # what the heights of a profile are
_STEEP = (1.05, 8.0)  # wavinesses whose shorter waves are told apart: their sum has no end at 1


@dataclass(frozen=True, eq=False)
class RoadSpectrum:
    """The one-sided density of the heights over wavenumber, and the line Gd(n) = Gd(n0) (n / n0)^-waviness through it.

    The line is that of least squares between the logarithms of densities averaged in twelfths of an octave from
    `lowest` to `highest`; `scatter` is the standard deviation of these from the line, as a factor. Line and `averages`
    are those of the road. In `density`, that of the samples, shorter waves than two intervals are seen too; `folded` is
    by which factor `standard` would be higher with them.
    """

    wavenumber: Matrix  # (n,) [cycle/m]
    density: Matrix  # (n,) [m^3]
    unevenness: float  # Gd(n0) of the line [m^3]
    waviness: float
    standard: float  # Gd(n0) of the line whose waviness is 2, as ISO 8608 has it [m^3]
    scatter: float
    lowest: float  # [cycle/m] of the line
    highest: float
    bands: int = 0  # of the line
    averages: tuple[tuple[float, float], ...] = ()  # of the bands: wavenumber and density
    folded: float = 1.0

    @property
    def iso8608_class(self) -> RoadClass:
        """The class of the line whose waviness is 2."""
        return next(c for c in ROAD_CLASSES.values() if self.standard < c.highest)

    def road(self, speed: float) -> Road:
        """The road of waviness 2 that is as rough, for indices; it is driven at `speed` [m/s]."""
        shape = self.shape(self.standard, 2.0)
        return Road(roughness=0.5 * self.standard * N0**2, speed=speed, shape=shape)

    def shape(self, unevenness: float, waviness: float) -> RoadShape | None:
        """How the averages of the bands lie about a line; None where they are not known."""
        if not self.averages:
            return None
        wavenumbers, densities = zip(*self.averages, strict=True)
        line = unevenness * (np.array(wavenumbers) / N0) ** -waviness
        return RoadShape(tuple(wavenumbers), tuple((np.array(densities) / line).tolist()))


def road_spectrum(
    profile: Profile, lowest: float = LOWEST, highest: float = HIGHEST, track: str = "", sampling: str = POINTS
) -> RoadSpectrum:
    """The spectrum of one track of a profile, by Welch's method, and the line through it from `lowest` to `highest`.

    The profile is cut into pieces that overlap by half, a straight line is taken from each, and Hann's window put on
    it. Without a `track`, of two tracks the mean. Points that are not evenly spaced are joined by lines.

    `sampling` says what the heights are: "points" of the road, or "averages", each over its interval, of which the line
    is corrected for what waves shorter than two intervals add; or "filtered", without such waves, as they are.

    Raises `RecordError` for a profile that is too short, or spaced too widely, for three bands of the line.
    """
    if not isinstance(profile, Profile):
        raise RecordError(f"A road spectrum is that of a profile, such as read_profile(...), got {profile!r}.")
    if not (is_number(lowest) and is_number(highest) and 0.0 < lowest < highest):
        raise RecordError(
            f"The line is laid from a low to a higher wavenumber [cycle/m], got {lowest!r} to {highest!r}."
        )
    if sampling not in SAMPLING:
        known = " or ".join(repr(one) for one in SAMPLING)
        raise RecordError(f"The sampling of a profile is {known}, got {sampling!r}.")
    even = profile.even()
    if track and track not in even.tracks:
        raise RecordError(f"{profile.source!r} has no track {track!r}.")
    heights = [even.tracks[track]] if track else list(even.tracks.values())
    size = max(2 * even.distance.size // (_SEGMENTS + 1), min(even.distance.size, 16))
    wavenumber, densities = scipy.signal.welch(
        np.array(heights), fs=1.0 / even.interval, nperseg=size, window="hann", detrend="linear"
    )  # type: ignore[call-overload]
    density = np.mean(densities, axis=0)
    if not np.any(density[1:] > 0.0):
        raise RecordError(f"{profile.source!r} is flat: there is no spectrum to lay a line through.")
    whole = slice(_FIRST, (size + 1) // 2)  # without the line at half of a cycle in an interval, which is two in one
    leaked = _leakage(np.arange(_FIRST, whole.stop, dtype=float))
    n, smooth, lines = _bands(wavenumber[whole], density[whole] / leaked, lowest, highest)
    if n.size < _FEWEST:
        raise RecordError(
            f"{profile.source!r} is {profile.length:g} m long with a point every {even.interval:g} m: too short, or "
            f"too widely spaced, for a line from {lowest:g} to {highest:g} cycle/m."
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
    )


def _folding(part: Matrix, waviness: float, sampling: str) -> Matrix:
    """Density of samples over that of a road with this waviness, at wavenumbers times the interval [1].

    Waves of n + k/d look like those of n at points that are d apart, for every whole k. Their sum is one of Hurwitz's
    zeta functions on each side. An average over d takes sinc(n d) of the height of a wave.
    """
    if sampling == FILTERED:
        return np.ones_like(part)
    steep = waviness if sampling == POINTS else waviness + 2.0
    zeta = scipy.special.zeta
    total = part**steep * (zeta(steep, part) + zeta(steep, 1.0 - part))
    return np.asarray(total if sampling == POINTS else total * np.sinc(part) ** 2)


def _waviness(x: Matrix, seen: Matrix, part: Matrix, sampling: str) -> float:
    """The waviness that is the slope of the line without what its own shorter waves add, within bounds.

    The steeper it is the less they add, and the less steep is the line without them: there is one.
    """

    def beyond(waviness: float) -> float:
        return float(-np.polyfit(x, seen - np.log(_folding(part, waviness, sampling)), 1)[0]) - waviness

    low, high = _STEEP
    if beyond(low) <= 0.0 or beyond(high) >= 0.0:
        return low if beyond(low) <= 0.0 else high
    return float(scipy.optimize.brentq(beyond, low, high, xtol=1e-9))


def _leakage(line: Matrix) -> Matrix:
    """Mean of a line by Hann's window over the density there, for a density of waviness 2 [1].

    The window lets a sixth of each neighbour's power in, and the lower one has more.
    """
    return np.asarray(2.0 / 3.0 + ((line / (line - 1.0)) ** 2 + (line / (line + 1.0)) ** 2) / 6.0)


def _freedom(points: int, size: int, lines: Matrix) -> Matrix:
    """Degrees of freedom of a mean over so many neighbouring lines of Welch's method with Hann's window.

    Pieces that overlap by half have squared correlations of 1/36 with the next, lines of (2/3)^2 and (1/6)^2 with the
    next two. Source: Welch (1967); Harris (1978), Table 1. Of two tracks one is counted, since they may be alike.
    """
    pieces = max((points - size) // (size - size // 2) + 1, 1)
    single = 2.0 * pieces / (1.0 + 2.0 / 36.0 * (pieces - 1) / pieces)
    spread = 1.0 + 2.0 * sum(np.maximum(1.0 - j / lines, 0.0) * r for j, r in ((1, 4.0 / 9.0), (2, 1.0 / 36.0)))
    return np.asarray(single * lines / spread)


def _bias_of_logarithm(freedom: Matrix) -> Matrix:
    """Mean logarithm of a density that is chi-squared with these degrees of freedom, less that of its mean."""
    return np.asarray(scipy.special.digamma(0.5 * freedom) - np.log(0.5 * freedom))


def _bands(wavenumber: Matrix, density: Matrix, lowest: float, highest: float) -> tuple[Matrix, Matrix, Matrix]:
    """Means in bands of a twelfth of an octave, where there are lines: wavenumber, density, and how many lines.

    The wavenumber of a band is the one at which a density of waviness 2 has its mean over the band.
    """
    inside = (wavenumber >= lowest) & (wavenumber <= highest) & (density > 0.0)
    n, d = wavenumber[inside], density[inside]
    number = np.floor(_OCTAVE * np.log2(n / lowest)).astype(int) if n.size else np.zeros(0, int)
    found = np.unique(number)
    centre = np.array([np.mean(n[number == band] ** -2.0) ** -0.5 for band in found])
    means, lines = (np.array([what(d[number == band]) for band in found], float) for what in (np.mean, np.size))
    return centre, means, lines
