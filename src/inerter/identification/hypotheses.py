"""What a device or its sensors may do beyond the model: named hypotheses, each with unknowns of its own.

One changes the motion that the device is given, or the force that the load cell reads, or both. With a hypothesis in
its problem a fit is what it is without: coordinates, residuals, derivatives, intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.signal import bilinear, lfilter

from inerter.identification.experiment import Experiment
from inerter.identification.suspects import Details, Suspect
from inerter.networks.elements import Network

Matrix = NDArray[np.float64]
Values = Mapping[str, float]
GAIN, DELAY = "sensor gain", "sensor delay"
LONGEST_DELAY = 0.02  # [s] that is looked for
_GAINS = (0.5, 2.0)


@dataclass(frozen=True)
class Unknown:
    """A number that a hypothesis leaves open; of this `size` it would be seen."""

    name: str
    unit: str
    lower: float
    upper: float
    size: float


def _as_it_was(experiment: Experiment, values: Values) -> Experiment:
    return experiment


def _as_read(force: Matrix, experiment: Experiment, values: Values) -> Matrix:
    return force


def _none(values: Values) -> Details:
    return {}


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """`moved` makes of an experiment the one that the device feels, `read` of its force what the load cell reads.

    `device` takes the place of the model; its free values that the model does not have are unknowns too.
    """

    name: Suspect
    unknowns: tuple[Unknown, ...] = ()
    device: Network | None = None
    moved: Callable[[Experiment, Values], Experiment] = _as_it_was
    read: Callable[[Matrix, Experiment, Values], Matrix] = _as_read  # of the first samples
    details: Callable[[Values], Details] = _none  # the numbers of its sentence
    slow: int | None = None  # degree over time of what it leaves open in each part of a record
    starts: tuple[Values, ...] = ({},)  # where to begin, unless it is at the sizes, or at zero if it may be negative
    alike: Mapping[str, str] = field(default_factory=dict)  # unknowns that begin where those of the model are, by these


def gain() -> Hypothesis:
    """A load cell that reads in proportion."""
    unknown = Unknown(GAIN, "", *_GAINS, 1.0)
    return Hypothesis(Suspect.GAIN, (unknown,), read=_in_proportion)


def _in_proportion(force: Matrix, experiment: Experiment, values: Values) -> Matrix:
    return values[GAIN] * force


def delay(longest: float) -> Hypothesis:
    """A force that is late against the displacement, or early where the displacement is late."""
    unknown = Unknown(DELAY, "s", -longest, longest, 0.1 * longest)
    return Hypothesis(Suspect.DELAY, (unknown,), moved=_late, details=_lateness)


def _late(experiment: Experiment, values: Values) -> Experiment:
    return experiment.late(values[DELAY])


def _lateness(values: Values) -> Details:
    return {"delay": values[DELAY]}


def filtered_displacement(order: int) -> Hypothesis:
    """A displacement that went through a low pass (Butterworth), which is undone before the device feels it."""
    name = f"displacement filter {order}"
    unknown = Unknown(name, "s", 0.0, 0.02, 2e-3)
    first, second = (1.0, 0.0) if order == 1 else (math.sqrt(2.0), 1.0)

    def moved(e: Experiment, values: Values) -> Experiment:
        T, motion = values[name], e.motion
        jerk = np.gradient(motion.acceleration, e.record.interval)
        x = motion.displacement + first * T * motion.velocity + second * T**2 * motion.acceleration
        return e.moved(x, motion.velocity + first * T * motion.acceleration + second * T**2 * jerk)

    return Hypothesis(
        Suspect.FILTERED_DISPLACEMENT, (unknown,), moved=moved, details=lambda values: {"time": values[name]}
    )


def filtered_force() -> Hypothesis:
    """A force that went through a low pass of second order, on top of what is known of the load cell."""
    name = "force filter"
    unknown = Unknown(name, "s", 0.0, 0.02, 2e-3)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        return low_passed(force, e.record.interval, values[name])

    return Hypothesis(Suspect.FILTERED_FORCE, (unknown,), read=read, details=lambda values: {"time": values[name]})


def drift() -> Hypothesis:
    """A load cell whose zero moves slowly: a polynomial over the record, which nobody can continue for long."""
    unknowns = tuple(Unknown(f"drift, degree {degree}", "N", -1e3, 1e3, 1.0) for degree in range(1, 5))

    def path(values: Values, size: int) -> Matrix:
        coefficients = [0.0, *(values[u.name] for u in unknowns)]
        return np.asarray(np.polynomial.legendre.legval(np.linspace(-1.0, 1.0, size), coefficients))

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        return np.asarray(force + path(values, e.size)[: force.size])

    def details(values: Values) -> Details:
        return {"drift": float(np.ptp(path(values, 101)[:81]))}

    return Hypothesis(Suspect.DRIFT, unknowns, read=read, details=details, slow=2)


def fixture() -> Hypothesis:
    """A mass that moves with the table between load cell and device."""
    name = "fixture mass"
    unknown = Unknown(name, "kg", 0.0, 1e3, 1.0)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        moved = e.motion.acceleration[: force.size]
        return np.asarray(force + values[name] * through_cell(moved, e))

    return Hypothesis(Suspect.FIXTURE_MASS, (unknown,), read=read, details=lambda values: {"mass": values[name]})


def sensors(offset: bool) -> list[Hypothesis]:
    """What the sensors may do; an offset of the load cell that is not free among them."""
    found = [
        delay(LONGEST_DELAY),
        filtered_displacement(1),
        filtered_displacement(2),
        filtered_force(),
        drift(),
        fixture(),
    ]
    return found if offset else [*found, _offset()]


def _offset() -> Hypothesis:
    name = "force offset"
    unknown = Unknown(name, "N", -1e3, 1e3, 1.0)

    return Hypothesis(
        Suspect.OFFSET,
        (unknown,),
        read=lambda force, e, values: force + values[name],
        details=lambda values: {"offset": values[name]},
    )


def low_passed(values: Matrix, interval: float, time: float) -> Matrix:
    """Through a Butterworth low pass of second order whose corner is 1/(2 pi `time`)."""
    if time <= 0.0:
        return values
    b, a = bilinear([1.0], [time**2, math.sqrt(2.0) * time, 1.0], 1.0 / interval)
    return np.asarray(lfilter(b, a, values))


def through_cell(force: Matrix, experiment: Experiment) -> Matrix:
    """A force as the load cell reads it, as far as its bandwidth is known."""
    bandwidth = experiment.record.force_bandwidth
    return force if bandwidth is None else low_passed(force, experiment.record.interval, 0.5 / math.pi / bandwidth)
