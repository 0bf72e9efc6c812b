"""What the noise of the encoder does to the estimates: it moves the model, and the fit leans away from that.

The noise that the smoothed displacement still has passes through the model into its force, so values that let less
of it through seem to fit better. How far this leads is found by adding as much noise again and seeing how far the
best fit leans further (simulation and extrapolation, Cook and Stefanski 1994, in its linear form). Each noise is also
added with the opposite sign, which cancels all that is not second order.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.experiment import disturbed
from inerter.identification.intervals import ROBUST, Optimum, steps_of
from inerter.identification.problem import Problem

Matrix = NDArray[np.float64]
PAIRS = 4


def lean(problem: Problem, optimum: Optimum, seed: int, pairs: int = PAIRS) -> Matrix:
    """How far the noise of the encoders has moved the best fit, in coordinates; at most two standard errors."""
    random = np.random.default_rng([seed, 1])
    steps = steps_of(optimum)
    gradients = []
    for _ in range(pairs):
        noises = [e.motion.noise * random.standard_normal(e.size) for e in problem.experiments]
        for sign in (-1.0, 1.0):
            moved = [disturbed(e, sign * noise) for e, noise in zip(problem.experiments, noises, strict=True)]
            there = replace(problem, experiments=moved)
            residual, jacobian = there.residual(optimum.point), there.jacobian(optimum.point, steps)
            weight = (1.0 + (residual / ROBUST) ** 2) ** -0.5
            gradients.append(jacobian.T @ (weight * residual))
            problem.simulations = there.simulations
    residual, jacobian = problem.residual(optimum.point), problem.jacobian(optimum.point, steps)
    weight = (1.0 + (residual / ROBUST) ** 2) ** -0.5
    extra = np.mean(gradients, axis=0) - jacobian.T @ (weight * residual)
    moved_by = -(optimum.covariance / optimum.variance) @ extra
    limit = 2.0 * optimum.errors
    return np.asarray(np.clip(moved_by, -limit, limit))
