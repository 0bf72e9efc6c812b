"""`Norm` for many designs of one layout, and for the optimiser: the same numbers from compiled code.

The compiled path serves designs that decay and pass no white noise straight through, which the topology decides. It
is tried at one design with the exact norms; where it does not serve, and for the single design at which it fails, the
exact norms answer instead, so that no number is silently wrong.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from inerter.errors import Status, StatusKind
from inerter.indices.index import Combination, Question
from inerter.kernels import gain as gain_kernels
from inerter.kernels import h2 as h2_kernels
from inerter.methods.linear import Conventions, LinearProblem, linear_problem
from inerter.norms.delay import pade
from inerter.norms.h2 import h2
from inerter.systems.descriptor import Descriptor, close
from inerter.vehicle.mechanism import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CompiledQuestion:
    """One question as a function of the free values: the `Objective` of `Norm`."""

    problem: LinearProblem
    costly = False

    @cached_property
    def descriptor(self) -> tuple[Any, ...]:
        """The descriptor's arrays in the order in which compiled code takes them."""
        names = ("S", "R", "F", "X_eta", "X_x", "X_u", "Y_eta", "Y_x", "Y_u")
        return tuple(np.ascontiguousarray(getattr(self.problem.descriptor, name), dtype=float) for name in names)

    @cached_property
    def sizes(self) -> tuple[Any, ...]:
        """The sizes of the terms of S, R, F, Y_eta and Y_x."""
        return tuple(np.ascontiguousarray(stack) for stack in self.problem.descriptor.sizes[:5])

    @cached_property
    def arrivals(self) -> tuple[Array, NDArray[np.complex128], NDArray[np.complex128], float]:
        """Times between arrivals of the road, and the Pade approximant (no poles where the delay is exact)."""
        order = self.problem.pade_order
        none = np.zeros(0, dtype=complex)
        gaps = np.diff(self.problem.delays)
        if order is None:
            return gaps, none, none, 0.0
        approximant = pade(order)
        return gaps, approximant.poles, approximant.residues, approximant.direct

    @property
    def corner(self) -> float:
        """The high-pass corner [rad/s], zero for none."""
        return self.problem.corner or 0.0

    @property
    def is_peak(self) -> bool:
        """Whether the index is a peak gain."""
        return self.problem.question.combination is Combination.PEAK_GAIN

    @cached_property
    def serves(self) -> bool:
        """Whether compiled code may be used for this topology, judged at the middle of the bounds."""
        middle = {name: (free.lower * free.upper) ** 0.5 or free.upper for name, free in self._variables.items()}
        return bool(self._exact(np.array(list(middle.values()))).status.ok)

    @property
    def _variables(self) -> dict[str, Any]:
        return dict(self.problem.descriptor.variables)

    def _exact(self, point: Array) -> Any:
        values = dict(zip(self._variables, point.tolist(), strict=True))
        return self.problem.estimate(close(self.problem.descriptor, values))

    def values(self, points: Array) -> Array:
        """The index at each row of `points`, for a search: infinite where compiled code cannot tell.

        Those are designs with hardly any damping, which no search wants; to value them exactly would cost more than
        all the others.
        """
        values = self._compiled(points) if self.serves else self.known(points)
        return np.where(np.isnan(values), np.inf, values)

    def known(self, points: Array) -> Array:
        """The index at each row of `points`, from the exact norms where need be; nan where rounding decides."""
        if not self.is_peak:
            return np.asarray(self.output_norms(points) @ self.problem.weights)
        result = self._compiled(points)
        for i in np.flatnonzero(np.isnan(result)):
            estimate = self._exact(points[i])
            result[i] = np.nan if _is_lost(estimate.status) else estimate.value
        return result

    def output_norms(self, points: Array) -> Array:
        """Norms (designs, outputs) at each row of `points`, for an index of r.m.s. values."""
        result = self._compiled_norms(points)
        for i in np.flatnonzero(np.isnan(result).any(axis=1)):
            values = dict(zip(self._variables, points[i].tolist(), strict=True))
            system = self.problem.system(close(self.problem.descriptor, values))
            exact = h2(system, self.problem.pade_order)
            result[i] = np.nan if _is_lost(exact.status) else exact.outputs
        return result

    def _compiled(self, points: Array) -> Array:
        """The index by compiled code alone; nan where it cannot tell."""
        if not self.is_peak:
            return np.asarray(self._compiled_norms(points) @ self.problem.weights)
        if not self.serves:
            return np.full(points.shape[0], np.nan)
        largest = gain_kernels.peaks_of(points, self.descriptor)[1].max(axis=1)
        return np.where(np.isfinite(largest), largest * self.problem.weights[0], np.nan)

    def _compiled_norms(self, points: Array) -> Array:
        if not self.serves:
            return np.full((points.shape[0], len(self.problem.descriptor.outputs)), np.nan)
        norms, _, good = h2_kernels.norms(points, self.descriptor, self.sizes, self.arrivals, self.corner, np.empty(0))
        norms[~good] = np.nan
        return np.asarray(norms)

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """An index of r.m.s. values and its gradient; by differences where compiled code does not serve."""
        if self.serves:
            weights = self.problem.weights
            norms, gradients, good = h2_kernels.norms(
                point[None], self.descriptor, self.sizes, self.arrivals, self.corner, weights
            )
            if good[0]:
                return float(norms[0] @ weights), gradients[0]
        return self._exact(point).value, self._difference(point)

    def _difference(self, point: Array) -> Array:
        steps = 1e-5 * point * np.eye(point.size)
        ends = self.values(np.vstack([point + steps, point - steps]))
        with np.errstate(invalid="ignore"):  # infinite on both sides: no gradient
            return np.asarray((ends[: point.size] - ends[point.size :]) / (2e-5 * point))

    def active(self, point: Array) -> Array | None:
        """Frequencies [rad/s] of the local maxima of the gain, the highest (or sharpest) first, for a peak gain."""
        if not self.is_peak:
            return None
        omegas, gains = (found[0] for found in gain_kernels.peaks_of(point[None], self.descriptor))
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


