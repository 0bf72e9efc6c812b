"""`Norm` for many designs of one layout, and for the optimiser: the same numbers from compiled code.

Compiled code serves outputs whose norm is finite, which the topology decides: it is asked at one design without special
values. The single design at which double precision is not sure goes to the norms without rounding, so that no number is
silently wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.indices.definition import Combination, IndexDefinition
from inerter.indices.excitation import road_of
from inerter.kernels import excess as excess_kernels
from inerter.kernels import gain as gain_kernels
from inerter.kernels import h2 as h2_kernels
from inerter.kernels import modal as modal_kernels
from inerter.methods.linear import Conventions, LinearProblem, linear_problem
from inerter.methods.method import Estimate
from inerter.methods.modal_norm import modal_arguments, stacks_of
from inerter.methods.objective import count_of, rows_of
from inerter.networks.elements import middle
from inerter.norms.delay import pade
from inerter.norms.exact import h2_exactly
from inerter.norms.h2 import drift_covariance
from inerter.signals.coherence import Excess
from inerter.systems.descriptor import close
from inerter.systems.linear import LinearSystem
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
_ASIDE = 0.0137  # relative distance from the middle of the bounds, another one for each value
_ASTRIDE, _SAME = (1e-4, 1e-5), 1e-7  # relative distances at which a gradient is looked at; what it may be off by
_USABLE = 1e-5  # the same where the norms are not sure: differences without rounding take a search too long
_NEAR = ((1e-5, 5e4),)  # relative steps and weights of differences of values without rounding
_FAR = ((3e-3, 2.0 / 9e-3), (6e-3, -1.0 / 36e-3))  # of fourth order: compiled values may be off by 1e-9
_CREST = 0.5  # share of a value to which it falls within these steps where no search ends
_MOVED, _STEADY = (1e-13, -2e-13), 1e-10  # relative steps of some roundings, and what norms may change by them
_UNCERTAIN = 1e-10  # error estimate from which on the error bound of a norm behind a filter may be exceeded
_MANY_STATES = 9  # with those of filters, from which on modes are faster than covariances, and come first
_FEW, _MOST_EXACT = 8, 64  # designs of a search that are all valued, and that are valued without rounding at most


@dataclass(frozen=True, eq=False)
class CompiledNorm:
    """Index as a function of the design variables, from compiled code: the `Differentiable` objective of `Norm`."""

    problem: LinearProblem
    is_regular: bool = False  # whether all outputs are known to be finite and excited

    @property
    def descriptor(self) -> tuple[Any, ...]:
        """The descriptor's arrays in the order in which compiled code takes them."""
        return self._stacks[0]

    @property
    def extended_descriptor(self) -> tuple[Array, Array]:
        """S, [R F], Y_eta and [Y_x Y_u] in a row, and their rounding errors: no entries where these are zero."""
        return self._stacks[1]

    @cached_property
    def _stacks(self) -> tuple[tuple[Any, ...], tuple[Array, Array]]:
        return stacks_of(self.problem.descriptor)

    @cached_property
    def _modal_arguments(self) -> tuple[Any, Any, Any] | None:
        """Arguments of the norms by modes; None where these cannot serve."""
        return modal_arguments(self.problem)

    @cached_property
    def arrivals(self) -> tuple[Array, tuple[Any, Any, float], tuple[NDArray[np.int64], Array]]:
        """Times between arrivals of the road, the Pade approximant (no poles where the delay is exact), and the states
        that only the road moves, with their covariance.
        """
        order = self.problem.pade_order
        none = np.zeros(0, dtype=complex)
        gaps = np.ascontiguousarray(np.diff(self.problem.delays))
        if order is None:
            return gaps, (none, none, 0.0), self._drifts
        approximant = pade(order)
        return gaps, (approximant.poles, approximant.residues, approximant.direct), self._drifts

    @property
    def _drifts(self) -> tuple[NDArray[np.int64], Array]:
        """States that only the road moves, and their covariance; none where that is infinite."""
        d = self.problem.descriptor
        moves = np.any(d.X_eta, axis=1) | np.any(d.X_x, axis=1)
        drifting = np.flatnonzero(~moves)
        covariance = drift_covariance(d.X_u[drifting], self.problem.delays, self.problem.sources)
        return (drifting, covariance) if covariance is not None else (drifting[:0], np.zeros((0, 0)))

    @cached_property
    def single_source_definitions(self) -> tuple[CompiledNorm, ...]:
        """Objectives of the single sources, whose squares add up; empty for one source."""
        sources = tuple(dict.fromkeys(self.problem.sources))
        return tuple(CompiledNorm(self.problem.of_source(s)) for s in sources) if len(sources) > 1 else ()

    @property
    def is_peak(self) -> bool:
        """Whether the index is a peak gain."""
        return self.problem.definition.is_peak

    @cached_property
    def supported_outputs(self) -> NDArray[np.bool_]:
        """True for outputs that compiled code can evaluate: finite at a design near the middle of the bounds."""
        if self.is_regular:
            return np.ones(self.problem.weights.size, dtype=bool)
        if self.is_peak:
            return np.array([self._exact(self._special).status.ok])
        return np.asarray(~np.isinf(self._special_norms))

    @cached_property
    def reachable_outputs(self) -> NDArray[np.bool_]:
        """True for outputs that the source excites; those of a half model ignore the common motion of both sides."""
        if self.is_regular:
            return np.ones(self.problem.weights.size, dtype=bool)
        return np.asarray(self._special_norms > 0.0)

    @cached_property
    def per_source_definitions(self) -> tuple[tuple[NDArray[np.bool_], CompiledNorm], ...]:
        """Mask of the outputs that each source excites, and the objective of these outputs."""
        sources = [one for one in self.single_source_definitions or (self,) if np.any(one.reachable_outputs)]
        return tuple((one.reachable_outputs, CompiledNorm(one.problem.part(one.reachable_outputs))) for one in sources)

    @cached_property
    def _special_norms(self) -> Array:
        """Norms of the outputs at a design near the middle of the bounds."""
        return self._norms(self._special)

    @cached_property
    def _special(self) -> Array:
        """Values of a generic design near the middle of the bounds."""
        halfway = np.array([middle(free) for free in self._free.values()])
        return np.asarray(halfway * (1.0 + _ASIDE * np.arange(1, halfway.size + 1)))

    @property
    def _free(self) -> dict[str, Any]:
        return dict(self.problem.descriptor.free)

    def _columns(self, one: CompiledNorm) -> list[int]:
        """Positions of the design variables of `one` among all design variables."""
        names = list(self._free)
        return [names.index(name) for name in one._free]

    def _values(self, point: Array) -> dict[str, float]:
        return dict(zip(self._free, point.tolist(), strict=True))

    def _close_at(self, point: Array) -> LinearSystem:
        return close(self.problem.descriptor, self._values(point))

    def _exact(self, point: Array) -> Estimate:
        return self.problem.estimate(self._values(point))

    def _norms(self, point: Array) -> Array:
        return self.problem.norms(self.problem.system(self._close_at(point)), self._values(point))[0].outputs

    def _exact_norms(self, point: Array) -> Array:
        if self.single_source_definitions:
            parts = [one._exact_norms(point[self._columns(one)]) for one in self.single_source_definitions]
            return np.asarray(np.linalg.norm(parts, axis=0))
        system = self.problem.system(self._close_at(point))
        return self.problem.correct_norms(system, h2_exactly(system, self.problem.pade_order)[0])[0]

    def values(self, points: Array) -> Array:
        """Index at each row of `points`, for a search: infinite where unknown.

        Where compiled code is not sure there is hardly any damping, or nearly a rigid link, which few searches want. So
        such designs are valued without rounding only where there are few others to choose from.
        """
        values = self._compiled_values(points)
        unsure = np.flatnonzero(np.isnan(values))
        if points.shape[0] <= _FEW or unsure.size > 0.9 * points.shape[0]:
            values[unsure[:_MOST_EXACT]] = self.evaluate_points(points[unsure[:_MOST_EXACT]])
        return np.where(np.isnan(values), np.inf, values)

    def is_unsure(self, points: Array) -> Bools:
        """Whether double precision does not suffice for the index, at each row of `points`."""
        found = self._compiled_values(points) if self.is_peak else self._compiled_norms(points)
        return np.asarray(np.isnan(found.reshape(points.shape[0], -1)).any(axis=1))

    def evaluate_points(self, points: Array) -> Array:
        """Index at each row of `points`, which may be infinite; nan where unknown."""
        if not self.is_peak:
            return self._combine(self.output_norms(points))
        result = self._compiled_values(points)
        for i in np.flatnonzero(np.isnan(result)):
            result[i] = self._exact(points[i]).value
        return result

    def output_norms(self, points: Array) -> Array:
        """Norms (designs, outputs) at each row of `points`, for an index of r.m.s. values."""
        result = self._compiled_norms(points)
        for i in np.flatnonzero(np.isnan(result).any(axis=1)):
            result[i] = self._norms(points[i])
        return result

    def _compiled_values(self, points: Array) -> Array:
        """Index by compiled code alone; infinite where the topology makes it so, nan where inaccurate."""
        if not self.is_peak:
            return self._combine(self._compiled_norms(points))
        if not self.supported_outputs[0]:
            return np.full(points.shape[0], np.inf)
        largest = gain_kernels.peaks_of(points, self.descriptor, self.extended_descriptor)[1].max(axis=1)
        return np.where(np.isfinite(largest), largest * self.problem.weights[0], np.nan)

    def _compiled_norms(self, points: Array) -> Array:
        result = np.full((points.shape[0], self.supported_outputs.size), np.inf)
        if not np.all(self.supported_outputs):
            if np.any(self.supported_outputs):
                result[:, self.supported_outputs] = CompiledNorm(
                    self.problem.part(self.supported_outputs)
                )._compiled_norms(points)
            return result
        norms, _, errors, by_modes = self._with_gradients(points, np.empty(0))
        norms[~self._sure(points, norms, errors, by_modes)] = np.nan
        return norms

    def _with_gradients(self, points: Array, weights: Array) -> tuple[Array, Array, Array, Bools]:
        """Norms, gradients of their sum with `weights`, none without, and error estimates, by compiled code.

        The last tells where all is by modes. Over several sources, squares are added up for the outputs that each one
        excites.
        """
        if self._has_one_exact_source:
            return self._kernel_norms(points, weights)
        squares, errors = np.zeros((points.shape[0], self.supported_outputs.size)), np.zeros(points.shape[0])
        gradients = np.zeros((points.shape[0] if weights.size else 0, points.shape[1]))
        modal, found = np.ones(points.shape[0], dtype=bool), []
        for seen, columns, one in self._excited:
            alone = weights[seen] if weights.size and self._is_excited_once else np.empty(0)
            norms, slopes, behind, of_one, by_modes = one._of_one_source(
                np.ascontiguousarray(points[:, columns]), alone
            )
            squares[:, seen] += norms**2
            found.append((norms, slopes, behind))
            errors, modal = np.maximum(errors, of_one), modal & by_modes
        total = np.sqrt(squares)
        for row in range(gradients.shape[0]):
            for (seen, columns, one), (norms, slopes, behind) in zip(self._excited, found, strict=True):
                if slopes.size and np.all(np.isfinite(slopes[row])):
                    gradients[row, columns] += slopes[row]
                    continue
                shares = weights[seen] * norms[row] / np.maximum(total[row, seen], 1e-300)
                own = np.ascontiguousarray(points[row, columns])
                gradients[row, columns] += one._slopes_of_one_source(own, shares, norms[row], behind[row])
        return total, gradients, errors, modal

    @cached_property
    def _excited(self) -> tuple[tuple[NDArray[np.bool_], list[int], CompiledNorm], ...]:
        """`per_source_definitions` with the positions of their design variables."""
        return tuple((seen, self._columns(one), one) for seen, one in self.per_source_definitions)

    @cached_property
    def _is_excited_once(self) -> bool:
        """Whether no output is excited by several sources, so that weights of its norm are those of its one source."""
        return bool(np.all(np.sum([seen for seen, *_ in self._excited], axis=0) <= 1))

    @cached_property
    def _has_one_exact_source(self) -> bool:
        """Whether one source excites all outputs through an exact filter."""
        return not self.single_source_definitions and self._excess is None and bool(self.reachable_outputs.all())

    def _kernel_norms(self, points: Array, weights: Array) -> tuple[Array, Array, Array, Bools]:
        """Norms, gradients and error estimates over one source: by modes or by covariances for its filter.

        The slower way takes the designs of which the other is not sure. The last tells which are by modes.
        """
        many = _has_many_states(self.problem)
        ways = (self._by_modes, self._by_covariances) if many else (self._by_covariances, self._by_modes)
        norms, gradients, errors = ways[0](points, weights)
        missing = np.isinf(errors)
        if missing.any():
            rest = np.flatnonzero(missing)
            found = ways[1](points[rest], weights)
            norms[rest], errors[rest] = found[0], found[2]
            if weights.size:
                gradients[rest] = found[1]
        return norms, gradients, errors, ~missing if many else missing

    def _by_covariances(self, points: Array, weights: Array) -> tuple[Array, Array, Array]:
        """The same by covariances, with states for filters."""
        norms, gradients, errors = h2_kernels.norms(points, *self.arguments, weights)
        return np.asarray(norms), np.asarray(gradients), np.asarray(errors)

    def _by_modes(self, points: Array, weights: Array) -> tuple[Array, Array, Array]:
        """Norms, gradients and error estimates over one source by modes; estimates are infinite where modes fail."""
        if self._modal_arguments is None:
            missing = np.full((points.shape[0], self.problem.weights.size), np.nan)
            slopes = np.full((points.shape[0] if weights.size else 0, points.shape[1]), np.nan)
            return missing, slopes, np.full(points.shape[0], np.inf)
        descriptor, extended, noise = self._modal_arguments
        norms, gradients, errors = modal_kernels.norms_by_modes(points, descriptor, extended, noise, weights)
        return np.asarray(norms), np.asarray(gradients), np.asarray(errors)

    @cached_property
    def _excess(self) -> Excess | None:
        """Relative excess of the source's density over that of its filter, as a function; None if there is none."""
        return next((self.problem.excesses.get(source) for source in self.problem.sources), None)

    def _of_one_source(self, points: Array, weights: Array) -> tuple[Array, Array, Array, Array, Bools]:
        """Norms over a source that excites all outputs, their gradients, norms for its filter alone, error estimates.

        Gradients (designs, values) are those of the sum of the norms with `weights`. Both norms are one where the
        filter is exact or modes do without it; elsewhere gradients are nan. The last tells where modes do.
        """
        if self._excess is None:
            norms, gradients, errors, by_modes = self._kernel_norms(points, weights)
            return norms, gradients, norms, errors, by_modes
        norms, gradients, errors = self._by_modes(points, weights)
        by_modes = np.isfinite(errors)
        behind, rest = norms.copy(), np.flatnonzero(~by_modes)
        if rest.size:
            found, _, unsure = map(np.asarray, h2_kernels.norms(points[rest], *self.arguments, np.empty(0)))
            own = (self.descriptor, self.arrivals, self._excess.table)
            squares = found**2 + excess_kernels.corrections(points[rest], *own, np.empty(0))[0]
            norms[rest], behind[rest] = np.sqrt(np.maximum(squares, 0.0)), found
            errors[rest] = np.where(np.any(np.isnan(norms[rest]), axis=1), np.inf, unsure)
        return norms, gradients, behind, errors, by_modes

    def _slopes_of_one_source(self, point: Array, weights: Array, norms: Array, found: Array) -> Array:
        """Gradient at one point of the sum with `weights` of the norms of `_of_one_source`."""
        if self._excess is None:
            return np.asarray(self._kernel_norms(point[None], weights)[1][0])
        _, gradients, errors = self._by_modes(point[None], weights)
        if np.isfinite(errors[0]):
            return np.asarray(gradients[0])
        shares, own = weights / np.maximum(norms, 1e-150), (self.descriptor, self.arrivals, self._excess.table)
        slopes = h2_kernels.norms(point[None], *self.arguments, shares * found)[1][0]
        return np.asarray(slopes + excess_kernels.corrections(point[None], *own, 0.5 * shares)[1][0])

    def _sure(self, points: Array, norms: Array, errors: Array, by_modes: Bools) -> Bools:
        """True for designs whose norms are accurate (designs,).

        Uncertain norms behind filters beyond first order count as accurate if steps of rounding size leave them alone.
        Under light damping the states of such a filter cancel in its output, and the error bound of compiled code
        may then be exceeded a little. Modes have no such states.
        """
        sure = np.isfinite(errors)
        uncertain = sure & (errors > _UNCERTAIN) & ~by_modes
        if uncertain.any() and self.problem.highest_filter >= 2:
            asked = np.flatnonzero(uncertain)
            shifted_value = np.concatenate([points[asked] * (1.0 + by) for by in _MOVED])
            again = self._with_gradients(shifted_value, np.empty(0))[0].reshape(len(_MOVED), asked.size, -1)
            with np.errstate(invalid="ignore"):
                steady = np.all(np.abs(again - norms[asked]) <= _STEADY * norms[asked], axis=(0, 2))
            sure[asked] = steady & bool(points.shape[1])
        return sure

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """An index of r.m.s. values and its gradient.

        The adjoint's where modes know the norms or a difference confirms it, else differences: of compiled values where
        these are sure, else of values without rounding. It is nan where these would be differences across the resonance
        of a motion that is hardly damped, which a search only steps over.
        """
        if not self.supported_outputs.all():
            return self._exact_index(point), _slopes(self._exact_indices, point, _NEAR)[0]
        norms, gradient, errors, is_modal = self._with_slopes(point)
        found = value = float(self._combine(norms)[0])
        allowed = _SAME
        if not self._sure(point[None], norms, errors, is_modal)[0]:
            value, allowed = self._exact_index(point), _USABLE
        agrees = abs(found - value) <= _SAME * value
        if agrees and (is_modal[0] or self._gradient_agrees(point, gradient, allowed * value)):
            return value, gradient
        slopes, around = _slopes(self._compiled_values, point, _FAR)
        if not np.all(np.isfinite(slopes)):
            is_crest = np.any(around < _CREST * value)
            slopes = np.full(point.size, np.nan) if is_crest else _slopes(self._exact_indices, point, _NEAR)[0]
        return value, slopes

    def _combine(self, norms: Array) -> Array:
        return self.problem.definition.combine(norms, self.problem.weights)

    def _with_slopes(self, point: Array) -> tuple[Array, Array, Array, Bools]:
        """Norms, gradient of the index, error estimates of the norms, and whether all is by modes."""
        definition, weights = self.problem.definition, self.problem.weights
        if definition.combination is not Combination.SUM_OF_RMS:  # whose slopes need no norms
            weights = definition.slopes(self._with_gradients(point[None], np.empty(0))[0][0], weights)
        norms, gradients, errors, by_modes = self._with_gradients(point[None], weights)
        return norms, gradients[0], errors, by_modes

    @cached_property
    def _direction(self) -> Array:
        """A generic direction of the logarithms of the free values."""
        return np.asarray(np.cos(1.0 + np.arange(len(self._free))))

    @property
    def arguments(self) -> tuple[Any, Any, Any]:
        """Arguments of compiled code other than the points; filters are part of the descriptor."""
        return self.descriptor, self.extended_descriptor, self.arrivals

    def _exact_index(self, point: Array) -> float:
        return float(self._combine(self._exact_norms(point)))

    def _exact_indices(self, points: Array) -> Array:
        return np.array([self._exact_index(point) for point in points])

    def _gradient_agrees(self, point: Array, gradient: Array, allowed: float) -> bool:
        """Whether the gradient agrees with a central difference in one direction, but for what is allowed.

        The adjoint of covariances has no error bound. The shorter step is for resonances so sharp that the difference
        by the longer one is off.
        """
        slope = (gradient * point) @ self._direction
        for step in _ASTRIDE:
            ends = point * np.exp(step * np.outer([1.0, -1.0], self._direction))
            ahead, behind = self._combine(self._with_gradients(ends, np.empty(0))[0])
            if abs((ahead - behind) / (2.0 * step) - slope) <= allowed:
                return True
        return False

    def active(self, point: Array) -> Array | None:
        """Frequencies [rad/s] of the local maxima of the gain, the highest (or sharpest) first, for a peak gain."""
        if not self.is_peak:
            return None
        omegas, gains = (
            found[0] for found in gain_kernels.peaks_of(point[None], self.descriptor, self.extended_descriptor)
        )
        peaks = np.isfinite(omegas)
        if not peaks.any():  # equal poles have no partial fractions
            return np.array([peak.omega for peak in self._exact(point).peaks if np.isfinite(peak.omega)])
        order = np.argsort(-np.where(np.isnan(gains), np.inf, gains)[peaks], kind="stable")
        return np.asarray(omegas[peaks][order])

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """Gains at the frequencies `which`, and their gradients over the free values."""
        gains, gradients = gain_kernels.gains(point, self.descriptor, which)
        weight = self.problem.weights[0]
        return weight * gains, weight * gradients


