"""What a model answers to the displacement of a record, beside what the rig did; and its linear response."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from inerter.errors import LinearSystemError, RecordError, Status
from inerter.networks.elements import Network
from inerter.networks.transform import linearise
from inerter.records.periods import common_periods, whole_periods
from inerter.records.record import Record
from inerter.records.response import Estimator, frequency_response
from inerter.records.result import Response, exact_response
from inerter.records.spectra import lines_of
from inerter.signals.harmonics import Harmonics
from inerter.signals.signal import Signal
from inerter.simulation.simulate import simulate
from inerter.vehicle.rig import Rig

Matrix = NDArray[np.float64]
Complex = NDArray[np.complex128]
_STEP = 2e-4  # [s] longest of the simulation
_ABOVE = 1.25  # times the highest frequency of the response: where the displacement is cut off
_HIGHEST = 0.8  # of half the rate: a cut-off above that is none
_ORDER = 4  # of the Butterworth filter, which goes forward and backward


def model_response(
    model: Network | Rig,
    records: Record | Sequence[Record],
    *,
    estimator: Estimator = "H1",
    segment: float | None = None,
    step: float = _STEP,
) -> Response:
    """The response of a device on the rig to the records' own displacement, by the estimator that the records get.

    Friction and backlash make it depend on the amplitude, so it is a model's only fair comparison with a measurement.
    The displacement is smoothed before the device feels it, for the steps of an encoder are no motion of the table:
    where it repeats, to the harmonics of its mean period that stand out of the scatter, and the device is in its
    steady state; where it does not, by a Butterworth filter, forward and backward, a quarter above the highest
    frequency of their response, and the device starts from rest. The frequencies are those that
    `frequency_response(records)` finds. `step` [s] is the longest of the simulation.

    Raises `RecordError` as `frequency_response` does, and where a simulation has to stop; `DesignError`,
    `MechanismError` and `SimulationError` as `simulate` does. What a simulation says of its accuracy is the `status`.

    >>> import inerter as it, numpy as np
    >>> t = np.arange(2000) * 1e-3
    >>> moved = 1e-3 * np.sin(2 * np.pi * 5 * t)
    >>> record = it.Record(t, moved, 2e4 * moved)
    >>> it.model_response(it.Spring(1e4) | it.Damper(10.0), record).gain.round(3)
    array([10004.934])
    """
    rig = model if isinstance(model, Rig) else Rig(model)
    chosen = [records] if isinstance(records, Record) else list(records)
    measured = frequency_response(chosen, estimator=estimator, segment=segment)
    if segment is None and (periods := common_periods(chosen)) is not None:
        moved = [_mean_period(record, period) for record, period in zip(chosen, periods, strict=True)]
        answered = [_in_steady_state(rig, motion, record, step) for motion, record in zip(moved, chosen, strict=True)]
    else:
        cutoff = _ABOVE * measured.frequency[-1]
        answered = [_from_rest(rig, smoothed(record, cutoff), step) for record in chosen]
    answers = [record for record, _ in answered]
    if not any(np.ptp(record.force) for record in answers):  # such as in the play of a gap
        found = exact_response(measured.omega, np.zeros(measured.omega.size, dtype=complex), measured.amplitude)
    else:
        found = frequency_response(answers, estimator=estimator, segment=segment)
        found = found.lines(_among(found.omega, measured.omega))
        if found.estimator == "periodic":  # two periods that are the same have no scatter
            found = exact_response(found.omega, found.value, found.amplitude)
    notes = [note for record, _ in answered for note in record.notes]
    status = next((status for _, status in answered if not status.ok), found.status)
    found = replace(found, source="model", status=status, notes=tuple(dict.fromkeys(notes)))
    bands = {record.force_bandwidth for record in chosen}
    return as_read(found, bands.pop()) if len(bands) == 1 else found


def as_read(response: Response, bandwidth: float | None) -> Response:
    """A model's response as a load cell of this bandwidth [Hz] reads it: Butterworth, of second order."""
    if bandwidth is None:
        return response
    s = 1j * response.frequency / bandwidth
    read = exact_response(response.omega, response.value / (s * s + math.sqrt(2.0) * s + 1.0), response.amplitude)
    note = f"As read by a load cell of {bandwidth:g} Hz."
    return replace(read, source=response.source, status=response.status, notes=(*response.notes, note))