def evaluate_problems(
    mechanism: Mechanism, questions: Sequence[Question], conventions: Conventions, points: Mapping[str, Array]
) -> Array:
    """Indices (designs, indices); questions that share road and filter share one solve a design."""
    problems = [linear_problem(mechanism, question, conventions) for question in questions]
    groups: dict[Any, list[int]] = {}
    for i, (question, problem) in enumerate(zip(questions, problems, strict=True)):
        alone = question.combination is Combination.PEAK_GAIN
        key = ("peak", i) if alone else (question.road, question.inputs, problem.corner)
        groups.setdefault(key, []).append(i)
    result: Array = np.empty((next(iter(points.values())).size if points else 1, len(questions)))
    for members in groups.values():
        if questions[members[0]].combination is Combination.PEAK_GAIN:
            compiled = CompiledQuestion(problems[members[0]])
            result[:, members[0]] = compiled.known(_rows(compiled.problem.descriptor, points, result.shape[0]))
            continue
        outputs = tuple({o.output: o for i in members for o in questions[i].outputs}.values())
        joint = linear_problem(mechanism, replace(questions[members[0]], outputs=outputs), conventions)
        joint = replace(joint, corner=problems[members[0]].corner)
        compiled = CompiledQuestion(joint)
        norms = compiled.output_norms(_rows(joint.descriptor, points, result.shape[0]))
        places = [o.output for o in outputs]
        for i in members:
            columns = [places.index(o.output) for o in questions[i].outputs]
            result[:, i] = norms[:, columns] @ problems[i].weights
    return result


def _is_lost(status: Status) -> bool:
    return status.kind in (StatusKind.INACCURATE, StatusKind.FAILED)


def _rows(descriptor: Descriptor, points: Mapping[str, Array], count: int) -> Array:
    columns = [points[name] for name in descriptor.variables]
    return np.ascontiguousarray(np.column_stack(columns)) if columns else np.empty((count, 0))
