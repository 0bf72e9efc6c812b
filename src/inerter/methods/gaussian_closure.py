"""Statistical linearisation of dry friction: equivalent dampers for a Gaussian motion, and the index with them.

With a Gaussian velocity of r.m.s. sigma across it, a Coulomb friction f has the equivalent damper sqrt(2/pi) f / sigma
(see `equivalent_damper`), and sigma follows from the dampers by one Lyapunov equation.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from inerter.errors import ErrorSource, MechanismError, Status, StatusKind
from inerter.formatting import format_share
from inerter.indices.definition import IndexDefinition
from inerter.methods.compiled_norm import CompiledNorm
from inerter.methods.equivalent import (
    PROMISE,
    STIFFEST,
    Equivalent,
    equivalent,
    poorly_represented,
    slipping_freely,
)
from inerter.methods.equivalent_damper import GAUSSIAN
from inerter.methods.error_bounds import with_error_sources
from inerter.methods.linear import Conventions, linear_problem
from inerter.methods.method import Estimate
from inerter.methods.notes import Note
from inerter.methods.objective import Smooth
from inerter.norms.response import rounded_response
from inerter.systems.descriptor import close
from inerter.systems.outputs import force_of, of_mount, velocity_of
from inerter.vehicle.mechanism import Mechanism, OutputWeight

Array = NDArray[np.float64]
_STEPS = 160
_SETTLED = 1e-10  # relative error of a damper's r.m.s. force
_NUDGE = 1e-4  # relative change of a damper for differences
_LOCKED = 0.02  # d log(force) / d log(damper) below which a friction whose force is too small will not slip
_RIGID = 1e-5  # the same for a damper that stands for a rigid link
_UNLIKE = (0.03, 0.45)  # error of the index where that is 1 - x, over x and x^2: velocities are not Gaussian then
_SHARE = (0.06, 0.82)  # the same as a share of the range that the index has over all dampers
_SPRINGY = 2.2  # times both for a friction that a spring is in series with: it sticks for longer
_EFFECT = (0.02, 0.35)  # error of what its force does to an output, relative to that, over 1 and x
_UNDAMPED_EFFECT = (0.1, 0.9)  # the same for a friction that springs alone are in series with, ...
_SPRINGY_EFFECT = (0.1, 1.4)  # ... and where no inerter is beside that either
_STRONGEST = 8.0  # times x: a share that its force has in an output at most; of 198 simulated ones the most was 2.6
_SLIPPED = 2.4  # times the share of the time in which the force through a rigid link exceeds friction: the error
_NEGLIGIBLE = 0.1  # of the promise, up to which the error by one friction is not looked at twice
_REST = 1.0 - 2.0 / math.pi  # mean square of f sign(v) less its damper's force, over f^2, for a Gaussian v
_NOT_GAUSSIAN = 1.1  # times what that adds to a force; of 22 simulated ones the most was 1.06
_GRID = 40  # frequencies from one to three times it, for what a friction adds to forces
_BETWEEN = 13  # dampers that stand for all that a friction may become
_SOFTER = 10.0  # part of a damper that holds: an index of what is held is the same with it
_FIRM = 1e4  # times a typical damper is as good as a rigid link for that

Speeds = Callable[[Array, NDArray[np.intp]], Array]


@dataclass(frozen=True, eq=False)
class Dampers:
    """Equivalent dampers (designs, frictions) [N s/m], masks of sticking frictions, and errors.

    `error` is the largest relative error of the force of a friction that slips; nan where the covariance was lost.
    `unlike` (designs, frictions) is what the index may be off by, relative to it, because one damper stands for a
    friction; infinite where that sticks for a part of the time, or damps so much that its velocity is not Gaussian.
    `share` is the same as a share of the range that the index has over all dampers in that place. `apart` is 1 - d
    log(force) / d log(damper), from 0 for weak friction to 1; 0 for what sticks.
    """

    damping: Array
    sticks: NDArray[np.bool_]
    error: Array  # (designs,)
    unlike: Array
    share: Array
    apart: Array

    def of(self, designs: NDArray[np.intp]) -> Dampers:
        """Equivalent dampers of the designs of these numbers."""
        return Dampers(*(getattr(self, each.name)[designs] for each in fields(self)))

    def with_larger_errors(self, factors: Array) -> Dampers:
        """The same dampers where each friction (frictions,) may be off by so many times as much."""
        unlike, share = self.unlike * factors, self.share * factors
        return replace(self, unlike=np.where(unlike <= PROMISE, unlike, np.inf), share=np.minimum(share, 1.0))


def solve_dampers(speeds: Speeds, limits: Array, start: Array, held: NDArray[np.bool_] | None = None) -> Dampers:
    """Dampers c with c speeds(c) = `limits`, by Newton's method in 1/c, for many designs side by side.

    `speeds(c, designs)` gives the r.m.s. velocities (rows, frictions) for rows of dampers of the numbered designs.
    1/force is nearly linear in 1/c both for small and for large c, so few steps are needed. A friction whose force
    saturates below its limit sticks; its damper ends so large that it hardly moves. `held` ones stick from the start.
    """
    damping, error = start.copy(), np.full(limits.shape[0], np.inf)
    held = np.zeros(limits.shape, dtype=bool) if held is None else held
    sticks, unlike, left = held.copy(), np.where(held, np.inf, 0.0), np.arange(limits.shape[0])
    share, apart = np.where(held, 1.0, 0.0), np.zeros(held.shape)
    for step in range(_STEPS):
        if left.size == 0:
            break
        ratio, slope = _forces(speeds, damping[left], limits[left], left)
        own = np.einsum("rii->ri", slope)
        saturated = (own < _LOCKED) | (damping[left] > STIFFEST * start[left])
        stuck = held[left] | (ratio * (1.0 + 20.0 * np.maximum(own, 0.0)) < 1.0) & saturated | (ratio == 0.0)
        miss = np.where(stuck, 0.0, np.abs(ratio - 1.0)).max(axis=1)
        settled = (miss <= _SETTLED) | np.isnan(miss)
        error[left], sticks[left] = miss, stuck
        apart[left] = np.where(stuck, 0.0, np.clip(1.0 - own, 0.0, 1.0))
        unlike[left], share[left] = _off_by(apart[left], GAUSSIAN.force_ratio * ratio, stuck)
        factor = np.where(stuck, 1.0, _newton(ratio, slope, stuck, alone=step % 40 >= 15))
        rigid = np.where(stuck & ~held[left], np.clip(own / _RIGID, 1.0, 1.0 / _RIGID), 1.0)
        damping[left] *= np.where(settled[:, None], rigid, factor)
        left = left[~settled]
    return Dampers(damping, sticks, error, unlike, share, apart)


def _off_by(apart: Array, ratio: Array, stuck: NDArray[np.bool_]) -> tuple[Array, Array]:
    """`unlike` and `share` of `Dampers` for each friction, from its `apart`.

    For one that sticks, from the `ratio` of the r.m.s. force through a rigid link to friction.
    """
    held = _SLIPPED * scipy.special.erfc(np.sqrt(0.5) / np.maximum(ratio, 1e-6))
    unlike, share = (np.where(stuck, held, apart * (a + b * apart)) for a, b in (_UNLIKE, _SHARE))
    return np.where(unlike <= PROMISE, unlike, np.inf), np.minimum(share, 1.0)


def _forces(speeds: Speeds, damping: Array, limits: Array, designs: NDArray[np.intp]) -> tuple[Array, Array]:
    """Forces over their limits, and d log(force i) / d log(damper j)."""
    frictions = damping.shape[1]
    nudged = damping[:, None, :] * (1.0 + _NUDGE * np.vstack([np.zeros(frictions), np.eye(frictions)]))
    found = speeds(nudged.reshape(-1, frictions), np.repeat(designs, frictions + 1)).reshape(nudged.shape)
    still = found[:, 0] <= 1e-12 * found[:, 0].max(axis=1, keepdims=True)
    logs = np.log(np.where(still[:, None] | ~(found > 0.0), np.nan, found))
    slope = np.eye(frictions) + np.swapaxes(logs[:, 1:] - logs[:, :1], 1, 2) / np.log1p(_NUDGE)
    slope = np.where(still[:, :, None] | still[:, None, :], np.eye(frictions), slope)
    return np.where(still, 0.0, damping * found[:, 0] / limits), slope


def _newton(ratio: Array, slope: Array, stuck: NDArray[np.bool_], alone: bool) -> Array:
    """Factors by which to multiply the dampers; `alone` as if each force depended on its own damper only.

    The matrix is singular where two frictions slip as one, such as two end to end; a single one slips as it must then.
    """
    identity = np.eye(ratio.shape[1])
    free = ~stuck[:, :, None] & ~stuck[:, None, :] & np.isfinite(slope)
    if alone:
        free &= identity > 0.0
    matrix = np.where(free, slope, identity) + 1e-12 * identity
    miss = np.where(stuck | np.isnan(ratio), 0.0, ratio - 1.0)
    relative = np.linalg.solve(matrix, (0.5 if alone else 1.0) * miss[..., None])[..., 0]
    return np.asarray(1.0 / np.clip(1.0 + relative, 0.1, 1e4))


@dataclass(frozen=True, eq=False)
class Pattern:
    """The linear model while certain frictions stick (rigid links) and the others slip (dampers)."""

    index: CompiledNorm
    velocities: CompiledNorm  # across the frictions that slip; without the index's filter
    parts: Equivalent

    @cached_property
    def columns(self) -> list[int]:
        """Position of each free value of the descriptor in (values of the design, dampers)."""
        return self.parts.order(self.index.problem.descriptor)

    @cached_property
    def single(self) -> tuple[CompiledNorm, ...]:
        """Objectives of the r.m.s. velocity across each friction."""
        problem = self.velocities.problem
        return tuple(CompiledNorm(problem.part(slice(i, i + 1))) for i in range(len(problem.definition.outputs)))

    def rows(self, points: Array, damping: Array) -> Array:
        """Rows of values in the order of the descriptor's free values."""
        return np.ascontiguousarray(np.hstack([points, damping])[:, self.columns])

    def dampers(self, points: Array, start: Array, held: NDArray[np.bool_] | None = None) -> Dampers:
        """The equivalent dampers at each row of `points`."""
        weight = self.velocities.problem.weights

        def speeds(damping: Array, designs: NDArray[np.intp]) -> Array:
            return np.asarray(weight * self.velocities.output_norms(self.rows(points[designs], damping)))

        if not start.shape[1]:
            none = np.zeros(start.shape, dtype=bool)
            return Dampers(start, none, np.zeros(points.shape[0]), *np.zeros((3, *start.shape)))
        found = solve_dampers(speeds, GAUSSIAN.force(self.parts.limits(points)), start, held)
        return found.with_larger_errors(np.where(self.parts.springy, _SPRINGY, 1.0))

    @cached_property
    def beside(self) -> NDArray[np.bool_]:
        """Whether an output of the index is the force of the mount that has a friction (outputs, frictions)."""
        outputs, mechanism = self.index.problem.unfiltered.outputs, self.parts.mechanism
        found = np.zeros((len(outputs), len(self.parts.dampers)), dtype=bool)
        for mount in mechanism.mounts():
            labels = {element.label for element in mount.network.elements()}
            forces = {of_mount(mount)[0], *map(force_of, labels), *(["force"] if len(mechanism.struts) == 1 else [])}
            for i in (i for i, name in enumerate(self.parts.dampers) if name in labels):
                found[:, i] |= [name in forces for name in outputs]
        return found

    def force_shares(self, values: Mapping[str, float]) -> Array:
        """Part of the force of each friction in each output (outputs, frictions), in the unit of the output over N.

        `values` are those of all that is free. From the responses H with the damper c of a friction and with 2 c, H':
        since its force is c times the velocity v' across it, the part is |H' - H| / (c |v'|), here in the mean square
        over the frequencies of v', or over three times those if that is more: the rest is there.
        """
        outputs, velocities = self.index.problem.unfiltered, self.velocities.problem.unfiltered
        poles = np.abs(np.linalg.eigvals(close(velocities, values).A))
        poles = poles[poles > 0.0] if np.any(poles > 0.0) else np.ones(1)
        lowest, highest = 0.1 * poles.min(), 10.0 * poles.max()
        omega = lowest * 3.0 ** np.arange(0.0, math.log(highest / lowest, 3.0) + 1.0, 1.0 / _GRID)
        before = rounded_response(close(outputs, values), omega)
        found = np.zeros(self.beside.shape)
        for i, name in enumerate(self.parts.dampers):
            doubled = {**values, name: 2.0 * values[name]}
            force = values[name] * rounded_response(close(velocities, doubled), omega)[:, [i]]
            change = rounded_response(close(outputs, doubled), omega) - before
            change, force = (np.sum(np.abs(one) ** 2, axis=2) for one in (change, force))
            part = np.where(force > 0.0, change / np.maximum(force, np.finfo(float).tiny), 0.0)
            density = force * omega[:, None]
            means = [np.sum(part * density, axis=0), np.sum(part[_GRID:] * density[:-_GRID], axis=0)]
            total = np.sum(density)  # zero across a friction that symmetry keeps from moving
            found[:, i] = np.sqrt(np.max(means, axis=0) / total) if total > 0.0 else 0.0
        return found

    def effect(self, dampers: Dampers) -> Array:
        """Relative error of what the force of each friction does to an output (designs, frictions); 0 if it sticks."""
        kinds = zip(self.parts.springy, self.parts.undamped, strict=True)
        terms = [_SPRINGY_EFFECT if one else _UNDAMPED_EFFECT if other else _EFFECT for one, other in kinds]
        constant, slope = np.array(terms).reshape(-1, 2).T
        return np.where(dampers.sticks, 0.0, constant + slope * dampers.apart)

    def off_in_forces(self, points: Array, dampers: Dampers) -> tuple[Array, Array]:
        """Relative errors of the index (designs,): by what the forces of frictions do to outputs, and by their rests.

        Each force is off by its `effect`. That of a friction with a Gaussian velocity is that of its damper, and a rest
        that is uncorrelated with it, which counts in the outputs that are forces beside it: dampers do less there.
        """
        rows = self.rows(points, dampers.damping)
        names = tuple(self.index.problem.descriptor.free)
        parts = np.array([self.force_shares(dict(zip(names, row.tolist(), strict=True))) for row in rows])
        limits = np.where(dampers.sticks, 0.0, self.parts.limits(points))
        limits /= self.index.problem.definition.drive.amplitude_density
        norms = self.index.output_norms(rows)
        moved = GAUSSIAN.force_ratio * np.einsum("rof,rf->ro", parts, limits * self.effect(dampers))
        rest = _REST * np.einsum("rof,rf->ro", np.where(self.beside, parts, 0.0) ** 2, limits**2)
        with np.errstate(invalid="ignore", divide="ignore"):
            by_forces, by_rests = (
                np.asarray(self.combine(changed) / self.combine(norms) - 1.0)
                for changed in (norms + moved, np.sqrt(norms**2 + rest))
            )
        return by_forces, _NOT_GAUSSIAN * by_rests

    def combine(self, norms: Array) -> Array:
        """The index of norms (..., outputs)."""
        return self.index.problem.definition.combine(norms, self.index.problem.weights)

    def spread(self, norms: Sequence[Array]) -> Array:
        """Range of the index (designs,) over the norms of its outputs (several, designs, outputs)."""
        return self.combine(np.max(norms, axis=0)) - self.combine(np.min(norms, axis=0))

    def value_and_gradient(self, definition: CompiledNorm, row: Array) -> tuple[float, Array]:
        """A value and its gradient over (values of the design, dampers)."""
        value, over_free = definition.value_and_gradient(row)
        gradient = np.zeros(len(self.parts.design) + len(self.parts.dampers))
        gradient[self.columns] = over_free
        return value, gradient


