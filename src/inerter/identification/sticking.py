"""Frictions that never slip in the records: only a lower bound is known, and no inertance in parallel with them.

A sticking device is a spring and a damper only. A free fit may let it slip by a micrometre where the noise of the force
is largest, where the residual is discontinuous: on one side friction and inertance matter, on the other they do not,
and differences across it are meaningless. So the best fit that never slips is sought, and used unless the records
require slip.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from inerter.identification.intervals import (
    BestFit,
    CostProfile,
    Side,
    best_fit_of,
    constrained_optimum,
    profiles,
    robust_cost,
    steps_of,
)
from inerter.identification.problem import FitProblem
from inerter.networks.elements.roles import GuardRole, LinearRole
from inerter.systems.outputs import force_of

Matrix = NDArray[np.float64]
_EVALUATIONS, _ACCURACY = 8, 1e-7
_FAR = 100.0  # times the least cost, beyond which a sticking device is not near the best fit
_LEVEL = 0.99
_BESIDE = (0.0, 0.25, 0.5, 0.75, 1.0)  # between the bounds, of parameters without effect while sticking
_FIRST, _WIDER, _STEPS = 1e-3, 4.0, 14  # of the force held; of a step to the last; evaluations
_NEAR = 0.05  # of the root of a rise, to which an end is found


@dataclass(frozen=True)
class Adhesion:
    """Frictions (by coordinate) that never slip in the best fit, and the largest force [N] that each of them held."""

    held: dict[int, float]

    def __bool__(self) -> bool:
        return bool(self.held)

    def of(self, i: int) -> float | None:
        """The force [N] that friction i held, or the largest that any held; None where all slip."""
        return self.held.get(i, max(self.held.values(), default=None))


def with_adhesion(problem: FitProblem, optimum: BestFit) -> tuple[BestFit, Adhesion]:
    """The best fit without unnecessary slip, and the largest forces held by sticking frictions.

    Slip adds at least two unknowns, a friction and the moving inertance: it is accepted where the cost decreases by
    more than two unknowns would by chance.
    """
    held: dict[int, float] = {}
    for i in _frictions(problem):
        point = optimum.point.copy()
        point[i] = problem.space.bounds[1][i]
        far = robust_cost(problem.residual(point)) > _FAR * optimum.cost
        if far or _largest_held_force(problem, point, i) is None:
            continue
        still = best_fit_of(problem, point, steps_of(optimum), _EVALUATIONS, _ACCURACY)
        force = _largest_held_force(problem, still.point, i)
        allowed = 0.5 * float(chi2.ppf(_LEVEL, 2)) * still.variance * float(np.max(still.widening))
        if force is not None and still.cost <= optimum.cost + allowed:
            optimum, held[i] = still, force
    return optimum, Adhesion(held)


def is_unobservable(optimum: BestFit) -> NDArray[np.bool_]:
    """Mask of the coordinates on which the residuals do not depend."""
    sizes = np.linalg.norm(optimum.jacobian, axis=0)
    return np.asarray(sizes <= 1e-9 * float(sizes.max()))


def profiles_at_rest(problem: FitProblem, optimum: BestFit, adhesion: Adhesion) -> list[CostProfile]:
    """The profiles of a sticking device: frictions have a lower end, and the values at rest are unbounded."""
    lower, upper = problem.space.bounds
    unseen = is_unobservable(optimum)
    seen = np.flatnonzero(~unseen).tolist()
    found = dict(zip(seen, profiles(problem, optimum, seen), strict=True))
    for i in np.flatnonzero(unseen).tolist():
        ends = float(lower[i]), float(upper[i])
        found[i] = CostProfile(Side(ends[0], False), Side(ends[1], False), tuple((end, 0.0) for end in ends), None)
    for i, force in adhesion.held.items():
        found[i] = _profile_from_below(problem, optimum, i, force)
    return [found[i] for i in range(optimum.point.size)]


def _frictions(problem: FitProblem) -> list[int]:
    """The coordinates of frictions."""
    return [
        i
        for i, kind in enumerate(problem.space.kinds)
        if kind is not None and kind.linear is LinearRole.OPEN and kind.switch is not None
        if kind.switch.guard is GuardRole.FORCE
    ]


def _largest_held_force(problem: FitProblem, point: Matrix, i: int) -> float | None:
    """The largest force [N] that a friction held; None if it slipped, or the device cannot be simulated."""
    name, largest = problem.space.names[i], 0.0
    for e in problem.experiments:
        answer = problem.simulate(e, point)
        if answer is None or any(event.element == name for event in answer.run.events):
            return None
        largest = max(largest, float(np.abs(answer.run[force_of(name)]).max()))
    return largest


def _profile_from_below(problem: FitProblem, optimum: BestFit, i: int, force: float) -> CostProfile:
    """The profile of a friction that held `force` [N], from the bound of the search down to the rise of the cost."""
    space, threshold = problem.space, float(optimum.threshold[i])
    top, bottom = float(space.bounds[1][i]), float(space.bounds[0][i])
    points = [(space.coordinate_of(i, force), 0.0), (top, 0.0)]
    inside, outside, root = force, 0.0, 0.0
    value, step = force * (1.0 - _FIRST), _FIRST
    for _ in range(_STEPS):
        at = space.coordinate_of(i, value)
        root = np.sqrt(max(_least_cost(problem, optimum, i, at) - optimum.cost, 0.0) / threshold)
        points.append((at, float(root) ** 2))
        if abs(root - 1.0) < _NEAR:
            return _one_sided_profile(at, True, top, points)
        if root < 1.0:
            inside = value
            if at <= bottom + 1e-12:
                return _one_sided_profile(bottom, False, top, points)
        else:
            outside = value
        if outside == 0.0:
            step *= _WIDER
            value = force * max(1.0 - step, 0.0)
        else:
            value = 0.5 * (inside + outside)
    return _one_sided_profile(space.coordinate_of(i, outside), True, top, points)


def _one_sided_profile(end: float, known: bool, top: float, points: list[tuple[float, float]]) -> CostProfile:
    return CostProfile(Side(end, known), Side(top, False), tuple(sorted(points)), None)


def _least_cost(problem: FitProblem, optimum: BestFit, i: int, value: float) -> float:
    """The least cost with a friction at `value`, over the parameters that matter only in slip."""
    lower, upper = problem.space.bounds
    free = is_unobservable(optimum)
    free[i] = False
    costs = []
    for share in _BESIDE if free.any() else (0.0,):
        point = np.where(free, lower + share * (upper - lower), optimum.point)
        costs.append(constrained_optimum(problem, replace(optimum, point=point), i, value)[0])
    return min(costs)
