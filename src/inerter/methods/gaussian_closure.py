"""Statistical linearisation of dry friction: the dampers whose r.m.s. force is that of the friction, and what follows.

With a Gaussian velocity of r.m.s. sigma across it, the damper nearest to a Coulomb friction f in the mean square is
c = sqrt(2/pi) f / sigma (Caughey 1963; Roberts and Spanos 1990), and sigma follows from c by one Lyapunov equation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from inerter.errors import Status, StatusKind
from inerter.indices.index import Question
from inerter.methods.compiled_norm import CompiledQuestion
from inerter.methods.equivalent import Equivalent, equivalent
from inerter.methods.linear import Conventions, LinearProblem, linear_problem
from inerter.methods.method import Estimate
from inerter.norms.h2 import h2
from inerter.systems.descriptor import close
from inerter.vehicle.mechanism import Mechanism, Weighted

Array = NDArray[np.float64]
_SHARE = math.sqrt(2.0 / math.pi)  # r.m.s. force of the equivalent damper over the friction force
_STEPS = 80
_SETTLED = 1e-10  # relative error of a damper's r.m.s. force
_NUDGE = 1e-5  # relative change of a damper for differences
_LOCKED = 1e-5  # d log(force) / d log(damper) below which a friction whose force is too small will not slip
_RIGID = 1e-7  # the same for a damper that stands for a rigid link


@dataclass(frozen=True, eq=False)
class Dampers:
    """Equivalent dampers (designs, frictions) [N s/m], those that stand for a friction that sticks, and the error.

    `error` is the largest relative error of the force of a friction that slips; nan where the covariance was lost.
    """

    damping: Array
    sticks: NDArray[np.bool_]
    error: Array  # (designs,)


def solve_dampers(rms: Callable[[Array, NDArray[np.intp]], Array], limits: Array, start: Array) -> Dampers:
    """Dampers c with c rms(c) = `limits`, by Newton's method in 1/c, for many designs side by side.

    `rms(c, designs)` gives the velocities (rows, frictions) for rows of dampers of the numbered designs. 1/force is
    nearly linear in 1/c both for small and for large c, which makes few steps of it. Where the force saturates below
    its limit the friction sticks, and the damper is made so large that it moves no more.
    """
    count, frictions = limits.shape
    damping, sticks, error = start.copy(), np.zeros(limits.shape, dtype=bool), np.full(count, np.inf)
    left = np.arange(count)
    for step in range(_STEPS):
        if left.size == 0:
            break
        ratio, slope = _forces(rms, damping[left], limits[left], left)
        own = np.einsum("rii->ri", slope)
        stuck = (ratio < 1.0) & (own < _LOCKED) | (ratio == 0.0)
        sticks[left] = stuck
        miss = np.where(stuck, 0.0, np.abs(ratio - 1.0))
        error[left] = miss.max(axis=1)
        factor = _newton(ratio, slope, stuck, careful=step > _STEPS // 2)
        rigid = stuck & (own < 2.0 * _RIGID)
        factor = np.where(stuck, np.where(rigid, 1.0, np.clip(own / _RIGID, 1.0, 1e3)), factor)
        settled = (error[left] <= _SETTLED) & np.all(rigid | ~stuck, axis=1) | np.isnan(error[left])
        damping[left] = np.where(settled[:, None], damping[left], damping[left] * factor)
        left = left[~settled]
    return Dampers(damping, sticks, error)


def _forces(
    rms: Callable[[Array, NDArray[np.intp]], Array], damping: Array, limits: Array, designs: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Forces over their limits, and d log(force i) / d log(damper j)."""
    rows, frictions = damping.shape
    nudged = damping[:, None, :] * (1.0 + _NUDGE * np.vstack([np.zeros(frictions), np.eye(frictions)]))
    found = rms(nudged.reshape(-1, frictions), np.repeat(designs, frictions + 1)).reshape(nudged.shape)
    still = found[:, 0] <= 1e-14 * found[:, 0].max(axis=1, keepdims=True, initial=0.0)
    logs = np.log(np.where(still[:, None] | ~(found > 0.0), np.nan, found))
    slope = np.eye(frictions) + np.swapaxes(logs[:, 1:] - logs[:, :1], 1, 2) / np.log1p(_NUDGE)
    slope = np.where(still[:, :, None] | still[:, None, :], np.eye(frictions), slope)
    return np.where(still, 0.0, damping * found[:, 0] / limits), slope