def linear_response(model: Network | Rig, omega: ArrayLike, cell_bandwidth: float | None = None) -> Response:
    """The linear response of a device, j omega times its admittance: friction left out, gaps closed.

    As read by a load cell of `cell_bandwidth` [Hz], if that is given.

    Raises `DesignError` if a value is free, `LinearSystemError` unless omega holds positive frequencies [rad/s].
    """
    device = model.device if isinstance(model, Rig) else model
    try:
        frequencies = np.atleast_1d(np.asarray(omega, dtype=float))
    except (TypeError, ValueError):
        frequencies = np.full(1, np.nan)
    if frequencies.ndim != 1 or not np.all(np.isfinite(frequencies) & (frequencies > 0.0)):
        raise LinearSystemError("A linear response needs a list of positive frequencies [rad/s].")
    value = np.asarray(1j * frequencies * device.admittance(1j * frequencies))
    linear = linearise(device)
    left_out = {e.key: [o.label for o in linear.left_out if o.key == e.key] for e in linear.left_out}
    notes = [f"{key.capitalize()} left out: {', '.join(labels)}." for key, labels in left_out.items()]
    notes += [f"Gaps closed: {', '.join(linear.gaps)}."] if linear.gaps else []
    return as_read(
        replace(exact_response(frequencies, value), source="linear model", notes=tuple(notes)), cell_bandwidth
    )


def smoothed(record: Record, cutoff: float) -> Record:
    """A record whose displacement has nothing above `cutoff` [Hz]: Butterworth, of fourth order, forward and backward.

    As it is where the cut-off is close to half the rate.
    """
    if cutoff >= _HIGHEST * 0.5 / record.interval:
        return record.with_notes("The displacement is as measured: it reaches up to nearly half the rate.")
    filter_ = scipy.signal.butter(_ORDER, cutoff, fs=1.0 / record.interval, output="sos")
    return record.with_notes(
        f"The displacement smoothed up to {cutoff:.4g} Hz (Butterworth, forward and backward).",
        displacement=scipy.signal.sosfiltfilt(filter_, record.displacement),
    )


def _among(omega: Matrix, others: Matrix) -> NDArray[np.bool_]:
    """Which frequencies are also among others, which increase."""
    after = np.searchsorted(others, omega * (1.0 - 1e-6))
    return np.asarray(np.append(others, np.inf)[after] <= omega * (1.0 + 1e-6))


def _mean_period(record: Record, period: float) -> Harmonics:
    """The mean period of a displacement, of the harmonics that stand out of its scatter."""
    part = whole_periods(record, period)
    lines = lines_of([part])
    significant = lines.excited() | lines.significant()
    amplitudes = np.where(significant, lines.displacement[0].mean(axis=0), 0.0)
    last = 1 + int(np.max(np.flatnonzero(amplitudes), initial=0))
    return Harmonics(
        label=f"mean period of {record.source}",
        coefficient=amplitudes[:last],
        period=part.period,
        highest_frequency=last / part.period,
    )


def _in_steady_state(rig: Rig, motion: Harmonics, record: Record, step: float) -> tuple[Record, Status]:
    """Two periods, which are the same, of the record of a model, and how the simulation ended."""
    count = max(round(motion.period / record.interval), 2 * motion.coefficient.size + 2, 4)
    every = math.ceil(motion.period / count / step * (1.0 - 1e-9))
    run = simulate(rig, displacement=motion, initial="periodic", step=motion.period / (count * every), every=every)
    if not run.status.ok and run.time.size < count:
        raise RecordError(f"The model cannot follow {record.source!r}: {run.status.message}.")
    time = np.asarray(np.arange(2 * count) * (motion.period / count))
    x, force = (np.tile(run[name][:count], 2) for name in ("displacement", "device_force"))
    count_significant = np.count_nonzero(motion.coefficient)
    notes = (f"The model's steady state on the mean period of the displacement, of {count_significant} harmonics.",)
    return Record(time, x, force, source=record.source, notes=notes, period=motion.period), run.status


def _from_rest(rig: Rig, record: Record, step: float) -> tuple[Record, Status]:
    """The record that the model would have left, from rest, and how the simulation ended."""
    every = math.ceil(record.interval / step * (1.0 - 1e-9))
    signal = Signal.sampled(np.arange(record.time.size) * record.interval, record.displacement)
    run = simulate(rig, displacement=signal, duration=record.duration, step=record.interval / every, every=every)
    if run.time.size < record.time.size:
        raise RecordError(f"The model cannot follow {record.source!r}: {run.status.message}.")
    notes = (*record.notes[-1:], "The model starts from rest.")
    return Record(record.time, record.displacement, run["device_force"], source=record.source, notes=notes), run.status
