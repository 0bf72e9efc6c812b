"""Values with the filter of a load cell of unstated bandwidth, for which a delay stands in a fit.

A filter delays slow forces by the square root of two over its angular frequency, but attenuates faster ones too, which
a delay does not. What that changes in the values is no noise, and a precise record shows more of it than its intervals
contain. A fit with the filter in place of the delay tells how much; where it fits as well, the intervals are widened to
the values of both, and the difference is added in squares to the standard errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from inerter.identification.hypotheses import DELAY, LOAD_CELL, load_cell
from inerter.identification.intervals import BestFit, CostProfile, fit_by_secants, steps_of
from inerter.identification.parameter_space import space_of
from inerter.identification.problem import FitProblem
from inerter.identification.statements.causes import Suspect

Matrix = NDArray[np.float64]
_ROUNDS, _ACCURACY = 10, 1e-6
_STEP = 0.05  # of the logarithm of a bandwidth, for differences
_AS_GOOD = 2.0  # rise of the cost up to which the filter is as likely, as at the ends of an interval of 95 %


def with_filter(
    problem: FitProblem, optimum: BestFit, found: Sequence[CostProfile]
) -> tuple[BestFit, list[CostProfile]]:
    """The best fit and its profiles, as uncertain as a fit with a filter in place of the delay says, if it is as good.

    The ends of the profiles are moved as far as the values move, and the covariance has the product of these
    differences in addition. Unchanged where the force is not late, for a filter makes it late.
    """
    values = problem.space.values_by_name(optimum.point)
    if values.get(DELAY, 0.0) <= 0.0:
        return optimum, list(found)
    assumed = (*(h for h in problem.assumed if h.name is not Suspect.DELAY), load_cell())
    other = replace(problem, space=space_of(problem.rig, assumed), assumed=assumed, systems={})
    start = other.space.coordinates_of({**values, LOAD_CELL: math.sqrt(0.5) / math.pi / values[DELAY]})
    names = problem.space.names
    known = dict(zip(names, steps_of(optimum), strict=True))
    steps = np.array([known.get(name, _STEP) for name in other.space.names])
    fit = fit_by_secants(other, start, other.jacobian(start, steps), _ROUNDS, _ACCURACY)
    if fit.cost > optimum.cost + _AS_GOOD:
        return optimum, list(found)
    there = dict(zip(other.space.names, fit.point, strict=True))
    moved = np.array([there.get(name, x) - x for name, x in zip(names, optimum.point, strict=True)])
    relative = moved / np.sqrt(optimum.widening)  # which a standard error is multiplied by
    covariance = optimum.covariance + np.outer(relative, relative)
    return replace(optimum, covariance=covariance), [p.widen(float(by)) for p, by in zip(found, moved, strict=True)]
