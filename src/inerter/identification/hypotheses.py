"""Named hypotheses on effects of the device or its sensors beyond the model, each with its unknowns.

A hypothesis changes the motion imposed on the device, or the force read by the load cell, or both. A fit with a
hypothesis consists of the same parts as without: coordinates, residuals, derivatives, intervals.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from inerter.identification.experiment import Experiment
from inerter.identification.statements.causes import Details, Suspect
from inerter.networks.elements import Network

Matrix = NDArray[np.float64]
Values = Mapping[str, float]
GAIN, DELAY, LOAD_CELL = "sensor gain", "sensor delay", "load cell bandwidth"
LONGEST_DELAY = 0.02  # [s] that is searched
_GAINS = (0.5, 2.0)
_BANDWIDTHS = (5.0, 5e3)  # [Hz]


@dataclass(frozen=True)
class Unknown:
    """An unknown of a hypothesis; `size` is its detectable size."""

    name: str
    unit: str
    lower: float
    upper: float
    size: float


def _unchanged_motion(experiment: Experiment, values: Values) -> Experiment:
    return experiment


def _unchanged_force(force: Matrix, experiment: Experiment, values: Values) -> Matrix:
    return force


def _no_details(values: Values) -> Details:
    return {}


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A hypothesis: `change_motion` returns the experiment imposed on the device, `read` the force of the load cell.

    `device` replaces the model; its free values that the model does not have are unknowns too.
    """

    name: Suspect
    unknowns: tuple[Unknown, ...] = ()
    device: Network | None = None
    change_motion: Callable[[Experiment, Values], Experiment] = _unchanged_motion
    read: Callable[[Matrix, Experiment, Values], Matrix] = _unchanged_force  # of the first samples
    details: Callable[[Values], Details] = _no_details  # the numbers of its sentence
    slow: int | None = None  # degree of the polynomial over time that is free in each part of a record
    starts: tuple[Values, ...] = ({},)  # starting values; default: the sizes, or zero if it may be negative
    counterparts: Mapping[str, str] = field(default_factory=dict)  # unknowns that start at these values of the model


def gain() -> Hypothesis:
    """Hypothesis of a gain error of the load cell."""
    unknown = Unknown(GAIN, "", *_GAINS, 1.0)
    return Hypothesis(Suspect.GAIN, (unknown,), read=_scale_force)


def _scale_force(force: Matrix, experiment: Experiment, values: Values) -> Matrix:
    return values[GAIN] * force


def delay(longest: float) -> Hypothesis:
    """Hypothesis of a delay of the force against the displacement, or vice versa."""
    unknown = Unknown(DELAY, "s", -longest, longest, 0.1 * longest)
    return Hypothesis(Suspect.DELAY, (unknown,), change_motion=_delay_motion, details=_delay_details)


def _delay_motion(experiment: Experiment, values: Values) -> Experiment:
    return experiment.with_delay(values[DELAY])


def _delay_details(values: Values) -> Details:
    return {"delay": values[DELAY]}


def filtered_displacement(order: int) -> Hypothesis:
    """Hypothesis of a low-pass filtered displacement (Butterworth), which is inverted."""
    name = f"displacement filter {order}"
    unknown = Unknown(name, "s", 0.0, 0.02, 2e-3)
    first, second = (1.0, 0.0) if order == 1 else (math.sqrt(2.0), 1.0)

    def change_motion(e: Experiment, values: Values) -> Experiment:
        T, motion = values[name], e.motion
        jerk = np.gradient(motion.acceleration, e.record.interval)
        x = motion.displacement + first * T * motion.velocity + second * T**2 * motion.acceleration
        return e.with_motion(x, motion.velocity + first * T * motion.acceleration + second * T**2 * jerk)

    return Hypothesis(
        Suspect.FILTERED_DISPLACEMENT,
        (unknown,),
        change_motion=change_motion,
        details=lambda values: {"time": values[name]},
    )


def filtered_force() -> Hypothesis:
    """Hypothesis of a force low-pass filtered at second order, in addition to the known load cell."""
    name = "force filter"
    unknown = Unknown(name, "s", 0.0, 0.02, 2e-3)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        return filter_force(force, e.record.interval, values[name])

    return Hypothesis(Suspect.FILTERED_FORCE, (unknown,), read=read, details=lambda values: {"time": values[name]})


