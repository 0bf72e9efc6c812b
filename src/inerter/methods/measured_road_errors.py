"""Errors of indices on a measured road: the fitted line instead of its spectrum, and unmeasured waves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from inerter.errors import ErrorSource
from inerter.indices.definition import IndexDefinition
from inerter.indices.excitation import shape_of
from inerter.norms.response import modal_response
from inerter.systems.linear import LinearSystem

Array = NDArray[np.float64]
ROAD_ERRORS = ("line of the road", "longer waves than measured", "shorter waves than measured")
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
    All three are shared by all values on the road.
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
    ratio = np.exp(np.interp(np.log(omega / (2.0 * math.pi * speed)), np.log(shape.wavenumber), np.log(shape.ratio)))
    by_line = np.asarray(np.trapezoid(power * (ratio - 1.0)[:, None], omega, axis=0))
    beyond = np.asarray(np.clip(1.0 - np.trapezoid(power, omega, axis=0), 0.0, 1.0))
    omega, power = power_between(_LONGEST * ends[0], ends[0])
    longer = np.asarray(np.minimum(np.trapezoid(power, omega, axis=0), beyond))
    change = _change_of(definition, norms)
    line = change(by_line)

    def most(shares: Array) -> float:
        return max(abs(change(by_line + shares) - line), abs(change(by_line - shares) - line))

    both, several = most(beyond), np.array([most(longer), most(beyond - longer)])
    long, short = (several * both / max(float(several.sum()), 1e-300)).tolist()  # which together make the most of both
    return (
        ErrorSource("line of the road", abs(line), line),
        ErrorSource("longer waves than measured", long, long),
        ErrorSource("shorter waves than measured", short, short),
    )


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
