"""Harmonic balance of dry friction in one harmonic: a peak gain under a sinusoidal force.

A Coulomb friction f across which the velocity has the amplitude V acts on that harmonic as a damper of 4 f / (pi V),
see `equivalent_damper`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import OK, ErrorSource, PerformanceIndexError, Status, StatusKind
from inerter.indices.definition import IndexDefinition
from inerter.kernels import harmonic as kernels
from inerter.methods.equivalent import PROMISE, Equivalent, equivalent, poorly_represented
from inerter.methods.equivalent_damper import SINUSOIDAL
from inerter.methods.error_bounds import with_error_sources
from inerter.methods.linear import check_peak_gain
from inerter.methods.method import Estimate
from inerter.norms.hinf import GainPeak
from inerter.systems.descriptor import Descriptor, describe
from inerter.systems.input_paths import InputPath, apply_excitation, inputs_of
from inerter.systems.output_filters import with_output_filters
from inerter.systems.outputs import force_of, velocity_of
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]
_PEAKS: Array = np.empty(0)  # frequencies that are not known yet
_NEAR = 0.5  # of the highest gain: peaks that could be the highest, since an untold one may be off by that much
_NUDGE = 1e-6  # relative change of a value for differences
_DISTORTED = 3.0  # times what the third harmonic may do to the response that this may be off by ...
_STOPS = 1.2  # ... or less: times its power of 3/4, of friction that stops a slow motion at every turn
_OVERTONES = 5.0  # times what other harmonics of square waves add to the mean square
_SEARCH = 1e-6  # relative error of a peak's height by its place, and by the limit of low frequencies


@dataclass(frozen=True, eq=False)
class HarmonicBalance:
    """A peak gain with friction as a function of the free values: `Differentiable`.

    The gains at given frequencies are its components, with gradients by central differences.
    """

    definition: IndexDefinition
    descriptor: Descriptor  # inputs: the force, a force beside each friction; outputs: displacement, velocities
    parts: Equivalent

    @property
    def amplitude(self) -> float:
        """Force amplitude [N]."""
        assert self.definition.amplitude is not None
        return float(self.definition.amplitude)  # of an integer the kernel would be compiled once more

    @property
    def weight(self) -> float:
        """Factor of the gain in the index."""
        return abs(self.definition.outputs[0].weight)

    @cached_property
    def arrays(self) -> tuple[Any, ...]:
        """The descriptor as compiled code takes it."""
        return self.descriptor.arrays

    @cached_property
    def places(self) -> NDArray[np.int64]:
        """Positions of the equivalent dampers among the free values of the descriptor."""
        names = list(self.descriptor.free)
        return np.array([names.index(name) for name in self.parts.dampers], dtype=np.int64)

    def check_idle(self) -> None:
        """Raises `DesignError` if a free value has no effect."""
        self.parts.check_idle(self.descriptor)

    def _rows(self, points: Array) -> tuple[Array, Array]:
        """Values for the descriptor, and amplitudes of the friction forces."""
        dampers = np.full((points.shape[0], len(self.parts.dampers)), self.parts.scale)
        rows = np.hstack([points, dampers])[:, self.parts.order(self.descriptor)]
        return np.ascontiguousarray(rows), np.ascontiguousarray(SINUSOIDAL.force(self.parts.limits(points)))

    def _gains(self, points: Array, omegas: Array = _PEAKS) -> Iterator[tuple[Array, Array, bool, float, float]]:
        """Frequencies and gains at `omegas` or at the peaks, for each row of `points`.

        Whether all went well, and what part of the gain may be wrong because frictions are neither so weak nor so
        strong that one harmonic tells what they do, and what the others add to its mean square (at peaks neither is
        asked).
        """
        for row, limit in zip(*self._rows(points), strict=True):
            yield kernels.gains(row, limit, self.places, self.arrays, self.amplitude, self.parts.scale, omegas)

    def evaluate_points(self, points: Array, trusted: bool = True) -> Array:
        """The index at each row of `points`; nan where it could not be found, or is not to be `trusted`."""
        result = np.full(points.shape[0], np.nan)
        for i, (omegas, gains, fine, *_) in enumerate(self._gains(points)):
            if fine and gains.size and (not trusted or self._off_by(points[i], omegas, gains) <= PROMISE):
                result[i] = self.weight * gains.max() if np.isfinite(gains.max()) or not trusted else np.nan
        return result

    def _off_by(self, point: Array, omegas: Array, gains: Array) -> float:
        """Relative error of the largest gain by taking frictions in one harmonic: at the peaks that could be it."""
        highest = np.maximum(omegas[gains >= _NEAR * gains.max()], _slowest(omegas))
        *_, third, over = next(self._gains(point[None], highest))
        return float(
            max(_DISTORTED * third, min(_STOPS * third**0.75, PROMISE), math.sqrt(1.0 + _OVERTONES * over) - 1.0)
        )

    def values(self, points: Array) -> Array:
        """Index at each row of `points`, accurate or not; infinite where unknown."""
        known = self.evaluate_points(points, trusted=False)
        return np.where(np.isnan(known), np.inf, known)

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The index, and the gradient of the highest peak."""
        which = self.active(point)[:1]
        if which.size == 0:
            return math.inf, np.zeros_like(point)
        values, gradients = self.components(point, which)
        return float(values[0]), gradients[0]

    def peaks(self, point: Array) -> tuple[tuple[GainPeak, ...], bool]:
        """Local maxima of the index's gain, the highest first, and whether all went well."""
        omegas, gains, fine, *_ = next(self._gains(point[None]))
        order = np.argsort(-gains, kind="stable")
        return tuple(GainPeak(float(omegas[i]), self.weight * float(gains[i])) for i in order), bool(fine)

    def active(self, point: Array) -> Array:
        """Frequencies [rad/s] of the local maxima of the gain, the highest first; 0 for the limit of low ones."""
        return np.array([peak.omega for peak in self.peaks(point)[0] if peak.gain > 0.0])

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """Gains at the frequencies `which`, and their gradients over the free values."""
        steps = _NUDGE * np.diag(point)
        points = np.vstack([point, point + steps, point - steps])
        found = np.full((points.shape[0], which.size), np.nan)
        for i, (_, gains, *_) in enumerate(self._gains(points, np.maximum(which, _slowest(which)))):
            found[i, : gains.size] = self.weight * gains
        ahead, behind = found[1 : 1 + point.size], found[1 + point.size :]
        return found[0], np.asarray((ahead - behind).T / (2.0 * _NUDGE * point))

    def estimate(self) -> Estimate:
        """The index of a design without free values."""
        peaks, fine = self.peaks(np.zeros(0))
        result = Estimate(math.nan, self.definition.unit, peaks=peaks, notes=self.descriptor.notes)
        if not peaks:
            return replace(result, status=Status(StatusKind.FAILED, "the frequency response could not be computed"))
        omegas, gains = np.array([peak.omega for peak in peaks]), np.array([peak.gain for peak in peaks])
        bound = self._off_by(np.zeros(0), omegas, gains)
        status = OK
        if not bound <= PROMISE:
            status = poorly_represented("friction as large as the forces in parallel with it", bound)
        if not fine:
            status = Status(StatusKind.INACCURATE, "harmonic balance not converged at every frequency")
        if not np.isfinite(peaks[0].gain):
            status = Status(StatusKind.MARGINAL, "rigid-body mode without stiffness: unbounded gain")
        words = [f"{said} by its describing function" for said in self.parts.frictions]
        result = replace(result, value=peaks[0].gain, status=status, notes=(*result.notes, *words))
        own = ErrorSource("one harmonic of friction", bound), ErrorSource("search for the peak", _SEARCH)
        return with_error_sources(result, own, PROMISE + _SEARCH)


def harmonic_balance(mechanism: Mechanism, definition: IndexDefinition) -> HarmonicBalance:
    """The balance for a peak gain.

    Raises `PerformanceIndexError` unless the index is of one output from one force with an amplitude.
    """
    check_peak_gain(definition)
    if definition.amplitude is None:
        raise PerformanceIndexError(
            "A peak gain with friction depends on the amplitude of the force, which expected-value needs too. Give it, "
            "such as 1000 N."
        )
    parts = equivalent(mechanism)
    paths = definition.input_paths(parts.mechanism)
    beside = tuple(InputPath(force_of(name), name) for name in parts.dampers)
    descriptor = describe(
        parts.mechanism,
        inputs_of((*paths, *beside)),
        (definition.outputs[0].output, *map(velocity_of, parts.dampers)),
    )
    filters = (*definition.filters, *(None for _ in parts.dampers))
    return HarmonicBalance(
        definition, with_output_filters(apply_excitation(descriptor, (*paths, *beside)), filters), parts
    )


def _slowest(omegas: Array) -> float:
    """Frequency [rad/s] far below `omegas`, for the static limit."""
    return 1e-7 * float(np.min(omegas[omegas > 0.0], initial=1.0))