def kernels_of(definition: IndexDefinition, by_modes: bool = False) -> tuple[Any, ...]:
    """The compiled code that values of the index and their gradients call, whatever the vehicle."""
    if definition.is_peak:
        return gain_kernels.peaks_of, gain_kernels.gains
    coherence = getattr(road_of(definition.drive), "coherence", None)
    corrected = coherence is not None and coherence.is_isotropic
    found: list[Any] = [h2_kernels.norms]
    if corrected:
        found.append(excess_kernels.corrections)
    if by_modes or coherence is not None or any(one is not None for one in definition.filters):
        found.append(modal_kernels.norms_by_modes)
    return tuple(found)


def first_kernel(problem: LinearProblem) -> Any:
    """The compiled code that values designs, where it is sure of them."""
    if problem.definition.is_peak:
        return gain_kernels.peaks_of
    return modal_kernels.norms_by_modes if _has_many_states(problem) else h2_kernels.norms


def _has_many_states(problem: LinearProblem) -> bool:
    """Whether norms by modes come first."""
    return len(problem.descriptor.states) >= _MANY_STATES


def _slopes(
    values: Callable[[Array], Array], point: Array, stencil: Sequence[tuple[float, float]]
) -> tuple[Array, Array]:
    """Central differences by relative steps, those of the stencil with their weights, and the values that they take."""
    steps, weights = np.array(stencil).T
    shifts = np.multiply.outer(np.concatenate([steps, -steps]), np.eye(point.size))
    around = values(point * (1.0 + shifts.reshape(-1, point.size))).reshape(2, steps.size, point.size)
    with np.errstate(invalid="ignore"):  # infinite on both sides: no gradient
        return weights @ (around[0] - around[1]) / point, around