def averaged_force() -> Hypothesis:
    """Hypothesis of a force that is a moving average, which may be late by more than is searched otherwise."""
    length, late = Unknown("averaged time", "s", 0.0, 0.2, 5e-3), Unknown("delay of the average", "s", -0.1, 0.1, 5e-3)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        time = np.asarray(e.record.interval * np.arange(force.size), dtype=np.float64)
        width = max(values[length.name], 0.5 * e.record.interval)
        sums = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]))]) * e.record.interval
        ends = (time - values[late.name] + sign * 0.5 * width for sign in (1.0, -1.0))
        after, before = (_extended(end, time, sums, force) for end in ends)
        return np.asarray((after - before) / width)

    starts = tuple({length.name: time} for time in (5e-3, 25e-3))
    return Hypothesis(
        Suspect.AVERAGED_FORCE,
        (length, late),
        read=read,
        details=lambda values: {"time": values[length.name], "delay": values[late.name] + values.get(DELAY, 0.0)},
        starts=starts,
    )


def _extended(at: Matrix, time: Matrix, sums: Matrix, force: Matrix) -> Matrix:
    """The integral of the force at any times, of which it keeps its first and last value before and after."""
    inside = np.interp(at, time, sums)
    return np.asarray(inside + np.minimum(at - time[0], 0.0) * force[0] + np.maximum(at - time[-1], 0.0) * force[-1])


def load_cell(stated: float | None = None) -> Hypothesis:
    """Hypothesis of a load cell whose bandwidth the records do not state, or not rightly, as a part of the rig.

    Friction that reverses between two samples is not resolved by a filter of the samples.
    """
    unknown = Unknown(LOAD_CELL, "Hz", *_BANDWIDTHS, 100.0)

    def change_motion(e: Experiment, values: Values) -> Experiment:
        if e.record.force_bandwidth != stated:
            return e
        return replace(e, record=replace(e.record, force_bandwidth=values[LOAD_CELL]))

    return Hypothesis(
        Suspect.FILTERED_FORCE,
        (unknown,),
        change_motion=change_motion,
        details=lambda values: {"time": 0.5 / math.pi / values[LOAD_CELL], "stated": stated},
        starts=tuple({LOAD_CELL: bandwidth, DELAY: 0.0} for bandwidth in (60.0, 250.0)),  # for a delay stood for it
    )


def drift() -> Hypothesis:
    """Hypothesis of a slow zero drift of the load cell: a polynomial over the record, not to be extrapolated far."""
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
    """Hypothesis of a fixture mass between load cell and device."""
    name = "fixture mass"
    unknown = Unknown(name, "kg", 0.0, 1e3, 1.0)

    def read(force: Matrix, e: Experiment, values: Values) -> Matrix:
        acceleration = e.motion.acceleration[: force.size]
        return np.asarray(force + values[name] * read_by_load_cell(acceleration, e))

    return Hypothesis(Suspect.FIXTURE_MASS, (unknown,), read=read, details=lambda values: {"mass": values[name]})


def sensor_hypotheses(offset: bool) -> list[Hypothesis]:
    """Hypotheses on the sensors, with an offset of the load cell if that is not free."""
    found = [
        delay(LONGEST_DELAY),
        filtered_displacement(1),
        filtered_displacement(2),
        filtered_force(),
        averaged_force(),
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


def filter_force(values: Matrix, interval: float, time: float) -> Matrix:
    """The values after a Butterworth low-pass filter of second order with corner 1/(2 pi `time`)."""
    if time <= 0.0:
        return values
    rate = 2.0 * time / interval  # of the bilinear transformation: s = 2 (z - 1) / (z + 1) / interval
    square, damped = rate**2, math.sqrt(2.0) * rate
    return np.asarray(
        lfilter([1.0, 2.0, 1.0], [1.0 + damped + square, 2.0 - 2.0 * square, 1.0 - damped + square], values)
    )


def read_by_load_cell(force: Matrix, experiment: Experiment) -> Matrix:
    """The force read by the load cell of the record, if its bandwidth is known."""
    bandwidth = experiment.record.force_bandwidth
    return force if bandwidth is None else filter_force(force, experiment.record.interval, 0.5 / math.pi / bandwidth)
