"""Errors of indices on a measured road: its fitted line, unmeasured waves, and the scatter of its spectrum."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import ErrorSource
from inerter.indices.definition import IndexDefinition
from inerter.indices.excitation import shape_of
from inerter.norms.response import modal_response
from inerter.signals.road import RoadShape
from inerter.systems.linear import LinearSystem

Array = NDArray[np.float64]
ROAD_ERRORS = ("line of the road", "longer waves than measured", "shorter waves than measured", "length of the profile")
_SMOOTH = 13  # bands, an octave
_DEVIATIONS = 2.0  # standard deviations of the scatter of a spectrum in its bound
_LONGEST = 1e-3  # of the lowest measured frequency: that down to which longer waves count
_POINTS = 800  # frequencies between the ends of what was measured
_BESIDE = np.concatenate([-np.geomspace(30.0, 0.03, 20), np.geomspace(0.03, 30.0, 20)])  # of a pole, over its damping


def road_errors(
    definition: IndexDefinition, system: LinearSystem, pade_order: int | None, norms: Array
) -> tuple[ErrorSource, ...]:
    """Errors of an index of r.m.s. values on a road with a measured shape; none on any other.

    `system` has the outputs of the index over white noise, with these `norms`. The road as it was measured, with the
    densities of its bands in the place of the line, gives another value: that is the error by the line. What lies
    beyond the waves that were measured may be missing, or twice as much, the longer ones and the shorter ones each.
    The densities of a profile scatter about those of the road that it is a sample of, each band independently, which
    changes the value by the share that the band has in it. All of these are shared by all values on the road.
    """
    found = shape_of(definition.drive)
    if found is None or definition.is_peak or not np.all(np.isfinite(norms)):
        return ()
    shape, speed = found
    ends = [2.0 * math.pi * speed * n for n in (shape.wavenumber[0], shape.wavenumber[-1])]
    poles, total = np.asarray(np.linalg.eigvals(system.A), complex), np.maximum(norms**2, 1e-300)

    def power_between(low: float, high: float) -> tuple[Array, Array]:
        omega = _frequencies(low, high, poles)
        return omega, np.sum(np.abs(modal_response(system, omega, pade_order)) ** 2, axis=2) / math.pi / total

    omega, power = power_between(*ends)
    wavenumber = omega / (2.0 * math.pi * speed)
    ratio = np.interp(np.log(wavenumber), np.log(shape.wavenumber), shape.ratio)
    by_line = np.asarray(np.trapezoid(power * (ratio - 1.0)[:, None], omega, axis=0))
    scatter = _scatter(shape, wavenumber, 2.0 * math.pi * speed * power)
    beyond = np.asarray(np.clip(1.0 - np.trapezoid(power, omega, axis=0), 0.0, 1.0))
    omega, power = power_between(_LONGEST * ends[0], ends[0])
    longer = np.asarray(np.minimum(np.trapezoid(power, omega, axis=0), beyond))
    change = _change_of(definition, norms)
    line = change(by_line)

    def most(shares: Array) -> float:
        return max(abs(change(by_line + shares) - line), abs(change(by_line - shares) - line))

    both, several = most(beyond), np.array([most(longer), most(beyond - longer)])
    long, short = (several * both / max(float(several.sum()), 1e-300)).tolist()  # which together make the most of both
    weights = np.array([abs(output.weight) for output in definition.outputs])
    shares = definition.slopes(norms, weights) * norms / max(float(definition.combine(norms, weights)), 1e-300)
    by_band = tuple((0.5 * _DEVIATIONS * scatter @ shares).tolist())
    return (
        ErrorSource("line of the road", abs(line), (line,)),
        ErrorSource("longer waves than measured", long, (long,)),
        ErrorSource("shorter waves than measured", short, (short,)),
        ErrorSource("length of the profile", math.hypot(*by_band), by_band),
    )


def _scatter(shape: RoadShape, wavenumber: Array, power: Array) -> Array:
    """Standard deviations of mean squares (bands, outputs), relative to them, by the scatter of each band's density.

    `power` is the share of a mean square for each cycle/m, on the fitted line. Bands end midway between the wavenumbers
    of the shape. A density that happens to be low would scatter too little; the mean of several takes its place.
    """
    middle = np.log(shape.wavenumber)
    ends = np.exp(np.concatenate([middle[:1], 0.5 * (middle[1:] + middle[:-1]), middle[-1:]]))
    below = scipy.integrate.cumulative_trapezoid(power, wavenumber, axis=0, initial=0)
    shares = np.diff([np.interp(ends, wavenumber, column) for column in below.T], axis=1)
    ratio = scipy.ndimage.uniform_filter1d(shape.ratio, _SMOOTH, mode="nearest")
    return np.asarray((shares * ratio / np.sqrt(np.diff(ends) * shape.length)).T)


def _change_of(definition: IndexDefinition, norms: Array) -> Callable[[Array], float]:
    """Function from relative changes of the mean squares to the relative change of the index, with its sign."""
    weights = np.array([abs(output.weight) for output in definition.outputs])
    value = float(definition.combine(norms, weights))

    def change(shares: Array) -> float:
        other = float(definition.combine(norms * np.sqrt(np.maximum(1.0 + shares, 0.0)), weights))
        return other / value - 1.0 if value > 0.0 else 0.0

    return change


def _frequencies(low: float, high: float, poles: NDArray[np.complex128]) -> Array:
    """Frequencies [rad/s] between two, closer together near each resonance."""
    near = (np.abs(poles.imag)[:, None] + np.abs(poles.real)[:, None] * _BESIDE).ravel()
    omega = np.unique(np.concatenate([np.geomspace(low, high, _POINTS), near]))
    return np.asarray(omega[(omega >= low) & (omega <= high)])