def evaluate_problems(
    mechanism: Mechanism, definitions: Sequence[IndexDefinition], conventions: Conventions, points: Mapping[str, Array]
) -> Array:
    """Indices (designs, indices), nan where not ok; indices with the same excitation and filter share one solve."""
    problems = [linear_problem(mechanism, definition, conventions) for definition in definitions]
    groups: dict[Any, list[int]] = {}
    for i, (definition, problem) in enumerate(zip(definitions, problems, strict=True)):
        alone = definition.is_peak
        key = ("peak", i) if alone else (definition.excitation, _shared_filter(problem.definition))
        groups.setdefault(key, []).append(i)
    result: Array = np.empty((count_of(points), len(definitions)))
    for members in groups.values():
        if definitions[members[0]].is_peak:
            compiled = CompiledNorm(problems[members[0]])
            result[:, members[0]] = compiled.evaluate_points(rows_of(points, compiled.problem.descriptor.free))
            continue
        asked = [problems[i].definition for i in members]
        found = {o.output: (o, f) for one in asked for o, f in zip(one.outputs, one.filters, strict=True)}
        outputs, filters = (tuple(part) for part in zip(*found.values(), strict=True))
        joint = linear_problem(mechanism, replace(asked[0], outputs=outputs, filter=filters), conventions)
        compiled = CompiledNorm(joint)
        norms = compiled.output_norms(rows_of(points, joint.descriptor.free))
        places = [o.output for o in outputs]
        for i in members:
            columns = [places.index(o.output) for o in definitions[i].outputs]
            result[:, i] = definitions[i].combine(norms[:, columns], problems[i].weights)
    result[np.isinf(result)] = np.nan  # an infinite index has a status that is not ok
    return result


def _shared_filter(definition: IndexDefinition) -> Any:
    """The filter of all outputs; which outputs have which, where they differ."""
    several = set(definition.filters)
    return several.pop() if len(several) == 1 else (definition.outputs, definition.filters)
