"""Confidence intervals by profile likelihood: one value fixed, all others re-optimised (Raue et al. 2009)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.stats import t as student

from inerter.identification.problem import FitProblem, map_problems
from inerter.identification.search import improve
from inerter.methods.averages import CONFIDENCE
from inerter.work.progress import counter
from inerter.work.running import over_threads

Matrix = NDArray[np.float64]
ROBUST = 3.0  # whitened residuals beyond this count less than their square
_STEPS = (1e-6, 1e-2)  # of a coordinate, between which differences are taken
_BLOCKS = 40
_FOLLOWING, _SEARCHING, _RETURNING = 3, 8, 8
_RETURNED = 1e-5  # relative change of the cost that ends a return to the profile
_BENT = 1.25  # times the rise of a linear model: a profile that rises more is followed with derivatives near there


@dataclass(frozen=True, eq=False)
class BestFit:
    """The best fit and its neighbourhood, in coordinates."""

    point: Matrix
    cost: float  # half the robust sum of squares
    residual: Matrix
    jacobian: Matrix  # with the weights of the robust cost
    variance: float  # of a whitened residual
    covariance: Matrix  # of the coordinates
    widening: Matrix  # of the threshold of each profile, for residuals that are still autocorrelated
    samples: int

    @property
    def errors(self) -> Matrix:
        """Standard errors of the coordinates."""
        return np.sqrt(np.diag(self.covariance) * self.widening)

    @property
    def threshold(self) -> Matrix:
        """Rise of each profile at the ends of its 95 % confidence interval."""
        quantile = float(student.ppf(0.5 + 0.5 * CONFIDENCE, max(self.samples - self.point.size, 1)))
        return 0.5 * quantile**2 * self.variance * self.widening


def best_fit_of(
    problem: FitProblem,
    start: Matrix,
    steps: Matrix | None = None,
    evaluations: int = 20,
    accuracy: float = 1e-9,
) -> BestFit:
    """The best fit near `start`, with differences as wide as the coordinates are uncertain."""
    return _best_fit(problem, *improve(problem, start, evaluations, steps, ROBUST, accuracy))


def _best_fit(problem: FitProblem, point: Matrix, cost: float, residual: Matrix, jacobian: Matrix) -> BestFit:
    samples = sum(int((w.weight > 0.0).sum()) for w in problem.whitenings)
    variance = 2.0 * cost / max(samples - point.size, 1)
    information = jacobian.T @ jacobian
    covariance = np.asarray(np.linalg.pinv(information, rcond=1e-14, hermitian=True) * variance)
    return BestFit(
        point, cost, residual, jacobian, variance, covariance, _widening(jacobian, residual, variance), samples
    )


def fit_by_secants(
    problem: FitProblem, start: Matrix, jacobian: Matrix, rounds: int, accuracy: float, held: int | None = None
) -> BestFit:
    """The fit after some Gauss-Newton steps from `start`, near which the derivatives of the residuals are known.

    Each step takes one simulation, which updates the derivatives too (Broyden 1965); a step without improvement is
    damped (Levenberg 1944). The fit ends where a step changes the cost by less than `accuracy`. The coordinate `held`
    stays at its start.
    """
    lower, upper = (bound.copy() for bound in problem.space.bounds)
    if held is not None:
        lower[held] = upper[held] = start[held]
    size = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
    point, slopes, damping = np.clip(start, lower, upper), jacobian / size, 1e-6
    residual = problem.residual(point)
    cost = robust_cost(residual)
    for _ in range(rounds):
        root = (1.0 + (residual / ROBUST) ** 2) ** -0.25
        low, high = (lower - point) * size - 1e-12, (upper - point) * size + 1e-12
        step = _damped_step(root[:, None] * slopes, root * residual, damping, (low, high))
        other = np.clip(point + step / size, lower, upper)
        step = (other - point) * size
        length = float(step @ step)
        if length == 0.0:
            break
        there = problem.residual(other)
        rise = robust_cost(there) - cost
        if rise < cost:  # otherwise too far for the derivatives here
            slopes += np.outer((there - residual - slopes @ step) / length, step)
        if rise >= 0.0:
            damping = max(10.0 * damping, 1e-2)
            continue
        point, residual, cost, damping = other, there, cost + rise, 0.1 * damping
        if -rise < accuracy * cost:
            break
    root = (1.0 + (residual / ROBUST) ** 2) ** -0.25
    return _best_fit(problem, point, cost, residual, root[:, None] * slopes * size)


def _damped_step(slopes: Matrix, residual: Matrix, damping: float, bounds: tuple[Matrix, Matrix]) -> Matrix:
    """The step within bounds with the smallest residual, by linear least squares."""
    triangle = np.asarray(np.linalg.qr(np.column_stack([slopes, residual]), mode="r"))
    count = slopes.shape[1]
    rows = np.vstack([triangle[:count, :count], math.sqrt(damping) * np.eye(count)])
    return np.asarray(lsq_linear(rows, -np.append(triangle[:count, count], np.zeros(count)), bounds).x)


def steps_of(optimum: BestFit) -> Matrix:
    """Half a standard error of each coordinate, within limits."""
    return np.clip(0.5 * np.nan_to_num(optimum.errors, nan=_STEPS[1]), *_STEPS)


def _widening(jacobian: Matrix, residual: Matrix, variance: float) -> Matrix:
    """Variances over those of independent residuals, from sums over blocks of time; at least one.

    Source: the sandwich estimator for dependent data, with blocks as clusters (Liang and Zeger 1986).
    """
    scores = jacobian * (residual * (1.0 + (residual / ROBUST) ** 2) ** 0.25)[:, None]  # its rows are weighted already
    blocks = np.array([part.sum(axis=0) for part in np.array_split(scores, _BLOCKS)])
    inverse = np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True)
    sandwich = np.diag(inverse @ (blocks.T @ blocks) @ inverse)
    plain = np.maximum(np.diag(inverse) * variance, 1e-300)
    return np.maximum(sandwich / plain, 1.0)


@dataclass(frozen=True)
class Side:
    """One end of an interval, in coordinates; `known` if determined by the record, not by the bound of the search."""

    end: float
    known: bool


@dataclass(frozen=True, eq=False)
class CostProfile:
    """Both ends, the points of the profile (coordinate, rise of the cost over its threshold), and a better fit."""

    lower: Side
    upper: Side
    points: tuple[tuple[float, float], ...]
    better: tuple[float, Matrix] | None  # a cost below the optimum's, and where

    def shift(self, by: float) -> CostProfile:
        """The shifted profile; ends at the bounds of the search are kept."""
        lower, upper = (replace(side, end=side.end + by) if side.known else side for side in (self.lower, self.upper))
        return CostProfile(lower, upper, tuple((x + by, rise) for x, rise in self.points), self.better)

    def widen(self, by: float) -> CostProfile:
        """The profile with the end towards another value shifted as far as it is; ends at bounds are kept."""
        return replace(
            self,
            lower=replace(self.lower, end=self.lower.end + min(by, 0.0) * self.lower.known),
            upper=replace(self.upper, end=self.upper.end + max(by, 0.0) * self.upper.known),
        )


def profiles(problem: FitProblem, optimum: BestFit, among: Sequence[int] | None = None) -> list[CostProfile]:
    """The profile of every coordinate, or of those `among` them."""
    coordinates = list(range(optimum.point.size)) if among is None else among
    tasks = [(problem, (i, sign)) for i in coordinates for sign in (-1, 1)]
    found = map_problems(
        partial(_profile_side, optimum), tasks, over_threads, counter("sides of intervals", len(tasks))
    )
    result = []
    for n, i in enumerate(coordinates):
        (below, points, better), (above, more, other) = found[2 * n], found[2 * n + 1]
        best = min((b for b in (better, other) if b is not None), key=lambda b: b[0], default=None)
        result.append(CostProfile(below, above, tuple(sorted([*points, (float(optimum.point[i]), 0.0), *more])), best))
    return result


def _profile_side(
    optimum: BestFit, problem: FitProblem, way: tuple[int, int]
) -> tuple[Side, list[tuple[float, float]], tuple[float, Matrix] | None]:
    """Walk from the optimum along a coordinate, up or down, until the rise of the cost reaches its threshold."""
    i, sign = way
    bound = float(problem.space.bounds[1 if sign > 0 else 0][i])
    start, threshold = float(optimum.point[i]), float(optimum.threshold[i])
    points: list[tuple[float, float]] = []
    better: tuple[float, Matrix] | None = None
    room = sign * (bound - start)
    if room <= 1e-9:
        return Side(bound, False), points, None
    inside, outside, near = (0.0, 0.0), (np.inf, np.inf), optimum.point
    reach = float(np.sqrt(2.0 * threshold / max(_stiffness(optimum, i), 1e-300)))
    away = min(max(reach, 1e-9), room)
    for _ in range(_SEARCHING):
        cost, point = constrained_optimum(problem, optimum, i, start + sign * away)
        if optimum.point.size > 1 and cost - optimum.cost > threshold * max(_BENT * away / reach, 0.9) ** 2:
            other = _follow_profile(problem, optimum, near, i, start + sign * away)
            cost, point = other if other[0] < cost else (cost, point)
        root = float(np.sign(cost - optimum.cost) * np.sqrt(abs(cost - optimum.cost) / threshold))
        points.append((start + sign * away, max(root, 0.0) ** 2))
        if root < -0.3:
            better = (cost, point)
            break
        if abs(root - 1.0) < 0.03:
            return Side(start + sign * away, True), points, better
        if root < 1.0:
            inside, near = (away, max(root, 0.0)), point
            if away >= room * (1.0 - 1e-12):
                return Side(bound, False), points, better
        else:
            outside = (away, root)
        if outside[0] == np.inf:
            away = min(away * (3.0 if root < 0.3 else 1.2 / max(root, 0.4)), room)
        else:
            share = np.clip((1.0 - inside[1]) / (outside[1] - inside[1]), 0.1, 0.9)
            away = inside[0] + float(share) * (outside[0] - inside[0])
    return Side(start + sign * min(outside[0], room), np.isfinite(outside[0])), points, better


def _follow_profile(problem: FitProblem, optimum: BestFit, near: Matrix, i: int, value: float) -> tuple[float, Matrix]:
    """The least cost with coordinate i at `value`, from the point `near` of its profile, with the derivatives there."""
    lower, upper = problem.space.bounds
    J = problem.jacobian(near, steps_of(optimum))
    others = [j for j in range(near.size) if j != i]
    point = near.copy()
    point[i] = value
    if others:
        point[others] -= np.linalg.lstsq(J[:, others], J[:, i], rcond=1e-6)[0] * (value - near[i])
    found = fit_by_secants(problem, np.clip(point, lower, upper), J, _RETURNING, _RETURNED, held=i)
    return found.cost, found.point


def _stiffness(optimum: BestFit, i: int) -> float:
    """Second derivative of the profile at the optimum."""
    return float(optimum.variance / max(optimum.covariance[i, i], 1e-300))


def constrained_optimum(problem: FitProblem, optimum: BestFit, i: int, value: float) -> tuple[float, Matrix]:
    """The least cost with coordinate i at `value`, by Gauss-Newton steps with the derivatives of the optimum."""
    lower, upper = problem.space.bounds
    others = np.array([j for j in range(optimum.point.size) if j != i], dtype=int)
    J = optimum.jacobian
    point = optimum.point.copy()
    point[i] = value
    if others.size:
        normal = np.linalg.pinv(J[:, others].T @ J[:, others], rcond=1e-12, hermitian=True)
        point[others] -= normal @ (J[:, others].T @ J[:, i]) * (value - optimum.point[i])
    point = np.clip(point, lower, upper)
    best, at = np.inf, point
    for _ in range(_FOLLOWING if others.size else 1):
        residual = problem.residual(point)
        cost = robust_cost(residual)
        if cost >= best:
            break
        best, at = cost, point
        if not others.size:
            break
        weight = (1.0 + (residual / ROBUST) ** 2) ** -0.5
        point = at.copy()
        point[others] -= normal @ (J[:, others].T @ (weight * residual))
        point = np.clip(point, lower, upper)
        if np.allclose(point, at, rtol=0.0, atol=1e-10):
            break
    return best, at


def robust_cost(residual: Matrix) -> float:
    """Half the sum of soft-l1 squares, as `improve` minimises it."""
    return 0.5 * float(np.sum(soft_squares(residual)))


def soft_squares(residual: Matrix) -> Matrix:
    """Soft-l1 squares of whitened residuals, linear beyond `ROBUST`."""
    return np.asarray(2.0 * ROBUST**2 * (np.sqrt(1.0 + (residual / ROBUST) ** 2) - 1.0))
