"""Global search for the best fit: many points on the first part of the records, fewer on increasing parts.

A rattling device depends on its past for a few impacts only, so over a whole record the cost has many local minima.
Over the first moments it has one, which leads to the right one of the next longer part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import qmc

from inerter.identification.options import POINTS
from inerter.identification.problem import FitProblem, map_problems
from inerter.work.progress import counter, part, report
from inerter.work.running import over_threads

Matrix = NDArray[np.float64]
Stages = tuple[tuple[float, int, int], ...]  # horizon, candidates, and evaluations of each
QUICK: Stages = ((1 / 16, 12, 6), (1 / 8, 8, 6), (1 / 4, 5, 6), (1 / 2, 3, 6), (1.0, 2, 12))
THOROUGH: Stages = ((1 / 16, 24, 10), (1 / 8, 12, 8), (1 / 4, 6, 8), (1 / 2, 4, 8), (1.0, 2, 12))
_ROUGH, _SAME = 1e-3, 3e-3  # accuracy on parts of the records, and difference of coordinates that count as equal
STEP = 1e-3  # of a coordinate, before its uncertainty is known
_HOPS, _PATIENCE, _EVALUATIONS = 12, 4, 8
_REACH = (1.0, 0.3, 2.0)  # of hops, over the distance at which the linearised cost would double
_FARTHEST = 0.3  # in a coordinate


def search(
    problem: FitProblem,
    guess: Mapping[str, tuple[float, float]],
    seed: int,
    points: int = POINTS,
    stages: Stages = QUICK,
    progress: Callable[[float], None] | None = None,
) -> tuple[Matrix, list[float]]:
    """The best coordinates, and the costs of the last candidates on half of the records.

    `guess`: initial estimates, each with the half-width of its search range.
    """
    candidates = starting_points(problem, guess, seed, points)
    first = replace(problem, horizon=stages[0][0])
    work = [stages[0][0] * len(candidates) / 8, *(share * kept * runs for share, kept, runs in stages)]
    done = [float(d) for d in np.cumsum(work) / sum(work)]
    tell = counter("starting points", len(candidates), part(progress, 0.0, done[0]))
    costs = []
    for residual in over_threads(first.residual, candidates):
        costs.append(robust_sum(residual))
        tell(len(costs) / len(candidates))
    halfway: list[float] = []
    for stage, (horizon, kept, evaluations) in enumerate(stages):
        shorter = replace(problem, horizon=horizon)
        accuracy = 1e-9 if horizon == 1.0 else _ROUGH
        candidates = distinct(candidates, costs)[:kept]
        what = f"search, stage {stage + 1} of {len(stages)}: start"
        tasks = [(shorter, candidate) for candidate in candidates]
        tell = counter(what, len(tasks), part(progress, done[stage], done[stage + 1]))
        found = map_problems(partial(_improve_candidate, evaluations, accuracy), tasks, progress=tell)
        candidates, costs = [f[0] for f in found], [f[1] for f in found]
        halfway = sorted(costs) if horizon < 1.0 else halfway
    return candidates[int(np.argmin(costs))], halfway


def _improve_candidate(evaluations: int, accuracy: float, problem: FitProblem, start: Matrix) -> tuple[Matrix, float]:
    point, cost, _, _ = improve(problem, start, evaluations, accuracy=accuracy)
    return point, cost


def distinct(candidates: list[Matrix], costs: list[float]) -> list[Matrix]:
    """The candidates, the best first, without those equal to a better one."""
    result: list[Matrix] = []
    for i in np.argsort(costs):
        if all(np.abs(candidates[i] - other).max() > _SAME for other in result):
            result.append(candidates[i])
    return result


def starting_points(
    problem: FitProblem, guess: Mapping[str, tuple[float, float]], seed: int, count: int
) -> list[Matrix]:
    """Points of a Sobol' sequence: three quarters of them around the guess, if there is one, and some without backlash.

    A value that may be zero is drawn as the cube of a uniform one, because its order of magnitude is unknown.
    """
    space = problem.space
    lower, upper = space.bounds
    draws = qmc.Sobol(len(space.names), seed=seed).random(1 << (count - 1).bit_length())[:count]
    result = []
    for n, draw in enumerate(draws):
        point = np.where(space.lower < 0.0, upper * (2.0 * draw - 1.0) ** 3, lower + (upper - lower) * draw)
        point = np.where(space.lower == 0.0, upper * draw**3, point)
        if guess and n % 4 != 3:
            for i, name in enumerate(space.names):
                if name in guess:
                    value, width = guess[name]
                    point[i] = space.coordinate_of(i, value + width * (2.0 * draw[i] - 1.0))
        elif n % 8 == 7:
            point[space.nonlinear] = lower[space.nonlinear]
        result.append(np.clip(point, lower, upper))
    if guess:
        middle = {
            n: guess[n][0] if n in guess else float(v) for n, v in space.values_by_name(0.5 * (lower + upper)).items()
        }
        result.append(space.coordinates_of(middle))
    return result


def basin_hopping(problem: FitProblem, start: Matrix, seed: int) -> Matrix:
    """The best fit that can be reached from `start` by hops to nearby points, each improved.

    Hops go as far as the linearised cost would about double: far in flat directions, and far from bad fits.
    Source: basin hopping (Wales and Doye 1997), here without steps upwards.
    """
    random = np.random.default_rng([seed, 3])
    lower, upper = problem.space.bounds
    point, cost, _, jacobian = improve(problem, start, _EVALUATIONS)
    failures = 0
    for hop in range(_HOPS):
        report("basin hopping", hop, _HOPS)
        _, size, axes = np.linalg.svd(jacobian, full_matrices=False)
        reach = _REACH[hop % len(_REACH)] * np.sqrt(2.0 * cost / point.size)
        move = axes.T @ (reach / np.maximum(size, 1e-6 * size[0] + 1e-300) * random.standard_normal(point.size))
        move *= min(1.0, _FARTHEST / max(float(np.abs(move).max()), 1e-300))
        found = improve(problem, np.clip(point + move, lower, upper), _EVALUATIONS)
        failures = 0 if found[1] < 0.95 * cost else failures + 1
        if found[1] < cost:
            point, cost, _, jacobian = found
        if failures == _PATIENCE:
            break
    return point


def robust_sum(residual: Matrix) -> float:
    """Robust sum of squares, linear beyond 10: far from the best fit every residual is an outlier."""
    return float(np.sum(2.0 * (np.sqrt(1.0 + (residual / 10.0) ** 2) - 1.0)) * 100.0)


def improve(
    problem: FitProblem,
    start: Matrix,
    evaluations: int,
    steps: Matrix | None = None,
    scale: float = 10.0,
    accuracy: float = 1e-9,
) -> tuple[Matrix, float, Matrix, Matrix]:
    """Trust-region least squares from `start`: coordinates, cost, residuals and their derivatives.

    `scale`: residuals beyond it count less than their square (soft l1). The fit ends where a step changes the cost or
    the coordinates by less than `accuracy`.
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
        xtol=accuracy,
        ftol=accuracy,
    )
    return np.clip(result.x, lower, upper), float(result.cost), np.asarray(result.fun), np.asarray(result.jac)
