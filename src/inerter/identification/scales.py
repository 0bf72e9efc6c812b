"""Uncertainties of sensor scales and fixture mass, which no record shows, in the intervals of a fit.

A load cell that reads 1 % too much makes every stiffness, damping, inertance and friction 1 % larger, with the same
residual. Such an error has the same sign in all samples, so that a longer record does not reduce it: its standard
uncertainty is added to that of the estimates in squares (JCGM 100:2008, 5.1.2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from inerter.formatting import format_number
from inerter.identification.experiment import Experiment
from inerter.identification.friction_models import QUADRATIC_UNIT
from inerter.identification.intervals import ROBUST, BestFit, steps_of
from inerter.identification.options import FitOptions
from inerter.identification.problem import FitProblem
from inerter.identification.search import improve
from inerter.methods.averages import NORMAL_QUANTILE
from inerter.networks.elements import Free
from inerter.networks.elements.roles import LinearRole
from inerter.records.record import Record, scale_readings

Matrix = NDArray[np.float64]
_EVALUATIONS = 8
POWERS = {  # of the force's and of the displacement's scale in the value of an element: true over read
    LinearRole.STIFFNESS: (1.0, -1.0),
    LinearRole.DAMPING: (1.0, -1.0),
    LinearRole.MASS: (1.0, -1.0),
    LinearRole.OPEN: (1.0, 0.0),
    LinearRole.CLOSED: (0.0, 1.0),
}
_OF_UNITS = {QUADRATIC_UNIT: (1.0, -2.0)}  # the same of the value of an unknown law


@dataclass(frozen=True, eq=False)
class ScaleEffects:
    """Changes of every estimate [its unit] by one standard uncertainty of each scale and mass."""

    changes: Matrix  # (things, parameters)
    relative: Matrix  # (parameters,) the same of the end of an interval that has one end, over that end

    @property
    def covariance(self) -> Matrix:
        """Contribution to the covariance of the estimates."""
        return np.asarray(self.changes.T @ self.changes)

    @property
    def errors(self) -> Matrix:
        """Contribution to the standard uncertainty of each estimate."""
        return np.sqrt(np.diag(self.covariance))

    def width(self, i: int) -> float:
        """The width of a 95 % interval from these uncertainties alone."""
        return 2.0 * NORMAL_QUANTILE * float(self.errors[i])

    def widen(
        self, i: int, interval: tuple[float, float], best: float, known: tuple[bool, bool]
    ) -> tuple[float, float]:
        """The 95 % interval of a parameter with its scale errors.

        Two known ends are widened by the root of the sum of squares. A single end, which is not a distance from an
        estimate, is moved by all of the error of the scale.
        """
        error = NORMAL_QUANTILE * float(self.errors[i])
        alone = NORMAL_QUANTILE * float(self.relative[i])
        both, (low, high) = all(known), interval
        if known[0]:
            low = best - math.hypot(max(best - low, 0.0), error) if both else low * (1.0 - alone)
        if known[1]:
            high = best + math.hypot(max(high - best, 0.0), error) if both else high * (1.0 + alone)
        return max(low, 0.0) if interval[0] >= 0.0 else low, high


def apply_scales(record: Record, options: FitOptions) -> Record:
    """The record with its readings multiplied by the given scales."""
    force, moved = options.force_scale, options.displacement_scale
    for scale, names in (
        (force, ("force", "force_range", "force_noise")),
        (moved, ("displacement", "velocity", "acceleration", "displacement_noise")),
    ):
        if scale is not None and scale.value != 1.0:
            changes = {
                n: scale_readings(f"The {n} of {record.source!r}", v, scale.value)
                for n in names
                if (v := getattr(record, n)) is not None
            }
            note = f"{names[0].capitalize()} multiplied by its scale, {format_number(scale.value)}."
            record = record.with_notes(note, **changes)
    return record


def scale_effects(problem: FitProblem, optimum: BestFit, options: FitOptions) -> ScaleEffects | None:
    """The effects of the stated uncertainties; None where there are none.

    Where all elements are free, each value follows the scales by a power. Where some are fixed, the others compensate:
    then the records are fitted again with a scale, or a fixture mass, one standard uncertainty larger and smaller.
    """
    space = problem.space
    values = space.to_values(optimum.point)
    powers = np.array(
        [
            _OF_UNITS.get(unit, (0.0, 0.0)) if kind is None else POWERS[kind.linear]
            for kind, unit in zip(space.kinds, space.units, strict=True)
        ]
    )
    follows = all(isinstance(e.value, Free) or e.value == 0.0 for e in problem.rig.device.elements())
    follows = follows and not any(e.record.fixture_mass for e in problem.experiments)
    rows, relative = [], np.zeros(len(space.names))
    for column, (uncertainty, apply) in enumerate(_stated_scales(options)):
        if uncertainty > 0.0:
            along = uncertainty * powers[:, column]
            rows.append(values * along if follows else _refit_difference(problem, optimum, uncertainty, apply))
            relative = np.hypot(relative, along)
    if any(e.record.fixture_mass_error for e in problem.experiments):
        rows.append(_refit_difference(problem, optimum, 1.0, _add_fixture_mass))
    return ScaleEffects(np.array(rows), relative) if rows else None


def _stated_scales(options: FitOptions) -> Iterator[tuple[float, Callable[[Experiment, float], Experiment]]]:
    for scale, apply in ((options.force_scale, _scale_force), (options.displacement_scale, _scale_displacement)):
        yield 0.0 if scale is None else scale.relative, apply


def _refit_difference(
    problem: FitProblem, optimum: BestFit, uncertainty: float, apply: Callable[[Experiment, float], Experiment]
) -> Matrix:
    """Half the difference of the values between fits to records with one error and with its opposite."""
    ends = []
    for sign in (1.0, -1.0):
        other = replace(problem, experiments=[apply(e, sign * uncertainty) for e in problem.experiments])
        point, *_ = improve(other, optimum.point, _EVALUATIONS, steps_of(optimum), ROBUST)
        ends.append(problem.space.to_values(point))
    return np.asarray(0.5 * (ends[0] - ends[1]))


def _scale_force(e: Experiment, by: float) -> Experiment:
    return replace(e, record=replace(e.record, force=e.record.force * (1.0 + by)))


def _scale_displacement(e: Experiment, by: float) -> Experiment:
    moved = replace(e, record=replace(e.record, displacement=e.record.displacement * (1.0 + by)))
    return moved.with_motion(e.motion.displacement * (1.0 + by), e.motion.velocity * (1.0 + by))


def _add_fixture_mass(e: Experiment, by: float) -> Experiment:
    mass = (e.record.fixture_mass or 0.0) + by * (e.record.fixture_mass_error or 0.0)
    return replace(e, record=replace(e.record, fixture_mass=mass or None))