def _newton(ratio: Array, slope: Array, stuck: NDArray[np.bool_], careful: bool) -> Array:
    """Factors by which to multiply the dampers; `careful` takes short steps."""
    frictions = ratio.shape[1]
    free = ~stuck[:, :, None] & ~stuck[:, None, :]
    matrix = np.where(free & np.isfinite(slope), slope, np.eye(frictions))
    matrix = matrix + 1e-12 * np.eye(frictions)
    relative = np.linalg.solve(matrix, np.where(stuck | np.isnan(ratio), 0.0, ratio - 1.0)[..., None])[..., 0]
    if careful:
        return np.asarray(np.exp(-0.3 * np.clip(relative, -1.0, 1.0)))
    return np.asarray(1.0 / np.clip(1.0 + relative, 1e-2, 1e4))


@dataclass(frozen=True, eq=False)
class GaussianClosure:
    """An index of r.m.s. values as a function of the free values, with friction: an `Objective`.

    Gradients are those of the norms, with the dampers by implicit differentiation of their equations. The index is
    smooth but where a friction begins to slip.
    """

    index: CompiledQuestion
    velocities: CompiledQuestion  # across the frictions; without the index's filter
    parts: Equivalent

    @cached_property
    def columns(self) -> list[int]:
        """For each variable of the descriptor, where it stands in (values of the design, dampers)."""
        return self.parts.order(self.index.problem.descriptor)

    @cached_property
    def single(self) -> tuple[CompiledQuestion, ...]:
        """The velocity across each friction by itself."""
        problem = self.velocities.problem
        questions = [replace(problem.question, outputs=(output,)) for output in problem.question.outputs]
        descriptor = problem.descriptor
        rows = [
            replace(
                descriptor,
                Y_eta=descriptor.Y_eta[:, [i]],
                Y_x=descriptor.Y_x[:, [i]],
                Y_u=descriptor.Y_u[:, [i]],
                outputs=(descriptor.outputs[i],),
            )
            for i in range(len(questions))
        ]
        return tuple(
            CompiledQuestion(replace(problem, question=q, descriptor=d)) for q, d in zip(questions, rows, strict=True)
        )

    def check_idle(self) -> None:
        """Raises `DesignError` if a free value has no effect."""
        self.parts.check_idle(self.index.problem.descriptor)

    def rows(self, points: Array, damping: Array) -> Array:
        """Rows of values for the descriptors."""
        return np.ascontiguousarray(np.hstack([points, damping])[:, self.columns])

    def dampers(self, points: Array) -> Dampers:
        """The equivalent dampers at each row of `points`."""
        weight = self.velocities.problem.weights

        def rms(damping: Array, designs: NDArray[np.intp]) -> Array:
            return np.asarray(weight * self.velocities.output_norms(self.rows(points[designs], damping)))

        limits = _SHARE * self.parts.limits(points)
        return solve_dampers(rms, limits, np.full(limits.shape, self.parts.scale))

    def values(self, points: Array) -> Array:
        """The index at each row of `points`: infinite where it cannot be told."""
        known = self.known(points)
        return np.where(np.isnan(known), np.inf, known)

    def known(self, points: Array) -> Array:
        """The index at each row of `points`; nan where it cannot be told."""
        found = self.dampers(points)
        good = found.error <= 1e-6
        result = np.full(points.shape[0], np.nan)
        result[good] = self.index.known(self.rows(points[good], found.damping[good]))
        return result

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The index and its gradient over the free values."""
        found = self.dampers(point[None])
        row = self.rows(point[None], found.damping)[0]
        value, gradient = self._gradient(self.index, row)
        slips = np.flatnonzero(~found.sticks[0])
        design, on_damping = gradient[: point.size], gradient[point.size :]
        if slips.size == 0:
            return value, design
        damping = found.damping[0, slips]
        force, force_damping = np.zeros((slips.size, point.size)), np.eye(slips.size)  # derivatives of logarithms
        for row_of, i in enumerate(slips):
            speed, slope = self._gradient(self.single[i], row)
            force[row_of] += slope[: point.size] / speed
            force_damping[row_of] += slope[point.size :][slips] * damping / speed
            if self.parts.places[i] >= 0:
                force[row_of, self.parts.places[i]] -= 1.0 / point[self.parts.places[i]]
        change = -np.linalg.solve(force_damping, force)
        return value, design + (on_damping[slips] * damping) @ change

    def _gradient(self, question: CompiledQuestion, row: Array) -> tuple[float, Array]:
        """Value and gradient over (values of the design, dampers)."""
        value, over_variables = question.value_and_gradient(row)
        gradient = np.zeros(len(self.parts.design) + len(self.parts.dampers))
        gradient[self.columns] = over_variables
        return value, gradient

    def active(self, point: Array) -> Array | None:
        """None: the index is smooth."""
        return None

    def components(self, point: Array, which: Array) -> tuple[Array, Array]:
        """Not asked for where `active` gives None."""
        raise NotImplementedError

    def estimate(self) -> Estimate:
        """The index of a design without free values."""
        found = self.dampers(np.zeros((1, 0)))
        values = dict(zip(self.parts.dampers, found.damping[0].tolist(), strict=True))
        problem = self.index.problem
        if np.isnan(found.error[0]):
            message = "the r.m.s. velocity across a friction could not be computed: rounding hides it"
            return Estimate(math.nan, problem.question.unit, Status(StatusKind.FAILED, message))
        result = problem.estimate(close(problem.descriptor, values))
        if found.error[0] > _SETTLED and result.status.ok:
            message = f"the equivalent dampers are known to {found.error[0]:.1e} only"
            result = replace(result, status=Status(StatusKind.INACCURATE, message))
        told = [
            f"{words} sticks" if sticks else f"{words} taken as a damper of {c:.6g} N s/m"
            for words, c, sticks in zip(self.parts.frictions, found.damping[0], found.sticks[0], strict=True)
        ]
        return replace(result, notes=(*result.notes, *told))


def gaussian_closure(mechanism: Mechanism, question: Question, conventions: Conventions) -> GaussianClosure:
    """The closure for an index of r.m.s. values.

    A friction that the road's white velocity reaches directly, as one in a tyre, sees a velocity of infinite variance:
    its damper is zero, and it is left out.
    """
    excluded: list[str] = []
    while True:
        parts = equivalent(mechanism, excluded)
        index = CompiledQuestion(linear_problem(parts.mechanism, question, conventions))
        velocities = CompiledQuestion(_velocities(parts, question, conventions))
        direct = _direct(velocities)
        if not direct:
            return GaussianClosure(index, velocities, parts)
        excluded += [parts.frictions[i] for i in direct]


def _velocities(parts: Equivalent, question: Question, conventions: Conventions) -> LinearProblem:
    outputs = tuple(Weighted(f"{name}_velocity") for name in parts.dampers)
    asked = replace(question, outputs=outputs, high_pass=None, over_s=False)
    return linear_problem(parts.mechanism, asked, conventions)


def _direct(velocities: CompiledQuestion) -> Sequence[int]:
    """Numbers of the frictions that white noise passes straight to."""
    descriptor = velocities.problem.descriptor
    middle = {name: (free.lower * free.upper) ** 0.5 or free.upper for name, free in descriptor.variables.items()}
    return [int(i) for i in np.flatnonzero(np.any(close(descriptor, middle).D != 0.0, axis=1))]
