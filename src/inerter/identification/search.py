"""From anywhere within the bounds to the best fit: many points, then the best of them improved on longer horizons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import qmc

from inerter.identification.problem import Problem

Matrix = NDArray[np.float64]
POINTS, KEPT = 128, 5
FIRST_HORIZON = 0.4
STEP = 1e-3  # of a coordinate, before its uncertainty is known


def search(
    problem: Problem,
    guess: Mapping[str, tuple[float, float]],
    seed: int,
    points: int = POINTS,
    progress: Callable[[float], None] | None = None,
) -> tuple[Matrix, list[float]]:
    """The best coordinates, and the costs that the starts came to on the first part of the records.

    `guess`: values that are known in advance, each with the half-width of the range to look in.
    """
    short = replace(problem, horizon=FIRST_HORIZON)
    candidates = starts(problem, guess, seed, points)
    costs = np.array([soft(r) for r in short.residuals(candidates)])
    if progress is not None:
        progress(0.3)
    found = []
    for done, i in enumerate(np.argsort(costs)[:KEPT]):
        found.append(improve(short, candidates[i], 20))
        if progress is not None:
            progress(0.3 + 0.5 * (done + 1) / KEPT)
    best = min(found, key=lambda f: f[1])
    final = improve(problem, best[0], 30)
    problem.simulations += short.simulations
    return final[0], sorted(f[1] for f in found)


def starts(problem: Problem, guess: Mapping[str, tuple[float, float]], seed: int, count: int) -> list[Matrix]:
    """Points of a Sobol sequence: half of them around the guess, if there is one, and a quarter without backlash."""
    space = problem.space
    lower, upper = space.bounds
    draws = qmc.Sobol(len(space.names), seed=seed).random(1 << (count - 1).bit_length())[:count]
    result = []
    for n, draw in enumerate(draws):
        point = lower + draw * (upper - lower)
        if guess and n % 4 != 3:
            for i, name in enumerate(space.names):
                if name in guess:
                    value, width = guess[name]
                    point[i] = space.placed_one(i, value + width * (2.0 * draw[i] - 1.0))
        elif n % 8 == 7:
            point[space.nonlinear] = lower[space.nonlinear]
        result.append(np.clip(point, lower, upper))
    if guess:
        middle = {n: guess[n][0] if n in guess else float(v) for n, v in space.named(0.5 * (lower + upper)).items()}
        result.append(space.placed(middle))
    return result


def soft(residual: Matrix) -> float:
    """Sum of squares that grow like their roots beyond 10: far from the best fit every residual is an outlier."""
    return float(np.sum(2.0 * (np.sqrt(1.0 + (residual / 10.0) ** 2) - 1.0)) * 100.0)


def improve(
    problem: Problem, start: Matrix, evaluations: int, steps: Matrix | None = None, scale: float = 10.0
) -> tuple[Matrix, float, Matrix, Matrix]:
    """Trust-region least squares from `start`: coordinates, cost, residuals and their derivatives.

    `scale`: residuals beyond it count less than their square (soft l1).
    """
    space = problem.space
    lower, upper = space.bounds
    widths = np.full(start.size, STEP) if steps is None else steps

    def derivatives(point: Matrix) -> Matrix:
        return problem.jacobian(point, widths)

    result = least_squares(
        problem.residual,
        np.clip(start, lower, upper),
        jac=derivatives,
        bounds=(lower - 1e-12, upper + 1e-12),
        x_scale="jac",
        loss="soft_l1",
        f_scale=scale,
        max_nfev=evaluations,
        xtol=1e-9,
        ftol=1e-9,
    )
    return np.clip(result.x, lower, upper), float(result.cost), np.asarray(result.fun), np.asarray(result.jac)