@dataclass(frozen=True, eq=False)
class DamperSolution:
    """Some designs that share a pattern, and their dampers there.

    `unlike` and `share` (designs, frictions) are those of all frictions of the mechanism, those that are links in the
    pattern too.
    """

    pattern: Pattern
    designs: NDArray[np.intp]
    dampers: Dampers
    unlike: Array
    share: Array


@dataclass(frozen=True, eq=False)
class GaussianClosure(Smooth):
    """An index of r.m.s. values as a function of the free values, with friction: `Differentiable`.

    Gradients are those of the norms, with the dampers by implicit differentiation of their equations. The index is
    smooth but where a friction begins to slip.
    """

    mechanism: Mechanism
    definition: IndexDefinition
    conventions: Conventions
    patterns: dict[frozenset[str], Pattern | None] = field(default_factory=dict)  # those met so far

    @cached_property
    def without(self) -> frozenset[str]:
        """Frictions whose dampers are zero, because white noise passes straight to them."""
        return slipping_freely(self.mechanism, self.definition)

    def pattern(self, locked: frozenset[str]) -> Pattern | None:
        """The linear model with these frictions stuck; None if that makes a mount rigid, which has no model."""
        without = self.without
        if locked not in self.patterns:
            try:
                self.patterns[locked] = _pattern(self, without, locked)
            except MechanismError:
                self.patterns[locked] = None
        return self.patterns[locked]

    @property
    def free(self) -> Pattern:
        """The linear model with every friction slipping."""
        pattern = self.pattern(frozenset())
        assert pattern is not None
        return pattern

    def check_idle(self) -> None:
        """Raises `DesignError` if a free value has no effect."""
        self.free.parts.check_idle(self.free.index.problem.descriptor)

    def solve(self, points: Array) -> list[DamperSolution]:
        """The dampers of every row of `points`, by which frictions stick."""
        start = np.full((points.shape[0], len(self.free.parts.dampers)), self.free.parts.scale)
        return self._solve(points, np.arange(points.shape[0]), start, frozenset(), np.zeros((2, *start.shape)))

    def _solve(
        self,
        points: Array,
        designs: NDArray[np.intp],
        start: Array,
        locked: frozenset[str],
        off_by: Array,
    ) -> list[DamperSolution]:
        pattern = self.pattern(locked)
        assert pattern is not None
        found = pattern.dampers(points[designs], start)
        off_by[:, designs[:, None], self._numbers(pattern)] = found.unlike, found.share
        kinds, kind_of = np.unique(found.sticks, axis=0, return_inverse=True)
        solved: list[DamperSolution] = []
        for number, sticks in enumerate(kinds):
            here = np.flatnonzero(kind_of.ravel() == number)
            part = found.of(here)
            more = {name for name, sticks_too in zip(pattern.parts.dampers, sticks, strict=True) if sticks_too}
            inner = self.pattern(locked | more) if more else None
            if inner is not None:
                still = [i for i, name in enumerate(pattern.parts.dampers) if name in inner.parts.dampers]
                solved += self._solve(points, designs[here], part.damping[:, still], locked | more, off_by)
                continue
            if more:
                too_stiff = np.any(part.sticks & (part.damping > STIFFEST * pattern.parts.scale), axis=1)
                part = pattern.dampers(points[designs[here]], part.damping, part.sticks)
                part.error[too_stiff] = np.nan
            solved.append(DamperSolution(pattern, designs[here], part, *off_by[:, designs[here]]))
        return solved

    def _numbers(self, pattern: Pattern) -> list[int]:
        """Numbers, among all frictions, of those that slip in a pattern."""
        return [self.free.parts.dampers.index(name) for name in pattern.parts.dampers]

    def off_by(self, points: Array, solved: DamperSolution, promise: float = PROMISE) -> Array:
        """Relative error of the index (designs,) from the linearisation: sum over all frictions.

        Where that is more than `promise`, a friction counts only by a share of the range that the index has without it,
        with a rigid link in its place, and with any damper between: it may not matter. (The ends alone do not tell: the
        index may have a minimum between two that are alike.)

        The range of an index of several outputs is that of all together: what one gains another may lose, in the index
        but not in its error.

        An index that vanishes with the slip of a friction that sticks, such as the travel across it, has no bound.

        It is at least what the index changes by if the force of each friction does a little more or less than that of
        its damper; this is not looked at where it is within `promise` for the strongest of effects.
        """
        free, designs, unlike = self.free, solved.designs, solved.unlike.copy()
        damping = np.full((designs.size, len(free.parts.dampers)), _FIRM * free.parts.scale)
        damping[:, self._numbers(solved.pattern)] = np.minimum(solved.dampers.damping, _FIRM * free.parts.scale)
        unsure = unlike.sum(axis=1) > promise
        for i in range(unlike.shape[1]):
            here = np.flatnonzero(unsure & (unlike[:, i] > _NEGLIGIBLE * promise))
            if not here.size:
                continue
            found = []
            for damper in free.parts.scale * np.geomspace(1.0 / _FIRM, _FIRM, _BETWEEN):
                damping_there = damping[here].copy()
                damping_there[:, i] = damper
                found.append(free.index.output_norms(free.rows(points[designs[here]], damping_there)))
            with np.errstate(invalid="ignore"):
                spread = free.spread(found) / np.min(free.combine(np.array(found)), axis=0)
            part = solved.share[here, i] * np.where(np.isnan(spread), np.inf, spread)
            unlike[here, i] = np.fmin(unlike[here, i], part)
        stuck = np.ones(unlike.shape, dtype=bool)
        stuck[:, self._numbers(solved.pattern)] = solved.dampers.sticks
        if stuck.any():
            softer = np.where(stuck, damping / _SOFTER, damping)
            held, less = (free.index.output_norms(free.rows(points[designs], one)) for one in (damping, softer))
            unlike[stuck & (free.spread([held, less]) > PROMISE * free.combine(held))[:, None]] = np.inf
        off, pattern, dampers = unlike.sum(axis=1), solved.pattern, solved.dampers
        strongest = np.sum(_STRONGEST * dampers.apart * pattern.effect(dampers), axis=1)
        seen = np.flatnonzero((off <= PROMISE) & (pattern.beside.any() | (strongest > promise)))
        if seen.size:
            by_forces, by_rests = pattern.off_in_forces(points[designs[seen]], dampers.of(seen))
            off[seen] = np.fmax(off[seen], by_forces) + by_rests
        return np.asarray(off)

    def values(self, points: Array) -> Array:
        """Index at each row of `points`, accurate or not; infinite where unknown."""
        known = self.evaluate_points(points, trusted=False)
        return np.where(np.isnan(known), np.inf, known)

    def evaluate_points(self, points: Array, trusted: bool = True) -> Array:
        """Index at each row of `points`; nan where it is not available, or not accurate if `trusted`."""
        result = np.full(points.shape[0], np.nan)
        for solved in self.solve(points):
            good = solved.dampers.error <= _SETTLED
            if trusted:
                good &= self.off_by(points, solved) <= PROMISE
            rows = solved.pattern.rows(points[solved.designs[good]], solved.dampers.damping[good])
            result[solved.designs[good]] = solved.pattern.index.evaluate_points(rows)
        return result

    def value_and_gradient(self, point: Array) -> tuple[float, Array]:
        """The index and its gradient over the free values."""
        (solved,) = self.solve(point[None])
        pattern, parts = solved.pattern, solved.pattern.parts
        row = pattern.rows(point[None], solved.dampers.damping)[0]
        value, gradient = pattern.value_and_gradient(pattern.index, row)
        slips = np.flatnonzero(~solved.dampers.sticks[0])
        design, on_damping = gradient[: point.size], gradient[point.size :]
        damping = solved.dampers.damping[0, slips]
        force, force_damping = np.zeros((slips.size, point.size)), np.eye(slips.size)  # derivatives of logarithms
        for row_of, i in enumerate(slips):
            speed, slope = pattern.value_and_gradient(pattern.single[i], row)
            force[row_of] += slope[: point.size] / speed
            force_damping[row_of] += slope[point.size :][slips] * damping / speed
            if parts.places[i] >= 0:
                force[row_of, parts.places[i]] -= 1.0 / point[parts.places[i]]
        return value, design - (on_damping[slips] * damping) @ np.linalg.solve(force_damping, force)

    def estimate(self) -> Estimate:
        """The index of a design without free values."""
        (solved,) = self.solve(np.zeros((1, 0)))
        parts, dampers, problem = solved.pattern.parts, solved.dampers, solved.pattern.index.problem
        if np.isnan(dampers.error[0]):
            message = "the r.m.s. velocity across a friction element could not be computed: lost to rounding"
            return Estimate(math.nan, self.definition.unit, Status(StatusKind.FAILED, message))
        result = problem.estimate(dict(zip(parts.dampers, dampers.damping[0], strict=True)))
        if dampers.error[0] > _SETTLED and result.status.ok:
            message = f"the equivalent dampers are known to {format_share(dampers.error[0], 2)} only"
            result = replace(result, status=Status(StatusKind.INACCURATE, message))
        bound = float(self.off_by(np.zeros((1, 0)), solved, promise=0.0)[0])
        if result.status.ok and not bound <= PROMISE:
            result = replace(result, status=poorly_represented(self._poor(solved), bound))
        result = with_error_sources(
            result, (ErrorSource("one damper for a friction element", bound + float(dampers.error[0])),), np.inf
        )
        told = [Note(f"{words} sticks") for words in parts.locked]
        told += [
            Note(f"{words} sticks") if sticks else Note(f"{words} taken as a damper of ", float(c), " N s/m")
            for words, c, sticks in zip(parts.frictions, dampers.damping[0], dampers.sticks[0], strict=True)
        ]
        return replace(result, notes=(*self.free.index.problem.descriptor.notes, *told))

    def _poor(self, solved: DamperSolution) -> str:
        """Clause on the frictions that one damper represents poorly."""
        unlike, words = solved.unlike[0], self.free.parts.frictions
        if not np.any(unlike > PROMISE) and (beside := np.flatnonzero(solved.pattern.beside.any(axis=0))).size:
            inside = " and ".join(solved.pattern.parts.frictions[i] for i in beside)
            return f"a force that contains that of {inside}"
        worst = np.flatnonzero(unlike > PROMISE) if np.any(unlike > PROMISE) else np.flatnonzero(unlike)
        return f"{' and '.join(words[i] for i in worst)} sticks for a part of the time, which"


def _pattern(closure: GaussianClosure, without: frozenset[str], locked: frozenset[str]) -> Pattern:
    parts = equivalent(closure.mechanism, without, locked)
    wanted = tuple(OutputWeight(velocity_of(name)) for name in parts.dampers)
    outputs = closure.definition.outputs
    filters = (*closure.definition.filters, *(None for _ in wanted))
    joint_definition = replace(closure.definition, outputs=(*outputs, *wanted), filter=filters)
    joint = linear_problem(parts.mechanism, joint_definition, closure.conventions)
    index, velocities = joint.part(slice(0, len(outputs))), joint.part(slice(len(outputs), None))
    return Pattern(CompiledNorm(index), CompiledNorm(velocities), parts)
